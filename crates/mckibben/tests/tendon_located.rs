//! A load on an elastic tendon, its events located: closed forms, an independent integration, energy, both engines, a stiff tendon.

use crate::common::accounts::Audited;
use crate::common::steps::RigSteps;
use crate::common::tendon::{MASS, REST, STIFFNESS, independent, on_tendon, smooth};
use crate::common::{ATMOSPHERE, GRAVITY, INCH, Paper, assert_close, assert_within, scaled, seeded, slope};
use mckibben::friction::{BoucWen, Coulomb, Hysteresis, LuGre, MaxwellSlip};
use mckibben::load::SeriesTendon;
use mckibben::parameter::{self, Parameter};
use mckibben::plant::RigTrajectory;
use mckibben::simulation::{EventKind, Method, Rig, State, simulate};
use mckibben::{Dual, Over};
use std::f64::consts::TAU;

const TOLERANCE: f64 = 1e-10;

fn located(rig: &Rig, start: State, until: f64) -> RigTrajectory {
    simulate(rig, start, until, TOLERANCE).unwrap_or_else(|error| panic!("{error}"))
}

fn run(paper: &Paper, until: f64) -> RigTrajectory {
    located(&on_tendon(paper, STIFFNESS), paper.start(), until)
}

fn happened(run: &RigTrajectory, kind: EventKind) -> Vec<f64> {
    run.events().iter().filter(|event| event.kind == kind).map(|event| event.time).collect()
}

#[test]
fn two_springs_in_series_swing_at_their_frequency() {
    let velocity = 1e-5;
    let paper = smooth();
    let start = State { velocity, ..paper.start() };
    let own = paper.actuator().sealed_stiffness(start.length, start.pressure);
    let omega = (STIFFNESS * own / (STIFFNESS + own) / MASS).sqrt();
    let trajectory = located(&on_tendon(&paper, STIFFNESS), start, 3.0 * TAU / omega);
    let at_rest = start.length + REST + MASS * GRAVITY / STIFFNESS;
    for sample in trajectory.samples(0.1 / omega) {
        let (angle, part) = (omega * sample.time, STIFFNESS / (STIFFNESS + own));
        // A swing of some 0.2 µm, relative to the curvature of the muscle's force.
        assert_within(sample.load_distance - at_rest, velocity / omega * angle.sin(), 4e-5 * velocity / omega);
        assert_within(sample.length - start.length, part * velocity / omega * angle.sin(), 4e-5 * velocity / omega);
        assert_within(sample.velocity, part * velocity * angle.cos(), 2e-4 * velocity);
        assert_within(sample.load_velocity, velocity * angle.cos(), 2e-4 * velocity);
    }
    assert!(trajectory.events().is_empty());
}

/// A muscle without pressure has no force below its taut length: it takes all that a slack tendon leaves of the distance, to the last
/// digit, and moves with it.
#[test]
fn a_muscle_without_pressure_has_what_its_tendon_leaves() {
    let paper = Paper::sealed().gauge(0.0);
    let actuator = paper.actuator();
    for stiffness in [1e4, 1e5, 1e6, 1e7] {
        for rest in (0..60).map(|part| 5e-3 + 5e-4 * f64::from(part)) {
            let distance = 0.102;
            let tendon = SeriesTendon::new(stiffness, rest).expect("a tendon");
            assert_eq!(tendon.balance(&actuator, distance, ATMOSPHERE), distance - rest);
        }
    }
}

#[test]
fn it_comes_to_an_independent_integration() {
    let until = 0.2;
    for viscous in [0.0, 3.0, 60.0] {
        let paper = smooth().friction(viscous, 0.0);
        let balanced = paper.start().length;
        let exact = independent(&paper.clone().from(balanced, 0.15), viscous, until);
        let last = run(&paper.from(balanced, 0.15), until).at(until);
        assert_within(last.load_distance, exact[0], 2e-10);
        assert_within(last.length, exact[1], 2e-10);
    }
}

/// Only mass and tendon swing while dry friction holds the muscle, and it breaks away at the tension that it holds.
#[test]
fn a_held_muscle_lets_the_tendon_swing_until_it_breaks_away() {
    let paper = Paper::sealed().friction(5.0, 2e-3).gauge(3e5);
    let omega = (STIFFNESS / MASS).sqrt();
    let rig = on_tendon(&paper, STIFFNESS);
    let begin = paper.start();
    let (_, most) = rig.holdable(begin.length, begin.pressure.0, 0.0);
    let surplus = most - MASS * GRAVITY;
    let at_rest = begin.length + REST + MASS * GRAVITY / STIFFNESS;
    for (part, breaks) in [(0.8, false), (1.3, true)] {
        let velocity = part * surplus / STIFFNESS * omega;
        let trajectory = located(&rig, State { velocity, ..begin }, 2.0 * TAU / omega);
        let until = if breaks { (1.0 / part).asin() / omega } else { trajectory.duration() };
        for sample in trajectory.samples(0.1 / omega).take_while(|sample| sample.time < until) {
            // The polynomial of a step rounds.
            assert_close(sample.length, begin.length, 1e-15);
            let swing = velocity / omega * (omega * sample.time).sin();
            assert_within(sample.load_distance - at_rest, swing, 1e-9 * velocity / omega);
        }
        let broke = happened(&trajectory, EventKind::BreakAway);
        assert_eq!(!broke.is_empty(), breaks);
        if let Some(first) = broke.first() {
            assert_close(*first, until, 1e-8);
            let stuck = happened(&trajectory, EventKind::Stick);
            assert!(stuck[0] > *first && stuck[0] < until + TAU / omega, "{stuck:?}");
        }
    }
}

/// On its shortest length the muscle bears any tension, and leaves it where it no longer holds the load.
#[test]
fn on_its_shortest_length_the_muscle_is_a_rope() {
    let paper = smooth().gauge(5e5).with(|rig| rig.min_length = Some(3.4 * INCH));
    let start = State { velocity: 0.02, ..paper.start() };
    let omega = (STIFFNESS / MASS).sqrt();
    let at_rest = start.length + REST + MASS * GRAVITY / STIFFNESS;
    let trajectory = located(&on_tendon(&paper, STIFFNESS), start, 0.3);
    for sample in trajectory.samples(1e-3) {
        assert_close(sample.length, start.length, 1e-15);
        let swing = 0.02 / omega * (omega * sample.time).sin();
        assert_within(sample.load_distance - at_rest, swing, 1e-8 * 0.02 / omega);
    }
}

/// Thrown at a held muscle the load leaves the tendon where the stretch ends, flies, and meets it again.
#[test]
fn a_load_that_is_thrown_flies_on_a_loose_tendon() {
    let paper = Paper::sealed().friction(5.0, 1e-2).gauge(3e5);
    let start = State { velocity: -0.5, ..paper.start() };
    let trajectory = located(&on_tendon(&paper, STIFFNESS), start, 0.3);
    let loose = happened(&trajectory, EventKind::TendonLoose)[0];
    let tight = happened(&trajectory, EventKind::TendonTight)[0];
    // x = a sin(ωt) until it has risen by the stretch at rest.
    let omega = (STIFFNESS / MASS).sqrt();
    let stretch = MASS * GRAVITY / STIFFNESS;
    if trajectory.at(loose).length == start.length {
        assert_close(loose, (stretch / (0.5 / omega)).asin() / omega, 1e-7);
    }
    let left = trajectory.at(loose);
    for part in 1..10 {
        let time = f64::from(part) / 10.0 * (tight - loose);
        let sample = trajectory.at(loose + time);
        assert_eq!(sample.tension, 0.0);
        let expected = left.load_distance + left.load_velocity * time + 0.5 * GRAVITY * time * time;
        assert_close(sample.load_distance, expected, 1e-9);
    }
    assert_within(trajectory.at(tight).load_distance - REST, trajectory.at(tight).length, 1e-10);
}

/// Every law of friction, under pulses, on a loose and on a tight tendon, against the ends of its range: what the gas does is
/// stored or dissipated.
#[test]
fn the_energy_closes() {
    let elements = MaxwellSlip::new(&[5e-5, 4e-4], &[0.8, 0.1]).expect("elements");
    let bristles = LuGre::new(1e-4, 5e-5).expect("a law");
    let falling = LuGre::new(1e-4, 5e-5).and_then(|law| law.with_velocity(1.5, 5e-3, 2e-3)).expect("a law");
    let static_only = LuGre::new(1e-4, 5e-5).and_then(|law| law.with_velocity(1.3, 5e-2, 0.0)).expect("a law");
    let stribeck = Coulomb::new(1e-4).and_then(|law| law.with_stribeck(1.2, 0.2)).expect("a law");
    let pulses = || Paper::pwm(20.0, 0.5).gauge(1e5);
    let cases: [(&str, Paper); 14] = [
        ("viscous and dry", pulses()),
        ("dry", pulses().friction(0.0, 2e-4)),
        ("none", pulses().friction(0.0, 0.0)),
        ("viscous", pulses().friction(20.0, 0.0)),
        ("thrown", pulses().with(|rig| rig.velocity = -1.5)),
        ("thrown, dry", pulses().friction(0.0, 2e-4).with(|rig| rig.velocity = -1.5)),
        ("Maxwell", pulses().friction(0.0, 0.0).with(|rig| rig.hysteresis = Some(Hysteresis::MaxwellSlip(elements)))),
        ("Maxwell, dry", pulses().with(|rig| rig.hysteresis = Some(Hysteresis::MaxwellSlip(elements)))),
        (
            "Bouc-Wen",
            pulses().friction(0.0, 0.0).with(|rig| {
                rig.hysteresis = Some(Hysteresis::BoucWen(BoucWen::new(1e-4, 4e3, 2e3).expect("a law")));
            }),
        ),
        ("LuGre", pulses().friction(5.0, 0.0).with(|rig| rig.hysteresis = Some(Hysteresis::LuGre(falling)))),
        ("LuGre alone", pulses().friction(0.0, 0.0).with(|rig| rig.hysteresis = Some(Hysteresis::LuGre(bristles)))),
        ("LuGre static", pulses().friction(0.0, 0.0).with(|rig| rig.hysteresis = Some(Hysteresis::LuGre(static_only)))),
        ("Stribeck", pulses().friction(30.0, 0.0).with(|rig| rig.coulomb = Some(stribeck))),
        ("heavy", pulses().mass(60.0).with(|rig| rig.velocity = 0.3)),
    ];
    for (name, paper) in cases {
        for isometric in [false, true] {
            let paper = if isometric { paper.clone().isometric(3.7 * INCH) } else { paper.clone() };
            let run = simulate(&on_tendon(&paper, STIFFNESS), paper.start(), 0.4, 1e-9);
            let run = run.unwrap_or_else(|error| panic!("{name}, {isometric}: {error}"));
            let audit = run.audit();
            let open = audit.residual() / audit.turnover();
            println!("{name} {isometric}: {open:.1e} {:?} events {}", run.statistics(), run.events().len());
            assert!(open.abs() < 1e-6, "{name}, held ends {isometric}: {open} of {audit:?}");
            assert!(audit.dissipated() >= -1e-9 * audit.turnover(), "{name}: {audit:?}");
            assert!(audit.air_residual().abs() < 1e-6 * audit.air_in, "{name}: {audit:?}");
            for sample in run.samples(1e-3) {
                let stretch = sample.load_distance - REST - sample.length;
                assert_within(sample.tension, STIFFNESS * stretch.max(0.0), 1e-5);
            }
        }
    }
}

/// By the fixed-step engine the ends differ by its own error: of order 2 in the step without viscous friction, of order 1 with it.
#[test]
fn both_engines_come_to_the_same_at_the_order_of_the_fixed_steps() {
    let until = 0.15;
    let sealed = smooth().start().length;
    for (viscous, order, counts) in [(0.0, 2.0, [400, 800]), (60.0, 1.0, [800, 1600])] {
        let thrown = smooth().friction(viscous, 0.0).from(sealed, 0.15);
        // Where the tendon comes loose or the braid taut no step is divided.
        for (paper, least) in [(thrown, order - 0.3), (Paper::pwm(25.0, 0.5).gauge(2e5).friction(viscous, 0.0), 0.7)] {
            let rig = on_tendon(&paper, STIFFNESS);
            let exact = located(&rig, paper.start(), until).at(until);
            let errors = counts.map(|steps: u32| {
                let mut stepper = RigSteps::new(&rig, paper.start(), Method::Stable);
                for step in 1..=steps {
                    stepper.advance_to(until * (f64::from(step) / f64::from(steps))).expect("a step");
                }
                (stepper.sample().load_distance - exact.load_distance).abs()
            });
            let fitted = (errors[0] / errors[1]).log2();
            assert!(errors[1] < 2e-5 && fitted > least, "{viscous} N·s/m: order {fitted}, {errors:?}");
        }
    }
    let paper = Paper::pwm(25.0, 0.5).gauge(2e5);
    let rig = on_tendon(&paper, STIFFNESS);
    let exact = located(&rig, paper.start(), until);
    let mut stepper = RigSteps::new(&rig, paper.start(), Method::Stable);
    for step in 1..=15_000 {
        let time = until * (f64::from(step) / 15_000.0);
        stepper.advance_to(time).expect("a step");
        let (sample, exact) = (stepper.sample(), exact.at(time));
        assert_within(sample.load_distance, exact.load_distance, 2e-5);
        assert_within(sample.length, exact.length, 2e-5);
    }
}

/// A stiffer tendon comes nearer to none, by as much as it is stiffer.
#[test]
fn a_stiff_tendon_is_none() {
    for viscous in [0.0, 20.0] {
        let paper = Paper::pwm(25.0, 0.5).friction(viscous, 0.0).gauge(2e5);
        let alone = located(&paper.rig(), paper.start(), 0.2);
        let [near, nearer] = [1e6, 1e7].map(|stiffness| {
            let run = located(&on_tendon(&paper, stiffness), paper.start(), 0.2);
            let off = |time: f64| run.at(time).load_distance - run.at(0.0).load_distance - alone.at(time).length;
            (0..=200_u32)
                .map(|step| off(f64::from(step) * 1e-3) + alone.at(0.0).length)
                .fold(0.0, |most: f64, off| most.max(off.abs()))
        });
        println!("{viscous}: {near} {nearer}");
        assert_close(near / nearer, 10.0, 0.1);
    }
}

#[test]
fn derivatives_are_those_of_finite_differences() {
    let rows: [&'static Parameter; 5] = [
        &parameter::TENDON_STIFFNESS,
        &parameter::MASS,
        &parameter::VISCOUS,
        &parameter::COULOMB_WIDTH,
        &parameter::EXTERNAL_VOLUME,
    ];
    for paper in [Paper::pwm(25.0, 0.5).gauge(2e5), Paper::pwm(25.0, 0.5).gauge(2e5).friction(0.0, 1e-4)] {
        let rig = on_tendon(&paper, STIFFNESS);
        let end = |rig: &Rig| {
            let last = located(rig, rig.start(&paper.initial()).expect("a start"), 0.15).at(0.15);
            [last.load_distance, last.length, last.pressure.0]
        };
        for row in rows {
            if scaled(&rig, row, 1e-2) == rig {
                continue;
            }
            let seeded = seeded(&rig, row);
            let start = seeded.begin(&paper.initial().map(|_, value| Dual::of(value))).expect("a start");
            let run = simulate(&seeded, start, Dual::of(0.15), TOLERANCE).expect("a run");
            let last = run.at(Dual::of(0.15));
            let exact = [last.load_distance.slope[0], last.length.slope[0], last.pressure.0.slope[0]];
            for (n, exact) in exact.into_iter().enumerate() {
                assert_close(exact, slope(1e-5, |relative| end(&scaled(&rig, row, relative))[n]), 1e-3);
            }
        }
    }
}

#[test]
fn parameters_that_would_make_the_end_jump_are_refused() {
    let falling = Coulomb::new(1e-3).and_then(|law| law.with_stribeck(2.0, 1e-2)).expect("a law");
    let rough =
        |viscous: f64| Paper::pwm(10.0, 0.5).gauge(2e5).friction(viscous, 0.0).with(|rig| rig.coulomb = Some(falling));
    let error_of = |paper: &Paper| {
        simulate(&on_tendon(paper, STIFFNESS), paper.start(), 1.0, 1e-8).expect_err("a jump").to_string()
    };
    assert!(error_of(&rough(0.0)).contains("friction.viscous"), "{}", error_of(&rough(0.0)));
    assert!(error_of(&rough(2.0)).contains("steepest fall of dry friction"), "{}", error_of(&rough(2.0)));
    let short = smooth().from(2.4 * INCH, 0.0).with(|rig| rig.min_length = Some(2.5 * INCH));
    assert!(error_of(&short).contains("actuator.min_length"), "{}", error_of(&short));
}
