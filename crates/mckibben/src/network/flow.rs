//! Flows through the branches of a network and the rates of its nodes, by the formulas of a mode.
//!
//! ```text
//! orifice    ṁ = C ψ(r) P_up/√T_up          by the piece of ψ that the mode says (21)(23)
//! leak       ṁ = k (P² − P_atm²)/(2 R T_up)
//! node       ṁ_node = Σ in − Σ out,   heat: Σ ṁ_in T_up for chambers that keep an energy balance
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | ṁ | mass flow through a branch, positive from its first node to its second | kg/s |
//! | C ψ | flow law of the orifice ([`FlowLaw`](crate::valve::FlowLaw)) times its opening | kg·√K/(s·Pa) |
//! | P, T | absolute pressure of a node, temperature of its air; `up`: of the node that the flow leaves | Pa, K |
//! | k | conductance of a leak | m³/(s·Pa) |
//!
//! What a regulator's outlet gives away comes from its inlet: nodes are gone through from the end, and each hands on what
//! it does not hold.
//!
//! Source: Colbrunn, Nelson & Quinn (2001), section 3.2, and conservation of mass at each node; the laws of [hoses, leaks,
//! reservoirs and regulators](crate::line) have their own. Checked by `tests/plant_ledger.rs` and `tests/simulation.rs`.

use super::formulas::FlowFormulas;
use super::piping::{End, Orifice, Pipe, Piping};
use super::{Branch, BranchKind, Network, Node, NodeKind};
use crate::air::{Air, Chamber};
use crate::dual::Dual;
use crate::scalar::{Mask, Over, Scalar};
use crate::straight::StraightLine;
use alloc::vec;
use alloc::vec::Vec;

/// A node at an instant.
#[derive(Clone, Copy, Debug)]
pub struct NodeState<T> {
    /// Absolute pressure in Pa.
    pub pressure: T,
    /// `1/P`.
    pub(crate) per_pressure: T,
    /// `1/√T` of its air in 1/√K, where it does not change.
    per_root_temperature: T,
    /// What flows in and out in kg/s; zero for a source and the atmosphere.
    pub(crate) inward: T,
    pub(crate) outward: T,
    /// `Σ ṁ_in T` of what flows in, in kg·K/s.
    pub(crate) warmth: T,
}

impl<T: Scalar> NodeState<T> {
    /// The node at its pressure, whose derivatives are given.
    #[inline(always)]
    pub(super) fn along<const K: usize>(&self, pressure: Dual<T, K>) -> NodeState<Dual<T, K>> {
        let mut per_pressure = Dual { value: self.per_pressure, ..pressure };
        for slope in &mut per_pressure.slope {
            *slope = -(*slope * self.per_pressure * self.per_pressure);
        }
        NodeState {
            pressure,
            per_pressure,
            per_root_temperature: Dual::of(self.per_root_temperature),
            inward: Dual::of(self.inward),
            outward: Dual::of(self.outward),
            warmth: Dual::of(self.warmth),
        }
    }

    /// Net flow into the node in kg/s.
    #[inline(always)]
    pub(crate) fn net(&self) -> T {
        self.inward - self.outward
    }
}

/// The nodes and branches of a network at an instant.
#[derive(Clone, Debug)]
pub struct NetworkState<T> {
    /// All nodes.
    pub nodes: Vec<NodeState<T>>,
    /// Flow through each branch in kg/s, positive from `from` to `to`.
    pub(crate) flows: Vec<T>,
}

impl<T: Scalar> NetworkState<T> {
    pub(crate) fn new<S: Scalar>(network: &Network<S>) -> Self
    where
        T: Over<S>,
    {
        let nodes = network.nodes.iter().map(|node| NodeState::of(network, node));
        Self { nodes: nodes.collect(), flows: vec![T::zero(); network.branches.len()] }
    }

    /// Takes on the numbers of another network of equal structure.
    #[inline(always)]
    pub(crate) fn adapt<S: Scalar>(&mut self, network: &Network<S>)
    where
        T: Over<S>,
    {
        for (state, node) in self.nodes.iter_mut().zip(&network.nodes) {
            *state = NodeState::of(network, node);
        }
    }
}

impl<T: Scalar> NodeState<T> {
    /// A node through which nothing flows yet.
    #[inline(always)]
    fn of<S: Scalar>(network: &Network<S>, node: &Node<S>) -> Self
    where
        T: Over<S>,
    {
        let pressure = match node.kind {
            NodeKind::Atmosphere => T::of(network.atmosphere),
            _ => T::of(network.absolute(node.gauge)),
        };
        Self {
            pressure,
            per_pressure: T::one() / pressure,
            per_root_temperature: T::one() / T::of(node.temperature).sqrt(),
            inward: T::zero(),
            outward: T::zero(),
            warmth: T::zero(),
        }
    }
}

/// The states and chambers that the pressures of nodes follow from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AroundNetwork<'a, T> {
    pub(crate) chambers: &'a [Chamber<T>],
    pub(crate) state: &'a [T],
}

impl<R: Scalar> Network<R> {
    /// Computes all flows at a time in s.
    #[inline(always)]
    pub(crate) fn flows<T: Over<R>>(
        &self,
        time: T,
        piping: &Piping<R>,
        around: AroundNetwork<'_, T>,
        air: &Air<R>,
        mode: &impl FlowFormulas<R>,
        at: &mut NetworkState<T>,
    ) {
        let NetworkState { nodes, flows } = at;
        piping.enter_nodes(around, nodes);
        for orifice in &piping.orifices {
            let Orifice { from, to, .. } = orifice;
            let densities = Densities { chambers: around.chambers, gas_constant: air.gas_constant() };
            let ends = OrificeEnds { near: &nodes[from.node], far: &nodes[to.node], densities };
            let Some((is_inward, flow)) = mode.orifice(orifice, ends, time) else {
                flows[orifice.branch] = T::zero();
                continue;
            };
            flows[orifice.branch] = T::select(is_inward, flow, -flow);
            if is_inward.any() {
                let flow = T::select(is_inward, flow, T::zero());
                self.bring(to, flow, from, around, air, nodes);
                take(from, flow * T::of(orifice.copies), nodes);
            }
            if (!is_inward).any() {
                let flow = T::select(is_inward, T::zero(), flow);
                take(to, flow, nodes);
                self.bring(from, flow * T::of(orifice.copies), to, around, air, nodes);
            }
        }
        for pipe in &piping.pipes {
            self.flow_of_pipe(pipe, around, air, mode, nodes, flows);
        }
        for &[outlet, inlet] in &piping.drawn {
            let drawn = nodes[outlet].net();
            nodes[inlet].inward = nodes[inlet].inward + drawn;
        }
    }

    /// Computes the flow through a branch that is no orifice.
    #[inline(always)]
    fn flow_of_pipe<T: Over<R>>(
        &self,
        Pipe { branch, kind, from, to, place }: &Pipe<R>,
        around: AroundNetwork<'_, T>,
        air: &Air<R>,
        mode: &impl FlowFormulas<R>,
        nodes: &mut [NodeState<T>],
        flows: &mut [T],
    ) {
        let (near, far) = (nodes[from.node].pressure, nodes[to.node].pressure);
        let flow = match kind {
            BranchKind::Loss(hose) => mode.loss(*branch, hose, [near, far]),
            BranchKind::Inertia(_) => place.map_or(T::zero(), |place| around.state[place]),
            BranchKind::Leak(leakage) => {
                let outwards = near.lt(far);
                let upstream = T::select(
                    outwards,
                    self.temperature(to.node, around.chambers, air),
                    T::of(self.nodes[from.node].temperature),
                );
                leakage.between(near, far, T::of(air.gas_constant()) * upstream)
            }
            BranchKind::Compressor => match (&self.nodes[to.node].kind, mode.runs(*branch)) {
                (NodeKind::Reservoir(reservoir), runs) if runs.any() => {
                    T::select(runs, reservoir.delivery(far), T::zero())
                }
                _ => T::zero(),
            },
            BranchKind::Path { .. } | BranchKind::Check { .. } => return,
        };
        flows[*branch] = flow;
        let backwards = flow.lt(T::zero());
        let forward = T::select(backwards, T::zero(), flow);
        let back = T::select(backwards, -flow, T::zero());
        self.bring(to, forward, from, around, air, nodes);
        take(to, back, nodes);
        self.bring(from, back, to, around, air, nodes);
        take(from, forward, nodes);
    }

    /// Adds what comes into a node from another to its sums.
    #[inline(always)]
    fn bring<T: Over<R>>(
        &self,
        end: &End,
        amount: T,
        other: &End,
        around: AroundNetwork<'_, T>,
        air: &Air<R>,
        nodes: &mut [NodeState<T>],
    ) {
        if end.counts {
            nodes[end.node].inward = nodes[end.node].inward + amount;
            if end.warms {
                let temperature = self.temperature(other.node, around.chambers, air);
                nodes[end.node].warmth = nodes[end.node].warmth + amount * temperature;
            }
        }
    }

    /// Temperature in K of the air of a node.
    #[inline(always)]
    pub(crate) fn temperature<T: Over<R>>(&self, node: usize, chambers: &[Chamber<T>], air: &Air<R>) -> T {
        match self.nodes[node].kind {
            NodeKind::Chamber { actuator } => air.temperature(&chambers[actuator]),
            _ => T::of(self.nodes[node].temperature),
        }
    }

    /// The rate of a node's pressure in Pa/s, once all flows are known; of a chamber the actuator's to say.
    #[inline(always)]
    pub(crate) fn node_rate<T: Over<R>>(&self, node: usize, mode: &impl FlowFormulas<R>, at: &NetworkState<T>) -> T {
        match &self.nodes[node].kind {
            NodeKind::Hose(hose) => hose.pressure_rate(at.nodes[node].net()),
            NodeKind::Reservoir(reservoir) => reservoir.pressure_rate(at.nodes[node].net()),
            NodeKind::Outlet { .. } | NodeKind::Port { .. } | NodeKind::Given { .. } => mode.set_rate(self, node, at),
            NodeKind::Atmosphere | NodeKind::Source | NodeKind::Chamber { .. } => T::zero(),
        }
    }

    /// Absolute pressure in Pa of a node where it is given, and its rate in Pa/s, at a time in s after so many rows have passed;
    /// none for another node.
    pub(crate) fn given(&self, node: usize, time: R, passed: usize) -> Option<[R; 2]> {
        let (line, late) = self.given_line(node, passed)?;
        let [gauge, rate] = line.at(time - late);
        Some([self.absolute(gauge), rate])
    }

    /// The straight line of gauge pressures of a node where they are given, and how much later in s than that they are there.
    pub fn given_line(&self, node: usize, passed: usize) -> Option<(StraightLine<R>, R)> {
        match self.nodes[node].kind {
            NodeKind::Given { series, late } => Some((self.series[series].line(passed), late)),
            _ => None,
        }
    }

    /// The rate of the flow through a cell of a distributed hose in kg/s².
    #[inline(always)]
    pub(crate) fn branch_rate<T: Over<R>>(&self, branch: usize, at: &NetworkState<T>) -> T {
        let Branch { from, to, kind } = &self.branches[branch];
        match kind {
            BranchKind::Inertia(hose) => {
                hose.flow_rate(at.flows[branch], at.nodes[*from].pressure, at.nodes[*to].pressure)
            }
            _ => T::zero(),
        }
    }
}

impl<R: Scalar> Network<R> {
    /// The error in Pa of a regulator's outlet, which its inlet may limit, once all flows are known.
    #[doc(hidden)]
    #[inline(always)]
    pub fn outlet_error<T: Over<R>>(&self, node: usize, limited: T::Mask, at: &NetworkState<T>) -> Option<T> {
        let NodeKind::Outlet { regulator, set, inlet } = &self.nodes[node].kind else { return None };
        let pressure = at.nodes[node].pressure;
        let error = regulator.error(pressure, T::of(self.absolute(*set)), None, -at.nodes[node].net());
        Some(match inlet {
            Some(inlet) => T::select(limited, at.nodes[*inlet].pressure - pressure, error),
            None => error,
        })
    }

    /// By how much in Pa the inlet of a regulator's outlet lies above what the outlet goes to without that limit.
    #[doc(hidden)]
    #[inline(always)]
    pub fn inlet_margin<T: Over<R>>(&self, node: usize, at: &NetworkState<T>) -> Option<T> {
        let NodeKind::Outlet { regulator, set, inlet: Some(inlet) } = &self.nodes[node].kind else { return None };
        let inlet = at.nodes[*inlet].pressure;
        Some(-regulator.error(inlet, T::of(self.absolute(*set)), None, -at.nodes[node].net()))
    }
}

impl<R: Scalar> Piping<R> {
    /// Sets the pressures of the nodes that change, and their sums to zero.
    #[inline(always)]
    fn enter_nodes<T: Over<R>>(&self, around: AroundNetwork<'_, T>, nodes: &mut [NodeState<T>]) {
        for varying in &self.varying {
            let of_node = &mut nodes[varying.node];
            (of_node.inward, of_node.outward, of_node.warmth) = (T::zero(), T::zero(), T::zero());
            (of_node.pressure, of_node.per_pressure) = match varying.chamber {
                Some(actuator) => {
                    let chamber = &around.chambers[actuator];
                    (chamber.pressure, chamber.per_pressure)
                }
                None => {
                    let pressure = around.state[varying.place];
                    (pressure, T::one() / pressure)
                }
            };
        }
    }
}

/// Adds what leaves a node to its sums.
#[inline(always)]
fn take<T: Scalar>(end: &End, amount: T, nodes: &mut [NodeState<T>]) {
    if end.counts {
        nodes[end.node].outward = nodes[end.node].outward + amount;
    }
}

/// Chambers whose density says how the air of an actuator drives a flow, in the scalar of a state.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Densities<'a, S, C> {
    pub(super) chambers: &'a [Chamber<C>],
    pub(super) gas_constant: S,
}

/// `P²/T` of the air of actuators.
pub trait SquaredDrive<T> {
    /// `P²/T` in Pa²/K of the air of an actuator at a pressure in Pa.
    fn squared_drive(&self, actuator: usize, pressure: T) -> T;
}

impl<S: Scalar, C: Over<S>, T: Over<S> + Over<C>> SquaredDrive<T> for Densities<'_, S, C> {
    #[inline(always)]
    fn squared_drive(&self, actuator: usize, pressure: T) -> T {
        <T as Over<S>>::of(self.gas_constant) * pressure * <T as Over<C>>::of(self.chambers[actuator].density())
    }
}

/// What lies at the two ends of an orifice.
pub struct OrificeEnds<'a, T, D> {
    pub(super) near: &'a NodeState<T>,
    pub(super) far: &'a NodeState<T>,
    pub(super) densities: D,
}

impl<T: Scalar, D: SquaredDrive<T>> OrificeEnds<'_, T, D> {
    /// Flow in kg/s inwards, each lane by the zone of its pressures, whose ratios are given.
    #[inline(always)]
    pub fn inwards<S: Scalar>(&self, orifice: &Orifice<S>, [critical, laminar]: [T; 2]) -> T
    where
        T: Over<S>,
    {
        let [near, far] = self.pressures();
        let (choked, straight) = (far.le(critical * near), !far.le(laminar * near));
        let driven = T::of(orifice.law.conductance()) * self.drive(orifice, true);
        driven * orifice.law.in_zones(choked, straight, self.gap(true))
    }

    /// Flow in kg/s outwards, as [`OrificeEnds::inwards`].
    #[inline(always)]
    pub fn outwards<S: Scalar>(&self, orifice: &Orifice<S>, [critical, laminar]: [T; 2]) -> T
    where
        T: Over<S>,
    {
        let [near, far] = self.pressures();
        let (choked, straight) = (!(critical * far).le(near), (laminar * far).le(near));
        let driven = T::of(orifice.law.conductance()) * self.drive(orifice, false);
        driven * orifice.law.in_zones(choked, straight, self.gap(false))
    }

    /// The pressures at its first and its second node in Pa.
    #[inline(always)]
    pub fn pressures(&self) -> [T; 2] {
        [self.near.pressure, self.far.pressure]
    }

    /// `P/√T` in Pa/√K of the air that flows inwards or outwards.
    #[inline(always)]
    pub(crate) fn drive<S>(&self, orifice: &Orifice<S>, is_inward: bool) -> T {
        match (is_inward, orifice.ambient) {
            (true, _) => self.drive_of(&orifice.from, self.near),
            (false, true) => self.far.pressure * self.far.per_root_temperature,
            (false, false) => self.drive_of(&orifice.to, self.far),
        }
    }

    /// `1 − P_down/P_up` for a flow inwards or outwards.
    #[inline(always)]
    pub(crate) fn gap(&self, is_inward: bool) -> T {
        match is_inward {
            true => (self.near.pressure - self.far.pressure) * self.near.per_pressure,
            false => (self.far.pressure - self.near.pressure) * self.far.per_pressure,
        }
    }

    /// `P/√T` of the air of a node in Pa/√K.
    #[inline(always)]
    fn drive_of(&self, end: &End, at: &NodeState<T>) -> T {
        match end.chamber {
            Some(actuator) => self.densities.squared_drive(actuator, at.pressure).sqrt(),
            None => at.pressure * at.per_root_temperature,
        }
    }
}
