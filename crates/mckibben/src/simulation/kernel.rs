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
//! pressure, the steeper of the tangent and the secant of the flow's part to the port's pressure, so that no flow
//! overshoots the port. With this γ the first stage goes at most 0.59 of the way.
//!
//! The second stage may still ask for more air than there is, where a passage empties the actuator many times over within
//! the step. A part that would leave less than an eighth of the pressure or of the air is taken by one stage with γ = 1
//! instead, which leaves some whatever the step.
//!
//! Masks and selects stand where branches would, and everything is inlined, so that all of it becomes part of the kernel
//! that calls it and is compiled for that kernel's instructions. With a hose or a supply that changes the step is that of
//! [`piped`](super::piped).
//!
//! Source: Verwer, Spee, Blom & Hundsdorfer, SIAM J. Sci. Comput. 20 (1999). Checked by `tests/fixed_step.rs`.

use super::piped::{PLAIN, Stepped, of_rig};
use super::rig::Rig;
use crate::actuator::Actuator;
use crate::air::{Chamber, Flow};
use crate::dual::Dual;
use crate::force::Statics;
use crate::friction::{Memory, Rubbing};
use crate::load::{Line, Load};
use crate::scalar::{Mask, Over, Scalar};
use crate::valve::{Openings, Port, Valve};

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
    /// How far the passages are open where they are not whole, or what lies beyond; with several lanes neither.
    pub openings: Openings<S>,
    /// Direction of sliding: −1, 0 or +1.
    pub sliding: S,
    /// Where friction holds the load at rest.
    pub stuck: S::Mask,
    /// Where the tendon is slack.
    pub slack: S::Mask,
    /// Where the taut braid pulls.
    pub taut: S::Mask,
    /// Where the compressor runs.
    pub compressor: S::Mask,
    /// The straight line that a prescribed motion by a table is on.
    pub line: Line<S>,
    /// What the hysteresis remembers of where the part began.
    pub memory: Memory<S>,
}

impl<S: Scalar> Held<S> {
    /// Before anything is known: shut, and free to move between the limits of the length.
    pub(crate) fn nothing() -> Self {
        let nowhere = S::Mask::splat(false);
        Self {
            supply: nowhere,
            exhaust: nowhere,
            openings: Openings::Whole,
            sliding: S::zero(),
            stuck: nowhere,
            slack: nowhere,
            taut: nowhere,
            compressor: nowhere,
            line: Line::resting(S::zero()),
            memory: Memory::relaxed(S::zero()),
        }
    }

    /// The same for a stable step of `step` s from a time in s, where the pressure beyond the passage changes.
    #[inline(always)]
    pub(super) fn midway(&self, method: Method, time: S, step: S) -> Option<Self> {
        if !S::IS_ONE || method != Method::Stable {
            return None;
        }
        Some(Self { openings: self.openings.midway(time, step)?, ..*self })
    }

    /// The absolute pressure in Pa beyond the passage to the supply at a time in s.
    #[inline(always)]
    pub(super) fn supply_pressure(&self, valve: &Valve<S>, time: S) -> S {
        let own = valve.port_pressure(Port::Supply);
        if S::IS_ONE { self.openings.pressure(time).unwrap_or(own) } else { own }
    }

    /// The same with the passages as they are at a time in s, where they are under way.
    #[inline(always)]
    pub(super) fn come_to(&self, time: S) -> Option<Self> {
        if !S::IS_ONE {
            return None;
        }
        Some(Self { openings: self.openings.come_to(time)?, ..*self })
    }
}

/// What follows from the state and what is held.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Observed<S> {
    pub(crate) tension: S,
    pub(crate) volume: S,
    pub(crate) temperature: S,
    pub(crate) flow: Flow<S>,
}

impl<S: Scalar, L: Statics<S>> Rig<S, L> {
    /// Time derivatives of the four states, by selects: whatever the mode.
    #[inline(always)]
    pub fn rates<T: Over<S>>(&self, time: T, state: &[T; 4], held: &Held<S>) -> [T; 4] {
        let [length, velocity, pressure, mass] = *state;
        let [length, velocity, acceleration] = self.motion(time, [length, velocity, pressure], held);
        let (chamber, flow) = self.contents(time, [length, velocity, pressure, mass], held, held.slack);
        [velocity, acceleration, self.actuator().pressure_rate(&chamber, &flow), flow.net()]
    }

    /// Length, velocity and acceleration of the ends as the load has them.
    #[inline(always)]
    pub(crate) fn motion<T: Over<S>>(&self, time: T, ends: [T; 3], held: &Held<S>) -> [T; 3] {
        let [length, velocity, pressure] = ends;
        match self.load() {
            Load::Prescribed(motion) => motion.on_line(time, &held.line),
            Load::Isometric => [length, T::zero(), T::zero()],
            Load::HangingMass { .. } | Load::ConstantForce { .. } => {
                let Some(inertia) = self.load().inertia() else { return [length, velocity, T::zero()] };
                let actuator = self.actuator();
                let factors = actuator.factors(length, pressure);
                let force = actuator.signed_force(ends, self.rubbing(length, velocity, held), held.taut, factors);
                let tension = T::select(held.slack, T::zero(), force.larger(T::zero()));
                let acceleration = T::select(held.stuck, T::zero(), inertia.acceleration(tension));
                [length, T::select(held.stuck, T::zero(), velocity), acceleration]
            }
        }
    }

    /// How the threads rub where the ends have come to `length` (m) and `velocity` (m/s).
    #[inline(always)]
    pub(super) fn rubbing<T: Over<S>>(&self, length: T, velocity: T, held: &Held<S>) -> Rubbing<T> {
        Rubbing { width: self.actuator().width(&held.memory, length, velocity), ..T::of(held.sliding).into() }
    }

    /// Flow through the valve from a chamber at its end of the line.
    #[inline(always)]
    pub(super) fn through_valve<T: Over<S>>(&self, time: T, chamber: &Chamber<T>, held: &Held<S>) -> Flow<T> {
        let actuator = self.actuator();
        if S::IS_ONE
            && let Some(valve) = actuator.valve()
            && let Some(flow) = valve.flow_through(&held.openings, time, [held.supply, held.exhaust], chamber)
        {
            return flow;
        }
        actuator.flow(chamber, held.supply, held.exhaust)
    }

    /// The air and its flow.
    #[inline(always)]
    fn contents<T: Over<S>>(&self, time: T, state: [T; 4], held: &Held<S>, slack: S::Mask) -> (Chamber<T>, Flow<T>) {
        let actuator = self.actuator();
        let [length, velocity, pressure, mass] = state;
        let chamber = actuator.chamber(length, velocity, pressure, mass, slack);
        let flow = self.through_valve(time, &chamber, held);
        (chamber, self.with_leak(&chamber, flow))
    }

    /// What a sample shows beside the state at a time in s.
    #[inline(always)]
    pub(crate) fn observe<const N: usize>(&self, time: S, state: &Stepped<S, N>, held: &Held<S>) -> Observed<S> {
        let actuator = self.actuator();
        let [length, velocity, pressure, _] = of_rig(state);
        let (chamber, mut flow) = self.contents(time, of_rig(state), held, actuator.limits().is_slack(length));
        if N > PLAIN && self.is_piped() {
            flow = self.actuator_inflow(time, state, &chamber, held);
        }
        let sliding = actuator.tension_sliding(length, velocity, pressure, self.rubbing(length, velocity, held));
        let pull = self.load().inertia().map_or(sliding, |inertia| inertia.pull);
        let tension = S::select(held.stuck, pull, sliding);
        Observed { tension, volume: chamber.volume, temperature: actuator.air().temperature(&chamber), flow }
    }

    /// One part of a step by the classical Runge–Kutta method.
    #[inline(always)]
    pub fn step_rk4(&self, time: S, state: [S; 4], step: S, held: &Held<S>) -> [S; 4] {
        // A loop, so that the rates are compiled once.
        let mut slopes = [[S::zero(); 4]; 4];
        for (stage, reach) in reaches(step).into_iter().enumerate() {
            let at = ahead(&state, reach, &slopes[stage.saturating_sub(1)]);
            slopes[stage] = self.rates(time + reach, &at, held);
        }
        gathered(&state, step, &slopes)
    }

    /// One part of a step by the stable method.
    #[inline(always)]
    pub fn step_stable(&self, time: S, state: [S; 4], step: S, held: &Held<S>) -> [S; 4] {
        let (first, slopes) = self.rates_with_slopes(time, &state, held);
        let matrix = Matrix::new(&slopes, self.settling_rate(time, &state, &first, held), step);
        let k1 = matrix.solve(first);
        let second = self.rates(time + step, &ahead(&state, step, &k1), held);
        let second = ahead(&second, S::constant(-2.0), &k1);
        // Where passages are under way the second stage has the matrix of what they come to: the order stays.
        let k2 = match held.come_to(time + step) {
            None => matrix.solve(second),
            Some(held) => {
                let (rates, slopes) = self.rates_with_slopes(time, &state, &held);
                Matrix::new(&slopes, self.settling_rate(time, &state, &rates, &held), step).solve(second)
            }
        };
        ahead(&state, step * S::constant(0.5), &ahead(&k2, S::constant(3.0), &k1))
    }

    /// One part of a step by the linearly implicit Euler method, of order 1: the air goes along the steeper of tangent and
    /// secant, so that it comes nearer to the port and never beyond, and its mass goes with it,
    /// `|Δm| ≤ |ṁ|/s ≤ m |P_port − P|/(κP)`.
    #[inline(always)]
    pub(super) fn step_firm(&self, time: S, state: [S; 4], step: S, held: &Held<S>) -> [S; 4] {
        let (first, slopes) = self.rates_with_slopes(time, &state, held);
        let settling = self.settling_rate(time, &state, &first, held);
        let matrix = Matrix::of_reach(&slopes, settling, step);
        let mut slope = matrix.solve(first);
        slope[3] = matrix.with_the_pressure(first[3]);
        ahead(&state, step, &slope)
    }

    /// Time derivatives of the four states, and those of their slopes that the stable method uses.
    #[inline(always)]
    fn rates_with_slopes(&self, time: S, state: &[S; 4], held: &Held<S>) -> ([S; 4], Slopes<S>) {
        let [length, velocity, pressure, mass] = *state;
        let ends: [Dual<S, 2>; 3] = [Dual::variable(length, 0), Dual::variable(velocity, 1), Dual::of(pressure)];
        let [length, velocity, acceleration] = self.motion(Dual::of(time), ends, held);
        let ends = [Dual::of(length.value), Dual::of(velocity.value)];
        let air: [Dual<S, 1>; 4] = [ends[0], ends[1], Dual::variable(pressure, 0), Dual::of(mass)];
        let (chamber, flow) = self.contents(Dual::of(time), air, held, held.slack);
        let (pressure_rate, mass_rate) = (self.actuator().pressure_rate(&chamber, &flow), flow.net());
        let slopes = Slopes {
            acceleration: acceleration.slope,
            pressure_rate: pressure_rate.slope[0],
            mass_rate: mass_rate.slope[0],
        };
        ([velocity.value, acceleration.value, pressure_rate.value, mass_rate.value], slopes)
    }

    /// The secant from the pressure to that of an open port: of the pressure's rate in 1/s, and of the air mass's in
    /// kg/(s·Pa), by the flow alone. What else moves the pressure (the volume, heat) does not settle at the port.
    #[inline(always)]
    fn settling_rate(&self, time: S, state: &[S; 4], rates: &[S; 4], held: &Held<S>) -> [S; 2] {
        let actuator = self.actuator();
        let Some(valve) = actuator.valve() else { return [S::zero(); 2] };
        if S::IS_ONE
            && let Some(shares) = held.openings.at(time)
        {
            let [length, _, pressure, mass] = *state;
            let chamber = actuator.chamber(length, rates[0], pressure, mass, held.slack);
            return secants_of_shares(actuator, valve, &chamber, [held.supply, held.exhaust], shares);
        }
        let one_open = (held.supply | held.exhaust) & !(held.supply & held.exhaust);
        let port = S::select(held.supply, held.supply_pressure(valve, time), valve.port_pressure(Port::Exhaust));
        let [length, _, pressure, mass] = *state;
        let chamber = actuator.chamber(length, rates[0], pressure, mass, held.slack);
        let (beside, by_mass) = match self.leak(&chamber) {
            None => (Flow::none(), rates[3]),
            Some(leak) => (leak, rates[3] - leak.net()),
        };
        let by_flow = rates[2] - actuator.pressure_rate(&chamber, &beside);
        let gap = port - pressure;
        let per_gap = S::one() / gap;
        let settling = by_flow * per_gap;
        // Where the pressures are equal there is no secant, and the tangent has the slope of the straight line.
        let settles = one_open & S::zero().lt(gap.magnitude()) & S::zero().lt(settling);
        [S::select(settles, settling, S::zero()), S::select(settles, by_mass * per_gap, S::zero())]
    }
}

/// The settling rate of a rig whose passages are open to shares: the sum of the secants to both ports.
pub(super) fn secants_of_shares<S: Scalar, L: Statics<S>>(
    actuator: &Actuator<S, L>,
    valve: &Valve<S>,
    chamber: &Chamber<S>,
    open: [S::Mask; 2],
    shares: [S; 2],
) -> [S; 2] {
    let still = actuator.pressure_rate(chamber, &Flow::none());
    through_shares(valve, chamber, open, shares).into_iter().fold([S::zero(); 2], |[settling, by_mass], (gap, flow)| {
        let secant = (actuator.pressure_rate(chamber, &flow) - still) / gap;
        let settles = S::zero().lt(gap.magnitude()) & S::zero().lt(secant);
        let of_mass = S::select(settles, flow.net() / gap, S::zero());
        [settling + S::select(settles, secant, S::zero()), by_mass + of_mass]
    })
}

/// Flow through each open passage by its share, with the gap from the chamber's pressure to that of the port in Pa.
pub(super) fn through_shares<S: Scalar>(
    valve: &Valve<S>,
    chamber: &Chamber<S>,
    [supply, exhaust]: [S::Mask; 2],
    shares: [S; 2],
) -> [(S, Flow<S>); 2] {
    let through = |port, open: S::Mask, share: S| {
        let flow = valve.flow(port, chamber).where_open(open).through(share);
        (valve.port_pressure(port) - chamber.pressure, flow)
    };
    [through(Port::Supply, supply, shares[0]), through(Port::Exhaust, exhaust, shares[1])]
}

/// How far ahead each stage of the Runge–Kutta method looks.
#[inline(always)]
pub(super) fn reaches<S: Scalar>(step: S) -> [S; 4] {
    let half = S::constant(0.5) * step;
    [S::zero(), half, half, step]
}

/// What the four stages of the Runge–Kutta method come to.
#[inline(always)]
pub(super) fn gathered<S: Scalar, const N: usize>(state: &[S; N], step: S, [k1, k2, k3, k4]: &[[S; N]; 4]) -> [S; N] {
    let (outer, inner) = (ahead(k1, S::one(), k4), ahead(k2, S::one(), k3));
    ahead(state, step * S::constant(1.0 / 6.0), &ahead(&outer, S::constant(2.0), &inner))
}

/// `y + h k`.
#[inline(always)]
pub(super) fn ahead<S: Scalar, const N: usize>(state: &[S; N], step: S, slope: &[S; N]) -> [S; N] {
    let mut end = *state;
    for n in 0..N {
        end[n] = slope[n].multiply_add(step, state[n]);
    }
    end
}

/// Part of pressure and air mass that a stable step leaves at least, or is not believed. From the paper's supply to the
/// atmosphere at a constant temperature it is more than this.
const LEAST_LEFT: f64 = 0.125;

/// Where pressure (Pa) and air mass (kg) are left enough of what they were.
#[inline(always)]
pub(super) fn leaves_enough<S: Scalar>(before: [S; 2], after: [S; 2]) -> S::Mask {
    let least = S::constant(LEAST_LEFT);
    (least * before[0]).lt(after[0]) & (least * before[1]).lt(after[1])
}

/// γh.
#[inline(always)]
pub(super) fn reach<S: Scalar>(step: S) -> S {
    step * S::constant(1.0 + core::f64::consts::FRAC_1_SQRT_2)
}

/// What the matrix of the stable method is made of.
pub(super) struct Slopes<S> {
    /// Of the acceleration, by length and by velocity.
    pub(super) acceleration: [S; 2],
    /// Of the pressure's rate, by the pressure.
    pub(super) pressure_rate: S,
    /// Of the air mass's rate, by the pressure.
    pub(super) mass_rate: S,
}

/// `I − γhA` in the blocks that it has: length and velocity, pressure, air mass.
pub(super) struct Matrix<S> {
    reach: S,
    velocity_by_length: S,
    velocity_pivot: S,
    pressure_pivot: S,
    mass_by_pressure: S,
}

impl<S: Scalar> Matrix<S> {
    #[inline(always)]
    pub(super) fn new(slopes: &Slopes<S>, settling: [S; 2], step: S) -> Self {
        Self::of_reach(slopes, settling, reach(step))
    }

    /// The same with γh given.
    #[inline(always)]
    pub(super) fn of_reach(slopes: &Slopes<S>, [settling, mass_settling]: [S; 2], reach: S) -> Self {
        let velocity_by_length = reach * slopes.acceleration[0];
        let velocity_by_velocity = reach * slopes.acceleration[1];
        let tangent = slopes.pressure_rate.smaller(S::zero());
        let steeper = tangent.smaller(-settling);
        let takes_secant = (-settling).lt(tangent);
        Self {
            reach,
            velocity_by_length,
            velocity_pivot: S::one() / (S::one() - velocity_by_velocity - reach * velocity_by_length),
            pressure_pivot: S::one() / (S::one() - reach * steeper),
            // The air mass answers to the pressure along the same line, tangent or secant.
            mass_by_pressure: reach * S::select(takes_secant, -mass_settling, slopes.mass_rate),
        }
    }

    /// The slope of an air mass that goes as far as the pressure does, in the same part of its way.
    #[inline(always)]
    pub(super) fn with_the_pressure(&self, rate: S) -> S {
        rate * self.pressure_pivot
    }

    #[inline(always)]
    pub(super) fn solve(&self, right: [S; 4]) -> [S; 4] {
        let velocity = (right[1] + self.velocity_by_length * right[0]) * self.velocity_pivot;
        let pressure = right[2] * self.pressure_pivot;
        [right[0] + self.reach * velocity, velocity, pressure, right[3] + self.mass_by_pressure * pressure]
    }
}
