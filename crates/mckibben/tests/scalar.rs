//! The scalars: derivatives of dual numbers, eight lanes side by side.

use crate::common::{ATMOSPHERE, Paper, between, slope};
use core::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};
use mckibben::air::{Chamber, Process};
use mckibben::force::Effectiveness;
use mckibben::friction::{Coulomb, Hysteresis, MaxwellSlip};
use mckibben::parameter::Parameter;
use mckibben::valve::{ExhaustTemperature, FlowStandard, Ports};
use mckibben::{AbsolutePressure, Actuator, ActuatorState, Dual, Mask, Response, Scalar};

/// A function of one number that any scalar can evaluate.
trait Function {
    fn at<T: Scalar>(&self, x: T) -> T;
}

macro_rules! functions {
    ($($name:ident: |$x:ident| $body:expr;)*) => {
        $(
            struct $name;
            impl Function for $name {
                fn at<T: Scalar>(&self, $x: T) -> T { $body }
            }
        )*
        /// Compares every function's dual derivatives with finite differences at a place.
        fn check_all(x: f64) {
            $(check(stringify!($name), &$name, x);)*
        }
    };
}

fn c<T: Scalar>(value: f64) -> T {
    T::constant(value)
}

functions! {
    Sum: |x| x + x + c(3.0);
    Difference: |x| c::<T>(2.0) - x * c(3.0);
    Product: |x| x * x * x;
    Quotient: |x| (x + c(1.0)) / (x * x + c(2.0));
    Negative: |x| -(x * x);
    Root: |x| (x + c(4.0)).sqrt();
    Logarithm: |x| (x + c(4.0)).ln();
    Exponential: |x| (x * c(0.7)).exp();
    ExponentialLessOne: |x| (x * c(0.7)).exp_m1();
    Sine: |x| x.sin();
    Cosine: |x| x.cos();
    Power: |x| (x + c(4.0)).power(x);
    MultiplyAdd: |x| x.multiply_add(x, x);
    Smaller: |x| (x * x).smaller(x * x * x + c(10.0));
    Larger: |x| (x * x).larger(x - c(10.0));
    Magnitude: |x| (x * x - c(20.0)).magnitude();
    Chosen: |x| T::select(x.le(c(100.0)), x.sin(), x.cos());
    Composed: |x| ((x * x + c(1.0)).ln() * x.cos()).exp() / (x.sin() + c(3.0)).sqrt();
}

fn check(name: &str, function: &impl Function, x: f64) {
    let dual = function.at(Dual::<f64, 2>::variable(x, 1));
    let twice = function.at(Dual { value: Dual::<f64, 1>::variable(x, 0), slope: [Dual::<f64, 1>::constant(1.0)] });
    assert_eq!(dual.value, function.at(x), "{name}: the value itself");
    assert_eq!(dual.slope[0], 0.0, "{name}: the direction that x does not lie in");
    // The five-point rule at 1e-3 is off by about 1e-12 times the fifth derivative, and by rounding of 1e-13 |f|.
    let first = slope(1e-3, |h| function.at(x + h));
    let scale = 1.0 + dual.value.abs() + first.abs();
    assert!((dual.slope[1] - first).abs() < 1e-9 * scale, "{name} at {x}: {} is not {first}", dual.slope[1]);
    let second = slope(1e-3, |h| function.at(Dual::<f64, 1>::variable(x + h, 0)).slope[0]);
    let nested = twice.slope[0].slope[0];
    assert!((nested - second).abs() < 1e-8 * (scale + second.abs()), "{name} at {x}: {nested} is not {second}");
}

#[test]
fn dual_numbers_carry_first_and_second_derivatives_of_every_operation() {
    for x in [-1.9, -0.6, 0.3, 1.0, 2.4] {
        check_all(x);
    }
}

#[test]
fn choices_take_the_derivative_of_the_branch_that_was_chosen() {
    let x = Dual::<f64, 1>::variable(-2.0, 0);
    assert_eq!(x.magnitude(), Dual { value: 2.0, slope: [-1.0] });
    assert_eq!(x.larger(Dual::constant(0.0)), Dual::constant(0.0));
    assert_eq!(x.smaller(Dual::constant(0.0)), x);
    assert_eq!(x.sign(), Dual::constant(-1.0));
    // What is not chosen may be anything, NaN included.
    let chosen = Dual::select(true, x, x.sqrt());
    assert_eq!(chosen, x);
}

/// Eight numbers side by side, as a batch has them, with the functions that the core takes for `f64`: those of the
/// standard library or of `libm`.
#[derive(Clone, Copy, Debug)]
struct Lanes([f64; 8]);
#[derive(Clone, Copy, Debug)]
struct Mask8([bool; 8]);

fn lanes(make: impl FnMut(usize) -> f64) -> Lanes {
    Lanes(core::array::from_fn(make))
}

macro_rules! lanewise {
    ($($trait:ident $method:ident),*) => {
        $(impl $trait for Lanes {
            type Output = Self;
            fn $method(self, other: Self) -> Self { lanes(|i| self.0[i].$method(other.0[i])) }
        })*
    };
}
lanewise!(Add add, Sub sub, Mul mul, Div div);

impl Neg for Lanes {
    type Output = Self;
    fn neg(self) -> Self {
        lanes(|i| -self.0[i])
    }
}
impl BitAnd for Mask8 {
    type Output = Self;
    fn bitand(self, other: Self) -> Self {
        Self(core::array::from_fn(|i| self.0[i] & other.0[i]))
    }
}
impl BitOr for Mask8 {
    type Output = Self;
    fn bitor(self, other: Self) -> Self {
        Self(core::array::from_fn(|i| self.0[i] | other.0[i]))
    }
}
impl Not for Mask8 {
    type Output = Self;
    fn not(self) -> Self {
        Self(self.0.map(|bit| !bit))
    }
}
impl Mask for Mask8 {
    fn splat(value: bool) -> Self {
        Self([value; 8])
    }
    fn any(self) -> bool {
        self.0.contains(&true)
    }
}
impl Scalar for Lanes {
    type Mask = Mask8;
    fn constant(value: f64) -> Self {
        Self([value; 8])
    }
    fn sqrt(self) -> Self {
        Self(self.0.map(Scalar::sqrt))
    }
    fn ln(self) -> Self {
        Self(self.0.map(Scalar::ln))
    }
    fn exp(self) -> Self {
        Self(self.0.map(Scalar::exp))
    }
    fn exp_m1(self) -> Self {
        Self(self.0.map(Scalar::exp_m1))
    }
    fn sin(self) -> Self {
        Self(self.0.map(Scalar::sin))
    }
    fn cos(self) -> Self {
        Self(self.0.map(Scalar::cos))
    }
    fn lt(self, other: Self) -> Mask8 {
        Mask8(core::array::from_fn(|i| self.0[i] < other.0[i]))
    }
    fn le(self, other: Self) -> Mask8 {
        Mask8(core::array::from_fn(|i| self.0[i] <= other.0[i]))
    }
    fn select(mask: Mask8, yes: Self, no: Self) -> Self {
        lanes(|i| if mask.0[i] { yes.0[i] } else { no.0[i] })
    }
}

/// Each lane's own parameters: all a little different, some much.
fn vary(parameter: &Parameter, value: f64, lane: usize) -> f64 {
    let by = 1.0 + 0.01 * lane as f64;
    match parameter.key {
        "air.heat_capacity_ratio" => value - 0.03 * lane as f64,
        "actuator.friction.viscous" | "actuator.external_volume" => value * (1.0 + lane as f64),
        "actuator.friction.coulomb_width" => value * lane as f64,
        "valve.critical_ratio" => value * (1.0 - 0.05 * lane as f64),
        "valve.laminar_ratio" => value - 0.001 * lane as f64,
        "actuator.max_length" | "actuator.min_length" | "actuator.thread_length" => value * by,
        _ => value * (1.0 + 0.003 * lane as f64),
    }
}

fn bits(response: &Response) -> [u64; 8] {
    [
        response.tension,
        response.per_length,
        response.per_velocity,
        response.per_pressure,
        response.pressure_rate,
        response.mass_flow,
        response.temperature,
        response.volume,
    ]
    .map(f64::to_bits)
}

fn lane_of(response: &Response<Lanes>, lane: usize) -> Response {
    Response {
        tension: response.tension.0[lane],
        per_length: response.per_length.0[lane],
        per_velocity: response.per_velocity.0[lane],
        per_pressure: response.per_pressure.0[lane],
        pressure_rate: response.pressure_rate.0[lane],
        mass_flow: response.mass_flow.0[lane],
        temperature: response.temperature.0[lane],
        volume: response.volume.0[lane],
    }
}

/// Rigs that reach every form of every law.
fn variants() -> Vec<Paper> {
    let table = Effectiveness::table(&[0.0, 1e5, 3e5, 5e5], &[0.5, 0.8, 0.85, 0.9]).expect("a table");
    let iso = FlowStandard::Iso6358 { sonic_conductance: 5e-9, critical_ratio: 0.3 };
    vec![
        Paper::pwm(25.0, 0.5),
        Paper::pwm(25.0, 0.5).process(Process::Isothermal).with(|rig| (rig.effectiveness, rig.standard) = (table, iso)),
        Paper::pwm(25.0, 0.5).process(Process::Polytropic { index: 1.2 }).with(|rig| {
            rig.effectiveness = Effectiveness::polynomial(&[0.5, 1e-6, -5e-13]).expect("a polynomial");
            rig.exhaust_temperature = ExhaustTemperature::Ambient;
        }),
        Paper::pwm(25.0, 0.5).process(Process::EnergyBalance { heat_transfer: 0.1, wall_temperature: 300.0 }),
        Paper::pwm(25.0, 0.5).with(|rig| {
            let elements = MaxwellSlip::new(&[1e-4, 2e-3], &[0.8, 0.1]).expect("elements");
            let dry = Coulomb::new(1e-4)
                .and_then(|dry| dry.with_force(0.3, 1e-6))
                .and_then(|dry| dry.with_stribeck(1.4, 0.1));
            (rig.hysteresis, rig.coulomb) = (Some(Hysteresis::MaxwellSlip(elements)), Some(dry.expect("a law")));
        }),
    ]
}

/// Distance, velocity, pressure and air mass: slack to taut, both ways and at rest, vacuum to above the supply.
fn random_state(row: usize) -> (f64, f64, f64, f64) {
    let velocity = if row.is_multiple_of(7) { 0.0 } else { between(row, 1, -1.0, 1.0) };
    let pressure = between(row, 2, 0.5, 9.0) * ATMOSPHERE;
    (between(row, 0, 0.055, 0.105), velocity, pressure, between(row, 3, 0.5, 2.0) * 1e-5 * pressure / ATMOSPHERE)
}

/// Actuator length in m at which the hysteresis of a variant is relaxed.
const RELAXED: f64 = 0.085;

#[test]
fn eight_lanes_are_bit_identical_to_scalar_evaluations() {
    for paper in variants() {
        let actuator = paper.actuator();
        let wide: Actuator<Lanes> = actuator.map(|parameter, value| lanes(|lane| vary(parameter, value, lane)));
        let single: Vec<Actuator> =
            (0..8).map(|lane| actuator.map(|parameter, value| vary(parameter, value, lane))).collect();
        for row in 0..500 {
            let of = |lane: usize| random_state(8 * row + lane);
            let (pressure, air_mass) = (lanes(|lane| of(lane).2), lanes(|lane| of(lane).3));
            let state = ActuatorState::new(AbsolutePressure(pressure), air_mass, Lanes([RELAXED; 8]));
            let ports = Ports { supply: row.is_multiple_of(2), exhaust: row.is_multiple_of(3) };
            let all = wide.respond(&state, lanes(|lane| of(lane).0), lanes(|lane| of(lane).1), ports);
            for (lane, alone) in single.iter().enumerate() {
                let (distance, velocity, pressure, air_mass) = of(lane);
                let state = ActuatorState::new(AbsolutePressure(pressure), air_mass, RELAXED);
                let expected = alone.respond(&state, distance, velocity, ports);
                let got = lane_of(&all, lane);
                assert_eq!(bits(&got), bits(&expected), "lane {lane}: {got:?} is not {expected:?}");
            }
        }
    }
}

#[test]
fn lanes_may_have_different_flow_paths_open() {
    for paper in variants() {
        let actuator = paper.actuator();
        let wide: Actuator<Lanes> = actuator.map(|_, value| Lanes([value; 8]));
        let supply = core::array::from_fn(|lane| lane & 1 != 0);
        let exhaust = core::array::from_fn(|lane| lane & 2 != 0);
        for row in 0..200 {
            let of = |lane: usize| random_state(8 * row + lane);
            let chamber = wide.chamber(
                lanes(|lane| of(lane).0),
                lanes(|lane| of(lane).1),
                lanes(|lane| of(lane).2),
                lanes(|lane| of(lane).3),
                wide.limits().is_slack(lanes(|lane| of(lane).0)),
            );
            let flow = wide.flow(&chamber, Mask8(supply), Mask8(exhaust));
            for lane in 0..8 {
                let (distance, velocity, pressure, mass) = of(lane);
                let slack = actuator.limits().is_slack(distance);
                let chamber: Chamber = actuator.chamber(distance, velocity, pressure, mass, slack);
                let expected = actuator.flow(&chamber, supply[lane], exhaust[lane]);
                assert_eq!(flow.inward.0[lane].to_bits(), expected.inward.to_bits());
                assert_eq!(flow.outward.0[lane].to_bits(), expected.outward.to_bits());
            }
        }
    }
}
