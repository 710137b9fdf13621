//! The energy audit of a joint: where the work of both gases went.
//!
//! ```text
//! −∫ F dL of both actuators = Δ(½ J ω² − M g d cos(θ − θ₀) − W θ)      the limb
//!                           + Δ(½ K_stop δ²)                           pressed stops
//!                           + ∫ c ω² dt                                the joint's damping
//!                           + ∫ (S u − K_stop δ u) dt                  the stops' damping and rebound
//! ```
//!
//! and each actuator's gas work goes into that and its own losses as in [`EnergyAudit`].

use super::mode::Contact;
use super::trajectory::JointTrajectory;
use crate::load::SIGN;
use crate::scalar::Real;
use crate::simulation::energy::EnergyAudit;

/// Where the work of both gases went, in J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JointAudit {
    /// Agonist and antagonist; the load of each is its work on its ends, `−∫ F dL`.
    pub actuators: [EnergyAudit; 2],
    /// Energy that the limb and pressed stops gained, kinetic and potential.
    pub gain: f64,
    /// Dissipated by the joint's viscous damping.
    pub damping: f64,
    /// Dissipated by the stops, their rebound included.
    pub stops: f64,
}

impl JointAudit {
    /// What does not close in J: at the ends of the actuators, and within them.
    pub fn residual(&self) -> f64 {
        let [first, second] = &self.actuators;
        first.residual() + second.residual() + first.load + second.load - self.gain - self.damping - self.stops
    }

    /// Everything dissipated in J.
    pub fn dissipated(&self) -> f64 {
        self.actuators.iter().map(EnergyAudit::dissipated).sum::<f64>() + self.damping + self.stops
    }

    /// Sum of the magnitudes of all terms in J, to which the residual is to be compared.
    pub fn turnover(&self) -> f64 {
        let actuators: f64 = self.actuators.iter().map(EnergyAudit::turnover).sum();
        actuators + self.gain.abs() + self.damping.abs() + self.stops.abs()
    }

    /// What does not close in the air of both, in kg.
    pub fn air_residual(&self) -> f64 {
        self.actuators.iter().map(EnergyAudit::air_residual).sum()
    }
}

impl<R: Real> JointTrajectory<R> {
    /// The energy and air balance of the whole trajectory.
    pub fn audit(&self) -> JointAudit {
        let joint = self.rig().joint();
        let mut audit = JointAudit::default();
        self.visit(|weight, sample, phase, of_actuators| {
            let (weight, mode) = (weight.value(), &phase.mode);
            for i in 0..2 {
                let actuator = &self.rig().driven()[i].actuator;
                let of = &mut audit.actuators[i];
                let (sample, mode) = (&sample.actuators[i], &phase.mode.actuators[i]);
                let (flow, widths) = &of_actuators[i];
                of.load += of.add(actuator, weight, sample, mode, (flow, *widths));
            }
            let speed = sample.angular_velocity;
            audit.damping += weight * (joint.damping() * speed * speed).value();
            let (Contact::Pressed(end) | Contact::Rebound(end)) = mode.contact else { return };
            let outwards = R::constant(SIGN[end.index()]);
            let Some(stop) = joint.stops().ends[end.index()] else { return };
            let pressed = match mode.contact {
                Contact::Pressed(_) => joint.stop_torque(end.index(), sample.angle, speed),
                _ => R::zero(),
            };
            let stored = joint.stops().stiffness * (outwards * (sample.angle - stop)).larger(R::zero());
            audit.stops += weight * ((pressed - stored) * outwards * speed).value();
        });
        let (start, end) = (self.at(R::zero()), self.at(self.duration()));
        for i in 0..2 {
            let actuator = &self.rig().driven()[i].actuator;
            audit.actuators[i].add_gains(actuator, &start.actuators[i], &end.actuators[i]);
        }
        let energy = |angle, velocity| joint.energy(angle, velocity).value();
        audit.gain = energy(end.angle, end.angular_velocity) - energy(start.angle, start.angular_velocity);
        audit
    }
}
