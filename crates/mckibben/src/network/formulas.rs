//! Which formulas of a network hold, as its [flows](super::flow) need them.

use super::flow::{NetworkState, OrificeEnds, SquaredDrive};
use super::implicit::RegulatedResponse;
use super::mode::NetworkMode;
use super::piping::Orifice;
use super::{BranchKind, Network, NodeKind};
use crate::line::{Hose, Poppet};
use crate::scalar::{Over, Real, Scalar};
use crate::valve::Approach;

/// The discrete state of a network as its flows need it.
pub trait FlowFormulas<S: Scalar> {
    /// Flow in kg/s through an orifice at a time in s, zero or more, and whether it goes from its first node to its second;
    /// none where it is shut.
    fn orifice<T: Over<S>>(
        &self,
        orifice: &Orifice<S>,
        ends: OrificeEnds<'_, T, impl SquaredDrive<T>>,
        time: T,
    ) -> Option<(S::Mask, T)>;

    /// Whether a poppet, or a pressure beyond a valve, is on its way at a time in s.
    fn is_under_way(&self, time: S) -> S::Mask;

    /// Flow in kg/s through a lumped hose between two pressures in Pa.
    fn loss<T: Over<S>>(&self, branch: usize, hose: &Hose<S>, pressure: [T; 2]) -> T;

    /// Whether a compressor runs.
    fn runs(&self, branch: usize) -> S::Mask;

    /// The rate in Pa/s of the pressure of a regulator's outlet, of a regulated port, or of a node where it is given.
    fn set_rate<T: Over<S>>(&self, network: &Network<S>, node: usize, at: &NetworkState<T>) -> T;

    /// How the pressure of a regulator's outlet or of a regulated port answers within a stage for γh in s.
    fn regulated_response(&self, network: &Network<S>, node: usize, gamma_h: S) -> RegulatedResponse<S>;

    /// The node behind a flow that goes at the speed of sound, and that flow in kg/s over its pressure in Pa.
    fn sonic<T: Over<S>>(&self, network: &Network<S>, branch: usize) -> Option<(usize, T)>;
}

impl<R: Real> FlowFormulas<R> for NetworkMode<R> {
    #[inline(always)]
    fn orifice<T: Over<R>>(
        &self,
        orifice: &Orifice<R>,
        ends: OrificeEnds<'_, T, impl SquaredDrive<T>>,
        time: T,
    ) -> Option<(bool, T)> {
        let zone = self.branches[orifice.branch].zone?;
        // A piece of an orifice's law says which way its air goes, also a little beyond its ends.
        let is_inward = zone.is_inward();
        let mut flow = T::of(orifice.law.conductance());
        flow = flow * ends.drive(orifice, is_inward);
        flow = flow * orifice.law.in_zone(zone, || ends.gap(is_inward));
        if let Some((valve, port)) = orifice.opened
            && let Some(shares) = self.valves[valve].openings.at(time)
        {
            flow = flow * shares[port as usize];
        }
        Some((is_inward, flow))
    }

    fn is_under_way(&self, time: R) -> bool {
        self.valves.iter().any(|valve| valve.openings.at(time).is_some())
    }

    #[inline(always)]
    fn loss<T: Over<R>>(&self, branch: usize, hose: &Hose<R>, [near, far]: [T; 2]) -> T {
        hose.tube().flow_in(self.branches[branch].regime, near, far)
    }

    #[inline(always)]
    fn runs(&self, branch: usize) -> bool {
        self.branches[branch].runs
    }

    fn set_rate<T: Over<R>>(&self, network: &Network<R>, node: usize, at: &NetworkState<T>) -> T {
        let its = &self.nodes[node];
        match &network.nodes[node].kind {
            NodeKind::Outlet { regulator, .. } => network
                .outlet_error(node, its.limited, at)
                .map_or(T::zero(), |error| regulator.pressure_rate(error, its.poppet)),
            NodeKind::Port { regulator, .. } => match (its.approach, network.set_point(node, self)) {
                (Some(approach), Some(set)) => regulator.rate_in(approach, at.nodes[node].pressure, T::of(set)),
                _ => T::zero(),
            },
            NodeKind::Given { .. } => {
                T::of(network.given(node, R::zero(), its.rows_passed).map_or(R::zero(), |[_, rate]| rate))
            }
            _ => T::zero(),
        }
    }

    fn regulated_response(&self, network: &Network<R>, node: usize, gamma_h: R) -> RegulatedResponse<R> {
        let (zero, one, its) = (R::zero(), R::one(), &self.nodes[node]);
        match &network.nodes[node].kind {
            NodeKind::Outlet { regulator, .. } if its.poppet != Poppet::Rests => {
                let rate = gamma_h / regulator.lag();
                let (answer, by_inlet) = if its.limited { (zero, rate) } else { (rate * regulator.droop(), zero) };
                RegulatedResponse { answer, own: one + rate, by_inlet }
            }
            NodeKind::Port { regulator, .. } if its.approach == Some(Approach::Settles) => {
                let own = one - gamma_h * regulator.rate_in(Approach::Settles, one, zero);
                RegulatedResponse { answer: zero, own, by_inlet: zero }
            }
            _ => RegulatedResponse { answer: zero, own: one, by_inlet: zero },
        }
    }

    #[inline(always)]
    fn sonic<T: Over<R>>(&self, network: &Network<R>, branch: usize) -> Option<(usize, T)> {
        let forwards = self.branches[branch].sonic?;
        debug_assert!(matches!(network.branches[branch].kind, BranchKind::Inertia(_)), "it is a cell of a hose");
        network.sonic(branch, forwards)
    }
}
