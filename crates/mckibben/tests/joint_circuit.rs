//! The exergy of a joint's whole circuit: filling in closed form, the hanging mass as a limiting case, the sum, and what has
//! no circuit.

use crate::common::joint::Pair;
use crate::common::{ATMOSPHERE, GRAVITY, LB, PSI, Paper, assert_close, assert_within};
use mckibben::air::Process;
use mckibben::force::Effectiveness;
use mckibben::load::{Limb, MomentArm, Stops, Tendon};
use mckibben::simulation::{InitialAngle, InitialLength};
use mckibben::valve::{Command, Request};

fn pulses(frequency: f64, duty: f64) -> Command {
    Command::pwm(frequency, duty, Request::Fill, Request::Exhaust).expect("a command")
}

/// Two equal actuators that fill at angle zero keep their volume; each draws `V (P − P_0) ln(P_s/P_0)`.
#[test]
fn two_isothermal_fillings_have_their_closed_form() {
    let paper = Paper::driven(Command::Constant(Request::Fill)).process(Process::Isothermal);
    let run = Pair::of(paper).run(0.3, 1e-10);
    let audit = run.circuit().expect("a circuit");
    let end = run.at(0.3).actuators[0];
    let supply = 100.0 * PSI + ATMOSPHERE;
    let (volume, pressure) = (end.volume, end.pressure.0);
    let drawn = volume * (pressure - ATMOSPHERE) * (supply / ATMOSPHERE).ln();
    let stored = volume * (pressure * (pressure / ATMOSPHERE).ln() - pressure + ATMOSPHERE);
    for of in audit.actuators.iter().flatten() {
        assert_close(of.drawn, drawn, 1e-8);
        assert_close(of.stored, stored, 1e-8);
    }
    let total = audit.total();
    assert_close(total.drawn, 2.0 * drawn, 1e-8);
    assert_close(total.compressor, 2.0 * drawn, 1e-8);
    // The limb stays where it is: no work, and no efficiency.
    assert_within(audit.load(), 0.0, 1e-9 * drawn);
    assert_within(audit.efficiency().expect("something is drawn"), 0.0, 1e-9);
    assert_within(audit.residual(), 0.0, 1e-7 * drawn);
}

/// With a slack, sealed antagonist every term is that of the rig on a line.
#[test]
fn with_a_slack_antagonist_it_is_the_circuit_of_the_hanging_mass() {
    let (mass, radius) = (5.0 * LB, 0.02);
    let paper = Paper::pwm(10.0, 0.5).mass(mass).with(|rig| rig.length = InitialLength::Equilibrium);
    let line = paper.run(0.5, 1e-10).circuit().expect("a circuit");
    let pair = Pair::of(paper).with(|pair| {
        pair.papers[1] = Paper::sealed();
        pair.limb = Limb { mass, distance: 0.0, inertia: mass * radius * radius, gravity: GRAVITY, hanging_angle: 0.0 };
        let slack = Tendon { arm: MomentArm::Pulley(1e-3), rest_length: 0.02 };
        pair.tendons = [Tendon { arm: MomentArm::Pulley(radius), rest_length: 0.09 }, slack];
        pair.torque = -mass * GRAVITY * radius;
        pair.angle = InitialAngle::Equilibrium;
    });
    let turned = pair.run(0.5, 1e-10).circuit().expect("a circuit");
    assert_eq!(turned.actuators[1], None);
    let agonist = turned.actuators[0].expect("it draws");
    for (a, b) in [
        (line.drawn, agonist.drawn),
        (line.compressor, agonist.compressor),
        (line.stored, agonist.stored),
        (line.exhaust, agonist.exhaust),
        (line.throttled, agonist.throttled),
        (line.mixed, agonist.mixed),
        (line.heat, agonist.heat),
        (line.heat_gain, agonist.heat_gain),
        (line.work.gas_work, agonist.work.gas_work),
        (line.work.load, turned.load()),
    ] {
        assert_within(a, b, 1e-6 * line.drawn);
    }
    assert_close(line.efficiency().expect("drawn"), turned.efficiency().expect("drawn"), 1e-5);
}

#[test]
fn the_sum_closes_while_both_valves_work_against_stops_and_damping() {
    let balance = Process::EnergyBalance { heat_transfer: 0.5, wall_temperature: 300.0 };
    for process in [Process::Isothermal, Process::Isentropic, Process::Polytropic { index: 1.2 }, balance] {
        let pair = Pair::of(Paper::driven(pulses(20.0, 0.6)).process(process).friction(3.0, 1e-4)).with(|pair| {
            pair.papers[0].effectiveness = Effectiveness::Constant(0.9);
            pair.papers[1].command = Some(pulses(7.0, 0.3));
            pair.limb.distance = 0.12;
            pair.damping = 2e-3;
            pair.stops = Stops { ends: [Some(-0.2), Some(0.25)], stiffness: 300.0, damping: 0.3 };
            let arm = MomentArm::table(&[-0.3, 0.0, 0.3], &[0.012, 0.015, 0.014]).expect("a table");
            pair.tendons[0].arm = arm;
        });
        for tolerance in [1e-6, 1e-9] {
            let audit = pair.run(0.6, tolerance).circuit().expect("a circuit");
            let residual = audit.residual().abs() / audit.turnover();
            assert!(residual <= 100.0 * tolerance, "{process:?}: {residual:e}");
            let of_limb = audit.work.gain + audit.work.damping + audit.work.stops;
            assert_within(audit.load(), of_limb, 100.0 * tolerance * audit.turnover());
            // What leaves out any of the places does not close.
            let total = audit.total();
            for place in [total.exhaust, total.throttled, total.stored, audit.work.dissipated()] {
                assert!(place.abs() > 1e3 * audit.residual().abs(), "{process:?}: {audit:?}");
            }
        }
    }
}

#[test]
fn one_that_is_sealed_has_no_account_and_two_have_no_circuit() {
    assert_eq!(Pair::of(Paper::sealed()).run(0.1, 1e-6).circuit(), None);
    // A sealed antagonist that the agonist pulls out takes part in the work alone.
    let paper = Paper::driven(Command::Constant(Request::Fill)).process(Process::Isentropic);
    let pair = Pair::of(paper).with(|pair| pair.papers[1] = Paper::sealed().gauge(20.0 * PSI));
    let audit = pair.run(0.3, 1e-9).circuit().expect("a circuit");
    assert!(audit.actuators[0].is_some() && audit.actuators[1].is_none());
    assert!(audit.work.actuators[1].load < 0.0, "{audit:?}");
    assert_within(audit.residual(), 0.0, 1e-7 * audit.turnover());
    assert!(audit.efficiency().is_some_and(|share| share > 0.0 && share < 0.5), "{audit:?}");
}
