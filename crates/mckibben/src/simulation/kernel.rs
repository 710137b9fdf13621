//! One step of the fixed-step engine while nothing switches, in any number of lanes.
//!
//! | method | order | for |
//! |---|---|---|
//! | [`Method::Rk4`] | 4 | the paper's Runge–Kutta; needs `h` below the time constant of the air near equal pressure |
//! | [`Method::Stable`] | 2 | any `h` that a robot simulator uses |
//!
//! The stable method is Verwer's two-stage Rosenbrock scheme, of order 2 for whatever matrix `A` stands in for the
//! Jacobian:
//!
//! ```text
//! (I − γhA) k₁ = f(y)        (I − γhA) k₂ = f(y + h k₁) − 2 k₁        y⁺ = y + h (3k₁ + k₂)/2        γ = 1 + 1/√2
//! ```
//!
//! That freedom is used: `A` holds the exact derivatives of the mechanics (the taut braid may be stiff) and, for the
//! pressure, the steeper of the tangent and the secant to the port's pressure, so that no step overshoots the port. With
//! this γ the first stage goes at most 0.59 of the way.
//!
//! Masks and selects stand where branches would, and loops where closures would, so that all of it becomes part of the
//! kernel that calls it and is compiled for that kernel's instructions.
//!
//! Source: Verwer, Spee, Blom & Hundsdorfer, SIAM J. Sci. Comput. 20 (1999). Checked by `tests/fixed_step.rs`.

use super::rig::Rig;
use crate::air::{Chamber, Flow};
use crate::dual::Dual;
use crate::load::{Line, Load};
use crate::scalar::{Over, Scalar};
use crate::valve::Port;

/// Weight of each stage of the classical Runge–Kutta method in sixths, and how far the next stage reaches along it.
const RK4: [(f64, f64); 4] = [(1.0, 0.5), (2.0, 0.5), (2.0, 1.0), (1.0, 0.0)];

/// How a step is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// The classical Runge–Kutta method of order 4, as in the paper.
    Rk4,
    /// A linearly implicit method of order 2 that is stable at any step.
    Stable,
}

/// What stays the same during a part of a step.
#[derive(Clone, Copy, Debug)]
pub struct Held<S: Scalar> {
    /// Where the passage to the supply is open.
    pub supply: S::Mask,
    /// Where the passage to the surroundings is open.
    pub exhaust: S::Mask,
    /// Direction of sliding: −1, 0 or +1.
    pub sliding: S,
    /// Where friction holds the load at rest.
    pub stuck: S::Mask,
    /// The straight line that a prescribed motion by a table is on.
    pub line: Line<S>,
}

/// What follows from the state and what is held.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Observed<S> {
    pub(crate) tension: S,
    pub(crate) volume: S,
    pub(crate) temperature: S,
    pub(crate) flow: Flow<S>,
}

impl<S: Scalar> Rig<S> {
    /// Time derivatives of the four states, by selects: whatever the mode.
    #[inline(always)]
    pub fn rates<T: Over<S>>(&self, time: T, state: &[T; 4], held: &Held<S>) -> [T; 4] {
        let actuator = self.actuator();
        let [mut length, mut velocity, pressure, mass] = *state;
        let mut acceleration = T::zero();
        match self.load() {
            Load::Prescribed(motion) => [length, velocity, acceleration] = motion.on_line(time, &held.line),
            Load::Isometric => velocity = T::zero(),
            Load::HangingMass { .. } | Load::ConstantForce { .. } => {
                if let Some(inertia) = self.load().inertia() {
                    let tension = actuator.tension_sliding(length, velocity, pressure, T::of(held.sliding));
                    acceleration = T::select(held.stuck, T::zero(), inertia.acceleration(tension));
                    velocity = T::select(held.stuck, T::zero(), velocity);
                }
            }
        }
        let (chamber, flow) = self.contents(length, velocity, pressure, mass, held);
        [velocity, acceleration, actuator.pressure_rate(&chamber, &flow), flow.net()]
    }

    /// The air and its flow.
    #[inline(always)]
    fn contents<T: Over<S>>(
        &self,
        length: T,
        velocity: T,
        pressure: T,
        mass: T,
        held: &Held<S>,
    ) -> (Chamber<T>, Flow<T>) {
        let actuator = self.actuator();
        let slack = actuator.limits().is_slack(length);
        let chamber = actuator.chamber(length, velocity, pressure, mass, slack);
        (chamber, actuator.flow(&chamber, held.supply, held.exhaust))
    }

    /// What a sample shows beside the state.
    #[inline(always)]
    pub(crate) fn observe(&self, state: &[S; 4], held: &Held<S>) -> Observed<S> {
        let actuator = self.actuator();
        let [length, velocity, pressure, mass] = *state;
        let (chamber, flow) = self.contents(length, velocity, pressure, mass, held);
        let sliding = actuator.tension_sliding(length, velocity, pressure, held.sliding);
        let pull = self.load().inertia().map_or(sliding, |inertia| inertia.pull);
        let tension = S::select(held.stuck, pull, sliding);
        Observed { tension, volume: chamber.volume, temperature: actuator.air().temperature(&chamber), flow }
    }

    /// One part of a step, with a prescribed motion where it ends exactly.
    #[inline(always)]
    pub(crate) fn take(&self, method: Method, time: S, state: &[S; 4], step: S, held: &Held<S>) -> [S; 4] {
        let mut end = match method {
            Method::Rk4 => self.step_rk4(time, *state, step, held),
            Method::Stable => self.step_stable(time, *state, step, held),
        };
        if let Load::Prescribed(motion) = self.load() {
            [end[0], end[1], _] = motion.on_line(time + step, &held.line);
        }
        end
    }

    /// One part of a step by the classical Runge–Kutta method.
    #[inline(always)]
    pub fn step_rk4(&self, time: S, state: [S; 4], step: S, held: &Held<S>) -> [S; 4] {
        // One loop, so that the rates are compiled once.
        let (mut at, mut sum) = (state, [S::zero(); 4]);
        for (stage, (weight, reach)) in RK4.into_iter().enumerate() {
            let here = if stage == 0 { S::zero() } else { step * S::constant(RK4[stage - 1].1) };
            let slope = self.rates(time + here, &at, held);
            sum = ahead(&sum, S::constant(weight), &slope);
            at = ahead(&state, step * S::constant(reach), &slope);
        }
        ahead(&state, step * S::constant(1.0 / 6.0), &sum)
    }

    /// One part of a step by the stable method.
    #[inline(always)]
    pub fn step_stable(&self, time: S, state: [S; 4], step: S, held: &Held<S>) -> [S; 4] {
        let seeded: [Dual<S, 3>; 4] = core::array::from_fn(|n| Dual::variable(state[n], n));
        let rates = self.rates(Dual::of(time), &seeded, held);
        let first: [S; 4] = rates.map(|rate| rate.value);
        let matrix = Matrix::new(&rates, self.settling_rate(&state, &first, held), step);
        let k1 = matrix.solve(first);
        let second = self.rates(time + step, &ahead(&state, step, &k1), held);
        let k2 = matrix.solve(ahead(&second, S::constant(-2.0), &k1));
        ahead(&state, step * S::constant(0.5), &ahead(&k2, S::constant(3.0), &k1))
    }

    /// Rate in 1/s of the secant from the pressure to that of an open port: how fast it would settle at its present rate.
    #[inline(always)]
    fn settling_rate(&self, state: &[S; 4], rates: &[S; 4], held: &Held<S>) -> S {
        let Some(valve) = self.actuator().valve() else { return S::zero() };
        let one_open = (held.supply | held.exhaust) & !(held.supply & held.exhaust);
        let port = S::select(held.supply, valve.port_pressure(Port::Supply), valve.port_pressure(Port::Exhaust));
        let gap = port - state[2];
        let secant = rates[2] / gap;
        S::select(one_open & S::zero().lt(secant), secant, S::zero())
    }
}

/// `y + h k`.
#[inline(always)]
fn ahead<S: Scalar>(state: &[S; 4], step: S, slope: &[S; 4]) -> [S; 4] {
    // A loop and not a closure, so that nothing stands between it and the instruction set of the kernel it is part of.
    let mut end = *state;
    for n in 0..4 {
        end[n] = slope[n].multiply_add(step, state[n]);
    }
    end
}

/// `I − γhA` in the blocks that it has: length and velocity, pressure, air mass.
struct Matrix<S> {
    reach: S,
    velocity_by_length: S,
    velocity_pivot: S,
    pressure_pivot: S,
    mass_by_pressure: S,
}

impl<S: Scalar> Matrix<S> {
    #[inline(always)]
    fn new(rates: &[Dual<S, 3>; 4], settling: S, step: S) -> Self {
        let reach = step * S::constant(1.0 + core::f64::consts::FRAC_1_SQRT_2);
        let velocity_by_length = reach * rates[1].slope[0];
        let velocity_by_velocity = reach * rates[1].slope[1];
        let tangent = rates[2].slope[2].smaller(S::zero());
        let steeper = tangent.smaller(-settling);
        let by_pressure = rates[3].slope[2];
        // The air mass answers to the pressure along the same line, tangent or secant.
        let secant_mass = -settling * rates[3].value / rates[2].value;
        let takes_secant = (-settling).lt(tangent);
        Self {
            reach,
            velocity_by_length,
            velocity_pivot: S::one() / (S::one() - velocity_by_velocity - reach * velocity_by_length),
            pressure_pivot: S::one() / (S::one() - reach * steeper),
            mass_by_pressure: reach * S::select(takes_secant, secant_mass, by_pressure),
        }
    }

    #[inline(always)]
    fn solve(&self, right: [S; 4]) -> [S; 4] {
        let velocity = (right[1] + self.velocity_by_length * right[0]) * self.velocity_pivot;
        let pressure = right[2] * self.pressure_pivot;
        [right[0] + self.reach * velocity, velocity, pressure, right[3] + self.mass_by_pressure * pressure]
    }
}
