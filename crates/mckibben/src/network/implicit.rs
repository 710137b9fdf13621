//! How the pressures of a network answer to each other within a step: a linear system that is solved from the ends of the tree
//! to its root and back, in time linear in its nodes.
//!
//! With `δ_b` for the change of the flow through a branch over a stage, `r = γh`, and k for the slopes that are looked for,
//! the rows of `(I − rA) k = f` are
//!
//! ```text
//! branch       δ_b = y_b + a_b k_from − b_b k_to                    a, b: ∂ṁ/∂P, or the secant where that is steeper
//! cell         w: k_w = δ_b,   y = σ f_w,   a = b = σ r/I           I: inertance, σ = 1/(1 + r ∂ẇ/∂w)
//! node         (1 + r/τ) k + r χ O = f + l k_inlet                  O = Σ out δ − Σ in δ: what goes out
//! chamber      (1 + r/τ) k + r χ O = f + r η k_m                    η = ∂Ṗ/∂m: more air takes more heat from the wall
//! air mass     k_m = f_m − r O
//! ```
//!
//! A chamber's row has `k_m` put in, so that it has `χ + r η` for χ and `f + r η f_m` for f.
//!
//! | node | χ | 1/τ | l |
//! |---|---|---|---|
//! | chamber | κP/m | how fast heat and a growing volume take pressure | 0 |
//! | hose, reservoir | Pa per kg | 0 | 0 |
//! | outlet of a regulator | droop over lag | one over lag | r/τ where its inlet limits it, χ then 0 |
//! | port of a proportional regulator | 0 | one over its time constant | 0 |
//!
//! What goes out of a regulator's outlet goes out of its inlet. All of a, b, χ and 1/τ are zero or more: no division can fail,
//! and a flow moves no pressure beyond another. A branch that closes a ring counts for its two nodes, not between them; the
//! method that uses it keeps its order whatever the matrix.

use super::flow::{AroundNetwork, Densities, NetworkState, OrificeEnds};
use super::formulas::FlowFormulas;
use super::piping::Piping;
use super::{Branch, BranchKind, Network, NodeKind};
use crate::air::Air;
use crate::dual::Dual;
use crate::plant::Plant;
use crate::scalar::{Over, Scalar};
use alloc::vec::Vec;

/// How a node hangs on the one nearer to the root.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Link {
    parent: usize,
    /// Whether it is a regulator's outlet on its inlet, and no branch.
    is_inlet: bool,
}

/// A node whose pressure changes.
#[derive(Clone, Copy, Debug)]
struct Row<R> {
    node: usize,
    /// Place of its pressure among the states, and of the mass of its air.
    place: usize,
    mass: Option<usize>,
    link: Option<Link>,
    /// r χ, 1 + r/τ, l and r η.
    answer: R,
    own: R,
    by_inlet: R,
    by_mass: R,
    /// How O answers to its own pressure once what hangs on it is known, and to that of its parent.
    out: R,
    out_by_parent: R,
    /// How the parent's O answers to this pressure.
    parent_by_this: R,
    /// Of the whole row, inverted, and how its pressure answers to its parent's.
    per_pivot: R,
    by_parent: R,
    /// The constant part of O and of the pressure, for one right side.
    outflow: R,
    pressure: R,
}

/// A branch between two places.
#[derive(Clone, Copy, Debug)]
struct Edge<R> {
    from: Option<usize>,
    to: Option<usize>,
    /// The row whose branch to its parent it is.
    child: Option<usize>,
    /// Place of its flow among the states.
    place: Option<usize>,
    /// How many alike draw from `from`.
    copies: R,
    /// a and b.
    slopes: [R; 2],
    /// σ, and y for one right side.
    share: R,
    start: R,
}

/// The system of a network.
#[derive(Clone, Debug)]
pub(crate) struct Elimination<R> {
    /// From the ends of the tree to its roots.
    rows: Vec<Row<R>>,
    edges: Vec<Edge<R>>,
}

/// How the pressure of a node that a regulator keeps answers: r χ, 1 + r/τ and l.
pub struct RegulatedResponse<R> {
    /// `r χ`.
    pub answer: R,
    /// `1 + r/τ`.
    pub own: R,
    /// `l`.
    pub by_inlet: R,
}

/// A plant at an instant, as the system needs it. A trait, not functions: those would be compiled separately, without
/// the instructions of a batch.
pub(crate) trait Answers<R> {
    /// How a node answers.
    fn node(&self, node: usize) -> NodeResponse<R>;

    /// How a branch answers to the pressures at its ends, and the share σ of a cell.
    fn branch(&self, branch: usize) -> ([R; 2], R);
}

/// How a node answers.
pub(crate) struct NodeResponse<R> {
    /// Pa per kg of what comes in.
    pub(crate) per_mass: R,
    /// In 1/s, besides flows.
    pub(crate) falls: R,
    /// In Pa/s per kg of air that a chamber has.
    pub(crate) by_mass: R,
}

/// How many equal branches one stands for.
fn copies_of<R: Scalar>(branch: &Branch<R>) -> R {
    match branch.kind {
        BranchKind::Path { copies, .. } => copies,
        _ => R::one(),
    }
}

impl<R: Scalar> Elimination<R> {
    /// That of a plant, without numbers.
    pub(crate) fn new(plant: &Plant<R>) -> Self {
        let (network, places) = (plant.network(), plant.indices());
        let place_of = |node: usize| match network.nodes[node].kind {
            NodeKind::Chamber { actuator } => {
                let given = plant.actuators()[actuator].pressure.is_some();
                (!given).then_some(places.actuators[actuator].pressure)
            }
            NodeKind::Given { .. } => None,
            _ => places.nodes[node],
        };
        let neighbours = |node: usize| {
            let branches = network.branches.iter().filter_map(move |branch| match (branch.from, branch.to) {
                (from, to) if from == node => Some((to, false)),
                (from, to) if to == node => Some((from, false)),
                _ => None,
            });
            let fed = network.nodes.iter().enumerate().filter_map(move |(outlet, it)| match it.kind {
                NodeKind::Outlet { inlet, .. } if inlet == Some(node) => Some((outlet, true)),
                _ => None,
            });
            branches.chain(fed)
        };
        // From the roots on; what feeds others stands before them.
        let mut found: Vec<(usize, Option<(usize, bool)>)> = Vec::new();
        for root in 0..network.nodes.len() {
            let is_fed = matches!(network.nodes[root].kind, NodeKind::Outlet { inlet: Some(_), .. });
            if is_fed || place_of(root).is_none() || found.iter().any(|(node, _)| *node == root) {
                continue;
            }
            let mut next = found.len();
            found.push((root, None));
            while next < found.len() {
                let here = found[next].0;
                for (node, is_inlet) in neighbours(here) {
                    if place_of(node).is_some() && !found.iter().any(|(other, _)| *other == node) {
                        found.push((node, Some((here, is_inlet))));
                    }
                }
                next += 1;
            }
        }
        found.reverse();
        let row_of = |node: usize| found.iter().position(|(other, _)| *other == node);
        let zero = R::zero();
        let row = |&(node, parent): &(usize, Option<(usize, bool)>)| Row {
            node,
            place: place_of(node).unwrap_or(0),
            mass: match network.nodes[node].kind {
                NodeKind::Chamber { actuator } => Some(places.actuators[actuator].mass()),
                _ => None,
            },
            link: parent.and_then(|(parent, is_inlet)| Some(Link { parent: row_of(parent)?, is_inlet })),
            answer: zero,
            own: R::one(),
            by_inlet: zero,
            by_mass: zero,
            out: zero,
            out_by_parent: zero,
            parent_by_this: zero,
            per_pivot: R::one(),
            by_parent: zero,
            outflow: zero,
            pressure: zero,
        };
        let rows: Vec<Row<R>> = found.iter().map(row).collect();
        let hangs = |row: usize, on: usize| rows[row].link == Some(Link { parent: on, is_inlet: false });
        let edges = network.branches.iter().zip(&places.branches).map(|(branch, place)| {
            let (from, to) = (row_of(branch.from), row_of(branch.to));
            let child = match (from, to) {
                (Some(from), Some(to)) if hangs(to, from) => Some(to),
                (Some(from), Some(to)) if hangs(from, to) => Some(from),
                _ => None,
            };
            Edge {
                from,
                to,
                child,
                place: *place,
                copies: copies_of(branch),
                slopes: [zero; 2],
                share: zero,
                start: zero,
            }
        });
        let edges = edges.collect();
        Self { rows, edges }
    }

    /// Takes on the numbers of another plant of equal structure.
    #[inline(always)]
    pub(crate) fn adapt(&mut self, network: &Network<R>) {
        for (edge, branch) in self.edges.iter_mut().zip(&network.branches) {
            edge.copies = copies_of(branch);
        }
    }

    /// Sets the numbers of a stage for γh in s.
    #[inline(always)]
    pub(crate) fn factor(
        &mut self,
        network: &Network<R>,
        mode: &impl FlowFormulas<R>,
        gamma_h: R,
        answers: &impl Answers<R>,
    ) {
        let (zero, one) = (R::zero(), R::one());
        for row in &mut self.rows {
            let NodeResponse { per_mass, falls, by_mass } = answers.node(row.node);
            row.by_mass = gamma_h * by_mass;
            let per_mass = per_mass + row.by_mass;
            (row.answer, row.own, row.by_inlet) = (gamma_h * per_mass, one + gamma_h * falls, zero);
            if let NodeKind::Outlet { .. } | NodeKind::Port { .. } = network.nodes[row.node].kind {
                let RegulatedResponse { answer, own, by_inlet } = mode.regulated_response(network, row.node, gamma_h);
                (row.answer, row.own, row.by_inlet) = (answer, own, by_inlet);
            }
            (row.out, row.out_by_parent, row.parent_by_this) = (zero, zero, zero);
        }
        for (branch, edge) in self.edges.iter_mut().enumerate() {
            (edge.slopes, edge.share) = answers.branch(branch);
            let [a, b] = edge.slopes;
            if let Some(from) = edge.from {
                self.rows[from].out = self.rows[from].out + edge.copies * a;
            }
            if let Some(to) = edge.to {
                self.rows[to].out = self.rows[to].out + b;
            }
            // O of `from` falls by copies · b with the pressure of `to`, that of `to` by a with the pressure of `from`.
            if let Some(child) = edge.child {
                let row = &mut self.rows[child];
                let (this, parent) = if edge.to == Some(child) { (a, edge.copies * b) } else { (edge.copies * b, a) };
                row.out_by_parent = row.out_by_parent + this;
                row.parent_by_this = row.parent_by_this + parent;
            }
        }
        for index in 0..self.rows.len() {
            let row = &mut self.rows[index];
            row.per_pivot = one / row.answer.multiply_add(row.out, row.own);
            row.by_parent = row.answer.multiply_add(row.out_by_parent, row.by_inlet) * row.per_pivot;
            if let Some(Link { parent, is_inlet }) = row.link {
                let (by_this, by_parent) = (if is_inlet { row.out } else { -row.parent_by_this }, row.by_parent);
                self.rows[parent].out = by_this.multiply_add(by_parent, self.rows[parent].out);
            }
        }
    }

    /// Writes the slopes of the network's states, which are their right sides before.
    #[inline(always)]
    pub(crate) fn solve(&mut self, gamma_h: R, slopes: &mut [R]) {
        let zero = R::zero();
        for row in &mut self.rows {
            row.outflow = zero;
        }
        for edge in &mut self.edges {
            let Some(place) = edge.place else { continue };
            edge.start = edge.share * slopes[place];
            if let Some(from) = edge.from {
                self.rows[from].outflow = self.rows[from].outflow + edge.start;
            }
            if let Some(to) = edge.to {
                self.rows[to].outflow = self.rows[to].outflow - edge.start;
            }
        }
        for index in 0..self.rows.len() {
            let row = &mut self.rows[index];
            let right = match row.mass {
                Some(mass) => row.by_mass.multiply_add(slopes[mass], slopes[row.place]),
                None => slopes[row.place],
            };
            row.pressure = (right - row.answer * row.outflow) * row.per_pivot;
            if let Some(Link { parent, is_inlet }) = row.link {
                let (outflow, by_pressure) = match is_inlet {
                    true => (row.outflow, row.out * row.pressure),
                    false => (zero, -row.parent_by_this * row.pressure),
                };
                let up = &mut self.rows[parent].outflow;
                *up = *up + outflow + by_pressure;
            }
        }
        for index in (0..self.rows.len()).rev() {
            if let Some(Link { parent, .. }) = self.rows[index].link {
                let of_parent = self.rows[parent].pressure;
                let row = &mut self.rows[index];
                row.pressure = row.by_parent.multiply_add(of_parent, row.pressure);
            }
            let row = &mut self.rows[index];
            slopes[row.place] = row.pressure;
            row.outflow = zero;
        }
        for edge in &self.edges {
            let [a, b] = edge.slopes;
            let mut change = edge.start;
            if let Some(from) = edge.from {
                change = change + a * self.rows[from].pressure;
            }
            if let Some(to) = edge.to {
                change = change - b * self.rows[to].pressure;
            }
            if let Some(place) = edge.place {
                slopes[place] = change;
            }
            if let Some(from) = edge.from {
                self.rows[from].outflow = self.rows[from].outflow + edge.copies * change;
            }
            if let Some(to) = edge.to {
                self.rows[to].outflow = self.rows[to].outflow - change;
            }
        }
        for row in &self.rows {
            if let Some(mass) = row.mass {
                slopes[mass] = slopes[mass] - gamma_h * row.outflow;
            }
        }
    }
}

impl<R: Scalar> Network<R> {
    /// How the flow through a branch answers to the pressures at its ends in kg/(s·Pa), the tangent or the secant where that
    /// is steeper; and the share of its own slope that a cell keeps.
    #[inline(always)]
    pub(crate) fn slopes(
        &self,
        piping: &Piping<R>,
        branch: usize,
        (time, gamma_h): (R, R),
        around: AroundNetwork<'_, R>,
        air: &Air<R>,
        (mode, at): (&impl FlowFormulas<R>, &NetworkState<R>),
    ) -> ([R; 2], R) {
        let (zero, one) = (R::zero(), R::one());
        let Branch { from, to, kind } = &self.branches[branch];
        let (near, far) = (at.nodes[*from].pressure, at.nodes[*to].pressure);
        let [p, q] = [Dual::<R, 2>::variable(near, 0), Dual::variable(far, 1)];
        let flow = match kind {
            BranchKind::Path { .. } | BranchKind::Check { .. } => {
                let Some(orifice) = piping.orifice(branch) else { return ([zero; 2], zero) };
                let (near, far) = (at.nodes[*from].along(p), at.nodes[*to].along(q));
                let densities = Densities { chambers: around.chambers, gas_constant: air.gas_constant() };
                let ends = OrificeEnds { near: &near, far: &far, densities };
                let Some((is_inward, flow)) = mode.orifice(orifice, ends, Dual::of(time)) else {
                    return ([zero; 2], zero);
                };
                Dual::select(is_inward, flow, -flow)
            }
            BranchKind::Loss(hose) => mode.loss(branch, hose, [p, q]),
            BranchKind::Inertia(hose) => {
                if let Some((behind, per_pressure)) = mode.sonic::<R>(self, branch) {
                    return (if behind == *from { [per_pressure, zero] } else { [zero, -per_pressure] }, zero);
                }
                let place = at.flows[branch];
                let drive = gamma_h * hose.per_inertance();
                let share = one / drive.multiply_add(hose.steepest_loss(place, near, far), one);
                return ([drive * share; 2], share);
            }
            BranchKind::Leak(leakage) => {
                let beyond = self.temperature(*to, around.chambers, air);
                let upstream = R::select(near.lt(far), beyond, self.nodes[*from].temperature);
                leakage.between(p, q, Dual::of(air.gas_constant() * upstream))
            }
            BranchKind::Compressor => match &self.nodes[*to].kind {
                NodeKind::Reservoir(reservoir) => {
                    let falls = -reservoir.delivery(q).slope[1];
                    return ([zero, R::select(mode.runs(branch), falls.larger(zero), zero)], zero);
                }
                _ => return ([zero; 2], zero),
            },
        };
        let gap = near - far;
        let secant = R::select(zero.lt(gap.magnitude()), (flow.value / gap).larger(zero), zero);
        let [by_near, by_far] = flow.slope;
        ([by_near.larger(secant), (-by_far).larger(secant)], zero)
    }
}
