//! A braid from whichever of its numbers a file states, and the presets of measured muscles.
//!
//! The closed form: `L₀ = b cos θ₀` and `π n D₀ = b sin θ₀`.

use mckibben::parameter as p;
use mckibben::simulation::simulate;
use mckibben_scenario::diagnostic::Class;
use mckibben_scenario::presets::{ACTUATORS, DMSP_10_250, DMSP_20_300};
use mckibben_scenario::{Document, Force, MUSCLE_TOLERANCE, Muscle, Scenario};
use std::f64::consts::PI;

const LENGTH: f64 = 0.2;
const DIAMETER: f64 = 0.01;
const ANGLE: f64 = 25.0;

const REST: &str = "\n[load]\nkind = \"hanging-mass\"\nmass = \"5 kg\"\n[initial]\ngauge_pressure = \"2 bar\"\n[run]\nduration = \"50 ms\"\n";

/// The five keys of one muscle, as text.
fn keys() -> [(&'static str, String); 5] {
    let (b, n) = closed_form();
    [
        ("thread_length", format!("\"{b} m\"")),
        ("turns", format!("{n:?}")),
        ("length", format!("\"{LENGTH} m\"")),
        ("diameter", format!("\"{DIAMETER} m\"")),
        ("braid_angle", format!("\"{ANGLE} deg\"")),
    ]
}

/// Thread length and turns from length, diameter and angle.
fn closed_form() -> (f64, f64) {
    let theta = ANGLE.to_radians();
    let b = LENGTH / theta.cos();
    (b, b * theta.sin() / (PI * DIAMETER))
}

fn document(actuator: &str) -> Document {
    Document::parse(&format!("[actuator]\n{actuator}{REST}"), "muscle.toml").expect("TOML")
}

fn scenario(actuator: &str) -> Scenario {
    document(actuator).scenario().unwrap_or_else(|error| panic!("{actuator}\n{error}"))
}

/// What is wrong, which is one thing, with its class, line and text.
fn refused(actuator: &str) -> (Class, usize, String) {
    let found = document(actuator).scenario().expect_err(actuator);
    let all: Vec<_> = found.iter().collect();
    assert_eq!(all.len(), 1, "{found}");
    (all[0].class(), all[0].place().map_or(0, |place| place.line()), found.to_string())
}

fn lines(of: impl IntoIterator<Item = usize>) -> String {
    let keys = keys();
    of.into_iter().map(|at| format!("{} = {}\n", keys[at].0, keys[at].1)).collect()
}

/// Whether keys, by their place among the five, determine a braid: two equations are left for the others, and those for the turns.
fn determines(set: &[usize]) -> bool {
    set.len() > 3 || set == [0, 1] || (set.len() == 3 && set != [0, 2, 4])
}

fn near(found: f64, expected: f64) -> bool {
    (found - expected).abs() < 1e-12 * expected
}

#[test]
fn every_determining_set_gives_the_closed_form() {
    let (b, n) = closed_form();
    let mut tried = 0;
    for mask in 1_usize..32 {
        let set: Vec<usize> = (0..5).filter(|at| mask & (1 << at) != 0).collect();
        // Of the model's own numbers alone, `max_length` says where the muscle is at rest.
        let longest = if set == [0, 1] { "max_length = \"0.2 m\"\n" } else { "" };
        let text = lines(set.iter().copied()) + longest;
        if !determines(&set) {
            assert!(document(&text).muscle().is_none(), "{text}");
            continue;
        }
        tried += 1;
        let actuator = scenario(&text).actuator;
        assert!(near(actuator.thread_length, b) && near(actuator.turns, n), "{text}{actuator:?}");
        assert!(near(actuator.max_length, LENGTH) && near(actuator.min_length, b / 3_f64.sqrt()), "{text}{actuator:?}");
        let muscle: Muscle = document(&text).muscle().expect("a muscle");
        let found = [muscle.length, muscle.diameter, muscle.braid_angle];
        assert!(found.into_iter().zip([LENGTH, DIAMETER, ANGLE.to_radians()]).all(|(a, b)| near(a, b)), "{found:?}");
        let stated: Vec<&str> = muscle.stated().map(|row| row.key.rsplit('.').next().expect("a name")).collect();
        assert_eq!(stated, set.iter().map(|at| keys()[*at].0).collect::<Vec<_>>());
        // The braid of the core has that diameter and angle there.
        let braid = mckibben::Braid::new(actuator.thread_length, actuator.turns).expect("a braid");
        assert!(near(braid.diameter(LENGTH), DIAMETER) && near(braid.interweave_angle(LENGTH), ANGLE.to_radians()));
    }
    assert_eq!(tried, 16);
}

#[test]
fn too_little_is_refused_with_what_would_do() {
    let of = |set: &[usize], expected: &[&str], never: &[&str]| {
        let (class, line, text) = refused(&lines(set.iter().copied()));
        assert_eq!((class, line), (Class::Missing, 2), "{text}");
        assert!(expected.iter().all(|word| text.contains(word)), "{text}");
        assert!(!never.iter().any(|word| text.contains(word)), "{text}");
    };
    of(
        &[2, 3],
        &["`length`, `diameter` alone do not determine", "add one of `thread_length`, `turns`, `braid_angle`"],
        &[],
    );
    of(&[3, 4], &["add one of `thread_length`, `turns`, `length`"], &[]);
    // The angle says nothing of the turns in addition to thread and length.
    of(&[0, 2], &["add one of `turns`, `diameter`"], &["`braid_angle`"]);
    of(&[0, 2, 4], &["add one of `turns`, `diameter`"], &[]);
    of(&[3], &["add two of `thread_length`, `turns`, `length`, `braid_angle`"], &[]);
    // A preset has another braid, which one number of a muscle at rest does not alter.
    let (_, line, text) = refused("preset = \"colbrunn-2001\"\ndiameter = \"10 mm\"\n");
    assert!(line == 3 && text.contains("add two of"), "{text}");
    // A key that is misspelt is the one mistake.
    let (class, _, text) = refused("length = \"200 mm\"\ndiameter = \"10 mm\"\nbraid_angel = \"25 deg\"\n");
    assert!(class == Class::UnknownKey && text.contains("`braid_angle`"), "{text}");
    let (_, _, text) = refused("rest_length = \"200 mm\"\ndiameter = \"10 mm\"\nbraid_angle = \"25 deg\"\n");
    assert!(text.contains("did you mean `length`?"), "{text}");
}

#[test]
fn contradictions_are_refused_with_the_numbers() {
    let of = |text: &str, at: usize, expected: &[&str]| {
        let (class, line, message) = refused(text);
        assert_eq!((class, line), (Class::Inconsistent, at), "{message}");
        assert!(expected.iter().all(|word| message.contains(word)), "{message}");
    };
    let rest = lines([2, 3, 4]);
    let longer = format!("{rest}thread_length = \"300 mm\"\n");
    of(&longer, 5, &["`actuator.thread_length` = 0.3 m", "length, diameter and braid_angle give: 0.220676 m"]);
    of(&format!("{rest}turns = 4\n"), 5, &["`actuator.turns` = 4", "2.96861"]);
    let wide = "thread_length = \"300 mm\"\nturns = 2\nlength = \"200 mm\"\ndiameter = \"10 mm\"\n";
    of(wide, 2, &["`actuator.thread_length` = 0.3 m", "turns, length and diameter give: 0.209637 m"]);
    of(
        "thread_length = \"300 mm\"\nturns = 2\nlength = \"200 mm\"\nbraid_angle = \"25 deg\"\n",
        2,
        &["turns, length and braid_angle give: 0.220676 m"],
    );
    let impossible = "thread_length = \"150 mm\"\ndiameter = \"10 mm\"\nlength = \"200 mm\"\n";
    of(impossible, 4, &["`actuator.length` = 0.2 m", "must be less than", "0.15 m"]);
    let wider = "thread_length = \"150 mm\"\nturns = 10\ndiameter = \"10 mm\"\n";
    of(wider, 4, &["`actuator.diameter` = 0.01 m", "0.00477465 m"]);
    of(&format!("{rest}max_length = \"180 mm\"\n"), 2, &["`actuator.length` = 0.2 m", "at most", "0.18 m"]);
    of(
        "preset = \"festo-dmsp-10-250\"\nturns = 2\n",
        3,
        &["`actuator.turns` = 2 contradicts", "length, diameter and braid_angle give: 4.3387"],
    );
    // An angle beyond the neutral one: the core's rule, shown where the angle stands.
    let (class, line, text) = refused_by_model(&(lines([2, 3]) + "braid_angle = \"60 deg\"\n"));
    assert!(class == Class::Inconsistent && line == 4 && text.contains("follows from the muscle at rest"), "{text}");
    for words in
        ["`actuator.braid_angle` = 60 deg is out of range", "less than 54.736 deg", "an angle such as 25.000 deg"]
    {
        assert!(text.contains(words), "{words}\n{text}");
    }
    let (_, _, text) = refused_by_model(&(lines([2, 3]) + "braid_angle = \"1.2 rad\"\n"));
    assert!(text.contains("`actuator.braid_angle` = 1.2 rad") && text.contains("less than 0.955 rad"), "{text}");
    // Where the greatest length is given, a muscle may be at rest above that angle.
    let stretched = "thread_length = \"300 mm\"\nturns = 2\nbraid_angle = \"60 deg\"\nmax_length = \"250 mm\"\n";
    assert!(document(stretched).experiment().is_ok());
    // Without the angle it follows.
    let (_, _, text) = refused_by_model("turns = 4\nlength = \"100 mm\"\ndiameter = \"20 mm\"\n");
    assert!(text.contains("the braid angle at rest that follows, 68.3") && text.contains("54.736 deg"), "{text}");
    // Beyond a right angle it is no angle of a braid, in the unit of the file.
    let (class, line, text) = refused(&(lines([2, 3]) + "braid_angle = \"95 deg\"\n"));
    assert_eq!((class, line), (Class::OutOfRange, 4), "{text}");
    assert!(
        text.contains("= 95 deg is out of range") && text.contains("greater than 0 and less than 90 deg"),
        "{text}"
    );
}

fn refused_by_model(actuator: &str) -> (Class, usize, String) {
    let found = document(actuator).experiment().expect_err(actuator);
    let one = found.iter().next().expect("a mistake").clone();
    (one.class(), one.place().map_or(0, |place| place.line()), found.to_string())
}

/// Rounding to the digits that people write is no contradiction, and what is stated stands.
#[test]
fn rounded_numbers_agree() {
    let text = "length = \"200 mm\"\ndiameter = \"10 mm\"\nbraid_angle = \"25 deg\"\nthread_length = \"221 mm\"\nturns = 2.97\n";
    let actuator = scenario(text).actuator;
    assert_eq!((actuator.thread_length, actuator.turns, actuator.max_length), (0.221, 2.97, 0.2));
    let (b, _) = closed_form();
    for (factor, agrees) in [(1.0 + 0.9 * MUSCLE_TOLERANCE, true), (1.0 + 1.1 * MUSCLE_TOLERANCE, false)] {
        let text = format!("{}thread_length = \"{} m\"\n", lines([2, 3, 4]), factor * b);
        assert_eq!(document(&text).scenario().is_ok(), agrees, "{factor}");
    }
}

#[test]
fn a_muscle_by_diameter_moves_as_the_one_by_its_thread() {
    let (b, n) = closed_form();
    let by_thread = format!("thread_length = \"{b} m\"\nturns = {n:?}\nmax_length = \"{LENGTH} m\"\n");
    let of = |text: &str| {
        let experiment = document(text).experiment().unwrap_or_else(|error| panic!("{error}"));
        let run = simulate(&experiment.rig, experiment.start, 0.05, 1e-10).expect("a run");
        let at = |step: u32| {
            let state = run.at(0.001 * f64::from(step));
            [state.length, state.velocity, state.pressure.0]
        };
        (0..=50).flat_map(at).collect::<Vec<f64>>()
    };
    let (first, second) = (of(&lines([2, 3, 4])), of(&by_thread));
    assert!(first.len() > 100 && first.len() == second.len());
    for (a, b) in first.iter().zip(&second) {
        assert!((a - b).abs() <= 1e-9 * (1.0 + b.abs()), "{a} {b}");
    }
}

#[test]
fn it_is_written_and_read_again() {
    let found = scenario(&(lines([2, 3, 4]) + "wall_thickness = \"0.5 mm\"\n"));
    let again = Scenario::from_str(&found.to_toml(), "again.toml").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(found, again);
    // The file itself keeps what it states.
    let document = document(&lines([2, 3, 4]));
    let again = Document::parse(&document.to_toml(), "again.toml").expect("TOML");
    assert_eq!(again.scenario().expect("a scenario"), document.scenario().expect("a scenario"));
    assert!(again.contains("actuator.braid_angle") && !again.contains("actuator.turns"));
}

#[test]
fn a_sweep_over_the_braid_angle_moves_all_that_follows() {
    let vary = "\n[sweep.vary]\n\"actuator.braid_angle\" = { from = \"20 deg\", to = \"30 deg\", count = 3 }\n\
                \"actuator.length\" = [\"200 mm\", \"300 mm\"]\n";
    let text = format!("[actuator]\n{}{REST}{vary}", lines([2, 3, 4]));
    let sweep = Document::parse(&text, "sweep.toml").expect("TOML").sweep().unwrap_or_else(|error| panic!("{error}"));
    let sweep = sweep.expect("a sweep");
    assert_eq!(sweep.rows(), 6);
    for row in 0..6 {
        let (theta, length) = ((20.0 + 5.0 * (row / 2) as f64).to_radians(), if row % 2 == 0 { 0.2 } else { 0.3 });
        let of = sweep.scenario(row).expect("a row").actuator;
        let b = length / theta.cos();
        assert!(near(of.thread_length, b) && near(of.turns, b * theta.sin() / (PI * DIAMETER)), "{row}: {of:?}");
        assert!(near(of.max_length, length) && near(of.min_length, b / 3_f64.sqrt()), "{row}: {of:?}");
    }
    // A row that contradicts itself is that row's error.
    let text = format!(
        "[actuator]\n{}{REST}\n[sweep.vary]\n\"actuator.length\" = [\"200 mm\", \"300 mm\"]\n",
        lines([0, 2, 3])
    );
    let sweep = Document::parse(&text, "sweep.toml").expect("TOML").sweep().expect("a sweep").expect("a sweep");
    assert!(sweep.scenario(0).is_ok());
    let error = sweep.scenario(1).expect_err("longer than its thread").to_string();
    assert!(error.contains("actuator.length") && error.contains("less than"), "{error}");
}

/// What is said of one actuator of a plant or joint is laid over what is said of all: key by key, or as a whole braid.
#[test]
fn actuators_of_a_plant_have_their_own_braids() {
    let plant = |all: &str, own: &str| {
        let text = format!(
            "{all}\n[actuators.left]\n{own}\n[actuators.right]\n[load]\nkind = \"isometric\"\n[initial]\nlength = \"180 mm\"\n\
             gauge_pressure = \"1 bar\"\n[run]\nduration = \"1 s\"\n"
        );
        let document = Document::parse(&text, "plant.toml").expect("TOML");
        let plant = document.plant_experiment().unwrap_or_else(|error| panic!("{error}")).expect("a plant");
        let braid = |at: usize| plant.plant.actuators()[at].actuator.law().law.braid;
        [0, 1].map(|at| (braid(at).thread_length(), braid(at).turns()))
    };
    let (b, n) = closed_form();
    let all = format!("[actuator]\n{}", lines([2, 3, 4]));
    let [left, right] = plant(&all, "diameter = \"20 mm\"");
    assert!(near(left.0, b) && near(left.1, 0.5 * n) && near(right.0, b) && near(right.1, n), "{left:?} {right:?}");
    let by_thread = "[actuator]\nthread_length = \"0.23 m\"\nturns = 2.5\nmax_length = \"0.21 m\"";
    let [left, right] = plant(by_thread, &lines([2, 3, 4]));
    assert!(near(left.0, b) && near(left.1, n) && right == (0.23, 2.5), "{left:?} {right:?}");
    let [left, _] = plant(&all, "thread_length = \"0.23 m\"\nturns = 2.5\nmax_length = \"0.21 m\"");
    assert_eq!(left, (0.23, 2.5));
}

/// Measured tensions of a muscle: gauge pressure, length and tension, where it pulled.
fn measured(name: &str) -> Vec<[f64; 3]> {
    let path = format!("{}/../../validation/martens-boblan-2017/{name}.csv", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).expect("the data");
    let rows = text.lines().skip(1).map(|line| {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.trim().parse().expect("a number")).collect();
        [cells[0], cells[1], cells[2]]
    });
    rows.filter(|row| row[2] > 0.0).collect()
}

#[test]
fn presets_pull_as_the_muscles_were_measured() {
    // The errors in percent that their sources state, rounded there to 0.1.
    for (preset, data, rms) in [(&DMSP_10_250, "dmsp-10-250", 1.9), (&DMSP_20_300, "dmsp-20-300", 0.2)] {
        let scenario = scenario(&format!("preset = \"{}\"\n", preset.name));
        let actuator = scenario.rig().unwrap_or_else(|error| panic!("{error}")).actuator().clone();
        let rows = measured(data);
        let largest = rows.iter().fold(0.0, |most: f64, row| most.max(row[2]));
        let squares = rows.iter().map(|[gauge, length, tension]| {
            let force = actuator.static_force(*length, actuator.air().atmosphere().0 + gauge);
            (force - tension).powi(2)
        });
        let error = 100.0 * (squares.sum::<f64>() / rows.len() as f64).sqrt() / largest;
        assert!((error - rms).abs() < 0.05, "{}: {error:.3} %", preset.name);
        let stated = format!("rms error {rms} % of {largest:.1} N");
        assert!(preset.values.iter().any(|value| value.source.contains(&stated)), "{stated}");
        // The shortest length is the shortest measured.
        let shortest = rows.iter().fold(f64::INFINITY, |least, row| least.min(row[1]));
        assert_eq!(scenario.actuator.min_length, shortest);
    }
}

#[test]
fn presets_of_muscles_go_with_the_keys_of_a_file() {
    assert_eq!(ACTUATORS[0].name, "colbrunn-2001");
    let thin = "preset = \"festo-dmsp-10-250\"\n";
    let of = scenario(thin).actuator;
    assert!(matches!(of.force, Force::TonduLopez { coefficients: Some(_), .. }) && of.bladder.is_some());
    assert!((of.thread_length - 0.284_743_6).abs() < 1e-7 && (of.turns - 4.338_70).abs() < 1e-5, "{of:?}");
    // Another length of the same tube, and with it the range of lengths.
    let longer = scenario(&format!("{thin}length = \"400 mm\"\n")).actuator;
    assert!(near(longer.thread_length, 1.6 * of.thread_length) && longer.max_length == 0.4, "{longer:?}");
    assert!(near(longer.min_length, longer.thread_length / 3_f64.sqrt()));
    // Another law goes without the bladder; a number of the law replaces the preset's.
    let ideal = scenario(&format!("{thin}force.law = \"ideal-braid\"\n")).actuator;
    assert!(ideal.force == Force::IdealBraid && ideal.bladder.is_none());
    let softer = scenario(&format!("{thin}bladder.force = \"100 N\"\n")).actuator;
    assert!(softer.bladder.expect("a bladder").force == 100.0 && softer.force == of.force);
    let other = scenario(&format!("{thin}force.end_factor = 1.1\n")).actuator;
    assert!(matches!(other.force, Force::TonduLopez { end_factor: 1.1, coefficients: Some(_), .. }), "{other:?}");
    let thick = scenario("preset = \"festo-dmsp-20-300\"\n").actuator;
    assert!(
        matches!(thick.force, Force::MartensBoblan { modulus: [c0, ..], .. } if near(c0, 1.279_299_36e9)),
        "{thick:?}"
    );
    // What is written is the whole law.
    let found = scenario(thin);
    assert_eq!(Scenario::from_str(&found.to_toml(), "again.toml").unwrap_or_else(|error| panic!("{error}")), found);
    // What no source states is listed.
    let assumed: Vec<&str> = document(thin).assumed().iter().map(|of| of.parameter.key).collect();
    assert!(assumed.contains(&p::DIAMETER.key) && assumed.contains(&p::INITIAL_RADIUS.key), "{assumed:?}");
    assert!(!assumed.contains(&p::BLADDER_FORCE.key) && !assumed.contains(&p::MIN_LENGTH.key), "{assumed:?}");
    // So is a default of a law that the file names itself.
    let own =
        document(&format!("{thin}force.law = \"extensible-braid\"\nforce.thread_stiffness = \"50 kN/m\"\n")).assumed();
    assert!(own.iter().all(|of| !of.parameter.key.starts_with("actuator.force")), "{own:?}");
    let own = document("force.law = \"tondu-lopez\"\n").assumed();
    assert!(own.iter().any(|of| of.parameter.key == p::END_FACTOR_RISE.key), "{own:?}");
}

/// A fit changes the model's numbers of one actuator, and of a plant what its file states.
#[test]
fn fits_name_what_can_change() {
    let file = document(&lines([2, 3, 4]));
    let mut scenario = file.scenario().expect("a scenario");
    let thread = file.find("actuator.thread_length", [], &mut scenario).expect("a number");
    assert!(thread.set(&mut scenario, 0.25).is_ok_and(|set| set));
    let again = Scenario::from_str(&scenario.to_toml(), "fitted.toml").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(again.actuator.thread_length, 0.25);
    let refused = file.find("actuator.diameter", [], &mut scenario).expect_err("described at rest").to_string();
    assert!(refused.contains("thread length and turns follow") && refused.contains("`actuator.turns`"), "{refused}");

    let plant = |own: &str| {
        let text = format!(
            "[actuators.left]\n{own}[load]\nkind = \"isometric\"\n[initial]\nlength = \"180 mm\"\ngauge_pressure = \"1 bar\"\n\
             [run]\nduration = \"1 s\"\n"
        );
        Document::parse(&text, "plant.toml").expect("TOML")
    };
    let file = plant(&lines([2, 3, 4]));
    let diameter = file.find_in_plant("actuators.left.diameter").expect("a parameter");
    let wider = file.with_plant_values(&[diameter], &[0.02]).expect("in range").muscles();
    let (_, n) = closed_form();
    assert!(wider[0].0 == "left" && near(wider[0].1.turns, 0.5 * n), "{wider:?}");
    let follows = file.find_in_plant("actuators.left.turns").expect_err("it follows").to_string();
    assert!(follows.contains("follows from what else the file gives of the braid"), "{follows}");
    let many = plant(&lines([1, 2, 3, 4])).find_in_plant("actuators.left.diameter").expect_err("too many").to_string();
    assert!(many.contains("follows from"), "{many}");
}
