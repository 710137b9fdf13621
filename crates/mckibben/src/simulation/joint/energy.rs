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

use super::JointRig;
use super::circuit::{JointCircuitAudit, add_air};
use super::mode::Contact;
use super::run::{AcceptedJointStep, JointRunEnd};
use super::trajectory::{JointSample, JointTrajectory};
use crate::load::SIGN;
use crate::scalar::Real;
use crate::simulation::circuit::{CircuitAudit, Exergy};
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
    /// The most that rounding may leave of a term of the limb, in J: ε times its energy, over the points of the quadrature.
    pub limb_rounding: f64,
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

    /// The most that rounding may leave of a term, in J.
    pub fn rounding(&self) -> f64 {
        self.actuators.iter().map(|of| of.rounding).sum::<f64>() + self.limb_rounding
    }

    /// What does not close in the air of both, in kg.
    pub fn air_residual(&self) -> f64 {
        self.actuators.iter().map(EnergyAudit::air_residual).sum()
    }
}

impl JointAudit {
    /// Adds an accepted step.
    fn step<R: Real>(&mut self, step: &AcceptedJointStep<'_, R>) {
        let (rig, joint) = (step.rig(), step.rig().joint());
        step.visit(|weight, sample, phase, of_actuators| {
            let (weight, mode) = (weight.value(), &phase.mode);
            for i in 0..2 {
                let actuator = &rig.driven()[i].actuator;
                let of = &mut self.actuators[i];
                let (sample, mode) = (&sample.actuators[i], &phase.mode.actuators[i]);
                let (flow, widths) = &of_actuators[i];
                of.load += of.add(actuator, weight, sample, mode, (flow, *widths));
            }
            let speed = sample.angular_velocity;
            self.limb_rounding += f64::EPSILON * joint.energy(sample.angle, speed).value().abs();
            self.damping += weight * (joint.damping() * speed * speed).value();
            let (Contact::Pressed(end) | Contact::Rebound(end)) = mode.contact else { return };
            let outwards = R::constant(SIGN[end.index()]);
            let Some(stop) = joint.stops().ends[end.index()] else { return };
            let pressed = match mode.contact {
                Contact::Pressed(_) => joint.stop_torque(end.index(), sample.angle, speed),
                _ => R::zero(),
            };
            let stored = joint.stops().stiffness * (outwards * (sample.angle - stop)).larger(R::zero());
            self.stops += weight * ((pressed - stored) * outwards * speed).value();
        });
    }

    /// Adds what was gained between the start and the end.
    fn finish<R: Real>(&mut self, start: &JointSample<R>, end: &JointRunEnd<R>) {
        let (rig, end) = (&end.rig, &end.sample);
        for i in 0..2 {
            let actuator = &rig.driven()[i].actuator;
            self.actuators[i].add_gains(actuator, &start.actuators[i], &end.actuators[i]);
        }
        let energy = |angle, velocity| rig.joint().energy(angle, velocity).value();
        self.gain = energy(end.angle, end.angular_velocity) - energy(start.angle, start.angular_velocity);
    }
}

/// The accounts of a joint's run that are added up as it is made: of its energy, and of the exergy of both supplies' air.
#[derive(Clone, Debug)]
pub struct JointLedger<R: Real = f64> {
    work: JointAudit,
    circuits: [Option<(Exergy, CircuitAudit)>; 2],
    start: Option<JointSample<R>>,
}

impl<R: Real> JointLedger<R> {
    /// Nothing yet of a run of `rig`. There is no account of the exergy where neither actuator has a valve.
    pub fn new(rig: &JointRig<R>) -> Self {
        let circuits = rig.driven().each_ref().map(|driven| {
            let valve = driven.actuator.valve()?;
            Some((Exergy::new(&driven.actuator, valve), CircuitAudit::default()))
        });
        Self { work: JointAudit::default(), circuits, start: None }
    }

    /// Adds an accepted step.
    pub fn step(&mut self, step: &AcceptedJointStep<'_, R>) {
        if self.start.is_none() && step.holds_start() {
            self.start = Some(step.at(R::zero()));
        }
        self.work.step(step);
        add_air(&mut self.circuits, step);
    }

    /// The balance of energy and air of a run that has come to its end, and the account of the exergy if there is one.
    pub fn finish(self, end: &JointRunEnd<R>) -> (JointAudit, Option<JointCircuitAudit>) {
        let Self { mut work, circuits, start } = self;
        let start = start.unwrap_or(end.sample);
        work.finish(&start, end);
        if circuits.iter().all(Option::is_none) {
            return (work, None);
        }
        let [first, second] = circuits;
        let finished = |i: usize, circuit: Option<(Exergy, CircuitAudit)>| {
            let (exergy, audit) = circuit?;
            let stored = exergy.contents(&end.sample.actuators[i]) - exergy.contents(&start.actuators[i]);
            Some(CircuitAudit { stored, work: work.actuators[i], ..audit })
        };
        let actuators = [finished(0, first), finished(1, second)];
        (work, Some(JointCircuitAudit { actuators, work }))
    }
}

impl<R: Real> JointTrajectory<R> {
    /// The energy and air balance of the whole trajectory.
    pub fn audit(&self) -> JointAudit {
        self.accounts().0
    }

    /// The exergy of the whole circuit; none where neither actuator has a valve.
    pub fn circuit(&self) -> Option<JointCircuitAudit> {
        self.accounts().1
    }

    /// The balance of energy and air, and the account of the exergy if there is one, as [`JointLedger`] adds them up.
    pub fn accounts(&self) -> (JointAudit, Option<JointCircuitAudit>) {
        let mut ledger = JointLedger::new(self.rig());
        self.each_step(|step| ledger.step(step));
        ledger.finish(&self.end())
    }
}
