//! The step of the fixed-step engine in a sweep.
//!
//! | the sweep | the longest step of a row |
//! |---|---|
//! | gives `run.step`, or varies it | that one |
//! | gives `run.accuracy`, or neither | one for all rows: the least that the rows that are tried need |
//! | varies `run.accuracy`, or no row that is tried can be run | what the row needs individually, as by `mckibben simulate` |
//!
//! Tried are up to [`TRIED`] rows, evenly spread over the numbers of the rows, the first and the last among them. What
//! they need hangs on the sweep alone, so all its shards, and a resumed sweep, take the same step. A row that
//! cannot be run is passed over and has its reason in its own line; one that can, but reaches the accuracy with no step
//! that is tried, is named in the summary.
//!
//! Checked by the program's `tests/sweep.rs`.

use super::schedule;
use crate::failure::Failure;
use crate::progress::Progress;
use mckibben::Error;
use mckibben::parameter as p;
use mckibben::plant::{PlantStepError, TimeStepping};
use mckibben_scenario::{Engine, Run, Sweep};

/// At most how many rows are tried.
pub const TRIED: u64 = 8;

/// One step for all rows that give none.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The longest step in s.
    pub step: f64,
    /// The accuracy that it is chosen for.
    pub accuracy: f64,
    /// The rows that it is enough for, of those that were tried.
    pub reached: Vec<u64>,
    /// The rows that no step is enough for.
    pub unreached: Vec<u64>,
}

impl Choice {
    /// Tries rows of a sweep on `jobs` threads. `None` when the rows give their steps.
    ///
    /// # Errors
    /// As [`schedule::in_order`].
    pub fn of(sweep: &Sweep, jobs: usize) -> Result<Option<Self>, Failure> {
        let varies_accuracy = sweep.axes().iter().any(|axis| axis.path == p::ACCURACY.key);
        if sweep.gives_step() || varies_accuracy || !sweep.uses_engine(Engine::FixedStep) {
            return Ok(None);
        }
        let _progress = Progress::begin("choosing the step", None);
        let mut choice: Option<Self> = None;
        let mut unreached = Vec::new();
        schedule::in_order(
            jobs,
            spread(sweep.rows()),
            |row| needed(sweep, *row),
            |row, needed| {
                match needed {
                    Some(Ok((step, accuracy))) => {
                        let known = choice.get_or_insert_with(|| Self {
                            step,
                            accuracy,
                            reached: Vec::new(),
                            unreached: Vec::new(),
                        });
                        known.step = known.step.min(step);
                        known.reached.push(row);
                    }
                    Some(Err(Error::Inconsistent { parameter, .. })) if parameter.key == p::ACCURACY.key => {
                        unreached.push(row);
                    }
                    Some(Err(_)) | None => {}
                }
                Ok(())
            },
        )?;
        Ok(choice.map(|choice| Self { unreached, ..choice }))
    }
}

/// How a row goes through time: as it says, or by the step for all, or by the one that it needs.
///
/// # Errors
/// What `needed` finds.
pub(super) fn stepping(
    run: &Run,
    choice: Option<&Choice>,
    needed: impl FnOnce() -> Result<(TimeStepping, Option<PlantStepError>), Error>,
) -> Result<TimeStepping, Error> {
    match (run.engine, run.step, choice) {
        (Engine::FixedStep, None, Some(choice)) => Ok(run.fixed(choice.step)),
        _ => needed().map(|(how, _)| how),
    }
}

/// The rows to try, of so many.
fn spread(rows: u64) -> impl Iterator<Item = u64> {
    let tried = rows.min(TRIED);
    let row = move |index| u128::from(index) * u128::from(rows - 1) / u128::from((tried - 1).max(1));
    (0..tried).map(move |index| row(index) as u64)
}

/// The step that a row at fixed steps needs, with its accuracy.
fn needed(sweep: &Sweep, row: u64) -> Option<Result<(f64, f64), Error>> {
    let (run, needed) = match sweep.plant(row) {
        Some(plant) => plant.ok().map(|plant| (plant.run, plant.stepping()))?,
        None => {
            let scenario = sweep.scenario(row).ok()?;
            let needed = match (scenario.has_joint(), scenario.has_controller()) {
                (false, false) => scenario.experiment().ok()?.stepping(),
                (false, true) => scenario.controlled_experiment().ok()??.stepping(),
                (true, false) => scenario.joint_experiment().ok()??.stepping(),
                (true, true) => scenario.controlled_joint_experiment().ok()??.stepping(),
            };
            (scenario.run, needed)
        }
    };
    match needed {
        Ok((TimeStepping::Fixed { step, .. }, _)) => Some(Ok((step, run.accuracy))),
        Ok((TimeStepping::Located { .. }, _)) => None,
        Err(error) => Some(Err(error)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_to_try_are_evenly_spread_from_the_first_to_the_last() {
        for rows in [1, 2, 7, 8, 9, 63, 10_000, u64::MAX] {
            let tried: Vec<u64> = spread(rows).collect();
            assert_eq!(tried.len() as u64, rows.min(8));
            assert_eq!((tried[0], tried[tried.len() - 1]), (0, rows - 1));
            let gaps: Vec<u64> = tried.windows(2).map(|pair| pair[1] - pair[0]).collect();
            let (least, greatest) = (gaps.iter().min(), gaps.iter().max());
            assert!(
                gaps.is_empty() || (least > Some(&0) && greatest <= least.map(|gap| gap + 1).as_ref()),
                "{tried:?}"
            );
        }
    }
}
