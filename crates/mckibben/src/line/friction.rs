//! Friction loss of a gas in a smooth round tube, laminar and turbulent.
//!
//! ```text
//! Re = 4ṁ/(π d μ)         σ = (P₁² − P₂²)/(2RT) · d³/(μ² L)         σ = f Re²/2
//!
//! laminar, Re ≤ 2300      f = 64/Re             σ = 32 Re                    Hagen–Poiseuille
//! turbulent, Re ≥ 4000    f = 0.3164/Re^¼       σ = 0.1582 Re^(7/4)          Blasius
//! between                 u = t (t + a (1 − t))/(1 + (a + e − 2) t (1 − t))          values and slopes of both ends
//!
//! ṁ = ṁ_f/√(1 + (ṁ_f/ṁ_c)²)       ṁ_c = A P_up √(γ/(RT)) (2/(γ+1))^((γ+1)/(2(γ−1)))
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | d, L, A | `diameter`, `length`, `area` | m, m, m² |
//! | μ, R, T | `viscosity`, `gas_constant`, `temperature` | Pa·s, J/(kg·K), K |
//! | Re, σ | Reynolds number, `drive` | – |
//! | t, u | how far Re and σ have come between laminar and turbulent, from 0 to 1 | – |
//! | a, e | slopes of u over t at both ends, `SLOPES` | – |
//! | ṁ_f, ṁ_c | flow by friction alone, flow at the speed of sound | kg/s |
//!
//! σ is the pressure loss with the mean density, `ρ̄ Δp = (P₁ − P₂)(P₁ + P₂)/(2RT)`, which is the integral of `ρ dP` along
//! a tube whose wall keeps the air's temperature: compressibility is in it. What is not in it is the air's acceleration
//! as it expands. The last line stands in: it keeps the flow below the speed of sound at the inlet's pressure, leaves
//! a long tube alone, and lies within 8 % of the isothermal flow with friction and acceleration for L/d from 100 on.
//!
//! Given σ the flow is known (a lumped hose); given the flow, σ is (a distributed one). The laws have continuous slopes and
//! each is the other's inverse: the rational quadratic between them rises where its slopes do, and is inverted by one
//! root. Blasius' law holds to Re = 10⁵; beyond it the loss is too low (by 3 % at 2·10⁵).
//!
//! Source: textbook fluid mechanics (F. M. White, Fluid Mechanics; H. Blasius 1913). The bounds 2300 and 4000 are the usual
//! ones; the quadratic and the last line are choices of this project. Rational quadratics that rise: R. Delbourgo &
//! J. A. Gregory, IMA J. Numer. Anal. 2 (1982).
//! Checked by `tests/line_friction.rs`.

use crate::air::Air;
use crate::convert::Convert;
use crate::error::Error;
use crate::parameter;
use crate::scalar::{Function, Mask, Over, Scalar};
use core::f64::consts::PI;

/// Reynolds number up to which the flow is laminar.
pub const LAMINAR_END: f64 = 2300.0;
/// Reynolds number from which the flow is turbulent.
pub const TURBULENT_START: f64 = 4000.0;
/// Half of Blasius' 0.3164.
const BLASIUS: f64 = 0.1582;
/// σ where the laminar flow ends.
const LAMINAR_DRIVE: f64 = 32.0 * LAMINAR_END;
/// `4000^(3/4)`.
const TURBULENT_ROOT: f64 = 502.973_371_873_174_8;
/// σ where the turbulent flow starts, and its slope there.
const TURBULENT_DRIVE: f64 = BLASIUS * TURBULENT_START * TURBULENT_ROOT;
const TURBULENT_SLOPE: f64 = 1.75 * BLASIUS * TURBULENT_ROOT;
/// A bound for the slope of the law between both flows.
#[cfg(feature = "alloc")]
const STEEPEST: f64 = 194.0;

/// Slopes of u over t where the laminar flow ends and where the turbulent one starts.
const SLOPES: [f64; 2] = {
    let secant = (TURBULENT_DRIVE - LAMINAR_DRIVE) / (TURBULENT_START - LAMINAR_END);
    [32.0 / secant, TURBULENT_SLOPE / secant]
};
/// `a + e − 2`.
const BEND: f64 = SLOPES[0] + SLOPES[1] - 2.0;

/// The pieces of the law in order of rising drive, from the far pressure being the larger to the near one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FlowRegime {
    /// Turbulent, backwards.
    TurbulentBack,
    /// Between laminar and turbulent, backwards.
    TransitionBack,
    /// Laminar, either way.
    Laminar,
    /// Between laminar and turbulent.
    Transition,
    /// Turbulent.
    Turbulent,
}

impl FlowRegime {
    /// All pieces in their order.
    pub const RISING: [Self; 5] =
        [Self::TurbulentBack, Self::TransitionBack, Self::Laminar, Self::Transition, Self::Turbulent];

    /// The signed drives between which it holds; `None` where it has no end.
    pub fn bounds(self) -> [Option<f64>; 2] {
        match self {
            Self::TurbulentBack => [None, Some(-TURBULENT_DRIVE)],
            Self::TransitionBack => [Some(-TURBULENT_DRIVE), Some(-LAMINAR_DRIVE)],
            Self::Laminar => [Some(-LAMINAR_DRIVE), Some(LAMINAR_DRIVE)],
            Self::Transition => [Some(LAMINAR_DRIVE), Some(TURBULENT_DRIVE)],
            Self::Turbulent => [Some(TURBULENT_DRIVE), None],
        }
    }
}

/// A smooth round tube and the gas in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tube<S = f64> {
    length: S,
    diameter: S,
    viscosity: S,
    gas_constant: S,
    temperature: S,
    heat_capacity_ratio: S,
    shape: Shape<S>,
}

/// What follows from the parameters of a tube.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Shape<S> {
    area: S,
    /// σ over `P₁² − P₂²`, in 1/Pa².
    drive: S,
    /// ṁ over Re, in kg/s.
    flow: S,
    /// 1/ṁ_c times the inlet's pressure, in Pa·s/kg.
    per_choked: S,
}

impl Tube {
    /// A tube of `length` and inner `diameter` (m) with the gas of `air`, of `viscosity` (Pa·s) and at `temperature` (K).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number outside its range.
    pub fn new(length: f64, diameter: f64, viscosity: f64, temperature: f64, air: &Air) -> Result<Self, Error> {
        Ok(Self::assemble([
            parameter::HOSE_LENGTH.check(length)?,
            parameter::HOSE_DIAMETER.check(diameter)?,
            parameter::HOSE_VISCOSITY.check(viscosity)?,
            parameter::SUPPLY_TEMPERATURE.check(temperature)?,
            air.gas_constant(),
            air.heat_capacity_ratio(),
        ]))
    }
}

impl<S: Scalar> Tube<S> {
    fn assemble([length, diameter, viscosity, temperature, gas_constant, heat_capacity_ratio]: [S; 6]) -> Self {
        let (one, two) = (S::one(), S::constant(2.0));
        let thermal = gas_constant * temperature;
        let area = S::constant(PI / 4.0) * diameter * diameter;
        let gamma = heat_capacity_ratio;
        let sonic = (two / (gamma + one)).power((gamma + one) / (two * (gamma - one)));
        let shape = Shape {
            area,
            drive: diameter * diameter * diameter / (two * thermal * viscosity * viscosity * length),
            flow: S::constant(PI / 4.0) * diameter * viscosity,
            per_choked: one / (area * (gamma / thermal).sqrt() * sonic),
        };
        Self { length, diameter, viscosity, gas_constant, temperature, heat_capacity_ratio, shape }
    }

    /// Converts the tube to another scalar type.
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Tube<T> {
        let length = convert.parameter(&parameter::HOSE_LENGTH, self.length);
        let diameter = convert.parameter(&parameter::HOSE_DIAMETER, self.diameter);
        let viscosity = convert.parameter(&parameter::HOSE_VISCOSITY, self.viscosity);
        let temperature = convert.parameter(&parameter::SUPPLY_TEMPERATURE, self.temperature);
        let gas_constant = convert.parameter(&parameter::GAS_CONSTANT, self.gas_constant);
        let heat_capacity_ratio = convert.parameter(&parameter::HEAT_CAPACITY_RATIO, self.heat_capacity_ratio);
        let Shape { area, drive, flow, per_choked } = self.shape;
        match convert.carry() {
            Some(mut carry) => Tube {
                length,
                diameter,
                viscosity,
                gas_constant,
                temperature,
                heat_capacity_ratio,
                shape: Shape {
                    area: carry(area),
                    drive: carry(drive),
                    flow: carry(flow),
                    per_choked: carry(per_choked),
                },
            },
            None => Tube::assemble([length, diameter, viscosity, temperature, gas_constant, heat_capacity_ratio]),
        }
    }

    /// Length in m.
    #[inline(always)]
    pub fn length(&self) -> S {
        self.length
    }

    /// Cross-section in m².
    #[inline(always)]
    pub fn area(&self) -> S {
        self.shape.area
    }

    /// Inner volume in m³.
    #[inline(always)]
    pub fn volume(&self) -> S {
        self.shape.area * self.length
    }

    /// `R T` in m²/s², which is `P/ρ`.
    #[inline(always)]
    pub fn pressure_per_density(&self) -> S {
        self.gas_constant * self.temperature
    }

    /// Temperature of the air in K.
    pub fn temperature(&self) -> S {
        self.temperature
    }

    /// Dynamic viscosity in Pa·s.
    pub fn viscosity(&self) -> S {
        self.viscosity
    }

    /// Reynolds number of a mass flow in kg/s.
    #[inline(always)]
    pub fn reynolds<T: Over<S>>(&self, flow: T) -> T {
        flow / T::of(self.shape.flow)
    }

    /// Mass flow in kg/s from an absolute pressure (Pa) to another, negative when the second is the larger.
    #[inline(always)]
    pub fn flow<T: Over<S>>(&self, from: T, to: T) -> T {
        let drive = self.drive(from, to);
        let size = self.slower_than_sound(reynolds_at(drive.magnitude()), from.larger(to));
        T::select(drive.lt(T::zero()), -size, size)
    }

    /// Mass flow by the formula of one piece, continued beyond its bounds by polynomials.
    #[inline(always)]
    pub fn flow_in<T: Over<S>>(&self, regime: FlowRegime, from: T, to: T) -> T {
        let drive = self.drive(from, to);
        match regime {
            FlowRegime::TurbulentBack => -self.slower_than_sound(turbulent_about(-drive), to),
            FlowRegime::TransitionBack => -self.slower_than_sound(transition_about(-drive), to),
            FlowRegime::Laminar => self.slower_than_sound(drive * T::constant(1.0 / 32.0), from.larger(to)),
            FlowRegime::Transition => self.slower_than_sound(transition_about(drive), from),
            FlowRegime::Turbulent => self.slower_than_sound(turbulent_about(drive), from),
        }
    }

    /// Mass flow in kg/s from an absolute pressure (Pa) to another, each lane by the formula of the piece that its drive lies in.
    #[doc(hidden)]
    #[inline(always)]
    pub fn flow_in_lanes<T: Over<S>>(&self, from: T, to: T) -> T {
        let (drive, number) = (self.drive(from, to), T::constant);
        let mut flow = self.flow_in(FlowRegime::Laminar, from, to);
        // What no lane needs is not computed.
        let back = drive.le(number(-LAMINAR_DRIVE));
        if back.any() {
            flow = T::select(back, self.flow_in(FlowRegime::TransitionBack, from, to), flow);
            let turbulent = drive.le(number(-TURBULENT_DRIVE));
            if turbulent.any() {
                flow = T::select(turbulent, self.flow_in(FlowRegime::TurbulentBack, from, to), flow);
            }
        }
        let ahead = !drive.le(number(LAMINAR_DRIVE));
        if ahead.any() {
            flow = T::select(ahead, self.flow_in(FlowRegime::Transition, from, to), flow);
            let turbulent = !drive.le(number(TURBULENT_DRIVE));
            if turbulent.any() {
                flow = T::select(turbulent, self.flow_in(FlowRegime::Turbulent, from, to), flow);
            }
        }
        flow
    }

    /// The drive σ with its sign, from an absolute pressure (Pa) to another.
    #[inline(always)]
    pub fn drive<T: Over<S>>(&self, from: T, to: T) -> T {
        (from - to) * (from + to) * T::of(self.shape.drive)
    }

    #[inline(always)]
    fn slower_than_sound<T: Over<S>>(&self, reynolds: T, upstream: T) -> T {
        let friction = reynolds * T::of(self.shape.flow);
        let choked = friction * T::of(self.shape.per_choked);
        friction * upstream / choked.multiply_add(choked, upstream * upstream).sqrt()
    }

    /// The friction that a mass flow (kg/s) meets along the tube, as a loss of pressure in Pa at a `mean` absolute pressure
    /// (Pa); of the sign of the flow.
    #[inline(always)]
    pub fn loss<T: Over<S>>(&self, flow: T, mean: T) -> T {
        let size = drive_at(self.reynolds(flow.magnitude())) / (T::of(self.shape.drive + self.shape.drive) * mean);
        T::select(flow.lt(T::zero()), -size, size)
    }
}

impl<S: Scalar> Tube<S> {
    /// A bound for `∂Δp/∂ṁ` in Pa·s/kg at a flow (kg/s), and at the flow which two pressures (Pa, absolute) could keep up.
    #[cfg(feature = "alloc")]
    #[inline(always)]
    pub(crate) fn steepest_loss(&self, flow: S, from: S, to: S) -> S {
        let drive = drive_at(self.reynolds(flow.magnitude())).larger(self.drive(from, to).magnitude());
        let mean = S::constant(0.5) * (from + to);
        steepest_drive(drive) / ((self.shape.drive + self.shape.drive) * mean * self.shape.flow)
    }
}

/// A bound for `∂σ/∂Re` at drives up to σ: where the flow is turbulent it is `1.75 · 0.1582 (σ/0.1582)^(3/7)`, here with the
/// power 7/16, which roots make; the law below that is nowhere steeper than [`STEEPEST`].
#[cfg(feature = "alloc")]
#[inline(always)]
fn steepest_drive<T: Scalar>(drive: T) -> T {
    let beyond = (drive * T::constant(1.0 / BLASIUS)).larger(T::one());
    let half = beyond.sqrt();
    let turbulent = T::constant(1.75 * BLASIUS) * half / half.sqrt().sqrt().sqrt();
    T::select(drive.lt(T::constant(LAMINAR_DRIVE)), T::constant(32.0), turbulent.larger(T::constant(STEEPEST)))
}

/// The Reynolds number that a drive σ of zero or more keeps up.
#[inline(always)]
pub fn reynolds_at<T: Scalar>(drive: T) -> T {
    let number = T::constant;
    let is_laminar = drive.lt(number(LAMINAR_DRIVE));
    let mut reynolds = drive * number(1.0 / 32.0);
    // What no lane needs is not computed.
    if (!is_laminar).any() {
        // Beyond its own range each formula is evaluated at the end of its range at worst.
        let transition = transition_at(drive.larger(number(LAMINAR_DRIVE)).smaller(number(TURBULENT_DRIVE)));
        reynolds = T::select(is_laminar, reynolds, transition);
        let is_below = drive.lt(number(TURBULENT_DRIVE));
        if (!is_below).any() {
            let turbulent = turbulent_at(drive.larger(number(TURBULENT_DRIVE)));
            reynolds = T::select(is_below, reynolds, turbulent);
        }
    }
    reynolds
}

#[inline(always)]
fn turbulent_at<T: Scalar>(drive: T) -> T {
    (drive * T::constant(1.0 / BLASIUS)).by::<FourSevenths>()
}

/// `z^(4/7)` for z from `4000^(7/4)` on, to the last digits up to Re = 10⁶ and to 10⁻⁸ up to 10⁷, as the fourth power of the
/// seventh root: Padé's fraction n/d of `(z^(1/4))^(4/7)` about [`MIDDLE`], then a step of Halley's, with one division for
/// both. Lanes have roots; they have no logarithm.
struct FourSevenths;

impl Function for FourSevenths {
    #[inline(always)]
    fn value<S: Scalar>(z: S) -> S {
        let off = z.sqrt().sqrt() * S::constant(1.0 / MIDDLE) - S::one();
        let (upper, lower) = (polynomial(off, PADE[0]) * S::constant(OF_MIDDLE), polynomial(off, PADE[1]));
        let (above, below) = (seventh_power(upper), z * seventh_power(lower));
        let (three, four) = (S::constant(3.0), S::constant(4.0));
        let root = upper * (three * above + four * below) / (lower * (four * above + three * below));
        let square = root * root;
        square * square
    }

    #[inline(always)]
    fn slope<S: Scalar>(z: S, power: S) -> S {
        S::constant(4.0 / 7.0) * power / z
    }
}

#[inline(always)]
fn seventh_power<S: Scalar>(x: S) -> S {
    let square = x * x;
    square * square * square * x
}

#[inline(always)]
fn polynomial<T: Scalar>(x: T, [zeroth, first, second, third, fourth, fifth]: [f64; 6]) -> T {
    let high = x.multiply_add(x.multiply_add(T::constant(fifth), T::constant(fourth)), T::constant(third));
    x.multiply_add(x.multiply_add(x.multiply_add(high, T::constant(second)), T::constant(first)), T::constant(zeroth))
}

/// `z^(1/4)` in the middle of the turbulent range, and its power 4/7.
const MIDDLE: f64 = 126.0;
const OF_MIDDLE: f64 = 15.856_660_947_787_232;

/// Numerator and denominator of Padé's fraction of `(1 + x)^(4/7)`, of order 5 over 5, in rising powers of x.
const PADE: [[f64; 6]; 2] = [pade(4.0 / 7.0), pade(-4.0 / 7.0)];

const fn pade(exponent: f64) -> [f64; 6] {
    let mut coefficients = [1.0; 6];
    let mut power = 1;
    while power < 6 {
        let before = (power - 1) as f64;
        let grows = (5.0 - before) / (before + 1.0) * (exponent + 5.0 - before) / (10.0 - before);
        coefficients[power] = coefficients[power - 1] * grows;
        power += 1;
    }
    coefficients
}

/// The turbulent law, below its start by four terms of its series there: the power itself has no value below zero.
#[inline(always)]
fn turbulent_about<T: Scalar>(drive: T) -> T {
    const SERIES: [f64; 4] = [1.0, 4.0 / 7.0, -6.0 / 49.0, 20.0 / 343.0];
    let short = (drive * T::constant(1.0 / TURBULENT_DRIVE) - T::one()).smaller(T::zero());
    let [zeroth, first, second, third] = SERIES.map(T::constant);
    let series = short.multiply_add(short.multiply_add(short.multiply_add(third, second), first), zeroth);
    turbulent_at(drive.larger(T::constant(TURBULENT_DRIVE))) * series
}

/// The law between both flows, beyond its ends by straight lines.
#[inline(always)]
fn transition_about<T: Scalar>(drive: T) -> T {
    let kept = drive.larger(T::constant(LAMINAR_DRIVE)).smaller(T::constant(TURBULENT_DRIVE));
    let below = (drive - kept).smaller(T::zero()) * T::constant(1.0 / 32.0);
    let above = (drive - kept).larger(T::zero()) * T::constant(1.0 / TURBULENT_SLOPE);
    transition_at(kept) + below + above
}

#[inline(always)]
fn transition_at<T: Scalar>(drive: T) -> T {
    let number = T::constant;
    let within = (drive - number(LAMINAR_DRIVE)) * number(1.0 / (TURBULENT_DRIVE - LAMINAR_DRIVE));
    within.by::<ShareOfReynolds>().multiply_add(number(TURBULENT_START - LAMINAR_END), number(LAMINAR_END))
}

/// The drive σ that a Reynolds number of zero or more needs.
#[inline(always)]
pub fn drive_at<T: Scalar>(reynolds: T) -> T {
    let number = T::constant;
    let laminar = reynolds * number(32.0);
    let beyond = reynolds.larger(number(TURBULENT_START));
    let root = beyond.sqrt();
    let turbulent = beyond * root * root.sqrt() * number(BLASIUS);
    let within = (reynolds - number(LAMINAR_END)) * number(1.0 / (TURBULENT_START - LAMINAR_END));
    let transition =
        share_of_drive(within).multiply_add(number(TURBULENT_DRIVE - LAMINAR_DRIVE), number(LAMINAR_DRIVE));
    let below = T::select(reynolds.lt(number(LAMINAR_END)), laminar, transition);
    T::select(reynolds.lt(number(TURBULENT_START)), below, turbulent)
}

/// u at a t from 0 to 1.
#[inline(always)]
fn share_of_drive<T: Scalar>(t: T) -> T {
    let (one, rest) = (T::one(), T::one() - t);
    let low = T::constant(SLOPES[0]);
    t * rest.multiply_add(low, t) / (t * rest).multiply_add(T::constant(BEND), one)
}

/// t at a u from 0 to 1: the root of `(1 − a + u κ) t² + (a − u κ) t − u = 0` with `κ = a + e − 2`.
struct ShareOfReynolds;

impl Function for ShareOfReynolds {
    #[inline(always)]
    fn value<S: Scalar>(u: S) -> S {
        let linear = u.multiply_add(S::constant(-BEND), S::constant(SLOPES[0]));
        let square = S::constant(4.0) * u * (S::one() - linear);
        let root = linear.multiply_add(linear, square).sqrt();
        (u + u) / (linear + root)
    }

    /// One over `∂u/∂t = (e t² + 2 t (1 − t) + a (1 − t)²)/(1 + κ t (1 − t))²`.
    #[inline(always)]
    fn slope<S: Scalar>(_: S, t: S) -> S {
        let rest = S::one() - t;
        let divisor = (t * rest).multiply_add(S::constant(BEND), S::one());
        let both = S::constant(2.0) * t * rest;
        let rises =
            (t * t).multiply_add(S::constant(SLOPES[1]), (rest * rest).multiply_add(S::constant(SLOPES[0]), both));
        divisor * divisor / rises
    }
}
