//! A joint at fixed steps: bounded cost, no allocation, every motion of a seat inside the step.
//!
//! A step is divided at every instant at which a seat moves or arrives, a spool passes an edge or a regulated pressure takes
//! another course, where an actuator falls slack, tight, taut or lets go, where a
//! stop is met or left, and, with Coulomb friction, where the joint comes to rest: there it sticks if both frictions
//! together can hold it. Each part is one step of a [`Method`], of order 2 or 4; a row of a moment arm's table, whose slope
//! has a corner there, leaves order 2.
//!
//! What is stepped is the caller's: a [`JointStepper`] holds the parameters alone, and any number of [`JointCourse`]s, which
//! are plain values to be copied, set aside and taken up again, go through time on it.
//!
//! ```
//! use mckibben::control::Drive;
//! use mckibben::simulation::{JointRig, JointState, JointStepper, Method};
//! use mckibben::valve::Request;
//!
//! # fn turns(rig: JointRig, start: JointState) -> Result<(), mckibben::Error> {
//! let stepper = JointStepper::driven(rig, Method::Stable, 50.0)?;
//! let mut course = stepper.begin(start);
//! let pulses = |duty| Drive::Pulses { duty, pulse: Request::Fill, rest: Request::Exhaust };
//! stepper.drive(&mut course, [pulses(0.7), pulses(0.3)])?;
//! for count in 1..=1000 {
//!     stepper.advance_to(&mut course, f64::from(count) * 1e-3)?;
//! }
//! let angle = course.state().angle;
//! # Ok(())
//! # }
//! ```
//!
//! Checked by `tests/joint_stepper.rs`.

use super::kernel::Held;
use super::sample::JointSample;
use super::{ANGLE, JointRig, JointState, PRESSURE, VELOCITY};
use crate::control::{Drive, Modulator};
use crate::error::Error;
use crate::force::Statics;
use crate::friction::Memory;
use crate::load::SIGN;
use crate::pressure::AbsolutePressure;
use crate::scalar::Real;
use crate::simulation::kernel::{Method, Observed};
use crate::simulation::sample::Sample;
use crate::simulation::timetable::Progress;
use crate::valve::{Command, Openings, Ports, is_due};

/// Parts of a step between two instants that may end at a turn before the rest is taken as it is.
const MAX_TURNS: usize = 6;
/// Part of a step that the last secant moves a turn by: what is left is far below the error of a step of order 4.
const TURN_TOLERANCE: f64 = 1e-8;
/// Part of a step that a joint which starts from rest, or on a limit, moves before a turn is looked for.
const FROM_REST: f64 = 1e-3;
/// Secants and bisections after which a turn is taken where the bracket is.
const MAX_SECANTS: usize = 60;
/// What can cease to hold: the turning, the extent of each actuator, each stop.
const MARGINS: usize = 5;

/// Steps joints of one kind through time.
#[derive(Clone, Debug)]
pub struct JointStepper<R: Real<Time = R> = f64> {
    rig: JointRig<R>,
    method: Method,
    pulse_frequency: R,
}

/// Where a joint is in time: state, valves and what friction remembers. It belongs to whoever steps it.
#[derive(Clone, Copy, Debug)]
pub struct JointCourse<R = f64> {
    time: R,
    state: [R; 6],
    held: Held<R>,
    progress: [Progress<R>; 2],
    modulators: [Modulator<R>; 2],
}

impl<R: Real<Time = R>> JointCourse<R> {
    /// The time in s that has been reached.
    pub fn time(&self) -> R {
        self.time
    }

    /// The state at that time.
    pub fn state(&self) -> JointState<R> {
        JointState::from_array(self.state)
    }

    /// Which passages of agonist's and antagonist's valve are open.
    pub fn ports(&self) -> [Ports; 2] {
        self.held.ports
    }

    /// Whether friction holds the joint at rest.
    pub fn is_stuck(&self) -> bool {
        self.held.stuck
    }
}

impl<R: Real<Time = R>> JointStepper<R> {
    /// A joint whose valves follow the commands of its rig.
    ///
    /// # Errors
    /// [`Error::Misuse`] for actuators with [`Fittings`](super::Fittings).
    pub fn new(rig: JointRig<R>, method: Method) -> Result<Self, Error> {
        rig.check_bare()?;
        Ok(Self { rig, method, pulse_frequency: R::one() })
    }

    /// A joint whose valves do what [`JointStepper::drive`] asks and nothing else; pulses come at `pulse_frequency` in Hz.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless the frequency is above zero and finite; [`Error::Misuse`] as [`JointStepper::new`].
    pub fn driven(mut rig: JointRig<R>, method: Method, pulse_frequency: R) -> Result<Self, Error> {
        rig.check_bare()?;
        crate::parameter::PWM_FREQUENCY.check(pulse_frequency.value())?;
        for actuation in rig.driven.iter_mut().filter_map(|driven| driven.actuation.as_mut()) {
            actuation.command = Command::nothing();
        }
        Ok(Self { rig, method, pulse_frequency })
    }

    /// The joint with its actuators.
    pub fn rig(&self) -> &JointRig<R> {
        &self.rig
    }

    /// A course at t = 0 in a state, its coils released.
    pub fn begin(&self, start: JointState<R>) -> JointCourse<R> {
        self.begin_at(R::zero(), start)
    }

    /// The same at a time in s, as a row of a batch that goes on; what the rig's own commands asked up to then has been passed.
    pub fn begin_at(&self, time: R, start: JointState<R>) -> JointCourse<R> {
        let lengths = self.rig.joint.lengths(start.angle);
        let remember = |i: usize| Memory::relaxed(self.rig.driven[i].actuator.limits().actuator_length(lengths[i]));
        let held = Held {
            ports: [Ports::CLOSED; 2],
            openings: [Openings::Whole; 2],
            turning: R::zero(),
            stuck: false,
            slack: [false; 2],
            taut: [false; 2],
            pressed: [false; 2],
            memory: [remember(0), remember(1)],
        };
        let mut course = JointCourse {
            time,
            state: start.to_array(),
            held,
            progress: [0, 1].map(|i| Progress::none().regulated(self.rig.regulator_clock(i, start.pressure[i].0))),
            modulators: [Modulator::idle(); 2],
        };
        self.enter_extents(&mut course);
        self.pass(&mut course);
        course
    }

    /// What is asked of both valves from now on. Pulses begin with the next period, which may be now.
    ///
    /// # Errors
    /// [`Error::Misuse`] when an actuator has no valve, it cannot do what is asked, or has a dead time;
    /// [`Error::OutOfRange`] for a duty cycle outside 0 to 1. Then nothing has changed.
    pub fn drive(&self, course: &mut JointCourse<R>, drives: [Drive<R>; 2]) -> Result<(), Error> {
        for i in 0..2 {
            let Some(actuation) = &self.rig.driven[i].actuation else {
                return Err(Error::Misuse {
                    what: "something is asked of a valve, but the actuator has none",
                    remedy: "give both actuators a valve, or leave them sealed",
                });
            };
            actuation.solenoid.check_acts_at_once()?;
            match drives[i] {
                Drive::Steady(request) => actuation.solenoid.check_request(request)?,
                Drive::Pulses { duty, pulse, rest } => {
                    crate::parameter::DUTY.check(duty.value())?;
                    actuation.solenoid.check_request(pulse)?;
                    actuation.solenoid.check_request(rest)?;
                }
            }
        }
        for i in 0..2 {
            let asked = course.modulators[i].command(drives[i], course.time, self.pulse_frequency);
            self.ask(course, i, asked);
        }
        self.pass(course);
        Ok(())
    }

    fn ask(&self, course: &mut JointCourse<R>, i: usize, request: Option<crate::valve::Request>) {
        if let (Some(request), Some(actuation)) = (request, &self.rig.driven[i].actuation) {
            course.progress[i].ask(course.time, &actuation.solenoid, request);
        }
    }

    /// Goes on to `until` s in one step, divided where something switches. A time that has passed changes nothing.
    ///
    /// # Errors
    /// [`Error::Stopped`] when the step was so long that it left the physics, or the joint pulled a braid straight; the
    /// course is then as it was.
    pub fn advance_to(&self, course: &mut JointCourse<R>, until: R) -> Result<(), Error> {
        let before = *course;
        loop {
            let seats = [0, 1].map(|i| self.rig.timetable(i).next(&course.progress[i], until));
            let edges = course.modulators.each_ref().map(|modulator| modulator.next(self.pulse_frequency));
            // An edge where the step ends waits: a command that is given there comes before it.
            let edges = edges.map(|edge| edge.filter(|edge| !is_due(until, *edge)));
            let instants = seats.into_iter().chain(edges).flatten();
            let instant = instants.min_by(|a, b| a.value().total_cmp(&b.value()));
            self.glide(course, instant.map_or(until, |instant| until.smaller(instant)));
            if let Some(error) = self.fault(course) {
                *course = before;
                return Err(error);
            }
            if instant.is_none() {
                return Ok(());
            }
            for i in 0..2 {
                if edges[i].is_some_and(|edge| is_due(edge, course.time)) {
                    let asked = course.modulators[i].pass(course.time, self.pulse_frequency);
                    self.ask(course, i, asked);
                }
            }
            self.pass(course);
        }
    }

    /// Everything that is known at the time that has been reached.
    pub fn sample(&self, course: &JointCourse<R>) -> JointSample<R> {
        let JointCourse { time, state, held, .. } = course;
        let leverage = self.rig.joint.leverage_in(self.rig.joint.pieces(state[ANGLE]), state[ANGLE]);
        let slopes = leverage.slopes();
        let tensions = if held.stuck {
            self.shared_tensions(course)
        } else {
            [0, 1].map(|i| {
                let ends = [leverage.lengths[i], slopes[i] * state[VELOCITY], state[PRESSURE[i]]];
                self.rig.sliding_tension(i, ends, held)
            })
        };
        let actuators = [0, 1].map(|i| {
            let actuator = &self.rig.driven[i].actuator;
            let of = [leverage.lengths[i], slopes[i] * state[VELOCITY], state[PRESSURE[i]], state[PRESSURE[i] + 1]];
            let chamber = actuator.chamber(of[0], of[1], of[2], of[3], held.slack[i]);
            let flow = self.rig.inflow(i, *time, &chamber, held);
            let temperature = actuator.air().temperature(&chamber);
            let observed = Observed { tension: tensions[i], volume: chamber.volume, temperature, flow };
            let sample = Sample::new(*time, &of, &observed, held.ports[i]);
            Sample { supply_pressure: held.openings[i].pressure(*time).map(AbsolutePressure), ..sample }
        });
        let torque = leverage.torque_of(tensions);
        JointSample { time: *time, angle: state[ANGLE], angular_velocity: state[VELOCITY], torque, actuators }
    }

    /// Passes what is due at the seats, and decides anew what follows.
    pub(super) fn pass(&self, course: &mut JointCourse<R>) {
        for i in 0..2 {
            let timetable = self.rig.timetable(i);
            course.held.ports[i] = timetable.pass_seats(&mut course.progress[i], course.time);
            course.held.openings[i] = timetable.openings(&course.progress[i]);
        }
        self.slide(course);
    }

    /// Goes on to `until` with the same passages open.
    fn glide(&self, course: &mut JointCourse<R>, until: R) {
        for _ in 0..MAX_TURNS {
            let step = (until - course.time).larger(R::zero());
            let end = self.rig.take_tenable(self.method, course.time, &course.state, step, &course.held);
            let ceases = self.margins(course, &end).map(|margin| margin.value() < 0.0);
            if !(step.value() > 0.0 && ceases.contains(&true)) {
                return self.arrive(course, end, until);
            }
            let (part, state, which) = self.locate(course, step, end, ceases);
            let reached = course.time + part;
            self.arrive(course, state, reached);
            self.turn(course, which, step);
        }
        let step = (until - course.time).larger(R::zero());
        let end = self.rig.take_tenable(self.method, course.time, &course.state, step, &course.held);
        self.arrive(course, end, until);
        self.enter_extents(course);
    }

    fn arrive(&self, course: &mut JointCourse<R>, end: [R; 6], time: R) {
        course.state = end;
        course.time = course.time.larger(time);
        let joint = &self.rig.joint;
        let lengths = joint.lengths(end[ANGLE]);
        let slopes = joint.leverage_in(joint.pieces(end[ANGLE]), end[ANGLE]).slopes();
        for i in 0..2 {
            let velocity = slopes[i] * end[VELOCITY];
            self.rig.driven[i].actuator.remember(&mut course.held.memory[i], lengths[i], velocity);
        }
    }

    /// By how much turning, extents and stops hold in a state, each negative where it has ceased to.
    fn margins(&self, course: &JointCourse<R>, state: &[R; 6]) -> [R; MARGINS] {
        let (held, joint) = (&course.held, &self.rig.joint);
        let (angle, velocity) = (state[ANGLE], state[VELOCITY]);
        let leverage = joint.leverage_in(joint.pieces(angle), angle);
        let slopes = leverage.slopes();
        let extent = |i: usize| {
            let limits = self.rig.driven[i].actuator.limits();
            let (length, speed) = (leverage.lengths[i], slopes[i] * velocity);
            let above = limits.stiffness() * (length - limits.min_length());
            let taut = (limits.stiffness() * (length - limits.max_length())).smaller(limits.taut_force(length, speed));
            if held.slack[i] {
                -above
            } else if held.taut[i] {
                taut
            } else {
                above.smaller(-taut)
            }
        };
        let stop = |end: usize| {
            let Some(stop) = joint.stops().ends[end] else { return R::constant(f64::INFINITY) };
            let beyond = joint.stops().stiffness * R::constant(SIGN[end]) * (angle - stop);
            let press = beyond.smaller(joint.stop_torque(end, angle, velocity));
            if held.pressed[end] { press } else { -press }
        };
        let turning = if held.stuck {
            let (least, most) = self.torques_at_rest(held, state);
            most.smaller(-least)
        } else if held.turning.value() != 0.0 {
            held.turning * velocity
        } else {
            R::constant(f64::INFINITY)
        };
        // At rest nothing comes to an end by the length.
        let still = |margin: R| if held.stuck { R::constant(f64::INFINITY) } else { margin };
        [turning, still(extent(0)), still(extent(1)), still(stop(0)), still(stop(1))]
    }

    /// The point within a step where something first ceases to hold: how much of the step is taken, the state there, and
    /// which.
    ///
    /// Secants with the older end's value halved when it stays twice (the Illinois rule), and a bisection now and then so
    /// that the bracket shrinks whatever the function.
    fn locate(&self, course: &JointCourse<R>, step: R, end: [R; 6], ceases: [bool; MARGINS]) -> (R, [R; 6], usize) {
        // What holds at the end of the step is taken to hold throughout.
        let margin = |state: &[R; 6]| {
            let margins = self.margins(course, state);
            let those = (0..MARGINS).filter(|which| ceases[*which]).map(|which| (margins[which], which));
            those.min_by(|a, b| a.0.value().total_cmp(&b.0.value())).unwrap_or((R::zero(), 0))
        };
        let (mut low, mut high) = (R::zero(), R::one());
        let ((mut at_low, _), (mut at_high, which)) = (margin(&course.state), margin(&end));
        let (mut theta, mut was_beyond) = (R::one(), None);
        let mut found = (step, end, which);
        for count in 0..MAX_SECANTS {
            // From rest or from a limit the function starts at zero, or a rounding below: look away from the start.
            let from_rest = at_low.value() <= 0.0;
            let secant = (high - low).multiply_add(at_low / (at_low - at_high), low);
            let next = if from_rest {
                R::constant(FROM_REST)
            } else if count % 8 != 7 && low.lt(secant) && secant.lt(high) {
                secant
            } else {
                R::constant(0.5) * (low + high)
            };
            let state = self.rig.take_tenable(self.method, course.time, &course.state, next * step, &course.held);
            let (value, which) = margin(&state);
            // What is not a number is beyond as well.
            let is_beyond = !R::zero().le(value);
            let change = (next - theta).magnitude().value();
            theta = next;
            found = (theta * step, state, which);
            if change <= TURN_TOLERANCE || value.value() == 0.0 || (from_rest && is_beyond) {
                break;
            }
            let stays = was_beyond == Some(is_beyond);
            let half = R::constant(0.5);
            if is_beyond {
                (high, at_high) = (next, value);
                at_low = if stays { half * at_low } else { at_low };
            } else {
                (low, at_low) = (next, value);
                at_high = if stays { half * at_high } else { at_high };
            }
            was_beyond = Some(is_beyond);
        }
        found
    }

    /// Goes through a turn that ended a part of a step of `step` s.
    fn turn(&self, course: &mut JointCourse<R>, which: usize, step: R) {
        match which {
            0 => {
                let was_stuck = course.held.stuck;
                if !was_stuck {
                    course.state[VELOCITY] = R::zero();
                }
                self.slide(course);
                // A joint that broke away does not stick in the same instant, whatever the last rounding of the margin.
                if was_stuck && course.held.stuck {
                    let (least, most) = self.torques_at_rest(&course.held, &course.state);
                    self.head(course, if most.value() < -least.value() { -R::one() } else { R::one() });
                }
            }
            1 | 2 => {
                let i = which - 1;
                let limits = self.rig.driven[i].actuator.limits();
                let middle = R::constant(0.5) * (limits.min_length() + limits.max_length());
                let short = self.rig.joint.lengths(course.state[ANGLE])[i].lt(middle);
                let was_free = !(course.held.slack[i] || course.held.taut[i]);
                if short && self.rests_on_the_shortest(course, i, step) {
                    course.state[VELOCITY] = R::zero();
                    course.held.slack[i] = false;
                    (course.held.turning, course.held.stuck) = (R::zero(), true);
                    return;
                }
                (course.held.slack[i], course.held.taut[i]) = (was_free && short, was_free && !short);
            }
            stop => course.held.pressed[stop - 3] = !course.held.pressed[stop - 3],
        }
    }

    /// Whether the joint, where an actuator is at its shortest, comes to rest: the torque can be held, and it turns no
    /// faster than one step makes it.
    fn rests_on_the_shortest(&self, course: &JointCourse<R>, i: usize, step: R) -> bool {
        let mut held = course.held;
        held.slack[i] = false;
        let (least, most) = self.torques_between(&held, &course.state, [0, 1].map(|of| of == i));
        let fastest = most.value().max(-least.value()) / self.rig.joint.inertia().value() * step.value();
        least.value() <= 0.0 && most.value() >= 0.0 && course.state[VELOCITY].value().abs() <= fastest
    }

    /// The least and the largest torque in N·m on the joint at rest.
    fn torques_at_rest(&self, held: &Held<R>, state: &[R; 6]) -> (R, R) {
        self.torques_between(held, state, [false; 2])
    }

    fn torques_between(&self, held: &Held<R>, state: &[R; 6], shortest: [bool; 2]) -> (R, R) {
        let leverage = self.rig.joint.leverage_in(self.rig.joint.pieces(state[ANGLE]), state[ANGLE]);
        let [of, other] = [0, 1].map(|i| self.holdable(held, state, i, shortest[i]));
        let mut load = self.rig.joint.other_torque(state[ANGLE], R::zero());
        for end in 0..2 {
            let press = self.rig.joint.stop_torque(end, state[ANGLE], R::zero()).larger(R::zero());
            load = load - R::constant(SIGN[end]) * press;
        }
        (leverage.torque_of([of.0, other.1]) + load, leverage.torque_of([of.1, other.0]) + load)
    }

    /// The least and the largest tension in N that an actuator can hold at rest.
    fn holdable(&self, held: &Held<R>, state: &[R; 6], i: usize, shortest: bool) -> (R, R) {
        if held.slack[i] {
            return (R::zero(), R::zero());
        }
        let actuator = &self.rig.driven[i].actuator;
        let length = self.rig.joint.lengths(state[ANGLE])[i];
        // A joint that came to rest here lies within the last secant of the shortest length.
        let near = actuator.limits().min_length().value() * (1.0 + TURN_TOLERANCE);
        let resting = shortest || length.value() <= near;
        actuator.holdable(
            actuator.limits().actuator_length(length),
            state[PRESSURE[i]],
            resting,
            self.rig.rubbing(i, length, R::zero(), held),
        )
    }

    /// Tensions in N of both actuators while the joint sticks: of what each can hold, the share that balances the joint.
    fn shared_tensions(&self, course: &JointCourse<R>) -> [R; 2] {
        let (held, state) = (&course.held, &course.state);
        let [of, other] = [0, 1].map(|i| self.holdable(held, state, i, false));
        let (least, most) = self.torques_at_rest(held, state);
        let width = most - least;
        let share = if width.value() > 0.0 { -least / width } else { R::constant(0.5) };
        let share = share.larger(R::zero()).smaller(R::one());
        [of.0 + share * (of.1 - of.0), other.1 - share * (other.1 - other.0)]
    }

    /// Decides anew how the joint turns: from rest it sticks if the torque can be held.
    fn slide(&self, course: &mut JointCourse<R>) {
        let velocity = course.state[VELOCITY];
        let frictionless = !self.rig.driven.iter().any(|driven| driven.actuator.friction().has_coulomb());
        if velocity.value() != 0.0 {
            course.held.stuck = false;
            course.held.turning = if frictionless { R::zero() } else { velocity.sign() };
            return;
        }
        // Without friction only an actuator at its shortest holds the joint, and it has been put to rest there.
        if frictionless && !course.held.stuck {
            course.held.turning = R::zero();
            return;
        }
        let (least, most) = self.torques_at_rest(&course.held, &course.state);
        if most.value() < 0.0 {
            self.head(course, -R::one());
        } else if least.value() > 0.0 {
            self.head(course, R::one());
        } else {
            (course.held.turning, course.held.stuck) = (R::zero(), true);
        }
    }

    /// Sets the joint turning from rest; an actuator at its shortest that this would shorten falls slack.
    fn head(&self, course: &mut JointCourse<R>, heading: R) {
        let lengths = self.rig.joint.lengths(course.state[ANGLE]);
        for i in 0..2 {
            let shortest = self.rig.driven[i].actuator.limits().min_length().value();
            if heading.value() * SIGN[i] < 0.0 && lengths[i].value() <= shortest * (1.0 + TURN_TOLERANCE) {
                course.held.slack[i] = true;
            }
        }
        let frictionless = !self.rig.driven.iter().any(|driven| driven.actuator.friction().has_coulomb());
        course.held.stuck = false;
        course.held.turning = if frictionless { R::zero() } else { heading };
    }

    /// Decides extents and stops anew where they do not hold.
    fn enter_extents(&self, course: &mut JointCourse<R>) {
        let margins = self.margins(course, &course.state);
        let velocity = course.state[VELOCITY];
        let leverage = self.rig.joint.leverage(course.state[ANGLE]);
        for i in 0..2 {
            if margins[1 + i].value() < 0.0 {
                let limits = self.rig.driven[i].actuator.limits();
                let length = leverage.lengths[i];
                course.held.slack[i] = limits.is_slack(length);
                let pulls = R::zero().lt(limits.force(length, leverage.slopes()[i] * velocity));
                course.held.taut[i] = !course.held.slack[i] && pulls;
            }
            if margins[3 + i].value() < 0.0 {
                course.held.pressed[i] = !course.held.pressed[i];
            }
        }
    }

    /// What is wrong with a course that left the physics.
    fn fault(&self, course: &JointCourse<R>) -> Option<Error> {
        let state = course.state.map(R::value);
        let time = course.time.value();
        let stopped =
            |reason, quantity, value, unit, remedy| Error::Stopped { time, reason, quantity, value, unit, remedy };
        let positive = [false, false, true, true, true, true];
        if let Some(n) = (0..6).find(|&n| !state[n].is_finite() || (positive[n] && state[n] <= 0.0)) {
            let (quantity, unit) = match n {
                ANGLE => ("joint angle", "rad"),
                VELOCITY => ("angular velocity", "rad/s"),
                2 | 4 => ("absolute pressure", "Pa"),
                _ => ("air mass", "kg"),
            };
            let remedy = "shorten run.step, or set run.method = \"stable\" or run.engine = \"event-located\"";
            let reason = "a step of the fixed-step engine left the physics";
            return Some(stopped(reason, quantity, state[n], unit, remedy));
        }
        let lengths = self.rig.joint.lengths(course.state[ANGLE]);
        let straight = |i: usize| lengths[i].value() >= self.rig.driven[i].actuator.law().law.end_length().value();
        (straight(0) || straight(1)).then(|| {
            let remedy = "lighten the load, stiffen actuator.limit.stiffness, give the joint stops or shorten run.step";
            stopped("the joint pulled a braid straight", "joint angle", state[ANGLE], "rad", remedy)
        })
    }
}
