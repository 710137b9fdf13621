//! Symptom: under PWM the stable method was of order 1, ten times less accurate than at order 2; and with heat from the
//! wall its very first step left the physics.
//!
//! Cause: the pressure's secant to an open port was taken of its whole rate. Where the shrinking volume carries the
//! pressure across the port's, or heat moves it off, the gap is nil and the rate is not: the secant was endless and held
//! the pressure still for a step. Only the flow settles at the port.

mod common;

use common::{PSI, Paper};
use mckibben::air::Process;
use mckibben::load::{Load, Motion};
use mckibben::simulation::accuracy::Reference;
use mckibben::simulation::{FixedStepper, InitialLength, Method};
use mckibben::valve::{Command, Request};

#[test]
fn heat_at_equal_pressures() {
    for (heat_transfer, wall_temperature) in [(0.1, 293.15), (0.1, 320.0), (10.0, 280.0), (0.0, 293.15)] {
        for length in [0.07, 0.08, 0.085, 0.0897, 0.095] {
            let process = Process::EnergyBalance { heat_transfer, wall_temperature };
            let paper = Paper::pwm(25.0, 0.5).isometric(length).process(process);
            let (rig, start) = (paper.rig(), paper.start());
            let mut stepper = FixedStepper::new(&rig, start, Method::Stable);
            for index in 1..=100 {
                stepper.advance_to(1e-3 * f64::from(index)).unwrap_or_else(|error| panic!("{length}: {error}"));
            }
        }
    }
}

#[test]
fn a_volume_that_carries_the_pressure_across_the_supplys() {
    // The muscle is filled to the supply's pressure and moved to and fro with the supply open.
    let paper = Paper::driven(Command::Constant(Request::Fill)).gauge(99.0 * PSI).with(|rig| {
        let motion = Motion::sinusoid(0.08, 5e-3, 10.0, 0.0, rig.thread_length).expect("a motion");
        (rig.load, rig.length) = (Load::Prescribed(motion), InitialLength::Equilibrium);
        rig.laminar_ratio = 0.95;
        rig.delays = (0.0, 0.0);
    });
    let reference = Reference::new(&paper.rig(), paper.start(), 0.2, 1e-12).expect("a run");
    let [coarse, fine] = [2e-4, 1e-4].map(|step| reference.error(Method::Stable, step).expect("steps").greatest());
    let order = (coarse / fine).log2();
    assert!(order > 1.8, "order {order}: {coarse:e} and {fine:e}");
}
