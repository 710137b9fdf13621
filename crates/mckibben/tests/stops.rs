//! Rigs at the ends of their travel and at equal pressures: modes that last, few events, the right place to rest.
//!
//! The rules are those of `mckibben::engine::event`; `tests/events.rs` has them on systems in closed form.

use crate::common::{ATMOSPHERE, GRAVITY, LB, PSI, Paper, assert_close, assert_within};
use mckibben::air::Process;
use mckibben::load::Load;
use mckibben::plant::RigTrajectory;
use mckibben::simulation::{EventKind, InitialLength, LengthRegime, Sliding};
use mckibben::valve::{Command, Request};

const PROCESSES: [Process; 4] = [
    Process::Isentropic,
    Process::Isothermal,
    Process::Polytropic { index: 1.2 },
    Process::EnergyBalance { heat_transfer: 0.1, wall_temperature: 293.15 },
];

fn count(run: &RigTrajectory, kind: EventKind) -> usize {
    run.events().iter().filter(|event| event.kind == kind).count()
}

#[test]
fn clause_6_an_exhaust_at_equal_pressure_does_not_chatter() {
    for process in PROCESSES {
        let exhaust = Paper::driven(Command::Constant(Request::Exhaust)).process(process);
        // Held at exactly the atmosphere's pressure, or slightly off it: nothing happens for 10 s.
        for gauge in [0.0, 1e-9, -1e-9, 1e-3, -1e-3] {
            let run = exhaust.clone().gauge(gauge).isometric(0.085).run(10.0, 1e-8);
            assert!(run.statistics().events <= 2, "{process:?} from {gauge} Pa: {:?}", run.events());
            assert!(run.statistics().evaluations < 20_000, "{process:?} from {gauge} Pa: {:?}", run.statistics());
            assert_within(run.at(10.0).pressure.0, ATMOSPHERE, 1e-2);
        }
        // Emptied from 7 bar: choked, subsonic, near equal.
        let run = exhaust.clone().gauge(6e5).isometric(0.085).run(10.0, 1e-8);
        assert!((2..=6).contains(&run.statistics().events), "{process:?}: {:?}", run.events());
        // The muscle hangs on its taut braid and swings, with its flow path open.
        let run = exhaust.clone().run(10.0, 1e-8);
        assert!(run.statistics().events <= 10, "{process:?}: {:?}", run.statistics());
        assert!(run.statistics().evaluations < 50_000, "{process:?}: {:?}", run.statistics());
    }
}

#[test]
fn clause_6_a_motion_that_breathes_through_the_exhaust_passes_each_border_once_a_swing() {
    // A slow sinusoid pumps air to and fro at nearly equal pressure: inflow and outflow take turns, two borders a period.
    let motion =
        |rig: &Paper| mckibben::load::Motion::sinusoid(0.085, 0.002, 1.0, 0.0, rig.thread_length).expect("a motion");
    let paper = Paper::driven(Command::Constant(Request::Exhaust)).with(|rig| rig.load = Load::Prescribed(motion(rig)));
    let run = paper.run(10.0, 1e-8);
    let flow = count(&run, EventKind::Flow);
    assert!((19..=23).contains(&flow), "{flow} changes of the flow's piece in ten periods");
    assert_eq!(count(&run, EventKind::Reversal), 20);
}

#[test]
fn a_mass_at_rest_on_the_taut_braid_stays_there() {
    for width in [0.0, 1e-4] {
        let paper = Paper::sealed().friction(3.5, width);
        let run = paper.run(10.0, 1e-8);
        assert_eq!(run.statistics().events, 0, "{:?}", run.events());
        let closed = paper.max_length + 5.0 * LB * GRAVITY / paper.limit_stiffness;
        for sample in run.samples(0.5) {
            assert_close(sample.length, closed, 1e-9);
            assert_within(sample.tension, 5.0 * LB * GRAVITY, 1e-4);
        }
    }
}

#[test]
fn a_mass_dropped_on_the_taut_braid_hits_it_with_the_speed_of_its_fall() {
    // Slack below L_min, then no pressure, so no force, up to L_max: a free fall of known height. A vented actuator has no
    // further gas spring: an external volume of 1 m³ keeps its pressure.
    let paper = Paper::sealed().friction(0.0, 0.0).with(|rig| rig.external_volume = 1.0);
    for start in [0.05, 0.09] {
        let run = paper.clone().from(start, 0.0).run(3.0, 1e-10);
        let height = paper.max_length - start;
        let first = run.events().iter().find(|event| event.kind == EventKind::Taut).expect("it becomes taut");
        // The gas spring left by 1 m³ is about 1e-6 of the weight.
        assert_close(first.time, (2.0 * height / GRAVITY).sqrt(), 1e-5);
        assert_close(run.at(first.time).velocity, (2.0 * GRAVITY * height).sqrt(), 1e-5);
        // It never gets higher again than it came from, and ends on the braid.
        let top = run.samples(1e-3).map(|sample| sample.length).fold(f64::MAX, f64::min);
        assert!(top >= start * (1.0 - 1e-9), "{top} above {start}");
        let rest = paper.max_length + 5.0 * LB * GRAVITY / paper.limit_stiffness;
        assert_within(run.at(3.0).length, rest, 1e-6);
        assert!(run.statistics().events < 200, "{:?}", run.statistics());
        // Without pressure the tension is nowhere below zero, and the braid does not hold the mass back on rebound.
        assert!(run.samples(1e-4).all(|sample| sample.tension >= 0.0));
        assert_eq!(count(&run, EventKind::Rebound), count(&run, EventKind::TautEnd));
    }
}

#[test]
fn the_first_blow_on_the_braid_is_that_of_a_damped_spring() {
    // x = v₀/ω_d e^(−δt) sin ω_d t plus the sag of gravity; it stops pulling when K x + C v = 0, before it is back.
    let paper = Paper::sealed()
        .friction(0.0, 0.0)
        .with(|rig| (rig.external_volume, rig.load) = (1.0, Load::ConstantForce { mass: 2.0, force: 0.0 }));
    let run = paper.clone().from(paper.max_length, 1.0).run(0.1, 1e-11);
    let (delta, rate) = (100.0 / 4.0, 1.75e5 / 2.0_f64);
    let damped = (rate - delta * delta).sqrt();
    // K x + C v = e^(−δt) [C cos ω_d t + (K − C δ)/ω_d sin ω_d t].
    let time = (std::f64::consts::PI - (100.0 * damped / (1.75e5 - 100.0 * delta)).atan()) / damped;
    let rebound = run.events().iter().find(|event| event.kind == EventKind::Rebound).expect("a rebound");
    // The gas at atmospheric pressure in 1 m³ adds a force of some micronewton.
    assert_close(rebound.time, time, 1e-6);
    let speed = |t: f64| (-delta * t).exp() * ((damped * t).cos() - delta / damped * (damped * t).sin());
    assert_close(run.at(time).velocity, speed(time), 1e-6);
    // From there it flies freely at that speed.
    let free = run.events().iter().find(|event| event.kind == EventKind::TautEnd).expect("it comes free");
    assert_eq!(free.after.length_regime, LengthRegime::Free);
    assert_close(run.at(free.time + 1e-3).velocity, speed(time), 1e-6);
}

/// A muscle whose force at its shortest is well above the load.
fn stronger_than_its_load(width: f64) -> Paper {
    Paper::sealed().friction(3.5, width).gauge(3e5).mass(1.0).with(|rig| rig.min_length = Some(0.08))
}

#[test]
fn a_load_that_is_weaker_than_the_muscle_rests_at_the_shortest_length() {
    for width in [0.0, 1e-3] {
        let paper = stronger_than_its_load(width);
        let shortest: f64 = paper.actuator().static_force(0.08, 3e5 + ATMOSPHERE);
        assert!(shortest > 2.0 * GRAVITY, "F_s(L_min) = {shortest} N");
        // It starts there and stays.
        let run = paper.run(5.0, 1e-8);
        assert_eq!(run.at(5.0).length, 0.08);
        assert!(run.statistics().events <= 1, "{:?}", run.events());
        assert_within(run.at(5.0).tension, GRAVITY, 1e-12);
        if width == 0.0 {
            // The muscle pulls nearly constantly there, so viscous friction takes less of each smaller bounce: no rest in
            // finite time, and nothing but ever smaller bounces.
            let run = paper.from(0.08, -0.3).run(5.0, 1e-8);
            let highest = |from: f64, to: f64| {
                run.samples(1e-3).filter(|s| s.time >= from && s.time < to).map(|s| s.length).fold(f64::MAX, f64::min)
            };
            assert!(highest(0.0, 1.0) < highest(1.0, 3.0) && highest(1.0, 3.0) < highest(3.0, 5.0));
            continue;
        }
        // Lifted and let go, or pulled up against it: it bounces on a slack tendon and comes to rest.
        for (start, velocity) in [(0.07, 0.0), (0.085, 0.0), (0.08, -0.3), (0.09, 0.5)] {
            let run = paper.clone().from(start, velocity).run(5.0, 1e-8);
            let last = run.at(5.0);
            assert_eq!((last.length, last.velocity), (0.08, 0.0), "from {start}: {:?}", run.statistics());
            let end = run.events().last().expect("it came to rest");
            assert_eq!((end.kind, end.after.sliding), (EventKind::Stick, Sliding::Stuck));
            assert!(run.statistics().events < 3000, "from {start}: {:?}", run.statistics());
        }
    }
}

#[test]
fn the_first_flight_off_the_stop_is_a_throw() {
    // Slack at once, up against gravity and back at the same speed: 2v/g.
    let run = stronger_than_its_load(0.0).from(0.08, -0.3).run(0.2, 1e-10);
    let tight = run.events().iter().find(|event| event.kind == EventKind::Tight).expect("it comes down");
    assert_close(tight.time, 0.6 / GRAVITY, 1e-12);
    assert_close(run.at(tight.time).velocity, 0.3, 1e-12);
    assert_close(run.at(0.3 / GRAVITY).length, 0.08 - 0.09 / (2.0 * GRAVITY), 1e-12);
}

#[test]
fn a_resting_load_is_lifted_off_when_the_pressure_falls() {
    // On the stop any tension up to what the muscle can hold; as the chamber empties the load breaks away downwards.
    let paper = stronger_than_its_load(1e-4).with(|rig| rig.command = Some(Command::Constant(Request::Exhaust)));
    let run = paper.run(0.5, 1e-9);
    let away = run.events().iter().find(|event| event.kind == EventKind::BreakAway).expect("it breaks away");
    assert_eq!(away.after.sliding, Sliding::Lengthening);
    // At that instant the load is what force and friction together can hold.
    let sample = run.at(away.time);
    let actuator = paper.actuator();
    let force: f64 = actuator.static_force(0.08, sample.pressure.0);
    let bound: f64 = actuator.coulomb_bound(0.08, sample.pressure.0);
    assert_close(force + bound, GRAVITY, 1e-7);
    assert!(run.at(0.5).length > 0.09);
}

#[test]
fn a_stuck_load_breaks_away_when_the_balance_leaves_the_friction() {
    // Filled slowly: shortens once F_s − Q k_sec exceeds the weight, and not before.
    let paper = Paper::driven(Command::Constant(Request::Fill))
        .friction(3.5, 1e-3)
        .gauge(60.0 * PSI)
        .mass(6.0 * LB)
        .with(|rig| rig.delays = (0.0, 0.0));
    let run = paper.run(0.2, 1e-9);
    let away = run.events().iter().find(|event| event.kind == EventKind::BreakAway).expect("it breaks away");
    assert_eq!((away.before.sliding, away.after.sliding), (Sliding::Stuck, Sliding::Shortening));
    let (first, sample) = (run.at(0.0), run.at(away.time));
    assert_close(sample.length, first.length, 4.0 * f64::EPSILON);
    let actuator = paper.actuator();
    let force: f64 = actuator.static_force(sample.length, sample.pressure.0);
    let bound: f64 = actuator.coulomb_bound(sample.length, sample.pressure.0);
    assert_close(force - bound, 6.0 * LB * GRAVITY, 1e-7);
    // While it stuck, it pulled just as hard as the load.
    assert_close(run.at(0.5 * away.time).tension, 6.0 * LB * GRAVITY, 1e-15);
}

#[test]
fn a_tendon_that_is_outrun_pulls_nothing_until_it_is_caught_up() {
    // Shortening so fast that c v exceeds the static force: the tension is zero, and the load flies freely.
    let paper = Paper::sealed().friction(30.0, 0.0).gauge(1e5).with(|rig| {
        rig.load = Load::ConstantForce { mass: 1.0, force: 0.0 };
        rig.length = InitialLength::At(0.09);
        rig.velocity = -2.0;
    });
    let force: f64 = paper.actuator().static_force(0.09, 1e5 + ATMOSPHERE);
    assert!(force < 60.0);
    let run = paper.run(5e-3, 1e-10);
    for sample in run.samples(5e-4) {
        assert_eq!(sample.tension, 0.0);
        assert_close(sample.velocity, -2.0, 4.0 * f64::EPSILON);
        assert_within(sample.length, 0.09 - 2.0 * sample.time, 1e-15);
    }
}

#[test]
fn a_load_that_pulls_the_braid_straight_stops_the_run_with_a_word() {
    let paper = Paper::sealed().from(0.097, 60.0).with(|rig| (rig.limit_stiffness, rig.limit_damping) = (1e3, 0.0));
    let error = mckibben::simulation::simulate(&paper.rig(), paper.start(), 1.0, 1e-8).expect_err("too fast");
    let message = error.to_string();
    assert!(message.contains("straight") && message.contains("actuator.limit.stiffness"), "{message}");
}
