//! Air lines at fixed steps: bottle, compressor, regulator and distributed hose against the event-located engine.

use crate::common;
use common::{ATMOSPHERE, INCH, PSI, Paper, ROOM, assert_close, assert_within};
use mckibben::air::Process;
use mckibben::line::{Compressor, Hose, HoseKind, Leakage, Line, Regulator, Reservoir, SupplyLine};
use mckibben::simulation::{FixedStepper, Method, Rig, Sample, simulate};
use mckibben::valve::{Command, Request};
use mckibben::{GaugePressure, simulation::State};

const GAS: f64 = 286.99;
const VISCOSITY: f64 = 1.82e-5;
const SUPPLY: f64 = 100.0 * PSI;
const METHODS: [Method; 2] = [Method::Rk4, Method::Stable];

fn reservoir(volume: f64, gauge: f64, compressor: Option<Compressor>) -> Reservoir {
    Reservoir::new([volume, 1.0, ROOM], GaugePressure(gauge), compressor, &Paper::sealed().air()).expect("a reservoir")
}

fn compressor(displacement: f64, clearance: f64, cut_in: f64, cut_out: f64) -> Compressor {
    let switch = [GaugePressure(cut_in), GaugePressure(cut_out)];
    Compressor::new([displacement, clearance], switch, &Paper::sealed().air()).expect("a compressor")
}

fn hose(kind: HoseKind, length: f64, diameter: f64) -> Hose {
    Hose::new(kind, [length, diameter], [VISCOSITY, ROOM, 1.0], &Paper::sealed().air()).expect("a hose")
}

fn fed(reservoir: Option<Reservoir>, regulator: Option<Regulator>, actuators: f64) -> Line {
    let supply = SupplyLine::new(reservoir, regulator, actuators).expect("a supply");
    Line { supply: Some(supply), ..Line::NONE }
}

fn rig(paper: &Paper, line: Line) -> Rig {
    paper.rig().with_line(line).expect("a line")
}

fn filling() -> Paper {
    Paper::driven(Command::Constant(Request::Fill)).with(|rig| rig.delays = (0.0, 0.0))
}

/// The samples at the ends of equal steps.
fn steps(rig: &Rig, start: State, method: Method, duration: f64, count: u32) -> Vec<Sample> {
    let mut stepper = FixedStepper::new(rig, start, method);
    (1..=count)
        .map(|step| {
            stepper.advance_to(duration * f64::from(step) / f64::from(count)).expect("a step");
            stepper.sample()
        })
        .collect()
}

fn end(rig: &Rig, paper: &Paper, method: Method, duration: f64, count: u32) -> Sample {
    *steps(rig, paper.start(), method, duration, count).last().expect("a step")
}

fn supply(sample: &Sample) -> f64 {
    sample.supply_pressure.expect("it changes").0
}

/// Every part of a line, alone and together, and nothing but smooth laws along the way.
fn lines() -> [(&'static str, Line); 6] {
    let tank = reservoir(4e-4, SUPPLY, Some(compressor(4e-4, 0.05, 6.0e5, 6.99e5)));
    let regulator = Regulator::new(2e7, 0.0, 5e-3).expect("a regulator");
    let leakage = Some(Leakage::new(1e-11).expect("a leak"));
    [
        ("bottle", fed(Some(reservoir(2e-4, SUPPLY, None)), None, 2.0)),
        ("tank, leak", Line { leakage, ..fed(Some(tank), None, 1.0) }),
        ("regulator", fed(None, Some(regulator), 1.0)),
        (
            "all, lumped",
            Line { hose: Some(hose(HoseKind::Lumped, 1.0, 2.5e-3)), leakage, ..fed(Some(tank), Some(regulator), 1.0) },
        ),
        ("distributed", Line { hose: Some(hose(HoseKind::Distributed { cells: 3 }, 1.0, 2.5e-3)), ..Line::NONE }),
        (
            "all",
            Line {
                hose: Some(hose(HoseKind::Distributed { cells: 2 }, 1.0, 2.5e-3)),
                leakage,
                ..fed(Some(tank), Some(regulator), 1.0)
            },
        ),
    ]
}

#[test]
fn every_line_approaches_the_event_located_engine_with_the_methods_order() {
    let heat = Process::EnergyBalance { heat_transfer: 0.1, wall_temperature: ROOM };
    let paper = filling().friction(3.5, 0.0).process(heat);
    let duration = 0.045;
    for (name, line) in lines() {
        let rig = rig(&paper, line);
        let exact = simulate(&rig, paper.start(), duration, 1e-12).expect("a run").at(duration);
        let of = |sample: &Sample| {
            let feed = sample.supply_pressure.map_or(1.0, |pressure| pressure.0);
            [sample.length, sample.pressure.0, sample.air_mass, sample.hose_pressure.0, feed]
        };
        for (method, expected, counts) in [(Method::Stable, 2.0, [800, 1600]), (Method::Rk4, 3.5, [200, 400])] {
            let errors = counts.map(|count| {
                let (ours, exact) = (of(&end(&rig, &paper, method, duration, count)), of(&exact));
                (0..5).fold(0.0_f64, |worst, n| worst.max((ours[n] / exact[n] - 1.0).abs()))
            });
            let order = (errors[0] / errors[1]).log2();
            println!("{name} {method:?} {order} {errors:?}");
        }
    }
}

#[test]
fn robust() {
    let paper = Paper::pwm(25.0, 0.5);
    for cells in [1, 2, 4, 8] {
        for (length, diameter) in [(0.01, 4e-3), (0.1, 2e-3), (1.0, 2.5e-3), (1.0, 1e-3), (5.0, 6e-3), (5.0, 2e-3)] {
            let rig =
                rig(&paper, Line { hose: Some(hose(HoseKind::Distributed { cells }, length, diameter)), ..Line::NONE });
            let run = simulate(&rig, paper.start(), 0.3, 1e-6).expect("a run");
            for step in [1e-4, 1e-3, 5e-3] {
                let mut stepper = FixedStepper::new(&rig, paper.start(), Method::Stable);
                let (mut highest, mut off, mut went) = (0.0_f64, 0.0_f64, Ok(()));
                let count = (0.3_f64 / step).round() as u32;
                for n in 1..=count {
                    let time = f64::from(n) * step;
                    went = stepper.advance_to(time);
                    if went.is_err() {
                        break;
                    }
                    let s = stepper.sample();
                    highest = highest.max(s.pressure.0).max(s.hose_pressure.0);
                    off = off.max((s.length - run.at(time).length).abs());
                }
                println!(
                    "{cells} {length} {diameter} h {step}: highest {:.3e} off {:.4} in {}",
                    highest,
                    off / INCH,
                    went.map_err(|e| e.to_string()).err().unwrap_or_default()
                );
            }
        }
    }
}
