//! The periodic orbit of a plant: states that return, the balance of momentum over a period, equilibria in closed form.

use crate::common::{ATMOSPHERE, GRAVITY, Paper, assert_close, assert_within};
use mckibben::Error;
use mckibben::command::{Driver, PlantMeasurement, PlantSensors};
use mckibben::control::{Quantity, Sampling, SetPoint};
use mckibben::plant::{Orbit, Plant, PlantRun, RigPlant, TimeStepping};
use mckibben::simulation::Method;
use mckibben::valve::{Command, Request, RuntimeCommand};

const TOLERANCE: f64 = 1e-9;

/// The run of a rig by the event-located engine.
fn begun(paper: &Paper) -> PlantRun {
    let view = RigPlant::new(&paper.rig());
    PlantRun::new(view.plant(), &view.start(&paper.start()), TOLERANCE).expect("a run")
}

fn settled(run: &mut PlantRun, most: u64) -> Orbit {
    run.settle(0.05, most, &mut |_| Ok(())).expect("it goes on")
}

/// Mean, least and greatest value of a state over a period from where the run is.
fn over_a_period(run: &mut PlantRun, period: f64, place: usize) -> [f64; 3] {
    const POINTS: u32 = 2000;
    let (start, mut seen) = (run.time(), [0.0, f64::INFINITY, f64::NEG_INFINITY]);
    for point in 1..=POINTS {
        run.advance_to(start + period * f64::from(point) / f64::from(POINTS)).expect("it goes on");
        let value = run.state()[place];
        seen = [seen[0] + value / f64::from(POINTS), seen[1].min(value), seen[2].max(value)];
    }
    seen
}

/// Steps behind the end of a run of fixed ones are those that are set, and none that are out of range.
#[test]
fn other_steps_go_on_where_a_run_is() {
    let paper = Paper::pwm(25.0, 0.4).mass(2.0);
    let view = RigPlant::new(&paper.rig());
    let fixed = TimeStepping::Fixed { method: Method::Rk4, step: 1e-4 };
    let mut run = PlantRun::new(view.plant(), &view.start(&paper.start()), fixed).expect("a run");
    run.advance_to(0.3).expect("it goes on");
    let (there, cost) = (run.state().to_vec(), run.statistics());
    assert!(matches!(run.set_stepping(0.0), Err(Error::OutOfRange { .. })));
    assert_eq!(run.stepping(), fixed);
    run.set_stepping(TOLERANCE).expect("within its range");
    assert_eq!((run.state(), run.statistics()), (&there[..], cost));
    let mut other = run.clone();
    other.set_stepping(TimeStepping::Fixed { method: Method::Rk4, step: 1e-5 }).expect("within its range");
    for run in [&mut run, &mut other] {
        run.advance_to(0.6).expect("it goes on");
    }
    for (located, stepped) in run.state().iter().zip(other.state()) {
        assert_within(*stepped, *located, 1e-5 * located.abs().max(1e-2));
    }
}

/// Nothing damps the swing of a muscle without friction in a period: no number of plain periods ends it, and guesses do. On the
/// orbit the momentum returns, so the mean tension is the weight.
#[test]
fn an_undamped_swing_has_an_orbit_that_only_guesses_reach() {
    let mass = 2.0;
    let paper = Paper::pwm(25.0, 0.4).friction(0.0, 0.0).mass(mass);
    let mut run = begun(&paper);
    run.advance_to(2.0).expect("it goes on");
    let start = run.save();
    let swing = over_a_period(&mut run, 0.4, 0);
    run.restore(&start).expect("its own");
    let orbit = settled(&mut run, 300);
    assert!(orbit.settled && orbit.guesses > 0, "{orbit:?}");
    assert_close(orbit.period, 0.04, 1e-15);
    let before = run.state().to_vec();
    // Trapezoids over the period, with the kinks of the pulses: the mean of F(L, P) less the weight, over the weight.
    let points = 4000;
    let actuator = paper.actuator();
    let (start, mut mean) = (run.time(), 0.0);
    for point in 1..=points {
        run.advance_to(start + orbit.period * f64::from(point) / f64::from(points)).expect("it goes on");
        let state = run.state();
        mean += actuator.static_force(state[0], state[2]) / f64::from(points);
    }
    assert_close(mean, mass * GRAVITY, 1e-6);
    for (after, before) in run.state().iter().zip(&before) {
        assert_within(*after, *before, 1e-6 * before.abs().max(1e-2));
    }
    let settled = over_a_period(&mut run, orbit.period, 0);
    assert!(settled[2] - settled[1] < 0.2 * (swing[2] - swing[1]), "{settled:?} after {swing:?}");
}

/// Where friction damps, the plant goes to its orbit unforced: guesses lead to the one that plain periods reach.
#[test]
fn guesses_and_plain_periods_reach_one_orbit() {
    let paper = Paper::pwm(25.0, 0.4).friction(40.0, 0.0);
    let mut guessed = begun(&paper);
    let orbit = settled(&mut guessed, 500);
    assert!(orbit.settled, "{orbit:?}");
    let mut plain = begun(&paper);
    plain.advance_to(60.0).expect("it goes on");
    for (a, b) in guessed.state().iter().zip(plain.state()) {
        assert_within(*a, *b, 2e-6 * b.abs().max(1e-2));
    }
}

/// Sealed air keeps its mass and, without heat, its entropy, and an undamped muscle its energy: what it swings about is where
/// F(L, P) = m g with P V^κ as at the start, in closed form.
#[test]
fn a_sealed_muscle_settles_where_it_balances_with_the_air_that_it_has() {
    let paper = Paper::sealed().gauge(4e5).friction(0.0, 0.0).from(0.088, 0.0);
    let mut run = begun(&paper);
    let (mass, start) = (run.state()[3], paper.start());
    let orbit = settled(&mut run, 300);
    assert!(orbit.settled, "{orbit:?}");
    let actuator = paper.actuator();
    let constant = start.pressure.0 * actuator.volume(start.length).powf(1.4);
    let pressure = |length: f64| constant / actuator.volume(length).powf(1.4);
    let weight = 5.0 * crate::common::LB * GRAVITY;
    let balance =
        crate::common::bisect(0.075, 0.0975, |length| actuator.static_force(length, pressure(length)) - weight);
    assert_close(run.state()[0], balance, 1e-5);
    assert_close(run.state()[2], pressure(balance), 1e-5);
    assert_close(run.state()[3], mass, 1e-6);
    assert_within(run.state()[1], 0.0, 1e-6);
}

/// Where dry friction holds a load, it stays: settled at once, without a guess, at the pressure it has.
#[test]
fn a_load_that_sticks_has_settled() {
    let mut run = begun(&Paper::sealed().gauge(3e5).friction(3.5, 2e-4));
    let orbit = settled(&mut run, 50);
    assert!(orbit.settled && orbit.guesses == 0, "{orbit:?}");
    assert_close(run.state()[2], 3e5 + ATMOSPHERE, 1e-9);
}

#[test]
fn the_period_is_the_least_that_all_pulses_share() {
    let view = RigPlant::new(&Paper::pwm(20.0, 0.4).rig());
    let plant = |frequencies: &[f64]| {
        let mut network = view.plant().network().clone();
        let of = |frequency: &f64| Command::pwm(*frequency, 0.5, Request::Fill, Request::Exhaust).expect("a command");
        network.valves[0].command = of(&frequencies[0]);
        for frequency in &frequencies[1..] {
            let mut other = network.valves[0].clone();
            other.command = of(frequency);
            network.valves.push(other);
        }
        Plant::new(view.plant().actuators().to_vec(), network, view.plant().mechanisms().to_vec()).expect("a plant")
    };
    let period = |frequencies: &[f64]| plant(frequencies).period();
    assert_eq!(period(&[20.0]), Ok(Some(0.05)));
    assert_close(period(&[20.0, 50.0]).expect("a period").expect("pulses"), 0.1, 1e-12);
    assert_close(period(&[20.0, 30.0, 12.5]).expect("a period").expect("pulses"), 0.4, 1e-12);
    assert!(matches!(period(&[20.0, 20.0 * 2f64.sqrt()]), Err(Error::NotImplemented(_))));
    assert_eq!(RigPlant::new(&Paper::sealed().rig()).plant().period(), Ok(None));
}

/// A controller that follows a set point of 2 Hz has its period, though its valve was to pulse at 25 Hz and the air at either end
/// of its way rests for longer than that.
#[test]
fn a_controller_settles_with_its_set_point() {
    let paper = Paper::pwm(25.0, 0.4).friction(60.0, 0.0);
    let view = RigPlant::new(&paper.rig());
    let decide = |seen: &PlantMeasurement, (): &mut (), commands: &mut [Option<RuntimeCommand>]| {
        let request = if (2.0 * seen.time).fract() < 0.5 { Request::Fill } else { Request::Exhaust };
        commands[0] = Some(RuntimeCommand::Request(request));
    };
    let sampling = Sampling::new(100.0, 0).expect("in range");
    let driver = Driver::of_function(decide, (), &[0], sampling, PlantSensors::perfect());
    let set_point = SetPoint::sinusoid(Quantity::Length, 0.09, 0.01, 2.0, 0.0).expect("in range");
    let driver = driver.with_set_points([&set_point]);
    let mut run =
        PlantRun::with_drivers(view.plant(), &view.start(&paper.start()), TOLERANCE, vec![driver]).expect("a run");
    let orbit = settled(&mut run, 200);
    assert!(orbit.settled && orbit.guesses == 0, "{orbit:?}");
    assert_close(orbit.period, 0.5, 1e-12);
    let place = view.plant().indices().actuators[0].pressure;
    let [_, least, greatest] = over_a_period(&mut run, orbit.period, place);
    assert!(greatest - least > 1e5, "{least} to {greatest} Pa");
}
