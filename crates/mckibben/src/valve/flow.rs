//! Mass flow of a gas through a passage: the paper's orifice and ISO 6358.
//!
//! ```text
//! ṁ = G P_up/√T_up · ψ(r)          r = P_down/P_up
//!
//! orifice (21)(23)   G = η A_p C_q √(γ/R · (2/(γ+1))^((γ+1)/(γ−1)))      r_c = (2/(γ+1))^(γ/(γ−1))
//!                    ψ = √(2/(γ−1) · (r^(2/γ) − r^((γ+1)/γ)) / (2/(γ+1))^((γ+1)/(γ−1)))
//! ISO 6358-1         G = η C ρ₀ √T₀                                      r_c = b
//!                    ψ = √(1 − ((r − b)/(1 − b))²)
//!
//! choked, r ≤ r_c    ψ = 1
//! r > r_lam          ψ = ψ(r_lam) (1 − r)/(1 − r_lam)
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | G | `conductance` | kg·√K/(s·Pa) |
//! | ψ | `ratio_function` | –, 1 when choked |
//! | r_c, r_lam | `critical_ratio`, `laminar_ratio` | – |
//! | A_p C_q, η | `flow_area`, `efficiency` | m², – |
//! | C, b | `sonic_conductance`, `critical_ratio` | m³/(s·Pa), – |
//! | ρ₀, T₀ | reference atmosphere, ISO 8778: 1.185 kg/m³, 293.15 K | |
//!
//! Both forms of ψ are `√(1−r)·g(r)` with g analytic on `[r_c, 1]`, so g is a polynomial fitted when the law is made:
//! no power is left in the loop, and the difference of two nearly equal powers near r = 1 is gone with it. The largest
//! error against the textbook form in extended precision is a few units in the last place.
//!
//! The slope of either law is infinite at r = 1; the straight line above `r_lam` is the usual cure.
//! `r_c` is used as it is (0.52828 for air), not rounded to 0.528, so that the law is continuous.
//! Source: Colbrunn, Nelson & Quinn (2001), section 3.2, after McCloy & Martin (1980); ISO 6358-1:2013.
//! Checked by `tests/valve.rs`: transcription of (23), both limits, continuity and slope, reverse flow.

use crate::air::Air;
use crate::error::{Error, Requirement};
use crate::parameter::{self, Parameter};
use crate::scalar::{Over, Real, Scalar};
use core::f64::consts::PI;

/// Terms of the polynomial g: beyond this the next Chebyshev coefficient is below the rounding of `f64` for every γ.
const TERMS: usize = 20;
/// Density of the reference atmosphere in kg/m³ (ISO 8778).
pub const REFERENCE_DENSITY: f64 = 1.185;
/// Temperature of the reference atmosphere in K (ISO 8778).
const REFERENCE_TEMPERATURE: f64 = 293.15;

/// The two usual ways to state the size of a passage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FlowStandard<S = f64> {
    /// The paper's orifice (21)(23).
    Orifice {
        /// Effective area `A_p C_q` in m².
        flow_area: S,
    },
    /// ISO 6358-1.
    Iso6358 {
        /// Sonic conductance C in m³/(s·Pa) at the reference atmosphere.
        sonic_conductance: S,
        /// Critical back-pressure ratio b.
        critical_ratio: S,
    },
}

/// One of the pieces of the flow law on one side of equal pressure, in order of rising pressure in the actuator.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FlowZone {
    /// Inflow at the speed of sound.
    ChokedIn,
    /// Inflow slower than sound.
    SubsonicIn,
    /// Inflow on the straight line near equal pressure.
    LaminarIn,
    /// Outflow on the straight line near equal pressure.
    LaminarOut,
    /// Outflow slower than sound.
    SubsonicOut,
    /// Outflow at the speed of sound.
    ChokedOut,
}

impl FlowZone {
    /// All zones in order of rising pressure in the actuator.
    pub const RISING: [Self; 6] =
        [Self::ChokedIn, Self::SubsonicIn, Self::LaminarIn, Self::LaminarOut, Self::SubsonicOut, Self::ChokedOut];

    /// Whether air flows into the actuator.
    #[inline(always)]
    pub fn is_inward(self) -> bool {
        self <= Self::LaminarIn
    }
}

/// Mass flow through an open passage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowLaw<S = f64> {
    standard: FlowStandard<S>,
    efficiency: S,
    heat_capacity_ratio: S,
    gas_constant: S,
    laminar_ratio: S,
    critical_ratio: S,
    conductance: S,
    /// Slope of the straight line, `ψ(r_lam)/(1 − r_lam)`.
    laminar_slope: S,
    /// `t = scale·r + offset` maps `[r_c, 1]` to `[−1, 1]`.
    scale: S,
    offset: S,
    /// Coefficients of g in rising powers of t.
    polynomial: [S; TERMS],
}

impl FlowLaw {
    /// A passage for the gas of `air`, with a factor `efficiency` on its flow and a straight line above `laminar_ratio`.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number outside its range; [`Error::Inconsistent`] when the straight line would begin
    /// below the critical ratio.
    pub fn new(standard: FlowStandard, efficiency: f64, laminar_ratio: f64, air: &Air) -> Result<Self, Error> {
        match standard {
            FlowStandard::Orifice { flow_area } => drop(parameter::FLOW_AREA.check(flow_area)?),
            FlowStandard::Iso6358 { sonic_conductance, critical_ratio } => {
                parameter::SONIC_CONDUCTANCE.check(sonic_conductance)?;
                parameter::CRITICAL_RATIO.check(critical_ratio)?;
            }
        }
        let law = Self::assemble(
            standard,
            parameter::EFFICIENCY.check(efficiency)?,
            air.heat_capacity_ratio(),
            air.gas_constant(),
            parameter::LAMINAR_RATIO.check(laminar_ratio)?,
        );
        if laminar_ratio <= law.critical_ratio {
            return Err(Error::Inconsistent {
                parameter: &parameter::LAMINAR_RATIO,
                value: laminar_ratio,
                requirement: Requirement {
                    relation: "must be greater than",
                    other: "the critical ratio",
                    value: law.critical_ratio,
                    unit: "",
                },
                remedy: "give a ratio just below 1, such as 0.999",
            });
        }
        Ok(law)
    }
}

impl<S: Scalar> FlowLaw<S> {
    fn assemble(
        standard: FlowStandard<S>,
        efficiency: S,
        heat_capacity_ratio: S,
        gas_constant: S,
        laminar_ratio: S,
    ) -> Self {
        let (one, two, gamma) = (S::one(), S::constant(2.0), heat_capacity_ratio);
        let base = two / (gamma + one);
        let choked = base.power((gamma + one) / (gamma - one));
        let (critical_ratio, conductance) = match standard {
            FlowStandard::Orifice { flow_area } => {
                (base.power(gamma / (gamma - one)), flow_area * (gamma / gas_constant * choked).sqrt())
            }
            FlowStandard::Iso6358 { sonic_conductance, critical_ratio } => (
                critical_ratio,
                sonic_conductance * S::constant(REFERENCE_DENSITY) * S::constant(REFERENCE_TEMPERATURE).sqrt(),
            ),
        };
        // g² = ψ²/(1 − r), written so that nothing cancels as r → 1.
        let g = |r: S| match standard {
            FlowStandard::Orifice { .. } => {
                let u = r.ln();
                let powers = (two * u / gamma).exp() * ((gamma - one) / gamma * u).exp_m1() / u.exp_m1();
                (two / (gamma - one) * powers / choked).sqrt()
            }
            FlowStandard::Iso6358 { critical_ratio: b, .. } => (one + r - two * b).sqrt() / (one - b),
        };
        let half = (one - critical_ratio) / two;
        let middle = (one + critical_ratio) / two;
        let mut law = Self {
            standard,
            efficiency,
            heat_capacity_ratio,
            gas_constant,
            laminar_ratio,
            critical_ratio,
            conductance: efficiency * conductance,
            laminar_slope: S::zero(),
            scale: one / half,
            offset: -middle / half,
            polynomial: chebyshev_fit(|t| g(middle + half * S::constant(t))),
        };
        law.laminar_slope = law.subsonic(laminar_ratio) / (one - laminar_ratio);
        law
    }

    /// The same law over another scalar.
    pub fn map<T: Scalar>(&self, mut convert: impl FnMut(&'static Parameter, S) -> T) -> FlowLaw<T> {
        let standard = match self.standard {
            FlowStandard::Orifice { flow_area } => {
                FlowStandard::Orifice { flow_area: convert(&parameter::FLOW_AREA, flow_area) }
            }
            FlowStandard::Iso6358 { sonic_conductance, critical_ratio } => FlowStandard::Iso6358 {
                sonic_conductance: convert(&parameter::SONIC_CONDUCTANCE, sonic_conductance),
                critical_ratio: convert(&parameter::CRITICAL_RATIO, critical_ratio),
            },
        };
        FlowLaw::assemble(
            standard,
            convert(&parameter::EFFICIENCY, self.efficiency),
            convert(&parameter::HEAT_CAPACITY_RATIO, self.heat_capacity_ratio),
            convert(&parameter::GAS_CONSTANT, self.gas_constant),
            convert(&parameter::LAMINAR_RATIO, self.laminar_ratio),
        )
    }

    /// `G` in kg·√K/(s·Pa), the efficiency included.
    #[inline(always)]
    pub fn conductance(&self) -> S {
        self.conductance
    }

    /// Specific gas constant R in J/(kg·K).
    #[inline(always)]
    pub fn gas_constant(&self) -> S {
        self.gas_constant
    }

    /// Pressure ratio `r_c` below which the flow is choked.
    pub fn critical_ratio(&self) -> S {
        self.critical_ratio
    }

    /// Pressure ratio `r_lam` above which the law is a straight line.
    pub fn laminar_ratio(&self) -> S {
        self.laminar_ratio
    }

    /// ψ between the critical ratio and the straight line.
    #[inline(always)]
    fn subsonic<T: Over<S>>(&self, ratio: T) -> T {
        let t = ratio.multiply_add(T::of(self.scale), T::of(self.offset));
        (T::one() - ratio).sqrt() * polynomial(&self.polynomial, t)
    }

    /// ψ on the straight line.
    #[inline(always)]
    fn laminar<T: Over<S>>(&self, ratio: T) -> T {
        T::of(self.laminar_slope) * (T::one() - ratio)
    }

    /// ψ at a pressure ratio from 0 to 1.
    #[inline(always)]
    pub fn ratio_function<T: Over<S>>(&self, ratio: T) -> T {
        let kept = ratio.larger(T::of(self.critical_ratio)).smaller(T::of(self.laminar_ratio));
        T::select(T::of(self.laminar_ratio).lt(ratio), self.laminar(ratio), self.subsonic(kept))
    }

    /// ψ by the formula of one zone, smoothly continued beyond the zone's bounds; a choked flow asks for no ratio.
    #[inline(always)]
    pub fn in_zone<T: Over<S>>(&self, zone: FlowZone, ratio: impl FnOnce() -> T) -> T {
        match zone {
            FlowZone::ChokedIn | FlowZone::ChokedOut => T::one(),
            FlowZone::SubsonicIn | FlowZone::SubsonicOut => self.subsonic(ratio()),
            FlowZone::LaminarIn | FlowZone::LaminarOut => self.laminar(ratio()),
        }
    }
}

impl<S: Real> FlowLaw<S> {
    /// Absolute pressures in Pa in the actuator between which a zone holds, for a port at pressure `beyond`; `None`
    /// where a zone has no end.
    pub fn bounds(&self, zone: FlowZone, beyond: S) -> (Option<S>, Option<S>) {
        // A critical ratio of zero never chokes.
        let choked = (self.critical_ratio.value() > 0.0).then_some(self.critical_ratio * beyond);
        let (choked_in, laminar_in) = (choked, Some(self.laminar_ratio * beyond));
        let (choked_out, laminar_out) =
            (choked.map(|_| beyond / self.critical_ratio), Some(beyond / self.laminar_ratio));
        match zone {
            FlowZone::ChokedIn => (None, choked_in),
            FlowZone::SubsonicIn => (choked_in, laminar_in),
            FlowZone::LaminarIn => (laminar_in, Some(beyond)),
            FlowZone::LaminarOut => (Some(beyond), laminar_out),
            FlowZone::SubsonicOut => (laminar_out, choked_out),
            FlowZone::ChokedOut => (choked_out, None),
        }
    }
}

/// Coefficients in rising powers of t of the polynomial through `function` at the Chebyshev points of `[−1, 1]`.
fn chebyshev_fit<S: Scalar>(function: impl Fn(f64) -> S) -> [S; TERMS] {
    let count = TERMS as f64;
    let angle = |node: usize| PI * (node as f64 + 0.5) / count;
    let values: [S; TERMS] = core::array::from_fn(|node| function(Scalar::cos(angle(node))));
    let mut polynomial = [S::zero(); TERMS];
    // T_k and T_{k+1} in powers of t; their coefficients are whole numbers.
    let (mut now, mut next) = ([0.0; TERMS], [0.0; TERMS]);
    now[0] = 1.0;
    next[1] = 1.0;
    for k in 0..TERMS {
        let share = if k == 0 { 1.0 } else { 2.0 } / count;
        let coefficient = (0..TERMS)
            .fold(S::zero(), |sum, node| sum + values[node] * S::constant(share * Scalar::cos(k as f64 * angle(node))));
        for (term, whole) in polynomial.iter_mut().zip(now) {
            *term = *term + coefficient * S::constant(whole);
        }
        let after = core::array::from_fn(|i| if i == 0 { 0.0 } else { 2.0 * next[i - 1] } - now[i]);
        now = next;
        next = after;
    }
    polynomial
}

/// Value of a polynomial at `t`, in four-term groups so that the groups run side by side.
#[inline(always)]
fn polynomial<S: Scalar, T: Over<S>>(coefficients: &[S; TERMS], t: T) -> T {
    let (t2, mut sum) = (t * t, T::zero());
    let t4 = t2 * t2;
    for group in coefficients.chunks_exact(4).rev() {
        let low = t.multiply_add(T::of(group[1]), T::of(group[0]));
        let high = t.multiply_add(T::of(group[3]), T::of(group[2]));
        sum = sum.multiply_add(t4, t2.multiply_add(high, low));
    }
    sum
}
