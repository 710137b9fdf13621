//! Matrices with the names and units of what they act on.

use alloc::vec::Vec;

/// A state, an input or an output: the difference from its value at the operating point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Signal {
    /// Its name, as in the columns of a run.
    pub name: &'static str,
    /// Its symbol.
    pub symbol: &'static str,
    /// Its SI unit; empty for a pure number.
    pub unit: &'static str,
}

/// `dx/dt = A x + B u`, `y = C x + D u`, each matrix as its rows.
#[derive(Clone, Debug, PartialEq)]
pub struct StateSpace {
    /// What x holds.
    pub states: Vec<Signal>,
    /// What u holds.
    pub inputs: Vec<Signal>,
    /// What y holds.
    pub outputs: Vec<Signal>,
    /// One row for each state, one column for each state.
    pub a: Vec<Vec<f64>>,
    /// One row for each state, one column for each input.
    pub b: Vec<Vec<f64>>,
    /// One row for each output, one column for each state.
    pub c: Vec<Vec<f64>>,
    /// One row for each output, one column for each input.
    pub d: Vec<Vec<f64>>,
}

impl StateSpace {
    /// Where an input of this name stands in u.
    pub fn input(&self, name: &str) -> Option<usize> {
        self.inputs.iter().position(|signal| signal.name == name)
    }

    /// Where an output of this name stands in y.
    pub fn output(&self, name: &str) -> Option<usize> {
        self.outputs.iter().position(|signal| signal.name == name)
    }

    /// The same without one state that is a linear function of the others, `Σ per_state(name) · x`.
    pub(super) fn without(&self, name: &str, per_state: impl Fn(&str) -> f64) -> Self {
        let Some(gone) = self.states.iter().position(|signal| signal.name == name) else { return self.clone() };
        let kept = || (0..self.states.len()).filter(|n| *n != gone);
        let fold = |row: &Vec<f64>| kept().map(|n| row[n] + row[gone] * per_state(self.states[n].name)).collect();
        Self {
            states: kept().map(|n| self.states[n]).collect(),
            inputs: self.inputs.clone(),
            outputs: self.outputs.clone(),
            a: kept().map(|n| fold(&self.a[n])).collect(),
            b: kept().map(|n| self.b[n].clone()).collect(),
            c: self.c.iter().map(fold).collect(),
            d: self.d.clone(),
        }
    }
}
