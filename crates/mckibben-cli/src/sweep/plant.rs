//! The runs of rows that are plants: each by the event-located engine, streamed and not kept.

use super::reduce::{LAST_PART, SIMULTANEOUS, Track, missed};
use super::rows::{Outcome, PlantCell, Samples};
use crate::plant::control::Follower;
use crate::plant::observation::air_used;
use crate::plant::{self, columns};
use mckibben::Error;
use mckibben::plant::{PlantLedgerKeeper, PlantSample};
use mckibben::simulation::{Reading, SampleTimes};
use mckibben::valve::Command;
use mckibben_scenario::{
    PlantColumn, PlantContent, PlantExperiment, PlantQuantity, PlantReduced, PlantReduction, Record,
};

/// Runs a row.
pub(super) fn run(of: &PlantExperiment, columns: &[PlantColumn], record: &Record) -> Outcome {
    simulate(of, columns, record).unwrap_or_else(|error| Outcome::Failed(error.to_string()))
}

fn simulate(of: &PlantExperiment, columns: &[PlantColumn], record: &Record) -> Result<Outcome, Error> {
    let run = &of.run;
    let mut recorder = Recorder::new(of, columns, record);
    let mut follower = Follower::new(of);
    let times: Box<dyn Iterator<Item = f64>> = match record {
        Record::Samples(times) => Box::new(times.iter().copied()),
        _ => Box::new(SampleTimes::new(run.duration, run.sample_interval).times()),
    };
    let mut reading = Reading::new(times, run.duration);
    let uses_air = matches!(record, Record::PlantReductions(list) if list.iter().any(|of| of.of == PlantReduced::Air));
    let mut keeper = uses_air.then(|| PlantLedgerKeeper::new(&of.plant, run.stepping()));
    let made = plant::stream(of, &mut follower, &mut |step| {
        if let Some(keeper) = &mut keeper {
            keeper.step(step);
        }
        reading.step(step, |sample: &PlantSample| {
            recorder.see(sample);
            Ok(())
        })
    })?;
    let last = made.run.sample();
    reading.finish(&last, |sample| {
        recorder.see(sample);
        Ok::<_, Error>(())
    })?;
    let air = keeper.map(|keeper| air_used(of, &keeper.finish(&made.run)));
    Ok(recorder.finish(follower, air))
}

/// What is made of the samples of a run.
struct Recorder<'a> {
    of: &'a PlantExperiment,
    columns: &'a [PlantColumn],
    reductions: Option<&'a [PlantReduction]>,
    tracks: Vec<Track<PlantQuantity>>,
    times: Vec<f64>,
    settles: bool,
    window_start: f64,
    last: Option<f64>,
    rows: Vec<Vec<PlantCell>>,
    fault: Option<String>,
}

impl<'a> Recorder<'a> {
    fn new(of: &'a PlantExperiment, columns: &'a [PlantColumn], record: &'a Record) -> Self {
        let reductions = match record {
            Record::PlantReductions(list) => Some(list.as_slice()),
            _ => None,
        };
        let mut tracks = Vec::new();
        for PlantReduction { of, statistic, .. } in reductions.unwrap_or_default() {
            if let PlantReduced::Quantity(quantity) = of {
                Track::add(&mut tracks, *quantity, *statistic);
            }
        }
        let duration = of.run.duration;
        let period = slowest_period(of).unwrap_or(LAST_PART * duration);
        Self {
            of,
            columns,
            reductions,
            settles: tracks.iter().any(Track::settles),
            tracks,
            times: Vec::new(),
            window_start: duration - period - SIMULTANEOUS * duration,
            last: None,
            rows: Vec::new(),
            fault: None,
        }
    }

    fn see(&mut self, sample: &PlantSample) {
        if self.fault.is_some() {
            return;
        }
        let (plant, time) = (&self.of.plant, sample.time);
        if self.reductions.is_some() {
            let step = self.last.map(|before| time - before);
            for track in &mut self.tracks {
                let value = track.quantity().of(plant, sample);
                track.see(value, step, time >= self.window_start);
            }
            if self.settles {
                self.times.push(time);
            }
            self.last = Some(time);
            return;
        }
        let cell = |column: &PlantColumn| match column.content {
            PlantContent::Number(quantity) => PlantCell::Number(quantity.of(plant, sample)),
            PlantContent::Ports(valve) => PlantCell::Word(columns::ports(valve, sample)),
        };
        let row: Vec<PlantCell> =
            std::iter::once(PlantCell::Number(time)).chain(self.columns.iter().map(cell)).collect();
        let fault = |(cell, column): (&PlantCell, &PlantColumn)| match cell {
            PlantCell::Number(value) if !value.is_finite() => {
                Some(format!("{} = {value} at t = {time} s is not a finite number", column.title()))
            }
            _ => None,
        };
        self.fault = row[1..].iter().zip(self.columns).find_map(fault);
        self.rows.push(row);
    }

    fn finish(self, follower: Follower<'_>, air: Option<f64>) -> Outcome {
        if let Some(fault) = self.fault {
            return Outcome::Failed(fault);
        }
        let Some(reductions) = self.reductions else { return Outcome::Sampled(Samples::Plant(self.rows)) };
        let duration = self.last.unwrap_or(0.0);
        let whole = self.window_start > -2.0 * SIMULTANEOUS * duration;
        let owners = follower.owners();
        let goals = follower.finish().map_or_else(Vec::new, |closed| closed.goals);
        let value = |reduction: &PlantReduction| match reduction.of {
            PlantReduced::Air => air,
            PlantReduced::Error(control, quantity) => {
                let own =
                    goals.iter().zip(&owners).filter(|(goal, owner)| **owner == control && goal.quantity == quantity);
                missed(own.map(|(goal, _)| goal), reduction.statistic)
            }
            PlantReduced::Quantity(quantity) => {
                let track = self.tracks.iter().find(|track| track.quantity() == quantity)?;
                track.reduced(reduction.statistic, Some(&self.times), (duration, whole))
            }
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
