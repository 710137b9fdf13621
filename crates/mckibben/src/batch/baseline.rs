//! Batches for machines without wide registers: every row goes by itself, as the fixed-step engine does, on all cores.

use super::engine::{Dealing, Demands, Engine, Show};
use super::lane::Lane;
use super::span::Span;
use super::{Row, RowByRow};
use crate::error::Error;
use crate::lanes::wide::Number;
use crate::simulation::closed_loop::Control;
use crate::simulation::course::Course;
use crate::simulation::fixed_step::Walk;
use crate::simulation::piped::{of_rig, volume};
use crate::simulation::sample::Sample;
use crate::simulation::told::Told;
use crate::simulation::{Decision, Method, State, Stepper};
use crate::valve::{Demand, Openings};
use alloc::boxed::Box;
use alloc::vec::Vec;
use rayon::prelude::*;

/// Rows one by one, each a block of its own.
#[derive(Debug)]
pub(super) struct Baseline<R: Number>(RowByRow<Single<R>>);

/// A row with its numbers as they are in lanes.
#[derive(Debug)]
struct Single<R: Number> {
    method: Method,
    lane: Lane<R>,
    walk: Walk<R>,
    told: Told<f64>,
}

impl<R: Number> Baseline<R> {
    /// Rows of a batch.
    pub(super) fn build(rows: &[Row], deal: Dealing<'_>, method: Method) -> Box<dyn Engine>
    where
        R: 'static,
    {
        let begun: Vec<_> =
            deal(1).par_iter().flat_map_iter(|block| block).map(|row| Single::begin(&rows[*row], method)).collect();
        let (steppers, faults): (_, Vec<Option<Error>>) = begun.into_iter().unzip();
        let mut rows = RowByRow::at(0.0, steppers);
        for (row, fault) in faults.into_iter().enumerate().filter_map(|(row, fault)| Some((row, fault?))) {
            rows.stop(row, fault);
        }
        Box::new(Self(rows))
    }
}

impl<R: Number> Engine for Baseline<R> {
    fn advance(&mut self, Span { until, steps, .. }: Span) {
        self.0.advance(until, steps);
    }

    fn go(&mut self, span: Span, demand: &Demands<'_>, show: Option<Show<'_>>) {
        self.0.for_each_living(|row, single| demand(row, 0).map_or(Ok(()), |demand| single.tell(demand)));
        self.advance(span);
        if let Some(show) = show {
            show.where_are(|row| self.state(row, 0));
        }
    }

    fn control(&mut self, block: usize, _: usize, control: Box<dyn Control>) {
        if let Some(Single { lane, walk, .. }) = self.0.living(block) {
            lane.control = Some(control);
            if let Err(fault) = lane.sample_due(walk) {
                self.0.stop(block, fault);
            }
        }
    }

    fn decisions(&self, block: usize, _: usize) -> &[Decision] {
        let control = self.0.row(block).and_then(|row| row.lane.control.as_ref());
        control.map_or(&[], |control| control.decisions())
    }

    fn tell(&mut self, block: usize, _: usize, demand: Demand) -> Result<(), Error> {
        self.0.running(block)?.tell(demand)
    }

    fn restart(&mut self, block: usize, rows: &[(usize, &Row)]) -> Result<(), Error> {
        let time = self.0.time();
        for (_, row) in rows {
            let Some(Single { method, lane, .. }) = self.0.row(block) else { return Ok(()) };
            let (mut lane, mut walk) = lane.anew(row, time)?;
            lane.pass(&mut walk)?;
            let single = Single { method: *method, lane, walk, told: Told::nothing() };
            self.0.put(block, single);
        }
        Ok(())
    }

    fn restart_all(&mut self, rows: &[Vec<(usize, &Row)>]) -> Result<(), Error> {
        rows.iter().enumerate().try_for_each(|(block, rows)| self.restart(block, rows))
    }

    fn state(&self, block: usize, _: usize) -> Result<State, &Error> {
        let Single { walk, .. } = self.0.alive(block)?;
        Ok(State::from_array(of_rig(&walk.course.state).map(|number| number.value())))
    }

    fn samples(&self) -> Vec<Vec<Result<Sample, Error>>> {
        self.0.samples().into_iter().map(|sample| [sample].into()).collect()
    }
}

impl<R: Number> Single<R> {
    /// A row at t = 0 with what is due then behind it, and why it goes no further, if so.
    fn begin(row: &Row, method: Method) -> (Self, Option<Error>) {
        let mut lane = Lane::<R>::new(row, None);
        let mut walk = lane.begin(row, 0.0);
        let fault = lane.fault.take().or_else(|| lane.pass(&mut walk).err());
        (Self { method, lane, walk, told: Told::nothing() }, fault)
    }

    fn tell(&mut self, demand: Demand) -> Result<(), Error> {
        let Self { lane, walk, told, .. } = self;
        let Walk { course, progress, .. } = walk;
        told.tell(|| Ok((lane.valve_mut()?, progress)), course.time, demand)
    }
}

impl<R: Number> Stepper for Single<R> {
    type Sample = Sample;

    fn time(&self) -> f64 {
        self.walk.course.time
    }

    fn advance_to(&mut self, until: f64) -> Result<(), Error> {
        let Self { lane, walk, told, .. } = self;
        let time = walk.course.time;
        if told.hear(|| (lane.actuation.as_mut(), &mut walk.progress), [time, until]) {
            lane.pass_due(walk);
        }
        self.lane.go(&mut self.walk, self.method, until, None)
    }

    fn sample(&self) -> Sample {
        let Self { lane, walk, .. } = self;
        let Course { time, state, held } = &walk.course;
        let observed = lane.rig.observe(R::of_time(*time), state, held).map(|number| number.value());
        let hose = lane.rig.hose_content(state).map(|air| [state[volume(0)].value(), air.value()]);
        let supply = lane.rig.feed(state).map(|pressure| pressure.value());
        let four = of_rig(state).map(|number| number.value());
        let sample = Sample::of_values(*time, four, &observed, (walk.ports, hose, supply));
        match lane.openings(&walk.progress) {
            Openings::Whole => sample,
            _ => lane.under_way(walk, sample),
        }
    }
}
