//! Which formulas of a network hold in several plants side by side, as masks.

use crate::wide::Wide;
use mckibben::internals::{
    Approach, FlowFormulas, NetworkMode, NetworkState, Orifice, OrificeEnds, RegulatedResponse, SquaredDrive,
};
use mckibben::line::{Hose, Poppet};
use mckibben::network::{BranchKind, Network, NodeKind};
use mckibben::scalar::{Mask, Over, Scalar};

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

/// Which branches are open, of compressors which run, and what regulators do.
#[derive(Clone, Debug)]
pub(crate) struct HeldFlows<W: Scalar> {
    open: Vec<W::Mask>,
    open_flags: Vec<W>,
    nodes: Vec<HeldNode<W>>,
}

impl<W: Wide> HeldFlows<W> {
    /// Of a network, before any lane is entered.
    #[inline(always)]
    pub(crate) fn new(network: &Network<W>) -> Self {
        let (no, zero) = (W::Mask::splat(false), W::zero());
        let node =
            HeldNode { moves: no, limited: no, direction: zero, set: zero, moves_flag: zero, limited_flag: zero };
        Self {
            open: vec![no; network.branches.len()],
            open_flags: vec![zero; network.branches.len()],
            nodes: vec![node; network.nodes.len()],
        }
    }

    /// Enters the mode of the row in a lane; [`HeldFlows::update`] makes masks of it.
    pub(crate) fn enter(&mut self, lane: usize, network: &Network<W::Lane>, mode: &NetworkMode<W::Lane>) {
        for (index, flag) in self.open_flags.iter_mut().enumerate() {
            let rests = matches!(network.branches[index].kind, BranchKind::Compressor) && !mode.branches[index].runs;
            flag.mark(lane, network.is_open(index, mode) && !rests);
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
            held.direction.put(lane, W::Lane::constant(direction));
            held.set.put(lane, network.set_point(index, mode).unwrap_or(W::Lane::constant(0.0)));
        }
    }

    /// Makes masks of what has been entered.
    #[inline(always)]
    pub(crate) fn update(&mut self) {
        let zero = W::zero();
        for (mask, flag) in self.open.iter_mut().zip(&self.open_flags) {
            *mask = zero.lt(*flag);
        }
        for node in &mut self.nodes {
            (node.moves, node.limited) = (zero.lt(node.moves_flag), zero.lt(node.limited_flag));
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
        _: T,
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
        Some((is_inward, T::select(open, flow, T::zero())))
    }

    #[inline(always)]
    fn is_under_way(&self, _: W) -> bool {
        false
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
