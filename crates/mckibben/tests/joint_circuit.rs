//! The exergy of a joint's whole circuit: filling in closed form, the hanging mass as a limiting case, the sum, and what draws
//! nothing.

use crate::common::accounts::Audited;
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
    let ledger = run.ledger();
    let end = run.at(0.3).actuators[0];
    let supply = 100.0 * PSI + ATMOSPHERE;
    let (volume, pressure) = (end.volume, end.pressure.0);
    let drawn = volume * (pressure - ATMOSPHERE) * (supply / ATMOSPHERE).ln();
    let stored = volume * (pressure * (pressure / ATMOSPHERE).ln() - pressure + ATMOSPHERE);
    for of in &ledger.actuators {
        assert_close(of.exergy_gain, stored, 1e-8);
    }
    let total = ledger.total();
    assert_close(total.drawn, 2.0 * drawn, 1e-8);
    assert_close(total.least_work, 2.0 * drawn, 1e-8);
    // The limb stays where it is: no work, and no efficiency.
    assert_within(total.work, 0.0, 1e-9 * drawn);
    assert_within(total.efficiency().expect("something is drawn"), 0.0, 1e-9);
    assert_within(ledger.exergy().residual, 0.0, 1e-7 * drawn);
}

/// With a slack, sealed antagonist every term is that of the rig on a line.
#[test]
fn with_a_slack_antagonist_it_is_the_circuit_of_the_hanging_mass() {
    let (mass, radius) = (5.0 * LB, 0.02);
    let paper = Paper::pwm(10.0, 0.5).mass(mass).with(|rig| rig.length = InitialLength::Equilibrium);
    let line = paper.run(0.5, 1e-10).circuit().total;
    let pair = Pair::of(paper).with(|pair| {
        pair.papers[1] = Paper::sealed();
        pair.limb = Limb { mass, distance: 0.0, inertia: mass * radius * radius, gravity: GRAVITY, hanging_angle: 0.0 };
        let slack = Tendon { arm: MomentArm::Pulley(1e-3), rest_length: 0.02 };
        pair.tendons = [Tendon { arm: MomentArm::Pulley(radius), rest_length: 0.09 }, slack];
        pair.torque = -mass * GRAVITY * radius;
        pair.angle = InitialAngle::Equilibrium;
    });
    let ledger = pair.run(0.5, 1e-10).ledger();
    let (turned, agonist) = (ledger.total(), &ledger.actuators[0]);
    for (a, b) in [
        (line.drawn, turned.drawn),
        (line.least_work, turned.least_work),
        (line.stored, agonist.exergy_gain),
        (line.exhaust, turned.exhaust),
        (line.throttled, turned.throttled),
        (line.mixed, turned.mixed),
        (line.heat_loss, agonist.heat_loss),
        (line.heat, agonist.heat),
        (line.gas_work, agonist.gas_work),
        (line.work, turned.work),
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
            let ledger = pair.run(0.6, tolerance).ledger();
            let (exergy, total) = (ledger.exergy(), ledger.total());
            let residual = exergy.residual.abs() / exergy.turnover;
            assert!(residual <= 100.0 * tolerance, "{process:?}: {residual:e}");
            let limb = &ledger.mechanisms[0];
            let of_limb = limb.kinetic + limb.potential + limb.damping + limb.stops;
            assert_within(total.work, of_limb, 100.0 * tolerance * exergy.turnover);
            // What leaves out any of the places does not close.
            let dissipated = total.dissipated + limb.damping + limb.stops;
            for place in [total.exhaust, total.throttled, total.stored, dissipated] {
                assert!(place.abs() > 1e3 * exergy.residual.abs(), "{process:?}: {ledger:?}");
            }
        }
    }
}

#[test]
fn one_that_is_sealed_draws_nothing() {
    let total = Pair::of(Paper::sealed()).run(0.1, 1e-6).ledger().total();
    assert_eq!((total.drawn, total.least_work, total.efficiency()), (0.0, 0.0, None));
    // A sealed antagonist that the agonist pulls out takes part in the work alone.
    let paper = Paper::driven(Command::Constant(Request::Fill)).process(Process::Isentropic);
    let pair = Pair::of(paper).with(|pair| pair.papers[1] = Paper::sealed().gauge(20.0 * PSI));
    let ledger = pair.run(0.3, 1e-9).ledger();
    assert!(ledger.actuators[1].work < 0.0, "{ledger:?}");
    // Some 1e-4 kg, to rounding.
    assert_within(ledger.actuators[1].air_gain, 0.0, 1e-18);
    let exergy = ledger.exergy();
    assert_within(exergy.residual, 0.0, 1e-7 * exergy.turnover);
    assert!(ledger.total().efficiency().is_some_and(|share| share > 0.0 && share < 0.5), "{ledger:?}");
}

/// Exergy is counted from the temperature of the supply, whichever actuator has it.
#[test]
fn the_dead_state_is_that_of_the_supply() {
    let warm = Paper::driven(Command::Constant(Request::Fill)).process(Process::Isothermal);
    let temperature = warm.supply_temperature;
    let totals = [0, 1].map(|valved| {
        let pair = Pair::of(Paper::sealed()).with(|pair| {
            pair.papers[valved] = warm.clone().with(|paper| {
                paper.supply_temperature = temperature + 30.0;
                paper.temperature = temperature + 30.0;
            });
        });
        pair.run(0.3, 1e-9).ledger().total()
    });
    assert!(totals[0].drawn > 0.0);
    for (a, b) in [
        (totals[0].drawn, totals[1].drawn),
        (totals[0].least_work, totals[1].least_work),
        (totals[0].throttled, totals[1].throttled),
    ] {
        assert_close(a, b, 1e-6);
    }
}
