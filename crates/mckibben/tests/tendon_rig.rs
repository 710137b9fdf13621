//! A load on an elastic tendon at fixed steps: two springs in series, an independent integration, energy, sticking, flight.

use crate::common::steps::RigSteps;
use crate::common::tendon::{MASS, Muscle, REST, STIFFNESS, independent, on_tendon, smooth};
use crate::common::{GRAVITY, INCH, PSI, Paper, assert_close, assert_within, scaled, seeded, slope, stable_error};
use mckibben::load::{Load, Motion};
use mckibben::parameter::{self, Parameter};
use mckibben::plant::{RigPlant, RigTrajectory, TimeStepping};
use mckibben::simulation::{Method, Rig, Sample, SeriesTendon, State, simulate};
use mckibben::{Dual, Over};
use std::f64::consts::TAU;

fn rig(paper: &Paper) -> Rig {
    on_tendon(paper, STIFFNESS)
}

/// Every sample of so many equal steps.
fn stepped(rig: &Rig, start: State, method: Method, until: f64, steps: u32) -> Vec<Sample> {
    let mut stepper = RigSteps::new(rig, start, method);
    let mut samples = vec![stepper.sample()];
    for step in 1..=steps {
        stepper.advance_to(until * (f64::from(step) / f64::from(steps))).expect("a step");
        samples.push(stepper.sample());
    }
    samples
}

fn run(paper: &Paper, until: f64, steps: u32) -> Vec<Sample> {
    stepped(&rig(paper), paper.start(), Method::Stable, until, steps)
}

#[test]
fn two_springs_in_series_swing_at_their_frequency() {
    let velocity = 1e-3;
    let paper = smooth();
    let start = State { velocity, ..paper.start() };
    let own = paper.actuator().sealed_stiffness(start.length, start.pressure);
    let omega = (STIFFNESS * own / (STIFFNESS + own) / MASS).sqrt();
    let until = 3.0 * TAU / omega;
    let samples = stepped(&rig(&paper), start, Method::Stable, until, 4000);
    let at_rest = start.length + REST + MASS * GRAVITY / STIFFNESS;
    assert_close(samples[0].load_distance, at_rest, 1e-12);
    for sample in samples {
        let (swing, part) = (velocity / omega * (omega * sample.time).sin(), STIFFNESS / (STIFFNESS + own));
        // A swing of some 20 µm is not quite small relative to the curvature of the muscle's force.
        assert_within(sample.load_distance - at_rest, swing, 2e-3 * velocity / omega);
        assert_within(sample.length - start.length, part * swing, 2e-3 * velocity / omega);
    }
}

/// Sealed air goes with the length of its actuator within a stage, however fast that comes to its balance with the tendon: `P V^γ`
/// stays.
#[test]
fn sealed_air_keeps_to_its_adiabat_at_one_millisecond() {
    for (viscous, stiffness) in
        [(0.1, STIFFNESS), (0.1, 100.0 * STIFFNESS), (10.0, STIFFNESS), (10.0, 100.0 * STIFFNESS)]
    {
        let paper = smooth().friction(viscous, 0.0);
        let balanced = paper.start().length;
        let paper = paper.from(balanced, 0.15);
        let samples = stepped(&on_tendon(&paper, stiffness), paper.start(), Method::Stable, 0.2, 200);
        let content = |sample: &Sample| sample.pressure.0 * sample.volume.powf(1.4);
        for sample in &samples {
            assert_close(content(sample), content(&samples[0]), 1e-4);
        }
    }
}

#[test]
fn it_comes_to_an_independent_integration_at_its_order() {
    let until = 0.2;
    for viscous in [0.0, 60.0] {
        let at_rest = smooth().friction(viscous, 0.0);
        let balanced = at_rest.start().length;
        let paper = at_rest.from(balanced, 0.15);
        let exact = independent(&paper, viscous, until);
        for (method, order, counts) in [(Method::Rk4, 4.0, [40, 80]), (Method::Stable, 2.0, [200, 400])] {
            let errors = counts.map(|steps| {
                let samples = stepped(&rig(&paper), paper.start(), method, until, steps);
                let last = samples.last().expect("a sample");
                [last.load_distance - exact[0], last.length - exact[1]].map(f64::abs)
            });
            for n in 0..2 {
                assert!(errors[1][n] < 2e-5, "{errors:?}");
                let fitted = (errors[0][n] / errors[1][n]).log2();
                assert!(fitted > order - 0.25, "{viscous} N·s/m, {method:?}: order {fitted}, {errors:?}");
            }
        }
    }
}

#[test]
fn without_friction_the_energy_stays() {
    let balanced = smooth().start().length;
    let paper = smooth().from(balanced, 0.15);
    let muscle = Muscle::of(&paper);
    let energy = |sample: &Sample| {
        let stretch = sample.tension / STIFFNESS;
        let moving = 0.5 * MASS * sample.load_velocity * sample.load_velocity;
        moving - MASS * GRAVITY * sample.load_distance
            + 0.5 * STIFFNESS * stretch * stretch
            + muscle.stored(sample.length)
    };
    let samples = run(&paper, 2.0, 20_000);
    let (first, turnover) = (energy(&samples[0]), 0.5 * MASS * 0.15 * 0.15);
    for sample in &samples {
        assert_within(energy(sample), first, 2e-4 * turnover);
        assert_close(sample.tension, STIFFNESS * (sample.load_distance - REST - sample.length), 1e-9);
    }
}

/// Mass and tendon swing alone, and the muscle stays exactly: held by dry friction, or on its shortest length.
#[test]
fn what_holds_the_muscle_leaves_the_tendon_to_swing() {
    let rough = Paper::sealed().friction(5.0, 2e-3).gauge(3e5);
    let stopped = smooth().gauge(5e5).with(|rig| rig.min_length = Some(3.4 * INCH));
    for paper in [rough, stopped] {
        let start = State { velocity: 0.02, ..paper.start() };
        let omega = (STIFFNESS / MASS).sqrt();
        let at_rest = start.length + REST + MASS * GRAVITY / STIFFNESS;
        for sample in stepped(&rig(&paper), start, Method::Stable, 0.3, 6000) {
            assert_eq!(sample.length, start.length);
            let swing = 0.02 / omega * (omega * sample.time).sin();
            let allowed = stable_error(omega, 0.3 / 6000.0, 0.3, 0.02 / omega);
            assert_within(sample.load_distance - at_rest, swing, allowed);
        }
    }
}

#[test]
fn a_load_that_is_thrown_flies_on_a_loose_tendon() {
    let paper = smooth().friction(20.0, 0.0);
    let start = State { velocity: -2.0, ..paper.start() };
    let samples = stepped(&rig(&paper), start, Method::Stable, 0.1, 2000);
    let loose = samples.iter().position(|sample| sample.tension == 0.0).expect("it comes loose");
    let left = samples[loose];
    for sample in &samples[loose..] {
        let time = sample.time - left.time;
        assert_eq!(sample.tension, 0.0);
        let expected = left.load_distance + left.load_velocity * time + 0.5 * GRAVITY * time * time;
        // It passes the axis of distances: against the length of the tendon.
        assert_within(sample.load_distance, expected, 1e-9 * REST);
    }
    // Let go, the muscle contracts until it no longer pulls.
    let last = samples.last().expect("a sample");
    assert!(last.length < start.length - 1e-3 && last.length >= 4.3218 * INCH / 3.0_f64.sqrt());
}

/// But for its stretch. Fixed steps come to that at order one, since the muscle follows the tendon within far less than a step;
/// Runge and Kutta's do once they resolve that.
#[test]
fn a_stiff_tendon_is_none() {
    let paper = Paper::pwm(25.0, 0.5);
    let alone = simulate(&paper.rig(), paper.start(), 0.3, 1e-9).expect("a run");
    let run = |stiffness| simulate(&on_tendon(&paper, stiffness), paper.start(), 0.3, 1e-9).expect("a run");
    let (stiff, less) = (run(1e8), run(1e6));
    for sample in alone.samples(1e-4) {
        let own = stiff.at(sample.time);
        // A pull of 600 N stretches it by 6 µm.
        assert_within(own.load_distance - REST, sample.length, 1e-5);
        assert_close(own.pressure.0, sample.pressure.0, 2e-4);
    }
    let off = |stiffness, method, steps, run: &RigTrajectory| {
        let samples = stepped(&on_tendon(&paper, stiffness), paper.start(), method, 0.3, steps);
        let of = |sample: &Sample| (sample.load_distance - run.at(sample.time).load_distance).abs();
        samples.iter().map(of).fold(0.0, f64::max)
    };
    let [coarse, fine] = [15_000, 30_000].map(|steps| off(1e8, Method::Stable, steps, &stiff));
    assert!(fine < 0.55 * coarse && fine < 2e-4, "{coarse:e} {fine:e}");
    let resolved = off(1e6, Method::Rk4, 60_000, &less);
    assert!(resolved < 1e-9, "{resolved:e}");
}

/// Both springs share what held ends leave them: what the muscle pulls is what the tendon gives.
#[test]
fn between_held_ends_the_muscle_shortens_by_what_the_tendon_gives() {
    let paper = Paper::pwm(25.0, 0.5).friction(0.0, 0.0).isometric(3.7 * INCH).gauge(1e5);
    let samples = run(&paper, 0.3, 3000);
    let (first, actuator) = (samples[0], paper.actuator());
    let mut most = 0.0_f64;
    for sample in &samples {
        assert_eq!((sample.load_distance, sample.load_velocity), (first.load_distance, 0.0));
        assert_within(first.length - sample.length, (sample.tension - first.tension) / STIFFNESS, 1e-12);
        assert_close(sample.tension, actuator.static_force(sample.length, sample.pressure.0), 1e-7);
        most = most.max(first.length - sample.length);
    }
    assert!(most > 2e-3, "{most}");
    // Finer steps come to the same.
    let finer = run(&paper, 0.3, 12_000);
    assert_close(finer[12_000].pressure.0, samples[3000].pressure.0, 5e-4);
}

#[test]
fn derivatives_are_those_of_finite_differences() {
    let paper = Paper::pwm(25.0, 0.5).friction(8.0, 0.0).gauge(2e5);
    let rig = rig(&paper);
    let end = |rig: &Rig| {
        let start = rig.start(&paper.initial()).expect("a start");
        let samples = stepped(rig, start, Method::Stable, 0.15, 600);
        [samples[600].load_distance, samples[600].pressure.0]
    };
    let rows: [&'static Parameter; 4] =
        [&parameter::TENDON_STIFFNESS, &parameter::MASS, &parameter::VISCOUS, &parameter::EXTERNAL_VOLUME];
    for row in rows {
        let seeded = seeded(&rig, row);
        let start = seeded.begin(&paper.initial().map(|_, value| Dual::of(value))).expect("a start");
        let stepping = TimeStepping::Fixed { method: Method::Stable, step: 0.15 / 600.0 };
        let run = RigPlant::new(&seeded).simulate(&start, Dual::of(0.15), stepping).expect("a run");
        let last = run.at(Dual::of(0.15));
        let exact = [last.load_distance.slope[0], last.pressure.0.slope[0]];
        for (n, exact) in exact.into_iter().enumerate() {
            assert_close(exact, slope(1e-3, |relative| end(&scaled(&rig, row, relative))[n]), 2e-3);
        }
    }
}

/// The tendon's load end on a given motion, at fixed steps: near the event-located engine, by the order of the method.
/// At low pressure an end without viscous friction sticks and breaks away within steps that do not locate everything: it goes on
/// where it does with every event at its instant, and comes to the same length.
#[test]
fn an_end_that_breaks_away_within_a_step_goes_on() {
    const UNTIL: f64 = 0.3;
    for (psi, coulomb, masses) in [
        (20.0, 1e-4, [1.02, 1.18, 1.73, 2.57, 2.62, 2.63, 3.93]),
        (30.0, 1e-4, [1.02, 1.82, 1.85, 2.02, 2.16, 3.01, 1.12]),
        (10.0, 1e-3, [1.32, 2.87, 2.88, 2.93, 2.45, 2.75, 2.1]),
    ] {
        for mass in masses {
            let paper = Paper::pwm(25.0, 0.5).gauge(psi * PSI).friction(0.0, coulomb).mass(mass);
            let rig = on_tendon(&paper, 1e4);
            let start = rig.start(&paper.initial()).expect("a start");
            let located = simulate(&rig, start, UNTIL, 1e-8).expect("a run").at(UNTIL).length;
            for (steps, error) in [(300, 2e-3), (1200, 3e-4)] {
                let fixed = stepped(&rig, start, Method::Stable, UNTIL, steps)[steps as usize].length;
                assert_within(fixed, located, error);
            }
        }
    }
}

#[test]
fn the_load_end_is_moved_at_fixed_steps() {
    let paper = smooth();
    let moved = Load::Prescribed(Motion::sinusoid(0.09 + REST, 1e-3, 10.0, 0.0, f64::MAX).expect("a motion"));
    let tendon = SeriesTendon::new(STIFFNESS, REST).expect("a tendon");
    let rig = paper.rig().with_load(moved).with_tendon(tendon);
    let start = rig.start(&paper.initial()).expect("a start");
    let exact = simulate(&rig, start, 0.1, 1e-11).expect("a run").at(0.1);
    let off = |step: f64| {
        let mut steps = RigSteps::new(&rig, start, Method::Stable);
        (1..=(0.1 / step).round() as u32).for_each(|n| steps.advance_to(step * f64::from(n)).expect("a step"));
        (steps.sample().length - exact.length).abs()
    };
    let (coarse, fine) = (off(2e-4), off(5e-5));
    assert!(coarse < 1e-4 && fine < coarse / 6.0, "{coarse:e} {fine:e}");
}
