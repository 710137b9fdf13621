//! Which warnings a run has, and what they say.

use super::*;
use crate::settle::End;
use mckibben_scenario::Document;

const MUSCLE: &str = "[supply]\ngauge_pressure = \"100 psi\"\n[valve]\npreset = \"matrix-eight-channel\"\n\
                      [command]\nkind = \"pwm\"\nfrequency = \"25 Hz\"\nduty = 0.5\n\
                      [load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n[run]\nduration = \"0.2 s\"";

/// The codes of a scenario's warnings with some values set, before a run and of the whole run.
fn codes(set: &[(&str, &str)]) -> [Vec<&'static str>; 2] {
    let mut document = Document::parse(MUSCLE, "muscle.toml").unwrap();
    set.iter().for_each(|(key, value)| document.set_plain_from("--set", key, value).unwrap());
    let ready = Ready::of(&document).unwrap();
    let before = ready.warnings();
    let all = of_run(before.clone(), &ready.stream(&document, None, End::Duration).unwrap().0);
    [before, all].map(|warnings| warnings.iter().map(|warning| warning.code).collect())
}

#[test]
fn a_plain_run_has_no_warnings() {
    assert_eq!(codes(&[]), [vec![], vec![]] as [Vec<&str>; 2]);
}

/// The valve opens 4 ms after its coil is energised and closes 1 ms after: at 25 Hz a duty of 0.1 is a pulse of 4 ms, one of
/// 0.975 leaves a pause of 1 ms, and both still move the poppet.
#[test]
fn pulses_at_the_delay_move_the_valve_and_shorter_ones_do_not() {
    let of = |duty| codes(&[("command.duty", duty)])[0].clone();
    assert_eq!(of("0.0999"), ["valve-never-opens"]);
    assert!(of("0.1001").is_empty());
    assert!(of("0.9749").is_empty());
    assert_eq!(of("0.9751"), ["valve-never-closes"]);
    // The valve that is commanded shut, or open, at all times does what is commanded.
    assert!(of("0").is_empty() && of("1").is_empty());
}

/// Numbers that a warning compares differ in its words, however little: 0.0999999 of 40 ms is 3.999996 ms.
#[test]
fn values_that_are_compared_have_as_many_digits_as_it_takes() {
    assert_eq!(compared([0.099_999_9 / 25.0, 0.004], "s"), ["3.999996 ms", "4 ms"]);
    assert_eq!(compared([0.002, 0.004], "s"), ["2 ms", "4 ms"]);
    assert_eq!(compared([0.999_999_9e-3, 1e-3], "s"), ["0.9999999 ms", "1 ms"]);
    assert_eq!(compared([6.000_001e5, 6e5], "Pa"), ["6.000001 bar", "6 bar"]);
    assert_eq!(compared([6e5, 6e5], "Pa"), ["6 bar", "6 bar"]);
    let mut document = Document::parse(MUSCLE, "muscle.toml").unwrap();
    document.set_plain_from("--set", "command.duty", "0.0999999").unwrap();
    let warnings = Ready::of(&document).unwrap().warnings();
    let text = warnings.first().map_or("", |warning| &warning.text);
    assert!(text.contains("a pulse of 3.999996 ms is shorter than valve.opening_delay = 4 ms"), "{text}");
}

/// A pause of a tenth of a period is 4 ms at 25 Hz, and 1 − 0.9 is not 0.1 in binary: the poppet moves all the same.
#[test]
fn a_pause_that_equals_the_delay_but_for_rounding_closes_the_valve() {
    for (frequency, duty, delay) in [
        ("25 Hz", "0.9", "4 ms"),
        ("20 Hz", "0.8", "10 ms"),
        ("25 Hz", "0.8", "8 ms"),
        ("40 Hz", "0.8", "5 ms"),
        ("50 Hz", "0.8", "4 ms"),
    ] {
        let of = |delay| {
            let set = [("command.frequency", frequency), ("command.duty", duty), ("valve.closing_delay", delay)];
            codes(&set)[0].clone()
        };
        assert!(of(delay).is_empty(), "{frequency}, {duty}");
        assert_eq!(of("10.001 ms"), ["valve-never-closes"], "{frequency}, {duty}");
    }
    let table = "{ kind = \"table\", time = [\"0.1 s\", \"0.2 s\", \"0.203 s\"], \
                 state = [\"fill\", \"exhaust\", \"fill\"] }";
    let of = |delay| codes(&[("command", table), ("valve.closing_delay", delay)])[0].clone();
    assert!(of("3 ms").is_empty());
    assert_eq!(of("3.001 ms"), ["valve-never-closes"]);
}

/// A normally open valve closes its path to the supply by the coil: a short fill is lost to the closing delay.
#[test]
fn a_normally_open_valve_has_the_delays_exchanged() {
    let of = |duty| codes(&[("valve.kind", "three-way-normally-open"), ("command.duty", duty)])[0].clone();
    assert_eq!(of("0.0249"), ["valve-never-opens"]);
    assert!(of("0.0251").is_empty());
    assert_eq!(of("0.9001"), ["valve-never-closes"]);
}

/// Of a table the longest pulse counts, two states that are alike as one, and the longest pause behind a pulse.
#[test]
fn a_table_of_pulses_that_are_too_short_is_warned_of() {
    let of = |times: &str, states: &str| {
        let table = format!("{{ kind = \"table\", time = [{times}], state = [{states}] }}");
        codes(&[("command", &table)])[0].clone()
    };
    let pulses = "\"fill\", \"exhaust\", \"fill\", \"exhaust\"";
    assert_eq!(of("\"10 ms\", \"12 ms\", \"50 ms\", \"53 ms\"", pulses), ["valve-never-opens"]);
    assert!(of("\"10 ms\", \"12 ms\", \"50 ms\", \"55 ms\"", pulses).is_empty());
    let joined = "\"fill\", \"fill\", \"exhaust\"";
    assert!(of("\"10 ms\", \"12 ms\", \"15 ms\"", joined).is_empty());
    let again = "\"fill\", \"exhaust\", \"fill\"";
    assert_eq!(of("\"10 ms\", \"20 ms\", \"20.9 ms\"", again), ["valve-never-closes"]);
    assert!(of("\"10 ms\", \"20 ms\", \"21.1 ms\"", again).is_empty());
    assert!(of("\"10 ms\"", "\"fill\"").is_empty() && of("\"10 ms\"", "\"exhaust\"").is_empty());
}

#[test]
fn what_no_braid_holds_is_warned_of() {
    let [before, all] = codes(&[("supply.gauge_pressure", "600 bar"), ("run.duration", "0.5 s")]);
    assert_eq!(before, ["pressure"]);
    assert!(["pressure", "thrown"].iter().all(|code| all.contains(code)), "{all:?}");
    let [before, all] = codes(&[("supply.gauge_pressure", "8 bar")]);
    assert!(before.is_empty() && all.is_empty(), "{all:?}");
}

#[test]
fn a_load_that_exceeds_the_muscle_is_warned_of() {
    let [before, all] = codes(&[("load.mass", "200 kg")]);
    assert_eq!(before, ["overstretched"]);
    assert!(["overstretched", "tension"].iter().all(|code| all.contains(code)), "{all:?}");
}

/// The muscle is 4.3 in long at most where nothing loads it. A length that the scenario gives is named, before and after the run.
#[test]
fn a_start_beyond_the_taut_length_names_what_says_so() {
    let mut document = Document::parse(MUSCLE, "muscle.toml").unwrap();
    document.set_plain_from("--set", "initial.length", "108 mm").unwrap();
    let ready = Ready::of(&document).unwrap();
    let (before, figures) = (ready.warnings(), ready.stream(&document, None, End::Duration).unwrap().0);
    for found in [before.clone(), of_run(before, &figures)] {
        let text = &found.iter().find(|of| of.code == OVERSTRETCHED).expect("too long").text;
        assert!(text.contains("starts at 108.0 mm") && text.contains("lower initial.length"), "{text}");
    }
}

/// With a tendon the distance is that of both: the muscle, of 97.79 mm at most, is no longer than the distance without the tendon's
/// rest length. A stiff tendon leaves it all of that.
#[test]
fn a_start_on_a_tendon_is_judged_by_the_length_of_the_muscle() {
    let of = |rest_length: &str| {
        let motion = "{ kind = \"prescribed-motion\", length = \"106 mm\", amplitude = \"1 mm\", \
                      frequency = \"1 Hz\" }";
        let tendon = format!("{{ stiffness = \"1e7 N/m\", rest_length = \"{rest_length}\" }}");
        let of_one = codes(&[("load", motion), ("tendon", &tendon)])[0].clone();
        let joint = "[tendon]\nstiffness = \"1e7 N/m\"\n[load]\nkind = \"antagonistic-joint\"\nmass = \"1 kg\"\n\
                     distance = \"0.1 m\"\npulley_radius = \"15 mm\"\nrest_length = \"106 mm\"\n[antagonist]\n\
                     [initial]\ngauge_pressure = \"2 bar\"\n[run]\nduration = \"0.01 s\"";
        let mut joint = Document::parse(joint, "joint.toml").unwrap();
        joint.set_text("tendon.rest_length", &format!("\"{rest_length}\"")).unwrap();
        let of_two = Ready::of(&joint).unwrap().warnings();
        (of_one, of_two.iter().map(|warning| warning.code).collect::<Vec<_>>())
    };
    assert_eq!(of("20 mm"), (vec![], vec![]));
    assert_eq!(of("2 mm"), (vec![OVERSTRETCHED], vec![OVERSTRETCHED; 2]));
}

/// A joint of two actuators and one of a chain. Stops give way, so that a joint may start at rest beyond one.
#[test]
fn a_start_beyond_a_stop_names_joint_angle_limit_and_remedy() {
    let examples = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let of = |file: &str, set: &[(&str, &str)]| {
        let mut document = Document::load(examples.join(file)).unwrap();
        set.iter().for_each(|(key, value)| document.set_plain_from("--set", key, value).unwrap());
        let found = Ready::of(&document).unwrap().warnings().into_iter().filter(|of| of.code == BEYOND_STOP);
        found.map(|of| of.to_string()).collect::<Vec<_>>()
    };
    let joint = "antagonistic-joint.toml";
    let words = "the joint starts at 15°, beyond its stop at load.max_angle = 5°";
    let remedy = "lower initial.angle or raise load.max_angle";
    let found = of(joint, &[("load.max_angle", "5 deg"), ("initial.angle", "15 deg")]);
    assert!(found.len() == 1 && found[0].contains(words) && found[0].ends_with(remedy), "{found:?}");
    assert!(of(joint, &[("load.max_angle", "15 deg"), ("initial.angle", "15 deg")]).is_empty());
    // A torque that presses the joint against its stop: at equilibrium it rests a part of a degree beyond.
    let pressed = [("load.max_angle", "5 deg"), ("load.torque", "5 N*m")];
    assert!(of(joint, &[&pressed[..], &[("initial.angle", "equilibrium")]].concat()).is_empty());
    assert_eq!(of(joint, &[&pressed[..], &[("initial.angle", "6 deg")]].concat()).len(), 1);
    let chain = "plant/hose-joint.toml";
    assert!(of(chain, &[]).is_empty());
    let document = Document::load(examples.join(chain)).unwrap();
    let Ready::Plant(plant) = Ready::of(&document).unwrap() else { panic!("a plant") };
    let name = &plant.names.mechanisms[0].joints[0];
    let found = of(chain, &[(&format!("mechanism.joints.{name}.angle"), "-45 deg")]);
    let words = format!("{name}: the joint starts at -45°, beyond its stop at joints.{name}.min_angle = -40°");
    let remedy = format!("raise joints.{name}.angle or lower joints.{name}.min_angle");
    assert!(found.len() == 1 && found[0].contains(&words) && found[0].ends_with(&remedy), "{found:?}");
}

#[test]
fn a_start_below_full_contraction_is_warned_of() {
    let of = |length| codes(&[("initial.length", length)])[0].clone();
    assert_eq!(of("2.4 in"), ["starts-slack"]);
    assert!(of("2.5 in").is_empty());
}

/// Between two points the start has the length of the straight line; on moment arms that of `rest_length`.
#[test]
fn a_slack_start_over_a_joint_names_what_its_length_follows_from() {
    let of = |coupling: &str, tendon: &str| {
        let joint = "mass = \"0.5 kg\"\ndistance = \"0.1 m\"\ninertia = \"1e-3 kg*m^2\"\n";
        let text = format!(
            "[mechanism]\nkind = \"chain\"\n[mechanism.joints.elbow]\n{joint}[actuators.biceps]\n\
             preset = \"colbrunn-2001\"\n{coupling}\n{tendon}\n[run]\nduration = \"10 ms\"\n"
        );
        let document = Document::parse(&text, "arm.toml").unwrap();
        let found = Ready::of(&document).unwrap().warnings();
        found.iter().filter(|of| of.code == "starts-slack").map(ToString::to_string).collect::<Vec<_>>()
    };
    let points = |along: &str| {
        format!(
            "coupling.origin.along = \"{along}\"\n\
             coupling.insertion = {{ segment = \"elbow\", along = \"10 cm\" }}"
        )
    };
    let tendon = "tendon = { stiffness = \"8 N/mm\", rest_length = \"2 mm\" }";
    let remedy = "raise the distance between coupling.origin and coupling.insertion, or start at another angle";
    for (coupling, tendon, words) in [
        (points("10 cm"), "", "both ends at one point"),
        (points("10 cm"), tendon, "both ends at one point"),
        (points("6 cm"), "", "it starts slack, 40.00 mm long"),
    ] {
        let found = of(&coupling, tendon);
        assert!(found.len() == 1 && found[0].starts_with("biceps: "), "{found:?}");
        assert!(found[0].contains(words) && found[0].ends_with(remedy), "{found:?}");
    }
    assert!(of(&points("1 cm"), "").is_empty());
    let found = of("coupling = { rest_length = \"40 mm\", arms.elbow = \"1 cm\" }", "");
    assert!(found.len() == 1 && found[0].contains("raise the rest length over the joint"), "{found:?}");
}

/// A pressure regulator refuses such a set point; a controller may aim for it.
#[test]
fn a_requested_pressure_above_the_supply_is_warned_of() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/control/bang-bang.toml");
    let mut document = Document::load(path).unwrap();
    assert_eq!(Ready::of(&document).unwrap().warnings(), []);
    document.set_text("supply.gauge_pressure", "\"55 psi\"").unwrap();
    let found = Ready::of(&document).unwrap().warnings();
    assert_eq!(found.iter().map(|of| of.code).collect::<Vec<_>>(), ["supply-exceeded"]);
    let text = "controller.gauge_pressure = 4.137 bar exceeds supply.gauge_pressure = 3.792 bar";
    assert!(found[0].text.contains(text), "{}", found[0]);
}

/// What the model of a joint may request is known of both valves; of a plant each controller's.
#[test]
fn requests_of_joints_and_plants_are_compared_with_the_supply() {
    let of = |file: &str, set: &[(&str, &str)]| {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples").join(file);
        let mut document = Document::load(path).unwrap();
        set.iter().for_each(|(key, value)| document.set_plain_from("--set", key, value).unwrap());
        let found = Ready::of(&document).unwrap().warnings();
        let found = found.into_iter().filter(|of| of.code == "supply-exceeded");
        found.map(|of| of.part).collect::<Vec<_>>()
    };
    let joint = "control/joint-air-mass.toml";
    assert_eq!(of(joint, &[("supply.gauge_pressure", "80 psi")]), ["agonist", "antagonist"]);
    assert!(of(joint, &[("supply.gauge_pressure", "85 psi")]).is_empty());
    // The compressor fills the tank up to 4.5 bar.
    let (plant, key) = ("plant/controlled.toml", "actuators.gripper.controller.gauge_pressure");
    assert!(of(plant, &[(key, "[\"1 bar\", \"4.4 bar\", \"2 bar\"]")]).is_empty());
    assert_eq!(of(plant, &[(key, "[\"1 bar\", \"4.6 bar\", \"2 bar\"]")]), ["gripper"]);
}

/// The codes and texts of an example with values set, before anything is run.
fn known(file: &str, set: &[(&str, &str)]) -> Vec<(&'static str, String)> {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples").join(file);
    let mut document = Document::load(path).unwrap();
    set.iter().for_each(|(key, value)| document.set_plain_from("--set", key, value).unwrap());
    Ready::of(&document).unwrap().warnings().into_iter().map(|of| (of.code, of.to_string())).collect()
}

/// The muscle of the examples is 97.79 mm long where it is taut and 63.38 mm at full contraction.
#[test]
fn set_points_that_no_muscle_reaches_are_warned_of() {
    let of = |length: &str| known("control/pid.toml", &[("controller.length", length)]);
    for (length, words) in [
        ("200 mm", "controller.length = 203 mm is 107.6 % above actuator.max_length = 97.79 mm"),
        ("60 mm", "controller.length = 57 mm is below the 63.38 mm of actuator.min_length"),
    ] {
        let found = of(length);
        assert!(found.len() == 1 && found[0].0 == "set-point-beyond", "{found:?}");
        assert!(found[0].1.contains(words), "{found:?}");
    }
    // 98 mm and 3 mm of its swing: a heavy load stretches the taut braid so far.
    assert!(of("98 mm").is_empty());
    let model = known("control/feed-forward.toml", &[("controller.length", "[\"92 mm\", \"86 mm\", \"110 mm\"]")]);
    assert!(model.iter().map(|of| of.0).eq(["set-point-beyond"]), "{model:?}");
}

/// Nothing is below vacuum, −1.013 bar gauge; between it and the atmosphere no exhaust pulls the air out.
#[test]
fn requested_pressures_below_the_atmosphere_are_warned_of() {
    let of = |gauge: &str| {
        let list = format!("[\"40 psi\", \"60 psi\", \"{gauge}\"]");
        known("control/bang-bang.toml", &[("controller.gauge_pressure", &list)])
    };
    let found = of("-2 bar");
    let words = "controller.gauge_pressure = -2 bar is a gauge pressure and not above vacuum, -1.013 bar";
    assert!(found.len() == 1 && found[0].0 == "supply-exceeded" && found[0].1.contains(words), "{found:?}");
    let found = of("-0.2 bar");
    let words = "controller.gauge_pressure = -0.2 bar lies below the pressure of the atmosphere";
    assert!(found.len() == 1 && found[0].1.contains(words), "{found:?}");
    assert!(of("0 bar").is_empty());
}

/// At 25 Hz even a pulse of a whole period is lost to a delay of 50 ms; at 15 Hz one of 67 ms is not.
#[test]
fn pulses_of_a_controller_that_are_shorter_than_the_delay_are_warned_of() {
    let of = |frequency: &str| {
        let set = [("valve.opening_delay", "50 ms"), ("controller.pulse_frequency", frequency)];
        known("control/pid.toml", &set)
    };
    let found = of("25 Hz");
    let words =
        "a whole period of 40 ms is shorter than valve.opening_delay = 50 ms; lower controller.pulse_frequency = 25 Hz";
    assert!(found.len() == 1 && found[0].0 == "valve-never-opens" && found[0].1.contains(words), "{found:?}");
    assert!(of("15 Hz").is_empty() && of("20 Hz").is_empty());
    // A relay holds a request for as many samples as it likes.
    assert!(known("control/bang-bang.toml", &[("valve.opening_delay", "5 ms")]).is_empty());
}

/// 80 % written as 80; a measured force may exceed the ideal braid's, but not twofold.
#[test]
fn an_effectiveness_in_percent_is_warned_of() {
    let of = |value| known("valves/opening-ramp.toml", &[("actuator.effectiveness", value)]);
    let found = of("{ constant = 80 }");
    let words = "the effectiveness is 80.00 at a gauge pressure of 0 bar, above 2";
    assert!(found.len() == 1 && found[0].0 == "effectiveness" && found[0].1.contains(words), "{found:?}");
    assert!(of("{ constant = 1.3 }").is_empty() && of("{ constant = \"80 %\" }").is_empty());
    // 0.7 at no pressure and 4.1 at the 100 psi of the supply.
    let rising = of("{ polynomial = [0.7, 0.034], pressure_unit = \"psi\" }");
    assert!(rising.len() == 1 && rising[0].1.contains("is 4.100 at a gauge pressure of 6.895 bar"), "{rising:?}");
}

/// The modulus of the wall is a cubic of the length in m, fitted from 237 mm to 300 mm: at 180 mm it is 59 MPa in place of 8.
#[test]
fn a_preset_of_another_length_is_warned_of() {
    let of = |length: &str| {
        let text = format!(
            "[actuator]\npreset = \"festo-dmsp-20-300\"\nlength = \"{length}\"\ndiameter = \"20 mm\"\n\
             braid_angle = \"25 deg\"\n[load]\nkind = \"hanging-mass\"\nmass = \"5 kg\"\n[run]\nduration = \"10 ms\"\n"
        );
        let document = Document::parse(&text, "muscle.toml").unwrap();
        let found = Ready::of(&document).unwrap().warnings();
        found.into_iter().filter(|of| of.code == "preset-length").map(|of| of.text).collect::<Vec<_>>()
    };
    let found = of("180 mm");
    let words = "of the preset festo-dmsp-20-300, whose wall was fitted to a muscle of 300 mm, and actuator.max_length = 180.0 mm";
    assert!(found.len() == 1 && found[0].contains(words), "{found:?}");
    assert!(of("300 mm").is_empty() && of("290 mm").is_empty());
    assert_eq!(of("320 mm").len(), 1);
}

#[test]
fn a_map_beyond_its_table_is_warned_of() {
    let map = "{ law = \"map\", gauge_pressure = [\"0 bar\", \"3 bar\"], length = [\"70 mm\", \"98 mm\"], \
               tension = [\"0 N\", \"1 N\", \"0 N\", \"60 N\"] }";
    let of = |supply| codes(&[("actuator.force", map), ("supply.gauge_pressure", supply)])[1].clone();
    assert!(of("6 bar").contains(&"law-extrapolated"));
    assert!(!of("2.9 bar").contains(&"law-extrapolated"));
}

#[test]
fn a_law_that_pushes_is_warned_of() {
    let of = |least: &str| {
        let map = format!(
            "{{ law = \"map\", gauge_pressure = [\"0 bar\", \"7 bar\"], length = [\"70 mm\", \"98 mm\"], \
             tension = [\"{least}\", \"1 N\", \"{least}\", \"60 N\"] }}"
        );
        let load = ("load", "{ kind = \"isometric\" }");
        codes(&[("actuator.force", &map), load, ("initial.length", "72 mm"), ("run.duration", "50 ms")])[1].clone()
    };
    assert_eq!(of("-40 N"), ["law-negative"]);
    assert!(of("0 N").is_empty());
    // A muscle that nothing fills has the atmosphere's pressure to within rounding.
    let empty = [
        ("valve", "{ kind = \"fill-hold-exhaust\", flow_area = \"1 mm^2\" }"),
        ("command", "{ kind = \"hold\" }"),
        ("load", "{ kind = \"isometric\" }"),
        ("initial", "{ length = \"85 mm\" }"),
    ];
    assert!(codes(&empty)[1].is_empty());
}

/// The text of the one warning of a code of a run.
fn text_of(code: &str, scenario: &str) -> String {
    let document = Document::parse(scenario, "muscle.toml").unwrap();
    let ready = Ready::of(&document).unwrap();
    let all = of_run(ready.warnings(), &ready.stream(&document, None, End::Duration).unwrap().0);
    let found: Vec<String> = all.iter().filter(|of| of.code == code).map(ToString::to_string).collect();
    assert_eq!(found.len(), 1, "{code}: {all:?}");
    found.concat()
}

/// The taut muscle is 97.79 mm long; 5 % more are 102.7 mm.
#[test]
fn a_motion_that_goes_too_far_names_its_keys() {
    let run = "[run]\nduration = \"0.1 s\"\n";
    let wave = "kind = \"prescribed-motion\"\nlength = \"95 mm\"\namplitude = \"10 mm\"\nfrequency = \"10 Hz\"\n";
    let table = "kind = \"prescribed-motion\"\ntime = [\"0 s\", \"0.1 s\"]\ntable_length = [\"95 mm\", \"105 mm\"]\n";
    for (scenario, keys) in [
        (format!("[load]\n{wave}{run}"), "lower load.length or load.amplitude"),
        (format!("[load]\n{table}{run}"), "lower load.table_length"),
        (
            format!("[mechanism]\n{}{run}[actuators.a]\n", wave.replace("-motion", "")),
            "lower mechanism.length or mechanism.amplitude",
        ),
    ] {
        let text = text_of(OVERSTRETCHED, &scenario);
        assert!(text.contains("reaches 105.0 mm") && text.ends_with(keys), "{text}");
    }
}

/// A sealed muscle has no supply: its motion compresses the air. By the braid's volume and 3 cm³ outside from 70 mm to 90 mm to
/// four fifths, 17 bar become 23 bar.
#[test]
fn a_pressure_of_a_sealed_muscle_names_its_start_and_its_motion() {
    let motion = "[load]\nkind = \"prescribed-motion\"\nlength = \"80 mm\"\namplitude = \"10 mm\"\n\
                  frequency = \"10 Hz\"\nphase = \"-90 deg\"\n";
    let rest = "[initial]\ngauge_pressure = \"16 bar\"\n[run]\nduration = \"0.1 s\"\n";
    let text = text_of("pressure", &format!("{motion}{rest}"));
    let remedy = "lower initial.gauge_pressure, or change load.length or load.amplitude";
    assert!(text.contains(remedy) && !text.contains("supply"), "{text}");
}

/// The supply of a plant has the key that its file has.
#[test]
fn a_pressure_of_a_named_supply_names_that() {
    let scenario = "[valve]\nkind = \"two-way\"\nflow_area = \"1 mm^2\"\n[command]\nkind = \"fill\"\n[load]\n\
                    kind = \"isometric\"\n[initial]\nlength = \"90 mm\"\n[run]\nduration = \"1 ms\"\n\
                    [supplies.bottle]\ngauge_pressure = \"200 bar\"\n[actuators.a]\n";
    let document = Document::parse(scenario, "plant.toml").unwrap();
    let found = Ready::of(&document).unwrap().warnings();
    assert!(found.len() == 1 && found[0].text.ends_with("lower supplies.bottle.gauge_pressure"), "{found:?}");
}

/// P_g(3L² − b²)/(4πn²) with P_g below zero falls further with the length: a higher pressure alone helps.
#[test]
fn a_braid_below_the_pressure_of_the_atmosphere_has_the_remedy_that_helps() {
    let scenario = "[load]\nkind = \"isometric\"\n[initial]\nlength = \"85 mm\"\ngauge_pressure = \"-0.5 bar\"\n[run]\n\
                    duration = \"10 ms\"\n";
    let text = text_of("law-negative", scenario);
    assert!(text.contains("; keep its pressure higher there; ") && !text.contains("min_length"), "{text}");
}

#[test]
fn steps_that_lose_energy_are_warned_of() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/fill-hold-exhaust.toml");
    let of = |step: &str| {
        let mut document = Document::load(&path).unwrap();
        for (key, value) in [("run.engine", "fixed-step"), ("run.step", step), ("run.sample_interval", step)] {
            document.set_plain_from("--set", key, value).unwrap();
        }
        let ready = Ready::of(&document).unwrap();
        let figures = ready.stream(&document, None, End::Duration).unwrap().0;
        figures.warnings().iter().map(|warning| warning.code).collect::<Vec<_>>()
    };
    assert!(of("1 ms").contains(&"energy-open"));
    assert!(!of("50 us").contains(&"energy-open"));
}

/// Of 1 kg that a muscle gained 0.9 kg were given: 0.1 of a turnover of 1.9 kg. What the tolerance may leave is no fault.
#[test]
fn air_and_exergy_that_do_not_close_are_warned_of_by_name() {
    let given = |mass| mckibben::plant::Carried { mass, ..Default::default() };
    let actuator = |mass| mckibben::plant::ActuatorLedger { air_gain: 1.0, given: given(mass), ..Default::default() };
    let of = |mass, draws| {
        let mut ledger = PlantLedger::default();
        ledger.actuators = vec![actuator(mass)];
        open_balance(&ledger, draws)
    };
    let found = of(0.9, true).expect("open");
    assert!(found.text.contains("5.263 % of its air (100.0 g of 1.900 kg)"), "{found}");
    assert!(found.code == "energy-open" && !found.text.contains("energy (") && !found.text.contains("exergy"));
    assert!(of(0.99, true).is_none() && of(0.9, false).is_none());
    // Near its limit of stability the method of Runge and Kutta loses exergy in a hose: at a third of the step it does not.
    let of = |step: &str| {
        let hose = "{ length = \"0.3 m\", diameter = \"4 mm\" }";
        let mut document = Document::parse(MUSCLE, "muscle.toml").unwrap();
        for (key, value) in [
            ("supply.gauge_pressure", "4 bar"),
            ("valve", "{ kind = \"three-way\", flow_area = \"1 mm^2\" }"),
            ("command.frequency", "40 Hz"),
            ("hose", hose),
            ("load", "{ kind = \"isometric\" }"),
            ("initial.length", "85 mm"),
            ("run.engine", "fixed-step"),
            ("run.method", "rk4"),
            ("run.step", step),
        ] {
            document.set_plain_from("--set", key, value).unwrap();
        }
        let figures = Ready::of(&document).unwrap().stream(&document, None, End::Duration).unwrap().0;
        figures.warnings().into_iter().find(|of| of.code == "energy-open").map(|of| of.text)
    };
    assert!(of("0.15 ms").is_some_and(|text| text.contains("of its exergy (") && !text.contains("energy (")));
    assert_eq!(of("0.05 ms"), None);
}

#[test]
fn each_actuator_of_a_plant_is_named() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/plant/arm.toml");
    let mut document = Document::load(path).unwrap();
    assert_eq!(Ready::of(&document).unwrap().warnings(), []);
    document.set_text("initial.gauge_pressure", "\"30 bar\"").unwrap();
    document.set_text("run.duration", "\"1 ms\"").unwrap();
    let ready = Ready::of(&document).unwrap();
    let Ready::Plant(plant) = &ready else { panic!("a plant") };
    let names = plant.names.actuators.clone();
    let of = |warnings: &[Warning]| -> Vec<String> {
        warnings.iter().filter(|of| of.code == "pressure").map(|of| of.part.clone()).collect()
    };
    let before = ready.warnings();
    assert_eq!(of(&before), names);
    // What the run reached takes the place of what was known before, each once.
    assert_eq!(of(&of_run(before, &ready.stream(&document, None, End::Duration).unwrap().0)), names);
}

#[test]
fn each_actuator_of_a_joint_is_named() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/antagonistic-joint.toml");
    let mut document = Document::load(path).unwrap();
    document.set_text("run.duration", "\"0.2 s\"").unwrap();
    let plain = Ready::of(&document).unwrap().warnings();
    document.set_text("initial.gauge_pressure", "\"30 bar\"").unwrap();
    let ready = Ready::of(&document).unwrap();
    let found = ready.warnings();
    assert!(plain.iter().all(|warning| warning.code != "pressure"));
    let of = |part: &str| found.iter().any(|of| of.code == "pressure" && of.part == part);
    assert!(of("agonist"), "{found:?}");
    assert!(found.iter().find(|of| of.code == "pressure").unwrap().to_string().starts_with("agonist: "));
}
