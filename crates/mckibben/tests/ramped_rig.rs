//! A rig whose valve's poppets take their time: a closed form, an independent integration, both engines, batches, audits.

use crate::common::accounts::Audited;
use crate::common::steps::RigSteps;
use crate::common::{ATMOSPHERE, INCH, Paper, ROOM, assert_close, assert_within, runge_kutta, scaled, seeded, slope};
use mckibben::air::Process;
use mckibben::line::{Hose, HoseKind, Line};
use mckibben::parameter::{self, Parameter};
use mckibben::plant::{Plant, PlantRun, RigTrajectory};
use mckibben::simulation::{Actuation, EventKind, Method, Rig, simulate};
use mckibben::valve::{Command, FlowStandard, Ramp, Request, Solenoid, ValveKind};
use mckibben::{Dual, Over};

const RISE: f64 = 6e-3;
const FALL: f64 = 9e-3;

fn ramped(paper: &Paper, times: [f64; 2]) -> Rig {
    let solenoid = Solenoid::new(paper.kind, paper.delays.0, paper.delays.1).expect("a solenoid");
    let solenoid = solenoid.with_ramp(Ramp::new(times[0], times[1]).expect("a ramp"));
    let command = paper.command.clone().expect("a command");
    Rig::new(paper.actuator(), Some(Actuation { solenoid, command }), paper.load.clone()).expect("a rig")
}

fn run(paper: &Paper, times: [f64; 2], duration: f64, tolerance: f64) -> RigTrajectory {
    simulate(&ramped(paper, times), paper.start(), duration, tolerance).expect("a run")
}

fn stepped(rig: &Rig, paper: &Paper, method: Method, until: f64, steps: u32) -> [f64; 4] {
    let mut stepper = RigSteps::new(rig, paper.start(), method);
    for step in 1..=steps {
        stepper.advance_to(until * f64::from(step) / f64::from(steps)).expect("a step");
    }
    let state = stepper.state();
    [state.length, state.velocity, state.pressure.0, state.air_mass]
}

/// Sonic conductance in m³/(s·Pa).
const CONDUCTANCE: f64 = 3e-9;

/// A held actuator at 7 bar that begins to vent at the start.
fn venting() -> Paper {
    let paper = Paper::driven(Command::Constant(Request::Exhaust)).isometric(3.5 * INCH).process(Process::Isothermal);
    paper.gauge(7e5).with(|rig| {
        rig.kind = ValveKind::FillHoldExhaust;
        rig.standard = FlowStandard::Iso6358 { sonic_conductance: CONDUCTANCE, critical_ratio: 0.4 };
        rig.efficiency = 1.0;
    })
}

/// While choked, `d ln P/dt = −λ C ρ₀ T₀ R/V`, and the integral of λ is a parabola, then a straight line.
#[test]
fn an_opening_seat_empties_by_the_exponential_of_a_parabola() {
    let paper = venting();
    let volume = paper.actuator().volume(3.5 * INCH);
    let rate = CONDUCTANCE * 1.185 * ROOM * paper.gas_constant / volume;
    let (opens, rise) = (paper.delays.0, 12e-3);
    let expected = |time: f64| {
        let since = (time - opens).clamp(0.0, rise);
        let area = since * since / (2.0 * rise) + (time - opens - rise).max(0.0);
        (ATMOSPHERE + 7e5) * (-rate * area).exp()
    };
    let rig = ramped(&paper, [rise, 0.0]);
    let until = 30e-3;
    assert!(expected(until) * 0.4 > ATMOSPHERE, "it is choked all the time");
    let located = simulate(&rig, paper.start(), until, 1e-11).expect("a run");
    for n in 0..=30 {
        let time = 1e-3 * f64::from(n);
        assert_close(located.at(time).pressure.0, expected(time), 1e-9);
    }
    let valve: Vec<f64> =
        located.events().iter().filter(|event| event.kind == EventKind::Valve).map(|event| event.time).collect();
    assert_eq!(valve, [opens, opens + rise]);
    for (method, tolerance) in [(Method::Rk4, 1e-9), (Method::Stable, 1e-6)] {
        assert_close(stepped(&rig, &paper, method, until, 3000)[2], expected(until), tolerance);
    }
}

/// Three-way: while the poppet is under way air goes from the supply to the atmosphere too. ISO 6358 written out, by the
/// classical Runge–Kutta method in small steps between the corners of the opening.
#[test]
fn both_flow_paths_of_a_three_way_valve_agree_with_an_independent_integration() {
    let (conductance, ratio) = (2e-9, 0.3);
    let command = Command::table(vec![0.0, 10e-3, 13e-3], vec![Request::Fill, Request::Exhaust, Request::Fill]);
    let paper = Paper::driven(command.expect("a table")).isometric(3.5 * INCH).process(Process::Isothermal);
    let paper = paper.gauge(1e5).with(|rig| {
        rig.standard = FlowStandard::Iso6358 { sonic_conductance: conductance, critical_ratio: ratio };
        rig.efficiency = 1.0;
        rig.delays = (1e-3, 2e-3);
    });
    let (volume, supply) = (paper.actuator().volume(3.5 * INCH), paper.supply_gauge + ATMOSPHERE);
    // Up from 1 ms for 6 ms; back from 12 ms for 9 ms, but sent up again at 14 ms where it has come down by 2/9.
    let corners = [1e-3, 7e-3, 12e-3, 14e-3, 14e-3 + RISE * 2.0 / 9.0, 20e-3];
    let opening = |piece: usize, time: f64| match piece {
        0 => (time - 1e-3) / RISE,
        1 | 4 => 1.0,
        2 => 1.0 - (time - 12e-3) / FALL,
        _ => 7.0 / 9.0 + (time - 14e-3) / RISE,
    };
    let flow = |upstream: f64, downstream: f64| {
        let r = downstream / upstream;
        let part = if r <= ratio { 1.0 } else { (1.0 - ((r - ratio) / (1.0 - ratio)).powi(2)).sqrt() };
        conductance * 1.185 * upstream * part
    };
    let rate = |share: f64, pressure: f64| {
        let net = share * flow(supply, pressure) - (1.0 - share) * flow(pressure, ATMOSPHERE);
        net * paper.gas_constant * ROOM / volume
    };
    let run = run(&paper, [RISE, FALL], 20e-3, 1e-11);
    let mut pressure = run.at(1e-3).pressure.0;
    for piece in 0..corners.len() - 1 {
        let (from, until) = (corners[piece], corners[piece + 1]);
        let step = (until - from) / 2000.0;
        for n in 0..2000 {
            let time = from + step * f64::from(n);
            [pressure] =
                runge_kutta([pressure], step, |since, [pressure]| [rate(opening(piece, time + since), pressure)]);
        }
        assert_close(run.at(until).pressure.0, pressure, 1e-8);
    }
    let instants: Vec<f64> =
        run.events().iter().filter(|event| event.kind == EventKind::Valve).map(|event| event.time).collect();
    assert_eq!(instants.len(), 5, "{instants:?}");
    for (instant, corner) in instants.iter().zip(corners) {
        assert_close(*instant, corner, 1e-14);
    }
}

#[test]
fn without_times_nothing_changes_and_short_ones_change_little() {
    let paper = Paper::pwm(20.0, 0.6);
    let bits =
        |run: &RigTrajectory| -> Vec<u64> { run.samples(1e-3).map(|sample| sample.pressure.0.to_bits()).collect() };
    let plain = paper.run(0.3, 1e-9);
    assert_eq!(bits(&run(&paper, [0.0, 0.0], 0.3, 1e-9)), bits(&plain));
    let end = |times| run(&paper, times, 0.3, 1e-11).at(0.3).pressure.0;
    let (exact, apart) = (end([0.0, 0.0]), |by: f64| end([by, by]));
    let (coarse, fine) = (apart(4e-6) - exact, apart(2e-6) - exact);
    assert!(fine.abs() < 1e-4 * exact);
    assert_within(coarse / fine, 2.0, 0.05);
}

/// A pulse shifted by half a ramp each way passes as much at a constant flow: choked filling of a large volume.
#[test]
fn a_pulse_passes_as_much_as_one_half_a_ramp_late() {
    let pulse = |times: [f64; 2], delays: (f64, f64)| {
        let command = Command::table(vec![0.0, 30e-3], vec![Request::Fill, Request::Hold]).expect("a table");
        let paper = Paper::driven(command).isometric(3.5 * INCH).process(Process::Isothermal).with(|rig| {
            rig.kind = ValveKind::TwoWay;
            rig.delays = delays;
            rig.standard = FlowStandard::Iso6358 { sonic_conductance: 1e-11, critical_ratio: 0.5 };
        });
        run(&paper, times, 0.06, 1e-11).at(0.06).air_mass
    };
    let late = pulse([0.0, 0.0], (4e-3 + RISE / 2.0, 1e-3 + FALL / 2.0));
    assert_close(pulse([RISE, FALL], (4e-3, 1e-3)), late, 1e-12);
}

#[test]
fn fixed_steps_come_to_the_event_located_run_at_their_order() {
    for process in [Process::Isentropic, Process::Isothermal] {
        // Both flow paths stay choked, so that the flow adds no kink.
        let paper = slow(Paper::pwm(20.0, 0.6)).isometric(3.5 * INCH).process(process).gauge(2e5);
        // All instants lie on the grid of the longest step, so that half the step halves every part.
        let paper = paper.with(|rig| rig.delays = (5e-3, 5e-3));
        let rig = ramped(&paper, [10e-3, 10e-3]);
        let exact = simulate(&rig, paper.start(), 0.1, 1e-12).expect("a run").at(0.1).pressure.0;
        for (method, order, counts) in [(Method::Rk4, 4.0, [20, 40]), (Method::Stable, 2.0, [80, 160])] {
            let error = |steps| (stepped(&rig, &paper, method, 0.1, steps)[2] - exact).abs();
            let fitted = (error(counts[0]) / error(counts[1])).log2();
            assert!(fitted > order - 0.35, "{method:?} {process:?}: order {fitted}");
            assert!(error(counts[1]) < 2e-4 * exact);
        }
    }
}

/// At steps far beyond the time in which the air settles, a poppet that has just begun to move lets it overshoot by little.
#[test]
fn the_stable_method_stays_stable_while_a_port_opens() {
    let paper = Paper::driven(Command::Constant(Request::Fill)).isometric(3.5 * INCH).with(|rig| {
        rig.standard = FlowStandard::Orifice { flow_area: 2e-5 };
    });
    let supply = paper.supply_gauge + ATMOSPHERE;
    for (kind, share) in [(ValveKind::ThreeWay, 0.0), (ValveKind::TwoWay, 0.0), (ValveKind::TwoWay, 0.99)] {
        let paper = paper.clone().gauge(share * paper.supply_gauge).with(|rig| rig.kind = kind);
        let rig = ramped(&paper, [20e-3, 0.0]);
        for steps in [3, 10, 30] {
            let mut stepper = RigSteps::new(&rig, paper.start(), Method::Stable);
            for step in 1..=steps {
                stepper.advance_to(0.1 * f64::from(step) / f64::from(steps)).expect("a step");
                assert!(stepper.state().pressure.0 <= 1.1 * supply, "{} Pa", stepper.state().pressure.0);
            }
            assert_close(stepper.state().pressure.0, supply, 2e-2);
        }
    }
}

#[test]
fn behind_a_hose_both_engines_agree() {
    let gas = [1.82e-5, ROOM, 1.0];
    let hose = Hose::new(HoseKind::Lumped, [2.0, 2.5e-3], gas, &Paper::sealed().air()).expect("a hose");
    let line = Line { hose: Some(hose), ..Line::NONE };
    let paper = Paper::pwm(20.0, 0.6);
    let rig = ramped(&paper, [RISE, FALL]).with_line(line).expect("a line");
    let exact = simulate(&rig, paper.start(), 0.2, 1e-10).expect("a run").at(0.2);
    for (method, tolerance) in [(Method::Rk4, 1e-6), (Method::Stable, 1e-4)] {
        assert_close(stepped(&rig, &paper, method, 0.2, 20_000)[2], exact.pressure.0, tolerance);
    }
}

#[test]
fn the_audits_close() {
    let run = run(&Paper::pwm(20.0, 0.6), [RISE, FALL], 0.4, 1e-10);
    let (circuit, audit) = (run.circuit(), run.audit());
    assert!(circuit.exergy.residual.abs() < 1e-6 * circuit.exergy.turnover, "{circuit:?}");
    assert!(audit.air_residual().abs() < 1e-7 * audit.air_in);
    // Samples show the flow that the audit counts.
    let mut flowed = 0.0;
    run.quadrature(|weight, sample, _| flowed += weight * sample.mass_flow);
    assert_close(flowed, audit.air_gain, 1e-6);
}

/// A tenth of the flow area: the pressure is far from settled when the run ends.
fn slow(paper: Paper) -> Paper {
    paper.with(|rig| rig.standard = FlowStandard::Orifice { flow_area: 1.67e-7 })
}

#[test]
fn derivatives_are_those_of_finite_differences() {
    let paper = slow(Paper::pwm(20.0, 0.6));
    let rig = ramped(&paper, [RISE, FALL]);
    let end = |rig: &Rig| simulate(rig, paper.start(), 0.13, 1e-11).expect("a run").at(0.13).pressure.0;
    let rows: [&'static Parameter; 3] = [&parameter::OPENING_TIME, &parameter::CLOSING_TIME, &parameter::OPENING_DELAY];
    for row in rows {
        let seeded = seeded(&rig, row);
        let start = seeded.begin(&paper.initial().map(|_, value| Dual::of(value))).expect("a start");
        let run = simulate(&seeded, start, Dual::of(0.13), 1e-11).expect("a run");
        let differences = slope(1e-4, |relative| end(&scaled(&rig, row, relative)));
        assert_close(run.at(Dual::of(0.13)).pressure.0.slope[0], differences, 1e-4);
    }
}

/// Two coils that are released and energised at once move their poppets in one instant, each with its own delay: the instants have
/// derivatives of their own.
#[test]
fn coils_that_move_in_one_instant_have_a_derivative_each() {
    let command = Command::table(vec![0.01, 0.05], vec![Request::Fill, Request::Exhaust]).expect("a command");
    let paper =
        slow(Paper::driven(command)).with(|rig| (rig.kind, rig.delays) = (ValveKind::FillHoldExhaust, (3e-3, 3e-3)));
    for times in [[0.0; 2], [4e-3; 2]] {
        let rig = ramped(&paper, times);
        let end = |rig: &Rig| simulate(rig, paper.start(), 0.1, 1e-11).expect("a run").at(0.1).pressure.0;
        let rows: [&'static Parameter; 2] = [&parameter::OPENING_DELAY, &parameter::CLOSING_DELAY];
        let ramps: [&'static Parameter; 2] = [&parameter::OPENING_TIME, &parameter::CLOSING_TIME];
        for row in rows.into_iter().chain(ramps).take(if times[0] > 0.0 { 4 } else { 2 }) {
            let seeded = seeded(&rig, row);
            let start = seeded.begin(&paper.initial().map(|_, value| Dual::of(value))).expect("a start");
            let run = simulate(&seeded, start, Dual::of(0.1), 1e-11).expect("a run");
            let difference = slope(1e-4, |relative| end(&scaled(&rig, row, relative)));
            let found = run.at(Dual::of(0.1)).pressure.0.slope[0];
            assert!(
                (found - difference).abs() < 1e-4 * difference.abs(),
                "{} at {times:?}: {found} for {difference}",
                row.key
            );
        }
    }
}

/// Poppets take their time where a host moves the ends, too.
#[test]
fn ends_that_a_host_moves_take_it() {
    let paper = Paper::driven(Command::Constant(Request::Fill)).isometric(3.5 * INCH);
    let rig = ramped(&paper, [RISE, FALL]);
    let plant = Plant::of_rig(&rig);
    let (plant, start) = plant.to_external(&Plant::start_of_rig(&rig, &paper.start())).expect("a plant");
    let mut steps = PlantRun::new(&plant, &start, 1e-9).expect("a run").steps(Method::Stable);
    steps.set(0, Request::Fill).expect("a request");
    for step in 1..=20 {
        steps.move_to(1e-3 * f64::from(step), &[3.5 * INCH]).expect("a step");
    }
    let own = stepped(&rig, &paper, Method::Stable, 20e-3, 20);
    assert_close(steps.state()[plant.indices().actuators[0].pressure], own[2], 1e-12);
}

/// On average a poppet that takes its time passes as much as one that jumps half of that later.
#[test]
fn its_mean_flow_is_that_of_a_later_seat() {
    use mckibben::linearize::{Aim, Content, linearize_driven};
    let (rise, fall) = (2e-3, 1.5e-3);
    let paper = Paper::pwm(20.0, 0.6).with(|rig| rig.delays = (3e-3, 2e-3));
    let later = paper.clone().with(|rig| rig.delays = (3e-3 + 0.5 * rise, 2e-3 + 0.5 * fall));
    let model =
        |rig: &Rig| linearize_driven(rig, Aim::Duty(0.5), Content::Temperature(ROOM)).expect("a model").minimal();
    let (ramped, later) = (model(&ramped(&paper, [rise, fall])), model(&later.rig()));
    for (ours, theirs) in [(&ramped.a, &later.a), (&ramped.b, &later.b), (&ramped.c, &later.c)] {
        for (ours, theirs) in ours.iter().flatten().zip(theirs.iter().flatten()) {
            assert_within(*ours, *theirs, 1e-8 * theirs.abs());
        }
    }
}
