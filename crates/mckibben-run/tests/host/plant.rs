//! A scenario as a plant that a host steps: names, commands, distances, outputs, and the way back.

use mckibben::GaugePressure;
use mckibben_run::host::{CommandMode, HostBatch, HostOptions, HostPlant, Motion};
use mckibben_scenario::Document;

/// A muscle of the paper with a valve of two poppets, 25 Hz pulses, at 90 mm and 40 psi.
pub(crate) const MUSCLE: &str = r#"
[supply]
gauge_pressure = "100 psi"
[valve]
preset = "matrix-eight-channel"
[command]
kind = "pwm"
frequency = "25 Hz"
duty = 0.5
[load]
kind = "hanging-mass"
mass = "5 lb"
[initial]
length = "90 mm"
gauge_pressure = "40 psi"
[run]
duration = "1 s"
engine = "fixed-step"
step = "0.5 ms"
"#;
/// A muscle of the paper on a pressure regulator.
pub(crate) const REGULATED: &str = r#"
[supply]
gauge_pressure = "6 bar"
[valve]
kind = "pressure-regulator"
flow_area = "2 mm^2"
time_constant = "20 ms"
rate_limit = "50 bar/s"
[command]
kind = "set-points"
time = ["0 s"]
gauge_pressure = ["3 bar"]
[load]
kind = "isometric"
[initial]
length = "90 mm"
[run]
duration = "1 s"
"#;
const PSI: f64 = 6_894.757_293_168_361;
const POUND: f64 = 0.453_592_37;

pub(crate) fn document(text: &str) -> Document {
    Document::parse(text, "muscle.toml").expect("TOML")
}

pub(crate) fn host(text: &str, options: &HostOptions<'_>) -> HostPlant {
    HostPlant::read(&document(text), options).expect("a plant")
}

fn output(host: &mut HostPlant, name: &str) -> f64 {
    let at = host.outputs().iter().position(|column| column.name == name);
    let mut all = vec![0.0; host.outputs().len()];
    host.read_outputs(&mut all).expect("as many");
    all[at.unwrap_or_else(|| panic!("no output {name}"))]
}

/// A load that a host integrates comes to where the scenario's own load does, to first order in the step.
#[test]
fn a_mass_of_the_host_moves_as_that_of_the_scenario() {
    // Dry friction at rest is set-valued: the owner of the load has to hold it, so it would blur the order.
    let text = MUSCLE.replace("[load]", "[actuator.friction]\ncoulomb_width = \"0 in\"\n[load]");
    let (requests, duration) = (HostOptions { command_mode: Some("request"), ..HostOptions::default() }, 0.05);
    let fine = HostOptions { motion: Motion::Scenario, max_step: Some(1e-6), ..requests };
    let mut whole = host(&text, &fine);
    whole.command(0, 1.0).expect("a request");
    whole.advance(duration, &[]).expect("a run");
    let length = output(&mut whole, "actuator.length");
    assert!((0.066..0.089).contains(&length), "free, and moved: {length} m");
    let error = |count: u32| {
        let mut of = host(&text, &requests);
        of.command(0, 1.0).expect("a request");
        let (mut distance, mut velocity, step) = (0.09, 0.0, duration / f64::from(count));
        let mut response = [of.steps_mut().compute(0).expect("a response")];
        for k in 1..=count {
            of.compute_at(&[distance], &[velocity], &mut response).expect("a response");
            velocity += (9.80665 - response[0].tension / (5.0 * POUND)) * step;
            distance += velocity * step;
            of.advance(f64::from(k) * step, &[distance]).expect("a step");
        }
        (distance - length).abs()
    };
    let errors = [2000, 4000, 8000].map(error);
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 1.0).abs() < 0.15, "order {order} of {errors:?} m");
    }
}

/// Each valve has the mode that it takes, and its name says so.
#[test]
fn commands_are_named_by_actuator_and_mode() {
    let named = |text: &str| host(text, &HostOptions::default()).commands()[0].name.clone();
    assert_eq!(named(MUSCLE), "actuator.duty");
    let held = MUSCLE.replace("kind = \"pwm\"\nfrequency = \"25 Hz\"\nduty = 0.5", "kind = \"fill\"");
    assert_eq!(named(&held), "actuator.request");
    let of = host(&held, &HostOptions { pulse_frequency: Some(50.0), ..HostOptions::default() });
    assert!(matches!(of.commands()[0].mode, CommandMode::Duty(pulses) if pulses.frequency == 50.0));
    let set_point = HostOptions { command_mode: Some("set-point"), ..HostOptions::default() };
    let refused = HostPlant::read(&document(MUSCLE), &set_point).expect_err("a valve with seats").to_string();
    assert!(refused.contains("command_mode=\"duty\" or command_mode=\"request\""), "{refused}");
}

/// Actuators on one tank are one plant with the names of the file.
#[test]
fn an_arm_on_one_tank_is_one_plant() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/plant/arm.toml");
    let document = Document::load(path).expect("an example");
    let options = HostOptions { command_mode: Some("request"), ..HostOptions::default() };
    let mut arm = HostPlant::read(&document, &options).expect("an arm");
    let count = arm.actuators().len();
    assert!(count >= 4 && arm.commands().len() == count, "{:?}", arm.commands());
    let distances: Vec<f64> = (0..count).map(|actuator| arm.distance(actuator)).collect();
    arm.command(0, 1.0).expect("a command");
    let name = arm.actuators()[0].clone();
    let begin = output(&mut arm, &format!("{name}.gauge_pressure"));
    arm.advance(0.2, &distances).expect("a step");
    assert!(output(&mut arm, &format!("{name}.gauge_pressure")) > begin + 1e4);
}

/// An arm that its scenario moves goes back to a state from wherever it is, and on to the same bits.
#[test]
fn an_arm_goes_back_from_another_mode() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/plant/arm.toml");
    let document = Document::load(path).expect("an example");
    let options = HostOptions { motion: Motion::Scenario, command_mode: Some("request"), ..HostOptions::default() };
    let mut arm = HostPlant::read(&document, &options).expect("an arm");
    let mut numbers = vec![0.0; arm.state_size()];
    let on = |arm: &mut HostPlant| {
        arm.command(2, 1.0).expect("a request");
        arm.advance(0.3, &[]).expect("steps");
        arm.steps().state().to_vec()
    };
    arm.command(0, 1.0).expect("a request");
    arm.advance(0.1, &[]).expect("steps");
    arm.save(&mut numbers).expect("a state");
    let there = on(&mut arm);
    arm.restore(&numbers).expect("a state");
    assert_eq!(on(&mut arm), there);
    let begin = |arm: &mut HostPlant| {
        arm.reset();
        arm.advance(0.1, &[]).expect("steps");
        arm.steps().state().to_vec()
    };
    let mut fresh = HostPlant::read(&document, &options).expect("an arm");
    assert_eq!(begin(&mut arm), begin(&mut fresh));
}

/// A state goes to numbers and back, and the plant goes on to the same bits; an equal command changes nothing.
#[test]
fn what_is_restored_goes_on_bit_for_bit() {
    let (mut of, mut other, mut once) = {
        let new = || host(MUSCLE, &HostOptions::default());
        (new(), new(), new())
    };
    let mut numbers = vec![0.0; of.state_size()];
    let step = |of: &mut HostPlant, k: u32| {
        of.command(0, 0.7).expect("a duty cycle");
        of.advance(f64::from(k) * 1e-3, &[0.09 - 1e-5 * f64::from(k % 40)]).expect("a step");
    };
    (1..=60).for_each(|k| step(&mut of, k));
    of.save(&mut numbers).expect("a state");
    (61..=200).for_each(|k| step(&mut of, k));
    let there = of.steps().state().to_vec();
    other.restore(&numbers).expect("a state");
    (61..=200).for_each(|k| step(&mut other, k));
    assert_eq!(other.steps().state(), there);
    once.command(0, 0.7).expect("a duty cycle");
    for k in 1..=200 {
        once.advance(f64::from(k) * 1e-3, &[0.09 - 1e-5 * f64::from(k % 40)]).expect("a step");
    }
    assert_eq!(once.steps().state(), there, "set once and left alone");
    // Behind the time stand the states.
    let distance = 1 + of.steps().plant().indices().mechanisms[0].position(0);
    for none in [0.0, -0.09, f64::NAN, 0.5] {
        let edited = [&numbers[..distance], &[none], &numbers[distance + 1..]].concat();
        assert!(of.restore(&edited).expect_err("no distance").to_string().contains("no state of this plant"), "{none}");
    }
    assert_eq!(of.steps().state(), there, "where it was");
    of.reset();
    assert_eq!(of.steps().time(), 0.0);
}

/// A pressure that the host sets is that of other air at the temperature that there is, and the tension of (1) is linear in it.
#[test]
fn a_host_sets_a_pressure() {
    let mut of = host(MUSCLE, &HostOptions::default());
    let before = of.steps_mut().compute(0).expect("a response");
    let mass = output(&mut of, "actuator.air_mass");
    of.steps_mut().set_pressure(0, GaugePressure(3e5)).expect("a pressure");
    let after = of.steps_mut().compute(0).expect("a response");
    assert!((after.temperature / before.temperature - 1.0).abs() < 1e-12);
    assert!((output(&mut of, "actuator.gauge_pressure") - 3e5).abs() < 1e-6);
    let ratio = (3e5 + 101_325.0) / (40.0 * PSI + 101_325.0);
    assert!((output(&mut of, "actuator.air_mass") / mass / ratio - 1.0).abs() < 1e-12);
    let (rise, expected) = (after.tension - before.tension, before.per_pressure * (3e5 - 40.0 * PSI));
    assert!((rise / expected - 1.0).abs() < 1e-9, "{rise} N for {expected} N");
    for (actuator, gauge) in [(0, -2e5), (0, f64::NAN), (1, 0.0)] {
        assert!(of.steps_mut().set_pressure(actuator, GaugePressure(gauge)).is_err());
    }
    assert_eq!(of.steps_mut().compute(0).expect("a response"), after);
}

/// A host begins where its model has the ends.
#[test]
fn a_plant_begins_at_distances_of_the_host() {
    let mut of = host(MUSCLE, &HostOptions::default());
    of.begin_at(&[0.085], &[0.01]).expect("a start");
    assert_eq!((of.distance(0), of.steps().time()), (0.085, 0.0));
    assert!((output(&mut of, "actuator.gauge_pressure") - 40.0 * PSI).abs() < 1e-6);
    assert!(of.begin_at(&[0.5], &[0.0]).is_err(), "longer than the thread");
    assert!(of.begin_at(&[], &[]).is_err());
    assert!(of.begin_at(&[0.0], &[0.0]).is_err());
    assert_eq!(of.distance(0), 0.085);
}

/// What cannot be is said, and changes nothing.
#[test]
fn what_cannot_be_is_refused() {
    let mut of = host(MUSCLE, &HostOptions::default());
    let state = of.steps().state().to_vec();
    let response = of.steps_mut().compute(0).expect("a response");
    for refused in [
        of.command(0, 1.5),
        of.command(0, f64::NAN),
        of.command(7, 0.5),
        of.advance(1e-3, &[]),
        of.advance(1e-3, &[f64::NAN]),
        of.advance(1e-3, &[0.5]),
        of.advance(-1.0, &[0.09]),
        of.advance(f64::INFINITY, &[0.09]),
        of.advance(1e-3, &[-0.09]),
        of.advance(1e-3, &[0.0]),
        of.compute_at(&[0.09], &[f64::NAN], &mut [response]),
        of.compute_at(&[0.5], &[0.0], &mut [response]),
        of.begin_at(&[0.09], &[f64::NAN]),
        of.begin_at(&[0.09], &[f64::INFINITY]),
        of.read_outputs(&mut []),
        of.save(&mut []),
        of.restore(&[0.0]),
    ] {
        assert!(!refused.expect_err("refused").to_string().is_empty());
    }
    assert_eq!(of.steps().state(), state);
    let mut whole = host(MUSCLE, &HostOptions { motion: Motion::Scenario, ..HostOptions::default() });
    assert!(whole.advance(1e-3, &[0.09]).is_err() && whole.begin_at(&[0.09], &[0.0]).is_err());
    assert!(whole.advance(f64::NAN, &[]).is_err());
    whole.advance(1e-2, &[]).expect("a step");
    whole.advance(1e-2, &[]).expect("no step");
    let back = whole.advance(5e-3, &[]).expect_err("a step back").to_string();
    assert!(back.contains("0.005 s") && back.contains("0.01 s"), "{back}");
    // The edges of its pulses would fill the memory.
    let mut long =
        host(&MUSCLE.replace("0.5 ms", "1e6 s"), &HostOptions { motion: Motion::Scenario, ..HostOptions::default() });
    long.command(0, 0.5).expect("a duty cycle");
    assert!(long.advance(1e6, &[]).expect_err("a long step").to_string().contains("edges of pulses"));
    let late = HostOptions { max_step: Some(0.0), ..HostOptions::default() };
    assert!(HostPlant::read(&document(MUSCLE), &late).is_err());
    let never = HostOptions { pulse_frequency: Some(0.0), ..HostOptions::default() };
    let held = MUSCLE.replace("kind = \"pwm\"\nfrequency = \"25 Hz\"\nduty = 0.5", "kind = \"fill\"");
    assert!(HostPlant::read(&document(&held), &never).is_err());
}

/// Where a scenario moves, its steps are those that `run.accuracy` allows for its run, with its commands and controllers.
#[test]
fn a_scenario_moves_by_the_steps_of_its_own_run() {
    let whole = HostOptions { motion: Motion::Scenario, ..HostOptions::default() };
    let named = format!("{}\n[actuators.muscle]\n", MUSCLE.replace("step = \"0.5 ms\"\n", ""));
    let experiment = document(&named).plant_experiment().expect("a plant").expect("with names");
    let own = experiment.stepping().expect("a step").1.expect("chosen").step;
    assert!(own < 5e-4, "{own} s");
    assert_eq!(host(&named, &whole).step(), Some(own));
    assert_eq!(host(&named, &HostOptions { max_step: Some(1e-5), ..whole }).step(), Some(1e-5));
    assert_eq!(host(MUSCLE, &whole).step(), Some(5e-4));
}

/// A supply whose pressure changes is an output, of one actuator and of a joint; one without end is none.
#[test]
fn supplies_that_change_are_outputs() {
    let outputs = |text: &str| -> Vec<String> {
        let of = host(text, &HostOptions::default());
        of.outputs().iter().map(|column| column.name.clone()).filter(|name| name.contains("supply")).collect()
    };
    let both = |name: &str| [format!("{name}.absolute_pressure"), format!("{name}.gauge_pressure")];
    let with = |more: &str| MUSCLE.replace("[valve]", &format!("{more}\n[valve]"));
    assert!(outputs(MUSCLE).is_empty());
    assert_eq!(outputs(&with("reservoir_volume = \"50 mL\"")), both("supply"));
    assert_eq!(outputs(&with("lag = \"20 ms\"")), both("supply"));
    let of = outputs(&with("reservoir_volume = \"50 mL\"\nlag = \"20 ms\""));
    assert_eq!(of, [both("supply.reservoir"), both("supply")].concat());

    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/line/joint.toml");
    let joint = std::fs::read_to_string(path).expect("an example");
    assert_eq!(outputs(&joint), both("supply"));
    let of = outputs(&format!("{joint}\n[antagonist.supply]\nreservoir_volume = \"0.2 L\"\n"));
    assert_eq!(of, [both("agonist_supply"), both("antagonist_supply")].concat());
}

/// A bottle sags while it fills a muscle.
#[test]
fn a_supply_that_is_drawn_from_sags() {
    let text = MUSCLE.replace("[valve]", "reservoir_volume = \"50 mL\"\n[valve]");
    let mut of = host(&text, &HostOptions { command_mode: Some("request"), ..HostOptions::default() });
    assert!((output(&mut of, "supply.gauge_pressure") - 100.0 * PSI).abs() < 1.0);
    of.command(0, 1.0).expect("a request");
    (1..=400).for_each(|count| of.advance(1e-3 * f64::from(count), &[0.09]).expect("a step"));
    let supply = output(&mut of, "supply.gauge_pressure");
    assert!((40.0 * PSI..99.0 * PSI).contains(&supply), "{supply} Pa");
}

/// A set point lies between zero and the gauge pressure of the supply, and a plant of a batch has its own supply.
#[test]
fn a_set_point_ends_at_the_supply() {
    let mut of = host(REGULATED, &HostOptions::default());
    assert_eq!(of.commands()[0].name, "actuator.set_point");
    let (low, high, unit) = of.commands()[0].mode.range();
    assert!(low == 0.0 && (high - 6e5).abs() < 1e-6 && unit == "Pa", "{low} to {high} {unit}");
    of.command(0, high).expect("the pressure of the supply");
    for number in [30e5, -1.0, f64::NAN] {
        let refused = of.command(0, number).expect_err("out of range").to_string();
        assert!(refused.contains(&format!("`actuator.set_point` = {number:?} Pa")), "{refused}");
        assert!(refused.contains("0.0 to ") && refused.contains("more than feeds it"), "{refused}");
    }
    let lower = host(&REGULATED.replace("6 bar", "4 bar"), &HostOptions::default());
    let mut batch = HostBatch::new([of, lower]).expect("scenarios that differ in numbers");
    batch.command(&[5e5, 3e5]).expect("set points");
    let refused = batch.command(&[3e5, 5e5]).expect_err("above the second supply").to_string();
    assert!(refused.contains("`actuator.set_point` = 500000.0 Pa"), "{refused}");
}

/// A request to hold is that of a scenario: five-way valves that supply or exhaust their outputs at rest fill or exhaust,
/// also in a joint and where actuators have names, each with its own valve.
#[test]
fn a_request_to_hold_is_that_of_the_scenario() {
    let requests = HostOptions { command_mode: Some("request"), ..HostOptions::default() };
    let held = MUSCLE.replace("kind = \"pwm\"\nfrequency = \"25 Hz\"\nduty = 0.5", "kind = \"fill\"");
    let of_kind = |kind: &str| {
        held.replace("preset = \"matrix-eight-channel\"", &format!("kind = \"{kind}\"\nflow_area = \"0.3 mm^2\""))
    };
    let after = |text: &str, output: &str, number: f64| {
        let mut of = host(text, &requests);
        let inputs = of.commands().len();
        (0..inputs).for_each(|input| of.command(input, number).expect("a request"));
        let (distances, before) = (vec![0.09; of.actuators().len()], self::output(&mut of, output));
        of.advance(0.02, &distances).expect("a step");
        (self::output(&mut of, output) - before, of.requests(0))
    };
    for (kind, requested) in [("five-way-pressurised", 1.0), ("five-way-exhausted", -1.0)] {
        let text = of_kind(kind);
        let (held, all) = after(&text, "actuator.gauge_pressure", 0.0);
        assert_eq!(all, [-1.0, 0.0, 1.0]);
        assert_eq!(held, after(&text, "actuator.gauge_pressure", requested).0, "{kind}");
        assert!(held * requested > 1e3, "{kind}: {held} Pa");
    }
    let (still, _) = after(&of_kind("five-way-closed"), "actuator.gauge_pressure", 0.0);
    assert!(still.abs() < 1.0, "{still} Pa");
    // A valve of an actuator in the place of the common one.
    let own = "[actuators.one]\n[actuators.two.valve]\npreset = \"matrix-eight-channel\"\n";
    let named = format!("{}\n{own}", of_kind("five-way-exhausted"));
    let two = host(&named, &requests);
    assert_eq!((two.requests(0), two.requests(1)), (vec![-1.0, 0.0, 1.0], vec![-1.0, 1.0]));
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/valves/five-way-joint.toml");
    let joint = std::fs::read_to_string(path).expect("an example").replace("five-way-closed", "five-way-pressurised");
    let joint = host(&joint, &requests);
    assert_eq!(joint.requests(1), [-1.0, 0.0, 1.0], "the antagonist has the valve of the file");
}

/// Hoses begin at the pressure of the actuator that they lead to, also where the host gives it.
#[test]
fn a_hose_begins_at_the_pressure_of_the_host() {
    let text = MUSCLE.replace("[load]", "[hose]\nlength = \"1 m\"\ndiameter = \"2.5 mm\"\n[load]");
    let mut of = host(&text, &HostOptions { command_mode: Some("request"), ..HostOptions::default() });
    of.begin_with_pressures(&[0.085], &[0.0], &[Some(3e5)]).expect("a start");
    assert!((output(&mut of, "actuator.gauge_pressure") - 3e5).abs() < 1e-6);
    assert!((output(&mut of, "actuator.hose_gauge_pressure") - 3e5).abs() < 1e-6);
    of.begin_with_pressures(&[0.085], &[0.0], &[None]).expect("a start");
    assert!((output(&mut of, "actuator.hose_gauge_pressure") - 40.0 * PSI).abs() < 1e-6);
    assert!(of.begin_with_pressures(&[0.085], &[0.0], &[Some(-2e5)]).is_err());
}

/// A state has places for 64 commands of a valve; one more is refused with what a host can do.
#[test]
fn more_commands_on_their_way_than_a_state_holds_have_a_remedy() {
    let text = REGULATED.replace("rate_limit", "dead_time = \"0.1 s\"\nrate_limit");
    let mut of = host(&text, &HostOptions::default());
    let mut numbers = vec![0.0; of.state_size()];
    for step in 1..=80_u32 {
        of.command(0, 1e5 + f64::from(step)).expect("a set point");
        of.advance(f64::from(step) * 1e-3, &[0.09]).expect("a step");
        if step == 60 {
            of.save(&mut numbers).expect("a state");
        }
    }
    let refused = of.save(&mut numbers).expect_err("80 commands").to_string();
    assert!(refused.contains("more than 64 commands") && refused.contains("shorten valve.dead_time"), "{refused}");
    assert!(!refused.contains("PlantSteps"), "{refused}");
}

/// A request that a valve does not have is refused with those that it has.
#[test]
fn requests_are_those_of_the_valve() {
    let requests = HostOptions { command_mode: Some("request"), ..HostOptions::default() };
    let mut three_way = host(MUSCLE, &requests);
    assert_eq!(three_way.requests(0), [-1.0, 1.0]);
    let refused = three_way.command(0, 0.0).expect_err("a three-way valve cannot hold").to_string();
    assert!(
        refused.contains("`actuator.request` = 0.0 is") && refused.contains("1 (fill) or -1 (exhaust)"),
        "{refused}"
    );
    let held = MUSCLE.replace("kind = \"pwm\"\nfrequency = \"25 Hz\"\nduty = 0.5", "kind = \"hold\"");
    let two_way = held.replace("preset = \"matrix-eight-channel\"", "kind = \"two-way\"\nflow_area = \"2 mm^2\"");
    let mut two_way = host(&two_way, &requests);
    assert_eq!(two_way.requests(0), [0.0, 1.0]);
    let refused = two_way.command(0, -1.0).expect_err("a two-way valve cannot exhaust").to_string();
    assert!(refused.contains("1 (fill) or 0 (hold)"), "{refused}");
    assert!(host(REGULATED, &HostOptions::default()).requests(0).is_empty());
}
