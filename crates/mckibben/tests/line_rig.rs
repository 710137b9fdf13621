//! The rig with a hose and a leak, by both engines.

use crate::common;
use crate::common::steps::RigSteps;
use common::accounts::Audited;
use common::{ATMOSPHERE, INCH, PSI, Paper, ROOM, assert_close, assert_within, slope};
use mckibben::air::Process;
use mckibben::line::{Hose, HoseKind, Leakage, Line};
use mckibben::simulation::{Method, Rig, simulate};
use mckibben::valve::{Command, ExhaustTemperature, Request, ValveKind};
use mckibben::{Dual, Error, Scalar, parameter};

const VISCOSITY: f64 = 1.82e-5;
const GAS: f64 = 286.99;

fn hose(kind: HoseKind, length: f64, diameter: f64) -> Line {
    let hose = Hose::new(kind, [length, diameter], [VISCOSITY, ROOM, 1.0], &Paper::sealed().air()).expect("a hose");
    Line { hose: Some(hose), ..Line::NONE }
}

fn leak(conductance: f64) -> Option<Leakage> {
    Some(Leakage::new(conductance).expect("a leak"))
}

fn rig(paper: &Paper, line: Line) -> Rig {
    paper.rig().with_line(line).expect("a line")
}

fn filling() -> Paper {
    Paper::driven(Command::Constant(Request::Fill)).with(|rig| rig.delays = (0.0, 0.0))
}

/// `dP/dt = −k (P² − P_atm²)/(2V)` at constant temperature: `(P − P_atm)/(P + P_atm)` falls as `exp(−k P_atm t/V)`.
#[test]
fn a_leak_empties_a_fixed_volume_as_the_closed_form_says() {
    let paper = Paper::sealed().process(Process::Isothermal).isometric(3.5 * INCH).gauge(4e5);
    let conductance = 2e-11;
    let rig = rig(&paper, Line { leakage: leak(conductance), ..Line::NONE });
    let run = simulate(&rig, paper.start(), 3.0, 1e-10).expect("a run");
    let volume = rig.actuator().volume(3.5 * INCH);
    let start = 4e5 + ATMOSPHERE;
    for time in [0.3, 1.0, 3.0] {
        let ratio = (start - ATMOSPHERE) / (start + ATMOSPHERE) * (-conductance * ATMOSPHERE * time / volume).exp();
        assert_close(run.at(time).pressure.0, ATMOSPHERE * (1.0 + ratio) / (1.0 - ratio), 1e-8);
    }
    let mut stepper = RigSteps::new(&rig, paper.start(), Method::Stable);
    (1..=3000).for_each(|step| stepper.advance_to(f64::from(step) * 1e-3).expect("a step"));
    assert_close(stepper.sample().pressure.0, run.at(3.0).pressure.0, 1e-4);
}

#[test]
fn a_hose_without_length_to_speak_of_is_none() {
    let ambient = ExhaustTemperature::Ambient;
    let paper = Paper::pwm(25.0, 0.5).with(|rig| rig.exhaust_temperature = ambient);
    let plain = paper.run(0.5, 1e-9);
    // A thousandth of the actuator's volume, and thirty times the valve's opening.
    let hosed = simulate(&rig(&paper, hose(HoseKind::Lumped, 1e-4, 8e-3)), paper.start(), 0.5, 1e-9).expect("a run");
    for time in [0.05, 0.1, 0.21, 0.5] {
        assert_within(hosed.at(time).length, plain.at(time).length, 2e-3 * (3.85 - 2.5) * INCH);
    }
}

#[test]
fn what_is_reached_in_the_end_does_not_depend_on_the_hose() {
    let warm = Process::EnergyBalance { heat_transfer: 0.05, wall_temperature: ROOM };
    let paper = filling().friction(200.0, 0.0).process(warm);
    let plain = paper.run(4.0, 1e-8).at(4.0);
    for kind in [HoseKind::Lumped, HoseKind::Distributed { cells: 3 }] {
        let run = simulate(&rig(&paper, hose(kind, 1.5, 2.5e-3)), paper.start(), 4.0, 1e-8).expect("a run");
        let end = run.at(4.0);
        assert_close(end.pressure.0, plain.pressure.0, 1e-4);
        assert_close(end.hose_pressure.0, plain.pressure.0, 1e-4);
        assert_close(end.length, plain.length, 1e-4);
    }
}

#[test]
fn air_and_energy_are_accounted_for() {
    let paper = Paper::pwm(25.0, 0.5);
    for kind in [HoseKind::Lumped, HoseKind::Distributed { cells: 4 }] {
        let line = Line { leakage: leak(1e-11), ..hose(kind, 1.0, 2.5e-3) };
        let audit = simulate(&rig(&paper, line), paper.start(), 0.6, 1e-9).expect("a run").audit();
        assert!(audit.residual().abs() < 1e-6 * audit.turnover(), "{audit:?}");
        assert!(audit.air_residual().abs() < 1e-6 * (audit.air_in + audit.air_out), "{audit:?}");
        assert!(audit.air_gain > 0.0 && audit.air_out > 0.0, "{audit:?}");
    }
}

/// What the valve does is seen L/c later through a lumped hose, and the front of a distributed one takes as long.
#[test]
fn a_hose_delays_by_its_length_over_the_speed_of_its_waves() {
    let length = 3.4;
    let delay = length / (GAS * ROOM).sqrt();
    let paper = filling().isometric(3.5 * INCH).gauge(60.0 * PSI).with(|rig| rig.supply_gauge = 62.0 * PSI);
    let paper = paper.with(|rig| rig.kind = ValveKind::FillHoldExhaust);
    let lumped =
        simulate(&rig(&paper, hose(HoseKind::Lumped, length, 5e-3)), paper.start(), 0.05, 1e-9).expect("a run");
    assert_close(lumped.events()[0].time, delay, 1e-12);
    let start = paper.start().pressure.0;
    assert_eq!(lumped.at(0.999 * delay).hose_pressure.0, start);
    assert!(lumped.at(1.01 * delay).hose_pressure.0 > start);

    // A choked valve is a source of constant flow w₀. Far along a ladder of cells without loss a step is the integral of
    // an Airy function: when the front would pass without dispersion, a third of it has come.
    let paper = paper.with(|rig| rig.supply_gauge = 160.0 * PSI);
    let line = hose(HoseKind::Distributed { cells: 8 }, length, 5e-3);
    let run = simulate(&rig(&paper, line), paper.start(), 0.05, 1e-9).expect("a run");
    let inflow = 0.85 * 0.040_42 * 1.8e-5 * 0.3048 * 0.3048 * (160.0 * PSI + ATMOSPHERE) / ROOM.sqrt();
    for cell in [5, 6] {
        let passes = |time: f64| run.line_at(time)[8 + cell - 1] - inflow / 3.0;
        let front = common::bisect(0.2 * delay, delay, passes);
        assert_close(front, delay * cell as f64 / 8.0, 0.03);
    }
}

#[test]
fn derivatives_pass_through_the_hose_and_its_delay() {
    let paper = Paper::pwm(25.0, 0.5).process(Process::Isentropic);
    for (row, size) in [(&parameter::HOSE_LENGTH, 1.0), (&parameter::HOSE_DIAMETER, 2.5e-3)] {
        let line = hose(HoseKind::Lumped, 1.0, 2.5e-3);
        let rig = rig(&paper, line);
        let seeded = rig.map(|parameter, value| {
            let constant = common::Seeded::constant(value);
            if std::ptr::eq(parameter, row) { Dual::variable(value, 0) } else { constant }
        });
        let start = seeded.begin(&paper.initial().map(|_, value| common::Seeded::constant(value))).expect("a start");
        let run = simulate(&seeded, start, Scalar::constant(0.1), 1e-11).expect("a run");
        let exact = run.at(Dual::constant(0.1));
        let near = |get: fn(&mckibben::simulation::Sample) -> f64| {
            slope(1e-4 * size, |h| {
                let changed = rig.map(|parameter, value| value + if std::ptr::eq(parameter, row) { h } else { 0.0 });
                get(&simulate(&changed, paper.start(), 0.1, 1e-11).expect("a run").at(0.1))
            })
        };
        assert_close(exact.pressure.0.slope[0], near(|sample| sample.pressure.0), 1e-4);
        assert_close(exact.length.slope[0], near(|sample| sample.length), 1e-4);
    }
}

fn end(rig: &Rig, paper: &Paper, method: Method, steps: u32, duration: f64) -> [f64; 3] {
    let mut stepper = RigSteps::new(rig, paper.start(), method);
    for step in 1..=steps {
        stepper.advance_to(duration * f64::from(step) / f64::from(steps)).expect("a step");
    }
    let sample = stepper.sample();
    [sample.length, sample.pressure.0, sample.hose_pressure.0]
}

#[test]
fn fixed_steps_approach_the_event_located_engine_with_their_order() {
    let paper =
        filling().friction(3.5, 0.0).process(Process::EnergyBalance { heat_transfer: 0.1, wall_temperature: ROOM });
    let rig = rig(&paper, Line { leakage: leak(1e-11), ..hose(HoseKind::Lumped, 1.0, 2.5e-3) });
    let duration = 0.045;
    let exact = simulate(&rig, paper.start(), duration, 1e-12).expect("a run").at(duration);
    let exact = [exact.length, exact.pressure.0, exact.hose_pressure.0];
    // Runge and Kutta's 4 is 3 here: the step on which the flow becomes turbulent has a jump in a second derivative.
    for (method, expected, counts) in [(Method::Stable, 2.0, [800, 1600]), (Method::Rk4, 3.0, [200, 400])] {
        let errors = counts.map(|steps| {
            let end = end(&rig, &paper, method, steps, duration);
            (0..3).fold(0.0_f64, |worst, n| worst.max((end[n] / exact[n] - 1.0).abs()))
        });
        let order = (errors[0] / errors[1]).log2();
        assert!(order > expected - 0.4, "{method:?}: order {order}, {errors:?}");
        assert!(errors[1] < 1e-4, "{method:?}: {errors:?}");
    }
}

/// Hose and actuator settle against each other in a few microseconds here, the hose against the port in as much.
#[test]
fn the_stable_method_takes_a_hose_of_any_size_in_steps_of_a_millisecond() {
    let paper = Paper::pwm(25.0, 0.5);
    for (length, diameter) in [(0.01, 4e-3), (0.1, 2e-3), (1.0, 2.5e-3), (5.0, 6e-3)] {
        let rig = rig(&paper, hose(HoseKind::Lumped, length, diameter));
        let run = simulate(&rig, paper.start(), 1.0, 1e-7).expect("a run");
        let mut stepper = RigSteps::new(&rig, paper.start(), Method::Stable);
        for step in 1..=1000 {
            let time = f64::from(step) * 1e-3;
            stepper.advance_to(time).expect("a step");
            let (ours, exact) = (stepper.sample(), run.at(time));
            let bound = 101.0 * PSI + ATMOSPHERE;
            assert!(ours.pressure.0 < bound && ours.hose_pressure.0 < bound, "{length}: {ours:?}");
            assert_within(ours.length, exact.length, 0.12 * INCH);
        }
    }
}

#[test]
fn a_hose_without_a_valve_is_refused_at_once() {
    let sealed = Paper::sealed().rig().with_line(hose(HoseKind::Lumped, 1.0, 2.5e-3));
    assert!(matches!(sealed, Err(Error::Misuse { .. })));
}
