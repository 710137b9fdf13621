//! Numbers that follow from others where a file leaves them out.
//!
//! ```text
//! L_min = b/√3            P_g,r(0) = P_g,s            P_g(0) = (r₁ − o)/s
//! ```
//!
//! | number | follows from |
//! |---|---|
//! | least length `L_min` | the thread length `b`: it is that of the neutral angle |
//! | gauge pressure `P_g,r(0)` that a reservoir starts at | the gauge pressure `P_g,s` of its supply |
//! | gauge pressure `P_g(0)` that a muscle starts at, where a pressure over time is given | the first row `r₁` of that, by the offset `o` and the scale `s` of its sensor |
//!
//! The formulas hold over any scalar, so that what follows is differentiated by what it follows from. Every other number that may
//! be left out has a constant for its default, or is computed by the core in the scalar of the run: an angle or a length at
//! balance, the coefficients of Tondu and Lopez. What a file says of both actuators of a joint is one number of both.
//!
//! Checked by `tests/follow.rs` of the identify crate: against differences of runs, with and without the number that follows.

use crate::scenario::{Load, Scenario};
use mckibben::Real;
use mckibben::parameter::{self as p, Parameter};

/// A number that follows from others of its actuator where it is left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Follower {
    /// Of the braid. A scenario does not show whether it was left out.
    LeastLength,
    /// Of a reservoir.
    ReservoirStart,
    /// Of a muscle whose pressure over time is given.
    FirstPressure,
}

/// The least length of a braid by its thread length, both in m: that of the neutral angle.
pub(crate) fn least_length<S: Real>(thread_length: S) -> S {
    thread_length / S::constant(3_f64.sqrt())
}

/// The gauge pressure in Pa of a row of a pressure over time, as its sensor shows it.
pub(crate) fn true_pressure<S: Real>(shown: S, [offset, scale]: [S; 2]) -> S {
    (shown - offset) / scale
}

impl Follower {
    /// All that there are.
    pub(crate) const ALL: [Self; 3] = [Self::LeastLength, Self::ReservoirStart, Self::FirstPressure];

    /// What it is a number of.
    pub(crate) fn parameter(self) -> &'static Parameter {
        match self {
            Self::LeastLength => &p::MIN_LENGTH,
            Self::ReservoirStart => &p::RESERVOIR_PRESSURE,
            Self::FirstPressure => &p::INITIAL_GAUGE_PRESSURE,
        }
    }

    /// Its value in a scenario by those that it follows from, of the first actuator of a joint; `None` where the scenario has one of
    /// its own. `number` gives each over the scalar, by its parameter, its index in a list, and its value.
    pub(crate) fn value<S: Real>(
        self,
        of: &Scenario,
        mut number: impl FnMut(&'static Parameter, usize, f64) -> S,
    ) -> Option<S> {
        match self {
            Self::LeastLength => Some(least_length(number(&p::THREAD_LENGTH, 0, of.actuator.thread_length))),
            Self::ReservoirStart => {
                let supply = of.supply.filter(|of| of.reservoir.is_some_and(|of| of.gauge_pressure.is_none()))?;
                Some(number(&p::SUPPLY_GAUGE_PRESSURE, 0, supply.gauge_pressure))
            }
            Self::FirstPressure => {
                let given = of.pressure.as_ref().filter(|_| of.initial.gauge_pressure.is_none())?;
                given.start_over(number)
            }
        }
    }
}

impl Scenario {
    /// Has the least lengths of these actuators, the second that of a joint's, follow from their thread lengths.
    pub fn let_least_lengths_follow(&mut self, [first, second]: [bool; 2]) {
        let of_second = match &mut self.load {
            Load::AntagonisticJoint(joint) => Some(&mut joint.antagonist.actuator),
            _ => None,
        };
        for actuator in [Some(&mut self.actuator).filter(|_| first), of_second.filter(|_| second)].into_iter().flatten()
        {
            actuator.min_length = least_length(actuator.thread_length);
        }
    }
}
