//! Which formulas of a network hold in several plants side by side, as masks.

use crate::wide::Wide;
use mckibben::internals::{
    Approach, FlowFormulas, NetworkMode, NetworkState, Orifice, OrificeEnds, RegulatedResponse, SquaredDrive,
    StraightLine,
};
use mckibben::line::{Hose, Poppet};
use mckibben::network::{BranchKind, Network, NodeKind};
use mckibben::scalar::{Mask, Over, Scalar};
use mckibben::valve::{Openings, Spool, SpoolMotion, Stroke, ValveKind};

/// Of a regulator's outlet or a regulated port in every lane.
#[derive(Clone, Copy, Debug)]
struct HeldNode<W: Scalar> {
    /// Where the poppet of an outlet moves, or where a port settles within the limit of its rate.
    moves: W::Mask,
    /// Where the inlet of an outlet limits it.
    limited: W::Mask,
    /// Of a poppet, or of a port at the limit of its rate: −1, 0 or +1.
    direction: W,
    /// What a port goes to, in Pa.
    set: W,
    moves_flag: W,
    limited_flag: W,
}

/// How far the flow paths of a valve are open in every lane.
#[derive(Clone, Copy, Debug)]
struct HeldValve<W: Scalar> {
    kind: ValveKind,
    spool: Option<Spool<W>>,
    strokes: [Stroke<W>; 2],
    motion: SpoolMotion<W>,
    /// Where nothing moves: the shares that stay, 1 of paths that are wholly open or shut.
    shares: [W; 2],
    moves: W::Mask,
    moves_flag: W,
    /// Whether it moves in any lane, and whether it has shares in any.
    moves_in_any: bool,
    is_partial: bool,
    partial_flag: W,
}

impl<W: Wide> HeldValve<W> {
    /// Whole flow paths.
    #[inline(always)]
    fn new(kind: ValveKind, spool: Option<Spool<W>>) -> Self {
        let (zero, one) = (W::zero(), W::one());
        Self {
            kind,
            spool,
            strokes: [Stroke { start: zero, end: zero, from: one, to: one }; 2],
            motion: SpoolMotion { time: zero, position: zero, velocity: zero, command: zero },
            shares: [one; 2],
            moves: W::Mask::splat(false),
            moves_flag: zero,
            moves_in_any: false,
            is_partial: false,
            partial_flag: zero,
        }
    }

    fn enter(&mut self, lane: usize, openings: &Openings, origin: f64) {
        let mut shares = [1.0; 2];
        match openings {
            Openings::Whole => {}
            Openings::Shares(its) => shares = *its,
            Openings::Poppets { strokes, .. } => {
                for (of_lanes, its) in self.strokes.iter_mut().zip(strokes) {
                    of_lanes.start.put(lane, its.start - origin);
                    of_lanes.end.put(lane, its.end - origin);
                    of_lanes.from.put(lane, its.from);
                    of_lanes.to.put(lane, its.to);
                }
            }
            Openings::Spool { motion, .. } => {
                self.motion.time.put(lane, motion.time - origin);
                self.motion.position.put(lane, motion.position);
                self.motion.velocity.put(lane, motion.velocity);
                self.motion.command.put(lane, motion.command);
            }
        }
        for (of_lanes, its) in self.shares.iter_mut().zip(shares) {
            of_lanes.put(lane, its);
        }
        self.moves_flag.mark(lane, matches!(openings, Openings::Poppets { .. } | Openings::Spool { .. }));
        self.partial_flag.mark(lane, !matches!(openings, Openings::Whole));
    }

    #[inline(always)]
    fn update(&mut self) {
        self.moves = W::zero().lt(self.moves_flag);
        (self.moves_in_any, self.is_partial) = (self.moves.any(), W::zero().lt(self.partial_flag).any());
    }

    /// The share of a flow path at a time in s; none where all are whole.
    #[inline(always)]
    fn share<T: Over<W>>(&self, port: usize, time: T) -> Option<T> {
        if !self.is_partial {
            return None;
        }
        let stays = T::of(self.shares[port]);
        if !self.moves_in_any {
            return Some(stays);
        }
        let moving = match &self.spool {
            Some(spool) => spool.openings(spool.at(&self.motion, time)[0]),
            None => self.kind.shares([self.strokes[0].opening(time), self.strokes[1].opening(time)]),
        };
        Some(T::select(self.moves, moving[port], stays))
    }
}

/// Enters a straight line in a lane, whose times are counted from an origin in s.
pub(crate) fn enter_line<W: Wide>(lane: usize, line: &mut StraightLine<W>, its: &StraightLine, origin: f64) {
    line.start.put(lane, its.start - origin);
    line.from.put(lane, its.from);
    line.slope.put(lane, its.slope);
}

/// Which branches are open, of compressors which run, how far valves are open, and what regulators do.
#[derive(Clone, Debug)]
pub(crate) struct HeldFlows<W: Scalar> {
    open: Vec<W::Mask>,
    open_flags: Vec<W>,
    nodes: Vec<HeldNode<W>>,
    valves: Vec<HeldValve<W>>,
    is_partial: bool,
    /// Of nodes whose pressure is given: the line of gauge pressures, and how much later in s they are there.
    given: Vec<Option<(StraightLine<W>, W)>>,
}

impl<W: Wide> HeldFlows<W> {
    /// Of a network, before any lane is entered.
    #[inline(always)]
    pub(crate) fn new(network: &Network<W>) -> Self {
        let (no, zero) = (W::Mask::splat(false), W::zero());
        let node =
            HeldNode { moves: no, limited: no, direction: zero, set: zero, moves_flag: zero, limited_flag: zero };
        let mut valves = Vec::with_capacity(network.valves.len());
        for valve in &network.valves {
            valves.push(HeldValve::new(valve.solenoid.kind(), valve.solenoid.spool().copied()));
        }
        let mut given = Vec::with_capacity(network.nodes.len());
        for node in &network.nodes {
            given.push(match node.kind {
                NodeKind::Given { .. } => Some((StraightLine::constant(zero), zero)),
                _ => None,
            });
        }
        Self {
            open: vec![no; network.branches.len()],
            open_flags: vec![zero; network.branches.len()],
            nodes: vec![node; network.nodes.len()],
            valves,
            is_partial: false,
            given,
        }
    }

    /// Enters the mode of the row in a lane, whose times are counted from an origin in s; [`HeldFlows::update`] makes masks of it.
    pub(crate) fn enter(&mut self, lane: usize, network: &Network, mode: &NetworkMode<f64>, origin: f64) {
        for (index, flag) in self.open_flags.iter_mut().enumerate() {
            let rests = matches!(network.branches[index].kind, BranchKind::Compressor) && !mode.branches[index].runs;
            flag.mark(lane, network.is_open(index, mode) && !rests);
        }
        for (held, its) in self.valves.iter_mut().zip(&mode.valves) {
            held.enter(lane, &its.openings, origin);
        }
        for (node, held) in self.given.iter_mut().enumerate() {
            if let Some((line, late)) = held
                && let Some((its, by)) = network.given_line(node, mode.nodes[node].rows_passed)
            {
                enter_line(lane, line, &its, origin);
                late.put(lane, by);
            }
        }
        for (index, (held, its)) in self.nodes.iter_mut().zip(&mode.nodes).enumerate() {
            let (moves, direction) = match network.nodes[index].kind {
                NodeKind::Outlet { .. } => (its.poppet != Poppet::Rests, its.poppet.direction()),
                NodeKind::Port { .. } => match its.approach {
                    Some(Approach::Settles) => (true, 0.0),
                    Some(Approach::Rises) => (false, 1.0),
                    Some(Approach::Falls) => (false, -1.0),
                    None => (false, 0.0),
                },
                _ => continue,
            };
            held.moves_flag.mark(lane, moves);
            held.limited_flag.mark(lane, its.limited);
            held.direction.put(lane, direction);
            held.set.put(lane, network.set_point(index, mode).unwrap_or(0.0));
        }
    }

    /// Makes masks of what has been entered.
    #[inline(always)]
    pub(crate) fn update(&mut self) {
        let zero = W::zero();
        for (mask, flag) in self.open.iter_mut().zip(&self.open_flags) {
            *mask = zero.lt(*flag);
        }
        self.is_partial = false;
        for valve in &mut self.valves {
            valve.update();
            self.is_partial |= valve.is_partial;
        }
        for node in &mut self.nodes {
            (node.moves, node.limited) = (zero.lt(node.moves_flag), zero.lt(node.limited_flag));
        }
    }

    /// The absolute pressure in Pa of a node where it is given, and its rate in Pa/s, at a time in s.
    #[inline(always)]
    pub(crate) fn given(&self, network: &Network<W>, node: usize, time: W) -> Option<[W; 2]> {
        match &self.given[node] {
            Some((line, late)) => {
                let [gauge, rate] = line.at(time - *late);
                Some([network.absolute(gauge), rate])
            }
            None => None,
        }
    }

    /// Where the inlet of a regulator's outlet limits it.
    #[inline(always)]
    pub(crate) fn is_limited(&self, node: usize) -> W::Mask {
        self.nodes[node].limited
    }
}

impl<W: Wide> FlowFormulas<W> for HeldFlows<W> {
    #[inline(always)]
    fn orifice<T: Over<W>>(
        &self,
        orifice: &Orifice<W>,
        ends: OrificeEnds<'_, T, impl SquaredDrive<T>>,
        time: T,
    ) -> Option<(W::Mask, T)> {
        let mut open = self.open[orifice.branch];
        if !open.any() {
            return None;
        }
        let [near, far] = ends.pressures();
        if orifice.opened.is_none() {
            // A check valve lets nothing back.
            open = open & far.le(near);
        }
        let (critical, laminar) = (T::of(orifice.law.critical_ratio()), T::of(orifice.law.laminar_ratio()));
        let is_inward = far.le(near);
        // No closures: they would be compiled separately, without the instructions of a batch.
        let flow = if !(!is_inward).any() {
            ends.inwards(orifice, [critical, laminar])
        } else if is_inward.any() {
            let flows = [ends.inwards(orifice, [critical, laminar]), ends.outwards(orifice, [critical, laminar])];
            T::select(is_inward, flows[0], flows[1])
        } else {
            ends.outwards(orifice, [critical, laminar])
        };
        let flow = match orifice.opened {
            Some((valve, port)) => match self.valves[valve].share(port as usize, time) {
                Some(share) => flow * share,
                None => flow,
            },
            None => flow,
        };
        Some((is_inward, T::select(open, flow, T::zero())))
    }

    #[inline(always)]
    fn is_under_way(&self, _: W) -> W::Mask {
        let mut under_way = W::Mask::splat(false);
        if self.is_partial {
            for valve in &self.valves {
                under_way = under_way | W::zero().lt(valve.partial_flag);
            }
        }
        under_way
    }

    #[inline(always)]
    fn loss<T: Over<W>>(&self, _: usize, hose: &Hose<W>, [near, far]: [T; 2]) -> T {
        hose.tube().flow_in_lanes(near, far)
    }

    #[inline(always)]
    fn runs(&self, branch: usize) -> W::Mask {
        self.open[branch]
    }

    #[inline(always)]
    fn set_rate<T: Over<W>>(&self, network: &Network<W>, node: usize, at: &NetworkState<T>) -> T {
        let (zero, held) = (T::zero(), &self.nodes[node]);
        match &network.nodes[node].kind {
            NodeKind::Outlet { regulator, .. } => match network.outlet_error(node, held.limited, at) {
                Some(error) => {
                    let beyond = error - T::of(regulator.dead_band()) * T::of(held.direction);
                    T::select(held.moves, beyond / T::of(regulator.lag()), zero)
                }
                None => zero,
            },
            NodeKind::Port { regulator, .. } => {
                let settles = regulator.rate_in(Approach::Settles, at.nodes[node].pressure, T::of(held.set));
                let limit: T = regulator.rate_in(Approach::Rises, zero, zero);
                T::select(held.moves, settles, limit * T::of(held.direction))
            }
            NodeKind::Given { .. } => match &self.given[node] {
                Some((line, _)) => T::of(line.slope),
                None => zero,
            },
            _ => zero,
        }
    }

    #[inline(always)]
    fn regulated_response(&self, network: &Network<W>, node: usize, gamma_h: W) -> RegulatedResponse<W> {
        let (zero, one, held) = (W::zero(), W::one(), &self.nodes[node]);
        match &network.nodes[node].kind {
            NodeKind::Outlet { regulator, .. } => {
                let rate = gamma_h / regulator.lag();
                let moves = W::select(held.moves, rate, zero);
                RegulatedResponse {
                    answer: W::select(held.limited, zero, moves * regulator.droop()),
                    own: one + moves,
                    by_inlet: W::select(held.limited, moves, zero),
                }
            }
            NodeKind::Port { regulator, .. } => {
                let own = one - gamma_h * regulator.rate_in(Approach::Settles, one, zero);
                RegulatedResponse { answer: zero, own: W::select(held.moves, own, one), by_inlet: zero }
            }
            _ => RegulatedResponse { answer: zero, own: one, by_inlet: zero },
        }
    }

    // What lanes do not cover.

    fn sonic<T: Over<W>>(&self, _: &Network<W>, _: usize) -> Option<(usize, T)> {
        None
    }
}
