//! Batches for machines without wide registers: every row goes by itself, as the fixed-step engine does, on all cores.

use super::Row;
use super::block::Span;
use super::engine::{Dealing, Engine};
use super::lane::Lane;
use super::wide::Number;
use crate::error::Error;
use crate::friction::Memory;
use crate::simulation::closed_loop::Control;
use crate::simulation::course::Course;
use crate::simulation::fixed_step::{Walk, compressor_starts, stepped};
use crate::simulation::kernel::Held;
use crate::simulation::piped::{of_rig, volume};
use crate::simulation::sample::Sample;
use crate::simulation::{Decision, Method};
use crate::valve::Openings;
use alloc::boxed::Box;
use alloc::vec::Vec;
use rayon::prelude::*;

/// Rows one by one.
#[derive(Debug)]
pub(super) struct Baseline<R: Number> {
    method: Method,
    rows: Vec<Single<R>>,
}

#[derive(Debug)]
struct Single<R: Number> {
    lane: Lane<R>,
    walk: Walk<R>,
}

impl<R: Number> Baseline<R> {
    /// Rows of a batch, each a block of its own.
    pub(super) fn build(rows: &[Row], deal: Dealing<'_>, method: Method) -> Box<dyn Engine>
    where
        R: 'static,
    {
        let blocks = deal(1);
        let rows = blocks.par_iter().flat_map_iter(|block| block).map(|row| Single::new(&rows[*row])).collect();
        Box::new(Self { method, rows })
    }
}

impl<R: Number> Engine for Baseline<R> {
    fn advance(&mut self, from: f64, until: f64, steps: u64) {
        let (span, method) = (Span { from, until, steps }, self.method);
        match self.rows.as_mut_slice() {
            [row] => row.advance(&span, method),
            rows => rows.par_iter_mut().for_each(|row| row.advance(&span, method)),
        }
    }

    fn control(&mut self, block: usize, _: usize, control: Box<dyn Control>) {
        let Single { lane, walk } = &mut self.rows[block];
        lane.control = Some(control);
        if lane.fault.is_none() {
            lane.fault = lane.sample_due(walk).err();
        }
    }

    fn decisions(&self, block: usize, _: usize) -> &[Decision] {
        self.rows[block].lane.control.as_ref().map_or(&[], |control| control.decisions())
    }

    fn samples(&self) -> Vec<Vec<Result<Sample, Error>>> {
        self.rows.iter().map(|row| [row.sample()].into()).collect()
    }
}

impl<R: Number> Single<R> {
    fn new(row: &Row) -> Self {
        let (mut lane, start) = (Lane::<R>::new(row), stepped(&row.rig, row.start));
        let state = start.map(R::constant);
        let memory = Memory::relaxed(lane.rig.actuator().limits().actuator_length(state[0]));
        let held = Held { memory, compressor: compressor_starts(&row.rig, &start), ..Held::nothing() };
        let mut walk = Walk { course: Course { time: 0.0, state, held }, progress: lane.progress, ports: lane.ports };
        if lane.fault.is_none() {
            lane.fault = lane.pass(&mut walk).err();
        }
        Self { lane, walk }
    }

    fn advance(&mut self, span: &Span, method: Method) {
        let Self { lane, walk } = self;
        if lane.fault.is_none() {
            lane.fault = (1..=span.steps).try_for_each(|step| lane.go(walk, method, span.end_of(step), None)).err();
            lane.progress = walk.progress;
        }
    }

    fn sample(&self) -> Result<Sample, Error> {
        let Self { lane, walk } = self;
        if let Some(fault) = &lane.fault {
            return Err(fault.clone());
        }
        let Course { time, state, held } = &walk.course;
        let observed = lane.rig.observe(R::of_time(*time), state, held).map(|number| number.value());
        let hose = lane.rig.hose_content(state).map(|air| [state[volume(0)].value(), air.value()]);
        let supply = lane.rig.feed(state).map(|pressure| pressure.value());
        let sample =
            Sample::of_values(*time, of_rig(state).map(|number| number.value()), &observed, (walk.ports, hose, supply));
        Ok(match lane.openings() {
            Openings::Whole => sample,
            _ => lane.under_way(walk, sample),
        })
    }
}
