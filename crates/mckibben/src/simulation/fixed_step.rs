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
use super::kernel::{Held, Method};
use super::piped::{OUTLET, PIPED, RESERVOIR, Stepped, of_rig, volume};
use super::rig::{Rig, State};
use super::sample::Sample;
use super::tendon_step::{By, FarEnd};
use super::timetable::{Progress, Timetable};
use crate::error::Error;
use crate::force::Statics;
use crate::friction::Memory;
use crate::line::{Hose, Reservoir};
use crate::load::Line;
use crate::pressure::AbsolutePressure;
use crate::scalar::{Real, Scalar};
use crate::valve::{Port, Ports};

/// Steps one rig through time at fixed steps; no allocation.
#[derive(Clone, Debug)]
pub struct FixedStepper<'a, R: Real<Time = R> = f64> {
    rig: &'a Rig<R>,
    method: Method,
    journey: Journey<R>,
}

impl<'a, R: Real<Time = R>> FixedStepper<'a, R> {
    /// Starts at t = 0 in a state.
    pub fn new(rig: &'a Rig<R>, start: State<R>, method: Method) -> Self {
        Self { rig, method, journey: Journey::begin(rig, start) }
    }

    /// The time in s that has been reached.
    pub fn time(&self) -> R {
        self.journey.time()
    }

    /// The state at that time: the actuator's own where a tendon is in series.
    pub fn state(&self) -> State<R> {
        self.journey.state()
    }

    /// The states of the air line at that time, in the order of its parts: the pressures (Pa, absolute) of the hose's volumes
    /// from the valve on, the flows (kg/s) out of the cells of a distributed hose, the pressures of reservoir and regulator.
    /// As far as there are such parts.
    pub fn line(&self) -> impl Iterator<Item = R> {
        self.rig.states_of_line().map(|(place, ..)| self.journey.walk.course.state[place])
    }

    /// Which passages are open at that time.
    pub fn ports(&self) -> Ports {
        self.journey.walk.ports
    }

    /// What the hysteresis remembers at that time.
    pub fn memory(&self) -> &Memory<R> {
        &self.journey.walk.course.held.memory
    }

    /// Everything that is known at that time.
    pub fn sample(&self) -> Sample<R> {
        self.journey.sample(self.rig)
    }

    /// Goes on to `until` in one step, divided where something switches.
    ///
    /// # Errors
    /// [`Error::Stopped`] when the step was so long that it left the physics; the state is then the last good one.
    /// [`Error::Misuse`] for a rig whose pressure is given over time.
    pub fn advance_to(&mut self, until: R) -> Result<(), Error> {
        self.journey.advance_to(self.rig, self.method, until)
    }
}

/// The way through time of a rig that its owner keeps: on its actuator, and on a tendon in series if it has one.
#[derive(Clone, Debug)]
pub(crate) struct Journey<R: Real<Time = R>> {
    walk: Walk<R>,
    far_end: Option<FarEnd<R>>,
}

impl<R: Real<Time = R>> Journey<R> {
    /// At t = 0 in a state.
    pub(crate) fn begin(rig: &Rig<R>, start: State<R>) -> Self {
        Self::begin_at(R::zero(), rig, start)
    }

    /// At a time in s in a state.
    pub(crate) fn begin_at(time: R, rig: &Rig<R>, start: State<R>) -> Self {
        let mut walk = Walk::new(rig, stepped(rig, start));
        walk.course.time = time;
        let far_end = FarEnd::begin(rig, &mut walk);
        let mut journey = Self { walk, far_end };
        journey.pass(rig);
        journey
    }

    /// The time in s that has been reached.
    pub(crate) fn time(&self) -> R {
        self.walk.course.time
    }

    /// The state of the actuator at that time.
    pub(crate) fn state(&self) -> State<R> {
        State::from_array(of_rig(&self.walk.course.state))
    }

    /// Everything that is known at that time.
    pub(crate) fn sample(&self, rig: &Rig<R>) -> Sample<R> {
        match &self.far_end {
            None => self.walk.sample(rig),
            Some(far_end) => far_end.seen(self.walk.sample(far_end.guided())),
        }
    }

    /// Passes what is due.
    pub(crate) fn pass(&mut self, rig: &Rig<R>) {
        match &self.far_end {
            None => self.walk.pass(rig, &rig.timetable()),
            Some(far_end) => self.walk.pass(far_end.guided(), &rig.seats()),
        }
    }

    /// As [`FixedStepper::advance_to`].
    pub(crate) fn advance_to(&mut self, rig: &Rig<R>, method: Method, until: R) -> Result<(), Error> {
        rig.check_fixed_steps()?;
        match &mut self.far_end {
            None => self.walk.advance_to(rig, &rig.timetable(), method, until, None),
            Some(far_end) => far_end.advance_to(&mut self.walk, &By { method, seats: rig.seats() }, until),
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
    /// At t = 0, before what is due then has been passed.
    pub(super) fn new(rig: &Rig<R>, state: Stepped<R>) -> Self {
        let memory = Memory::relaxed(rig.actuator().limits().actuator_length(state[0]));
        let compressor = compressor_starts(rig, &state);
        let course = Course { time: R::zero(), state, held: Held { memory, compressor, ..Held::nothing() } };
        let progress = Progress::none().regulated(rig.regulator_clock(state[2]));
        Self { course, progress, ports: Ports::CLOSED }
    }
}

impl<R: Real> Walk<R> {
    /// Everything that is known at the time that has been reached.
    pub(crate) fn sample(&self, rig: &Rig<R>) -> Sample<R> {
        R::sample_walk(self, rig)
    }

    pub(crate) fn generic_sample(&self, rig: &Rig<R>) -> Sample<R> {
        let Course { time, state, held } = &self.course;
        let time = R::of_time(*time);
        let sample = Sample::new(time, &of_rig(state), &rig.observe(time, state, held), self.ports);
        let hose = rig.hose_content(state);
        let sample = hose.map_or(sample, |air| sample.with_line([state[volume(0)], air], None));
        let supply = rig.feed(state).or_else(|| held.openings.pressure(time));
        Sample { supply_pressure: supply.map(AbsolutePressure), ..sample }
    }

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
        R::advance_walk(self, rig, timetable, method, (until, &mut end))
    }

    pub(crate) fn generic_advance_to(
        &mut self,
        rig: &Rig<R>,
        timetable: &Timetable<'_, R::Time>,
        method: Method,
        (until, end): (R::Time, &mut Option<Stepped<R>>),
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
                return Err(outside(rig, thread, left.time.value(), &left.state.map(Real::value)));
            }
            if instant.is_none() {
                return Ok(());
            }
            self.pass(rig, timetable);
        }
    }

    /// Passes what is due.
    pub(crate) fn pass(&mut self, rig: &Rig<R>, timetable: &Timetable<'_, R::Time>) {
        R::pass_walk(self, rig, timetable);
    }

    pub(crate) fn generic_pass(&mut self, rig: &Rig<R>, timetable: &Timetable<'_, R::Time>) {
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

/// The states at a start: a hose begins at the actuator's pressure and at rest, a regulator at what it is set to or what the
/// reservoir gives.
pub(crate) fn stepped<R: Real>(rig: &Rig<R>, start: State<R>) -> Stepped<R> {
    let mut state: Stepped<R> = [R::zero(); PIPED];
    let [length, velocity, pressure, mass] = start.to_array();
    [state[0], state[1], state[2], state[3]] = [length, velocity, pressure, mass];
    let line = rig.line();
    for cell in 0..line.hose.as_ref().map_or(0, Hose::cells) {
        state[volume(cell)] = pressure;
    }
    let Some((supply, valve)) = line.supply.as_ref().zip(rig.actuator().valve()) else { return state };
    let reservoir = supply.reservoir().map(|reservoir| reservoir.start().0);
    if let Some(pressure) = reservoir {
        state[RESERVOIR] = pressure;
    }
    if supply.regulator().is_some() {
        let set = valve.port_pressure(Port::Supply);
        state[OUTLET] = reservoir.map_or(set, |pressure| set.smaller(pressure));
    }
    state
}

/// Whether the compressor runs at the start: below its upper pressure.
pub(crate) fn compressor_starts<R: Real>(rig: &Rig<R>, state: &Stepped<R>) -> bool {
    let reservoir = rig.line().supply.as_ref().and_then(|supply| supply.reservoir());
    reservoir.and_then(Reservoir::switch_pressures).is_some_and(|[_, stops]| state[RESERVOIR].lt(stops))
}

/// The error of a state beyond the laws of a braid of a given thread length in m.
fn outside<R: Real>(rig: &Rig<R>, thread: f64, time: f64, state: &Stepped<f64>) -> Error {
    let [length, velocity, pressure, air_mass] = of_rig(state);
    let numbers = [
        ("length", length, "m", length < thread),
        ("velocity", velocity, "m/s", true),
        ("absolute pressure", pressure, "Pa", pressure > 0.0),
        ("air mass", air_mass, "kg", air_mass > 0.0),
    ];
    let of_line =
        rig.states_of_line().map(|(place, what, unit)| (what, state[place], unit, unit != "Pa" || state[place] > 0.0));
    let culprit =
        numbers.into_iter().chain(of_line).find(|(_, value, _, admissible)| !(value.is_finite() && *admissible));
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
