//! The fixed-step engine: bounded cost, no allocation, valve edges honoured inside the step.
//!
//! A step of length `h` is divided at every instant at which a seat moves or arrives or a prescribed motion turns, where the tendon
//! falls slack or tight, where the braid comes taut or ceases to pull, and, with Coulomb friction, where the velocity comes
//! to zero: there the load sticks if friction can hold it. Each part is one step of a [`Method`]. A
//! [batch](crate::batch) does the same in lanes.
//!
//! What error a step leaves is in `docs/accuracy.md`; a step for an accuracy is chosen by [`super::accuracy`].
//!
//! Checked by `tests/fixed_step.rs`.

use super::course::Course;
use super::hosed::{Stepped, of_rig};
use super::kernel::{Held, Method};
use super::rig::{Rig, State};
use super::sample::Sample;
use super::tendon_step::FarEnd;
use super::timetable::{Progress, Timetable};
use crate::error::Error;
use crate::force::Statics;
use crate::friction::Memory;
use crate::line::HoseKind;
use crate::load::Line;
use crate::pressure::AbsolutePressure;
use crate::scalar::{Real, Scalar};
use crate::valve::Ports;

/// Steps one rig through time at fixed steps; no allocation.
#[derive(Clone, Debug)]
pub struct FixedStepper<'a, R: Real<Time = R> = f64> {
    rig: &'a Rig<R>,
    method: Method,
    walk: Walk<R>,
    far_end: Option<FarEnd<R>>,
}

impl<'a, R: Real<Time = R>> FixedStepper<'a, R> {
    /// Starts at t = 0 in a state.
    pub fn new(rig: &'a Rig<R>, start: State<R>, method: Method) -> Self {
        let mut walk = Walk::new(rig, stepped(start));
        let far_end = FarEnd::begin(rig, &mut walk);
        match &far_end {
            None => walk.pass(rig, &rig.timetable()),
            Some(far_end) => walk.pass(far_end.guided(), &far_end.timetable()),
        }
        Self { rig, method, walk, far_end }
    }

    /// The time in s that has been reached.
    pub fn time(&self) -> R {
        self.walk.course.time
    }

    /// The state at that time: the actuator's own where a tendon is in series.
    pub fn state(&self) -> State<R> {
        State::from_array(of_rig(&self.walk.course.state))
    }

    /// Which passages are open at that time.
    pub fn ports(&self) -> Ports {
        self.walk.ports
    }

    /// What the hysteresis remembers at that time.
    pub fn memory(&self) -> &Memory<R> {
        &self.walk.course.held.memory
    }

    /// Everything that is known at that time.
    pub fn sample(&self) -> Sample<R> {
        match &self.far_end {
            None => self.walk.sample(self.rig),
            Some(far_end) => far_end.seen(self.walk.sample(far_end.guided())),
        }
    }

    /// Goes on to `until` in one step, divided where something switches.
    ///
    /// # Errors
    /// [`Error::Stopped`] when the step was so long that it left the physics; the state is then the last good one.
    /// [`Error::Unsupported`] for a distributed hose or a supply that changes.
    pub fn advance_to(&mut self, until: R) -> Result<(), Error> {
        check_plumbing(self.rig)?;
        match &mut self.far_end {
            None => self.walk.advance_to(self.rig, &self.rig.timetable(), self.method, until, None),
            Some(far_end) => far_end.advance_to(&mut self.walk, self.method, until),
        }
    }
}

/// A rig's way through time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Walk<R: Real> {
    pub(crate) course: Course<R>,
    pub(crate) progress: Progress<R::Time>,
    pub(crate) ports: Ports,
}

impl<R: Real<Time = R>> Walk<R> {
    /// Everything that is known at the time that has been reached.
    pub(super) fn sample(&self, rig: &Rig<R>) -> Sample<R> {
        let Course { time, state, held } = &self.course;
        let sample = Sample::new(*time, &of_rig(state), &rig.observe(*time, state, held), self.ports);
        let hose = rig.line().hose.as_ref();
        let sample = hose.map_or(sample, |hose| sample.with_line([state[4], hose.content(state[4])], None));
        Sample { supply_pressure: held.openings.pressure(*time).map(AbsolutePressure), ..sample }
    }

    /// At t = 0, before what is due then has been passed.
    pub(super) fn new(rig: &Rig<R>, state: Stepped<R>) -> Self {
        let memory = Memory::relaxed(rig.actuator().limits().actuator_length(state[0]));
        let course = Course { time: R::zero(), state, held: Held { memory, ..Held::nothing() } };
        let progress = Progress::none().regulated(rig.regulator_clock(state[2]));
        Self { course, progress, ports: Ports::CLOSED }
    }
}

impl<R: Real> Walk<R> {
    /// Goes on to `until`, through every instant up to then; where that leaves the physics, stays at the last good state.
    /// The end of one whole step without an instant is given where it is known already.
    pub(crate) fn advance_to(
        &mut self,
        rig: &Rig<R>,
        timetable: &Timetable<'_, R::Time>,
        method: Method,
        until: R::Time,
        mut end: Option<Stepped<R>>,
    ) -> Result<(), Error> {
        loop {
            let instant = timetable.next(&self.progress, until);
            let before = self.course;
            let end = end.take().filter(|_| instant.is_none());
            self.course.advance(rig, method, instant.map_or(until, |instant| until.smaller(instant)), end);
            if !rig.admissible(&self.course.state) {
                let left = self.course;
                self.course = before;
                let thread = rig.actuator().law().law.end_length().value();
                return Err(outside(thread, left.time.value(), of_rig(&left.state).map(Real::value)));
            }
            if instant.is_none() {
                return Ok(());
            }
            self.pass(rig, timetable);
        }
    }

    /// Passes what is due.
    pub(crate) fn pass(&mut self, rig: &Rig<R>, timetable: &Timetable<'_, R::Time>) {
        self.ports = timetable.pass(&mut self.progress, self.course.time);
        let openings = timetable.openings(&self.progress).map(R::of_time);
        let held = &mut self.course.held;
        if let Some(motion) = timetable.motion {
            let Line { time, length, slope } = timetable.line(&self.progress);
            held.line = Line { time: R::of_time(time), length: R::of_time(length), slope: R::of_time(slope) };
            if motion.corners() > 0 {
                // The velocity jumps at a corner, and what holds after it depends on that.
                self.course.state[1] = held.line.slope;
            }
        }
        (held.supply, held.exhaust, held.openings) = (self.ports.supply, self.ports.exhaust, openings);
        self.course.enter(rig);
    }
}

/// The states at a start: a hose begins at the actuator's pressure.
pub(crate) fn stepped<S: Scalar>(start: State<S>) -> Stepped<S> {
    let [length, velocity, pressure, mass] = start.to_array();
    [length, velocity, pressure, mass, pressure]
}

/// That fixed steps can take a rig's air line.
pub(crate) fn check_plumbing<S: Scalar>(rig: &Rig<S>) -> Result<(), Error> {
    let line = rig.line();
    let distributed = line.hose.as_ref().is_some_and(|hose| matches!(hose.kind, HoseKind::Distributed { .. }));
    if distributed || line.supply.is_some() {
        return Err(Error::Unsupported {
            what: "the fixed-step engine and batches take neither a distributed hose nor a supply whose pressure changes",
            remedy: "set run.engine = \"event-located\", or hose.kind = \"lumped\" and a supply of constant pressure",
        });
    }
    Ok(())
}

/// The error of a state beyond the laws of a braid of a given thread length in m.
fn outside(thread: f64, time: f64, [length, velocity, pressure, air_mass]: [f64; 4]) -> Error {
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
