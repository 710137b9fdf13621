//! Mass flow of a gas through a flow path: the paper's orifice, ISO 6358, and IEC 60534 for valves stated by Kv or Cv.
//!
//! ```text
//! ṁ = G P_up/√T_up · ψ(r)          r = P_down/P_up
//!
//! orifice (21)(23)   G = η A_p C_q √(γ/R · (2/(γ+1))^((γ+1)/(γ−1)))      r_c = (2/(γ+1))^(γ/(γ−1))
//!                    ψ = √(2/(γ−1) · (r^(2/γ) − r^((γ+1)/γ)) / (2/(γ+1))^((γ+1)/(γ−1)))
//! ISO 6358-1         G = η C ρ₀ √T₀                                      r_c = b
//!                    ψ = √(1 − ((r − b)/(1 − b))²)
//! IEC 60534-2-1      G = η Kv √(ρ_w/Δp₀) ⅔ √(x_c/R)                        r_c = 1 − x_c,  x_c = (γ/1.4) x_T
//!                    ψ = Y √x / (⅔ √x_c)           Y = 1 − x/(3 x_c)       x = 1 − r
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
//! | Kv | `kv`, flow of water at Δp₀ = 1 bar; ρ_w = 999.1 kg/m³ | m³/s |
//! | Cv | `cv`, flow of water in US gal/min at 1 psi; Kv = 0.86498 m³/h · Cv, from the units themselves | – |
//! | x_T, x_c | `pressure_drop_ratio` of air and of the gas at which the flow chokes | – |
//! | Y | expansion factor, ⅔ when choked | – |
//!
//! Kv and Cv say nothing of where the flow chokes; x_T does, and few data sheets of small valves give it. With the usual 0.7
//! the sonic conductance that SMC states for its SY3000 to SY9000 in addition to their Cv is met within 25 %
//! (`docs/valves.md`): prefer C and b where they are known. The piping around the valve and laminar flow through it are
//! left out, `F_P = F_R = 1`.
//!
//! All forms of ψ are `√(1−r)·g(r)` with g analytic on `[r_c, 1]`, so g is a polynomial fitted when the law is made:
//! no power is left in the loop, and the difference of two nearly equal powers near r = 1 is gone with it. The largest
//! error against the textbook form in extended precision is a few units in the last place. With the gap x = 1 − r kept
//! between those of r_lam and r_c the three pieces are one, and `P_up/√T_up` goes under the same root:
//!
//! ```text
//! ψ = √x′·g·min(1, x/x_lam)        x = 1 − r = (P_up − P_down)/P_up        x′ = max(x_lam, min(x, x_c))
//! ```
//!
//! [`flow_parameter`] is (23) as the paper writes it, in powers: what a reader compares, not what a run evaluates.
//!
//! The slope of either law is infinite at r = 1; the straight line above `r_lam` is the usual cure.
//! `r_c` is used as it is (0.52828 for air), not rounded to 0.528, so that the law is continuous.
//! Source: Colbrunn, Nelson & Quinn (2001), section 3.2, after McCloy & Martin (1980); ISO 6358-1:2013; IEC 60534-2-1:2011,
//! also ISA-75.01.01, N₆ = √ρ_w as the Python package `fluids` has it.
//! Checked by `tests/valve.rs`: transcription of (23), both limits, continuity and slope, reverse flow; by
//! `tests/valve_coefficients.rs`: IEC 60534 in its own units, SMC's worked example of ISO 6358, a separate exhaust
//! path.

use crate::air::Air;
use crate::convert::{Convert, ConvertEach};
use crate::error::{Error, Requirement};
use crate::parameter::{self, Parameter};
#[cfg(feature = "alloc")]
use crate::scalar::Mask;
use crate::scalar::{Over, Real, Scalar};
use crate::valve::Port;
use crate::valve::flow_path::{FlowStandard, Rows};
use core::convert::Infallible;
use core::f64::consts::PI;

/// Terms of the polynomial g: beyond this the next Chebyshev coefficient is below the rounding of `f64` for every γ.
const TERMS: usize = 20;

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

/// Mass flow through an open flow path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowLaw<S = f64> {
    standard: FlowStandard<S>,
    efficiency: S,
    heat_capacity_ratio: S,
    gas_constant: S,
    laminar_ratio: S,
    shape: Shape<S>,
}

/// What follows from the parameters of a flow law.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Shape<S> {
    critical_ratio: S,
    conductance: S,
    /// `x_c = 1 − r_c`.
    critical_gap: S,
    /// `x_lam = 1 − r_lam`.
    laminar_gap: S,
    /// `1/x_lam`.
    per_laminar_gap: S,
    /// Slope of the straight line, `ψ(r_lam)/x_lam`.
    laminar_slope: S,
    /// `t = 1 − scale·x` maps `[0, x_c]` to `[1, −1]`.
    scale: S,
    /// Coefficients of g in rising powers of t.
    polynomial: [S; TERMS],
}

impl FlowLaw {
    /// A flow path for the gas of `air`, with a factor `efficiency` on its flow and a straight line above
    /// `laminar_ratio`.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number outside its range; [`Error::Inconsistent`] when the straight line would begin
    /// below the critical ratio.
    pub fn new(standard: FlowStandard, efficiency: f64, laminar_ratio: f64, air: &Air) -> Result<Self, Error> {
        Self::of_flow_path(Port::Supply, standard, efficiency, laminar_ratio, air)
    }

    /// As [`FlowLaw::new`], for the flow path to one port: messages name the keys of that path.
    ///
    /// # Errors
    /// As [`FlowLaw::new`].
    pub fn of_flow_path(
        port: Port,
        standard: FlowStandard,
        efficiency: f64,
        laminar_ratio: f64,
        air: &Air,
    ) -> Result<Self, Error> {
        standard.try_map(Rows::of(port), |row, value| row.check(value))?;
        let law = Self::assemble(
            standard,
            parameter::EFFICIENCY.check(efficiency)?,
            air.heat_capacity_ratio(),
            air.gas_constant(),
            parameter::LAMINAR_RATIO.check(laminar_ratio)?,
        );
        if laminar_ratio <= law.critical_ratio() {
            return Err(Error::Inconsistent {
                parameter: &parameter::LAMINAR_RATIO,
                value: laminar_ratio,
                requirement: Requirement {
                    relation: "must be greater than",
                    other: "the critical ratio",
                    value: law.critical_ratio(),
                    unit: "",
                },
                remedy: "give a ratio just below 1, such as 0.999",
            });
        }
        Ok(law)
    }
}

/// Flow parameter `C_m` in s·√K/m of (23), as the paper writes it, at a pressure ratio `P_down/P_up` from 0 to 1.
///
/// ```text
/// C_m = √[γ/R · (2/(γ+1))^((γ+1)/(γ−1))]                        P_down/P_up ≤ (2/(γ+1))^(γ/(γ−1)), choked
/// C_m = √[2γ/(R(γ−1)) · (r^(2/γ) − r^((γ+1)/γ))]                above, r = P_down/P_up
/// ```
///
/// The heat capacity ratio γ is above 1, the specific gas constant R in J/(kg·K) above 0. With the paper's orifice,
/// [`FlowLaw::conductance`] times [`FlowLaw::ratio_function`] is `η A_p C_q C_m` up to the laminar ratio: the same law as
/// a polynomial under a root, which simulations evaluate. The powers here cost more and lose digits as r nears 1.
///
/// Source: Colbrunn, Nelson & Quinn (2001), (23), with the exact critical ratio in place of its 0.528.
pub fn flow_parameter(heat_capacity_ratio: f64, gas_constant: f64, pressure_ratio: f64) -> f64 {
    let (gamma, r) = (heat_capacity_ratio, pressure_ratio);
    let base = 2.0 / (gamma + 1.0);
    let squared = if r <= base.power(gamma / (gamma - 1.0)) {
        gamma / gas_constant * base.power((gamma + 1.0) / (gamma - 1.0))
    } else {
        2.0 * gamma / (gas_constant * (gamma - 1.0)) * (r.power(2.0 / gamma) - r.power((gamma + 1.0) / gamma))
    };
    // Roundings may leave the difference of two equal powers below zero.
    Scalar::sqrt(squared.larger(0.0))
}

impl<S: Scalar> FlowLaw<S> {
    fn assemble(
        standard: FlowStandard<S>,
        efficiency: S,
        heat_capacity_ratio: S,
        gas_constant: S,
        laminar_ratio: S,
    ) -> Self {
        let (one, gamma) = (S::one(), heat_capacity_ratio);
        let (conductance, critical_ratio) = standard.size(gamma, gas_constant);
        let half = (one - critical_ratio) / S::constant(2.0);
        let laminar_gap = one - laminar_ratio;
        let mut shape = Shape {
            critical_ratio,
            conductance: efficiency * conductance,
            critical_gap: one - critical_ratio,
            laminar_gap,
            per_laminar_gap: one / laminar_gap,
            laminar_slope: S::zero(),
            scale: one / half,
            polynomial: chebyshev_fit(|t| standard.analytic_factor(gamma, one - half * S::constant(1.0 - t))),
        };
        shape.laminar_slope = shape.subsonic(laminar_gap) * shape.per_laminar_gap;
        Self { standard, efficiency, heat_capacity_ratio, gas_constant, laminar_ratio, shape }
    }

    /// Converts the law to another scalar type; `function` receives each number with its parameter.
    pub fn map<T: Scalar>(&self, function: impl FnMut(&'static Parameter, S) -> T) -> FlowLaw<T> {
        self.convert(Port::Supply, &mut ConvertEach(function))
    }

    /// Converts the law to another scalar type; the flow path to `port` is the one that it states.
    pub(crate) fn convert<T: Scalar>(&self, port: Port, convert: &mut impl Convert<S, T>) -> FlowLaw<T> {
        let number = |row, value| Ok::<_, Infallible>(convert.parameter(row, value));
        let Ok(standard) = self.standard.try_map(Rows::of(port), number);
        let efficiency = convert.parameter(&parameter::EFFICIENCY, self.efficiency);
        let heat_capacity_ratio = convert.parameter(&parameter::HEAT_CAPACITY_RATIO, self.heat_capacity_ratio);
        let gas_constant = convert.parameter(&parameter::GAS_CONSTANT, self.gas_constant);
        let laminar_ratio = convert.parameter(&parameter::LAMINAR_RATIO, self.laminar_ratio);
        match convert.carry() {
            Some(carry) => FlowLaw {
                standard,
                efficiency,
                heat_capacity_ratio,
                gas_constant,
                laminar_ratio,
                shape: self.shape.map(carry),
            },
            None => FlowLaw::assemble(standard, efficiency, heat_capacity_ratio, gas_constant, laminar_ratio),
        }
    }

    /// `G` in kg·√K/(s·Pa), the efficiency included.
    #[inline(always)]
    pub fn conductance(&self) -> S {
        self.shape.conductance
    }

    /// Specific gas constant R in J/(kg·K).
    #[inline(always)]
    pub fn gas_constant(&self) -> S {
        self.gas_constant
    }

    /// Pressure ratio `r_c` below which the flow is choked.
    pub fn critical_ratio(&self) -> S {
        self.shape.critical_ratio
    }

    /// Pressure ratio `r_lam` above which the law is a straight line.
    pub fn laminar_ratio(&self) -> S {
        self.laminar_ratio
    }

    /// ψ at a pressure ratio from 0 to 1.
    #[inline(always)]
    pub fn ratio_function<T: Over<S>>(&self, ratio: T) -> T {
        self.driven(T::one(), T::one() - ratio)
    }

    /// Mass flow in kg/s from the upstream `P²/T` in Pa²/K and the gap `(P_up − P_down)/P_up`, zero to one.
    #[inline(always)]
    pub fn mass_flow<T: Over<S>>(&self, squared_drive: T, gap: T) -> T {
        T::of(self.shape.conductance) * self.driven(squared_drive, gap)
    }

    /// `√(squared drive)·ψ` whatever the zone, with one root.
    #[inline(always)]
    fn driven<T: Over<S>>(&self, squared_drive: T, gap: T) -> T {
        let shape = &self.shape;
        let kept = gap.smaller(T::of(shape.critical_gap)).larger(T::of(shape.laminar_gap));
        let line = (gap * T::of(shape.per_laminar_gap)).smaller(T::one());
        (squared_drive * kept).sqrt() * shape.analytic_factor(kept) * line
    }

    /// ψ where the flow is choked, on the straight line near equal pressure, and between: the formulas of [`FlowLaw::in_zone`].
    /// Most often all lanes are in one zone, and the root and the polynomial between take longer than the rest.
    #[inline(always)]
    #[cfg(feature = "alloc")]
    pub(crate) fn in_zones<T: Over<S>>(&self, choked: S::Mask, straight: S::Mask, gap: T) -> T {
        if !(!choked).any() {
            return T::one();
        }
        let line = T::of(self.shape.laminar_slope) * gap;
        if !(!(choked | straight)).any() {
            return T::select(choked, T::one(), line);
        }
        T::select(choked, T::one(), T::select(straight, line, self.shape.subsonic(gap)))
    }

    /// ψ by the formula of one zone, smoothly continued beyond the zone's bounds; a choked flow needs no gap.
    #[inline(always)]
    pub fn in_zone<T: Over<S>>(&self, zone: FlowZone, gap: impl FnOnce() -> T) -> T {
        match zone {
            FlowZone::ChokedIn | FlowZone::ChokedOut => T::one(),
            FlowZone::SubsonicIn | FlowZone::SubsonicOut => self.shape.subsonic(gap()),
            FlowZone::LaminarIn | FlowZone::LaminarOut => T::of(self.shape.laminar_slope) * gap(),
        }
    }
}

impl<S: Scalar> Shape<S> {
    fn map<T>(&self, mut number: impl FnMut(S) -> T) -> Shape<T> {
        Shape {
            critical_ratio: number(self.critical_ratio),
            conductance: number(self.conductance),
            critical_gap: number(self.critical_gap),
            laminar_gap: number(self.laminar_gap),
            per_laminar_gap: number(self.per_laminar_gap),
            laminar_slope: number(self.laminar_slope),
            scale: number(self.scale),
            polynomial: self.polynomial.map(number),
        }
    }

    /// `g` at a gap `1 − r`.
    #[inline(always)]
    fn analytic_factor<T: Over<S>>(&self, gap: T) -> T {
        polynomial(&self.polynomial, (-gap).multiply_add(T::of(self.scale), T::one()))
    }

    /// ψ between the critical ratio and the straight line, at a gap `1 − r`.
    #[inline(always)]
    fn subsonic<T: Over<S>>(&self, gap: T) -> T {
        gap.sqrt() * self.analytic_factor(gap)
    }
}

impl<S: Real> FlowLaw<S> {
    /// Absolute pressures in Pa in the actuator between which a zone holds, for a port at pressure `beyond`; `None`
    /// where a zone has no end.
    pub fn bounds(&self, zone: FlowZone, beyond: S) -> (Option<S>, Option<S>) {
        let (choked_in, laminar_in) = (Some(self.critical_ratio() * beyond), Some(self.laminar_ratio * beyond));
        // With a critical ratio of zero, or below it where a fit tries one, inflow chokes up to a vacuum in the actuator, which
        // is never, and outflow at no pressure, so that subsonic outflow has no end.
        let ratio = self.critical_ratio().value();
        let chokes = ratio > 0.0 && (beyond.value() / ratio).is_finite();
        let (choked_out, laminar_out) =
            (chokes.then(|| beyond / self.critical_ratio()), Some(beyond / self.laminar_ratio));
        match zone {
            FlowZone::ChokedIn => (None, choked_in),
            FlowZone::SubsonicIn => (choked_in, laminar_in),
            FlowZone::LaminarIn => (laminar_in, Some(beyond)),
            FlowZone::LaminarOut => (Some(beyond), laminar_out),
            FlowZone::SubsonicOut => (laminar_out, choked_out),
            FlowZone::ChokedOut => (choked_out, None),
        }
    }

    /// The zone that holds between a port and an actuator at these absolute pressures in Pa: up to rounding that whose
    /// [bounds](FlowLaw::bounds) the pressure in the actuator lies between.
    #[inline(always)]
    pub fn zone(&self, beyond: S, pressure: S) -> FlowZone {
        let (critical, laminar) = (self.critical_ratio().value(), self.laminar_ratio.value());
        let (beyond, pressure) = (beyond.value(), pressure.value());
        if pressure <= beyond {
            match pressure {
                _ if pressure <= critical * beyond => FlowZone::ChokedIn,
                _ if pressure <= laminar * beyond => FlowZone::SubsonicIn,
                _ => FlowZone::LaminarIn,
            }
        } else {
            match pressure {
                _ if laminar * pressure <= beyond => FlowZone::LaminarOut,
                _ if critical * pressure <= beyond => FlowZone::SubsonicOut,
                _ => FlowZone::ChokedOut,
            }
        }
    }
}

/// Coefficients in rising powers of t of the polynomial through `function` at the Chebyshev points of `[−1, 1]`.
fn chebyshev_fit<S: Scalar>(function: impl Fn(f64) -> S) -> [S; TERMS] {
    let count = TERMS as f64;
    let nodes: [f64; TERMS] = core::array::from_fn(|node| Scalar::cos(PI * (node as f64 + 0.5) / count));
    let values = nodes.map(function);
    let mut polynomial = [S::zero(); TERMS];
    // T_k and T_{k+1} at the nodes, and in powers of t, where their coefficients are whole numbers.
    let (mut now_at, mut next_at) = ([1.0; TERMS], nodes);
    let (mut now, mut next) = ([0.0; TERMS], [0.0; TERMS]);
    now[0] = 1.0;
    next[1] = 1.0;
    for k in 0..TERMS {
        let share = if k == 0 { 1.0 } else { 2.0 } / count;
        let mut coefficient = S::zero();
        for node in 0..TERMS {
            coefficient = coefficient + values[node] * S::constant(share * now_at[node]);
        }
        for (term, whole) in polynomial.iter_mut().zip(now) {
            *term = *term + coefficient * S::constant(whole);
        }
        let after_at = core::array::from_fn(|node| 2.0 * nodes[node] * next_at[node] - now_at[node]);
        let after = core::array::from_fn(|i| if i == 0 { 0.0 } else { 2.0 * next[i - 1] } - now[i]);
        (now_at, next_at) = (next_at, after_at);
        (now, next) = (next, after);
    }
    polynomial
}

/// Value of a polynomial at `t`, in four-term groups so that the groups run side by side.
#[inline(always)]
fn polynomial<S: Scalar, T: Over<S>>(coefficients: &[S; TERMS], t: T) -> T {
    let (t2, mut sum) = (t * t, T::zero());
    let t4 = t2 * t2;
    for group in 0..TERMS / 4 {
        let first = TERMS - 4 * (group + 1);
        let low = t.multiply_add(T::of(coefficients[first + 1]), T::of(coefficients[first]));
        let high = t.multiply_add(T::of(coefficients[first + 3]), T::of(coefficients[first + 2]));
        sum = sum.multiply_add(t4, t2.multiply_add(high, low));
    }
    sum
}
