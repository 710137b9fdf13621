//! A rig on a proportional pressure regulator: its pressure against the closed form, rest, dead time, rate, flow path,
//! audit, the orders of fixed steps, a batch.

use crate::common::accounts::Audited;
use crate::common::regulated::{Regulated, TimeSeries};
use crate::common::steps::RigSteps;
use crate::common::{ATMOSPHERE, INCH, PSI, Paper, assert_close, assert_within, scaled, seeded, slope};
use mckibben::air::Process;
use mckibben::line::{Hose, HoseKind, Line, Reservoir, SupplyLine};
use mckibben::parameter::{self, Parameter};
use mckibben::plant::{RigPlant, RigTrajectory, TimeStepping};
use mckibben::simulation::{Actuation, EventKind, Method, Rig, State, simulate};
use mckibben::valve::{Command, FlowStandard, Regulator, Request, Solenoid, ValveKind};
use mckibben::{Dual, Error, GaugePressure, Over};

const TAU: f64 = 0.03;
const DEAD: f64 = 5e-3;
const LIMIT: f64 = 2e6;
const TIGHT: f64 = 1e-10;
const CLOSED_FORM: Regulated = Regulated { time_constant: TAU, dead_time: DEAD, rate_limit: LIMIT };

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

fn run(paper: &Paper, regulator: Regulator, command: Command, duration: f64) -> RigTrajectory {
    let rig = rig(paper, regulator, command);
    simulate(&rig, rig.start(&paper.initial()).expect("a start"), duration, TIGHT).expect("a run")
}

/// Both ends held: the volume stays the same.
fn held() -> Paper {
    Paper::sealed().isometric(3.5 * INCH)
}

/// As [`held`], with a flow path through which the actuator follows at once.
fn wide() -> Paper {
    held().with(|rig| rig.standard = FlowStandard::Orifice { flow_area: 2e-4 })
}

fn regulated(run: &RigTrajectory, time: f64) -> f64 {
    run.at(time).supply_pressure.expect("it is regulated").0
}

fn instants(run: &RigTrajectory, kind: EventKind) -> Vec<f64> {
    run.events().iter().filter(|event| event.kind == kind).map(|event| event.time).collect()
}

/// A large step up, a small one that comes while the first is still under way, a large one down.
const STAIRS: ([f64; 3], [f64; 3]) = ([0.02, 0.15, 0.6], [4e5, 4.6e5, 1e5]);

/// What the closed form makes of these, each with its end, up to 1.2 s.
fn segments() -> Vec<(TimeSeries, f64)> {
    let (times, gauges) = STAIRS;
    let segments = CLOSED_FORM.segments(ATMOSPHERE, &times, &gauges.map(|gauge| gauge + ATMOSPHERE));
    let ends = times.iter().skip(1).map(|time| time + DEAD).chain([1.2]);
    segments.into_iter().zip(ends).collect()
}

#[test]
fn the_pressure_follows_the_closed_form() {
    let (times, gauges) = STAIRS;
    let run = run(&wide(), regulator(LIMIT), points(&times, &gauges), 1.2);
    for (series, until) in segments() {
        for n in 0..=50 {
            let time = series.time + (until - series.time) * f64::from(n) / 50.0;
            let expected = CLOSED_FORM.pressure(&series, time);
            assert_close(regulated(&run, time), expected, 1e-9);
            // The flow path is two thousand times as fast as the regulator.
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
fn a_small_flow_path_limits_the_filling_as_that_of_a_three_way_valve() {
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
        &parameter::VALVE_DEAD_TIME,
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
    let (circuit, audit) = (run.circuit(), run.audit());
    assert!(circuit.exergy.residual.abs() < 1e-6 * circuit.exergy.turnover, "{circuit:?}");
    assert!(audit.residual().abs() < 1e-6 * audit.turnover());
    assert!(audit.air_residual().abs() < 1e-7 * audit.air_in);
    // What went out went to the atmosphere: nothing comes back into the supply.
    let supply = 100.0 * PSI + ATMOSPHERE;
    let each = 286.99 * crate::common::ROOM * (supply / ATMOSPHERE).ln();
    assert_close(circuit.total.drawn, audit.air_in * each, 1e-6);
    assert!(audit.air_out > 0.0 && circuit.total.exhaust > 0.0 && circuit.total.throttled > 0.0);
}

#[test]
fn behind_a_lumped_hose_it_is_seen_late_and_comes_to_rest_at_the_set_point() {
    let gas = [1.82e-5, crate::common::ROOM, 1.0];
    let hose = Hose::new(HoseKind::Lumped, [2.0, 2.5e-3], gas, &Paper::sealed().air()).expect("a hose");
    let line = Line { hose: Some(hose), ..Line::NONE };
    let rig = rig(&held(), regulator(LIMIT), points(&[0.1], &[2e5])).with_line(line).expect("a line");
    let run = simulate(&rig, rig.start(&held().initial()).expect("a start"), 3.0, 1e-9).expect("a run");
    assert_eq!(instants(&run, EventKind::SetPoint), [0.1 + (DEAD + hose.transport_delay())]);
    let end = stepped(&rig, start(&rig, &held()), Method::Stable, 0.16, 16_000);
    assert_close(end.pressure.0, run.at(0.16).pressure.0, 1e-4);
    assert_close(run.at(3.0).pressure.0, 2e5 + ATMOSPHERE, 1e-6);
    let exergy = run.circuit().exergy;
    assert!(exergy.residual.abs() < 1e-6 * exergy.turnover, "{exergy:?}");
}

fn start(rig: &Rig, paper: &Paper) -> State {
    rig.start(&paper.initial()).expect("a start")
}

/// In so many equal steps.
fn stepped(rig: &Rig, start: State, method: Method, until: f64, steps: u32) -> State {
    let mut stepper = RigSteps::new(rig, start, method);
    for step in 1..=steps {
        stepper.advance_to(until * (f64::from(step) / f64::from(steps))).expect("a step");
    }
    stepper.state()
}

/// The largest error in Pa of the regulated pressure at the ends of so many steps, up to 1.2 s.
fn off_the_closed_form(method: Method, steps: u32) -> f64 {
    let (times, gauges) = STAIRS;
    let paper = held();
    let rig = rig(&paper, regulator(LIMIT), points(&times, &gauges));
    let mut stepper = RigSteps::new(&rig, start(&rig, &paper), method);
    let mut segments = segments().into_iter().peekable();
    let (mut now, mut worst) = (None, 0.0_f64);
    for step in 1..=steps {
        let time = 1.2 * f64::from(step) / f64::from(steps);
        stepper.advance_to(time).expect("a step");
        while let Some((series, _)) = segments.next_if(|(series, _)| series.time <= time) {
            now = Some(series);
        }
        let expected = now.map_or(ATMOSPHERE, |series| CLOSED_FORM.pressure(&series, time));
        let ours = stepper.sample().supply_pressure.expect("it is regulated").0;
        worst = worst.max((ours - expected).abs());
    }
    assert!(segments.peek().is_none());
    worst
}

/// The rate's limit ends within a step, and set points take effect there: neither costs an order. Of an exponential that falls
/// from `q τ` a step of x = h/τ errs by x⁵/120 of what is left with RK4 and by c x³ with ROS2, c = 2γ³ − 3γ² + 1/6 (see
/// `stable_error`); over a time t that is t/h times as much of `q τ exp(−t/τ)`, which is largest at t = τ.
#[test]
fn fixed_steps_come_to_the_closed_form_at_their_order() {
    let (reach, gamma) = (LIMIT * TAU, 1.0 + 0.5_f64.sqrt());
    let of_stable = 2.0 * gamma.powi(3) - 3.0 * gamma * gamma + 1.0 / 6.0;
    for (method, order, per_step, counts) in
        [(Method::Rk4, 4, 1.0 / 120.0, [300_u32, 600]), (Method::Stable, 2, of_stable, [1200, 2400])]
    {
        let errors = counts.map(|steps| off_the_closed_form(method, steps));
        let fitted = (errors[0] / errors[1]).log2();
        assert!((fitted - f64::from(order)).abs() < 0.2, "{method:?}: order {fitted}, {errors:?}");
        for (steps, error) in counts.into_iter().zip(errors) {
            let bound = per_step * (1.2 / f64::from(steps) / TAU).powi(order) * reach / std::f64::consts::E;
            assert!(error < 1.2 * bound, "{method:?}: {error} Pa above {bound} Pa");
        }
    }
}

/// In the bounds of one piece of the flow law, so that the flow adds no kink: from a vacuum to below the
/// regulated pressure, along the straight line and the exponential.
#[test]
fn fixed_steps_come_to_the_event_located_run_at_their_order() {
    let paper = Paper::sealed().isometric(3.5 * INCH).process(Process::Isothermal).gauge(-4.5e4).with(|rig| {
        rig.standard = FlowStandard::Iso6358 { sonic_conductance: 4e-9, critical_ratio: 0.3 };
    });
    let swift = Regulator::new(8e-3, 4e-3, 5e6).expect("a regulator");
    let rig = rig(&paper, swift, points(&[0.0], &[1.2e5]));
    let run = simulate(&rig, start(&rig, &paper), 0.032, 1e-12).expect("a run");
    assert_eq!([EventKind::Regulator, EventKind::Flow].map(|kind| instants(&run, kind).len()), [1, 0]);
    let exact = run.at(0.032);
    for (method, order, counts) in [(Method::Rk4, 4.0, [64, 128]), (Method::Stable, 2.0, [128, 256])] {
        let errors = counts.map(|steps| {
            let State { pressure, air_mass, .. } = stepped(&rig, start(&rig, &paper), method, 0.032, steps);
            [pressure.0 - exact.pressure.0, air_mass - exact.air_mass].map(f64::abs)
        });
        for n in 0..2 {
            let fitted = (errors[0][n] / errors[1][n]).log2();
            assert!(fitted > order - 0.3, "{method:?}: order {fitted}, {errors:?}");
        }
    }
}

#[test]
fn fixed_steps_agree_where_a_mass_bounces() {
    let paper = Paper::sealed();
    let rig = rig(&paper, regulator(LIMIT), points(&[0.0, 0.1, 0.2], &[4e5, 1e5, 3e5]));
    let exact = simulate(&rig, start(&rig, &paper), 0.3, 1e-11).expect("a run").at(0.3);
    for (method, within) in [(Method::Rk4, 1e-6), (Method::Stable, 1e-4)] {
        let end = stepped(&rig, start(&rig, &paper), method, 0.3, 30_000);
        assert_close(end.pressure.0, exact.pressure.0, within);
        assert_close(end.length, exact.length, within);
    }
}

/// With steps far beyond what the flow path needs, from both sides.
#[test]
fn long_stable_steps_never_overshoot() {
    for gauge in [0.0, 5e5] {
        let paper = held().gauge(gauge);
        let rig = rig(&paper, regulator(LIMIT), points(&[0.0], &[2e5]));
        let (most, least) = (gauge.max(2e5) + ATMOSPHERE, gauge.min(2e5) + ATMOSPHERE);
        for step in [0.02, 0.005, 0.001] {
            let mut stepper = RigSteps::new(&rig, start(&rig, &paper), Method::Stable);
            for n in 1..=(2.0 / step) as u32 {
                stepper.advance_to(step * f64::from(n)).expect("a step");
                let pressure = stepper.state().pressure.0;
                assert!(pressure <= most * (1.0 + 1e-9) && pressure >= least * (1.0 - 1e-9), "{step}: {pressure}");
            }
            assert_close(stepper.state().pressure.0, 2e5 + ATMOSPHERE, 1e-6);
        }
    }
}

#[test]
fn derivatives_of_fixed_steps_are_those_of_finite_differences() {
    let paper = held();
    let rig = rig(&paper, regulator(LIMIT), points(&[0.0, 0.2], &[3e5, 1e5]));
    let rows: [&'static Parameter; 5] = [
        &parameter::REGULATOR_TIME_CONSTANT,
        &parameter::VALVE_DEAD_TIME,
        &parameter::REGULATOR_RATE_LIMIT,
        &parameter::COMMAND_GAUGE_PRESSURE,
        &parameter::COMMAND_TIME,
    ];
    // Set points take effect within steps, and at the ends of steps.
    for count in [2989, 3000] {
        let end = |rig: &Rig| stepped(rig, start(rig, &paper), Method::Stable, 0.3, count).pressure.0;
        for row in rows {
            let seeded = seeded(&rig, row);
            let start = seeded.begin(&paper.initial().map(|_, value| Dual::of(value))).expect("a start");
            let stepping = TimeStepping::Fixed { method: Method::Stable, step: 0.3 / f64::from(count) };
            let run = RigPlant::new(&seeded).simulate(&start, Dual::of(0.3), stepping).expect("a run");
            let exact = run.at(Dual::of(0.3)).pressure.0.slope[0];
            assert_close(exact, slope(1e-4, |relative| end(&scaled(&rig, row, relative))), 1e-3);
        }
    }
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
    let bottle = Reservoir::new([1e-3, 1.0, 293.15], GaugePressure(5e5), None, &paper.air()).expect("a bottle");
    let supply = Some(SupplyLine::new(Some(bottle), None, 1.0).expect("a supply"));
    wrong(rig.with_line(Line { supply, ..Line::NONE }).expect_err("refused"), "behind a reservoir or a regulator");

    let three_way =
        Actuation { solenoid: Solenoid::new(ValveKind::ThreeWay, 0.0, 0.0).expect("a valve"), command: good() };
    let actuator = paper.clone().with(|rig| rig.command = Some(good())).actuator();
    wrong(Rig::new(actuator, Some(three_way), paper.load).expect_err("refused"), "pressure-regulator");
}
