//! Matrices with the names and units of what they act on.

use alloc::string::String;
use alloc::vec::Vec;

/// A state, an input or an output by its name: the difference from its value at the operating point.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Signal {
    /// Its name, as in the columns of a run.
    pub name: String,
    /// Its symbol, or its name where it has none.
    pub symbol: String,
    /// Its SI unit; empty for a pure number.
    pub unit: &'static str,
}

impl Signal {
    /// A signal without its own symbol.
    pub fn new(name: impl Into<String>, unit: &'static str) -> Self {
        let name = name.into();
        Self { symbol: name.clone(), name, unit }
    }

    /// The signal with a symbol.
    #[must_use]
    pub fn with_symbol(self, symbol: impl Into<String>) -> Self {
        Self { symbol: symbol.into(), ..self }
    }
}

/// `dx/dt = A x + B u`, `y = C x + D u`, each matrix as its rows. What the entries are is said by signals with names, or by
/// the identities of a plant's states, inputs and outputs.
#[derive(Clone, Debug, PartialEq)]
pub struct StateSpace<X = Signal, U = Signal, Y = Signal> {
    /// What x holds.
    pub states: Vec<X>,
    /// What u holds.
    pub inputs: Vec<U>,
    /// What y holds.
    pub outputs: Vec<Y>,
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
}

impl<X, U, Y> StateSpace<X, U, Y> {
    /// The model with names: the states, inputs and outputs at the given places, in that order. Every state must be among
    /// them, for the others depend on it; inputs and outputs may be left out.
    pub fn named(&self, [states, inputs, outputs]: [Vec<(usize, Signal)>; 3]) -> StateSpace {
        let block = |of: &[Vec<f64>], rows: &[(usize, Signal)], columns: &[(usize, Signal)]| -> Vec<Vec<f64>> {
            let row = |(row, _): &(usize, Signal)| columns.iter().map(|(column, _)| of[*row][*column]).collect();
            rows.iter().map(row).collect()
        };
        StateSpace {
            a: block(&self.a, &states, &states),
            b: block(&self.b, &states, &inputs),
            c: block(&self.c, &outputs, &states),
            d: block(&self.d, &outputs, &inputs),
            states: states.into_iter().map(|(_, signal)| signal).collect(),
            inputs: inputs.into_iter().map(|(_, signal)| signal).collect(),
            outputs: outputs.into_iter().map(|(_, signal)| signal).collect(),
        }
    }
}

impl<X: Clone, U: Clone, Y: Clone> StateSpace<X, U, Y> {
    /// The model without one state that is a linear function of the others and of the inputs,
    /// `Σ per_state(n) · x_n + Σ per_input(k) · u_k`.
    pub(crate) fn eliminate(
        &self,
        gone: usize,
        per_state: impl Fn(usize) -> f64,
        per_input: impl Fn(usize) -> f64,
    ) -> Self {
        let kept = || (0..self.states.len()).filter(|n| *n != gone);
        let by_states = |row: &Vec<f64>| -> Vec<f64> { kept().map(|n| row[n] + row[gone] * per_state(n)).collect() };
        let by_inputs = |row: &Vec<f64>, inputs: &Vec<f64>| -> Vec<f64> {
            inputs.iter().enumerate().map(|(k, entry)| entry + row[gone] * per_input(k)).collect()
        };
        Self {
            states: kept().map(|n| self.states[n].clone()).collect(),
            inputs: self.inputs.clone(),
            outputs: self.outputs.clone(),
            a: kept().map(|n| by_states(&self.a[n])).collect(),
            b: kept().map(|n| by_inputs(&self.a[n], &self.b[n])).collect(),
            c: self.c.iter().map(by_states).collect(),
            d: self.c.iter().zip(&self.d).map(|(row, inputs)| by_inputs(row, inputs)).collect(),
        }
    }
}
