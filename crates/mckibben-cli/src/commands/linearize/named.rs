//! Signals of a linear model by names that a file may choose.

use mckibben::linearize::{Signal, StateSpace};

/// A state, an input or an output by its name.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Named {
    /// Its name, such as `gauge_pressure` or `flexor.pressure`.
    pub name: String,
    /// Its symbol, or its name where it has none.
    pub symbol: String,
    /// SI unit; empty for a pure number.
    pub unit: String,
}

/// A linear model with names.
pub type NamedModel = StateSpace<Named, Named, Named>;

impl From<&Signal> for Named {
    fn from(signal: &Signal) -> Self {
        Self { name: signal.name.to_owned(), symbol: signal.symbol.to_owned(), unit: signal.unit.to_owned() }
    }
}

/// A model with other names for its signals.
pub(super) fn renamed<X, U, Y>(
    of: &StateSpace<X, U, Y>,
    (state, input, output): (impl Fn(&X) -> Named, impl Fn(&U) -> Named, impl Fn(&Y) -> Named),
) -> NamedModel {
    StateSpace {
        states: of.states.iter().map(state).collect(),
        inputs: of.inputs.iter().map(input).collect(),
        outputs: of.outputs.iter().map(output).collect(),
        a: of.a.clone(),
        b: of.b.clone(),
        c: of.c.clone(),
        d: of.d.clone(),
    }
}

/// A model of one actuator or of a joint with its own names.
pub(super) fn named(of: &StateSpace) -> NamedModel {
    let of_signal = |signal: &Signal| Named::from(signal);
    renamed(of, (of_signal, of_signal, of_signal))
}
