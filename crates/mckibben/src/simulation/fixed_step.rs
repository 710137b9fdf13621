//! The fixed-step engine: bounded cost, no allocation, valve edges honoured inside the step.
//!
//! A step of length `h` is divided at every instant at which a seat moves or a prescribed motion turns, where the tendon
//! falls slack or tight, where the braid comes taut or ceases to pull, and, with Coulomb friction, where the velocity comes
//! to zero: there the load sticks if friction can hold it. Each part is one step of
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
//! The kernels take masks and selects instead of branches, so that they also run on lanes.
//! What error a step leaves is in `docs/accuracy.md`; a step for an accuracy is chosen by [`super::accuracy`].
//!
//! Source: Verwer, Spee, Blom & Hundsdorfer, SIAM J. Sci. Comput. 20 (1999). Checked by `tests/fixed_step.rs`.

use super::mode::{Extent, Sliding};
use super::rig::{Rig, State};
use super::sample::Sample;
use crate::air::Flow;
use crate::dual::Dual;
use crate::error::Error;
use crate::load::Load;
use crate::scalar::{Mask, Over, Real, Scalar};
use crate::valve::{Port, Ports, SeatClock};

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
    /// Where the tendon is slack.
    pub slack: S::Mask,
    /// Where the taut braid pulls.
    pub taut: S::Mask,
    /// Corners of a prescribed motion that have been passed.
    pub corners_passed: usize,
}

impl<S: Scalar> Rig<S> {
    /// Time derivatives of the four states, by selects: whatever the mode.
    #[inline(always)]
    pub fn rates<T: Over<S>>(&self, time: T, state: &[T; 4], held: &Held<S>) -> [T; 4] {
        let actuator = self.actuator();
        let [mut length, mut velocity, pressure, mass] = *state;
        let mut acceleration = T::zero();
        match self.load() {
            Load::Prescribed(motion) => [length, velocity, acceleration] = motion.at(time, held.corners_passed),
            Load::Isometric => velocity = T::zero(),
            Load::HangingMass { .. } | Load::ConstantForce { .. } => {
                if let Some(inertia) = self.load().inertia() {
                    let ends = [length, velocity, pressure];
                    let effectiveness = actuator.law().effectiveness.at(actuator.gauge(pressure));
                    let force = actuator.signed_force(ends, T::of(held.sliding), held.taut, effectiveness);
                    let tension = T::select(held.slack, T::zero(), force.larger(T::zero()));
                    let free = (T::of(inertia.pull) - tension) / T::of(inertia.mass);
                    acceleration = T::select(held.stuck, T::zero(), free);
                    velocity = T::select(held.stuck, T::zero(), velocity);
                }
            }
        }
        let chamber = actuator.chamber(length, velocity, pressure, mass, held.slack);
        let flow = actuator.flow(&chamber, held.supply, held.exhaust);
        [velocity, acceleration, actuator.pressure_rate(&chamber, &flow), flow.net()]
    }

    /// One part of a step by the classical Runge–Kutta method.
    #[inline(always)]
    pub fn step_rk4(&self, time: S, state: [S; 4], step: S, held: &Held<S>) -> [S; 4] {
        let half = step * S::constant(0.5);
        let ahead = |slope: &[S; 4], by: S| core::array::from_fn(|n| slope[n].multiply_add(by, state[n]));
        let k1 = self.rates(time, &state, held);
        let k2 = self.rates(time + half, &ahead(&k1, half), held);
        let k3 = self.rates(time + half, &ahead(&k2, half), held);
        let k4 = self.rates(time + step, &ahead(&k3, step), held);
        let (sixth, two) = (step * S::constant(1.0 / 6.0), S::constant(2.0));
        core::array::from_fn(|n| state[n] + sixth * (k1[n] + two * (k2[n] + k3[n]) + k4[n]))
    }

    /// One part of a step by the stable method.
    #[inline(always)]
    pub fn step_stable(&self, time: S, state: [S; 4], step: S, held: &Held<S>) -> [S; 4] {
        let seeded: [Dual<S, 3>; 4] = core::array::from_fn(|n| Dual::variable(state[n], n));
        let rates = self.rates(Dual::of(time), &seeded, held);
        let first: [S; 4] = rates.map(|rate| rate.value);
        let matrix = Matrix::new(&rates, self.secant(&state, &first, held), step);
        let k1 = matrix.solve(first);
        let predicted: [S; 4] = core::array::from_fn(|n| k1[n].multiply_add(step, state[n]));
        let second = self.rates(time + step, &predicted, held);
        let k2 = matrix.solve(core::array::from_fn(|n| second[n] - S::constant(2.0) * k1[n]));
        let half = step * S::constant(0.5);
        core::array::from_fn(|n| state[n] + half * (S::constant(3.0) * k1[n] + k2[n]))
    }

    /// The secant from the pressure to that of an open port: of the pressure's rate in 1/s, and of the air mass's in
    /// kg/(s·Pa), by the flow alone. What else moves the pressure (the volume, heat) does not settle at the port.
    #[inline(always)]
    fn secant(&self, state: &[S; 4], rates: &[S; 4], held: &Held<S>) -> [S; 2] {
        let actuator = self.actuator();
        let Some(valve) = actuator.valve() else { return [S::zero(); 2] };
        let one_open = (held.supply | held.exhaust) & !(held.supply & held.exhaust);
        let port = S::select(held.supply, valve.port_pressure(Port::Supply), valve.port_pressure(Port::Exhaust));
        let [length, _, pressure, mass] = *state;
        let chamber = actuator.chamber(length, rates[0], pressure, mass, held.slack);
        let by_flow = rates[2] - actuator.pressure_rate(&chamber, &Flow::none());
        let gap = port - pressure;
        let settling = by_flow / gap;
        // Where the pressures are equal there is no secant, and the tangent has the slope of the straight line.
        let settles = one_open & S::zero().lt(gap.magnitude()) & S::zero().lt(settling);
        [settling, rates[3] / gap].map(|slope| S::select(settles, slope, S::zero()))
    }
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
    fn new(rates: &[Dual<S, 3>; 4], [settling, mass_settling]: [S; 2], step: S) -> Self {
        let reach = step * S::constant(1.0 + core::f64::consts::FRAC_1_SQRT_2);
        let velocity_by_length = reach * rates[1].slope[0];
        let velocity_by_velocity = reach * rates[1].slope[1];
        let tangent = rates[2].slope[2].smaller(S::zero());
        let steeper = tangent.smaller(-settling);
        let takes_secant = (-settling).lt(tangent);
        Self {
            reach,
            velocity_by_length,
            velocity_pivot: S::one() / (S::one() - velocity_by_velocity - reach * velocity_by_length),
            pressure_pivot: S::one() / (S::one() - reach * steeper),
            // The air mass answers to the pressure along the same line, tangent or secant.
            mass_by_pressure: reach * S::select(takes_secant, -mass_settling, rates[3].slope[2]),
        }
    }

    #[inline(always)]
    fn solve(&self, right: [S; 4]) -> [S; 4] {
        let velocity = (right[1] + self.velocity_by_length * right[0]) * self.velocity_pivot;
        let pressure = right[2] * self.pressure_pivot;
        [right[0] + self.reach * velocity, velocity, pressure, right[3] + self.mass_by_pressure * pressure]
    }
}

/// Steps one rig through time at fixed steps; no allocation.
#[derive(Clone, Debug)]
pub struct FixedStepper<'a, R: Real = f64> {
    rig: &'a Rig<R>,
    method: Method,
    time: R,
    state: [R; 4],
    clock: SeatClock<R>,
    ports: Ports,
    corners_passed: usize,
    sliding: Sliding,
    /// Slack, taut, or free: between the limits or beyond without pull.
    extent: Extent,
}

/// What a part of a step may end at before its time.
#[derive(Clone, Copy, Debug)]
enum Turn {
    /// The direction of sliding ceases to hold.
    Sliding,
    /// The extent ceases to hold.
    Extent,
}

/// Parts of a step between two instants that may end at a turn before the rest is taken as it is.
const MAX_TURNS: usize = 4;
/// Part of a step to which a turn is located.
const TURN_TOLERANCE: f64 = 1e-12;
/// Part of a step that a load which starts from rest, or on a limit, moves before a turn is looked for.
const FROM_REST: f64 = 1e-3;

impl<'a, R: Real> FixedStepper<'a, R> {
    /// Starts at t = 0 in a state.
    pub fn new(rig: &'a Rig<R>, start: State<R>, method: Method) -> Self {
        let mut stepper = Self {
            rig,
            method,
            time: R::zero(),
            state: start.to_array(),
            clock: SeatClock::released(),
            ports: Ports::CLOSED,
            corners_passed: 0,
            sliding: Sliding::Held,
            extent: Extent::Free,
        };
        stepper.pass_instants();
        stepper.sliding = stepper.sliding_from_rest_or_velocity();
        stepper
    }

    /// The time in s that has been reached.
    pub fn time(&self) -> R {
        self.time
    }

    /// The state at that time.
    pub fn state(&self) -> State<R> {
        State::from_array(self.state)
    }

    /// Which passages are open at that time.
    pub fn ports(&self) -> Ports {
        self.ports
    }

    /// Everything that is known at that time.
    pub fn sample(&self) -> Sample<R> {
        let actuator = self.rig.actuator();
        let [length, velocity, pressure, mass] = self.state;
        let slack = actuator.limits().is_slack(length);
        let chamber = actuator.chamber(length, velocity, pressure, mass, slack);
        let flow = actuator.flow(&chamber, self.ports.supply, self.ports.exhaust);
        let tension = match (self.sliding, self.rig.load().inertia()) {
            (Sliding::Stuck, Some(inertia)) => inertia.pull,
            _ => {
                let direction = R::constant(self.sliding.direction());
                actuator.tension_sliding(length, velocity, pressure, direction)
            }
        };
        let temperature = actuator.air().temperature(&chamber);
        Sample::new(self.time, &self.state, tension, chamber.volume, temperature, &flow, self.ports)
    }

    /// Goes on to `until` in one step, divided where something switches.
    ///
    /// # Errors
    /// [`Error::Stopped`] when the step was so long that it left the physics; the state is then the last good one.
    pub fn advance_to(&mut self, until: R) -> Result<(), Error> {
        loop {
            let instant = self.rig.next_instant(&self.clock, self.corners_passed, until);
            let part_end = instant.unwrap_or(until);
            let before = (self.time, self.state, self.sliding, self.extent);
            self.advance_smoothly(part_end);
            if let Err(error) = self.check() {
                (self.time, self.state, self.sliding, self.extent) = before;
                return Err(error);
            }
            if instant.is_none() {
                return Ok(());
            }
            self.pass_instants();
            self.sliding = self.sliding_from_rest_or_velocity();
        }
    }

    /// Whether the state is one that the laws hold for.
    fn check(&self) -> Result<(), Error> {
        let [length, velocity, pressure, air_mass] = self.state.map(Real::value);
        let thread = self.rig.actuator().law().law.braid.thread_length().value();
        let numbers = [
            ("length", length, "m", length < thread),
            ("velocity", velocity, "m/s", true),
            ("absolute pressure", pressure, "Pa", pressure > 0.0),
            ("air mass", air_mass, "kg", air_mass > 0.0),
        ];
        match numbers.into_iter().find(|(_, value, _, admissible)| !(value.is_finite() && *admissible)) {
            None => Ok(()),
            Some((quantity, value, unit, _)) => Err(Error::Stopped {
                time: self.time.value(),
                reason: "a step of the fixed-step engine left the physics",
                quantity,
                value,
                unit,
                remedy: "shorten run.step, or set run.method = \"stable\" or run.engine = \"event-located\"",
            }),
        }
    }

    fn pass_instants(&mut self) {
        if let Some(drive) = self.rig.actuation() {
            self.clock.advance(self.time, &drive.solenoid, &drive.command);
            self.ports = self.clock.ports(&drive.solenoid);
        }
        self.corners_passed = self.rig.corners_passed(self.corners_passed, self.time);
    }

    fn held(&self) -> Held<R> {
        Held {
            supply: self.ports.supply,
            exhaust: self.ports.exhaust,
            sliding: R::constant(self.sliding.direction()),
            stuck: self.sliding == Sliding::Stuck,
            slack: self.extent == Extent::Slack,
            taut: self.extent == Extent::Taut,
            corners_passed: self.corners_passed,
        }
    }

    fn take(&self, step: R) -> [R; 4] {
        let held = self.held();
        let mut state = match self.method {
            Method::Rk4 => self.rig.step_rk4(self.time, self.state, step, &held),
            Method::Stable => self.rig.step_stable(self.time, self.state, step, &held),
        };
        if let Load::Prescribed(motion) = self.rig.load() {
            let [length, velocity, _] = motion.at(self.time + step, self.corners_passed);
            (state[0], state[1]) = (length, velocity);
        }
        state
    }

    /// Goes on to `until` with the same passages open, in parts that end where the load turns, sticks or breaks away, and
    /// where it passes a limit of the length.
    fn advance_smoothly(&mut self, until: R) {
        if self.keeps_extent(&self.state) < 0.0 {
            self.extent = self.extent_of(&self.state);
        }
        for _ in 0..MAX_TURNS {
            let step = until - self.time;
            if step.value() <= 0.0 {
                break;
            }
            let end = self.take(step);
            let turns = [Turn::Sliding, Turn::Extent].into_iter().filter(|&turn| self.keeps(turn, &end) < 0.0);
            let first = turns.map(|turn| (self.part_to(turn, step), turn)).min_by(|a, b| a.0.total_cmp(&b.0));
            let Some((part, turn)) = first else {
                self.state = end;
                self.time = until;
                break;
            };
            let part = R::constant(part) * step;
            self.state = self.take(part);
            self.time = self.time + part;
            match turn {
                Turn::Sliding => {
                    if self.sliding != Sliding::Stuck {
                        self.state[1] = R::zero();
                    }
                    self.sliding = self.sliding_after(self.sliding);
                }
                Turn::Extent => self.extent = self.extent_after(),
            }
        }
        if self.time.value() < until.value() {
            self.state = self.take(until - self.time);
            self.time = until;
        }
        if self.rig.load().inertia().is_none() {
            self.sliding = self.sliding_from_rest_or_velocity();
        }
    }

    /// The part of a step at whose end something ceases to hold that does not hold at the end of the whole.
    fn part_to(&self, turn: Turn, step: R) -> f64 {
        let keeps = |theta: f64| self.keeps(turn, &self.take(R::constant(theta) * step));
        // From rest or from a limit the function starts at zero, or a rounding below: look away from the start.
        let from = if keeps(0.0) > 0.0 { 0.0 } else { FROM_REST };
        crate::root::bracketed(from, 1.0, TURN_TOLERANCE, keeps)
    }

    /// Negative where something has ceased to hold.
    fn keeps(&self, turn: Turn, state: &[R; 4]) -> f64 {
        match turn {
            Turn::Sliding => self.keeps_sliding(state),
            Turn::Extent => self.keeps_extent(state),
        }
    }

    /// The length in m by which a state is within the extent, negative beyond. The force of the taut braid counts as the
    /// stretch that it would take at rest.
    fn keeps_extent(&self, state: &[R; 4]) -> f64 {
        let limits = self.rig.actuator().limits();
        let above = (state[0] - limits.min_length()).value();
        let stretched = (state[0] - limits.max_length()).value();
        let taut = stretched.min((limits.taut_force(state[0], state[1]) / limits.stiffness()).value());
        match self.extent {
            Extent::Slack => -above,
            Extent::Taut => taut,
            Extent::Free | Extent::Rebound => above.min(-taut),
        }
    }

    /// The extent of a state that lies on no limit.
    fn extent_of(&self, state: &[R; 4]) -> Extent {
        let limits = self.rig.actuator().limits();
        let pulls = limits.force(state[0], state[1]).value() > 0.0;
        match limits.is_slack(state[0]).any() {
            true => Extent::Slack,
            false if pulls => Extent::Taut,
            false => Extent::Free,
        }
    }

    /// The extent after the present one has ceased to hold.
    fn extent_after(&self) -> Extent {
        let limits = self.rig.actuator().limits();
        let middle = 0.5 * (limits.min_length() + limits.max_length()).value();
        match self.extent {
            Extent::Slack | Extent::Taut => Extent::Free,
            Extent::Free | Extent::Rebound if self.state[0].value() < middle => Extent::Slack,
            Extent::Free | Extent::Rebound => Extent::Taut,
        }
    }

    /// Negative where the direction of sliding has ceased to hold: the velocity has turned, or the load broke away.
    fn keeps_sliding(&self, state: &[R; 4]) -> f64 {
        let Some(inertia) = self.rig.load().inertia() else { return 1.0 };
        match self.sliding {
            Sliding::Stuck => {
                let (least, most) = self.rig.holdable(state[0], state[2]);
                (most - inertia.pull).smaller(inertia.pull - least).value()
            }
            sliding => sliding.direction() * state[1].value(),
        }
    }

    /// The direction after the present one has ceased to hold; a load that broke away does not stick in the same instant.
    fn sliding_after(&self, before: Sliding) -> Sliding {
        let after = self.sliding_from_rest_or_velocity();
        if before != Sliding::Stuck || after != Sliding::Stuck {
            return after;
        }
        let (least, most) = self.rig.holdable(self.state[0], self.state[2]);
        let pull = self.rig.load().inertia().map_or(R::zero(), |inertia| inertia.pull);
        if (most - pull).value() < (pull - least).value() { Sliding::Lengthening } else { Sliding::Shortening }
    }

    /// The direction of sliding at the present state, or sticking at rest.
    fn sliding_from_rest_or_velocity(&self) -> Sliding {
        let velocity = self.state[1].value();
        let Some(inertia) = self.rig.load().inertia() else {
            return if velocity == 0.0 { Sliding::Held } else { self.rig.sliding(velocity) };
        };
        if velocity != 0.0 || !self.rig.actuator().friction().has_coulomb() {
            return self.rig.sliding(velocity);
        }
        let (least, most) = self.rig.holdable(self.state[0], self.state[2]);
        if most.value() < inertia.pull.value() {
            Sliding::Lengthening
        } else if inertia.pull.value() < least.value() {
            Sliding::Shortening
        } else if self.rig.actuator().limits().is_slack(self.state[0]).any() {
            self.rig.sliding(inertia.pull.value())
        } else {
            Sliding::Stuck
        }
    }
}
