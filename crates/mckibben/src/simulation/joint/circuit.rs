//! The energy audit of a joint's whole circuit: what the air from both supplies could have done, and where that went.
//!
//! Each actuator with a valve has the account of [`CircuitAudit`]; the work of the two on their ends,
//!
//! ```text
//! −∫ F dL of both = gain of limb and pressed stops + damping of the joint + losses in the stops
//! ```
//!
//! closes it. The work on the joint is the sum of the two: what the one does on the other, which it lengthens, is taken off.
//!
//! Checked by `tests/joint_circuit.rs`.

use super::Driven;
use super::energy::JointAudit;
use super::run::AcceptedJointStep;
use crate::scalar::Real;
use crate::simulation::circuit::{CircuitAudit, Exergy};
use crate::simulation::energy::EnergyAudit;
use crate::simulation::zones::Through;

/// Where the exergy of the air from both supplies went, in J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JointCircuitAudit {
    /// Agonist and antagonist; none for one without a valve, which draws nothing.
    pub actuators: [Option<CircuitAudit>; 2],
    /// Where the work of both gases went.
    pub work: JointAudit,
}

impl JointCircuitAudit {
    /// The accounts of those that draw.
    fn drawing(&self) -> impl Iterator<Item = &CircuitAudit> {
        self.actuators.iter().flatten()
    }

    /// Those that draw together, term by term; as load it has the work on the joint.
    pub fn total(&self) -> CircuitAudit {
        let work = self.drawing().fold(EnergyAudit::default(), |sum, of| sum.and(&of.work));
        let work = EnergyAudit { load: self.load(), ..work };
        self.drawing().fold(CircuitAudit { work, ..CircuitAudit::default() }, |sum, of| sum.and(of))
    }

    /// Work on the joint in J: that of both actuators on their ends.
    pub fn load(&self) -> f64 {
        self.work.actuators.iter().map(|of| of.load).sum()
    }

    /// What does not close in J, the audit of the work included.
    pub fn residual(&self) -> f64 {
        let air: f64 = self.drawing().map(|of| of.residual() - of.work.residual()).sum();
        air + self.work.residual()
    }

    /// Sum of the magnitudes of all terms in J, to which the residual is to be compared.
    pub fn turnover(&self) -> f64 {
        let air: f64 = self.drawing().map(|of| of.turnover() - of.work.turnover()).sum();
        air + self.work.turnover()
    }

    /// The most that rounding may leave of a term, in J.
    pub fn rounding(&self) -> f64 {
        self.drawing().map(|of| of.rounding).sum::<f64>() + self.work.rounding()
    }

    /// Net work on the joint over the exergy drawn; none where nothing was drawn. Of a cycle it is the efficiency; of a run
    /// that ends in another state than it began, what is stored belongs to the balance too.
    pub fn efficiency(&self) -> Option<f64> {
        self.total().efficiency()
    }

    /// Net work on the joint over the least work of a compressor; none where nothing was drawn.
    pub fn compressor_efficiency(&self) -> Option<f64> {
        self.total().compressor_efficiency()
    }
}

/// Adds the air of an accepted step to the accounts of those that draw.
pub(super) fn add_air<R: Real>(accounts: &mut [Option<(Exergy, CircuitAudit)>; 2], step: &AcceptedJointStep<'_, R>) {
    let driven = step.rig().driven();
    let regulates = |driven: &Driven<R>| driven.actuation.as_ref().is_some_and(|it| it.solenoid.regulator().is_some());
    let regulated = driven.each_ref().map(regulates);
    step.visit(|weight, sample, phase, of_actuators| {
        for (i, account) in accounts.iter_mut().enumerate() {
            let actuator = &driven[i].actuator;
            if let (Some((exergy, audit)), Some(valve)) = (account, actuator.valve()) {
                let shares = phase.openings[i].at(sample.time);
                let through = Through { mode: &phase.mode.actuators[i], shares, feed: None };
                let flows = (through, regulated[i].then_some(&of_actuators[i].0));
                audit.add(exergy, (actuator, valve), weight.value(), &sample.actuators[i], flows);
            }
        }
    });
}
