//! A simulated rig: equilibria, small oscillations, energy, sampling, and derivatives through the whole of it.

use crate::common::{ATMOSPHERE, GRAVITY, INCH, LB, LBF, PSI, Paper, assert_close, assert_within, bisect};
use mckibben::air::Process;
use mckibben::load::{Load, Motion};
use mckibben::parameter;
use mckibben::plant::RigTrajectory;
use mckibben::simulation::{EventKind, InitialLength, simulate};
use mckibben::valve::{Command, Request, ValveKind};
use mckibben::{Error, Over};
use std::f64::consts::{PI, TAU};

#[test]
fn the_equilibrium_is_where_equation_3_balances_the_weight() {
    for (gauge, pounds) in [(60.0 * PSI, 6.0), (80.0 * PSI, 11.0), (100.0 * PSI, 15.0), (3e5, 0.1)] {
        let paper = Paper::sealed().mass(pounds * LB).gauge(gauge);
        let closed = paper.balance(pounds * LB * GRAVITY);
        assert!(closed < paper.max_length);
        assert_close(paper.start().length, closed, 1e-14);
    }
    // A constant force is balanced the same way.
    let paper = Paper::sealed().gauge(3e5).with(|rig| rig.load = Load::ConstantForce { mass: 2.0, force: 40.0 });
    assert_close(paper.start().length, paper.balance(40.0), 1e-14);
}

#[test]
fn without_pressure_the_load_hangs_on_the_taut_braid() {
    for mass in [0.1, 2.0, 15.0 * LB] {
        let paper = Paper::sealed().mass(mass);
        let closed = paper.max_length + mass * GRAVITY / paper.limit_stiffness;
        assert_close(paper.start().length, closed, 1e-14);
    }
    // With a little pressure: a quadratic in L, solved here by bisection.
    let paper = Paper::sealed().mass(5.0).gauge(2e4);
    let (b, n) = (paper.thread_length, paper.turns);
    let surplus =
        |l: f64| 2e4 * (3.0 * l * l - b * b) / (4.0 * PI * n * n) + 1.75e5 * (l - paper.max_length) - 5.0 * GRAVITY;
    assert!(surplus(paper.max_length) < 0.0);
    assert_close(paper.start().length, bisect(paper.max_length, b, surplus), 1e-14);
}

#[test]
fn loads_without_an_equilibrium_say_so() {
    let no = |paper: Paper| match paper.rig().start(&paper.initial()) {
        Err(error @ Error::NoSolution { .. }) => error.to_string(),
        other => panic!("{other:?}"),
    };
    let isometric = Paper::sealed().with(|rig| rig.load = Load::Isometric);
    assert!(no(isometric).contains("isometric"));
    let pushed = Paper::sealed().gauge(3e5).with(|rig| rig.load = Load::ConstantForce { mass: 1.0, force: -1.0 });
    assert!(no(pushed).contains("pushes"));
    let heavy = Paper::sealed().with(|rig| rig.load = Load::ConstantForce { mass: 1.0, force: 1e5 });
    assert!(no(heavy).contains("straight"));
    // Stronger than the load even at full contraction: it rests at its shortest.
    let strong = Paper::sealed().gauge(3e5).mass(0.1).with(|rig| rig.min_length = Some(0.08));
    assert_eq!(strong.start().length, 0.08);
}

/// Dry friction takes its sign from the motion, whatever its rate: an actuator that goes to and fro by a micrometre in hours turns where
/// its motion turns. By (3) the force is k_sec (L − b/√3), so that friction adds Q k_sec to it or takes that away.
#[test]
fn friction_turns_where_a_motion_turns_however_slow_it_is() {
    let width = 2e-4;
    for (frequency, tolerance) in [(1.0, 1e-8), (1e-4, 1e-8), (1e-7, 1e-8), (0.1, 1e-2), (1e-3, 1e-4)] {
        let paper = Paper::sealed().gauge(3e5).friction(0.0, width).with(|rig| {
            let motion = Motion::sinusoid(0.087, 1e-6, frequency, 0.0, rig.thread_length).expect("a motion");
            rig.load = Load::Prescribed(motion);
        });
        let run = paper.run(2.2 / frequency, tolerance);
        for phase in (0..44).map(|step| 0.05 * (f64::from(step) + 0.5)) {
            let sample = run.at(phase / frequency);
            let gauge = sample.pressure.0 - ATMOSPHERE;
            let middle = paper.thread_length / 3.0_f64.sqrt();
            let secant = 3.0 * gauge / (4.0 * PI * paper.turns.powi(2)) * (sample.length + middle);
            let direction = (TAU * phase).cos().signum();
            assert_close(sample.tension, secant * (sample.length - middle + width * direction), 1e-9);
        }
        let turns = run.events().iter().filter(|event| event.kind == EventKind::Reversal).count();
        assert_eq!(turns, 4, "{frequency} Hz at {tolerance}");
    }
}

#[test]
fn a_start_in_equilibrium_stays_there() {
    for paper in [
        Paper::sealed().gauge(60.0 * PSI).friction(0.0, 0.0),
        Paper::sealed().friction(0.0, 0.0),
        Paper::sealed().gauge(60.0 * PSI),
        Paper::sealed(),
    ] {
        let run = paper.run(2.0, 1e-9);
        let first = run.at(0.0);
        for sample in run.samples(0.05) {
            // What rounding starts is bounded by what the tolerance allows a step.
            assert_close(sample.length, first.length, 1e-9);
            assert_close(sample.pressure.0, first.pressure.0, 1e-9);
        }
        assert!(run.statistics().events == 0, "{:?}", run.events());
    }
}

#[test]
fn a_damped_load_settles_where_it_balances() {
    // Isothermal and sealed: P V is constant, so the end is the root of one equation whatever the way there.
    let paper = Paper::sealed().process(Process::Isothermal).friction(40.0, 0.0).gauge(4e5).from(0.085, 0.0);
    let volume = |l: f64| -> f64 { paper.actuator().volume(l) };
    let weight = 5.0 * LB * GRAVITY;
    let surplus = |l: f64| {
        let gauge = (4e5 + ATMOSPHERE) * volume(0.085) / volume(l) - ATMOSPHERE;
        gauge * (3.0 * l * l - paper.thread_length.powi(2)) / (4.0 * PI * 6.25) - weight
    };
    let closed = bisect(0.064, 0.0977, surplus);
    assert_close(paper.run(5.0, 1e-10).at(5.0).length, closed, 1e-8);
}

#[test]
fn a_sealed_muscle_swings_at_the_frequency_of_its_sealed_stiffness() {
    for (process, kappa) in
        [(Process::Isentropic, 1.4), (Process::Isothermal, 1.0), (Process::Polytropic { index: 1.2 }, 1.2)]
    {
        for (gauge, mass) in [(60.0 * PSI, 6.0 * LB), (80.0 * PSI, 11.0 * LB)] {
            let paper = Paper::sealed().process(process).friction(0.0, 0.0).gauge(gauge).mass(mass);
            let (b, n, l) = (paper.thread_length, paper.turns, paper.balance(mass * GRAVITY));
            let volume = l * (b * b - l * l) / (4.0 * PI * n * n) + paper.external_volume;
            let slope = (b * b - 3.0 * l * l) / (4.0 * PI * n * n);
            let stiffness =
                3.0 * gauge * l / (2.0 * PI * n * n) + kappa * (gauge + ATMOSPHERE) * slope * slope / volume;
            let period = TAU / (stiffness / mass).sqrt();
            // 1e-4 m/s swing 2e-6 m, 2e-5 of the length: its square changes the period by 1e-9 or so.
            let run = paper.from(l, 1e-4).run(5.5 * period, 1e-13);
            let crossing = |cycle: f64| {
                let near = (cycle + 0.25) * period;
                bisect(near - 0.2 * period, near + 0.2 * period, |time| -run.at(time).velocity)
            };
            assert_close((crossing(5.0) - crossing(0.0)) / 5.0, period, 1e-7);
        }
    }
}

fn energy_balance(run: &RigTrajectory, mass: f64, until: f64) -> (f64, f64, f64) {
    let (mut work, mut size) = (0.0, 0.0);
    run.quadrature(|weight, sample, _| {
        work -= weight * sample.tension * sample.velocity;
        size += weight * (sample.tension * sample.velocity).abs();
    });
    let (first, last) = (run.at(0.0), run.at(until));
    let kinetic = 0.5 * mass * (last.velocity * last.velocity - first.velocity * first.velocity);
    (work, kinetic - mass * GRAVITY * (last.length - first.length), size)
}

#[test]
fn the_work_of_the_tension_is_the_energy_of_the_load() {
    for (paper, mass) in [
        (Paper::pwm(25.0, 0.5), 5.0 * LB),
        (Paper::pwm(25.0, 0.5).mass(1.0 * LB), 1.0 * LB),
        (Paper::pwm(50.0, 0.5).mass(15.0 * LB).process(Process::Isothermal), 15.0 * LB),
        (Paper::sealed().gauge(60.0 * PSI).from(0.08, 2.0), 5.0 * LB),
    ] {
        let run = paper.run(1.0, 1e-11);
        let (work, energy, size) = energy_balance(&run, mass, 1.0);
        assert!(size > 1e-2, "{size} J change hands");
        // The kinks are events, so the quadrature sees smooth pieces only.
        assert_within(work, energy, 1e-9 * size);
    }
}

#[test]
fn samples_are_at_the_requested_times_and_agree_with_each_other() {
    let run = Paper::pwm(25.0, 0.5).run(0.75, 1e-8);
    let (coarse, fine): (Vec<_>, Vec<_>) = (run.samples(1.0 / 64.0).collect(), run.samples(1.0 / 512.0).collect());
    assert_eq!((coarse.len(), fine.len()), (49, 385));
    for (index, sample) in coarse.iter().enumerate() {
        assert_eq!(sample.time, index as f64 / 64.0);
        assert_eq!(*sample, fine[8 * index]);
        assert_eq!(*sample, run.at(sample.time));
    }
    // An interval that does not divide the duration: the end comes on top.
    let uneven: Vec<f64> = run.samples(0.2).map(|sample| sample.time).collect();
    assert_eq!(uneven.len(), 5);
    for (index, time) in uneven.iter().take(4).enumerate() {
        assert_eq!(*time, index as f64 * 0.2);
    }
    assert_eq!((uneven[4], run.duration()), (0.75, 0.75));
    // One that divides it only up to rounding: no sliver at the end.
    let milli: Vec<f64> = run.samples(1e-3).map(|sample| sample.time).collect();
    assert_eq!((milli.len(), milli[750]), (751, 0.75));
    // Outside: the ends.
    assert_eq!(run.at(-1.0).length, run.at(0.0).length);
    assert_eq!(run.at(9.0), run.at(0.75));
    // The start is what was given.
    let start = Paper::pwm(25.0, 0.5).start();
    let first = run.at(0.0);
    assert_eq!(
        (first.length, first.velocity, first.pressure, first.air_mass),
        (start.length, 0.0, start.pressure, start.air_mass)
    );
}

#[test]
fn a_sample_at_an_edge_of_the_valve_shows_what_holds_after_it() {
    let run = Paper::pwm(25.0, 0.5).run(0.5, 1e-8);
    let edges: Vec<_> = run.events().iter().filter(|event| event.kind == EventKind::Valve).collect();
    assert_eq!(edges.len(), 25, "twelve periods and a half: thirteen openings, twelve closings");
    for edge in edges {
        assert_eq!(run.at(edge.time).ports, edge.after.ports);
        assert_eq!(run.at(edge.time * (1.0 - 1e-12)).ports, edge.before.ports);
        assert_eq!(run.at(edge.time * (1.0 + 1e-12)).ports, edge.after.ports);
        // The states are continuous there.
        let (before, after) = (run.at(edge.time * (1.0 - 1e-12)), run.at(edge.time));
        assert_within(before.length, after.length, 1e-11);
        assert_close(before.pressure.0, after.pressure.0, 1e-8);
    }
    // Two cases at exact instants of the sampling grid: 4 ms open, 21 ms shut.
    let grid: Vec<_> = run.samples(1e-3).collect();
    assert_eq!((grid[3].ports.name(), grid[4].ports.name()), ("exhaust", "supply"));
    assert_eq!((grid[20].ports.name(), grid[21].ports.name()), ("supply", "exhaust"));
}

#[test]
fn events_are_in_order_and_chain_from_mode_to_mode() {
    let run = Paper::pwm(25.0, 0.5).run(1.0, 1e-8);
    assert_eq!(run.statistics().events as usize, run.events().len());
    for pair in run.events().windows(2) {
        assert!(pair[0].time <= pair[1].time);
        assert_eq!(pair[0].after, pair[1].before);
    }
}

#[test]
fn a_prescribed_motion_is_followed_exactly() {
    let paper = Paper::pwm(25.0, 0.5).with(|rig| {
        rig.load = Load::Prescribed(Motion::sinusoid(0.085, 0.01, 3.0, 0.4, rig.thread_length).expect("a motion"));
    });
    for sample in paper.run(0.5, 1e-8).samples(1e-2) {
        let angle = TAU * 3.0 * sample.time + 0.4;
        assert_within(sample.length, 0.085 + 0.01 * angle.sin(), 1e-15);
        assert_within(sample.velocity, 0.01 * TAU * 3.0 * angle.cos(), 1e-14);
    }
    let table = Motion::table(vec![0.1, 0.3, 0.4], vec![0.08, 0.09, 0.07], 0.1).expect("a motion");
    let paper = Paper::sealed().gauge(2e5).with(|rig| rig.load = Load::Prescribed(table));
    let run = paper.run(0.5, 1e-10);
    let corners: Vec<f64> =
        run.events().iter().filter(|event| event.kind == EventKind::Corner).map(|event| event.time).collect();
    assert_eq!(corners, [0.1, 0.3, 0.4]);
    for (time, length, velocity) in [
        (0.05, 0.08, 0.0),
        (0.1, 0.08, 0.05),
        (0.2, 0.085, 0.05),
        (0.3, 0.09, -0.2),
        (0.35, 0.08, -0.2),
        (0.45, 0.07, 0.0),
    ] {
        assert_within(run.at(time).length, length, 1e-15);
        assert_within(run.at(time).velocity, velocity, 1e-14);
    }
    // A sealed chamber is where its volume puts it.
    let (first, last) = (run.at(0.0), run.at(0.5));
    assert_close(last.pressure.0, first.pressure.0 * (first.volume / last.volume).powf(1.4), 1e-9);
}

#[test]
fn a_hold_keeps_the_air() {
    let command = Command::table(vec![0.0, 0.01], vec![Request::Fill, Request::Hold]).expect("a command");
    let paper = Paper::driven(command).with(|rig| rig.kind = ValveKind::FillHoldExhaust).isometric(0.09);
    let run = paper.run(0.5, 1e-9);
    assert_eq!(run.at(0.2).ports.name(), "closed");
    assert_close(run.at(0.5).air_mass, run.at(0.012).air_mass, 1e-15);
    assert_close(run.at(0.5).pressure.0, run.at(0.012).pressure.0, 1e-12);
}

/// Length and pressure at the end of a run with stick and slip, as functions of mass, flow area and opening delay.
fn ends(mass: f64, area: f64, delay: f64) -> [f64; 2] {
    let paper = stick_slip(mass, area, delay);
    let run = paper.run(0.3, 1e-12);
    [run.at(0.3).length, run.at(0.3).pressure.0]
}

fn stick_slip(mass: f64, area: f64, delay: f64) -> Paper {
    Paper::pwm(25.0, 0.5).mass(mass).friction(0.02 * LBF / INCH, 0.1 * INCH).with(|rig| {
        rig.standard = mckibben::valve::FlowStandard::Orifice { flow_area: area };
        rig.delays.0 = delay;
        rig.length = InitialLength::At(0.0965);
        rig.gauge = 1.5e5;
    })
}

#[test]
fn dual_numbers_differentiate_the_whole_simulation() {
    let nominal = [2.3, 1.67e-6, 4e-3];
    let paper = stick_slip(nominal[0], nominal[1], nominal[2]);
    let plain = paper.run(0.3, 1e-10);
    let kinds: Vec<EventKind> = plain.events().iter().map(|event| event.kind).collect();
    assert!(kinds.contains(&EventKind::Stick) && kinds.contains(&EventKind::BreakAway), "{kinds:?}");
    type D = crate::common::Seeded;
    let rig = paper.rig().map(|row, value| match row.key {
        key if key == parameter::MASS.key => D::variable(value, 0),
        key if key == parameter::FLOW_AREA.key => D::variable(value, 1),
        key if key == parameter::OPENING_DELAY.key => D::variable(value, 2),
        _ => D::of(value),
    });
    let start = rig.begin(&paper.initial().map(|_, value| D::of(value))).expect("a start");
    let run = simulate(&rig, start, D::of(0.3), 1e-12).expect("the run reaches its end");
    let last = run.at(D::of(0.3));
    let exact = ends(nominal[0], nominal[1], nominal[2]);
    assert_close(last.length.value, exact[0], 1e-11);
    assert_close(last.pressure.0.value, exact[1], 1e-10);
    for direction in 0..3 {
        // The ends are good to about 1e-11 each, the difference spans 2e-4: 1e-7 of their own size over the parameter's, and
        // the error of the central difference itself is of the same order.
        let step = 1e-4 * nominal[direction];
        let at = |sign: f64| {
            let mut numbers = nominal;
            numbers[direction] += sign * step;
            ends(numbers[0], numbers[1], numbers[2])
        };
        let (above, below) = (at(1.0), at(-1.0));
        for (place, slope) in [last.length.slope[direction], last.pressure.0.slope[direction]].into_iter().enumerate() {
            let difference = (above[place] - below[place]) / (2.0 * step);
            let size = exact[place] / nominal[direction];
            assert!(difference.abs() > 1e-4 * size, "direction {direction}: nothing to compare");
            // Has shown events whose place was found but whose derivative was lost.
            assert_close(slope, difference, 1e-5);
        }
    }
}

#[test]
fn the_derivative_of_an_equilibrium_is_that_of_its_closed_form() {
    type D = crate::common::Seeded;
    let paper = Paper::sealed().mass(2.0).gauge(3e5);
    let rig =
        paper.rig().map(|row, value| if row.key == parameter::MASS.key { D::variable(value, 0) } else { D::of(value) });
    let start = rig.begin(&paper.initial().map(|_, value| D::of(value))).expect("a start");
    // L = √((b² + 4πn² M g/P_g)/3), so dL/dM = 2πn² g/(3 P_g L).
    let length = paper.balance(2.0 * GRAVITY);
    // The root is polished by one Newton step, whose slope is taken before it: good to the bracket's last width.
    assert_close(start.length.slope[0], 2.0 * PI * 6.25 * GRAVITY / (3.0 * 3e5 * length), 1e-10);
}

#[test]
fn runs_outside_their_ranges_are_refused() {
    let (rig, start) = (Paper::sealed().rig(), Paper::sealed().start());
    let key = |duration, tolerance| match simulate(&rig, start, duration, tolerance) {
        Err(Error::OutOfRange { parameter, .. }) => parameter.key,
        other => panic!("{:?}", other.map(|run| run.statistics())),
    };
    assert_eq!(key(0.0, 1e-8), "run.duration");
    assert_eq!(key(f64::NAN, 1e-8), "run.duration");
    assert_eq!(key(1.0, 0.0), "run.relative_tolerance");
    assert_eq!(key(1.0, 0.1), "run.relative_tolerance");
}
