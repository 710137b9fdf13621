//! The figures of a run of a plant: extremes, events, and the ledger of energy, exergy and air.
//!
//! A run is observed step by step as it is made, in five points of each step, at the sample interval, at least at 2000 instants, and
//! where a quantity turns at an extreme: nothing of it is kept.

use super::Made;
use crate::observation::{Ended, Peaks, Range, Times, dense_times};
use crate::warnings::Reached;
use mckibben::plant::{PlantLedgerKeeper, PlantSample, PlantStep};
use mckibben::simulation::{EventKind, Readable as _, Reading};
use mckibben_scenario::{PlantExperiment, PlantQuantity};
use std::collections::BTreeMap;

/// Samples in which extremes are looked for at least.
const LEAST_SAMPLES: f64 = 2000.0;

/// Everything that is observed.
#[derive(Clone, Debug)]
pub struct Observation {
    /// How many events of each kind there were.
    pub events: BTreeMap<EventKind, u64>,
    /// The columns of the table of states.
    pub rows: Vec<Row>,
    /// What each actuator reached, for the warnings.
    pub(crate) reached: Vec<Reached>,
    /// Steps and ledger.
    pub ended: Ended,
}

/// A line of the table of states; without a unit a heading.
#[derive(Clone, Debug)]
pub struct Row {
    /// What it is of.
    pub name: String,
    /// Its name among all numbers, such as `flexor.length`; empty of a heading.
    pub key: String,
    /// Its unit.
    pub unit: &'static str,
    /// The value at the end.
    pub last: f64,
    /// The least and the greatest value.
    pub range: Range,
    quantity: Option<PlantQuantity>,
    /// What is subtracted: the atmosphere of a gauge pressure.
    less: f64,
}

/// Observes a run.
pub(crate) struct Observer<'e> {
    experiment: &'e PlantExperiment,
    events: BTreeMap<EventKind, u64>,
    rows: Vec<Row>,
    /// Of the rows that are no headings.
    peaks: Peaks<Vec<f64>>,
    reached: Vec<Reached>,
    keeper: PlantLedgerKeeper<'e>,
    samples: Reading<Times>,
}

impl<'e> Observer<'e> {
    pub(crate) fn new(experiment: &'e PlantExperiment) -> Self {
        let run = &experiment.run;
        let rows = rows(experiment);
        Self {
            experiment,
            events: BTreeMap::new(),
            peaks: Peaks::new(rows.iter().filter(|row| row.quantity.is_some()).count()),
            rows,
            reached: vec![Reached::NONE; experiment.plant.actuators().len()],
            keeper: PlantLedgerKeeper::new(&experiment.plant, run.stepping()),
            samples: Reading::new(dense_times(run, LEAST_SAMPLES), run.duration),
        }
    }

    /// Takes a step.
    pub(crate) fn step(&mut self, step: &PlantStep<'_>) {
        let Self { experiment, events, rows, peaks, reached, keeper, samples } = self;
        keeper.step(step);
        let mut see = |time, sample: &PlantSample| {
            peaks.see(time, values(rows, experiment, sample));
            reach(reached, experiment, sample);
        };
        let Ok(()) = samples.step(step, |sample: &PlantSample| {
            see(sample.time, sample);
            Ok::<_, std::convert::Infallible>(())
        });
        // What is passed within an instant has no place in the run.
        let (start, end) = (step.start(), step.end());
        if step.holds(start) {
            let within = [0.25, 0.5, 0.75].map(|part| start + part * (end - start));
            [start, end].into_iter().chain(within).for_each(|time| see(time, &step.read(time)));
        }
        peaks.turn(|time| {
            let sample = step.read(time);
            reach(reached, experiment, &sample);
            values(rows, experiment, &sample)
        });
        if let Some(event) = step.event() {
            *events.entry(event.kind.kind).or_insert(0) += 1;
        }
    }

    /// The figures of a run that has come to its end.
    pub(crate) fn finish(mut self, made: &Made) -> Observation {
        let run = &made.run;
        let last = run.sample();
        let values = values(&self.rows, self.experiment, &last);
        self.peaks.widen(&values);
        let seen = self.rows.iter_mut().filter(|row| row.quantity.is_some()).zip(values).zip(self.peaks.ranges());
        seen.for_each(|((row, value), range)| (row.last, row.range) = (value, *range));
        reach(&mut self.reached, self.experiment, &last);
        let counts = run.statistics();
        let draws = !run.plant().network().valves.is_empty();
        let ended = Ended { counts, ledger: self.keeper.finish(run), draws, steps: made.stepping.steps(counts) };
        Observation { events: self.events, rows: self.rows, reached: self.reached, ended }
    }
}

/// The quantities of the rows that are no headings.
fn values(rows: &[Row], of: &PlantExperiment, sample: &PlantSample) -> Vec<f64> {
    rows.iter().filter_map(|row| Some(row.quantity?.of(&of.plant, sample) - row.less)).collect()
}

fn reach(reached: &mut [Reached], of: &PlantExperiment, sample: &PlantSample) {
    for ((reached, mounted), sample) in reached.iter_mut().zip(of.plant.actuators()).zip(&sample.actuators) {
        reached.see_in_plant(&mounted.actuator, sample);
    }
}

fn rows(of: &PlantExperiment) -> Vec<Row> {
    let atmosphere = of.plant.network().atmosphere;
    let row = |name: &str, key: String, unit, quantity, less| Row {
        name: name.to_owned(),
        key,
        unit,
        last: 0.0,
        range: Range::NONE,
        quantity,
        less,
    };
    let mut rows = Vec::new();
    for its in of.coordinates() {
        let (what, unit) = if its.is_angle { ("angle", "rad") } else { ("position", "m") };
        let quantity = PlantQuantity::Position(its.mechanism, its.index);
        rows.push(row(&its.name, format!("{}.{what}", its.name), unit, Some(quantity), 0.0));
    }
    for (index, actuator) in of.names.actuators.iter().enumerate() {
        rows.push(row(actuator, String::new(), "", None, 0.0));
        for (name, key, unit, quantity, less) in [
            ("length", "length", "m", PlantQuantity::Length(index), 0.0),
            ("tension", "tension", "N", PlantQuantity::Tension(index), 0.0),
            ("gauge pressure", "gauge_pressure", "Pa", PlantQuantity::Pressure(index), atmosphere),
        ] {
            rows.push(row(name, format!("{actuator}.{key}"), unit, Some(quantity), less));
        }
    }
    for (name, node) in &of.names.nodes {
        let quantity = PlantQuantity::NodePressure(*node);
        rows.push(row(&format!("{name}, gauge"), format!("{name}.gauge_pressure"), "Pa", Some(quantity), atmosphere));
    }
    rows
}
