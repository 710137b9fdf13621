//! Branches with what lies at their ends, resolved once for a run: what every evaluation would look up again.

use super::{BranchKind, NodeKind};
use crate::plant::Plant;
use crate::scalar::Scalar;
use alloc::vec::Vec;

/// What the pressure of a node that changes is: that of an actuator's air, or a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Varying {
    /// Of which actuator.
    Chamber(usize),
    /// At which place.
    State(usize),
}

/// The node at one end of a branch.
#[derive(Clone, Copy, Debug)]
pub(super) struct End {
    pub(super) node: usize,
    /// The actuator whose chamber it is.
    pub(super) chamber: Option<usize>,
    /// Whether what comes and goes counts there: not where the pressure is constant.
    pub(super) counts: bool,
    /// Whether the temperature of what comes in counts: where the air keeps an energy balance.
    pub(super) warms: bool,
}

/// A branch between its ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pipe<'a, R> {
    pub(super) kind: &'a BranchKind<R>,
    pub(super) from: End,
    pub(super) to: End,
    /// How many branches alike draw from `from`.
    pub(super) copies: R,
    /// Place of its flow among the states.
    pub(super) place: Option<usize>,
}

/// All branches of a network, in their order, and the nodes whose pressure changes.
#[derive(Clone, Debug)]
pub(crate) struct Piping<'a, R> {
    pub(super) pipes: Vec<Pipe<'a, R>>,
    pub(super) varying: Vec<(usize, Varying)>,
    /// The outlets of regulators that a node of the network feeds, each with that node, the last outlet first.
    pub(super) drawn: Vec<[usize; 2]>,
}

impl<'a, R: Scalar> Piping<'a, R> {
    /// That of a plant.
    pub(crate) fn new(plant: &'a Plant<R>) -> Self {
        let (network, places) = (plant.network(), plant.places());
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
        let pipes = network.branches.iter().zip(&places.branches).map(|(branch, place)| Pipe {
            kind: &branch.kind,
            from: end(branch.from),
            to: end(branch.to),
            copies: match branch.kind {
                BranchKind::Path { copies, .. } => copies,
                _ => R::one(),
            },
            place: *place,
        });
        let varying =
            network.nodes.iter().zip(&places.nodes).enumerate().filter_map(|(index, (node, place))| match node.kind {
                NodeKind::Chamber { actuator } => Some((index, Varying::Chamber(actuator))),
                _ => place.map(|place| (index, Varying::State(place))),
            });
        let outlets = network.nodes.iter().enumerate().rev();
        let drawn = outlets.filter_map(|(index, node)| match node.kind {
            NodeKind::Outlet { inlet, .. } => inlet.map(|inlet| [index, inlet]),
            _ => None,
        });
        Self { pipes: pipes.collect(), varying: varying.collect(), drawn: drawn.collect() }
    }
}
