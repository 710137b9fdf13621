//! A joint on valves that do not jump and with bristles, its events located: closed forms, the rig on a line as a limiting case,
//! Dahl's law, the orders of fixed steps, energy and exergy, derivatives.

use crate::common::joint::{Pair, on_a_line};
use crate::common::regulated::Regulated;
use crate::common::steps::JointSteps;
use crate::common::{ATMOSPHERE, PSI, Paper, ROOM, assert_close, assert_within};
use mckibben::Scalar as _;
use mckibben::air::Process;
use mckibben::friction::{BoucWen, Hysteresis, LuGre};
use mckibben::load::Stops;
use mckibben::plant::{JointPlant, JointTrajectory};
use mckibben::simulation::{Actuation, EventKind, InitialAngle, JointInitial, Method, Rig, simulate};
use mckibben::valve::{Command, FlowStandard, Ramp, Regulator, Request, Solenoid, Spool, ValveKind};
use mckibben::{GaugePressure, Real};

const TIGHT: f64 = 1e-11;

fn pulses(frequency: f64, duty: f64) -> Command {
    Command::pwm(frequency, duty, Request::Fill, Request::Exhaust).expect("a command")
}

fn regulator() -> Regulator {
    Regulator::new(0.02, 5e-3, 2e6).expect("a regulator")
}

/// Poppets that take their time, a spool and a pressure regulator, each with a command.
fn valves() -> [(&'static str, Solenoid, Command); 3] {
    let ramp = Ramp::new(3e-3, 5e-3).expect("a ramp");
    let seats = Solenoid::new(ValveKind::ThreeWay, 4e-3, 1e-3).expect("a valve").with_ramp(ramp);
    let spool = Solenoid::proportional(Spool::new(40.0, 0.4, 0.05, -0.1).expect("a spool"));
    let times = || vec![0.0, 0.1, 0.25];
    let positions = Command::positions(times(), vec![0.6, -0.4, 0.2]).expect("positions");
    let points = Command::set_points(times(), vec![4e5, 2e5, 2.3e5]).expect("set points");
    [
        ("ramp", seats, pulses(10.0, 0.5)),
        ("spool", spool, positions),
        ("regulator", Solenoid::regulating(regulator()), points),
    ]
}

fn falling() -> Hysteresis {
    Hysteresis::LuGre(LuGre::new(1e-4, 5e-5).and_then(|law| law.with_velocity(1.5, 5e-3, 2e-3)).expect("a law"))
}

/// Both actuators on the same kind of valve, the second a little later and with a lower command.
fn pair(solenoid: Solenoid, command: Command, hysteresis: Option<Hysteresis>) -> Pair {
    let paper = Paper::driven(command).gauge(2e5).friction(3.5, 0.0).with(|rig| rig.hysteresis = hysteresis);
    let other = match &paper.command {
        Some(Command::SetPoints { .. }) => Command::set_points(vec![0.01, 0.15], vec![1.5e5, 3e5]).expect("set points"),
        Some(Command::Positions { .. }) => Command::positions(vec![0.02, 0.2], vec![-0.3, 0.5]).expect("positions"),
        _ => pulses(13.0, 0.35),
    };
    Pair::of(paper).with(|pair| {
        pair.papers[1].command = Some(other);
        pair.solenoids = [Some(solenoid), Some(solenoid)];
        pair.limb.distance = 0.1;
        pair.angle = InitialAngle::At(0.1);
        pair.damping = 2e-3;
    })
}

/// With a slack antagonist a joint is a hanging mass, whose own tests hold it against closed forms and independent integrations.
#[test]
fn with_a_slack_antagonist_it_is_the_hanging_mass() {
    for hysteresis in [None, Some(falling())] {
        for (name, solenoid, command) in valves() {
            let (paper, pair) = on_a_line(command.clone());
            let paper = paper.with(|rig| rig.hysteresis = hysteresis);
            let pair = pair.with(|pair| {
                pair.papers[0].hysteresis = hysteresis;
                pair.solenoids[0] = Some(solenoid);
            });
            let actuation = Some(Actuation { solenoid, command });
            let line = Rig::new(paper.actuator(), actuation, paper.load.clone()).expect("a rig");
            let on_line = simulate(&line, line.start(&paper.initial()).expect("a start"), 0.4, TIGHT).expect("a run");
            let joint = pair.run(0.4, TIGHT);
            for step in 0..=400 {
                let time = f64::from(step) * 1e-3;
                let (a, b) = (on_line.at(time), joint.at(time).actuators[0]);
                assert_within(b.length, a.length, 1e-9);
                assert_within(b.velocity, a.velocity, 1e-7);
                assert_close(b.pressure.0, a.pressure.0, 1e-7);
                assert_within(b.tension, a.tension, 1e-3);
                assert_within(b.mass_flow, a.mass_flow, 1e-7);
                let beyond = [a, b].map(|sample| sample.supply_pressure.map_or(0.0, |pressure| pressure.0));
                assert_within(beyond[0], beyond[1], 1e-3);
            }
            assert_eq!(joint.events().is_empty(), on_line.events().is_empty(), "{name}");
        }
    }
}

/// A joint that is too heavy to turn.
fn held(paper: Paper) -> Pair {
    Pair::of(paper).with(|pair| pair.limb.inertia = 1e12)
}

/// While choked, `d ln P/dt = −λ C ρ₀ T₀ R/V`, and the integral of λ is a parabola, then a straight line.
#[test]
fn an_opening_seat_empties_a_held_actuator_by_the_exponential_of_a_parabola() {
    const CONDUCTANCE: f64 = 3e-9;
    let paper =
        Paper::driven(Command::Constant(Request::Exhaust)).process(Process::Isothermal).gauge(7e5).with(|rig| {
            rig.kind = ValveKind::FillHoldExhaust;
            rig.standard = FlowStandard::Iso6358 { sonic_conductance: CONDUCTANCE, critical_ratio: 0.4 };
            rig.efficiency = 1.0;
        });
    let volume = paper.actuator().volume(0.082);
    let rate = CONDUCTANCE * 1.185 * ROOM * paper.gas_constant / volume;
    let (opens, rise) = (paper.delays.0, 12e-3);
    let seats = Solenoid::new(paper.kind, paper.delays.0, paper.delays.1).expect("a valve");
    let slow = seats.with_ramp(Ramp::new(rise, 0.0).expect("a ramp"));
    let run = held(paper).with(|pair| pair.solenoids = [Some(slow), None]).run(30e-3, TIGHT);
    for step in 0..=30 {
        let time = 1e-3 * f64::from(step);
        let expected = |rise: f64| {
            let since = (time - opens).clamp(0.0, rise);
            let area = if rise > 0.0 { since * since / (2.0 * rise) } else { 0.0 } + (time - opens - rise).max(0.0);
            (ATMOSPHERE + 7e5) * (-rate * area).exp()
        };
        let sample = run.at(time);
        assert_close(sample.actuators[0].pressure.0, expected(rise), 1e-8);
        assert_close(sample.actuators[1].pressure.0, expected(0.0), 1e-8);
    }
    let valve = run.events().iter().filter(|event| event.kind.kind == EventKind::Valve);
    let of_agonist: Vec<f64> = valve.filter(|event| event.kind.actuator == Some(0)).map(|event| event.time).collect();
    assert_eq!(of_agonist, [opens, opens + rise]);
}

#[test]
fn a_regulated_pressure_follows_its_closed_form() {
    let (times, gauges) = ([0.02, 0.15], [4e5, 1e5]);
    let points = Command::set_points(times.to_vec(), gauges.to_vec()).expect("set points");
    let pair = pair(Solenoid::regulating(regulator()), points, None).with(|pair| pair.papers[0].gauge = 0.0);
    let run = pair.run(0.3, TIGHT);
    let closed_form = Regulated { time_constant: 0.02, dead_time: 5e-3, rate_limit: 2e6 };
    let segments = closed_form.segments(ATMOSPHERE, &times, &gauges.map(|gauge| gauge + ATMOSPHERE));
    for (step, segment) in segments.into_iter().enumerate() {
        let until = times.get(step + 1).map_or(0.3, |time| time + 5e-3);
        for n in 0..=50 {
            let time = segment.time + (until - segment.time) * f64::from(n) / 50.0;
            let supply = run.at(time).actuators[0].supply_pressure.expect("it is regulated").0;
            assert_close(supply, closed_form.pressure(&segment, time), 1e-8);
        }
    }
    let count = |kind| run.events().iter().filter(|event| event.kind.kind == kind).count();
    assert_eq!(count(EventKind::SetPoint), 4);
    assert!(count(EventKind::Regulator) >= 2);
}

fn difference(pair: &Pair, method: Method, steps: u32, until: f64, exact: &JointTrajectory) -> f64 {
    let rig = pair.rig().expect("a rig");
    let mut stepper = JointSteps::new(&rig, rig.start(&pair.initial()).expect("a start"), method);
    for step in 1..=steps {
        stepper.advance_to(until * (f64::from(step) / f64::from(steps))).expect("a step");
    }
    let (ours, theirs) = (stepper.sample(), exact.at(until));
    let pressures = [0, 1].map(|i| (ours.actuators[i].pressure.0 / theirs.actuators[i].pressure.0 - 1.0).abs());
    (ours.angle - theirs.angle).abs().max(pressures[0]).max(pressures[1])
}

/// Flows that are choked throughout, so that the rates are smooth between edges.
fn choked(pair: Pair) -> Pair {
    pair.with(|pair| {
        for paper in &mut pair.papers {
            paper.external_volume = 1e-3;
            paper.supply_gauge = 250.0 * PSI;
            paper.gauge = 45.0 * PSI;
        }
    })
}

#[test]
fn fixed_steps_come_to_it_at_their_order() {
    let until = 0.2;
    for (name, solenoid, command) in valves() {
        let pair = choked(pair(solenoid, command, None));
        let exact = pair.run(until, 1e-12);
        for (method, order, counts) in [(Method::Stable, 2.0, [400, 1600]), (Method::Rk4, 4.0, [50, 200])] {
            let errors = counts.map(|steps| difference(&pair, method, steps, until, &exact));
            let fitted = (errors[0] / errors[1]).log2() / 2.0;
            println!("{name} {method:?} {fitted} {errors:?}");
            // A regulated pressure crosses the actuator's, where the flow has a kink.
            let least = if name == "regulator" { 1.3 } else { order - 0.3 };
            assert!(fitted > least, "{name}, {method:?}: order {fitted}, {errors:?}");
        }
    }
    // Bristles turn with the joint: between two turns the order is the method's, and a step spans the turn.
    let pair = choked(pair(valves()[0].1, pulses(10.0, 0.5), Some(falling())));
    let exact = pair.run(until, 1e-12);
    let errors = [2000, 8000].map(|steps| difference(&pair, Method::Stable, steps, until, &exact));
    let fitted = (errors[0] / errors[1]).log2() / 2.0;
    println!("LuGre {fitted} {errors:?}");
    assert!(fitted > 1.7 && errors[1] < 1e-5, "order {fitted}, {errors:?}");
}

/// Bristles whose friction does not fall are Dahl's law, which that of Bouc and Wen gives without a state.
#[test]
fn bristles_that_do_not_fall_are_those_of_bouc_and_wen() {
    let (width, reach) = (1e-4, 5e-5);
    let bristles = Hysteresis::LuGre(LuGre::new(width, reach).expect("a law"));
    let remembered = Hysteresis::BoucWen(BoucWen::new(width, 1.0 / reach, 0.0).expect("a law"));
    let run = |law| {
        let stops = Stops { ends: [Some(-0.2), Some(0.15)], stiffness: 300.0, damping: 0.3 };
        let pair = pair(valves()[0].1, pulses(10.0, 0.5), Some(law)).with(|pair| pair.stops = stops);
        pair.with(|pair| pair.papers[1].hysteresis = Some(law)).run(0.4, TIGHT)
    };
    let (a, b) = (run(bristles), run(remembered));
    let turns = a.events().iter().filter(|event| event.kind.kind == EventKind::Reversal).count();
    assert!(turns > 3, "{turns}");
    for (a, b) in a.samples(1e-3).zip(b.samples(1e-3)) {
        assert_within(a.angle, b.angle, 1e-7);
        assert_within(a.torque, b.torque, 1e-4);
        assert_close(a.actuators[1].pressure.0, b.actuators[1].pressure.0, 1e-6);
    }
}

#[test]
fn the_audits_close() {
    for hysteresis in [None, Some(falling())] {
        for (name, solenoid, command) in valves() {
            let run = pair(solenoid, command, hysteresis).run(0.5, 1e-10);
            let ledger = run.ledger();
            let open = [ledger.work(), ledger.energy(), ledger.exergy()].map(|of| of.residual / of.turnover);
            println!("{name}: {open:?}, {:?}", run.statistics());
            assert!(open.iter().all(|open| open.abs() < 1e-6), "{name}: {open:?} {ledger:?}");
            let air = ledger.air();
            assert!(air.residual.abs() < 1e-7 * air.turnover, "{name}: {air:?}");
            if hysteresis.is_some() {
                assert!(ledger.actuators.iter().all(|of| of.slip > 0.0), "{name}: {ledger:?}");
            }
        }
    }
}

#[test]
fn derivatives_are_those_of_finite_differences() {
    type Number = mckibben::Seeded;
    for (name, solenoid, command) in valves() {
        let pair = pair(solenoid, command, Some(falling()));
        let at = |mass: f64| pair.clone().with(|pair| pair.limb.mass = mass).run(0.2, TIGHT).at(0.2).angle;
        let rig = pair
            .rig()
            .expect("a rig")
            .map(|parameter, value| crate::common::toward(value, f64::from(u8::from(parameter.key == "load.mass"))));
        let constant = |value: f64| Number::constant(value);
        let plain = pair.initial();
        let initial = JointInitial {
            gauge_pressure: plain.gauge_pressure.map(|gauge| GaugePressure(constant(gauge.0))),
            temperature: plain.temperature.map(constant),
            angle: InitialAngle::At(constant(0.1)),
            angular_velocity: constant(0.0),
        };
        let (joint, start) = (JointPlant::new(&rig).expect("a plant"), rig.begin(&initial).expect("a start"));
        let run = joint.simulate(&start, constant(0.2), TIGHT).expect("a run");
        let angle = run.at(constant(0.2)).angle;
        let (mass, step) = (pair.limb.mass, 1e-5);
        assert_close(angle.value(), at(mass), 1e-8);
        println!("{name}");
        assert_close(angle.slope[0], (at(mass + step) - at(mass - step)) / (2.0 * step), 1e-4);
    }
}
