//! What a file calls the parts of a plant, and what parts without a name of their own are called after.

use super::PlantExperiment;
use mckibben::network::NodeKind;

/// What a file calls the parts of a plant.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlantNames {
    /// Each actuator's.
    pub actuators: Vec<String>,
    /// The valve of each actuator in the network, where it has one.
    pub valves: Vec<Option<usize>>,
    /// The hose of each actuator: the node that its valve opens into, where it has one.
    pub hoses: Vec<Option<usize>>,
    /// Each mechanism's and, of a chain, its joints'; no name where it is the load of one actuator alone.
    pub mechanisms: Vec<MechanismNames>,
    /// The nodes of the network that are supplies; of one with reservoir and regulator both, the reservoir as `NAME.reservoir`.
    pub nodes: Vec<(String, usize)>,
    /// The valves of supplies.
    pub supply_valves: Vec<(String, usize)>,
}

/// What a file calls a mechanism and its parts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MechanismNames {
    /// Its name.
    pub name: Option<String>,
    /// Those of its joints.
    pub joints: Vec<String>,
}

impl PlantExperiment {
    /// The supply or the actuator that a node of the network is, or that it leads to; empty where it leads to none.
    pub fn owner_of_node(&self, mut node: usize) -> &str {
        let (network, names) = (self.plant.network(), &self.names);
        // A hose or a regulating valve belongs to what it leads to.
        for _ in 0..=network.branches.len() {
            if let Some((name, _)) = names.nodes.iter().find(|(_, its)| *its == node) {
                return name;
            }
            if let NodeKind::Chamber { actuator } = network.nodes[node].kind {
                return names.actuators.get(actuator).map_or("", String::as_str);
            }
            match network.branches.iter().find(|branch| branch.from == node) {
                Some(branch) => node = branch.to,
                None => return "",
            }
        }
        ""
    }

    /// The name of a quantity of a node, as columns have it: `tank.pressure`, `flexor.hose_pressure`, of a hose in cells
    /// `flexor.hose_pressure_1` at the valve and on from there.
    pub fn name_of_node(&self, node: usize, quantity: &str) -> String {
        let (network, owner) = (self.plant.network(), self.owner_of_node(node));
        if self.names.nodes.iter().any(|(_, its)| *its == node) {
            return format!("{owner}.{quantity}");
        }
        match &network.nodes[node].kind {
            NodeKind::Hose(hose) if hose.cells() > 1 => {
                format!("{owner}.hose_{quantity}_{}", node - network.hose_start(node) + 1)
            }
            NodeKind::Hose(_) | NodeKind::Given { .. } => format!("{owner}.hose_{quantity}"),
            NodeKind::Port { .. } => format!("{owner}.regulated_{quantity}"),
            NodeKind::Source | NodeKind::Outlet { .. } => format!("{owner}.supply_{quantity}"),
            NodeKind::Reservoir(_) => format!("{owner}.reservoir_{quantity}"),
            NodeKind::Chamber { .. } | NodeKind::Atmosphere => format!("{owner}.{quantity}"),
        }
    }

    /// The name of the flow out of a cell of a hose: `flexor.hose_flow_1`.
    pub fn name_of_flow(&self, branch: usize, quantity: &str) -> String {
        self.name_of_node(self.plant.network().branches[branch].from, quantity)
    }
}
