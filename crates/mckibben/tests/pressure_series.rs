//! A pressure that is given over time: the static force at it, the motion that a simulated valve made, the air by each process
//! in closed form, derivatives against differences, and what does not take it.

use crate::common::steps::RigSteps;
use crate::common::{ATMOSPHERE, PSI, Paper, assert_close, assert_within, scaled, seeded, slope};
use mckibben::Scalar;
use mckibben::air::Process;
use mckibben::line::{Hose, HoseKind, Leakage, Line};
use mckibben::parameter;
use mckibben::plant::{RigPlant, simulate_plant};
use mckibben::simulation::{EventKind, InitialLength, Method, PressureSeries, Rig, simulate};
use mckibben::valve::{Command, Request};

const TIME: [f64; 4] = [0.02, 0.1, 0.15, 0.3];
const GAUGE: [f64; 4] = [20.0 * PSI, 80.0 * PSI, 75.0 * PSI, 30.0 * PSI];

fn pressure_series() -> PressureSeries {
    PressureSeries::new(&TIME, &GAUGE).expect("a time series")
}

fn given(paper: &Paper) -> Rig {
    paper.rig().with_pressure(pressure_series()).expect("a rig")
}

/// The straight lines, by hand.
fn gauge(time: f64) -> f64 {
    let next = TIME.iter().position(|row| *row > time).unwrap_or(TIME.len());
    match next {
        0 => GAUGE[0],
        4 => GAUGE[3],
        _ => {
            let part = (time - TIME[next - 1]) / (TIME[next] - TIME[next - 1]);
            GAUGE[next - 1] + part * (GAUGE[next] - GAUGE[next - 1])
        }
    }
}

#[test]
fn an_isometric_rig_pulls_with_the_static_force_of_the_pressure() {
    let paper = Paper::sealed().isometric(0.085);
    let rig = given(&paper);
    let start = rig.start(&paper.initial()).expect("a start");
    assert_close(start.pressure.0, GAUGE[0] + ATMOSPHERE, 1e-15);
    let run = simulate(&rig, start, 0.4, 1e-9).expect("a run");
    for time in (0..=80).map(|step| 5e-3 * f64::from(step)) {
        let sample = run.at(time);
        assert_close(sample.pressure.0, gauge(time) + ATMOSPHERE, 1e-13);
        assert_close(sample.tension, rig.actuator().static_force(0.085, gauge(time) + ATMOSPHERE), 1e-12);
    }
    let corners: Vec<f64> =
        run.events().iter().filter(|event| event.kind == EventKind::Corner).map(|event| event.time).collect();
    assert_eq!(corners, TIME);
}

/// The pressure that a valve made, read so often that straight lines between two readings are it.
#[test]
fn the_pressure_of_a_valve_moves_the_load_as_the_valve_did() {
    let paper = Paper::pwm(20.0, 0.45).gauge(30.0 * PSI).mass(6.0);
    let valve = paper.run(0.4, 1e-11);
    let mut times: Vec<f64> = (0..=20_000).map(|step| 2e-5 * f64::from(step)).collect();
    // Where a poppet moves the pressure has a corner.
    times.extend(valve.events().iter().map(|event| event.time));
    times.sort_by(f64::total_cmp);
    times.dedup_by(|a, b| *a - *b < 1e-9);
    let gauges: Vec<f64> = times.iter().map(|time| valve.at(*time).pressure.0 - ATMOSPHERE).collect();
    let sealed = Paper { command: None, ..paper };
    let rig = sealed.rig().with_pressure(PressureSeries::new(&times, &gauges).expect("a time series")).expect("a rig");
    let run = simulate(&rig, rig.start(&sealed.initial()).expect("a start"), 0.4, 1e-10).expect("a run");
    for time in (0..=200).map(|step| 2e-3 * f64::from(step)) {
        let (ours, theirs) = (run.at(time), valve.at(time));
        assert_within(ours.length, theirs.length, 1e-7);
        // The paper's air has one entropy, whichever way its pressure came about.
        assert_close(ours.air_mass, theirs.air_mass, 1e-5);
    }
}

#[test]
fn the_air_follows_by_its_process() {
    let gamma = 1.4;
    let without_heat = Process::EnergyBalance { heat_transfer: 0.0, wall_temperature: 293.15 };
    let warm = Process::EnergyBalance { heat_transfer: 1e3, wall_temperature: 293.15 };
    // P ∝ m^κ at one volume; much heat keeps the wall's temperature, and makes a flow of (γ − 1) h δT/(γ R T) of an error δT
    // between steps: 1e-8 kg/s where that is 1e-8 T.
    for (process, index, within, of_flow) in [
        (Process::Isentropic, gamma, 1e-8, 1e-12),
        (Process::Isothermal, 1.0, 1e-12, 1e-12),
        (Process::Polytropic { index: 1.2 }, 1.2, 1e-8, 1e-12),
        (without_heat, gamma, 1e-8, 1e-12),
        (warm, 1.0, 1e-3, 1e-8),
    ] {
        let paper = Paper::sealed().isometric(0.085).process(process);
        let rig = given(&paper);
        let start = rig.start(&paper.initial()).expect("a start");
        let run = simulate(&rig, start, 0.35, 1e-10).expect("a run");
        for time in [0.05, 0.1, 0.12, 0.2, 0.35] {
            let sample = run.at(time);
            let expected = start.air_mass * (sample.pressure.0 / start.pressure.0).powf(1.0 / index);
            assert_close(sample.air_mass, expected, within);
            let rate = slope(1e-5, |dt| run.at(time - 1e-3 + dt).air_mass);
            assert_within(run.at(time - 1e-3).mass_flow, rate, 1e-3 * rate.abs() + of_flow);
        }
    }
}

/// Heat that brings the air to the temperature of its wall within a fiftieth of a step leaves the mass of an isothermal gas.
#[test]
fn heat_much_faster_than_a_stable_step_keeps_the_temperature_of_the_wall() {
    let wall_temperature = 293.15;
    let process = Process::EnergyBalance { heat_transfer: 1e4, wall_temperature };
    let paper = Paper::sealed().isometric(0.085).process(process);
    let rig = given(&paper);
    let mut steps = RigSteps::new(&rig, rig.start(&paper.initial()).expect("a start"), Method::Stable);
    for step in 1..=400 {
        let time = 1e-3 * f64::from(step);
        steps.advance_to(time).expect("it goes on");
        let (state, volume) = (steps.state(), paper.actuator().volume(0.085));
        let expected = state.pressure.0 * volume / (paper.gas_constant * wall_temperature);
        // While the pressure changes the mass is late by parts of a step.
        assert_close(state.air_mass, expected, if time > 0.32 { 1e-6 } else { 0.03 });
    }
}

/// The readings of a sensor with an offset, a scale and a clock that is late.
fn recorded([offset, scale, shift]: [f64; 3]) -> PressureSeries {
    let shown = GAUGE.map(|gauge| scale * gauge + offset);
    PressureSeries::new(&TIME.map(|time| time + shift), &shown)
        .and_then(|series| series.with_sensor(offset, scale, shift))
        .expect("a series")
}

/// What the sensor adds is taken off: the run is that of the pressure itself, by both engines, also where the first rows lie before
/// the start.
#[test]
fn what_the_sensor_adds_is_taken_off() {
    let paper = Paper::sealed().mass(6.0);
    for sensor in [[2e4, 1.0, 0.0], [0.0, 1.1, 0.0], [0.0, 1.0, 0.013], [-1.5e4, 0.93, -0.01]] {
        let (plain, shown) = (given(&paper), paper.rig().with_pressure(recorded(sensor)).expect("a rig"));
        let [plain, shown] = [plain, shown].map(|rig| {
            let start = rig.start(&paper.initial()).expect("a start");
            let mut steps = RigSteps::new(&rig, start, Method::Rk4);
            for step in 1..=3500 {
                steps.advance_to(1e-4 * f64::from(step)).expect("it goes on");
            }
            (simulate(&rig, start, 0.35, 1e-11).expect("a run").at(0.35), steps.sample())
        });
        for (plain, shown) in [(plain.0, shown.0), (plain.1, shown.1)] {
            assert_close(shown.length, plain.length, 1e-8);
            assert_close(shown.pressure.0, plain.pressure.0, 1e-12);
        }
    }
    // At t = 0 half of the way between two rows is gone.
    let series = PressureSeries::new(&[0.0, 0.2], &[1e5, 3e5]).and_then(|series| series.with_sensor(0.0, 1.0, 0.1));
    let rig = paper.rig().with_pressure(series.expect("a series")).expect("a rig");
    let start = rig.start(&paper.initial()).expect("a start");
    let run = simulate(&rig, start, 0.2, 1e-9).expect("a run");
    for (time, gauge) in [(0.0, 2e5), (0.05, 2.5e5), (0.1, 3e5), (0.2, 3e5)] {
        assert_close(run.at(time).pressure.0, gauge + ATMOSPHERE, 1e-12);
    }
    for (sensor, key) in
        [([f64::NAN, 1.0, 0.0], "offset"), ([0.0, 0.0, 0.0], "scale"), ([0.0, 1.0, f64::INFINITY], "shift")]
    {
        let error = pressure_series().with_sensor(sensor[0], sensor[1], sensor[2]).expect_err("no sensor").to_string();
        assert!(error.contains(&format!("pressure.{key}")), "{error}");
    }
}

/// Where readings come late, rows have passed before the start: the run is that of the table moved by hand, from its first
/// instant on, at the muscle and at the end of a hose. A lumped hose passes on at first what was read before the start.
#[test]
fn readings_that_come_late_begin_between_their_rows() {
    let shift = 0.06;
    let late = pressure_series().with_sensor(0.0, 1.0, shift).expect("a series");
    let times = [0.0, TIME[1] - shift, TIME[2] - shift, TIME[3] - shift];
    let moved = PressureSeries::new(&times, &[gauge(shift), GAUGE[1], GAUGE[2], GAUGE[3]]).expect("a series");
    let paper = Paper::sealed().mass(3.0);
    let lumped = Line { hose: Some(hose(HoseKind::Lumped, &paper)), ..Line::NONE };
    let rig = paper.rig().with_pressure(late.clone()).and_then(|rig| rig.with_line(lumped)).expect("a rig");
    let run = simulate(&rig, rig.start(&paper.initial()).expect("a start"), 0.05, 1e-10).expect("a run");
    let delay = hose(HoseKind::Lumped, &paper).transport_delay();
    for time in [0.0, 1e-3, 5e-3, 0.03, 0.05] {
        assert_close(run.at(time).hose_pressure.0, gauge(time + shift - delay) + ATMOSPHERE, 1e-12);
    }
    let hoses = [None, Some(HoseKind::Distributed { cells: 4 })];
    for line in hoses.map(|kind| kind.map(|kind| Line { hose: Some(hose(kind, &paper)), ..Line::NONE })) {
        let [late, moved] = [&late, &moved].map(|series| {
            let rig = paper.rig().with_pressure(series.clone()).expect("a rig");
            let rig = line.map_or(Ok(rig.clone()), |line| rig.with_line(line)).expect("a rig");
            let start = rig.start(&paper.initial()).expect("a start");
            let run = simulate(&rig, start, 0.05, 1e-11).expect("a run");
            let mut steps = RigSteps::new(&rig, start, Method::Stable);
            (1..=50).for_each(|step| steps.advance_to(1e-3 * f64::from(step)).expect("it goes on"));
            [run.at(0.0), run.at(1e-3), run.at(5e-3), run.at(0.05), steps.sample()]
        });
        for (late, moved) in late.iter().zip(&moved) {
            assert_close(late.pressure.0, moved.pressure.0, 1e-9);
            assert_close(late.hose_pressure.0, moved.hose_pressure.0, 1e-9);
            assert_close(late.air_mass, moved.air_mass, 1e-9);
            assert_close(late.length, moved.length, 1e-10);
        }
    }
}

#[test]
fn derivatives_are_those_of_differences() {
    let paper = Paper::sealed().mass(6.0);
    let rig = paper.rig().with_pressure(recorded([3e4, 1.1, 4e-3])).expect("a rig");
    let run = |rig: &Rig| {
        let start = rig.start(&paper.initial()).expect("a start");
        let sample = simulate(rig, start, 0.25, 1e-12).expect("a run").at(0.25);
        [sample.length, sample.velocity]
    };
    let of_sensor = [&parameter::SERIES_OFFSET, &parameter::SERIES_SCALE, &parameter::SERIES_SHIFT];
    let others = [&parameter::MASS, &parameter::VISCOUS, &parameter::TURNS, &parameter::SERIES_GAUGE_PRESSURE];
    for row in others.into_iter().chain(of_sensor) {
        type One = crate::common::Seeded;
        let seeded = seeded(&rig, row);
        let start = seeded.begin(&paper.initial().map(|_, value| One::constant(value))).expect("a start");
        let sample = simulate(&seeded, start, One::constant(0.25), 1e-12).expect("a run").at(One::constant(0.25));
        for (place, exact) in [sample.length, sample.velocity].into_iter().enumerate() {
            let difference = slope(1e-5, |part| run(&scaled(&rig, row, part))[place]);
            assert_within(exact.slope[0], difference, 1e-5 * difference.abs() + 1e-9);
        }
    }
}

#[test]
fn what_does_not_go_together_is_refused() {
    let error =
        Paper::driven(Command::Constant(Request::Fill)).rig().with_pressure(pressure_series()).expect_err("a valve");
    assert!(error.to_string().contains("a valve or a leak would change it too"), "{error}");
    let vacuum = PressureSeries::new(&[0.0, 1.0], &[0.0, -1.1e5]).expect("a time series");
    let error = Paper::sealed().rig().with_pressure(vacuum).expect_err("below vacuum");
    assert!(error.to_string().contains("pressure.gauge_pressure = -110000"), "{error}");
    for (times, gauges, words) in [
        (&[0.0, 1.0][..], &[1e5][..], "entry 2"),
        (&[], &[], "not one pressure for each time"),
        (&[1.0, 0.5], &[1e5, 1e5], "do not rise"),
        (&[0.0], &[f64::NAN], "pressure.gauge_pressure"),
    ] {
        let error = PressureSeries::new(times, gauges).expect_err("no time series").to_string();
        assert!(error.contains(words), "{error}");
    }
}

fn hose(kind: HoseKind, paper: &Paper) -> Hose {
    Hose::new(kind, [0.8, 3e-3], [1.8e-5, 293.15, 1.2], &paper.air()).expect("a hose")
}

/// What a sensor at the valve's end of a hose reads makes the air in the muscle, and so the motion, that the valve made.
#[test]
fn the_pressure_at_the_end_of_a_hose_moves_the_load_as_the_valve_did() {
    for kind in [HoseKind::Lumped, HoseKind::Distributed { cells: 6 }] {
        let paper = Paper::pwm(20.0, 0.45).mass(6.0);
        let line = Line { hose: Some(hose(kind, &paper)), ..Line::NONE };
        let driven = paper.rig().with_line(line).expect("a rig");
        let valve = simulate(&driven, driven.start(&paper.initial()).expect("a start"), 0.3, 1e-11).expect("a run");
        let mut times: Vec<f64> = (0..=30_000).map(|step| 1e-5 * f64::from(step)).collect();
        times.extend(valve.events().iter().map(|event| event.time).filter(|time| *time < 0.3));
        times.sort_by(f64::total_cmp);
        times.dedup_by(|a, b| *a - *b < 1e-9);
        let gauges: Vec<f64> = times.iter().map(|time| valve.at(*time).hose_pressure.0 - ATMOSPHERE).collect();
        let sealed = Paper { command: None, ..paper };
        // A lumped hose passes on late what is given; what the sensor of the model reads has passed it already.
        let late = match kind {
            HoseKind::Lumped => hose(kind, &sealed).transport_delay(),
            HoseKind::Distributed { .. } => 0.0,
        };
        let early = |time: &f64| if *time > late { Some(time - late) } else { None };
        let (times, gauges): (Vec<f64>, Vec<f64>) =
            times.iter().zip(&gauges).filter_map(|(time, gauge)| Some((early(time)?, *gauge))).unzip();
        let series = PressureSeries::new(&times, &gauges).expect("a time series");
        let rig = sealed.rig().with_pressure(series).and_then(|rig| rig.with_line(line)).expect("a rig");
        let run = simulate(&rig, rig.start(&sealed.initial()).expect("a start"), 0.3, 1e-10).expect("a run");
        let mut furthest: f64 = 0.0;
        for time in (1..=150).map(|step| 2e-3 * f64::from(step)) {
            let (ours, theirs) = (run.at(time), valve.at(time));
            assert_within(ours.length, theirs.length, 2e-7);
            assert_close(ours.hose_pressure.0, theirs.hose_pressure.0, 1e-5);
            assert_close(ours.pressure.0, theirs.pressure.0, 1e-4);
            assert_close(ours.air_mass, theirs.air_mass, 1e-4);
            furthest = furthest.max((theirs.hose_pressure.0 - theirs.pressure.0).abs());
        }
        assert!(furthest > 1e4, "the hose takes pressure: {furthest:e}");
    }
}

/// What flows out of the place where the pressure is given is what comes into a closed muscle, and energy and air are accounted
/// for, by both engines.
#[test]
fn the_air_that_a_hose_lets_in_is_accounted_for() {
    for kind in [HoseKind::Lumped, HoseKind::Distributed { cells: 4 }] {
        let paper = Paper::sealed().with(|paper| paper.length = InitialLength::At(0.09));
        let line =
            Line { hose: Some(hose(kind, &paper)), leakage: Some(Leakage::new(1e-11).expect("a leak")), ..Line::NONE };
        let rig = given(&paper).with_line(line).expect("a rig");
        let start = rig.start(&paper.initial()).expect("a start");
        assert_close(start.pressure.0, paper.initial().gauge_pressure.0 + ATMOSPHERE, 1e-15);
        let view = RigPlant::new(&rig);
        let ledger = simulate_plant(view.plant(), &view.start(&start), 0.5, 1e-10).expect("a run").ledger();
        for balance in [ledger.work(), ledger.energy(), ledger.exergy(), ledger.air()] {
            assert!(balance.closes(1e-6), "{balance:?}");
        }
        let exact = view.simulate(&start, 0.5, 1e-11).expect("a run").at(0.5);
        let off = |step: f64| {
            let mut steps = RigSteps::new(&rig, start, Method::Stable);
            (1..=(0.5 / step).round() as u32).for_each(|n| steps.advance_to(step * f64::from(n)).expect("a step"));
            let end = steps.sample();
            assert_close(end.hose_pressure.0, exact.hose_pressure.0, 1e-9);
            (end.length - exact.length).abs()
        };
        let (coarse, fine) = (off(5e-5), off(1.25e-5));
        assert!(coarse < 1e-3 && fine < coarse / 6.0, "{coarse:e} {fine:e}");
    }
}

/// Fixed steps come to the event-located engine by the order of the method, with the corners of the pressure inside them.
#[test]
fn it_goes_by_fixed_steps_too() {
    let paper = Paper::sealed().with(|paper| paper.length = InitialLength::At(0.09));
    let rig = given(&paper);
    let start = rig.start(&paper.initial()).expect("a start");
    let exact = RigPlant::new(&rig).simulate(&start, 0.5, 1e-11).expect("a run").at(0.5);
    let off = |step: f64| {
        let mut steps = RigSteps::new(&rig, start, Method::Stable);
        (1..=(0.5 / step).round() as u32).for_each(|n| steps.advance_to(step * f64::from(n)).expect("a step"));
        let end = steps.sample();
        assert!((end.pressure.0 - exact.pressure.0).abs() < 1e-6 * exact.pressure.0);
        (end.length - exact.length).abs()
    };
    let (coarse, fine) = (off(5e-4), off(1.25e-4));
    assert!(coarse < 1e-3 && fine < coarse / 6.0, "{coarse:e} {fine:e}");
}
