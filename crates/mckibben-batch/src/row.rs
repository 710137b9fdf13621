//! An element of a batch: a plant that goes on, or why it has stopped.

use crate::span::Span;
use mckibben::Error;
use mckibben::plant::PlantSteps;

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
#[derive(Debug)]
pub(crate) struct Row {
    /// Where it is; its lane may be ahead of it.
    pub(crate) steps: PlantSteps,
    pub(crate) fault: Option<Error>,
    pub(crate) change: Change,
    /// The next instant in s that is known; infinite when none is.
    pub(crate) next: f64,
    /// When in s pulses have to be laid out next.
    pub(crate) edge: f64,
}

impl Row {
    pub(crate) fn new(steps: PlantSteps) -> Self {
        Self { steps, fault: None, change: Change::All, next: f64::INFINITY, edge: f64::NEG_INFINITY }
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

    /// Goes through a span alone.
    pub(crate) fn advance(&mut self, span: &Span<'_>) {
        if self.is_alive() {
            self.fault = span.ends.iter().try_for_each(|end| self.steps.advance_to(*end)).err();
        }
    }
}
