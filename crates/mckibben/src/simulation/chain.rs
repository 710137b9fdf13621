//! The linear system of a stable step with an air line: from the supply to the actuator one after the other.
//!
//! With `δ` for the change of a flow over a step's reach `r = γh`, and k for the slopes that are looked for, the rows of
//! `(I − rA) k = f` are
//!
//! ```text
//! reservoir    k_r (1 + r q χ_r) = f_r − r χ_r N δ_s                                    q: the compressor's delivery falls
//! regulator    k_s (1 + r/τ)     = f_s + r/τ (k_r  or  −D N δ_s)                        which of the two limits the outlet
//! valve        δ_s = u k_feed − s_in k_1          δ = δ_s − s_out k_1                   k_feed: k_s, k_r or 0
//! hose         k_i = f_i + r χ (δ_{i−1} − δ_i)                                          δ_0 = δ
//!              δ_i = y_i + σ_i (k_i − k_{i+1})                                          k_{n+1} = k_P
//! actuator     k_P (1 + r (b l + o)) = f_P + r b δ_n    k_m = f_m + r (δ_n − l k_P)     l: the leak, o: as it grows
//! ```
//!
//! Behind each flow lies a pressure that answers to it by a straight line, `k = offset + gain δ`, from the actuator
//! backwards; so every row is solved once, and n cells cost n times one. All slopes are zero or more, and so are the gains:
//! no division can fail, and a flow moves no pressure beyond another.
//!
//! What one row gives the next one gets, whatever the slopes: tank, hose and actuator keep their air to rounding.

use super::kernel::Matrix;
use super::piped::{OUTLET, RESERVOIR, Stepped, flow, of_rig, volume};
use crate::scalar::Scalar;

/// How the flows of a line answer to pressures, all in kg/(s·Pa) and zero or more.
pub(super) struct Valve<S> {
    /// s_out: by what the valve opens into, towards the surroundings or a constant supply.
    pub(super) outwards: S,
    /// s_in: by what the valve opens into, towards a supply that changes.
    pub(super) inwards: S,
    /// u: by that supply.
    pub(super) feed: S,
}

/// A hose's part, of at most `C` cells.
pub(super) struct Cells<S, const C: usize> {
    pub(super) count: usize,
    /// r χ in Pa·s/kg.
    pub(super) stiffness: S,
    /// σ of each flow.
    pub(super) lead: [S; C],
    /// By what each flow's own slope counts in `y = f · share`.
    pub(super) share: [S; C],
    /// Whether the flows are states: without inertia they are not, and y is zero.
    pub(super) inertia: bool,
}

/// A supply's part.
pub(super) struct Source<S> {
    /// r χ_r N and 1/(1 + r q χ_r), zero where there is no reservoir.
    pub(super) reservoir: [S; 2],
    /// The part of a regulator.
    pub(super) regulator: Option<Outlet<S>>,
}

/// A regulator's part.
pub(super) struct Outlet<S> {
    /// r/τ, zero where the poppet rests.
    pub(super) rate: S,
    /// D N, zero where the reservoir's pressure limits the outlet.
    pub(super) droop: S,
    /// One where it does.
    pub(super) limited: S,
}

/// The actuator's part.
pub(super) struct End<S> {
    /// r in s.
    pub(super) reach: S,
    /// b in Pa/kg.
    pub(super) per_flow: S,
    /// l.
    pub(super) leak: S,
    /// The rate o in 1/s at which the pressure falls without any flow.
    pub(super) falls: S,
}

/// All of it, with what does not depend on the right side.
pub(super) struct Chain<S, const C: usize> {
    rig: Matrix<S>,
    end: End<S>,
    per_end: S,
    cells: Option<Cells<S, C>>,
    /// The gain behind each flow.
    behind: [S; C],
    /// What each flow is divided by, and each pressure before it.
    per_flow: [S; C],
    per_volume: [S; C],
    valve: Valve<S>,
    /// The gain of what the valve opens into, and by what the flow outwards lessens it.
    gain: S,
    per_outwards: S,
    source: Option<Source<S>>,
    /// By how much the feed gives way to what is drawn, and what the flow from it is divided by.
    gives: S,
    per_drawn: S,
}

impl<S: Scalar, const C: usize> Chain<S, C> {
    #[inline(always)]
    pub(super) fn new(
        rig: Matrix<S>,
        end: End<S>,
        cells: Option<Cells<S, C>>,
        valve: Valve<S>,
        source: Option<Source<S>>,
    ) -> Self {
        let (zero, one) = (S::zero(), S::one());
        let [mut behind, mut per_flow, mut per_volume] = [[zero; C]; 3];
        let into = end.reach * end.per_flow;
        let per_end = one / (into.multiply_add(end.leak, one) + end.reach * end.falls);
        let mut gain = into * per_end;
        if let Some(cells) = &cells {
            for cell in (0..cells.count).rev() {
                // 1/d and 1/(1 + rχ σ/d) by one division.
                let divisor = gain.multiply_add(cells.lead[cell], one);
                let both = cells.stiffness.multiply_add(cells.lead[cell], divisor);
                let inverse = one / (divisor * both);
                behind[cell] = gain;
                per_flow[cell] = both * inverse;
                per_volume[cell] = divisor * divisor * inverse;
                gain = cells.stiffness * per_volume[cell];
            }
        }
        let per_outwards = one / gain.multiply_add(valve.outwards, one);
        let gain = gain * per_outwards;
        let (mut gives, mut per_drawn) = (zero, one);
        if let Some(source) = &source {
            gives = source.reservoir[0] * source.reservoir[1];
            if let Some(outlet) = &source.regulator {
                gives = outlet.rate * (outlet.limited * gives + outlet.droop) / (one + outlet.rate);
            }
            per_drawn = one / (one + valve.feed * gives + valve.inwards * gain);
        }
        Self {
            rig,
            end,
            per_end,
            cells,
            behind,
            per_flow,
            per_volume,
            valve,
            gain,
            per_outwards,
            source,
            gives,
            per_drawn,
        }
    }

    /// The slopes that have `right` for their right side.
    #[inline(always)]
    pub(super) fn solve<const N: usize>(&self, right: &Stepped<S, N>) -> Stepped<S, N> {
        let (zero, one) = (S::zero(), S::one());
        let mut slopes = *right;
        [slopes[0], slopes[1], ..] = self.rig.solve(of_rig(right));

        let (mut behind, mut starts) = ([zero; C], [zero; C]);
        let mut offset = right[2] * self.per_end;
        if let Some(cells) = &self.cells {
            for cell in (0..cells.count).rev() {
                behind[cell] = offset;
                let own = if cells.inertia { right[flow(cell)] * cells.share[cell] } else { zero };
                starts[cell] = (own - cells.lead[cell] * offset) * self.per_flow[cell];
                offset = (right[volume(cell)] - cells.stiffness * starts[cell]) * self.per_volume[cell];
            }
        }
        offset = offset * self.per_outwards;

        let mut drawn = zero;
        if let Some(source) = &self.source {
            let reservoir = right[RESERVOIR] * source.reservoir[1];
            let feed = match &source.regulator {
                None => reservoir,
                Some(outlet) => (right[OUTLET] + outlet.rate * outlet.limited * reservoir) / (one + outlet.rate),
            };
            drawn = (self.valve.feed * feed - self.valve.inwards * offset) * self.per_drawn;
            slopes[RESERVOIR] = reservoir - source.reservoir[0] * source.reservoir[1] * drawn;
            if source.regulator.is_some() {
                slopes[OUTLET] = feed - self.gives * drawn;
            }
        }

        let mut pressure = self.gain.multiply_add(drawn, offset);
        let mut last = drawn - self.valve.outwards * pressure;
        if let Some(cells) = &self.cells {
            for cell in 0..cells.count {
                slopes[volume(cell)] = pressure;
                last = pressure.multiply_add(cells.lead[cell] * self.per_flow[cell], starts[cell]);
                if cells.inertia {
                    slopes[flow(cell)] = last;
                }
                pressure = self.behind[cell].multiply_add(last, behind[cell]);
            }
        }
        slopes[2] = pressure;
        slopes[3] = right[3] + self.end.reach * (last - self.end.leak * pressure);
        slopes
    }
}
