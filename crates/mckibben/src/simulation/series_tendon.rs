//! A modular actuator that pulls by an elastic tendon in series.
//!
//! ```text
//! x = L + ℓ + F/k                                  x: distance of what they pull together
//! F(L⁺, (L⁺ − L)/h, P⁺(L⁺)) = k (x⁺ − ℓ − L⁺)      for L⁺, at the end of each step of h
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | k | stiffness of the tendon | N/m |
//! | ℓ | its length at rest | m |
//! | L | length of the actuator | m |
//!
//! Actuator and tendon share one tension; what the tendon gives is what the actuator does not lengthen. Without a mass
//! between them the actuator's length has no speed of its own: each step solves for where both tensions are equal, with the
//! air, the seats and the memory of the hysteresis taken to there. It is the implicit Euler method, of order 1 in the step
//! and stable at any, however stiff the tendon. Dry friction holds as it should: while the tendon's change is less than it,
//! the actuator stays. A tendon that is let go hangs loose and pulls nothing.
//!
//! The balance is found by search, so the numbers are `f64` and carry no derivatives. A rig with such a tendon and a load of
//! its own is stepped by [`tendon_step`](super::tendon_step).
//!
//! Checked by `tests/series_tendon.rs`: two springs in series, a rigid tendon, sticking, a relaxation in closed form.

use super::modular::ModularActuator;
use super::rig::{Rig, State};
use crate::control::Drive;
use crate::error::Error;
use crate::load::SeriesTendon;
use crate::root;

/// Part of the longest length of the actuator to which the balance is found.
const RESOLVED: f64 = 1e-13;
/// Doublings of a step away from the last length within which the balance must lie.
const MOST_DOUBLINGS: u32 = 60;

/// A modular actuator with a tendon in series.
#[derive(Clone, Debug)]
pub struct TendonActuator {
    actuator: ModularActuator,
    tendon: SeriesTendon,
    distance: f64,
}

impl TendonActuator {
    /// The actuator of a rig at t = 0 in a state, and a tendon that its tension at rest has stretched; pulses come at
    /// `pulse_frequency` in Hz.
    ///
    /// # Errors
    /// As [`ModularActuator::new`].
    pub fn new(rig: &Rig, start: State, pulse_frequency: f64, tendon: SeriesTendon) -> Result<Self, Error> {
        let actuator = ModularActuator::new(rig, start, pulse_frequency)?;
        let stretch = actuator.respond(0.0).tension / tendon.stiffness();
        let distance = actuator.state().length + tendon.rest_length() + stretch;
        Ok(Self { actuator, tendon, distance })
    }

    /// The actuator; its own length and air.
    pub fn actuator(&self) -> &ModularActuator {
        &self.actuator
    }

    /// The tendon.
    pub fn tendon(&self) -> &SeriesTendon {
        &self.tendon
    }

    /// Distance in m of what actuator and tendon pull together.
    pub fn distance(&self) -> f64 {
        self.distance
    }

    /// Tension in N of both.
    pub fn tension(&self) -> f64 {
        self.tendon.tension(self.distance - self.actuator.state().length)
    }

    /// What is asked of the valve from now on.
    ///
    /// # Errors
    /// As [`ModularActuator::drive`].
    pub fn drive(&mut self, drive: Drive) -> Result<(), Error> {
        self.actuator.drive(drive)
    }

    /// What they pull together goes to a `distance` in m at `until` s, later than the time that has been reached.
    ///
    /// # Errors
    /// As [`ModularActuator::move_to`]; nothing has changed then.
    pub fn move_to(&mut self, until: f64, distance: f64) -> Result<(), Error> {
        let length = self.balance(until, distance)?;
        self.actuator.move_to(until, length)?;
        self.distance = distance;
        Ok(())
    }

    /// The length in m of the actuator at which both tensions are equal at `until`.
    fn balance(&mut self, until: f64, distance: f64) -> Result<f64, Error> {
        let start = self.actuator.state().length;
        let at_start = self.excess(until, distance, start)?;
        if at_start == 0.0 {
            return Ok(start);
        }
        let away = if at_start > 0.0 { -1.0 } else { 1.0 };
        let (mut near, mut far) = (start, start);
        let mut reach = (at_start.abs() / self.tendon.stiffness()).max(RESOLVED * start);
        for _ in 0..MOST_DOUBLINGS {
            far = start + away * reach;
            match self.excess(until, distance, far) {
                // Where the braid would be pulled straight no tendon could hold it.
                Err(_) if away > 0.0 => break,
                Err(error) => return Err(error),
                Ok(excess) if (excess > 0.0) == (at_start > 0.0) && excess != 0.0 => near = far,
                Ok(_) => break,
            }
            reach *= 2.0;
        }
        let (low, high) = if near < far { (near, far) } else { (far, near) };
        let beyond = self.tendon.stiffness() * (high - low);
        let excess = |length: f64| self.excess(until, distance, length).unwrap_or(beyond);
        Ok(root::bracketed(low, high, RESOLVED * start, excess))
    }

    /// Tension of the actuator less that of the tendon in N, if the actuator ends at a length in m; it rises with the length.
    fn excess(&mut self, until: f64, distance: f64, length: f64) -> Result<f64, Error> {
        let (before, state) = (self.actuator.going(), self.actuator.state());
        let velocity = (length - state.length) / (until - self.actuator.time());
        self.actuator.move_to(until, length)?;
        let tension = self.actuator.respond(velocity).tension;
        self.actuator.back_to(before);
        Ok(tension - self.tendon.tension(distance - length))
    }
}
