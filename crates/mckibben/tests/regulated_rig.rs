//! A rig on a proportional pressure regulator: its pressure against the closed form, rest, dead time, rate, passage, audit.

use crate::common::{ATMOSPHERE, INCH, PSI, Paper, assert_close, assert_within, scaled, seeded, slope};
use mckibben::line::{Hose, HoseKind, Line, Reservoir, SupplyLine};
use mckibben::parameter::{self, Parameter};
use mckibben::simulation::{Actuation, EventKind, FixedStepper, Method, Rig, Trajectory, simulate};
use mckibben::valve::{Command, FlowStandard, Regulated, Regulator, Request, Solenoid, ValveKind};
use mckibben::{AbsolutePressure, Dual, Error, GaugePressure, Over};

const TAU: f64 = 0.03;
const DEAD: f64 = 5e-3;
const LIMIT: f64 = 2e6;
const TIGHT: f64 = 1e-10;

fn regulator(limit: f64) -> Regulator {
    Regulator::new(TAU, DEAD, limit).expect("a regulator")
}

fn points(time: &[f64], gauge: &[f64]) -> Command {
    Command::set_points(time.to_vec(), gauge.to_vec()).expect("set points")
}

fn try_rig(paper: &Paper, regulator: Regulator, command: Command) -> Result<Rig, Error> {
    let actuator = paper.clone().with(|rig| rig.command = Some(command.clone())).actuator();
    Rig::new(actuator, Some(Actuation { solenoid: Solenoid::regulating(regulator), command }), paper.load.clone())
}

fn rig(paper: &Paper, regulator: Regulator, command: Command) -> Rig {
    try_rig(paper, regulator, command).expect("a rig")
}

fn run(paper: &Paper, regulator: Regulator, command: Command, duration: f64) -> Trajectory {
    let rig = rig(paper, regulator, command);
    simulate(&rig, rig.start(&paper.initial()).expect("a start"), duration, TIGHT).expect("a run")
}

/// Both ends held: the volume stays the same.
fn held() -> Paper {
    Paper::sealed().isometric(3.5 * INCH)
}

/// As [`held`], with a passage through which the actuator follows at once.
fn wide() -> Paper {
    held().with(|rig| rig.standard = FlowStandard::Orifice { flow_area: 2e-4 })
}

fn regulated(run: &Trajectory, time: f64) -> f64 {
    run.at(time).supply_pressure.expect("it is regulated").0
}

fn instants(run: &Trajectory, kind: EventKind) -> Vec<f64> {
    run.events().iter().filter(|event| event.kind == kind).map(|event| event.time).collect()
}

/// A large step up, a small one that comes while the first is still under way, a large one down.
#[test]
fn the_pressure_follows_the_closed_form() {
    let (times, gauges) = ([0.02, 0.15, 0.6], [4e5, 4.6e5, 1e5]);
    let paper = wide();
    let run = run(&paper, regulator(LIMIT), points(&times, &gauges), 1.2);
    let valve = paper.with(|rig| rig.command = Some(Command::Constant(Request::Fill))).valve();
    let at_rest = AbsolutePressure(ATMOSPHERE);
    let mut course = Regulated { time: 0.0, pressure: at_rest, setpoint: at_rest };
    for step in 0..times.len() {
        course = regulator(LIMIT).set(&course, times[step], AbsolutePressure(gauges[step] + ATMOSPHERE), &valve);
        let until = times.get(step + 1).map_or(1.2, |time| time + DEAD);
        for n in 0..=50 {
            let time = course.time + (until - course.time) * f64::from(n) / 50.0;
            let expected = regulator(LIMIT).pressure(&course, time);
            assert_close(regulated(&run, time), expected, 1e-9);
            // The passage is two thousand times as fast as the regulator.
            assert_within(run.at(time).pressure.0, expected, 2e-3 * ATMOSPHERE);
        }
    }
    assert_eq!(instants(&run, EventKind::SetPoint).len(), 3);
}

#[test]
fn it_comes_to_rest_at_the_set_point_from_both_sides() {
    for gauge in [0.0, 2e5, 5e5] {
        let run = run(&held().gauge(gauge), regulator(LIMIT), points(&[0.0], &[2e5]), 3.0);
        assert_close(run.at(3.0).pressure.0, 2e5 + ATMOSPHERE, 1e-7);
        let (most, least) = (gauge.max(2e5) + ATMOSPHERE, gauge.min(2e5) + ATMOSPHERE);
        for sample in run.samples(5e-3) {
            assert!(sample.pressure.0 <= most * (1.0 + 1e-8) && sample.pressure.0 >= least * (1.0 - 1e-8));
        }
    }
}

#[test]
fn a_set_point_acts_after_the_dead_time_to_the_instant() {
    let run = run(&held().gauge(1e5), regulator(LIMIT), points(&[0.05, 0.3], &[1.2e5, 3e5]), 0.5);
    assert_eq!(instants(&run, EventKind::SetPoint), [0.05 + DEAD, 0.3 + DEAD]);
    for time in [0.0, 0.03, 0.05 + DEAD] {
        assert_close(regulated(&run, time), 1e5 + ATMOSPHERE, 1e-14);
        assert_close(run.at(time).pressure.0, 1e5 + ATMOSPHERE, 1e-9);
    }
    let soon = 1e-6;
    assert_close(regulated(&run, 0.05 + DEAD + soon) - 1e5 - ATMOSPHERE, 2e4 * soon / TAU, 1e-3);
}

/// Beyond `q τ` of the set point the pressure rises by q; the limit ends where they meet.
#[test]
fn a_limited_rate_is_exactly_that() {
    let limit = 1e6;
    let run = run(&held(), regulator(limit), points(&[0.0], &[4e5]), 1.0);
    let end = DEAD + 4e5 / limit - TAU;
    for share in [0.1, 0.5, 1.0] {
        let time = DEAD + share * (end - DEAD);
        assert_close(regulated(&run, time), ATMOSPHERE + limit * (time - DEAD), 1e-12);
    }
    let ends = instants(&run, EventKind::Regulator);
    assert_eq!(ends.len(), 1);
    assert_close(ends[0], end, 1e-12);
}

/// A regulator of no inertia is a supply at its set point.
#[test]
fn a_small_passage_limits_the_filling_as_that_of_a_three_way_valve() {
    let small = |paper: Paper| {
        paper.with(|rig| {
            rig.standard = FlowStandard::Iso6358 { sonic_conductance: 2e-10, critical_ratio: 0.3 };
            rig.delays = (0.0, 0.0);
            rig.kind = ValveKind::ThreeWay;
        })
    };
    let swift = Regulator::new(1e-7, 0.0, 1e15).expect("a regulator");
    let regulated = run(&small(held()), swift, points(&[0.0], &[3e5]), 0.3);
    let filled = small(Paper::driven(Command::Constant(Request::Fill)).isometric(3.5 * INCH))
        .with(|rig| rig.supply_gauge = 3e5)
        .run(0.3, TIGHT);
    for time in [0.02, 0.1, 0.2, 0.3] {
        assert_close(regulated.at(time).pressure.0, filled.at(time).pressure.0, 1e-5);
    }
    assert!(filled.at(0.02).pressure.0 < 2.5e5);
}

#[test]
fn derivatives_are_those_of_finite_differences() {
    let paper = Paper::sealed();
    let rig = rig(&paper, regulator(LIMIT), points(&[0.0, 0.2], &[3e5, 1e5]));
    let end = |rig: &Rig| {
        let run = simulate(rig, rig.start(&paper.initial()).expect("a start"), 0.35, 1e-11).expect("a run");
        [run.at(0.35).length, run.at(0.35).pressure.0]
    };
    let rows: [&'static Parameter; 4] = [
        &parameter::REGULATOR_TIME_CONSTANT,
        &parameter::REGULATOR_DEAD_TIME,
        &parameter::REGULATOR_RATE_LIMIT,
        &parameter::COMMAND_GAUGE_PRESSURE,
    ];
    for row in rows {
        let seeded = seeded(&rig, row);
        let start = seeded.begin(&paper.initial().map(|_, value| Dual::of(value))).expect("a start");
        let run = simulate(&seeded, start, Dual::of(0.35), 1e-11).expect("a run");
        let exact = [run.at(Dual::of(0.35)).length.slope[0], run.at(Dual::of(0.35)).pressure.0.slope[0]];
        for (n, exact) in exact.into_iter().enumerate() {
            let differences = slope(1e-4, |relative| end(&scaled(&rig, row, relative))[n]);
            assert_close(exact, differences, 2e-4);
        }
    }
}

#[test]
fn the_audits_close() {
    let run = run(&Paper::sealed(), regulator(LIMIT), points(&[0.0, 0.4, 0.8], &[4e5, 1e5, 3e5]), 1.2);
    let audit = run.circuit().expect("a circuit");
    assert!(audit.residual().abs() < 1e-6 * audit.turnover(), "{audit:?}");
    assert!(audit.work.residual().abs() < 1e-6 * audit.work.turnover());
    assert!(audit.work.air_residual().abs() < 1e-7 * audit.work.air_in);
    // What went out went to the surroundings: nothing comes back into the supply.
    let supply = 100.0 * PSI + ATMOSPHERE;
    let each = 286.99 * crate::common::ROOM * (supply / ATMOSPHERE).ln();
    assert_close(audit.drawn, audit.work.air_in * each, 1e-6);
    assert!(audit.work.air_out > 0.0 && audit.exhaust > 0.0 && audit.throttled > 0.0);
}

#[test]
fn behind_a_lumped_hose_it_is_seen_late_and_comes_to_rest_at_the_set_point() {
    let gas = [1.82e-5, crate::common::ROOM, 1.0];
    let hose = Hose::new(HoseKind::Lumped, [2.0, 2.5e-3], gas, &Paper::sealed().air()).expect("a hose");
    let line = Line { hose: Some(hose), ..Line::NONE };
    let rig = rig(&held(), regulator(LIMIT), points(&[0.1], &[2e5])).with_line(line).expect("a line");
    let run = simulate(&rig, rig.start(&held().initial()).expect("a start"), 3.0, 1e-9).expect("a run");
    assert_eq!(instants(&run, EventKind::SetPoint), [0.1 + (DEAD + hose.transport_delay())]);
    assert_close(run.at(3.0).pressure.0, 2e5 + ATMOSPHERE, 1e-6);
    assert!(run.circuit().is_none());
}

#[test]
fn what_has_no_meaning_is_refused() {
    let (paper, good) = (held(), || points(&[0.0], &[2e5]));
    let wrong = |error: Error, word: &str| assert!(error.to_string().contains(word), "{error}");
    let beyond = try_rig(&paper, regulator(LIMIT), points(&[0.0, 1.0], &[2e5, 8e5])).expect_err("refused");
    wrong(beyond, "command.gauge_pressure = 800000 Pa contradicts");
    assert!(try_rig(&paper, regulator(LIMIT), points(&[0.0], &[paper.supply_gauge])).is_ok());
    wrong(try_rig(&paper, regulator(LIMIT), Command::Constant(Request::Fill)).expect_err("refused"), "set-points");
    wrong(Command::set_points(vec![0.0, 1.0], vec![1e5]).expect_err("refused"), "entry 2");
    wrong(Command::set_points(vec![0.0], vec![-1e5]).expect_err("refused"), "command.gauge_pressure = -100000");
    wrong(Command::set_points(vec![1.0, 1.0], vec![1e5; 2]).expect_err("refused"), "do not rise");

    let rig = rig(&paper, regulator(LIMIT), good());
    let start = rig.start(&paper.initial()).expect("a start");
    let stepped = FixedStepper::new(&rig, start, Method::Stable).advance_to(1e-3).expect_err("refused");
    wrong(stepped, "event-located");
    let bottle = Reservoir::new([1e-3, 1.0, 293.15], GaugePressure(5e5), None, &paper.air()).expect("a bottle");
    let supply = Some(SupplyLine::new(Some(bottle), None, 1.0).expect("a supply"));
    wrong(rig.with_line(Line { supply, ..Line::NONE }).expect_err("refused"), "supply must be constant");

    let three_way =
        Actuation { solenoid: Solenoid::new(ValveKind::ThreeWay, 0.0, 0.0).expect("a valve"), command: good() };
    let actuator = paper.clone().with(|rig| rig.command = Some(good())).actuator();
    wrong(Rig::new(actuator, Some(three_way), paper.load).expect_err("refused"), "pressure-regulator");
}
