//! Symptom: a run stopped with "no step is short enough", a hundred events in one instant after a tension had come to zero.
//!
//! Cause: a guard that is not linear in the state was searched as the polynomial through eight of its values over the step.
//! Where the guard has a feature much shorter than the step (friction that falls within a few mm/s of rest, or that begins
//! at zero gauge pressure), that polynomial swings below zero next to where the guard starts, a hair above it.

use crate::common::Paper;
use mckibben::friction::Coulomb;
use mckibben::load::Load;
use mckibben::simulation::{InitialLength, simulate};
use mckibben::valve::{Command, ExhaustTemperature, FlowStandard, Request, ValveKind};
#[test]
fn friction_that_falls_near_rest_does_not_make_a_guard_fire_at_once() {
    let paper = Paper::sealed().with(|rig| {
        rig.thread_length = 0.26725170562320477;
        rig.turns = 0.8179043648639063;
        rig.max_length = 0.18763303121056976;
        rig.limit_stiffness = 636023.174539897;
        rig.limit_damping = 142.96370749101638;
        rig.viscous = 0.0;
        rig.coulomb_width = 0.0;
        rig.coulomb = Some(
            Coulomb::new(2.804720909873887e-6)
                .unwrap()
                .with_force(1.047401266411057, 1.1355496599456109e-6)
                .unwrap()
                .with_stribeck(1.7610060293382719, 0.0024107998036498064)
                .unwrap(),
        );
        rig.external_volume = 0.0001677579915914351;
        rig.load = Load::HangingMass { mass: 0.18177722158170193, gravity: 9.80665 };
        rig.supply_gauge = 325255.19702821923;
        rig.supply_temperature = 285.4593657170076;
        rig.standard =
            FlowStandard::Iso6358 { sonic_conductance: 6.429867700381743e-9, critical_ratio: 0.20630453815017102 };
        rig.exhaust_temperature = ExhaustTemperature::Ambient;
        rig.kind = ValveKind::FillHoldExhaust;
        rig.delays = (0.002724245940215955, 0.004881397240859163);
        rig.command =
            Some(Command::pwm(67.55640364003744, 0.017473962656951603, Request::Hold, Request::Exhaust).unwrap());
        rig.gauge = 113993.72259618632;
        rig.length = InitialLength::Equilibrium;
        rig.velocity = -0.25040771745567053;
    });
    let run = simulate(&paper.rig(), paper.start(), 0.17, 2.291648791647306e-6).expect("the run reaches its end");
    // The tendon goes slack once more before the end, and no event follows another in the same instant.
    let times: Vec<f64> = run.events().iter().map(|event| event.time).collect();
    assert!(times.len() < 30 && times.windows(2).all(|pair| pair[1] > pair[0]), "{times:?}");
}
