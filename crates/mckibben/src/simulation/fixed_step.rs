//! The fixed-step engine: bounded cost, no allocation, valve edges honoured inside the step.
//!
//! A step of length `h` is divided at every instant at which a seat moves or a prescribed motion turns, and, with Coulomb
//! friction, where the velocity comes to zero: there the load sticks if friction can hold it. Each part is one step of a
//! [`Method`]. A [batch](crate::batch) does the same in lanes.
//!
//! Checked by `tests/fixed_step.rs`.

use super::course::{Course, Ordinary};
use super::kernel::{Held, Method};
use super::rig::{Rig, State};
use super::sample::Sample;
use super::timetable::Progress;
use crate::error::Error;
use crate::load::Line;
use crate::scalar::Real;
use crate::valve::Ports;

/// Steps one rig through time at fixed steps; no allocation.
#[derive(Clone, Debug)]
pub struct FixedStepper<'a, R: Real = f64> {
    rig: &'a Rig<R>,
    method: Method,
    course: Course<R>,
    progress: Progress<R>,
    ports: Ports,
}

impl<'a, R: Real> FixedStepper<'a, R> {
    /// Starts at t = 0 in a state.
    pub fn new(rig: &'a Rig<R>, start: State<R>, method: Method) -> Self {
        let held =
            Held { supply: false, exhaust: false, sliding: R::zero(), stuck: false, line: Line::resting(R::zero()) };
        let course = Course { time: R::zero(), state: start.to_array(), held };
        let mut stepper = Self { rig, method, course, progress: Progress::none(), ports: Ports::CLOSED };
        stepper.pass_instants();
        stepper
    }

    /// The time in s that has been reached.
    pub fn time(&self) -> R {
        self.course.time
    }

    /// The state at that time.
    pub fn state(&self) -> State<R> {
        State::from_array(self.course.state)
    }

    /// Which passages are open at that time.
    pub fn ports(&self) -> Ports {
        self.ports
    }

    /// Everything that is known at that time.
    pub fn sample(&self) -> Sample<R> {
        let Course { time, state, held } = &self.course;
        Sample::new(*time, state, &self.rig.observe(state, held), self.ports)
    }

    /// Goes on to `until` in one step, divided where something switches.
    ///
    /// # Errors
    /// [`Error::Stopped`] when the step was so long that it left the physics; the state is then the last good one.
    pub fn advance_to(&mut self, until: R) -> Result<(), Error> {
        loop {
            let instant = self.rig.timetable().next(&self.progress, until);
            let before = self.course;
            self.course.advance(Ordinary, self.rig, self.method, instant.unwrap_or(until));
            if !self.rig.admissible(&self.course.state) {
                let left = self.course;
                self.course = before;
                let thread = self.rig.actuator().law().law.braid.thread_length().value();
                return Err(outside(thread, left.time.value(), left.state.map(Real::value)));
            }
            if instant.is_none() {
                return Ok(());
            }
            self.pass_instants();
        }
    }

    fn pass_instants(&mut self) {
        let timetable = self.rig.timetable();
        self.ports = timetable.pass(&mut self.progress, self.course.time);
        self.course.held.line = timetable.line(&self.progress);
        (self.course.held.supply, self.course.held.exhaust) = (self.ports.supply, self.ports.exhaust);
        self.course.slide(self.rig, true);
    }
}

/// The error of a state beyond the laws of a braid of a given thread length in m.
pub(crate) fn outside(thread: f64, time: f64, [length, velocity, pressure, air_mass]: [f64; 4]) -> Error {
    let numbers = [
        ("length", length, "m", length < thread),
        ("velocity", velocity, "m/s", true),
        ("absolute pressure", pressure, "Pa", pressure > 0.0),
        ("air mass", air_mass, "kg", air_mass > 0.0),
    ];
    let culprit = numbers.into_iter().find(|(_, value, _, admissible)| !(value.is_finite() && *admissible));
    let (quantity, value, unit, _) = culprit.unwrap_or(numbers[0]);
    Error::Stopped {
        time,
        reason: "a step of the fixed-step engine left the physics",
        quantity,
        value,
        unit,
        remedy: "shorten run.step, or set run.method = \"stable\" or run.engine = \"event-located\"",
    }
}
