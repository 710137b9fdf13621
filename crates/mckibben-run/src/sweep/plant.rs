//! What is made of the runs of rows that are plants.

use super::reduce::missed;
use super::rows::{self, Outcome, Row, not_finite};
use super::series::{LAST_PART, Series, Windows};
use super::step::{self, Choice};
use crate::plant::columns;
use crate::plant::control::Follower;
use crate::table::Cell;
use mckibben::Error;
use mckibben::plant::{PlantLedger, PlantLedgerKeeper, PlantRun, PlantSample, PlantStep};
use mckibben::valve::Command;
use mckibben_scenario::sweep::Statistic;
use mckibben_scenario::{
    PlantColumn, PlantContent, PlantExperiment, PlantQuantity, PlantReduced, PlantReduction, Record, Sweep,
};

/// A row before its first step.
pub(super) fn ready<'r>(of: &'r PlantExperiment, choice: Option<&Choice>, sweep: &'r Sweep) -> Result<Row<'r>, Error> {
    let how = step::stepping(&of.run, choice, || of.stepping())?;
    let drivers = of.drivers();
    let recorder = Recorder::new(of, sweep.record());
    Row::new(of.run, (&of.plant, &of.start), how, drivers, Box::new(recorder))
}

/// What is made of the samples of a run.
struct Recorder<'a> {
    of: &'a PlantExperiment,
    /// The columns of samples with their indices in this row; none where reductions are recorded.
    columns: Vec<PlantColumn>,
    /// What is reduced, with its indices in this row, and how.
    reductions: Option<Vec<(PlantReduced, Statistic)>>,
    series: Series<PlantQuantity>,
    rows: Vec<Vec<Cell<'static>>>,
    fault: Option<String>,
    /// The ledger, where the air that is used or its exergy is recorded.
    keeper: Option<PlantLedgerKeeper<'a>>,
    /// What controllers decide, where their errors are recorded.
    follower: Option<Follower<'a>>,
}

impl<'a> Recorder<'a> {
    fn new(of: &'a PlantExperiment, record: &Record) -> Self {
        let in_row = |reduction: &PlantReduction| (reduction.in_row(of), reduction.statistic);
        let (columns, reductions) = match record {
            Record::PlantReductions(list) => (Vec::new(), Some(list.iter().map(in_row).collect::<Vec<_>>())),
            _ => (of.columns(), None),
        };
        let of_samples = |(reduced, statistic): &(PlantReduced, Statistic)| match reduced {
            PlantReduced::Quantity(quantity) => Some((*quantity, *statistic)),
            PlantReduced::Error(..) | PlantReduced::Air | PlantReduced::Efficiency => None,
        };
        let records = |wanted: fn(PlantReduced) -> bool| reductions.iter().flatten().any(|(of, _)| wanted(*of));
        let keeper = records(|of| matches!(of, PlantReduced::Air | PlantReduced::Efficiency))
            .then(|| PlantLedgerKeeper::new(&of.plant, of.run.stepping()));
        let follower = records(|of| matches!(of, PlantReduced::Error(..))).then(|| Follower::new(of));
        let duration = of.run.duration;
        let period = slowest_period(of).unwrap_or(LAST_PART * duration);
        Self {
            of,
            columns,
            series: Series::new(reductions.iter().flatten().filter_map(of_samples), Windows::last(period, duration)),
            reductions,
            rows: Vec::new(),
            fault: None,
            keeper,
            follower,
        }
    }
}

impl rows::Recorder for Recorder<'_> {
    fn see(&mut self, sample: &PlantSample) {
        if self.fault.is_some() {
            return;
        }
        let (plant, time) = (&self.of.plant, sample.time);
        if self.reductions.is_some() {
            self.series.see(time, |quantity: PlantQuantity| quantity.of(plant, sample));
            return;
        }
        let cell = |column: &PlantColumn| match column.content {
            PlantContent::Number(quantity) => Cell::Number(quantity.of(plant, sample)),
            PlantContent::Ports(valve) => Cell::Word(columns::ports(valve, sample)),
        };
        let row: Vec<Cell<'_>> = std::iter::once(Cell::Number(time)).chain(self.columns.iter().map(cell)).collect();
        self.fault = not_finite(&row, |place| match place.checked_sub(1) {
            Some(place) => self.columns[place].title(),
            None => "time_s".to_owned(),
        });
        self.rows.push(row);
    }

    fn turn_to_orbit(&mut self, windows: Option<Windows>) {
        self.series.turn_to_orbit(windows);
    }

    fn see_orbit(&mut self, window: usize, weight: f64, sample: &PlantSample) {
        let plant = &self.of.plant;
        self.series.see_orbit((sample.time, window, weight), |quantity: PlantQuantity| quantity.of(plant, sample));
    }

    fn takes_steps(&self) -> bool {
        self.keeper.is_some() || self.follower.is_some()
    }

    fn step(&mut self, step: &PlantStep<'_>) {
        if let Some(keeper) = &mut self.keeper {
            keeper.step(step);
        }
        if let (Some(follower), Some(decision)) = (&mut self.follower, step.decision()) {
            follower.see(decision);
        }
    }

    fn finish(self: Box<Self>, run: Option<&PlantRun>) -> Outcome {
        if let Some(fault) = self.fault {
            return Outcome::Failed(fault);
        }
        let Some(reductions) = self.reductions else { return Outcome::Sampled(self.rows) };
        let ledger = self.keeper.zip(run).map(|(keeper, run)| keeper.finish(run));
        let owners = self.follower.as_ref().map_or_else(Vec::new, Follower::owners);
        let goals = self.follower.and_then(Follower::finish).map_or_else(Vec::new, |closed| closed.goals);
        let value = |(reduced, statistic): &(PlantReduced, Statistic)| match *reduced {
            PlantReduced::Air => ledger.as_ref().map(PlantLedger::air_used),
            PlantReduced::Efficiency => {
                ledger.as_ref().filter(|_| !self.of.plant.network().valves.is_empty())?.total().efficiency()
            }
            PlantReduced::Error(control, quantity) => {
                let own =
                    goals.iter().zip(&owners).filter(|(goal, owner)| **owner == control && goal.quantity == quantity);
                missed(own.map(|(goal, _)| goal), *statistic)
            }
            PlantReduced::Quantity(quantity) => self.series.reduced(quantity, *statistic),
        };
        Outcome::Reduced(
            reductions.iter().map(|reduction| value(reduction).filter(|value| value.is_finite())).collect(),
        )
    }
}

/// The longest period in s of the pulses that are commanded; none without pulses.
fn slowest_period(of: &PlantExperiment) -> Option<f64> {
    let driven: Vec<usize> = of.controls.iter().flat_map(|control| control.driver().valves().to_vec()).collect();
    let valves = of.plant.network().valves.iter().enumerate().filter(|(valve, _)| !driven.contains(valve));
    let periods = valves.filter_map(|(_, its)| match its.command {
        Command::Pwm { frequency, .. } => Some(1.0 / frequency),
        _ => None,
    });
    periods.reduce(f64::max)
}
