//! Sensors, sampling, set points, modulation, relays and the laws that are made of them.

use crate::common::{ATMOSPHERE, PSI, Paper, ROOM, assert_close, assert_within, between, spread};
use mckibben::control::{
    AirMass, Between, Controller, Drive, FeedForward, JointController, JointMeasurement, JointSensors, JointTracker,
    MAX_DELAY, Measurement, Modulator, Output, Pid, Place, Quantity, Regulator, Relay, Sampled, Sampling, Sensor,
    Sensors, SetPoint, StaticAim, Tracker,
};
use mckibben::valve::{Command, Request};
use mckibben::{Dual, Error, GaugePressure, Over, Scalar};
use std::collections::BTreeSet;

fn seen(time: f64) -> Measurement {
    let pressure = GaugePressure(2e5);
    Measurement { time, length: 0.09, velocity: -0.01, pressure, air_mass: 2e-5, tension: 15.0 }
}

fn relay(quantity: Quantity, dead_band: f64, hysteresis: f64) -> Regulator {
    Regulator::Relay(Relay::new(quantity, dead_band, hysteresis, Between::Hold).expect("a relay"))
}

// Parameters

#[test]
fn rows_are_complete_and_those_of_a_quantity_have_its_unit() {
    let mut keys = BTreeSet::new();
    for row in mckibben::parameter::CONTROL {
        assert!(keys.insert(row.key) && row.key.starts_with("controller."), "{}", row.key);
    }
    for quantity in Quantity::ALL {
        let rows = quantity.rows();
        let own = [
            &rows.amplitude,
            &rows.dead_band,
            &rows.hysteresis,
            &rows.proportional_band,
            &rows.resolution,
            &rows.range,
        ];
        for row in own {
            assert_eq!(row.unit, rows.set_point.unit, "{}", row.key);
            assert!(!keys.contains(row.key), "{}", row.key);
        }
        for row in own.into_iter().chain([rows.set_point]) {
            assert!(row.meaning.ends_with('.') && !row.remedy.is_empty() && !row.symbol.is_empty(), "{}", row.key);
            assert!(row.default.is_none_or(|default| row.range.contains(default)), "{}", row.key);
        }
    }
}

// Sensors

#[test]
fn a_sensor_shows_the_nearest_multiple_of_its_step() {
    let step = 0.25;
    let sensor = Sensor::new(Quantity::Pressure, step, None).expect("a sensor");
    for row in 0..500 {
        let value = between(row, 0, -1e3, 1e3);
        let shown = sensor.show(value);
        assert!((shown - value).abs() <= 0.5 * step, "{value} is shown as {shown}");
        assert_eq!((shown / step).fract(), 0.0);
        assert_eq!(sensor.show(shown), shown);
    }
    assert_eq!([-0.375, -0.125, 0.125, 0.375, 0.124].map(|value| sensor.show(value)), [-0.25, 0.0, 0.25, 0.5, 0.0]);
    assert_eq!(sensor.show(1e300), 1e300);
    assert_eq!(Sensor::perfect().show(0.123), 0.123);
}

#[test]
fn a_sensor_stops_at_the_ends_of_its_range() {
    let sensor = Sensor::new(Quantity::Pressure, 10.0, Some((0.0, 155.0))).expect("a sensor");
    assert_eq!([-7.0, 4.0, 149.0, 154.0, 1e9].map(|value| sensor.show(value)), [0.0, 0.0, 150.0, 150.0, 155.0]);
    for (step, range, key) in [
        (-1.0, None, "controller.resolution"),
        (f64::NAN, None, "controller.resolution"),
        (0.0, Some((1.0, 1.0)), "controller.sensor_range"),
        (0.0, Some((f64::NAN, 1.0)), "controller.sensor_range"),
    ] {
        let message = Sensor::new(Quantity::Pressure, step, range).expect_err("refused").to_string();
        assert!(message.contains(key), "{message}");
    }
}

#[test]
fn what_a_sensor_has_rounded_has_no_derivative() {
    let value = Dual::<f64, 1>::variable(0.37, 0);
    let wide = |sensor: Sensor| sensor.map(Dual::<f64, 1>::of);
    assert_eq!(wide(Sensor::perfect()).show(value).slope, [1.0]);
    let stepped = wide(Sensor::new(Quantity::Length, 0.1, None).expect("a sensor")).show(value);
    assert_eq!(stepped.slope, [0.0]);
    assert_within(stepped.value, 0.4, 1e-15);
}

#[test]
fn each_quantity_has_its_own_sensor() {
    let coarse = |step| Sensor::new(Quantity::Length, step, None).expect("a sensor");
    let perfect = Sensors::perfect();
    assert_eq!(perfect.show(&seen(0.3)), seen(0.3));
    let sensors = Sensors { length: coarse(0.02), pressure: coarse(3e4), ..perfect };
    let shown = sensors.show(&seen(0.3));
    assert_within(shown.length, 0.1, 1e-15);
    assert_eq!(shown, Measurement { length: shown.length, pressure: GaugePressure(2.1e5), ..seen(0.3) });
    let truth = JointMeasurement { time: 0.3, angle: 0.31, angular_velocity: 1.0, actuators: [seen(0.3); 2] };
    let joint = JointSensors { angle: coarse(0.25), actuators: [sensors, perfect], ..JointSensors::perfect() };
    assert_eq!(joint.show(&truth), JointMeasurement { angle: 0.25, actuators: [shown, seen(0.3)], ..truth });
}

// Sampling

#[test]
fn sampling_instants_never_drift() {
    let sampling = Sampling::new(1000.0, 0).expect("a rate");
    // The nearest double to each decimal time, the millionth as the first.
    for (index, instant) in [(1, 0.001), (3, 0.003), (7, 0.007), (1_000_001, 1000.001), (123_456_789, 123456.789)] {
        assert_eq!(sampling.instant(index), instant);
    }
}

#[test]
fn a_decision_takes_effect_after_the_delay() {
    for delay in [0, 1, 2, 5, MAX_DELAY] {
        let sampling = Sampling::new(100.0, delay).expect("a rate");
        let mut sampled = Sampled::begin(0_u32);
        for k in 0..60_usize {
            assert_eq!(sampled.next(&sampling), k as f64 / 100.0);
            let effective = sampled.take(&sampling, |memory| {
                *memory += 1;
                k
            });
            assert_eq!(effective, k.checked_sub(delay), "delay {delay}");
            assert_eq!(sampled.memory, k as u32 + 1);
        }
    }
    for (rate, delay, key) in [(0.0, 0, "controller.rate"), (1.0, MAX_DELAY + 1, "controller.delay")] {
        assert!(Sampling::new(rate, delay).expect_err("refused").to_string().contains(key));
    }
    let pulses = Sampling::new(1.0, 0).expect("a rate").with_pulse_frequency(-1.0);
    assert!(pulses.expect_err("refused").to_string().contains("controller.pulse_frequency"));
}

#[test]
fn a_run_goes_on_from_a_copy_of_its_memory() {
    let pid = Pid::new(Quantity::Pressure, 1e5, Output::FillExhaust).and_then(|pid| pid.with_integral(0.1));
    let set_point = SetPoint::constant(Quantity::Pressure, 2.5e5).expect("a set point");
    let tracker = Tracker::new(Quantity::Pressure, set_point, Regulator::Pid(pid.expect("one"))).expect("a tracker");
    let sampling = Sampling::new(50.0, 3).expect("a rate");
    let samples = |start: &Sampled<_, Option<_>>, range: std::ops::Range<u64>| {
        let mut sampled = *start;
        let drives: Vec<_> = range
            .map(|k| {
                let pressure = GaugePressure(3e5 * spread(k as usize, 0));
                let seen = Measurement { pressure, ..seen(sampling.instant(k)) };
                sampled.take(&sampling, |memory| Some(tracker.decide(&seen, memory)))
            })
            .collect();
        (sampled, drives)
    };
    let begun = Sampled::begin(tracker.begin());
    let (halfway, first) = samples(&begun, 0..20);
    let (end, rest) = samples(&halfway, 20..40);
    assert_eq!(samples(&begun, 0..40), (end, [first, rest].concat()));
    assert_eq!(samples(&halfway, 20..40).0, end);
}

// Set points

#[test]
fn set_points_over_time() {
    let sine = SetPoint::sinusoid(Quantity::Length, 0.09, 0.005, 2.0, 0.3).expect("a set point");
    for time in [0.0_f64, 0.1, 0.77] {
        let expected = 0.09 + 0.005 * (4.0 * std::f64::consts::PI * time + 0.3).sin();
        assert_within(sine.at(time), expected, 1e-16);
    }
    let (time, value) = (vec![0.2, 0.3, 0.7], vec![1.0, 3.0, 2.0]);
    let lines = SetPoint::lines(Quantity::Force, time.clone(), value.clone()).expect("a set point");
    for (time, expected) in [(0.0, 1.0), (0.2, 1.0), (0.25, 2.0), (0.3, 3.0), (0.5, 2.5), (0.7, 2.0), (9.0, 2.0)] {
        assert_within(lines.at(time), expected, 1e-14);
    }
    let steps = SetPoint::steps(Quantity::Force, time, value).expect("a set point");
    // 3/10 s is a rounding below 0.1 s + 0.2 s: the step at 0.3 s is seen by either.
    for (time, expected) in [(0.0, 1.0), (0.29, 1.0), (0.1 + 0.2, 3.0), (3.0 / 10.0, 3.0), (0.69, 3.0), (0.7, 2.0)] {
        assert_eq!(steps.at(time), expected, "at {time}");
    }
    let wide = lines.map(Quantity::Force, |row, value| {
        if row.key == "controller.time" { Dual::<f64, 1>::variable(value, 0) } else { Dual::of(value) }
    });
    // All times later together: the slope of the line, backwards.
    assert_within(wide.at(Dual::of(0.5)).slope[0], 2.5, 1e-13);
}

#[test]
fn set_points_that_a_quantity_cannot_have_are_refused() {
    let refused = |result: Result<SetPoint, Error>, part: &str| {
        let message = result.expect_err("refused").to_string();
        assert!(message.contains(part), "{message}");
    };
    refused(SetPoint::constant(Quantity::Force, -1.0), "controller.force = -1 N");
    refused(SetPoint::constant(Quantity::Length, 0.0), "controller.length = 0 m");
    refused(SetPoint::sinusoid(Quantity::Force, 1.0, 2.0, 1.0, 0.0), "controller.force = -1 N");
    refused(SetPoint::sinusoid(Quantity::Angle, 1.0, -2.0, 1.0, 0.0), "controller.amplitude = -2 rad");
    refused(SetPoint::sinusoid(Quantity::Angle, 1.0, 2.0, 0.0, 0.0), "controller.frequency");
    refused(SetPoint::lines(Quantity::Angle, vec![], vec![]), "controller.angle: there is not one value");
    refused(SetPoint::lines(Quantity::Angle, vec![0.0], vec![1.0, 2.0]), "entry 2");
    refused(SetPoint::steps(Quantity::Angle, vec![0.0, 0.0], vec![1.0, 2.0]), "controller.time: the times do not rise");
    refused(SetPoint::steps(Quantity::Force, vec![0.0, 1.0], vec![1.0, f64::NAN]), "controller.force = NaN N");
}

// Modulation

/// The requests over time of commands at their instants, up to a time.
fn requested(commands: &[(f64, Drive)], frequency: f64, until: f64) -> Vec<(f64, Request)> {
    let (mut modulator, mut changes) = (Modulator::idle(), Vec::new());
    let mut append = |time: f64, request: Option<Request>| {
        if let Some(request) = request {
            if changes.last().is_some_and(|(last, _)| *last == time) {
                changes.pop();
            }
            changes.push((time, request));
        }
    };
    let mut commands = commands.iter().peekable();
    loop {
        let command = commands.peek().map(|(time, _)| *time);
        let Some(time) = [command, modulator.next(frequency)].into_iter().flatten().min_by(f64::total_cmp) else {
            break;
        };
        if time > until {
            break;
        }
        if command == Some(time) {
            let drive = commands.next().expect("it was peeked").1;
            append(time, modulator.command(drive, time, frequency));
        } else {
            append(time, modulator.pass(time, frequency));
        }
    }
    changes
}

fn fill(duty: f64) -> Drive {
    Drive::Pulses { duty, pulse: Request::Fill, rest: Request::Exhaust }
}

#[test]
fn a_constant_duty_is_the_open_loop_s_modulation() {
    for (frequency, duty) in [(25.0, 0.5), (7.0, 0.123), (50.0, 0.0), (50.0, 1.0)] {
        let command = Command::pwm(frequency, duty, Request::Fill, Request::Exhaust).expect("a command");
        let changes = requested(&[(0.0, fill(duty))], frequency, 20.0);
        let mut index = 0;
        let mut last = None;
        for (time, request) in changes {
            if last == Some(request) {
                // Duties of 0 and 1 say the same again each period.
                continue;
            }
            last = Some(request);
            assert_eq!(command.change(index), Some((time, request)));
            index += 1;
        }
        assert!(index > 0);
        assert!(command.change(index).is_none_or(|(time, _)| time > 20.0), "{index} changes");
    }
}

#[test]
fn a_new_duty_waits_for_the_next_period_and_a_steady_request_does_not() {
    let commands = [(0.0, fill(0.5)), (0.3, fill(0.25)), (1.0, fill(0.75)), (2.1, Drive::Steady(Request::Hold))];
    let expected = [
        (0.0, Request::Fill),
        (0.5, Request::Exhaust),
        (1.0, Request::Fill),
        (1.75, Request::Exhaust),
        (2.0, Request::Fill),
        (2.1, Request::Hold),
    ];
    assert_eq!(requested(&commands, 1.0, 9.0), expected);
    // From a steady request: the request stays until the period begins.
    let commands = [(0.0, Drive::Steady(Request::Hold)), (0.3, fill(0.5)), (1.2, fill(0.1))];
    let expected = [
        (0.0, Request::Hold),
        (1.0, Request::Fill),
        (1.5, Request::Exhaust),
        (2.0, Request::Fill),
        (2.1, Request::Exhaust),
    ];
    assert_eq!(requested(&commands, 1.0, 2.5), expected);
    assert_eq!(requested(&[], 1.0, 9.0), []);
}

#[test]
fn pulses_at_the_rate_of_the_samples_start_with_them() {
    for rate in [3.0, 30.0, 49.0, 1000.0 / 3.0] {
        let sampling = Sampling::new(rate, 0).expect("a rate");
        let frequency = sampling.pulse_frequency();
        for begins in [1_u64, 2, 5, 999, 123_457] {
            // Steady before, so that the period is found from the time alone.
            let mut modulator = Modulator::idle();
            let time = sampling.instant(begins);
            modulator.command(Drive::Steady(Request::Hold), sampling.instant(begins - 1), frequency);
            assert_eq!(modulator.command(fill(0.25), time, frequency), None);
            assert_eq!(modulator.next(frequency), Some(time));
            assert_eq!(modulator.pass(time, frequency), Some(Request::Fill));
            assert_eq!(modulator.next(frequency), Some((begins as f64 + 0.25) / frequency));
        }
    }
}

#[test]
fn the_end_of_a_pulse_has_the_derivative_of_its_duty() {
    let mut modulator = Modulator::idle();
    let duty = Dual::<f64, 1>::variable(0.4, 0);
    let (zero, frequency) = (Dual::of(0.0), Dual::of(20.0));
    modulator.command(Drive::Pulses { duty, pulse: Request::Fill, rest: Request::Hold }, zero, frequency);
    modulator.pass(zero, frequency);
    let end = modulator.next(frequency).expect("the pulse ends");
    assert_close(end.value, 0.02, 1e-15);
    assert_close(end.slope[0], 1.0 / 20.0, 1e-15);
}

// Bang-bang

#[test]
fn a_relay_fills_below_exhausts_above_and_holds_between() {
    let relay = Relay::new(Quantity::Pressure, 2.0, 0.5, Between::Hold).expect("a relay");
    let series = [
        (0.0, Request::Hold),
        (1.9, Request::Hold),
        (2.1, Request::Fill),
        (1.6, Request::Fill),
        (1.5, Request::Hold),
        (1.9, Request::Hold),
        (-2.0, Request::Hold),
        (-2.1, Request::Exhaust),
        (-1.6, Request::Exhaust),
        (2.5, Request::Fill),
        (-1.6, Request::Hold),
    ];
    let mut before = relay.begin();
    for (error, request) in series {
        before = relay.decide(error, before);
        assert_eq!(before, request, "at {error}");
    }
    let plain = Relay::new(Quantity::Pressure, 2.0, 0.0, Between::Hold).expect("a relay");
    assert_eq!(plain.decide(2.0, Request::Fill), Request::Hold);
}

#[test]
fn a_relay_of_a_three_way_valve_keeps_its_request() {
    let relay = Relay::new(Quantity::Pressure, 2.0, 0.0, Between::Keep).expect("a relay");
    let mut before = relay.begin();
    assert_eq!(before, Request::Exhaust);
    let (fill, exhaust) = (Request::Fill, Request::Exhaust);
    for (error, request) in [(1.0, exhaust), (2.1, fill), (-1.9, fill), (-2.1, exhaust), (1.9, exhaust)] {
        before = relay.decide(error, before);
        assert_eq!(before, request, "at {error}");
    }
}

#[test]
fn a_relay_s_numbers_are_checked() {
    for (dead_band, hysteresis, key) in [
        (-1.0, 0.0, "controller.dead_band = -1 kg"),
        (1.0, -1.0, "controller.hysteresis = -1 kg"),
        (1.0, 1.5, "controller.dead_band = 1 kg"),
    ] {
        let message =
            Relay::new(Quantity::AirMass, dead_band, hysteresis, Between::Hold).expect_err("refused").to_string();
        assert!(message.contains(key), "{message}");
    }
}

// Laws

#[test]
fn a_tracker_requests_air_when_the_length_is_too_long_and_other_quantities_too_low() {
    let wanted = [
        (Quantity::Pressure, 1.9e5, 2.1e5, 1e3),
        (Quantity::AirMass, 1.9e-5, 2.1e-5, 1e-7),
        (Quantity::Force, 14.0, 16.0, 0.1),
        (Quantity::Length, 0.095, 0.085, 1e-4),
    ];
    for (quantity, less, more, band) in wanted {
        for (target, request) in [(less, Request::Exhaust), (more, Request::Fill)] {
            let set_point = SetPoint::constant(quantity, target).expect("a set point");
            let tracker = Tracker::new(quantity, set_point.clone(), relay(quantity, band, 0.0)).expect("a tracker");
            let drive = tracker.decide(&seen(0.0), &mut tracker.begin());
            assert_eq!(drive, Drive::Steady(request), "{quantity:?}");
            assert_eq!(tracker.aim(&seen(0.0)), Some((quantity, target)));
            // The PID's output has the same sign, and its size is the error over the band.
            let pid = Pid::new(quantity, 400.0 * band, Output::FillHoldExhaust).expect("a controller");
            let tracker = Tracker::new(quantity, set_point, Regulator::Pid(pid)).expect("a tracker");
            let error = (target - quantity.of(&seen(0.0)).expect("it has it")).abs();
            let Drive::Pulses { duty, pulse, rest } = tracker.decide(&seen(0.0), &mut tracker.begin()) else {
                panic!("pulses");
            };
            assert_eq!((pulse, rest), (request, Request::Hold), "{quantity:?}");
            assert_close(duty, error / (400.0 * band), 1e-9);
        }
    }
    let angle = SetPoint::constant(Quantity::Angle, 0.1).expect("a set point");
    assert!(Tracker::new(Quantity::Angle, angle, relay(Quantity::Angle, 0.1, 0.0)).is_err());
}

#[test]
fn the_antagonist_does_the_opposite_of_the_agonist() {
    let truth = |angle| JointMeasurement { time: 0.0, angle, angular_velocity: 0.0, actuators: [seen(0.0); 2] };
    let angle = SetPoint::constant(Quantity::Angle, 0.1).expect("a set point");
    let joint = JointTracker { angle, regulator: relay(Quantity::Angle, 0.02, 0.0) };
    for (angle, requests) in [
        (0.0, [Request::Fill, Request::Exhaust]),
        (0.1, [Request::Hold, Request::Hold]),
        (0.2, [Request::Exhaust, Request::Fill]),
    ] {
        assert_eq!(joint.decide(&truth(angle), &mut joint.begin()), requests.map(Drive::Steady));
    }
    assert_eq!(joint.aim(&truth(0.0)), [Some((Quantity::Angle, 0.1)), None]);
    // Two controllers of one actuator each.
    let pressure = |target| {
        let set_point = SetPoint::constant(Quantity::Pressure, target).expect("a set point");
        Tracker::new(Quantity::Pressure, set_point, relay(Quantity::Pressure, 1e3, 0.0)).expect("a tracker")
    };
    let both = [pressure(1e5), pressure(3e5)];
    let drives = JointController::decide(&both, &truth(0.0), &mut JointController::begin(&both));
    assert_eq!(drives, [Request::Exhaust, Request::Fill].map(Drive::Steady));
}

/// The paper's actuator that is to hold 20 N at 3.5 in.
fn aim(length: Place) -> StaticAim {
    let force = SetPoint::constant(Quantity::Force, 20.0).expect("a force");
    StaticAim::new(Paper::sealed().actuator(), force, length, GaugePressure(100.0 * PSI)).expect("an aim")
}

#[test]
fn feed_forward_requests_the_pressure_of_the_model() {
    let at = |length: f64| {
        let paper = Paper::sealed();
        let (b, n) = (paper.thread_length, paper.turns);
        4.0 * std::f64::consts::PI * n * n * 20.0 / (3.0 * length * length - b * b)
    };
    let wanted = SetPoint::constant(Quantity::Length, 0.08).expect("a length");
    for (place, expected) in [(Place::Wanted(wanted), at(0.08)), (Place::Measured, at(0.09))] {
        let law = FeedForward { aim: aim(place), regulator: relay(Quantity::Pressure, 1e3, 0.0) };
        let Some((Quantity::Pressure, pressure)) = law.aim(&seen(0.0)) else { panic!("a pressure") };
        assert_close(pressure, expected, 1e-12);
        for (offset, request) in [(-2e3, Request::Fill), (0.0, Request::Hold), (2e3, Request::Exhaust)] {
            let seen = Measurement { pressure: GaugePressure(expected + offset), ..seen(0.0) };
            assert_eq!(law.decide(&seen, &mut law.begin()), Drive::Steady(request));
        }
    }
    // Slack: no pressure pulls, the highest is requested.
    let law = FeedForward { aim: aim(Place::Measured), regulator: relay(Quantity::Pressure, 1e3, 0.0) };
    let slack = Measurement { length: 0.06, ..seen(0.0) };
    assert_eq!(law.aim(&slack), Some((Quantity::Pressure, 100.0 * PSI)));
    let force = SetPoint::constant(Quantity::Force, 20.0).expect("a force");
    let refused = StaticAim::new(Paper::sealed().actuator(), force, Place::Measured, GaugePressure(0.0));
    assert!(refused.expect_err("refused").to_string().contains("controller.highest_gauge_pressure"));
}

#[test]
fn the_air_mass_of_the_set_point_holds_the_force_at_the_length() {
    let wanted = SetPoint::constant(Quantity::Length, 0.085).expect("a length");
    let law = AirMass::new(aim(Place::Wanted(wanted)), ROOM, relay(Quantity::AirMass, 1e-8, 0.0)).expect("a law");
    let mass = law.mass(&seen(0.0));
    // So much air at that temperature, sealed in at the length: the tension is the force.
    let actuator = Paper::sealed().actuator();
    let volume: f64 = actuator.volume(0.085);
    let pressure = mass * 286.99 * ROOM / volume;
    let force: f64 = actuator.tension_sliding(0.085, 0.0, pressure, 0.0);
    assert_close(force, 20.0, 1e-12);
    assert!(pressure > ATMOSPHERE);
    assert_eq!(law.aim(&seen(0.0)), Some((Quantity::AirMass, mass)));
    for (share, request) in [(0.99, Request::Fill), (1.0, Request::Hold), (1.01, Request::Exhaust)] {
        let seen = Measurement { air_mass: share * mass, ..seen(0.0) };
        assert_eq!(law.decide(&seen, &mut law.begin()), Drive::Steady(request));
    }
    let refused = AirMass::new(aim(Place::Measured), 0.0, relay(Quantity::AirMass, 1e-8, 0.0));
    assert!(refused.expect_err("refused").to_string().contains("controller.temperature"));
}

#[test]
fn a_controller_over_dual_numbers_decides_the_same() {
    let set_point = SetPoint::sinusoid(Quantity::Length, 0.088, 0.004, 1.0, 0.0).expect("a set point");
    let pid = Pid::new(Quantity::Length, 0.01, Output::FillHoldExhaust).and_then(|pid| pid.with_integral(0.2));
    let tracker = Tracker::new(Quantity::Length, set_point, Regulator::Pid(pid.expect("one"))).expect("a tracker");
    let wide = tracker.map(|row, value| {
        if row.key == "controller.amplitude" { Dual::<f64, 1>::variable(value, 0) } else { Dual::of(value) }
    });
    let (mut memory, mut wide_memory) = (tracker.begin(), wide.begin());
    for k in 0..30 {
        let seen = seen(f64::from(k) * 0.02);
        let over = Measurement {
            time: Dual::of(seen.time),
            length: Dual::of(seen.length),
            velocity: Dual::of(seen.velocity),
            pressure: GaugePressure(Dual::of(seen.pressure.0)),
            air_mass: Dual::of(seen.air_mass),
            tension: Dual::of(seen.tension),
        };
        let (narrow, over) = (tracker.decide(&seen, &mut memory), wide.decide(&over, &mut wide_memory));
        let (Drive::Pulses { duty, pulse, .. }, Drive::Pulses { duty: wide_duty, pulse: same, .. }) = (narrow, over)
        else {
            panic!("pulses");
        };
        assert_eq!((wide_duty.value, same), (duty, pulse));
        if k == 5 {
            // p and i at sample 5: −K s₅ − K h/T_i Σ s₀…s₄, with s the sine that the amplitude multiplies.
            let sine = |k: i32| (2.0 * std::f64::consts::PI * f64::from(k) * 0.02).sin();
            let expected = -100.0 * (sine(5) + 0.1 * (0..5).map(sine).sum::<f64>());
            let sign = if pulse == Request::Exhaust { -1.0 } else { 1.0 };
            assert_close(sign * wide_duty.slope[0], expected, 1e-9);
        }
    }
    assert_eq!(Dual::<f64, 1>::zero().slope, [0.0]);
}
