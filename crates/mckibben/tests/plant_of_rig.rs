//! The plant of a rig moves as the rig does by the engine of rigs.

use crate::common::random::{self, runner};
use crate::common::{INCH, PSI, Paper};
use mckibben::air::Process;
use mckibben::line::{Compressor, Hose, HoseKind, Leakage, Line, Regulator, Reservoir, SupplyLine};
use mckibben::plant::{Plant, simulate_plant};
use mckibben::simulation::{Rig, State, simulate};
use mckibben::{Error, GaugePressure};
use proptest::prelude::*;

/// The largest difference in length, pressure and air mass, over the range of each in the run.
fn largest_difference(rig: &Rig, start: State, duration: f64, tolerance: f64) -> Result<f64, Error> {
    let old = simulate(rig, start, duration, tolerance)?;
    let plant = Plant::of_rig(rig)?;
    let new = simulate_plant(&plant, &Plant::start_of_rig(rig, &start), duration, tolerance)?;
    let here = plant.places().actuators[0];
    let mut most: f64 = 0.0;
    let ranges = old.ranges();
    for sample in old.samples(duration / 400.0) {
        let (state, _) = new.at(sample.time);
        let length = here.length.map_or(state[0], |place| state[place]);
        let (pressure, mass) = (state[here.pressure], state[here.mass()]);
        let states = [(length, sample.length), (pressure, sample.pressure.0), (mass, sample.air_mass)];
        for (range, (ours, theirs)) in [ranges[0], ranges[2], ranges[3]].iter().zip(states) {
            let scale = (range.1 - range.0).max(1e-3 * range.1.abs());
            most = most.max((ours - theirs).abs() / scale);
        }
    }
    Ok(most)
}

#[test]
fn the_papers_rigs() {
    let cases: Vec<(&str, Paper, f64)> = vec![
        ("pwm", Paper::pwm(25.0, 0.5), 0.5),
        ("pwm 50", Paper::pwm(50.0, 0.5), 0.3),
        ("ring-down", Paper::sealed().gauge(60.0 * PSI).from(3.3 * INCH, 0.0), 2.0),
        ("isometric", Paper::pwm(25.0, 0.4).isometric(3.4 * INCH), 0.3),
        ("isothermal", Paper::pwm(25.0, 0.5).process(Process::Isothermal), 0.3),
        (
            "energy",
            Paper::pwm(25.0, 0.5).process(Process::EnergyBalance { heat_transfer: 0.05, wall_temperature: 290.0 }),
            0.3,
        ),
    ];
    for (name, paper, duration) in cases {
        let most = largest_difference(&paper.rig(), paper.start(), duration, 1e-8).expect(name);
        assert!(most < 1e-6, "{name}: {most}");
    }
}

/// Rigs that are tried when `MCKIBBEN_CASES` is not set.
const CASES: u32 = 300;

#[test]
fn random_rigs() {
    let ran = std::cell::Cell::new(0);
    let result = runner(CASES).run(&random::cases(), |case| {
        let rig = case.paper.rig();
        let Ok(start) = rig.start(&case.paper.initial()) else { return Ok(()) };
        match largest_difference(&rig, start, case.duration, 1e-10) {
            Ok(most) => {
                ran.set(ran.get() + 1);
                prop_assert!(most < 1e-5, "{most:e}");
                Ok(())
            }
            Err(Error::Stopped { reason, .. }) if reason.ends_with("straight") => Ok(()),
            Err(error) => Err(TestCaseError::fail(error.to_string())),
        }
    });
    result.unwrap_or_else(|error| panic!("{error}"));
    assert!(ran.get() > CASES / 2, "{} of {CASES} rigs ran", ran.get());
}

/// Hose, leak, reservoir and regulator.
#[test]
fn rigs_with_air_lines() {
    let paper = Paper::pwm(25.0, 0.5);
    let air = paper.air();
    let hose = |kind| Hose::new(kind, [1.0, 3e-3], [1.8e-5, 293.15, 1.0], &air).expect("a hose");
    let compressor = Compressor::new([2e-4, 0.03], [GaugePressure(5e5), GaugePressure(6.5e5)], &air).expect("one");
    let tank = Reservoir::new([2e-3, 1.0, 293.15], GaugePressure(6e5), Some(compressor), &air).expect("a tank");
    let bottle = Reservoir::new([1e-3, 1.4, 293.15], GaugePressure(7e5), None, &air).expect("a bottle");
    let regulator = Regulator::new(2e7, 3e3, 0.01).expect("a regulator");
    let plain = Regulator::new(2e7, 0.0, 0.01).expect("a regulator");
    let leak = Leakage::new(2e-11).expect("a leak");
    let supply = |reservoir, regulator| Some(SupplyLine::new(reservoir, regulator, 1.0).expect("a supply"));
    let cases = vec![
        ("lumped", Line { hose: Some(hose(HoseKind::Lumped)), ..Line::NONE }),
        ("distributed", Line { hose: Some(hose(HoseKind::Distributed { cells: 4 })), ..Line::NONE }),
        ("leak", Line { leakage: Some(leak), ..Line::NONE }),
        ("bottle", Line { supply: supply(Some(bottle), None), ..Line::NONE }),
        ("tank", Line { supply: supply(Some(tank), None), ..Line::NONE }),
        ("regulator", Line { supply: supply(None, Some(plain)), ..Line::NONE }),
        ("dead band", Line { supply: supply(Some(tank), Some(regulator)), ..Line::NONE }),
        (
            "all",
            Line { hose: Some(hose(HoseKind::Lumped)), leakage: Some(leak), supply: supply(Some(tank), Some(plain)) },
        ),
    ];
    for (name, line) in cases {
        let rig = paper.rig().with_line(line).expect(name);
        let start = rig.start(&paper.initial()).expect(name);
        let most = largest_difference(&rig, start, 0.4, 1e-8).expect(name);
        assert!(most < 2e-6, "{name}: {most}");
    }
}
