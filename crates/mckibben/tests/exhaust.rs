//! A separate flow path to the atmosphere, in both engines.

use crate::common::steps::RigSteps;
use crate::common::{ATMOSPHERE, INCH, Paper, ROOM, assert_close, assert_within};
use mckibben::air::Process;
use mckibben::simulation::{Method, simulate};
use mckibben::valve::{Command, FlowStandard, Request};

/// Sonic conductance of the exhaust in m³/(s·Pa).
const CONDUCTANCE: f64 = 3e-9;

/// A held actuator at 7 bar that vents through its own exhaust, which is not the flow path that fills it.
fn venting() -> Paper {
    let paper = Paper::driven(Command::Constant(Request::Exhaust)).isometric(3.5 * INCH).process(Process::Isothermal);
    paper.gauge(7e5).with(|rig| {
        rig.exhaust = Some(FlowStandard::Iso6358 { sonic_conductance: CONDUCTANCE, critical_ratio: 0.4 });
        rig.efficiency = 1.0;
    })
}

/// While choked, `dP/dt = −C ρ₀ √(T₀ T) R P/V` at the temperature T: an exponential.
fn pressure(paper: &Paper, time: f64) -> f64 {
    let volume = paper.actuator().volume(3.5 * INCH);
    let rate = CONDUCTANCE * 1.185 * (ROOM * ROOM).sqrt() * paper.gas_constant / volume;
    (ATMOSPHERE + 7e5) * (-rate * time).exp()
}

#[test]
fn a_choked_exhaust_empties_by_an_exponential() {
    let paper = venting();
    let (rig, start) = (paper.rig(), paper.start());
    // Choked until P = Patm/0.4.
    let (mut until, step) = (0.0, 1e-3);
    while pressure(&paper, until + step) * 0.4 > ATMOSPHERE {
        until += step;
    }
    assert!(until > 0.01);
    let located = simulate(&rig, start, until, 1e-10).expect("a run").at(until).pressure.0;
    assert_close(located, pressure(&paper, until), 1e-9);
    for method in [Method::Rk4, Method::Stable] {
        let mut stepper = RigSteps::new(&rig, start, method);
        let steps = 4000;
        for step in 1..=steps {
            stepper.advance_to(until * (f64::from(step) / f64::from(steps))).expect("a step");
        }
        assert_close(stepper.state().pressure.0, pressure(&paper, until), 1e-6);
    }
}

#[test]
fn both_engines_agree_under_pwm() {
    let paper = Paper::pwm(20.0, 0.6).with(|rig| {
        rig.standard = FlowStandard::Cv { cv: 0.03, pressure_drop_ratio: 0.7 };
        rig.exhaust = Some(FlowStandard::Kv { kv: 1.5e-5, pressure_drop_ratio: 0.55 });
    });
    let (rig, start) = (paper.rig(), paper.start());
    let located = simulate(&rig, start, 0.3, 1e-11).expect("a run");
    let mut stepper = RigSteps::new(&rig, start, Method::Rk4);
    for step in 1..=30_000 {
        stepper.advance_to(0.3 * f64::from(step) / 30_000.0).expect("a step");
    }
    let (exact, near) = (located.at(0.3), stepper.state());
    assert_within(near.length, exact.length, 1e-7);
    assert_close(near.pressure.0, exact.pressure.0, 1e-5);
    assert_close(near.air_mass, exact.air_mass, 1e-5);
    // And the flow paths do differ: a plain valve ends elsewhere.
    let plain = paper.with(|rig| rig.exhaust = None);
    let other = simulate(&plain.rig(), plain.start(), 0.3, 1e-8).expect("a run").at(0.3);
    assert!((other.pressure.0 / exact.pressure.0 - 1.0).abs() > 0.02);
}
