//! An element of a batch: a plant that goes on, or why it has stopped.
//!
//! Rows of one group share what they compute with, the desk: each comes to it with what is its own.

use crate::span::Span;
use mckibben::internals::host_mechanisms;
use mckibben::plant::{PlantRow, PlantSteps};
use mckibben::{Error, Response};
use std::ops::Range;

/// What of a row its lane does not know yet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Change {
    None,
    /// Its valves have been set.
    Commands,
    /// Its state and its mode as well.
    All,
}

/// A plant that goes on, or why it has stopped.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    /// Where it is; its lane may be ahead of it.
    pub(crate) steps: Box<PlantRow>,
    pub(crate) fault: Option<Error>,
    pub(crate) change: Change,
    /// The next instant in s that is known; infinite when none is.
    pub(crate) next: f64,
    /// When in s pulses have to be laid out next.
    pub(crate) edge: f64,
    /// Its number in the batch, and which of the coordinates are its own that a host moves.
    pub(crate) index: usize,
    pub(crate) coordinates: Range<usize>,
}

/// The rows of a group, all of equal structure.
#[derive(Clone, Debug)]
pub(crate) struct Rows {
    pub(crate) list: Vec<Row>,
    /// What they compute with, one after the other.
    pub(crate) desk: PlantSteps,
}

/// Those of them that are the lanes of one block.
pub(crate) struct BlockRows<'r> {
    pub(crate) list: &'r mut [Row],
    pub(crate) desk: &'r mut PlantSteps,
}

impl Rows {
    /// Those of a group, one at least.
    pub(crate) fn of(list: Vec<Row>) -> Self {
        let desk = list[0].steps.to_steps();
        Self { list, desk }
    }
}

impl Row {
    /// A row of this number, whose coordinates that a host moves begin at `first`.
    pub(crate) fn new(steps: PlantRow, index: usize, first: usize) -> Self {
        let own: usize = host_mechanisms(steps.plant()).map(|(_, here)| here.coordinates).sum();
        Self {
            steps: Box::new(steps),
            fault: None,
            change: Change::All,
            next: f64::INFINITY,
            edge: f64::NEG_INFINITY,
            index,
            coordinates: first..first + own,
        }
    }

    /// Sends its ends off, to where they come within a span in s.
    pub(crate) fn set_off(&mut self, desk: &mut PlantSteps, span: f64, distances: &[f64]) -> Result<(), Error> {
        let own = &distances[self.coordinates.clone()];
        desk.visit(&mut self.steps, |steps| {
            steps.check_moves(span, own)?;
            steps.begin_move(span, own);
            Ok(())
        })
    }

    /// Computes what its actuators answer with the ends at these distances and moving at these rates.
    pub(crate) fn compute_at(
        &mut self,
        desk: &mut PlantSteps,
        [distances, rates]: [&[f64]; 2],
        responses: &mut [Response],
    ) -> Result<(), Error> {
        let own = self.coordinates.clone();
        desk.visit(&mut self.steps, |steps| steps.compute_at(&distances[own.clone()], &rates[own], responses))
    }

    pub(crate) fn is_alive(&self) -> bool {
        self.fault.is_none()
    }

    pub(crate) fn stop(&mut self, fault: Error) {
        self.fault = Some(fault);
        self.next = f64::INFINITY;
    }

    /// Notes that something of it has changed.
    pub(crate) fn changes(&mut self, change: Change) {
        if self.change != Change::All {
            self.change = change;
        }
    }

    /// Finds the next instant up to `until` in s, and when pulses have to be laid out.
    pub(crate) fn look_ahead(&mut self, until: f64) {
        self.next = self.steps.next_instant(until);
        self.edge = self.steps.pulse_edge();
    }

    /// Steps through a span as a scalar instance.
    pub(crate) fn advance(&mut self, desk: &mut PlantSteps, span: &Span<'_>) {
        if self.is_alive() {
            self.fault = self.go(desk, span).err();
        }
    }

    fn go(&mut self, desk: &mut PlantSteps, span: &Span<'_>) -> Result<(), Error> {
        if let Some(distances) = span.distances {
            self.set_off(desk, span.until() - span.from, distances)?;
        }
        desk.visit(&mut self.steps, |steps| {
            span.ends.iter().try_for_each(|end| steps.advance_to(*end))?;
            if let Some(distances) = span.distances {
                steps.end_move(&distances[self.coordinates.clone()]);
            }
            Ok(())
        })
    }
}
