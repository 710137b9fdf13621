//! A rig on a proportional spool: an independent integration, a closed form, edges to the instant, both engines, audits.

use crate::common::accounts::Audited;
use crate::common::steps::RigSteps;
use crate::common::{
    ATMOSPHERE, INCH, PSI, Paper, ROOM, assert_close, assert_within, runge_kutta, scaled, seeded, slope,
};
use mckibben::air::Process;
use mckibben::line::{Hose, HoseKind, Line};
use mckibben::parameter::{self, Parameter};
use mckibben::plant::RigTrajectory;
use mckibben::simulation::{Actuation, EventKind, Method, Rig, State, simulate};
use mckibben::valve::{Command, FlowStandard, Request, Solenoid, Spool, ValveKind};
use mckibben::{Dual, Error, Over};
use std::f64::consts::TAU;

fn spool(frequency: f64, zeta: f64, overlap: f64) -> Spool {
    Spool::new(frequency, zeta, overlap, overlap).expect("a spool")
}

fn positions(time: &[f64], position: &[f64]) -> Command {
    Command::positions(time.to_vec(), position.to_vec()).expect("positions")
}

fn try_rig(paper: &Paper, solenoid: Solenoid, command: Command) -> Result<Rig, Error> {
    let actuator = paper.clone().with(|rig| rig.command = Some(command.clone())).actuator();
    Rig::new(actuator, Some(Actuation { solenoid, command }), paper.load.clone())
}

fn rig(paper: &Paper, spool: Spool, command: Command) -> Rig {
    try_rig(paper, Solenoid::proportional(spool), command).expect("a rig")
}

fn start(rig: &Rig, paper: &Paper) -> State {
    rig.start(&paper.initial()).expect("a start")
}

fn run(paper: &Paper, spool: Spool, command: Command, duration: f64, tolerance: f64) -> RigTrajectory {
    let rig = rig(paper, spool, command);
    simulate(&rig, start(&rig, paper), duration, tolerance).expect("a run")
}

fn stepped(rig: &Rig, paper: &Paper, method: Method, until: f64, steps: u32) -> f64 {
    let mut stepper = RigSteps::new(rig, start(rig, paper), method);
    for step in 1..=steps {
        stepper.advance_to(until * f64::from(step) / f64::from(steps)).expect("a step");
    }
    stepper.state().pressure.0
}

/// Sonic conductance in m³/(s·Pa) and critical ratio.
const FLOW_PATH: (f64, f64) = (6e-10, 0.3);

/// Held ends and air that keeps its temperature.
fn held() -> Paper {
    Paper::sealed().isometric(3.5 * INCH).process(Process::Isothermal).gauge(2e5).with(|rig| {
        rig.standard = FlowStandard::Iso6358 { sonic_conductance: FLOW_PATH.0, critical_ratio: FLOW_PATH.1 };
        rig.efficiency = 1.0;
    })
}

fn valve_events(run: &RigTrajectory) -> Vec<f64> {
    run.events().iter().filter(|event| event.kind == EventKind::Valve).map(|event| event.time).collect()
}

/// A spool that rings over its dead zone, meets a stop and turns: motion, edges and air by the classical Runge–Kutta method
/// in steps that are small relative to everything.
#[test]
fn it_agrees_with_an_independent_integration() {
    for (zeta, overlap) in [(0.2, 0.08), (0.7, -0.15), (1.6, 0.05)] {
        let (frequency, times, targets) = (60.0, [0.0, 0.02, 0.045], [0.12, 0.9, -0.6]);
        let paper = held();
        let until = 0.07;
        let run = run(&paper, spool(frequency, zeta, overlap), positions(&times, &targets), until, 1e-11);
        let (omega, volume) = (TAU * frequency, paper.actuator().volume(3.5 * INCH));
        let supply = paper.supply_gauge + ATMOSPHERE;
        let flow = |upstream: f64, downstream: f64| {
            let r = downstream / upstream;
            let part =
                if r <= FLOW_PATH.1 { 1.0 } else { (1.0 - ((r - FLOW_PATH.1) / (1.0 - FLOW_PATH.1)).powi(2)).sqrt() };
            FLOW_PATH.0 * 1.185 * upstream * part
        };
        let share = |way: f64| ((way - overlap) / (1.0 - overlap)).clamp(0.0, 1.0);
        let steps = 350_000;
        let step = until / f64::from(steps);
        let mut state = [0.0, 0.0, 2e5 + ATMOSPHERE];
        for n in 0..steps {
            let time = step * f64::from(n);
            let commanded = times.iter().rposition(|t| *t <= time + 0.5 * step).map_or(0.0, |row| targets[row]);
            let rates = |[x, v, pressure]: [f64; 3]| {
                let net = share(x) * flow(supply, pressure) - share(-x) * flow(pressure, ATMOSPHERE);
                let acceleration = omega * omega * (commanded - x) - 2.0 * zeta * omega * v;
                [v, acceleration, net * paper.gas_constant * ROOM / volume]
            };
            state = runge_kutta(state, step, |_, state| rates(state));
            if state[0].abs() > 1.0 {
                (state[0], state[1]) = (state[0].signum(), 0.0);
            }
            if (n + 1) % 7000 == 0 {
                assert_close(run.at(step * f64::from(n + 1)).pressure.0, state[2], 2e-6);
            }
        }
    }
}

/// A spool that is fast relative to the air stands where it is commanded: `P = P₀ exp(−λ C ρ₀ T₀ R t/V)` while choked.
#[test]
fn half_open_it_empties_half_as_fast() {
    let paper = held().gauge(7e5);
    let volume = paper.actuator().volume(3.5 * INCH);
    let rate = FLOW_PATH.0 * 1.185 * ROOM * paper.gas_constant / volume;
    let run = run(&paper, spool(1e7, 1.0, 0.2), positions(&[0.0], &[-0.6]), 0.05, 1e-11);
    for time in [0.01, 0.03, 0.05] {
        assert_close(run.at(time).pressure.0, (ATMOSPHERE + 7e5) * (-0.5 * rate * time).exp(), 1e-6);
    }
}

/// Critically damped, `x = u (1 − (1 + ωt) exp(−ωt))`: the supply opens and the exhaust shuts where that passes the edges.
#[test]
fn edges_are_passed_to_the_instant() {
    let (frequency, commanded) = (40.0, 0.7);
    let spool = Spool::new(frequency, 1.0, 0.25, -0.1).expect("a spool");
    let run = run(&held(), spool, positions(&[0.01], &[commanded]), 0.08, 1e-9);
    let events = valve_events(&run);
    let at = |time: f64| {
        let phase = TAU * frequency * (time - 0.01);
        commanded * (1.0 - (1.0 + phase) * (-phase).exp())
    };
    assert_eq!(events[0], 0.01);
    assert_close(at(events[1]), 0.1, 1e-10);
    assert_close(at(events[2]), 0.25, 1e-10);
    let names: Vec<&str> =
        [0.005, events[1] + 1e-6, events[2] + 1e-6].iter().map(|time| run.at(*time).ports.name()).collect();
    assert_eq!(names, ["exhaust", "closed", "supply"]);
    // Nothing flows in the dead zone.
    assert_eq!(run.at(0.5 * (events[1] + events[2])).mass_flow, 0.0);
}

#[test]
fn thrown_from_stop_to_stop_it_is_a_three_way_valve() {
    let command = positions(&[0.0, 0.1], &[1.0, -1.0]);
    let requests = Command::table(vec![0.0, 0.1], vec![Request::Fill, Request::Exhaust]).expect("a table");
    let swift = run(&held(), spool(1e7, 1.0, 0.0), command, 0.2, 1e-10);
    let paper = held().with(|rig| {
        (rig.delays, rig.kind, rig.command) = ((0.0, 0.0), ValveKind::ThreeWay, Some(requests));
    });
    let seats = paper.run(0.2, 1e-10);
    for time in [0.05, 0.1, 0.13, 0.2] {
        assert_close(swift.at(time).pressure.0, seats.at(time).pressure.0, 2e-6);
    }
}

#[test]
fn fixed_steps_come_to_the_event_located_run_at_their_order() {
    // Both flow paths stay choked, so that the flow adds no kink.
    let paper = held();
    let rig = rig(&paper, spool(12.0, 0.5, 0.0), positions(&[0.0], &[0.4]));
    let exact = simulate(&rig, start(&rig, &paper), 0.04, 1e-12).expect("a run");
    let exact = exact.at(0.04).pressure.0;
    for (method, order, counts) in [(Method::Rk4, 4.0, [10, 20]), (Method::Stable, 2.0, [40, 80])] {
        let error = |steps| (stepped(&rig, &paper, method, 0.04, steps) - exact).abs();
        let fitted = (error(counts[0]) / error(counts[1])).log2();
        assert!((fitted - order).abs() < 0.4, "{method:?}: order {fitted}");
    }
    // With edges, stops and a mass that bounces, the same numbers all the same.
    let paper = Paper::sealed();
    let rig = self::rig(&paper, spool(50.0, 0.15, 0.1), positions(&[0.0, 0.1, 0.2], &[0.15, -0.9, 0.6]));
    let exact = simulate(&rig, start(&rig, &paper), 0.3, 1e-11).expect("a run").at(0.3).pressure.0;
    assert_close(stepped(&rig, &paper, Method::Rk4, 0.3, 30_000), exact, 1e-6);
    assert_close(stepped(&rig, &paper, Method::Stable, 0.3, 30_000), exact, 1e-4);
}

#[test]
fn behind_a_hose_it_is_seen_late() {
    let gas = [1.82e-5, ROOM, 1.0];
    let hose = Hose::new(HoseKind::Lumped, [2.0, 2.5e-3], gas, &Paper::sealed().air()).expect("a hose");
    let line = Line { hose: Some(hose), ..Line::NONE };
    let paper = Paper::sealed();
    let rig =
        rig(&paper, spool(60.0, 0.5, 0.0), positions(&[0.03, 0.1], &[0.5, -0.5])).with_line(line).expect("a line");
    let exact = simulate(&rig, start(&rig, &paper), 0.15, 1e-10).expect("a run");
    assert_eq!(valve_events(&exact)[0], 0.03 + hose.transport_delay());
    assert_close(stepped(&rig, &paper, Method::Stable, 0.15, 15_000), exact.at(0.15).pressure.0, 1e-4);
}

#[test]
fn the_audits_close() {
    let command = positions(&[0.0, 0.1, 0.25], &[0.5, -0.2, 0.8]);
    for overlap in [0.1, -0.1] {
        let run = run(&Paper::sealed(), spool(50.0, 0.3, overlap), command.clone(), 0.4, 1e-10);
        let (circuit, audit) = (run.circuit(), run.audit());
        assert!(circuit.exergy.residual.abs() < 1e-6 * circuit.exergy.turnover, "{circuit:?}");
        assert!(audit.residual().abs() < 1e-6 * audit.turnover());
        assert!(audit.air_residual().abs() < 1e-7 * audit.air_in);
    }
}

#[test]
fn derivatives_are_those_of_finite_differences() {
    let paper = held();
    let rig = rig(&paper, spool(30.0, 0.25, 0.05), positions(&[0.0, 0.03], &[0.9, -0.3]));
    let end = |rig: &Rig| simulate(rig, start(rig, &paper), 0.06, 1e-11).expect("a run").at(0.06).pressure.0;
    let rows: [&'static Parameter; 5] = [
        &parameter::SPOOL_FREQUENCY,
        &parameter::SPOOL_DAMPING_RATIO,
        &parameter::SUPPLY_OVERLAP,
        &parameter::EXHAUST_OVERLAP,
        &parameter::COMMAND_TIME,
    ];
    for row in rows {
        let seeded = seeded(&rig, row);
        let start = seeded.begin(&paper.initial().map(|_, value| Dual::of(value))).expect("a start");
        let run = simulate(&seeded, start, Dual::of(0.06), 1e-11).expect("a run");
        let differences = slope(1e-4, |relative| end(&scaled(&rig, row, relative)));
        assert_close(run.at(Dual::of(0.06)).pressure.0.slope[0], differences, 1e-4);
    }
}

#[test]
fn what_has_no_meaning_is_refused() {
    let paper = held();
    let wrong = |error: Error, word: &str| assert!(error.to_string().contains(word), "{error}");
    let spooled = || Solenoid::proportional(spool(50.0, 0.7, 0.0));
    let seats = Solenoid::new(ValveKind::ThreeWay, 0.0, 0.0).expect("a valve");
    wrong(try_rig(&paper, spooled(), Command::Constant(Request::Fill)).expect_err("refused"), "positions");
    wrong(try_rig(&paper, seats, positions(&[0.0], &[0.5])).expect_err("refused"), "proportional-spool");
    wrong(Command::positions(vec![0.0], vec![1.5]).expect_err("refused"), "command.position = 1.5");
    wrong(Command::positions(vec![0.0, 1.0], vec![0.5]).expect_err("refused"), "entry 2");
    wrong(Command::positions(vec![1.0, 0.0], vec![0.5; 2]).expect_err("refused"), "do not rise");
}

/// A supply above the paper's does not change where the spool rests without a command: in the middle.
#[test]
fn before_the_first_position_it_rests_in_the_middle() {
    let run = run(&held(), spool(50.0, 0.7, 0.1), positions(&[0.5], &[1.0]), 0.6, 1e-9);
    assert_close(run.at(0.5).pressure.0, 2e5 + ATMOSPHERE, 1e-12);
    assert!(run.at(0.6).pressure.0 > 3e5 && run.at(0.6).pressure.0 <= 100.0 * PSI + ATMOSPHERE);
    assert_within(run.at(0.3).mass_flow, 0.0, 0.0);
}
