//! What follows from a number where the file leaves it out, in value and derivative; and parts that are switched off.

use mckibben_identify::adjustable::Adjustable;
use mckibben_identify::trajectories::{Observed, Sampling, Subject};
use mckibben_scenario::keys::KEYS;
use mckibben_scenario::{Document, Place, Scenario};

/// A muscle on a bottle, behind a hose.
const BOTTLE: &str = r#"
[actuator]
preset = "colbrunn-2001"

[supply]
gauge_pressure = "70 psi"
reservoir_volume = "40 cm^3"
[hose]
length = "0.6 m"
diameter = "2 mm"
[valve]
kind = "fill-hold-exhaust"
flow_area = "0.3 mm^2"
opening_delay = "3 ms"
closing_delay = "2 ms"
exhaust.flow_area = "0.2 mm^2"
[command]
kind = "table"
time = ["10 ms", "60 ms", "90 ms"]
state = ["fill", "hold", "exhaust"]
[load]
kind = "hanging-mass"
mass = "5 lb"
[initial]
gauge_pressure = "30 psi"
[run]
duration = "0.13 s"
"#;

/// A thread of the file's own, air with a wall, and a regulated tank with a compressor.
const TANK: &str = r#"
[actuator]
preset = "colbrunn-2001"

thread_length = "11 cm"
[air]
process = "energy-balance"
heat_transfer = "0.03 W/K"
[supply]
gauge_pressure = "70 psi"
temperature = "288 K"
reservoir_volume = "40 cm^3"
compressor_displacement = "10 L/min"
cut_in_gauge_pressure = "71 psi"
cut_out_gauge_pressure = "75 psi"
lag = "10 ms"
droop = "2e7 Pa*s/kg"
[valve]
kind = "two-way"
sonic_conductance = "0.1 L/(s*bar)"
critical_ratio = 0.3
opening_delay = "3 ms"
closing_delay = "2 ms"
[command]
kind = "table"
time = ["10 ms", "70 ms"]
state = ["fill", "hold"]
[load]
kind = "hanging-mass"
mass = "5 lb"
[initial]
gauge_pressure = "30 psi"
[run]
duration = "0.13 s"
"#;

/// Two muscles on one bottle, unless the antagonist has its own.
const JOINT: &str = r#"
[actuator]
preset = "colbrunn-2001"

[supply]
gauge_pressure = "70 psi"
reservoir_volume = "40 cm^3"
[valve]
kind = "three-way"
flow_area = "0.3 mm^2"
opening_delay = "3 ms"
closing_delay = "2 ms"
[command]
kind = "pwm"
frequency = "30 Hz"
duty = 0.6
[load]
kind = "antagonistic-joint"
pulley_radius = "15 mm"
rest_length = "3.3 in"
mass = "0.5 kg"
distance = "100 mm"
inertia = "1e-3 kg*m^2"
damping = "0.02 N*m*s/rad"
torque = "0.05 N*m"
hanging_angle = "3 deg"
[initial]
gauge_pressure = "22 psi"
[antagonist]
initial.gauge_pressure = "25 psi"
command.duty = 0.3

[run]
duration = "0.13 s"
"#;

/// The pressure at the end of a hose, by a sensor that is off.
const SERIES: &str = r#"
[actuator]
preset = "colbrunn-2001"

friction.viscous = "4 N*s/m"
[pressure]
at = "hose"
time = ["0 s", "50 ms", "0.1 s"]
gauge_pressure = ["20 psi", "60 psi", "10 psi"]
offset = "1 kPa"
scale = 1.1
shift = "2 ms"
[hose]
length = "1.2 m"
diameter = "2 mm"
[load]
kind = "hanging-mass"
mass = "5 lb"
[run]
duration = "0.13 s"
"#;

/// Two such, of which one has a sensor that is off.
const TWO_SERIES: &str = r#"
[actuator]
preset = "colbrunn-2001"

[pressure]
at = "hose"
time = ["0 s", "50 ms", "0.1 s"]
gauge_pressure = ["20 psi", "40 psi", "30 psi"]
[hose]
length = "1.2 m"
diameter = "2 mm"
[load]
kind = "antagonistic-joint"
pulley_radius = "15 mm"
rest_length = "3.3 in"
mass = "0.5 kg"
distance = "100 mm"
inertia = "1e-3 kg*m^2"
damping = "0.02 N*m*s/rad"
torque = "0.05 N*m"
hanging_angle = "3 deg"

[antagonist.pressure]
at = "hose"
time = ["0 s", "60 ms"]
gauge_pressure = ["24 psi", "30 psi"]
scale = 0.9
[run]
duration = "0.13 s"
"#;

fn document(text: &str) -> Document {
    Document::parse(text, "muscle.toml").unwrap_or_else(|error| panic!("{error}"))
}

fn sampling(scenario: &Scenario) -> Sampling {
    let mut observed = vec![Observed::Length, Observed::GaugePressure, Observed::Tension];
    if scenario.has_joint() {
        observed.extend([Observed::Angle, Observed::AntagonistGaugePressure]);
    }
    Sampling { observed, times: vec![0.0, 0.02, 0.045, 0.085, 0.127], tolerance: 1e-10 }
}

/// The readings with a number at a value, where its range has that.
fn values(sampling: &Sampling, of: &Subject, value: f64) -> Option<Vec<f64>> {
    match sampling.values(of, &[value], &|_| Ok(())) {
        Ok(values) => Some(values),
        Err(error) => {
            let words = error.to_string();
            assert!(words.contains("outside its range"), "{words}");
            None
        }
    }
}

/// Numbers of a file with one value for each path that it says, entries of lists one by one. What it says of both actuators of a
/// joint is one number of both.
fn places(document: &Document, scenario: &mut Scenario) -> Vec<Place> {
    let mut found = Vec::new();
    for path in KEYS.iter().map(|key| key.path).filter(|path| !path.starts_with("run.")) {
        let both = [path.to_owned(), format!("antagonist.{path}")];
        for path in both.into_iter().filter(|path| !path.starts_with("antagonist.") || document.contains(path)) {
            let entries = (0..3).map(|entry| format!("{path}[{entry}]"));
            let paths: Vec<String> = [path.clone()].into_iter().chain(entries).collect();
            let antagonists: Vec<String> = paths
                .iter()
                .map(|path| format!("antagonist.{path}"))
                .filter(|path| document.contains(path.split('[').next().unwrap_or(path)))
                .collect();
            let others = || antagonists.iter().map(String::as_str);
            // A start that is asked for is given by it: the place is looked for in a copy.
            found.extend(paths.iter().filter_map(|path| document.find(path, others(), &mut scenario.clone()).ok()));
        }
    }
    found
}

/// The paths by which the run changes, after each derivative has been compared with a difference of runs.
fn compared(name: &str, text: &str) -> Vec<String> {
    let document = document(text);
    let mut scenario = document.scenario().unwrap_or_else(|error| panic!("{name}: {error}"));
    let (sampling, mut moving) = (sampling(&scenario), Vec::new());
    let width = sampling.observed.len();
    for place in places(&document, &mut scenario) {
        let value = place.value(&mut scenario.clone()).expect("a number");
        let of = Adjustable::new(scenario.clone(), vec![place], document.says_of_each("actuator.min_length"));
        // Zero has no size that a step could be taken by, and may stand for a part that is absent.
        if value == 0.0 || of.check_derivatives(&[value]).is_err() {
            continue;
        }
        let of = Subject::from(of);
        let (read, slopes) =
            sampling.value_and_jacobian(&of, &[value], &|_| Ok(())).unwrap_or_else(|error| panic!("{name}: {error}"));
        let step = 1e-5 * value.abs();
        // What stands at an end of its range has one side alone.
        let [Some(low), Some(high)] = [value - step, value + step].map(|value| values(&sampling, &of, value)) else {
            continue;
        };
        let largest = |of: usize| read.iter().skip(of).step_by(width).fold(0.0_f64, |most, read| most.max(read.abs()));
        let mut moves = false;
        for (at, slope) in slopes.iter().enumerate() {
            let difference = (high[at] - low[at]) / (2.0 * step);
            let allowed = 2e-4 * difference.abs().max(largest(at % width) / value.abs());
            assert!(
                (slope - difference).abs() < allowed,
                "{name}, {}, {:?} at {} s: {slope:e} is not {difference:e}",
                place.path(),
                sampling.observed[at % width],
                sampling.times[at / width]
            );
            moves |= difference.abs() > 3.0 * allowed;
        }
        if moves {
            moving.push(place.path());
        }
    }
    moving
}

#[test]
fn what_a_file_leaves_out_follows_in_derivatives_as_in_runs() {
    let own = JOINT.replace(
        "command.duty = 0.3",
        "command.duty = 0.3\nsupply = { gauge_pressure = \"60 psi\", reservoir_volume = \"30 cm^3\" }",
    );
    let given = "reservoir_volume = \"40 cm^3\"\nreservoir_gauge_pressure = \"65 psi\"";
    let full = BOTTLE.replace("reservoir_volume = \"40 cm^3\"", given);
    let started = format!("{SERIES}\n[initial]\ngauge_pressure = \"15 psi\"\n");
    for (name, text, follows) in [
        ("a bottle", BOTTLE, &["supply.gauge_pressure", "actuator.thread_length"][..]),
        ("a bottle that is not full", &full, &["supply.reservoir_gauge_pressure"]),
        ("a tank", TANK, &["supply.gauge_pressure", "actuator.thread_length"]),
        ("one bottle of both", JOINT, &["supply.gauge_pressure", "actuator.thread_length"]),
        ("a bottle of each", &own, &["supply.gauge_pressure", "antagonist.supply.gauge_pressure"]),
        ("a given pressure", SERIES, &["pressure.gauge_pressure[0]", "pressure.offset", "pressure.scale"]),
        ("a given pressure from another", &started, &["pressure.gauge_pressure[0]", "initial.gauge_pressure"]),
        ("two given pressures", TWO_SERIES, &["antagonist.pressure.gauge_pressure[0]", "antagonist.pressure.scale"]),
    ] {
        let moving = compared(name, text);
        for path in follows {
            assert!(moving.iter().any(|of| of == path), "{name}: {path} is not among {moving:?}");
        }
    }
}

/// The derivative of the tension at 0.127 s by a number of a scenario at a value, or why there is none; and the number's path.
fn slope(text: &str, path: &str, value: f64) -> Result<f64, String> {
    let document = document(text);
    let mut scenario = document.scenario().unwrap_or_else(|error| panic!("{path}: {error}"));
    let place = Place::find(path, &mut scenario).unwrap_or_else(|error| panic!("{error}"));
    let subject = Subject::from(Adjustable::new(scenario.clone(), vec![place], [false; 2]));
    let sampling = Sampling { observed: vec![Observed::Tension], times: vec![0.127], tolerance: 1e-9 };
    let found = sampling.value_and_jacobian(&subject, &[value], &|_| Ok(()));
    found.map(|(_, slopes)| slopes[0]).map_err(|error| error.to_string())
}

#[test]
fn a_part_that_is_switched_off_has_no_derivative_and_says_so() {
    let of_actuator =
        |keys: &str| BOTTLE.replace("preset = \"colbrunn-2001\"", &format!("preset = \"colbrunn-2001\"\n{keys}"));
    let law = of_actuator("force = { law = \"tondu-lopez\", end_factor = 1.0, end_factor_pressure = \"50 kPa\" }");
    let taper = of_actuator("taper = { end_radius = \"2.2 mm\", length_ratio = 0.5 }");
    for (text, path, off, words) in [
        (BOTTLE, "valve.opening_delay", 0.0, "= 0 s switches its part off"),
        (BOTTLE, "valve.closing_delay", 0.0, "above zero, such as 1e-6 s, or leave the key out"),
        (BOTTLE, "valve.opening_time", 0.0, "has no derivative"),
        (BOTTLE, "valve.closing_time", 0.0, "has no derivative"),
        (BOTTLE, "actuator.wall_thickness", 0.0, "such as 1e-6 m,"),
        (BOTTLE, "actuator.friction.coulomb_width", 0.0, "such as 1e-6 m,"),
        (BOTTLE, "actuator.friction.coulomb_force", 0.0, "such as 1e-6 N,"),
        (BOTTLE, "actuator.friction.coulomb_force_per_pressure", 0.0, "such as 1e-12 m^2,"),
        (BOTTLE, "actuator.friction.structural_damping", 0.0, "such as 1e-6 s,"),
        (BOTTLE, "actuator.friction.static_ratio", 1.0, "above 1, such as 1.000001,"),
        (&law, "actuator.force.end_factor_rise", 0.0, "such as 1e-6,"),
        (&taper, "actuator.taper.length_ratio", 0.0, "such as 1e-6,"),
        (JOINT, "antagonist.command.duty", 1.0, "below 1, such as 0.999999,"),
    ] {
        let error = slope(text, path, off).expect_err(path);
        assert!(error.contains(&format!("`{path}` = ")) && error.contains(words), "{error}");
    }
    // Beside it there is one, and at zero where the part is there all the same.
    let forced = of_actuator("friction.coulomb_force = \"3 N\"");
    for (text, path, value) in [
        (BOTTLE, "actuator.friction.static_ratio", 1.000_001),
        (BOTTLE, "actuator.friction.coulomb_width", 1e-6),
        (BOTTLE, "valve.opening_delay", 1e-6),
        (BOTTLE, "actuator.friction.viscous", 0.0),
        (BOTTLE, "valve.dead_time", 0.0),
        (&forced, "actuator.friction.coulomb_width", 0.0),
        (&forced, "actuator.friction.coulomb_force_per_pressure", 0.0),
    ] {
        let found = slope(text, path, value).unwrap_or_else(|error| panic!("{error}"));
        assert!(found != 0.0 && found.is_finite(), "{path} at {value}: {found}");
    }
}
