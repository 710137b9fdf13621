//! What is known of a joint at an instant, whichever engine computed it.

use super::JointState;
use crate::scalar::Real;
use crate::simulation::sample::Sample;

/// Everything that is known at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointSample<R = f64> {
    /// Time in s.
    pub time: R,
    /// Angle in rad.
    pub angle: R,
    /// Angular velocity in rad/s.
    pub angular_velocity: R,
    /// Torque of both actuators in N·m, `r₁ F₁ − r₂ F₂`.
    pub torque: R,
    /// Agonist and antagonist.
    pub actuators: [Sample<R>; 2],
}

impl<R: Real> JointSample<R> {
    /// The six states.
    pub fn state(&self) -> JointState<R> {
        let Self { angle, angular_velocity, actuators, .. } = *self;
        let (pressure, air_mass) = (actuators.map(|of| of.pressure), actuators.map(|of| of.air_mass));
        JointState { angle, angular_velocity, pressure, air_mass }
    }
}
