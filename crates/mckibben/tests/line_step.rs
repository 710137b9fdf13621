//! Air lines at fixed steps: bottle, compressor, regulator and distributed hose, against the event-located engine and in
//! closed form; no air is lost, and no step takes more than there is.

use crate::common;
use common::steps::RigSteps;
use common::{ATMOSPHERE, INCH, PSI, Paper, ROOM, assert_close, assert_within};
use mckibben::air::Process;
use mckibben::line::{Compressor, Hose, HoseKind, Leakage, Line, Regulator, Reservoir, SupplyLine};
use mckibben::network::NodeKind;
use mckibben::plant::{RigPlant, TimeStepping};
use mckibben::simulation::{Actuation, Method, Rig, Sample, State, simulate};
use mckibben::valve::{Command, FlowStandard, Ramp, Request, Solenoid};
use mckibben::{Dual, GaugePressure, Scalar, parameter};

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

fn regulator(droop: f64, dead_band: f64, lag: f64) -> Regulator {
    Regulator::new(droop, dead_band, lag).expect("a regulator")
}

fn hose(kind: HoseKind, length: f64, diameter: f64) -> Hose {
    Hose::new(kind, [length, diameter], [VISCOSITY, ROOM, 1.0], &Paper::sealed().air()).expect("a hose")
}

fn cells(cells: usize, length: f64, diameter: f64) -> Line {
    Line { hose: Some(hose(HoseKind::Distributed { cells }, length, diameter)), ..Line::NONE }
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
    let mut stepper = RigSteps::new(rig, start, method);
    let sample = |step| {
        stepper.advance_to(duration * f64::from(step) / f64::from(count)).expect("a step");
        stepper.sample()
    };
    (1..=count).map(sample).collect()
}

fn end(rig: &Rig, paper: &Paper, method: Method, duration: f64, count: u32) -> Sample {
    *steps(rig, paper.start(), method, duration, count).last().expect("a step")
}

fn supply(sample: &Sample) -> f64 {
    sample.supply_pressure.expect("it changes").0
}

/// A tank that a compressor fills all the while.
fn tank() -> Reservoir {
    reservoir(4e-4, SUPPLY, Some(compressor(4e-4, 0.05, 6.0e5, 6.99e5)))
}

/// Every part of a line, alone and with others.
fn lines() -> [(&'static str, Line); 6] {
    let regulator = regulator(2e7, 0.0, 5e-3);
    let leakage = Some(Leakage::new(1e-11).expect("a leak"));
    let lumped = Some(hose(HoseKind::Lumped, 1.0, 2.5e-3));
    [
        ("bottle", fed(Some(reservoir(2e-4, SUPPLY, None)), None, 2.0)),
        ("tank, leak", Line { leakage, ..fed(Some(tank()), None, 1.0) }),
        ("regulator", fed(None, Some(regulator), 1.0)),
        ("all, lumped", Line { hose: lumped, leakage, ..fed(Some(tank()), Some(regulator), 1.0) }),
        ("distributed", cells(3, 1.0, 2.5e-3)),
        ("all", Line { leakage, hose: cells(2, 1.0, 2.5e-3).hose, ..fed(Some(tank()), Some(regulator), 1.0) }),
    ]
}

/// The flow law has a root where the flow ceases to be choked, so that Runge and Kutta's method does not keep its order
/// over the whole of a filling; its errors are held to the bound that steps of 0.1 ms meet by far.
#[test]
fn every_line_approaches_the_event_located_engine() {
    let heat = Process::EnergyBalance { heat_transfer: 0.1, wall_temperature: ROOM };
    let paper = filling().friction(3.5, 0.0).process(heat);
    let duration = 0.045;
    for (name, line) in lines() {
        let rig = rig(&paper, line);
        let exact = simulate(&rig, paper.start(), duration, 1e-12).expect("a run").at(duration);
        let of = |sample: &Sample| {
            let feed = sample.supply_pressure.map_or(1.0, |pressure| pressure.0);
            [
                sample.length,
                sample.pressure.0,
                sample.air_mass,
                sample.hose_pressure.0,
                sample.hose_air_mass + 1e-5,
                feed,
            ]
        };
        let error = |method, count| {
            let (ours, exact) = (of(&end(&rig, &paper, method, duration, count)), of(&exact));
            (0..6).fold(0.0_f64, |worst, n| worst.max((ours[n] / exact[n] - 1.0).abs()))
        };
        let errors = [800, 1600].map(|count| error(Method::Stable, count));
        let order = (errors[0] / errors[1]).log2();
        assert!((order - 2.0).abs() < 0.2 && errors[1] < 1e-4, "{name}: order {order}, {errors:?}");
        let errors = [75, 150, 450].map(|count| error(Method::Rk4, count));
        assert!(errors[2] < 1e-8 && errors[2] < 0.1 * errors[0], "{name}: {errors:?}");
    }
}

/// What a bottle, a hose and actuators alike hold together stays what it was, however long the step: the air that leaves one
/// is what enters the next. The valve never lets go of any.
#[test]
fn no_air_is_lost_between_bottle_and_actuators() {
    let paper = filling();
    let lumped = Some(hose(HoseKind::Lumped, 0.5, 2e-3));
    for hose in [None, lumped, cells(1, 0.5, 2e-3).hose, cells(5, 0.5, 2e-3).hose] {
        for (actuators, regulator) in [(1.0, None), (3.0, None), (3.0, Some(regulator(2e7, 1e3, 5e-3)))] {
            let volume = 2e-4;
            let bottle = reservoir(volume, 1.2 * SUPPLY, None);
            let rig = rig(&paper, Line { hose, ..fed(Some(bottle), regulator, actuators) });
            let per_pressure = volume / (GAS * ROOM);
            for (method, count) in [(Method::Rk4, 4000), (Method::Stable, 4000), (Method::Stable, 40)] {
                let mut stepper = RigSteps::new(&rig, paper.start(), method);
                let start = stepper.sample();
                (1..=count).for_each(|n| stepper.advance_to(0.2 * f64::from(n) / f64::from(count)).expect("a step"));
                let sample = stepper.sample();
                let gained = [sample, start].map(|s| s.air_mass + s.hose_air_mass);
                let gained = actuators * (gained[0] - gained[1]);
                let plant = stepper.steps.plant();
                let is_bottle = |node: usize| matches!(plant.network().nodes[node].kind, NodeKind::Reservoir(_));
                let bottle = (0..plant.network().nodes.len()).find(|node| is_bottle(*node)).expect("a bottle");
                let bottled = stepper.steps.state()[plant.indices().nodes[bottle].expect("a state")];
                let lost = (1.2 * SUPPLY + ATMOSPHERE - bottled) * per_pressure;
                assert!(gained > 1e-6 * actuators, "{gained}");
                assert_close(lost, gained, 1e-9);
            }
        }
    }
}

/// Without clearance the compressor delivers `P_atm Q` of pressure times volume a second: from one pressure to the other it
/// takes `(P₂ − P₁) V/(P_atm Q)`, in closed form, and then it rests.
#[test]
fn a_compressor_stops_within_a_step() {
    let (volume, displacement) = (1e-3, 5e-4);
    let tank = reservoir(volume, 4e5, Some(compressor(displacement, 0.0, 3e5, 5e5)));
    let paper = Paper::driven(Command::Constant(Request::Exhaust)).isometric(3.5 * INCH);
    let stops = 1e5 * volume / (ATMOSPHERE * displacement);
    for method in METHODS {
        for sample in steps(&rig(&paper, fed(Some(tank), None, 1.0)), paper.start(), method, 3.0, 301) {
            let expected = 4e5 + ATMOSPHERE + ATMOSPHERE * displacement / volume * sample.time.min(stops);
            assert_close(supply(&sample), expected, 1e-7);
        }
    }
}

#[test]
fn the_switch_keeps_the_reservoir_in_its_band() {
    let tank = reservoir(3e-4, 5e5, Some(compressor(2e-3, 0.05, 4e5, 5.5e5)));
    let paper = Paper::pwm(25.0, 0.5);
    let rig = rig(&paper, fed(Some(tank), None, 1.0));
    let exact = simulate(&rig, paper.start(), 2.0, 1e-9).expect("a run");
    for (method, count, near) in [(Method::Rk4, 20_000, 1e-4), (Method::Stable, 2000, 3e-2)] {
        let samples = steps(&rig, paper.start(), method, 2.0, count);
        for sample in &samples {
            let band = (4e5 + ATMOSPHERE) * (1.0 - 1e-6)..(5.5e5 + ATMOSPHERE) * (1.0 + 1e-6);
            assert!(band.contains(&supply(sample)), "{sample:?}");
        }
        assert_close(supply(samples.last().expect("one")), supply(&exact.at(2.0)), near);
    }
}

/// A choked valve draws what the outlet's pressure says, and the outlet has drooped by that. With the valve off the supply
/// the error decays with the lag, down to the dead band.
#[test]
fn a_regulator_droops_and_recovers_as_the_closed_forms_say() {
    let droop = 3e7;
    let paper = filling().isometric(3.5 * INCH).with(|rig| rig.external_volume = 1.0);
    let per_pressure = 0.85 * 0.040_42 * 1.8e-5 * 0.3048 * 0.3048 / ROOM.sqrt();
    let set = SUPPLY + ATMOSPHERE;
    for method in METHODS {
        let rig = rig(&paper, fed(None, Some(regulator(droop, 0.0, 1e-3)), 1.0));
        assert_close(supply(&end(&rig, &paper, method, 0.05, 500)), set / (1.0 + droop * per_pressure), 1e-4);
    }

    let (droop, band, lag, shut) = (2e7, 500.0, 20e-3, 0.05);
    let command = Command::table(vec![0.0, shut], vec![Request::Fill, Request::Exhaust]).expect("a command");
    let paper = Paper::driven(command).isometric(3.5 * INCH).with(|rig| rig.delays = (0.0, 0.0));
    let rig = rig(&paper, fed(None, Some(regulator(droop, band, lag)), 1.0));
    for (method, tolerance) in [(Method::Rk4, 1e-10), (Method::Stable, 1e-4)] {
        let samples = steps(&rig, paper.start(), method, 0.1, 1000);
        let error = set - supply(&samples[499]);
        assert!(error > 5.0 * band, "{error}");
        for sample in &samples[500..] {
            let expected = set - band - (error - band) * (-(sample.time - shut) / lag).exp();
            assert_close(supply(sample), expected, tolerance);
        }
    }
}

/// A small fast bottle, a stiff regulator, hoses from a centimetre to metres: nothing rises above what feeds it, and the length
/// stays near the run of the event-located engine.
#[test]
fn the_stable_method_takes_any_line_in_steps_of_a_millisecond() {
    let paper = Paper::pwm(25.0, 0.5);
    let small = Some(reservoir(5e-7, SUPPLY, Some(compressor(2e-3, 0.02, 6.0e5, 6.9e5))));
    let stiff = Some(regulator(1e6, 0.0, 1e-4));
    let mut lines = vec![fed(small, None, 1.0), fed(None, stiff, 1.0), fed(small, stiff, 2.0)];
    for (count, length, diameter) in [(1, 0.01, 4e-3), (2, 0.1, 2e-3), (4, 1.0, 1e-3), (8, 1.0, 2.5e-3), (8, 5.0, 6e-3)]
    {
        lines.push(cells(count, length, diameter));
        lines.push(Line { hose: cells(count, length, diameter).hose, ..fed(small, stiff, 1.0) });
    }
    for line in lines {
        let rig = rig(&paper, line);
        let run = simulate(&rig, paper.start(), 0.3, 1e-6).expect("a run");
        for sample in steps(&rig, paper.start(), Method::Stable, 0.3, 300) {
            // A wave that comes to a closed end may rise to twice what it was.
            let bound = if line.hose.is_some() { 1.3 } else { 1.0 } * (101.0 * PSI + ATMOSPHERE);
            assert!(sample.pressure.0.max(sample.hose_pressure.0) < bound, "{line:?}: {sample:?}");
            assert_within(sample.length, run.at(sample.time).length, 0.12 * INCH);
        }
    }
}

/// A wave in a line at fixed steps comes where it comes by the event-located engine.
#[test]
fn waves_run_as_fast_at_fixed_steps() {
    let paper = filling().isometric(3.5 * INCH).gauge(60.0 * PSI).with(|rig| rig.supply_gauge = 160.0 * PSI);
    let rig = rig(&paper, cells(8, 3.4, 5e-3));
    let exact = simulate(&rig, paper.start(), 0.02, 1e-10).expect("a run");
    let rise = |sample: &Sample| sample.pressure.0 - paper.start().pressure.0;
    let highest = rise(&exact.at(0.02));
    for (method, count, near) in [(Method::Rk4, 200, 1e-4), (Method::Stable, 2000, 1e-3)] {
        for sample in steps(&rig, paper.start(), method, 0.02, count) {
            assert_within(rise(&sample), rise(&exact.at(sample.time)), near * highest);
        }
    }
}

#[test]
fn a_seat_under_way_feeds_from_a_sagging_bottle() {
    let paper = Paper::pwm(25.0, 0.5);
    let ramp = Ramp::new(4e-3, 3e-3).expect("a ramp");
    let solenoid = Solenoid::new(paper.kind, 4e-3, 1e-3).expect("a solenoid").with_ramp(ramp);
    let drive = Actuation { solenoid, command: paper.command.clone().expect("a command") };
    for line in [fed(Some(reservoir(1e-4, SUPPLY, None)), None, 1.0), lines()[3].1, lines()[5].1] {
        let rig = Rig::new(paper.actuator(), Some(drive.clone()), paper.load.clone()).expect("a rig");
        let rig = rig.with_line(line).expect("a line");
        let exact = simulate(&rig, paper.start(), 0.2, 1e-9).expect("a run").at(0.2);
        for (method, near) in [(Method::Rk4, 1e-5), (Method::Stable, 2e-3)] {
            let ours = end(&rig, &paper, method, 0.2, 4000);
            assert_close(ours.pressure.0, exact.pressure.0, near);
            assert_close(supply(&ours), supply(&exact), near);
        }
    }
}

#[test]
fn derivatives_pass_through_a_line_at_fixed_steps() {
    let paper = Paper::pwm(25.0, 0.5);
    let rig = rig(&paper, lines()[5].1);
    for (row, size) in [(&parameter::RESERVOIR_VOLUME, 4e-4), (&parameter::HOSE_LENGTH, 1.0), (&parameter::LAG, 5e-3)] {
        let same = |parameter| std::ptr::eq(parameter, row);
        let seeded = rig.map(
            |parameter, value| {
                if same(parameter) { common::Seeded::variable(value, 0) } else { Dual::constant(value) }
            },
        );
        let start = seeded.begin(&paper.initial().map(|_, value| common::Seeded::constant(value))).expect("a start");
        let stepping = TimeStepping::Fixed { method: Method::Stable, step: 1e-3 };
        let run = RigPlant::new(&seeded).simulate(&start, Dual::constant(0.1), stepping).expect("a run");
        let exact = run.at(Dual::constant(0.1)).pressure.0.slope[0];
        let near = common::slope(1e-6 * size, |h| {
            let changed = rig.map(|parameter, value| value + if same(parameter) { h } else { 0.0 });
            end(&changed, &paper, Method::Stable, 0.1, 100).pressure.0
        });
        assert_close(exact, near, 1e-4);
    }
}

/// So many times the paper's valve.
fn larger(size: f64) -> FlowStandard {
    FlowStandard::Orifice { flow_area: size * 1.8e-5 * 0.3048 * 0.3048 }
}

/// Air that is filled in comes to the temperature of the wall, and to no more than the pressure of the supply, however well the wall
/// conducts heat; its pressure is that of short steps as nearly as without heat.
#[test]
fn heat_that_settles_within_a_step_takes_no_pressure_beyond_the_supply() {
    for (heat, missed) in [(100.0, 0.05), (1e4, 1e-3)] {
        for size in [1.0, 10.0, 100.0] {
            let paper = filling().isometric(3.5 * INCH).with(|rig| rig.standard = larger(size));
            let paper = paper.process(Process::EnergyBalance { heat_transfer: heat, wall_temperature: ROOM });
            let rig = paper.rig();
            let [coarse, fine] = [50, 10_000].map(|count| steps(&rig, paper.start(), Method::Stable, 0.05, count));
            for (sample, exact) in coarse.iter().zip(fine.iter().skip(199).step_by(200)) {
                assert_close(sample.temperature, exact.temperature, missed);
                assert_close(sample.pressure.0, exact.pressure.0, 0.25);
                assert!(sample.pressure.0 < 1.002 * (SUPPLY + ATMOSPHERE), "{heat} {size}: {sample:?}");
            }
        }
    }
}

/// A valve so large that a step empties the actuator many times over: the air goes down to what the atmosphere leaves
/// of it, `m P_atm/P` at constant temperature, and never below.
#[test]
fn a_step_takes_no_more_air_than_there_is() {
    let emptying = Paper::driven(Command::Constant(Request::Exhaust)).isometric(3.5 * INCH).gauge(6.9e5);
    let heat = Process::EnergyBalance { heat_transfer: 0.1, wall_temperature: ROOM };
    for process in [Process::Isentropic, Process::Isothermal, heat] {
        for (size, step) in [(12.0, 4e-3), (120.0, 20e-3), (1200.0, 1e-3), (1e5, 0.1)] {
            let paper = emptying.clone().process(process).with(|rig| {
                rig.standard = larger(size);
                rig.delays = (0.0, 0.0);
            });
            for line in [Line::NONE, lines()[0].1, cells(2, 0.05, 20e-3)] {
                let rig = rig(&paper, line);
                let [start, mass] = [paper.start().pressure.0, paper.start().air_mass];
                for sample in steps(&rig, paper.start(), Method::Stable, 10.0 * step, 10) {
                    assert!(
                        sample.air_mass > 0.3 * ATMOSPHERE / start * mass,
                        "{process:?} {size} {line:?}: {sample:?}"
                    );
                    // The inertia of a hose draws out a little more.
                    assert!(sample.pressure.0 > 0.5 * ATMOSPHERE, "{process:?} {size} {line:?}: {sample:?}");
                }
            }
        }
    }
    // Under pulses too, with a load, and with what feeds it.
    for (size, step) in [(12.0, 4e-3), (120.0, 20e-3)] {
        for process in [Process::Isentropic, heat] {
            let paper = Paper::pwm(25.0, 0.5).process(process).with(|rig| rig.standard = larger(size));
            for line in [Line::NONE, lines()[0].1, lines()[5].1] {
                let samples = steps(&rig(&paper, line), paper.start(), Method::Stable, 100.0 * step, 100);
                assert!(samples.iter().all(|sample| sample.air_mass > 0.0 && sample.pressure.0 > 0.0));
            }
        }
    }
}
