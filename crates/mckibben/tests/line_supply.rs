//! A supply whose pressure changes: bottle, compressor, regulator, several actuators.

use crate::common;
use common::accounts::Audited;
use common::{ATMOSPHERE, INCH, PSI, Paper, ROOM, assert_close, assert_within};
use mckibben::line::{Compressor, Hose, HoseKind, Line, Regulator, Reservoir, SupplyLine};
use mckibben::plant::RigTrajectory;
use mckibben::simulation::{EventKind, Rig, simulate};
use mckibben::valve::{Command, Request};
use mckibben::{Dual, Error, GaugePressure, Scalar, parameter};

const GAS: f64 = 286.99;
const SUPPLY: f64 = 100.0 * PSI;

fn reservoir(volume: f64, gauge: f64, compressor: Option<Compressor>) -> Reservoir {
    Reservoir::new([volume, 1.0, ROOM], GaugePressure(gauge), compressor, &Paper::sealed().air()).expect("a reservoir")
}

fn compressor(displacement: f64, clearance: f64, cut_in: f64, cut_out: f64) -> Compressor {
    let switch = [GaugePressure(cut_in), GaugePressure(cut_out)];
    Compressor::new([displacement, clearance], switch, &Paper::sealed().air()).expect("a compressor")
}

fn fed(reservoir: Option<Reservoir>, regulator: Option<Regulator>, actuators: f64) -> Line {
    let supply = SupplyLine::new(reservoir, regulator, actuators).expect("a supply");
    Line { supply: Some(supply), ..Line::NONE }
}

fn rig(paper: &Paper, line: Line) -> Rig {
    paper.rig().with_line(line).expect("a line")
}

fn run(paper: &Paper, line: Line, duration: f64) -> RigTrajectory {
    simulate(&rig(paper, line), paper.start(), duration, 1e-9).expect("a run")
}

fn supply(run: &RigTrajectory, time: f64) -> f64 {
    run.at(time).supply_pressure.expect("it changes").0
}

fn released() -> Paper {
    Paper::driven(Command::Constant(Request::Exhaust))
}

/// The mass that a bottle at constant temperature loses is the mass that its actuators gain while the valve stays on the supply.
#[test]
fn a_bottle_loses_what_its_actuators_draw() {
    let paper = Paper::driven(Command::Constant(Request::Fill));
    for actuators in [1.0, 4.0] {
        let volume = 2e-4;
        let run = run(&paper, fed(Some(reservoir(volume, SUPPLY, None)), None, actuators), 0.5);
        let lost = (SUPPLY + ATMOSPHERE - supply(&run, 0.5)) * volume / (GAS * ROOM);
        let audit = run.audit();
        assert_close(lost, actuators * audit.air_gain, 1e-6);
        assert!(supply(&run, 0.5) < 0.99 * (SUPPLY + ATMOSPHERE));
        assert!(audit.air_residual().abs() < 1e-6 * audit.air_in, "{audit:?}");
        assert!(audit.residual().abs() < 1e-6 * audit.turnover(), "{audit:?}");
    }
}

#[test]
fn a_bottle_without_end_is_a_supply_of_constant_pressure() {
    let paper = Paper::pwm(25.0, 0.5);
    let plain = paper.run(0.4, 1e-9);
    let fed = run(&paper, fed(Some(reservoir(1e3, SUPPLY, None)), None, 1.0), 0.4);
    for time in [0.1, 0.25, 0.4] {
        assert_close(fed.at(time).pressure.0, plain.at(time).pressure.0, 1e-6);
        assert_close(fed.at(time).length, plain.at(time).length, 1e-7);
    }
}

#[test]
fn actuators_alike_on_one_reservoir_are_one_on_their_part_of_it() {
    let paper = Paper::pwm(25.0, 0.5);
    let together = run(&paper, fed(Some(reservoir(6e-4, SUPPLY, None)), None, 3.0), 0.5);
    let alone = run(&paper, fed(Some(reservoir(2e-4, SUPPLY, None)), None, 1.0), 0.5);
    for time in [0.1, 0.3, 0.5] {
        assert_close(together.at(time).pressure.0, alone.at(time).pressure.0, 1e-9);
        assert_close(supply(&together, time), supply(&alone, time), 1e-9);
    }
}

/// Without clearance the compressor delivers `P_atm Q` of pressure times volume a second, whatever the pressure: with the
/// valve on the exhaust a reservoir at constant temperature fills in `(P₂ − P₁) V/(P_atm Q)`.
#[test]
fn a_compressor_fills_up_to_its_upper_pressure_and_stops() {
    let (volume, displacement) = (1e-3, 5e-4);
    let tank = reservoir(volume, 4e5, Some(compressor(displacement, 0.0, 3e5, 5e5)));
    let run = run(&released(), fed(Some(tank), None, 1.0), 4.0);
    let stops: Vec<f64> =
        run.events().iter().filter(|event| event.kind == EventKind::Compressor).map(|event| event.time).collect();
    assert_eq!(stops.len(), 1, "{stops:?}");
    assert_close(stops[0], 1e5 * volume / (ATMOSPHERE * displacement), 1e-9);
    assert_close(supply(&run, 4.0), 5e5 + ATMOSPHERE, 1e-9);
}

#[test]
fn the_switch_keeps_the_reservoir_in_its_band() {
    let tank = reservoir(3e-4, 5e5, Some(compressor(2e-3, 0.05, 4e5, 5.5e5)));
    let run = run(&Paper::pwm(25.0, 0.5), fed(Some(tank), None, 1.0), 4.0);
    let switches = run.events().iter().filter(|event| event.kind == EventKind::Compressor).count();
    assert!(switches >= 2, "{switches}");
    let band = (4e5 + ATMOSPHERE) * (1.0 - 1e-9)..(5.5e5 + ATMOSPHERE) * (1.0 + 1e-9);
    for sample in run.samples(1e-3) {
        let pressure = sample.supply_pressure.expect("it changes").0;
        assert!(band.contains(&pressure), "{pressure} at {}", sample.time);
    }
}

/// Clearance ε: nothing is delivered at the ratio `(1 + 1/ε)^γ`, and a tenth less at `(1 + 0.1/ε)^γ`.
#[test]
fn clearance_takes_from_the_delivery_as_the_ratio_grows() {
    let make = compressor(1e-4, 0.05, 3e5, 5e5);
    assert_close(make.efficiency(1.0), 1.0, 1e-14);
    assert_close(make.efficiency(3.0_f64.powf(1.4)), 0.9, 1e-13);
    assert_within(make.efficiency(21.0_f64.powf(1.4)), 0.0, 1e-13);
    assert_eq!(make.efficiency(1e3), 0.0);
}

/// After the valve leaves the supply nothing flows, and the droop that the flow had made decays with the lag, down to the
/// dead band.
#[test]
fn a_regulator_recovers_with_its_lag_down_to_its_dead_band() {
    let (droop, band, lag) = (2e7, 500.0, 20e-3);
    let regulator = Regulator::new(droop, band, lag).expect("a regulator");
    let shut = 0.05;
    let command = Command::table(vec![0.0, shut], vec![Request::Fill, Request::Exhaust]).expect("a command");
    let paper = Paper::driven(command).isometric(3.5 * INCH).with(|rig| rig.delays = (0.0, 0.0));
    let run = run(&paper, fed(None, Some(regulator), 1.0), 0.3);
    let set = SUPPLY + ATMOSPHERE;
    let error = set - supply(&run, shut);
    assert!(error > 5.0 * band, "{error}");
    for after in [0.5 * lag, lag, 1.3 * lag] {
        let expected = set - band - (error - band) * (-after / lag).exp();
        assert_close(supply(&run, shut + after), expected, 1e-8);
    }
    // The exponential never comes to the band; without a band it comes to the set pressure itself.
    assert!(set - supply(&run, 0.3) >= band * (1.0 - 1e-6));
    assert_close(set - supply(&run, 0.3), band, 0.05);
}

/// A choked valve draws what the outlet's pressure says, and the outlet has drooped by that.
#[test]
fn a_regulator_droops_in_proportion_to_the_flow() {
    let droop = 3e7;
    let regulator = Regulator::new(droop, 0.0, 1e-3).expect("a regulator");
    let paper = Paper::driven(Command::Constant(Request::Fill)).isometric(3.5 * INCH).with(|rig| {
        rig.delays = (0.0, 0.0);
        rig.external_volume = 1.0;
    });
    let run = run(&paper, fed(None, Some(regulator), 1.0), 0.05);
    let set = SUPPLY + ATMOSPHERE;
    let per_pressure = 0.85 * 0.040_42 * 1.8e-5 * 0.3048 * 0.3048 / ROOM.sqrt();
    assert_close(supply(&run, 0.05), set / (1.0 + droop * per_pressure), 1e-4);
}

#[test]
fn a_regulator_gives_no_more_than_its_reservoir_has() {
    let regulator = Regulator::new(0.0, 0.0, 5e-3).expect("a regulator");
    let tank = reservoir(5e-5, 1.1 * SUPPLY, None);
    let line = Line {
        hose: Some(
            Hose::new(HoseKind::Lumped, [1.0, 2.5e-3], [1.82e-5, ROOM, 1.0], &Paper::sealed().air()).expect("a hose"),
        ),
        ..fed(Some(tank), Some(regulator), 1.0)
    };
    let run = run(&Paper::pwm(25.0, 0.5), line, 1.0);
    let places = run.line_at(0.0);
    assert_eq!(places.len(), 3);
    assert_close(places[2], SUPPLY + ATMOSPHERE, 1e-12);
    let end = run.line_at(1.0);
    assert!(end[1] < 0.8 * places[1], "{end:?}");
    assert!(end[2] < 1.02 * end[1], "{end:?}");
}

#[test]
fn derivatives_pass_through_a_sagging_supply() {
    let paper = Paper::pwm(25.0, 0.5);
    let tank = reservoir(2e-4, SUPPLY, Some(compressor(2e-4, 0.05, 4e5, 6.5e5)));
    let rig = rig(&paper, fed(Some(tank), None, 1.0));
    let row = &parameter::RESERVOIR_VOLUME;
    let seeded =
        rig.map(
            |parameter, value| {
                if std::ptr::eq(parameter, row) { common::Seeded::variable(value, 0) } else { Dual::constant(value) }
            },
        );
    let start = seeded.begin(&paper.initial().map(|_, value| common::Seeded::constant(value))).expect("a start");
    let exact = simulate(&seeded, start, Scalar::constant(0.2), 1e-11).expect("a run").at(Dual::constant(0.2));
    let near = common::slope(1e-8, |h| {
        let changed = rig.map(|parameter, value| value + if std::ptr::eq(parameter, row) { h } else { 0.0 });
        simulate(&changed, paper.start(), 0.2, 1e-11).expect("a run").at(0.2).pressure.0
    });
    assert_close(exact.pressure.0.slope[0], near, 1e-4);
}

#[test]
fn what_contradicts_itself_is_refused() {
    let air = Paper::sealed().air();
    let switch = [GaugePressure(5e5), GaugePressure(4e5)];
    let refused = Compressor::new([1e-4, 0.05], switch, &air).expect_err("refused").to_string();
    assert!(refused.contains("supply.cut_in_gauge_pressure = 500000"), "{refused}");
    let refused = SupplyLine::new(None, None, 2.0).expect_err("refused").to_string();
    assert!(refused.contains("supply.actuators = 2"), "{refused}");
    let sealed = Paper::sealed().rig().with_line(fed(Some(reservoir(1e-3, SUPPLY, None)), None, 1.0));
    assert!(matches!(sealed, Err(Error::Misuse { .. })));
}
