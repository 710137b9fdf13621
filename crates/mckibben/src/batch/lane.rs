//! A row by itself: its rig, what drives its valve, its instants and its controller, and how it goes through time where it goes
//! alone, as the fixed-step engine does.

use super::Row;
use super::alone::CONTROLLED;
use super::gather::{are_same, form, narrow};
use crate::error::Error;
use crate::friction::Memory;
use crate::lanes::wide::Number;
use crate::load::Load;
use crate::pressure::AbsolutePressure;
use crate::scalar::Scalar;
use crate::simulation::closed_loop::{Control, measurement};
use crate::simulation::course::Course;
use crate::simulation::fixed_step::{Walk, compressor_starts, stepped};
use crate::simulation::kernel::Held;
use crate::simulation::piped::Stepped as States;
use crate::simulation::rig::Actuation;
use crate::simulation::sample::Sample;
use crate::simulation::timetable::{Progress, Timetable};
use crate::simulation::told::check_restart;
use crate::simulation::{Method, Rig};
use crate::valve::{Openings, Ports, is_due};
use alloc::boxed::Box;
use alloc::sync::Arc;

/// A row is begun anew with a rig that does not fit the others of its block.
pub(super) const OTHER_FORM: Error = Error::Misuse {
    what: "a row of a batch is begun anew with a rig of another form: with other laws or parts",
    remedy: "give it a rig that differs in numbers alone, or make another batch for rigs of that form",
};

/// What a row keeps for itself.
#[derive(Debug)]
pub(super) struct Lane<R> {
    /// Rows whose numbers are the same share it: it then stays in the cache.
    pub(super) rig: Arc<Rig<R>>,
    pub(super) actuation: Option<Actuation>,
    pub(super) load: Load,
    pub(super) fault: Option<Error>,
    pub(super) control: Option<Box<dyn Control>>,
}

impl<R: Number> Lane<R> {
    /// A row at t = 0, before what is due then has been passed; `like` is the rig of another, which may have the same numbers.
    pub(super) fn new(row: &Row, like: Option<&Arc<Rig<R>>>) -> Self {
        let rig = narrow(&row.rig);
        Self {
            rig: like.filter(|like| are_same(&rig, like)).cloned().unwrap_or_else(|| Arc::new(rig)),
            actuation: row.rig.actuation().cloned(),
            load: row.rig.load().clone(),
            fault: row.rig.check_fixed_steps().err(),
            control: None,
        }
    }

    /// A row of the same form in the place of this one, with nothing asked of its valve, and its walk at a time in s.
    pub(super) fn anew(&self, row: &Row, time: f64) -> Result<(Self, Walk<R>), Error> {
        check_restart(&row.rig)?;
        if self.control.is_some() {
            return Err(CONTROLLED);
        }
        let row = Row { rig: row.rig.clone().not_asked(), start: row.start };
        let lane = Self::new(&row, Some(&self.rig));
        let is_like = || Arc::ptr_eq(&lane.rig, &self.rig) || form(&lane.rig) == form(&self.rig);
        if row.rig.tendon().is_some() || !is_like() {
            return Err(OTHER_FORM);
        }
        let walk = lane.begin(&row, time);
        Ok((lane, walk))
    }

    /// Where the row is at a time in s at which it begins, before what is due then has been passed.
    pub(super) fn begin(&self, row: &Row, time: f64) -> Walk<R> {
        let start = stepped(&row.rig, row.start);
        let state = start.map(R::constant);
        let memory = Memory::relaxed(self.rig.actuator().limits().actuator_length(state[0]));
        let held = Held { memory, compressor: compressor_starts(&row.rig, &start), ..Held::nothing() };
        let progress = Progress::none().regulated(row.rig.regulator_clock(row.start.pressure.0));
        Walk { course: Course { time, state, held }, progress, ports: Ports::CLOSED }
    }

    /// The valve of a row, to be told what to do; there is none where a controller drives it.
    pub(super) fn valve_mut(&mut self) -> Result<Option<&mut Actuation>, Error> {
        match &self.control {
            None => Ok(self.actuation.as_mut()),
            Some(_) => Err(CONTROLLED),
        }
    }

    fn timetable(&self) -> Timetable<'_, f64> {
        Timetable { actuation: self.actuation.as_ref(), motion: self.load.motion(), pressure: None }
    }

    /// How far the passages are open, after the instants that have been passed.
    pub(super) fn openings(&self, progress: &Progress<f64>) -> Openings<f64> {
        self.timetable().openings(progress)
    }

    /// The next instant in s up to `until`, or the controller's next sample.
    pub(super) fn next(&self, progress: &Progress<f64>, until: f64) -> Option<f64> {
        let instant = self.timetable().next(progress, until);
        [instant, self.sampling()].into_iter().flatten().reduce(f64::min)
    }

    /// The controller's next sampling instant in s.
    fn sampling(&self) -> Option<f64> {
        self.control.as_ref().map(|control| control.next())
    }

    /// Takes the controller's sample if it is due.
    pub(super) fn sample_due(&mut self, walk: &mut Walk<R>) -> Result<(), Error> {
        if let Some(control) = &mut self.control
            && is_due(control.next(), walk.course.time)
        {
            let time = control.next();
            let truth = measurement(R::of_time(time), &walk.sample(&self.rig), self.rig.actuator());
            control.sample(&truth.of_lane(time), self.actuation.as_mut())?;
            walk.pass(&self.rig, &self.timetable());
        }
        Ok(())
    }

    /// Passes what is due where the walk is, if anything is.
    pub(super) fn pass_due(&self, walk: &mut Walk<R>) {
        if self.timetable().next(&walk.progress, walk.course.time).is_some() {
            walk.pass(&self.rig, &self.timetable());
        }
    }

    /// Passes what is due where the walk is: instants first, then the controller's sample.
    pub(super) fn pass(&mut self, walk: &mut Walk<R>) -> Result<(), Error> {
        if self.control.is_none() || self.timetable().next(&walk.progress, walk.course.time).is_some() {
            walk.pass(&self.rig, &self.timetable());
        }
        self.sample_due(walk)
    }

    /// Goes on to `until` in s by itself, with every sample of the controller on the way. The end of one whole step is given
    /// where it is known already.
    pub(super) fn go(
        &mut self,
        walk: &mut Walk<R>,
        method: Method,
        until: f64,
        mut end: Option<States<R>>,
    ) -> Result<(), Error> {
        loop {
            let sampling = self.sampling().filter(|instant| is_due(*instant, until));
            let to = sampling.map_or(until, |instant| instant.smaller(until));
            let end = end.take().filter(|_| sampling.is_none());
            walk.advance_to(&self.rig, &self.timetable(), method, to, end)?;
            self.sample_due(walk)?;
            if until <= walk.course.time {
                return Ok(());
            }
        }
    }

    /// The sample of a row whose passages are not whole, by the net flow into its actuator and what lies beyond.
    pub(super) fn under_way(&self, walk: &Walk<R>, sample: Sample) -> Sample {
        let Course { time, state, held } = &walk.course;
        let mass_flow = self.rig.observe(R::of_time(*time), state, held).flow.net().value();
        let supply_pressure = self.openings(&walk.progress).pressure(*time).map(AbsolutePressure);
        Sample { mass_flow, supply_pressure, ..sample }
    }
}
