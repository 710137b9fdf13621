//! A manifold: one supply that feeds several actuators, alike or not, each in a loop of one's own.
//!
//! ```text
//! feed      each valve gets the manifold's pressure P_n
//!           … each actuator goes on by one step h and draws Δm_i at that pressure …
//! advance   the supply goes on by that step with Σ Δm_i drawn
//!
//! reservoir   P⁺ = P + κRT/V (h ṁ_compressor(P) − Σ Δm_i)
//! regulator   P⁺ = P + (1 − e^(−h/τ)) Z(min(P_set − D Σ Δm_i/h, P_reservoir⁺) − P)
//! ```
//!
//! The symbols are those of [`Reservoir`](crate::line::Reservoir) and [`Regulator`](crate::line::Regulator), of which a
//! [`SupplyLine`] has either, both or neither. A manifold without either keeps the supply's pressure.
//!
//! What an actuator draws is what it gains ([`ModularActuator::drawn`]), so the air of reservoir and actuators, with what the
//! compressor brought and what was exhausted, stays the same to rounding. The pressures are of order 1 in the step: valves
//! see the pressure of its beginning, whoever draws in it. The compressor starts and stops at the end of the step in which
//! the pressure crosses its bound, so the band is kept to within one step. A step in which a valve could fill an actuator from
//! a reservoir no larger than that actuator swings to and fro, and is refused once the pressure would fall below nothing.
//!
//! ```
//! use mckibben::simulation::{Manifold, ModularActuator};
//!
//! # fn fills(mut manifold: Manifold, mut actuators: [ModularActuator; 2], length: f64) -> Result<(), mckibben::Error> {
//! manifold.feed(&mut actuators)?;
//! for count in 1..=1000 {
//!     let until = f64::from(count) * 1e-3;
//!     for actuator in &mut actuators {
//!         actuator.move_to(until, length)?;
//!     }
//!     manifold.serve(until, &mut actuators)?;
//! }
//! # Ok(())
//! # }
//! ```
//!
//! Source: the splitting is the first-order one (Lie), textbook numerical analysis. Checked by `tests/manifold.rs`: no air is
//! lost, the order against the event-located engine, one pressure for all air in the end.

use super::modular::ModularActuator;
use crate::error::{Error, Requirement};
use crate::line::{Regulator, Reservoir, SupplyLine};
use crate::parameter;
use crate::pressure::AbsolutePressure;
use crate::scalar::Real;
use crate::valve::{Supply, is_due};

/// One supply for several actuators.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Manifold<R: Real<Time = R> = f64> {
    line: SupplyLine<R>,
    set: R,
    state: ManifoldState<R>,
}

/// Where a manifold is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ManifoldState<R = f64> {
    /// The time in s that has been reached.
    pub time: R,
    /// Absolute pressure in the reservoir, if there is one.
    pub reservoir: Option<AbsolutePressure<R>>,
    /// Absolute pressure that comes to the valves.
    pub outlet: AbsolutePressure<R>,
    /// Whether the compressor runs.
    pub compressor_runs: bool,
    /// Air in kg that the compressor brought in the last step.
    pub delivered: R,
}

impl<R: Real<Time = R>> Manifold<R> {
    /// A manifold at t = 0 with the reservoir and the regulator of `line`, the regulator set to the pressure of `supply`.
    /// A compressor runs unless the reservoir is at its upper pressure.
    ///
    /// # Errors
    /// [`Error::Inconsistent`] for a line that counts several actuators: on a manifold each draws for itself.
    pub fn new(line: &SupplyLine<R>, supply: &Supply<R>) -> Result<Self, Error> {
        let actuators = line.actuators().value();
        if actuators != 1.0 {
            return Err(Error::Inconsistent {
                parameter: &parameter::ACTUATORS,
                value: actuators,
                requirement: Requirement { relation: "must be, on a manifold,", other: "one", value: 1.0, unit: "" },
                remedy: "leave supply.actuators at one: each actuator on a manifold draws for itself",
            });
        }
        let set = supply.pressure().0;
        let reservoir = line.reservoir().map(Reservoir::start);
        let outlet = match (reservoir, line.regulator()) {
            (None, _) => set,
            (Some(AbsolutePressure(pressure)), None) => pressure,
            (Some(AbsolutePressure(pressure)), Some(_)) => set.smaller(pressure),
        };
        let mut state = ManifoldState {
            time: R::zero(),
            reservoir,
            outlet: AbsolutePressure(outlet),
            compressor_runs: true,
            delivered: R::zero(),
        };
        state.compressor_runs = line.reservoir().is_some_and(|reservoir| runs(reservoir, &state));
        Ok(Self { line: *line, set, state })
    }

    /// The time in s that has been reached.
    pub fn time(&self) -> R {
        self.state.time
    }

    /// Absolute pressure that comes to the valves.
    pub fn pressure(&self) -> AbsolutePressure<R> {
        self.state.outlet
    }

    /// Everything that changes.
    pub fn state(&self) -> &ManifoldState<R> {
        &self.state
    }

    /// The reservoir and the regulator.
    pub fn line(&self) -> &SupplyLine<R> {
        &self.line
    }

    /// Air in kg in the reservoir, `V P/(κRT)`; none without one.
    pub fn content(&self) -> Option<R> {
        let (reservoir, pressure) = self.line.reservoir().zip(self.state.reservoir)?;
        Some(reservoir.content(pressure.0))
    }

    /// Sets the pressure at the valves of actuators that are at the time of the manifold.
    ///
    /// # Errors
    /// [`Error::Misuse`] for an actuator at another time; else as [`ModularActuator::feed`]. Actuators before the one
    /// that is refused have been fed.
    pub fn feed(&self, actuators: &mut [ModularActuator<R>]) -> Result<(), Error> {
        check_in_step(self.state.time, actuators)?;
        actuators.iter_mut().try_for_each(|actuator| actuator.feed(self.state.outlet))
    }

    /// Goes on to `until` s, where the actuators have come in one step, with what they drew in it, and feeds them from there
    /// on.
    ///
    /// # Errors
    /// [`Error::Misuse`] for an actuator at another time; else as [`Manifold::advance`] and [`ModularActuator::feed`].
    pub fn serve(&mut self, until: R, actuators: &mut [ModularActuator<R>]) -> Result<(), Error> {
        check_in_step(until, actuators)?;
        let drawn = actuators.iter().fold(R::zero(), |sum, actuator| sum + actuator.drawn());
        self.advance(until, drawn)?;
        self.feed(actuators)
    }

    /// Goes on to `until` s, later than the time that has been reached, with `drawn` kg taken since by all actuators
    /// together; below zero where more flowed back.
    ///
    /// # Errors
    /// [`Error::Misuse`] for a time that is not later; [`Error::Stopped`] where a pressure would fall to nothing. The
    /// manifold is then where it was last.
    pub fn advance(&mut self, until: R, drawn: R) -> Result<(), Error> {
        if !self.state.time.lt(until) {
            return Err(Error::Misuse {
                what: "a manifold cannot be moved back in time or in no time",
                remedy: "give a time later than the last",
            });
        }
        let step = until - self.state.time;
        let mut next = ManifoldState { time: until, delivered: R::zero(), ..self.state };
        if let Some((reservoir, pressure)) = self.line.reservoir().zip(self.state.reservoir) {
            if self.state.compressor_runs {
                next.delivered = step * reservoir.delivery(pressure.0);
            }
            let raised = pressure.0 + reservoir.pressure_rate(next.delivered - drawn);
            (next.reservoir, next.outlet) = (Some(AbsolutePressure(raised)), AbsolutePressure(raised));
            next.compressor_runs = runs(reservoir, &next);
        }
        if let Some(regulator) = self.line.regulator() {
            let inlet = next.reservoir.map(|pressure| pressure.0);
            next.outlet = AbsolutePressure(self.regulated(regulator, inlet, step, drawn));
        }
        let least = next.reservoir.map_or(next.outlet.0, |pressure| pressure.0.smaller(next.outlet.0)).value();
        check(until.value(), drawn.value(), "air drawn", "kg", drawn.value().is_finite())?;
        check(until.value(), least, "absolute pressure", "Pa", least.is_finite() && least > 0.0)?;
        self.state = next;
        Ok(())
    }

    /// The regulator's outlet after a step in which the flow is even: the exponential, which stays short of the dead band.
    fn regulated(&self, regulator: &Regulator<R>, inlet: Option<R>, step: R, drawn: R) -> R {
        let outlet = self.state.outlet.0;
        let error = regulator.error(outlet, self.set, inlet, drawn / step);
        let rate = regulator.pressure_rate(error, regulator.poppet(error));
        outlet - rate * regulator.lag() * (-step / regulator.lag()).exp_m1()
    }
}

/// Whether the compressor of a reservoir runs on.
fn runs<R: Real>(reservoir: &Reservoir<R>, state: &ManifoldState<R>) -> bool {
    let Some(([starts, stops], pressure)) = reservoir.switch_pressures().zip(state.reservoir) else { return false };
    if state.compressor_runs { pressure.0.lt(stops) } else { pressure.0.le(starts) }
}

/// That actuators are at a time in s.
fn check_in_step<R: Real<Time = R>>(time: R, actuators: &[ModularActuator<R>]) -> Result<(), Error> {
    let there = |actuator: &ModularActuator<R>| is_due(actuator.time(), time) && is_due(time, actuator.time());
    if actuators.iter().all(there) {
        return Ok(());
    }
    Err(Error::Misuse {
        what: "an actuator on a manifold is at another time than the manifold",
        remedy: "move every actuator to the same time, in one step, before the manifold serves them",
    })
}

/// That a number lets a step to `time` s be taken.
fn check(time: f64, value: f64, quantity: &'static str, unit: &'static str, holds: bool) -> Result<(), Error> {
    if holds {
        return Ok(());
    }
    Err(Error::Stopped {
        time,
        reason: "a step of the manifold left the physics",
        quantity,
        value,
        unit,
        remedy: "shorten the step, or enlarge the reservoir",
    })
}
