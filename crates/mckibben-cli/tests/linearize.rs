//! `mckibben linearize`: what it writes and prints against the library that it calls, and what it refuses.

use crate::common::{Folder, of_repository};
use mckibben::GaugePressure;
use mckibben::linearize::{Aim, Balance, Content, StateSpace, linearize, linearize_driven};
use mckibben_plot::Scale;
use mckibben_run::linearize::{LinearModel, Request};
use mckibben_scenario::Document;
use serde_json::Value;
use std::collections::BTreeSet;

const PSI: f64 = 6_894.757_293_168_361;

fn run(folder: &Folder, file: &str, arguments: &[&str]) -> String {
    let file = of_repository(file);
    let output = folder.mckibben().arg("linearize").arg(file).args(arguments).output().expect("the program runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("UTF-8")
}

fn refused(folder: &Folder, file: &str, arguments: &[&str], words: &str) {
    let file = of_repository(file);
    let output = folder.mckibben().arg("linearize").arg(file).args(arguments).output().expect("the program runs");
    let printed = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {printed}");
    assert!(printed.contains(words), "{arguments:?}: {printed}");
    assert!(folder.names().is_empty());
}

fn read(folder: &Folder, name: &str) -> Value {
    serde_json::from_str(&std::fs::read_to_string(folder.path(name)).expect("written")).expect("JSON")
}

fn rows(value: &Value) -> Vec<Vec<f64>> {
    let numbers = |row: &Value| row.as_array().expect("a row").iter().map(|n| n.as_f64().expect("a number")).collect();
    value.as_array().expect("a matrix").iter().map(numbers).collect()
}

/// The matrix `name = [ … ];` of a script.
fn of_script(script: &str, name: &str) -> Vec<Vec<f64>> {
    let (_, rest) = script.split_once(&format!("\n{name} = [\n")).expect("a matrix");
    let (body, _) = rest.split_once("];").expect("its end");
    let numbers = |row: &str| row.split_whitespace().map(|n| n.parse().expect("a number")).collect();
    body.lines().map(numbers).collect()
}

fn is_of(system: &StateSpace, matrix: impl Fn(&str) -> Vec<Vec<f64>>) {
    for (name, expected) in [("A", &system.a), ("B", &system.b), ("C", &system.c), ("D", &system.d)] {
        let written = matrix(name);
        assert_eq!(written.iter().map(Vec::len).collect::<Vec<_>>(), expected.iter().map(Vec::len).collect::<Vec<_>>());
        for (written, expected) in written.iter().flatten().zip(expected.iter().flatten()) {
            // The reader of JSON rounds a last digit; the files themselves are exact.
            assert!((written - expected).abs() <= f64::EPSILON * expected.abs(), "{name}: {written:e}, {expected:e}");
        }
    }
}

/// A controller has no part in a linear model, whose valves are held shut, of an actuator with or without a name and of a joint.
#[test]
fn files_with_controllers_have_linear_models_of_what_is_controlled() {
    let model = |file: &str, actuators: &str| {
        let text = std::fs::read_to_string(of_repository(file)).expect("an example") + actuators;
        let document = Document::parse(&text, "file.toml").expect("TOML");
        LinearModel::of("file", &document, &Request::default()).unwrap_or_else(|error| panic!("{file}: {error:?}"))
    };
    let (alone, named) =
        (model("examples/control/pid.toml", ""), model("examples/control/pid.toml", "\n[actuators.muscle]\n"));
    assert_eq!(alone.poles().len(), named.poles().len());
    for pole in alone.poles() {
        let near = named.poles().iter().map(|of| (of.real - pole.real).hypot(of.imaginary - pole.imaginary));
        assert!(near.fold(f64::INFINITY, f64::min) < 1e-6 * pole.real.hypot(pole.imaginary).max(1.0), "{pole:?}");
    }
    assert!(!model("examples/control/joint-air-mass.toml", "").poles().is_empty());
}

#[test]
fn both_files_hold_the_librarys_matrices() {
    let folder = Folder::new("linearize-files");
    let file = "examples/linearize-pwm.toml";
    let experiment = Document::load(of_repository(file)).unwrap().experiment().unwrap();
    let content = Content::Of(experiment.start);
    let pulsed = linearize_driven(&experiment.rig, Aim::Duty(0.4), content).unwrap();
    let balance = Balance::AtPressure(GaugePressure(4e5));
    let held = linearize(&experiment.rig, balance, content).unwrap();
    run(&folder, file, &["--output", "pulsed.json"]);
    run(&folder, file, &["--output", "pulsed.m", "--all-states"]);
    run(&folder, file, &["--gauge-pressure", "400 kPa", "--output", "held.json"]);
    let json = read(&folder, "pulsed.json");
    is_of(&pulsed.minimal(), |name| rows(&json[name]));
    assert_eq!(json["model"], "averaged-pwm");
    assert_eq!(json["inputs"][0]["name"], "duty");
    let pressure = json["operating_point"]["absolute_pressure_pa"].as_f64().expect("a number");
    assert!((pressure / pulsed.point.state.pressure.0 - 1.0).abs() <= f64::EPSILON);
    assert_eq!(json["pwm"]["validity"]["ripple_is_small"], true);
    let script = std::fs::read_to_string(folder.path("pulsed.m")).unwrap();
    is_of(&pulsed.system, |name| of_script(&script, name));
    assert!(script.contains("states = {'length', 'velocity', 'pressure', 'air_mass'};"));
    assert!(script.contains("model = ss(A, B, C, D);"));
    let json = read(&folder, "held.json");
    is_of(&held.minimal(), |name| rows(&json[name]));
    let poles = held.minimal().poles().unwrap();
    for (written, pole) in json["poles"].as_array().unwrap().iter().zip(&poles) {
        let close = |name: &str, value: f64| {
            (written[name].as_f64().expect("a number") - value).abs() <= f64::EPSILON * value.abs()
        };
        assert!(close("real_1_s", pole.real) && close("imaginary_rad_s", pole.imaginary), "{written}");
    }
    assert_eq!(json["poles"][2]["damping_ratio"], Value::Null);
    assert_eq!(json["pwm"], Value::Null);
}

#[test]
fn the_table_reports_the_point_the_poles_and_their_validity() {
    let folder = Folder::new("linearize-table");
    let printed = run(&folder, "examples/paper/fig-12.toml", &[]);
    for words in ["42.50 % of the period", "from 10.00 % to 97.50 %", "too large", "swings", "3 of 3", "Coulomb"] {
        assert!(printed.contains(words), "`{words}` is not in\n{printed}");
    }
    let printed = run(&folder, "examples/paper/fig-08.toml", &["--all-states", "--gauge-pressure", "60 psi"]);
    for words in ["valve held shut", "4.137 bar", "integrator", "3 of 4", "one pole at zero that no input reaches"] {
        assert!(printed.contains(words), "`{words}` is not in\n{printed}");
    }
    let printed = run(&folder, "examples/paper/fig-08.toml", &["--amplitude", "1 mm"]);
    assert!(printed.contains("of viscous damping, right for"), "{printed}");
    let printed = run(&folder, "examples/isometric-charge.toml", &["--gauge-pressure", "2 bar"]);
    assert!(printed.contains("the ends are held with"), "{printed}");
    assert!(folder.names().is_empty());
}

/// The poles that are written, as real and imaginary parts, by their size.
fn poles(model: &Value) -> Vec<[f64; 2]> {
    let part = |pole: &Value, name: &str| pole[name].as_f64().expect("a number");
    let poles = model["poles"].as_array().expect("poles").iter();
    let mut poles: Vec<[f64; 2]> = poles.map(|pole| [part(pole, "real_1_s"), part(pole, "imaginary_rad_s")]).collect();
    poles.sort_by(|a, b| a[0].hypot(a[1]).total_cmp(&b[0].hypot(b[1])));
    poles
}

/// The stiffness of a joint is in the units that are chosen: 1 lbf·in is 0.112984829 N·m.
#[test]
fn the_stiffness_of_a_joint_has_the_chosen_unit() {
    let folder = Folder::new("linearize-units");
    let of = |unit: &str, symbol: &str| -> f64 {
        let printed = run(&folder, "examples/linearize-joint.toml", &["--units", &format!("angular-stiffness={unit}")]);
        let (_, rest) = printed.split_once("with the valves shut ").expect("a stiffness");
        let (number, rest) = rest.split_once(' ').expect("a unit");
        assert!(rest.starts_with(symbol), "{printed}");
        number.parse().expect("a number")
    };
    let ratio = of("lbf*in/rad", "lbf·in/rad") / of("N*m/rad", "N·m/rad");
    assert!((ratio * 0.112_984_829 - 1.0).abs() < 1e-3, "{ratio}");
}

/// Six regulators of one time constant are six equal poles beside the far faster ones of hoses, on which an iteration for eigenvalues
/// may not end. The trace is the sum of the poles.
#[test]
fn equal_poles_of_regulators_beside_hoses_are_found() {
    let folder = Folder::new("linearize-equal-poles");
    for diameter in ["2 mm", "2.5 mm", "3 mm", "3.5 mm"] {
        let diameter = format!("hose.diameter={diameter}");
        let set = ["--set", "hose.length=0.5 m", "--set", &diameter, "--output", "leg.json"];
        run(&folder, "examples/plant/leg.toml", &set);
        let model = read(&folder, "leg.json");
        let (a, poles) = (rows(&model["A"]), poles(&model));
        let trace: f64 = a.iter().enumerate().map(|(place, row)| row[place]).sum();
        let sum: f64 = poles.iter().map(|pole| pole[0]).sum();
        assert!(poles.len() == a.len() && (sum / trace - 1.0).abs() < 1e-10, "{diameter}: {sum} {trace}");
        let of_regulators = poles.iter().filter(|pole| (pole[0] * 0.03 + 1.0).hypot(pole[1] * 0.03) < 1e-6);
        assert_eq!(of_regulators.count(), 6, "{diameter}: {poles:?}");
    }
}

/// Loads that share nothing have the damping that each has in a file with no other.
#[test]
fn an_amplitude_damps_each_load_in_its_own_mode() {
    let folder = Folder::new("linearize-loads");
    let [heavy, light] = [("heavy", "10 kg"), ("light", "0.5 kg")]
        .map(|(name, mass)| format!("[actuators.{name}]\nload = {{ kind = \"hanging-mass\", mass = \"{mass}\" }}\n"));
    let of = |actuators: &str| -> Value {
        let file = format!(
            "[actuator]\npreset = \"colbrunn-2001\"\n[initial]\ngauge_pressure = \"3 bar\"\n\
             [run]\nduration = \"1 s\"\n{actuators}"
        );
        let file = folder.file("loads.toml", &file);
        run(&folder, &file.display().to_string(), &["--amplitude", "1 mm", "--output", "loads.json"]);
        read(&folder, "loads.json")
    };
    let together = of(&format!("{heavy}{light}"));
    let alone = [of(&heavy), of(&light)];
    let mut expected: Vec<[f64; 2]> = alone.iter().flat_map(poles).collect();
    expected.sort_by(|a, b| a[0].hypot(a[1]).total_cmp(&b[0].hypot(b[1])));
    for (found, expected) in poles(&together).iter().zip(&expected) {
        let apart = (found[0] - expected[0]).hypot(found[1].abs() - expected[1].abs());
        assert!(apart <= 1e-6 * expected[0].hypot(expected[1]), "{found:?} {expected:?}");
    }
    let named = &together["coulomb_friction_as_damping"];
    assert_eq!([&named[0]["of"], &named[1]["of"]], ["heavy", "light"]);
    // One with so much friction that it creeps has no oscillation.
    let creeps = light.replace("[actuators.light]\n", "[actuators.light]\nfriction = { viscous = \"400 N*s/m\" }\n");
    let model = of(&format!("{heavy}{creeps}"));
    assert_eq!(model["coulomb_friction_as_damping"].as_array().map(Vec::len), Some(1));
}

/// The load swings as on a lumped hose; the waves in the cells of a hose are thirty times as fast and less damped.
#[test]
fn an_amplitude_is_of_the_load_and_no_wave_in_a_hose() {
    let folder = Folder::new("linearize-wave");
    let of = |hose: &str, viscous: &str| {
        let text = format!(
            "[actuator]\npreset = \"colbrunn-2001\"\nfriction = {{ viscous = \"{viscous}\" }}\n\
             [supply]\ngauge_pressure = \"5 bar\"\n[valve]\nkind = \"fill-hold-exhaust\"\nflow_area = \"0.3 mm^2\"\n\
             [command]\nkind = \"table\"\ntime = [\"5 s\"]\nstate = [\"hold\"]\n\
             [hose]\nlength = \"2 m\"\ndiameter = \"6 mm\"\n{hose}[load]\nkind = \"hanging-mass\"\nmass = \"2 kg\"\n\
             [initial]\ngauge_pressure = \"3 bar\"\n[run]\nduration = \"0.1 s\"\n"
        );
        folder.file("hose.toml", &text).display().to_string()
    };
    let cells = "kind = \"distributed\"\ncells = 4\n";
    let frequency = |hose: &str| -> f64 {
        run(&folder, &of(hose, "3.5 N*s/m"), &["--amplitude", "1 mm", "--output", "hose.json"]);
        let model = read(&folder, "hose.json");
        model["coulomb_friction_as_damping"]["angular_frequency_rad_s"].as_f64().expect("a number")
    };
    let (lumped, distributed) = (frequency(""), frequency(cells));
    assert!((distributed / lumped - 1.0).abs() < 1e-2, "{distributed} {lumped}");
    let file = of(cells, "600 N*s/m");
    let output =
        folder.mckibben().args(["linearize", &file, "--amplitude", "1 mm"]).output().expect("the program runs");
    let printed = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(2) && printed.contains("no load swings"), "{printed}");
}

/// Dead time and wave of a lumped hose are reported, and left out of the figure.
#[test]
fn delays_of_inputs_are_reported() {
    let folder = Folder::new("linearize-delay");
    let text = "[actuator]\npreset = \"colbrunn-2001\"\n[supply]\ngauge_pressure = \"5 bar\"\n\
                [valve]\nkind = \"pressure-regulator\"\nflow_area = \"0.3 mm^2\"\ntime_constant = \"20 ms\"\n\
                dead_time = \"50 ms\"\nrate_limit = \"50 bar/s\"\n\
                [command]\nkind = \"set-points\"\ntime = [\"0 s\"]\ngauge_pressure = [\"3 bar\"]\n\
                [load]\nkind = \"hanging-mass\"\nmass = \"2 kg\"\n[initial]\ngauge_pressure = \"3 bar\"\n\
                [run]\nduration = \"1 s\"\n";
    for (name, actuators) in [("one.toml", ""), ("named.toml", "[actuators.m]\n")] {
        let file = folder.file(name, &format!("{text}{actuators}")).display().to_string();
        let printed = run(&folder, &file, &["--output", "d.json"]);
        assert!(printed.contains("set_point by 50") && printed.contains("Inputs act late"), "{printed}");
        let model = read(&folder, "d.json");
        for input in model["inputs"].as_array().expect("inputs") {
            let is_command = input["name"].as_str().is_some_and(|name| name.ends_with("set_point"));
            assert_eq!(input["delay_s"], if is_command { 0.05 } else { 0.0 }, "{input}");
        }
        let document = Document::parse(&format!("{text}{actuators}"), name).expect("TOML");
        let figure = LinearModel::of(name, &document, &Request::default()).and_then(|model| model.figure(None));
        let caption = figure.expect("a figure").caption;
        assert!(caption.contains("without the delays of inputs"), "{caption}");
        run(&folder, &file, &["--output", "d.m"]);
        let script = std::fs::read_to_string(folder.path("d.m")).expect("a script");
        assert!(script.contains("\ndelay = [5e-2 0e0"), "{script}");
    }
}

#[test]
fn two_of_three_are_given_and_the_duty_may_follow() {
    let folder = Folder::new("linearize-point");
    let file = "examples/linearize-pwm.toml";
    let point = |arguments: &[&str]| {
        run(&folder, file, &[arguments, &["--output", "p.json"]].concat());
        read(&folder, "p.json")["operating_point"].clone()
    };
    let number = |point: &Value, name: &str| point[name].as_f64().expect("a number");
    let first = point(&["--gauge-pressure", "60 psi", "--load", "12 lb"]);
    let length = format!("{} m", number(&first, "length_m"));
    let second = point(&["--length", &length, "--load", "12 lb"]);
    assert!((number(&second, "gauge_pressure_pa") / (60.0 * PSI) - 1.0).abs() < 1e-9);
    let third = point(&["--length", &length, "--gauge-pressure", "60 psi"]);
    assert!((number(&third, "load_mass_kg") / (12.0 * 0.453_592_37) - 1.0).abs() < 1e-9);
    let duty = number(&point(&["--gauge-pressure", "60 psi", "--pwm"]), "duty");
    let back = point(&["--duty", &duty.to_string()]);
    assert!((number(&back, "gauge_pressure_pa") / (60.0 * PSI) - 1.0).abs() < 1e-8);
    let warm = point(&["--gauge-pressure", "60 psi", "--temperature", "310 K"]);
    assert!((number(&warm, "temperature_k") - 310.0).abs() < 1e-9);
}

/// The poles are roots of the characteristic polynomial of A, and both files hold the same numbers.
#[test]
fn a_joint_is_linearised_at_its_balance_or_at_a_stiffness() {
    let folder = Folder::new("linearize-joint");
    let file = "examples/moment-arm.toml";
    let text = run(&folder, file, &["--output", "j.json"]);
    assert!(text.contains("both valves held shut") && text.contains("swings"), "{text}");
    let model = read(&folder, "j.json");
    assert_eq!(model["model"], "joint-held-valves");
    assert_eq!(model["states"].as_array().map(Vec::len), Some(4));
    let pole = model["poles"].as_array().and_then(|poles| poles.iter().find(|of| of["imaginary_rad_s"] != 0.0));
    let swing = pole.and_then(|pole| pole["natural_frequency_rad_s"].as_f64()).expect("it swings");
    // Undamped, `ω² = −(A₂₁ + Σ A₂ₖ A_k2)` over the pressures: the sealed stiffness over the inertia.
    let entry = |row: usize, column: usize| model["A"][row][column].as_f64().expect("a number");
    let squared = -(entry(1, 0) + entry(1, 2) * entry(2, 1) + entry(1, 3) * entry(3, 1));
    assert!((swing * swing / squared - 1.0).abs() < 1e-6, "{swing} {squared}");
    run(&folder, file, &["--output", "j.m"]);
    let script = std::fs::read_to_string(folder.path("j.m")).expect("a script");
    assert!(script.contains(&format!("{:e}", entry(1, 0))) && script.contains("point.angle_rad"), "{script}");
    run(&folder, file, &["--angle", "5 deg", "--stiffness", "1.2 N*m/rad", "--all-states", "--output", "s.json"]);
    let stiff = read(&folder, "s.json");
    assert_eq!(stiff["states"].as_array().map(Vec::len), Some(6));
    let point = |name: &str| stiff["operating_point"][name].as_f64().expect("a number");
    assert!((point("angle_rad") - 5_f64.to_radians()).abs() < 1e-9, "{}", stiff["operating_point"]);
    assert!((point("stiffness_n_m_rad") - 1.2).abs() < 1e-9, "{}", stiff["operating_point"]);
}

#[test]
fn a_joint_under_pulses_is_averaged_and_drawn() {
    let folder = Folder::new("linearize-joint-pwm");
    let file = "examples/linearize-joint.toml";
    let printed = run(&folder, file, &["--output", "j.json", "--plot", "j.svg"]);
    for words in ["both valves under PWM at 200.0 Hz on average", "Mean flow of the antagonist's valve", "agonist duty"]
    {
        assert!(printed.contains(words), "{words} is not in\n{printed}");
    }
    let model = read(&folder, "j.json");
    assert_eq!(model["model"], "joint-averaged-pwm");
    let names = |of: &str| -> Vec<String> {
        let signals = model[of].as_array().expect("signals");
        signals.iter().map(|signal| signal["name"].as_str().expect("a name").to_owned()).collect()
    };
    assert_eq!(names("inputs")[..2], ["agonist_duty", "antagonist_duty"]);
    for (reach, valve) in model["controllability"].as_array().expect("each input").iter().zip([0, 1]) {
        // Each duty alone reaches every state: through the angle it moves the other's pressure.
        assert_eq!(reach["rank"], 4, "{reach}");
        assert!(model["pwm"][valve]["validity"]["ripple_is_small"] == true, "{}", model["pwm"]);
    }
    // No air is kept: every pole decays.
    assert!(model["poles"].as_array().expect("poles").iter().all(|pole| pole["real_1_s"].as_f64() < Some(0.0)));
    let svg = std::fs::read_to_string(folder.path("j.svg")).expect("drawn");
    for words in ["angle over agonist duty", "actuator torque over agonist", "PWM", "rad"] {
        assert!(svg.contains(words), "{words}");
    }
    // With the valves held: at an angle and a stiffness.
    run(&folder, file, &["--angle", "5 deg", "--stiffness", "1 N*m/rad", "--plot", "h.svg", "--input", "torque"]);
    let svg = std::fs::read_to_string(folder.path("h.svg")).expect("drawn");
    assert!(svg.contains("angle over torque") && svg.contains("both valves held shut"), "{svg}");
}

/// The flow path into a manifold, which has no command, is called after the manifold; all names are unique.
#[test]
fn an_inlet_is_called_after_the_supply_that_it_feeds() {
    let folder = Folder::new("linearize-inlet");
    run(&folder, "examples/plant/arm.toml", &["--output", "model.json"]);
    let json = read(&folder, "model.json");
    let inputs = json["inputs"].as_array().expect("inputs");
    let names: BTreeSet<&str> = inputs.iter().map(|input| input["name"].as_str().expect("a name")).collect();
    assert_eq!(names.len(), inputs.len(), "{names:?}");
    assert!(
        names.contains("manifold.supply_opening") && !names.iter().any(|name| name.starts_with("valve-")),
        "{names:?}"
    );
}

/// No duty holds the pressure of the atmosphere: the message names the actuators that start there, and the key.
#[test]
fn actuators_without_pressure_are_named_where_no_command_holds_it() {
    let folder = Folder::new("linearize-no-pressure");
    let knee = "[supply]\ngauge_pressure = \"6 bar\"\n[valve]\nkind = \"three-way\"\nflow_area = \"1 mm^2\"\n\
                [command]\nkind = \"pwm\"\nfrequency = \"20 Hz\"\nduty = 0.5\n\
                [mechanism]\nkind = \"chain\"\n[mechanism.joints.knee]\nsegment = \"shank\"\nmass = \"0.2 kg\"\n\
                distance = \"50 mm\"\ninertia = \"1e-3 kg*m^2\"\ndamping = \"0.02 N*m*s/rad\"\n\
                [actuators.front]\ncoupling.rest_length = \"80 mm\"\ncoupling.arms.knee = \"15 mm\"\n\
                initial.gauge_pressure = \"2 bar\"\n\
                [actuators.back]\ncoupling.rest_length = \"80 mm\"\ncoupling.arms.knee = \"-15 mm\"\n\
                [run]\nduration = \"1 s\"\n";
    folder.file("knee.toml", knee);
    let output = folder.mckibben().args(["linearize", "knee.toml", "--pwm"]).output().expect("the program runs");
    let printed = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{printed}");
    assert!(printed.contains("initial.gauge_pressure is 0 of back"), "{printed}");
    assert!(printed.contains("actuators.back.initial.gauge_pressure") && !printed.contains("front"), "{printed}");
}

/// A model of a muscle with what the text adds.
fn model_of(text: &str, request: &Request) -> Result<LinearModel, String> {
    let text = format!("[actuator]\npreset = \"colbrunn-2001\"\n{text}[run]\nduration = \"1 s\"\n");
    let document = Document::parse(&text, "file.toml").expect("TOML");
    LinearModel::of("file", &document, request).map_err(|failure| format!("{failure:?}"))
}

const THREE_WAY: &str = "[valve]\nkind = \"three-way\"\nflow_area = \"0.2 mm^2\"\n";
const HANGS: &str = "[load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n[initial]\ngauge_pressure = \"2 bar\"\n";

/// The commands that hold pressures are those of the other valves: one that a controller commands is shut, and keeps its air.
#[test]
fn valves_under_controllers_are_held_shut_while_commands_are_found() {
    let text = format!(
        "[supply]\ngauge_pressure = \"4 bar\"\n{THREE_WAY}{HANGS}\
         [actuators.pulsed]\ncommand = {{ kind = \"pwm\", frequency = \"100 Hz\", duty = 0.5 }}\n\
         [actuators.vents]\ncommand.kind = \"controllers\"\n\
         [actuators.holds]\ncommand.kind = \"controllers\"\n\
         valve = {{ kind = \"fill-hold-exhaust\", flow_area = \"0.2 mm^2\" }}\n\
         [controller]\nkind = \"bang-bang\"\ngauge_pressure = \"2 bar\"\nrate = \"100 Hz\"\ndead_band = \"1 psi\"\n"
    );
    let model = model_of(&text, &Request { pwm: true, ..Request::default() }).expect("a model");
    let point = model.point();
    let of = |name: &str| point.iter().find(|(its, _)| its == name).expect("a name").1;
    for name in ["vents", "holds"] {
        assert!(of(&format!("{name}.mass_flow_kg_s")).abs() < 1e-15, "{name}: {point:?}");
        assert_eq!([of(&format!("{name}.supply_opening")), of(&format!("{name}.exhaust_opening"))], [0.0; 2]);
    }
    assert!((0.1..0.9).contains(&of("pulsed.duty")) && of("pulsed.mass_flow_kg_s").abs() < 1e-15, "{point:?}");
}

/// Pressures lie between supply and atmosphere, whichever is the lower.
#[test]
fn a_vacuum_makes_what_lies_above_it() {
    let text = format!(
        "[supply]\ngauge_pressure = \"-0.5 bar\"\n{THREE_WAY}[command]\nkind = \"pwm\"\nfrequency = \"300 Hz\"\n\
         duty = 0.5\n[load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n"
    );
    let warnings = |gauge_pressure: Option<f64>| {
        let request = Request { gauge_pressure, ..Request::default() };
        model_of(&text, &request).expect("a model").account().warnings().join("\n")
    };
    assert!(!warnings(None).contains("cannot make"));
    assert!(warnings(Some(-0.7e5)).contains("lies below supply.gauge_pressure = -0.5 bar, which cannot make it"));
    assert!(warnings(Some(0.3e5)).contains("exceeds the pressure of the atmosphere"), "{}", warnings(Some(0.3e5)));
}

/// Of each port the pulse lasts longer by how much later the path shuts than opens, as a share of the period: the mean openings are those
/// of one actuator, of one with a name and of both of a joint.
#[test]
fn both_shares_are_mean_openings_in_every_kind_of_model() {
    let valve = |kind: &str, [opening, closing]: [&str; 2], command: &str| {
        format!(
            "[supply]\ngauge_pressure = \"6 bar\"\n[valve]\nkind = \"{kind}\"\nflow_area = \"0.05 mm^2\"\n\
             opening_delay = \"{opening} ms\"\nclosing_delay = \"{closing} ms\"\n[command]\nkind = \"pwm\"\n{command}\n"
        )
    };
    let half = "frequency = \"25 Hz\"\nduty = 0.5";
    let both = "pulse = \"fill\"\nrest = \"exhaust\"";
    let joint = "[load]\nkind = \"antagonistic-joint\"\npulley_radius = \"15 mm\"\nrest_length = \"85 mm\"\nmass = \"0.5 kg\"\n\
                 distance = \"100 mm\"\ninertia = \"1e-3 kg*m^2\"\n[initial]\ngauge_pressure = \"2 bar\"\n";
    let fixed = "[load]\nkind = \"isometric\"\n[initial]\nlength = \"85 mm\"\ngauge_pressure = \"2 bar\"\n";
    let named = format!("{fixed}[actuators.muscle]\n");
    for (valve, supply, exhaust) in [
        (valve("three-way", ["4", "1"], half), 0.5 - 3.0 / 40.0, 0.5 + 3.0 / 40.0),
        (valve("three-way", ["4", "9"], half), 0.5 + 5.0 / 40.0, 0.5 - 5.0 / 40.0),
        (valve("fill-hold-exhaust", ["4", "9"], &format!("{half}\n{both}")), 0.5 + 5.0 / 40.0, 0.5 + 5.0 / 40.0),
        // A pulse of 5 ms is shorter than the delay of 9 ms; the rest of 95 ms is not.
        (
            valve("fill-hold-exhaust", ["9", "2"], &format!("frequency = \"10 Hz\"\nduty = 0.05\n{both}")),
            0.0,
            0.95 - 7.0 / 100.0,
        ),
    ] {
        for (parts, names) in [(fixed, &[""][..]), (&named, &["muscle"]), (joint, &["agonist", "antagonist"])] {
            // A joint whose muscles get no air has no balance.
            if parts == joint && supply == 0.0 {
                continue;
            }
            let model = model_of(&format!("{valve}{parts}"), &Request::default()).expect("a model");
            let json: Value = serde_json::from_str(&model.json()).expect("JSON");
            let pulses = json["pwm"].as_array().cloned().unwrap_or_else(|| vec![json["pwm"].clone()]);
            assert_eq!(pulses.iter().map(|of| of["of"].as_str().expect("a name")).collect::<Vec<_>>(), names);
            for of in &pulses {
                for (key, due) in [("supply_share", supply), ("exhaust_share", exhaust)] {
                    let found = of[key].as_f64().expect("a share");
                    assert!((found - due).abs() < 1e-9, "{valve}{names:?}: {key} {found} {due}");
                }
            }
        }
    }
}

/// Delays of 12 and 13 ms take more than a period of 10 ms: only below 1/(25 ms) = 40 Hz any duty cycle moves the poppet.
#[test]
fn a_frequency_at_which_no_duty_cycle_moves_the_poppets_is_said_to_be_so() {
    let text = |frequency: &str| {
        format!(
            "[supply]\ngauge_pressure = \"6 bar\"\n{THREE_WAY}opening_delay = \"12 ms\"\nclosing_delay = \"13 ms\"\n\
             [command]\nkind = \"pwm\"\nfrequency = \"{frequency}\"\nduty = 0.48\n{HANGS}"
        )
    };
    let warnings = |text: &str| model_of(text, &Request::default()).expect("a model").account().warnings().join("\n");
    for part in ["", "[actuators.muscle]\n"] {
        let found = warnings(&format!("{}{part}", text("100 Hz")));
        assert!(found.contains("lower command.frequency below 40 Hz") && !found.contains("-30"), "{found}");
        assert!(!warnings(&format!("{}{part}", text("39 Hz"))).contains("does not answer"));
    }
    assert!(warnings(&text("100 Hz")).contains("no duty cycle at 100 Hz"));
}

/// The set point of a regulator reaches every state of a hose in cells, one behind the other, and of the mass that swings slowly behind
/// them; `supply_pressure` reaches none.
#[test]
fn fast_waves_do_not_hide_slow_states_from_an_input() {
    let text = format!(
        "[supply]\ngauge_pressure = \"6 bar\"\n[valve]\nkind = \"pressure-regulator\"\nflow_area = \"1.5 mm^2\"\n\
         time_constant = \"30 ms\"\nrate_limit = \"400 bar/s\"\n\
         [hose]\nlength = \"1 m\"\ndiameter = \"2.5 mm\"\nkind = \"distributed\"\ncells = 4\n\
         [command]\nkind = \"set-points\"\ntime = [\"0 s\"]\ngauge_pressure = [\"2 bar\"]\n{HANGS}"
    );
    let model = model_of(&text, &Request::default()).expect("a model");
    let account = model.account();
    let block = account.blocks.iter().find(|block| block.heading == "Controllability").expect("a table");
    let row = |name: &str| block.table.rows.iter().find(|row| row[0] == name).expect("an input");
    let states = model.system().states.len();
    let set_point = row("set point");
    assert!(set_point[1] == format!("{states} of {states}") && set_point[2] != "∞", "{set_point:?}");
    assert_eq!(row("supply pressure")[1..3], [format!("0 of {states}"), "∞".to_owned()]);
}

#[test]
fn hysteresis_that_is_a_stiffness_and_a_load_that_pushes_are_said_to_be_so() {
    let slips = "friction.hysteresis.law = \"maxwell-slip\"\nfriction.hysteresis.reach = [\"0.1 mm\"]\n\
                 friction.hysteresis.stiffness_ratio = [0.3]\n";
    let bends = "friction.hysteresis.law = \"lugre\"\nfriction.hysteresis.width = \"0.3 mm\"\n\
                 friction.hysteresis.bristle_reach = \"0.1 mm\"\n";
    for law in [slips, bends] {
        let model = model_of(&format!("{law}{HANGS}"), &Request::default()).expect("a model");
        let account = model.account();
        assert!(account.warnings().join("\n").contains("stiffness for small signals"), "{law}");
        let mut lines = account.blocks.iter().flat_map(|block| &block.lines);
        let stiffness = lines.find(|line| line.name == "stiffness").expect("a stiffness");
        assert!(stiffness.value.contains("without the hysteresis of friction"), "{law}: {}", stiffness.value);
    }
    let plain = model_of(HANGS, &Request::default()).expect("a model").account();
    assert!(plain.blocks.iter().flat_map(|block| &block.lines).all(|line| !line.value.contains("hysteresis")));
    let pushes = "[load]\nkind = \"constant-force\"\nmass = \"2 kg\"\nforce = \"-5 N\"\n\
                  [initial]\ngauge_pressure = \"2 bar\"\nlength = \"80 mm\"\n";
    let failure = model_of(pushes, &Request::default()).err().expect("no equilibrium");
    assert!(failure.contains("`length` with `gauge_pressure`") && !failure.contains("initial.length"), "{failure}");
    let given = Request { gauge_pressure: Some(2e5), length: Some(0.08), ..Request::default() };
    assert!(model_of(pushes, &given).is_ok());
}

/// What a regulator is set to is called a set point, with one actuator and with several that have names.
#[test]
fn the_set_point_of_a_regulator_has_one_name() {
    let pulses = "[command]\nkind = \"pwm\"\nfrequency = \"200 Hz\"\nduty = 0.4\n";
    let set = "gauge_pressure = \"5 bar\"\nlag = \"20 ms\"\ndroop = \"2e7 Pa*s/kg\"\n";
    let names = |text: &str| -> Vec<String> {
        let model = model_of(&format!("{THREE_WAY}{pulses}{HANGS}{text}"), &Request::default()).expect("a model");
        model.system().inputs.iter().map(|signal| signal.name.clone()).collect()
    };
    let alone = names(&format!("[supply]\n{set}"));
    let fed = format!("[supplies.tank]\ngauge_pressure = \"7 bar\"\n[supplies.reg]\nfrom = \"tank\"\n{set}");
    let named = names(&format!("{fed}[actuators.m]\nsupply = \"reg\"\n"));
    assert!(alone.contains(&"supply_set_point".to_owned()), "{alone:?}");
    assert!(["reg.supply_set_point", "tank.supply_pressure"].iter().all(|name| named.contains(&(*name).to_owned())));
}

#[test]
fn bode_plots_are_drawn() {
    let folder = Folder::new("linearize-bode");
    let file = "examples/linearize-pwm.toml";
    run(&folder, file, &["--plot", "a.svg"]);
    run(&folder, file, &["--plot", "b.png", "--input", "force"]);
    let svg = std::fs::read_to_string(folder.path("a.svg")).unwrap();
    for words in ["length over duty", "pressure over duty", "phase", "frequency (Hz)", "PWM"] {
        assert!(svg.contains(words), "{words}");
    }
    assert!(std::fs::read(folder.path("b.png")).unwrap().starts_with(b"\x89PNG"));
    // Decades of Hz; multiples of 20 dB.
    for label in [">0.1<", ">1<", ">10<", ">100<", ">1000<", ">0<", ">−160<", ">80<", ">140<", ">−90<", "dB re 1 Pa"]
    {
        assert!(svg.contains(label), "{label}");
    }
}

#[test]
fn bode_plots_hold_levels_over_a_logarithmic_axis_of_frequencies() {
    let document = Document::load(of_repository("examples/linearize-pwm.toml")).unwrap();
    let model = LinearModel::of("linearize-pwm", &document, &Request::default()).unwrap();
    let figure = model.figure(None).unwrap();
    assert_eq!((figure.x.scale, figure.x.unit.as_str()), (Scale::Logarithmic, "Hz"));
    let axes: Vec<_> = figure.panels.iter().map(|panel| (panel.y.scale, panel.y.unit.as_str())).collect();
    let linear = |unit| (Scale::Linear, unit);
    assert_eq!(axes, [linear("dB re 1 m"), linear("dB re 1 Pa"), linear("°")]);
    for (panel, name) in figure.panels.iter().zip(["length", "pressure"]) {
        let output = model.system().outputs.iter().position(|signal| signal.name == name).unwrap();
        let series = &panel.series[0];
        for (frequency, drawn) in series.x.iter().zip(&series.y) {
            let response = model.system().response(0, output, std::f64::consts::TAU * frequency).unwrap();
            assert!((10_f64.powf(drawn / 20.0) / response.magnitude() - 1.0).abs() < 1e-12, "{name} at {frequency} Hz");
        }
        let (least, greatest) = series.y.iter().fold((f64::MAX, f64::MIN), |(l, g), y| (l.min(*y), g.max(*y)));
        let (low, high) = (panel.y.min.unwrap(), panel.y.max.unwrap());
        assert!(low <= least && low > least - 20.0 && greatest <= high && high < greatest + 20.0, "{name}");
        assert_eq!((figure.x.min, figure.x.max), (Some(series.x[0]), series.x.last().copied()));
    }
}

#[test]
fn what_has_no_meaning_is_refused_before_anything_is_written() {
    let folder = Folder::new("linearize-bad");
    let (pulsed, sealed) = ("examples/linearize-pwm.toml", "examples/paper/fig-08.toml");
    refused(&folder, pulsed, &["--duty", "0.4", "--gauge-pressure", "60 psi"], "cannot be used with");
    refused(
        &folder,
        pulsed,
        &["--gauge-pressure", "60 psi", "--length", "85 mm", "--load", "5 lb"],
        "leave out one of `length`, `load`, and `gauge_pressure` or `duty`",
    );
    refused(&folder, pulsed, &["--duty", "1.4"], "duty");
    refused(&folder, sealed, &["--duty", "0.4"], "no PWM");
    refused(&folder, pulsed, &["--gauge-pressure", "60"], "60 psi");
    refused(&folder, pulsed, &["--length", "3 N"], "no length");
    refused(&folder, pulsed, &["--length", "50 mm"], "min_length");
    refused(&folder, pulsed, &["--length", "50 mm"], "`length` = 50 mm contradicts");
    refused(&folder, pulsed, &["--gauge-pressure", "-2 bar"], "vacuum");
    refused(&folder, pulsed, &["--gauge-pressure", "120 psi", "--pwm"], "no duty");
    refused(&folder, pulsed, &["--plot", "a.svg", "--input", "nothing"], "duty, mass_flow, force");
    refused(&folder, pulsed, &["--output", "model.txt"], ".json");
    refused(&folder, pulsed, &["--plot", "bode.jpg"], ".pdf");
    refused(&folder, sealed, &["--amplitude", "0 mm"], "amplitude");
    refused(&folder, "examples/isometric-charge.toml", &["--load", "5 lb"], "held");
    refused(&folder, "examples/paper/fig-03.toml", &[], "prescribed motion");
    let joint = "examples/antagonistic-joint.toml";
    refused(&folder, joint, &["--gauge-pressure", "60 psi"], "a joint has two actuators");
    refused(&folder, joint, &["--amplitude", "1 mm"], "`amplitude` is not supported for a joint");
    let stiff = ["--angle", "5 deg", "--stiffness", "2 N*m/rad", "--amplitude", "1 mm"];
    refused(&folder, joint, &stiff, "leave `amplitude` out");
    refused(
        &folder,
        joint,
        &["--plot", "a.svg", "--input", "mass_flow"],
        "agonist_mass_flow, antagonist_mass_flow, torque",
    );
    refused(&folder, joint, &["--angle", "20 deg", "--stiffness", "0.01 N*m/rad"], "must not be less than");
    refused(&folder, pulsed, &["--angle", "0 deg", "--stiffness", "1 N*m/rad"], "no joint");
}
