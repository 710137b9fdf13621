//! Rows that no vector lane takes: joints, legs, loads on a tendon in series, or any other stepper, each by itself.
//!
//! Checked by `tests/row_by_row.rs`.

use super::span::Span;
use crate::control::{Controller, JointController};
use crate::error::Error;
use crate::plant::NO_ROW;
use crate::scalar::Real;
use crate::simulation::{ControlledJointStepper, ControlledStepper, Decision, JointDecision, Stepper};
use alloc::vec::Vec;
use rayon::prelude::*;

/// Steps that a thread takes at least before it looks for others.
const STEPS_TOGETHER: usize = 64;

/// Many rows, each of which is a [`Stepper`] that goes through time by itself.
///
/// ```
/// use mckibben::batch::RowByRow;
/// use mckibben::simulation::{JointRig, JointState, JointStepper, Method};
///
/// # fn swing(rig: JointRig, starts: &[JointState]) -> Result<(), mckibben::Error> {
/// let stepper = JointStepper::new(rig, Method::Stable)?;
/// let mut batch = RowByRow::new(starts.iter().map(|start| (&stepper, stepper.begin(*start))).collect())?;
/// batch.advance(0.1, 1000); // to 0.1 s in steps of 0.1 ms
/// for sample in batch.samples() {
///     println!("{} rad", sample?.angle);
/// }
/// # Ok(())
/// # }
/// ```
///
/// Rows share nothing and are stepped on all cores, so each is the run of its stepper alone, bit for bit, whatever the number
/// of rows and of threads. Nothing is allocated but by the steppers themselves. A row that leaves the physics has an error of
/// its own from then on, and touches no other.
#[derive(Clone, Debug)]
pub struct RowByRow<S> {
    time: f64,
    rows: Vec<Row<S>>,
}

#[derive(Clone, Debug)]
struct Row<S> {
    stepper: S,
    fault: Option<Error>,
}

impl<S: Stepper> RowByRow<S> {
    /// A batch of steppers that have reached the same time.
    ///
    /// # Errors
    /// [`Error::Misuse`] where one is at another time than the first.
    pub fn new(steppers: Vec<S>) -> Result<Self, Error> {
        let time = steppers.first().map_or(0.0, S::time);
        if steppers.iter().any(|stepper| stepper.time() != time) {
            return Err(Error::Misuse {
                what: "the rows of a batch go through time together, and these have reached different times",
                remedy: "begin all of them at the same time, or make a batch of those that agree",
            });
        }
        Ok(Self::at(time, steppers))
    }

    /// The same of steppers that are known to have reached a time in s.
    pub(super) fn at(time: f64, steppers: Vec<S>) -> Self {
        Self { time, rows: steppers.into_iter().map(|stepper| Row { stepper, fault: None }).collect() }
    }

    /// How many rows there are.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The time in s that every living row has reached.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// The rows, to ask what a sample does not tell.
    pub fn rows(&self) -> impl Iterator<Item = &S> {
        self.rows.iter().map(|row| &row.stepper)
    }

    /// The rows, to tell their valves what to do. Whoever steps one of them himself has it out of step with the others.
    pub fn rows_mut(&mut self) -> impl Iterator<Item = &mut S> {
        self.rows.iter_mut().map(|row| &mut row.stepper)
    }

    /// What every row shows now, or why it has stopped, in the order of the rows.
    ///
    /// # Errors
    /// Each row's own: [`Error::Stopped`] when a step has led it out of the physics, others where a controller asked what
    /// cannot be.
    pub fn samples(&self) -> Vec<Result<S::Sample, Error>> {
        let sample = |row: &Row<S>| row.fault.clone().map_or_else(|| Ok(row.stepper.sample()), Err);
        self.rows.iter().map(sample).collect()
    }

    /// Another stepper in the place of a row, which lives again if it had stopped. The time of the batch goes on.
    ///
    /// # Errors
    /// [`Error::Misuse`] for a row that there is not, and for a stepper that is at another time than the batch. Then
    /// nothing has changed.
    pub fn restart(&mut self, row: usize, stepper: S) -> Result<(), Error> {
        if row >= self.rows.len() {
            return Err(NO_ROW);
        }
        if stepper.time() != self.time {
            return Err(Error::Misuse {
                what: "a row is begun anew at another time than the batch has reached",
                remedy: "begin the stepper at the time of the batch, as ToldStepper::begin_at does",
            });
        }
        self.put(row, stepper);
        Ok(())
    }

    /// The same of a row that there is and a stepper at that time.
    pub(super) fn put(&mut self, row: usize, stepper: S) {
        self.rows[row] = Row { stepper, fault: None };
    }

    /// A row, or why it has stopped.
    pub(super) fn alive(&self, row: usize) -> Result<&S, &Error> {
        let row = self.rows.get(row).ok_or(&NO_ROW)?;
        row.fault.as_ref().map_or(Ok(&row.stepper), Err)
    }

    /// The same to be told something.
    pub(super) fn running(&mut self, row: usize) -> Result<&mut S, Error> {
        self.alive(row).map_err(Error::clone)?;
        Ok(&mut self.rows[row].stepper)
    }

    /// Stops a row.
    pub(super) fn stop(&mut self, row: usize, fault: Error) {
        self.rows[row].fault = Some(fault);
    }

    /// A row that has not been stopped.
    pub(super) fn living(&mut self, row: usize) -> Option<&mut S> {
        self.rows.get_mut(row).filter(|row| row.fault.is_none()).map(|row| &mut row.stepper)
    }

    pub(super) fn row(&self, row: usize) -> Option<&S> {
        self.rows.get(row).map(|row| &row.stepper)
    }
}

impl<S: Stepper + Send> RowByRow<S> {
    /// Takes every living row to `until` (s) in `steps` equal steps, each divided where something switches in the row.
    /// Does nothing when `until` is not later than now or there are no steps.
    pub fn advance(&mut self, until: f64, steps: u64) {
        if steps > 0 && until > self.time && until.is_finite() {
            let span = Span { from: self.time, until, steps };
            let together = usize::try_from(steps).map_or(1, |steps| STEPS_TOGETHER.div_ceil(steps));
            match self.rows.as_mut_slice() {
                [] => {}
                [row] => row.advance(&span),
                rows => rows.par_iter_mut().with_min_len(together).for_each(|row| row.advance(&span)),
            }
            self.time = until;
        }
    }
}

impl<S: Stepper + Send> RowByRow<S> {
    /// Does something with every row that has not been stopped, given its number, on all cores; a row that cannot do it stops.
    pub(super) fn for_each_living(&mut self, does: impl Fn(usize, &mut S) -> Result<(), Error> + Sync) {
        self.rows.par_iter_mut().enumerate().with_min_len(STEPS_TOGETHER).for_each(|(count, row)| {
            if row.fault.is_none() {
                row.fault = does(count, &mut row.stepper).err();
            }
        });
    }
}

impl<S: Stepper> Row<S> {
    fn advance(&mut self, span: &Span) {
        if self.fault.is_none() {
            self.fault = (1..=span.steps).try_for_each(|step| self.stepper.advance_to(span.end_of(step))).err();
        }
    }
}

impl<R: Real<Time = R>, C: Controller<R>> RowByRow<ControlledStepper<R, C>> {
    /// What the controller of a row has decided, in order of time; nothing of a row that is not there.
    pub fn decisions(&self, row: usize) -> &[Decision<R>] {
        self.row(row).map_or(&[], ControlledStepper::decisions)
    }
}

impl<R: Real<Time = R>, C: JointController<R>> RowByRow<ControlledJointStepper<R, C>> {
    /// What the controller of a row has decided, in order of time; nothing of a row that is not there.
    pub fn decisions(&self, row: usize) -> &[JointDecision<R>] {
        self.row(row).map_or(&[], ControlledJointStepper::decisions)
    }
}
