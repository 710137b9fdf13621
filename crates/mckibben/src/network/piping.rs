//! Branches with what lies at their ends, resolved once for a run: what every evaluation would look up again.

use super::flow::NetworkState;
use super::{BranchKind, NodeKind};
use crate::plant::Plant;
use crate::scalar::Scalar;
use crate::valve::{FlowLaw, Port};
use alloc::vec::Vec;

/// A node whose pressure changes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Varying {
    pub(super) node: usize,
    /// Place of its pressure among the states.
    pub(super) place: usize,
    /// The actuator whose chamber it is.
    pub(super) chamber: Option<usize>,
}

/// The node at one end of a branch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct End {
    pub(super) node: usize,
    /// The actuator whose chamber it is.
    pub(super) chamber: Option<usize>,
    /// Whether what comes and goes counts there: not where the pressure is constant.
    pub(super) counts: bool,
    /// Whether the temperature of what comes in counts: where the air keeps an energy balance.
    pub(super) warms: bool,
}

/// A flow path of a valve, or a check valve, between its ends.
#[derive(Clone, Copy, Debug)]
pub struct Orifice<R> {
    /// Which branch.
    pub branch: usize,
    /// Its flow.
    pub law: FlowLaw<R>,
    /// The valve that opens it, and by which of its ports.
    pub opened: Option<(usize, Port)>,
    /// Whether air that comes back counts with the ambient temperature.
    pub(crate) ambient: bool,
    /// How many alike draw from `from`.
    pub(crate) copies: R,
    pub(crate) from: End,
    pub(crate) to: End,
}

/// Any other branch between its ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pipe<R> {
    /// Which branch.
    pub(super) branch: usize,
    pub(super) kind: BranchKind<R>,
    pub(super) from: End,
    pub(super) to: End,
    /// Place of its flow among the states.
    pub(super) place: Option<usize>,
}

/// All branches of a network, and the nodes whose pressure changes.
#[derive(Clone, Debug)]
pub(crate) struct Piping<R> {
    pub(super) orifices: Vec<Orifice<R>>,
    /// Which of them each branch is, if it is one.
    orifice_of: Vec<Option<usize>>,
    pub(super) pipes: Vec<Pipe<R>>,
    pub(super) varying: Vec<Varying>,
    /// The outlets of regulators that a node of the network feeds, each with that node, the last outlet first.
    pub(super) drawn: Vec<[usize; 2]>,
}

impl<R: Scalar> Piping<R> {
    /// That of a plant.
    pub(crate) fn new(plant: &Plant<R>) -> Self {
        let (network, places) = (plant.network(), plant.indices());
        let end = |node: usize| {
            let kind = &network.nodes[node].kind;
            let chamber = match kind {
                NodeKind::Chamber { actuator } => Some(*actuator),
                _ => None,
            };
            End {
                node,
                chamber,
                counts: !matches!(kind, NodeKind::Atmosphere | NodeKind::Source),
                warms: chamber.is_some_and(|actuator| places.keeps_heat[actuator]),
            }
        };
        let (mut orifices, mut pipes) = (Vec::new(), Vec::new());
        let mut orifice_of = alloc::vec![None; network.branches.len()];
        for (branch, it) in network.branches.iter().enumerate() {
            let (from, to) = (end(it.from), end(it.to));
            let (law, opened, ambient, copies) = match it.kind {
                BranchKind::Path { law, valve, port, ambient, copies } => (law, Some((valve, port)), ambient, copies),
                BranchKind::Check { law } => (law, None, false, R::one()),
                kind => {
                    pipes.push(Pipe { branch, kind, from, to, place: places.branches[branch] });
                    continue;
                }
            };
            orifice_of[branch] = Some(orifices.len());
            orifices.push(Orifice { branch, law, opened, ambient, copies, from, to });
        }
        let varying = network.nodes.iter().enumerate().filter_map(|(node, it)| match it.kind {
            NodeKind::Chamber { actuator } => {
                Some(Varying { node, place: places.actuators[actuator].pressure, chamber: Some(actuator) })
            }
            _ => places.nodes[node].map(|place| Varying { node, place, chamber: None }),
        });
        let outlets = network.nodes.iter().enumerate().rev();
        let drawn = outlets.filter_map(|(index, node)| match node.kind {
            NodeKind::Outlet { inlet, .. } => inlet.map(|inlet| [index, inlet]),
            _ => None,
        });
        Self { orifices, orifice_of, pipes, varying: varying.collect(), drawn: drawn.collect() }
    }
}

impl<R: Scalar> Piping<R> {
    /// Sets the pressures of the nodes that change alone.
    pub(crate) fn enter_pressures<T: Scalar>(&self, state: &[T], at: &mut NetworkState<T>) {
        for varying in &self.varying {
            at.nodes[varying.node].pressure = state[varying.place];
        }
    }

    /// The orifice that a branch is, if it is one.
    pub(super) fn orifice(&self, branch: usize) -> Option<&Orifice<R>> {
        self.orifices.get(self.orifice_of[branch]?)
    }

    /// The pressure of a node in Pa in a state; none for one that does not change.
    pub(crate) fn pressure<T: Copy>(&self, node: usize, state: &[T]) -> Option<T> {
        self.varying.iter().find(|varying| varying.node == node).map(|varying| state[varying.place])
    }
}
