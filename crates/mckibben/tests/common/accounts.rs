//! The ledger of a run of one actuator in the terms of the paper's rig.

use mckibben::network::BranchKind;
use mckibben::plant::{Balance, LedgerTotal, RigTrajectory};

/// Where the work of the gas went in J, and the air in kg.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Audit {
    pub(crate) gas_work: f64,
    pub(crate) effectiveness_loss: f64,
    pub(crate) bladder_storage: f64,
    pub(crate) load: f64,
    pub(crate) slip: f64,
    pub(crate) hysteresis_storage: f64,
    dissipated: f64,
    work: Balance,
    pub(crate) air_in: f64,
    pub(crate) air_out: f64,
    pub(crate) air_gain: f64,
}

impl Audit {
    pub(crate) fn residual(&self) -> f64 {
        self.work.residual
    }

    pub(crate) fn turnover(&self) -> f64 {
        self.work.turnover
    }

    pub(crate) fn dissipated(&self) -> f64 {
        self.dissipated
    }

    pub(crate) fn air_residual(&self) -> f64 {
        self.air_in - self.air_out - self.air_gain
    }
}

/// Where the exergy of the supply's air went in J.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Circuit {
    pub(crate) total: LedgerTotal,
    pub(crate) exergy: Balance,
}

pub(crate) trait Audited {
    fn audit(&self) -> Audit;
    fn circuit(&self) -> Circuit;
}

impl Audited for RigTrajectory {
    fn audit(&self) -> Audit {
        let ledger = self.ledger();
        let (of, mechanism) = (&ledger.actuators[0], &ledger.mechanisms[0]);
        let network = self.view().plant().network();
        let is_outside = |kind: &BranchKind| matches!(kind, BranchKind::Path { .. } | BranchKind::Leak(_));
        let (mut air_in, mut air_out) = (0.0, 0.0);
        self.plant()
            .replay(&mut |step| {
                step.quadrature(|weight, sample| {
                    for (branch, flow) in network.branches.iter().zip(&sample.branches) {
                        if is_outside(&branch.kind) {
                            air_in += weight * flow.mass_flow.max(0.0);
                            air_out += weight * (-flow.mass_flow).max(0.0);
                        }
                    }
                });
                Ok(())
            })
            .expect("a run that is kept");
        let hose = self.view().plant().network().nodes.iter().zip(&ledger.nodes);
        let hose: f64 = hose
            .filter(|(node, _)| matches!(node.kind, mckibben::network::NodeKind::Hose(_)))
            .map(|(_, of)| of.air_gain)
            .sum();
        Audit {
            gas_work: of.gas_work,
            effectiveness_loss: of.effectiveness_loss,
            bladder_storage: of.bladder_storage,
            load: mechanism.kinetic + mechanism.potential + mechanism.driven,
            slip: of.slip,
            hysteresis_storage: of.hysteresis_storage,
            dissipated: of.dissipated(),
            work: ledger.work(),
            air_in,
            air_out,
            air_gain: of.air_gain + hose,
        }
    }

    fn circuit(&self) -> Circuit {
        let ledger = self.ledger();
        Circuit { total: ledger.total(), exergy: ledger.exergy() }
    }
}
