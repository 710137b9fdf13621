//! Sweeps: the order of grids, the fast way to a row against the text, independence of order, and every mistake.

use mckibben::control::Quantity;
use mckibben_scenario::diagnostic::{Class, Diagnostic};
use mckibben_scenario::keys::{KEYS, Key, Kind, is_of_antagonist};
use mckibben_scenario::{AxisKind, AxisValue, Document, Force, Record, Sweep, quantity};
use std::path::Path;

const BASE: &str = r#"[supply]
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
[run]
duration = "2 s"
"#;

/// The line of [`BASE`] on which the sweep begins.
const FIRST: usize = 14;

fn document(sweep: &str) -> Document {
    Document::parse(&format!("{BASE}{sweep}"), "muscle.toml").unwrap_or_else(|error| panic!("{error}"))
}

fn sweep(text: &str) -> Sweep {
    document(text).sweep().unwrap_or_else(|error| panic!("{error}")).expect("a sweep")
}

fn number(sweep: &Sweep, axis: usize, row: u64) -> f64 {
    match sweep.value(axis, row) {
        AxisValue::Number(number) => number,
        AxisValue::Word(word) => panic!("{word}"),
    }
}

#[test]
fn a_file_without_the_section_has_no_sweep() {
    assert!(document("").sweep().expect("good").is_none());
}

#[test]
fn a_grid_has_every_combination_the_last_key_fastest() {
    let sweep = sweep(
        "[sweep.vary]\n\"load.mass\" = [\"1 kg\", \"2 kg\"]\n\"air.process\" = [\"isentropic\", \"isothermal\"]\n\
         \"valve.efficiency\" = { from = 0.25, to = 1, count = 3, spacing = \"logarithmic\" }\n",
    );
    assert_eq!((sweep.rows(), sweep.seed()), (12, 0));
    let rows = (0..12).map(|row| (sweep.value(0, row), sweep.value(1, row), sweep.value(2, row)));
    let mut expected = Vec::new();
    for mass in [1.0, 2.0] {
        for process in ["isentropic", "isothermal"] {
            for efficiency in [0.25, 0.5, 1.0] {
                let number = AxisValue::Number;
                expected.push((number(mass), AxisValue::Word(process), number(efficiency)));
            }
        }
    }
    assert_eq!(rows.collect::<Vec<_>>(), expected);
    let columns: Vec<String> = sweep.axes().iter().map(mckibben_scenario::Axis::column).collect();
    assert_eq!(columns, ["load_mass_kg", "air_process", "valve_efficiency"]);
    let kind = AxisKind::Quantity { unit: "kg", column: "load_mass_kg".to_owned() };
    assert_eq!((&sweep.axes()[0].kind, &sweep.axes()[1].kind), (&kind, &AxisKind::Word));
}

/// Dotted keys, quoted keys and sections mean the same, in the order in which they are written.
#[test]
fn paths_are_written_in_three_ways() {
    let one = "[sweep.vary]\nload.mass = [\"1 kg\"]\n\"valve.efficiency\" = [0.8, 0.9]\nload.gravity = [\"1 m/s^2\"]\n";
    let paths: Vec<String> = sweep(one).axes().iter().map(|axis| axis.path.clone()).collect();
    assert_eq!(paths, ["load.mass", "valve.efficiency", "load.gravity"]);
    let two = "[sweep.vary.load]\nmass = [\"1 kg\"]\n[sweep.vary.valve]\nefficiency = [0.8, 0.9]\n";
    assert_eq!(sweep(two).rows(), 2);
}

const EVERY_DESIGN: [&str; 3] = ["random", "latin-hypercube", "sobol"];

fn drawn(design: &str, rows: u64, seed: u64) -> Sweep {
    sweep(&format!(
        "[sweep]\ndesign = \"{design}\"\nrows = {rows}\nseed = {seed}\n[sweep.vary]\n\
         \"load.mass\" = {{ from = \"1 kg\", to = \"3 kg\" }}\n\"air.process\" = [\"isentropic\", \"isothermal\"]\n\
         \"valve.opening_delay\" = {{ normal = {{ mean = \"4 ms\", deviation = \"0.5 ms\" }} }}\n\
         \"actuator.friction.viscous\" = {{ log-normal = {{ median = \"3 N*s/m\", factor = 1.5 }} }}\n\
         \"command.frequency\" = {{ from = \"1 Hz\", to = \"100 Hz\", spacing = \"logarithmic\" }}\n"
    ))
}

#[test]
fn rows_do_not_depend_on_the_order_of_requests() {
    for design in EVERY_DESIGN {
        let (forth, back) = (drawn(design, 257, 3), drawn(design, 257, 3));
        let all = |sweep: &Sweep, row: u64| -> String {
            (0..5).map(|axis| format!("{:?} ", sweep.value(axis, row))).collect()
        };
        let first: Vec<String> = (0..257).map(|row| all(&forth, row)).collect();
        let mut second: Vec<String> = (0..257).rev().map(|row| all(&back, row)).collect();
        second.reverse();
        assert_eq!(first, second, "{design}");
        assert_eq!(forth.fingerprint_text(), back.fingerprint_text());
        let other = drawn(design, 257, 4);
        assert!(
            (0..257).all(|row| number(&other, 0, row) != number(&forth, 0, row)),
            "{design}: the seed does nothing"
        );
        assert_ne!(other.fingerprint_text(), forth.fingerprint_text());
    }
}

/// The share of rows below each of several quantiles, against the share by definition; words have equal odds. A Latin
/// hypercube and a Sobol' sequence of 4096 points leave no more than a stratum; a random design five standard errors.
#[test]
fn draws_follow_their_distributions() {
    let rows = 4096;
    for design in EVERY_DESIGN {
        let sweep = drawn(design, rows, 1);
        let allowed = if design == "random" { 5.0 * (0.25 / rows as f64).sqrt() } else { 1.5 / rows as f64 };
        let share = |axis: usize, bound: f64| {
            (0..rows).filter(|row| number(&sweep, axis, *row) < bound).count() as f64 / rows as f64
        };
        for (axis, bound, expected) in [
            (0, 1.5, 0.25),
            (0, 3.0, 1.0),
            (2, 4e-3, 0.5),
            (2, 4.5e-3, 0.841_344_746_068_542_9),
            (3, 3.0, 0.5),
            (3, 2.0, 0.158_655_253_931_457_05),
            (4, 10.0, 0.5),
        ] {
            let found = share(axis, bound);
            assert!(
                (found - expected).abs() <= allowed,
                "{design}, axis {axis}: {found} below {bound}, not {expected}"
            );
        }
        let words = (0..rows).filter(|row| sweep.value(1, *row) == AxisValue::Word("isothermal")).count();
        assert!((words as f64 / rows as f64 - 0.5).abs() <= allowed, "{design}: {words}");
    }
}

/// Keys that a joint alone has.
const JOINT_ALONE: &[&str] = &[
    "load.pulley_radius",
    "load.rest_length",
    "load.distance",
    "load.inertia",
    "load.hanging_angle",
    "load.torque",
    "load.damping",
    "load.min_angle",
    "load.max_angle",
    "load.stop_stiffness",
    "load.stop_damping",
    "initial.angle",
    "initial.angular_velocity",
];

/// A file with a joint for its load.
fn with_joint(text: &str) -> String {
    let mass = "kind = \"hanging-mass\"\nmass = \"5 lb\"";
    let joint = "kind = \"antagonistic-joint\"\nmass = \"1 kg\"\ndistance = \"10 cm\"\npulley_radius = \"15 mm\"\n\
                 rest_length = \"8 cm\"";
    assert!(text.contains(mass), "{text}");
    text.replace(mass, joint)
}

/// A file in which a quantity applies.
fn file_for(path: &str) -> String {
    let process = match path {
        "air.polytropic_index" => "[air]\nprocess = \"polytropic\"\npolytropic_index = 1.2\n",
        "air.heat_transfer" | "air.wall_temperature" => "[air]\nprocess = \"energy-balance\"\n",
        "actuator.thread_length" | "actuator.turns" | "actuator.max_length" => {
            "[actuator]\npreset = \"colbrunn-2001\"\n"
        }
        "actuator.length" | "actuator.diameter" | "actuator.braid_angle" => {
            "[actuator]\nlength = \"98 mm\"\ndiameter = \"6.4 mm\"\nbraid_angle = \"27 deg\"\n"
        }
        "actuator.force.end_factor" | "actuator.force.end_factor_rise" | "actuator.force.end_factor_pressure" => {
            "[actuator.force]\nlaw = \"tondu-lopez\"\n"
        }
        "actuator.force.radius" | "actuator.force.a" | "actuator.force.b" => {
            "[actuator.force]\nlaw = \"tondu-lopez\"\nradius = \"3 mm\"\na = 11.0\nb = 4.0\n"
        }
        "actuator.force.membrane_thickness" => {
            "[actuator.force]\nlaw = \"martens-boblan\"\nmembrane_thickness = \"0.3 mm\"\nmodulus = [4, -60, 300, 100]\nmodulus_unit = \"MPa\"\nlength_unit = \"m\"\n"
        }
        "actuator.force.thread_stiffness" => {
            "[actuator.force]\nlaw = \"extensible-braid\"\nthread_stiffness = \"30 kN/m\"\n"
        }
        _ if path.starts_with("actuator.force.max_") => {
            "[actuator.force]\nlaw = \"bolen\"\nmax_force = \"90 N\"\nmax_pressure = \"620 kPa\"\nmax_contraction = 0.3\nshape = [0.26, 6.4, 1.3]\n"
        }
        _ if path.starts_with("actuator.taper") => "[actuator.taper]\nend_radius = \"2.8 mm\"\nlength_ratio = 1\n",
        "actuator.friction.hysteresis.width"
        | "actuator.friction.hysteresis.beta"
        | "actuator.friction.hysteresis.gamma" => {
            "[actuator.friction.hysteresis]\nlaw = \"bouc-wen\"\nwidth = \"0.1 mm\"\nbeta = \"4000 m^-1\"\n"
        }
        _ if path.starts_with("actuator.friction.hysteresis") => {
            "[actuator.friction.hysteresis]\nlaw = \"lugre\"\nwidth = \"0.1 mm\"\nbristle_reach = \"0.05 mm\"\n"
        }
        _ if path.starts_with("actuator.bladder") => {
            "[actuator.bladder]\nform = \"saturating\"\nforce = \"10 N\"\nscale = 0.1\n"
        }
        _ => "",
    };
    let mut base = BASE.to_owned();
    if path.starts_with("valve.sonic") || path.starts_with("valve.critical") {
        let iso = "kind = \"three-way\"\nsonic_conductance = \"1 L/(s*bar)\"\ncritical_ratio = 0.5";
        base = base.replace("preset = \"matrix-eight-channel\"", iso);
    }
    let stated = match path {
        "valve.kv" => "kv = \"1 m^3/h\"",
        "valve.cv" => "cv = 0.3",
        "valve.pressure_drop_ratio" => "cv = 0.3\npressure_drop_ratio = 0.6",
        "valve.exhaust.flow_area" => "cv = 0.3\nexhaust.flow_area = \"1 mm^2\"",
        "valve.exhaust.sonic_conductance" | "valve.exhaust.critical_ratio" => {
            "cv = 0.3\nexhaust.sonic_conductance = \"1 L/(s*bar)\"\nexhaust.critical_ratio = 0.5"
        }
        "valve.exhaust.kv" => "cv = 0.3\nexhaust.kv = \"1 m^3/h\"",
        "valve.exhaust.cv" | "valve.exhaust.pressure_drop_ratio" => "cv = 0.3\nexhaust.cv = 0.4",
        _ => "",
    };
    if !stated.is_empty() {
        base = base.replace("preset = \"matrix-eight-channel\"", &format!("kind = \"three-way\"\n{stated}"));
    }
    if ["valve.time_constant", "valve.dead_time", "valve.rate_limit"].contains(&path) {
        let regulator = "kind = \"pressure-regulator\"\ncv = 0.3\ntime_constant = \"30 ms\"\nrate_limit = \"20 bar/s\"";
        let points = "kind = \"set-points\"\ntime = [\"0 s\"]\ngauge_pressure = [\"2 bar\"]";
        base = base.replace("preset = \"matrix-eight-channel\"", regulator);
        base = base.replace("kind = \"pwm\"\nfrequency = \"25 Hz\"\nduty = 0.5", points);
    }
    if path.starts_with("valve.spool.") {
        let spool =
            "kind = \"proportional-spool\"\ncv = 0.3\nspool.natural_frequency = \"80 Hz\"\nspool.damping_ratio = 0.6";
        let positions = "kind = \"positions\"\ntime = [\"0 s\"]\nposition = [0.5]";
        base = base.replace("preset = \"matrix-eight-channel\"", spool);
        base = base.replace("kind = \"pwm\"\nfrequency = \"25 Hz\"\nduty = 0.5", positions);
    }
    let mass = "kind = \"hanging-mass\"\nmass = \"5 lb\"";
    if path == "load.force" {
        base = base.replace(mass, "kind = \"constant-force\"\nmass = \"1 kg\"\nforce = \"1 N\"");
    }
    if ["load.length", "load.amplitude", "load.frequency", "load.phase"].contains(&path) {
        let wave = "kind = \"prescribed-motion\"\nlength = \"9 cm\"\namplitude = \"1 mm\"\nfrequency = \"1 Hz\"";
        base = base.replace(mass, wave);
    }
    if path.starts_with("pressure.") {
        // It stands in place of a valve and what belongs to that.
        base = "[pressure]\ntime = [\"0 s\", \"0.5 s\"]\ngauge_pressure = [\"1 bar\", \"3 bar\"]\n\
                [load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n[run]\nduration = \"1 s\"\n"
            .to_owned();
    }
    if path.starts_with("tendon.") {
        base.push_str("[tendon]\nstiffness = \"10 kN/m\"\n");
    }
    if path == "controller.angle" || path == "controller.stiffness" || JOINT_ALONE.contains(&path) {
        base = with_joint(&base);
    }
    if let Some(key) = path.strip_prefix("controller.") {
        base = base.replace("kind = \"pwm\"\nfrequency = \"25 Hz\"\nduty = 0.5", "kind = \"controllers\"");
        let of = match key {
            "angle" => "kind = \"pid\"\nproportional_band = \"10 deg\"",
            "stiffness" => {
                "kind = \"air-mass\"\nangle = \"5 deg\"\nhighest_gauge_pressure = \"5 bar\"\ndead_band = \"1 mg\""
            }
            "length" => "kind = \"pid\"\nproportional_band = \"1 mm\"",
            "air_mass" => "kind = \"pid\"\nproportional_band = \"1 g\"",
            "force" => "kind = \"pid\"\nproportional_band = \"1 N\"",
            "dead_band" | "hysteresis" => "kind = \"bang-bang\"\ngauge_pressure = \"1 bar\"\ndead_band = \"50 mbar\"",
            "highest_gauge_pressure" | "temperature" => {
                "kind = \"air-mass\"\nforce = \"1 N\"\nhighest_gauge_pressure = \"1 bar\"\ndead_band = \"1 mg\""
            }
            _ => {
                "kind = \"pid\"\ngauge_pressure = \"1 bar\"\namplitude = \"1 mbar\"\nfrequency = \"1 Hz\"\n\
                 proportional_band = \"1 bar\""
            }
        };
        base.push_str(&format!("[controller]\nrate = \"10 Hz\"\n{of}\n"));
    }
    if path == "hose.cells" {
        base.push_str("[hose]\nkind = \"distributed\"\nlength = \"2 m\"\ndiameter = \"3 mm\"\n");
    } else if path.starts_with("hose.") {
        base.push_str("[hose]\nlength = \"2 m\"\ndiameter = \"3 mm\"\n");
    }
    if path.starts_with("supply.") && !["supply.gauge_pressure", "supply.temperature"].contains(&path) {
        let line = "reservoir_volume = \"1 L\"\nreservoir_gauge_pressure = \"7 bar\"\nlag = \"10 ms\"\n\
                    compressor_displacement = \"10 L/min\"\ncut_in_gauge_pressure = \"6 bar\"\n\
                    cut_out_gauge_pressure = \"8 bar\"\n";
        base = base.replace("[supply]\n", &format!("[supply]\n{line}"));
    }
    format!("{process}{base}")
}

/// Three values of a key near its example, as a file has them; the last stands in a file alone.
fn literals(key: &Key) -> Option<[String; 3]> {
    let row = match key.kind {
        Kind::Quantity(row) | Kind::QuantityOr(row, _) | Kind::TimeSeries(row) | Kind::Whole(row) => row,
        // Their examples are pressures.
        Kind::Regulated => Quantity::Pressure.rows().set_point,
        _ => return None,
    };
    let example = match key.path {
        "initial.length" => "\"3.5 in\"",
        "initial.angle" => "\"5 deg\"",
        _ => key.example,
    };
    let at_example = quantity::parse(example.trim_matches('"')).expect("a quantity").value;
    // Other values near the example that are in range.
    let factors = if row.range.low == 1.0 { [1.05, 1.1, 1.0] } else { [0.9, 0.95, 1.0] };
    let values = match key.kind {
        Kind::Whole(_) => [1.0, 2.0, 0.0].map(|more| at_example + more),
        _ => factors.map(|factor| at_example * factor),
    };
    Some(values.map(|value| match row.unit {
        "" => format!("{value:?}"),
        unit => format!("\"{}\"", quantity::format(value, unit)),
    }))
}

/// Tries a list of values of the key at a path: each row's scenario is what the value as text gives, bit for bit. Whether the
/// key can stand in the file.
fn try_rows(text: &str, path: &str, literals: &[String; 3]) -> bool {
    // A list, so that text and list hold the same bits.
    let document =
        Document::parse(&format!("{text}[sweep.vary]\n\"{path}\" = [{}]\n", literals.join(", ")), "muscle.toml");
    let document = document.unwrap_or_else(|error| panic!("{error}"));
    let Ok(sweep) = document.sweep() else { return false };
    let sweep = sweep.expect("a sweep");
    for (index, literal) in literals.iter().enumerate() {
        let mut document = document.clone();
        document.remove("sweep");
        document.set_text(path, literal).expect("a path");
        let expected = document.scenario().unwrap_or_else(|error| panic!("{path}\n{error}"));
        let found = sweep.scenario(index as u64).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(found, expected, "{path}");
    }
    let scenarios = [0, 2].map(|row| sweep.scenario(row).expect("a row"));
    assert!(literals[0] == literals[2] || scenarios[0] != scenarios[1], "{path} changes nothing");
    true
}

/// For every key that is a quantity: the row's scenario is what reading the row's value from text gives, bit for bit.
#[test]
fn a_row_is_what_its_text_says() {
    let mut tried = 0;
    for key in KEYS.iter().filter(|key| key.varies()) {
        let Some(literals) = literals(key) else { continue };
        assert!(try_rows(&file_for(key.path), key.path, &literals), "{}", key.path);
        tried += 1;
    }
    assert!(tried > 130, "only {tried} quantities");
}

/// What varies of the first actuator of a joint varies of the second unless that has its own, and the second may vary alone.
#[test]
fn a_row_of_a_joint_is_what_its_text_says() {
    let (mut both, mut second) = (0, 0);
    for key in KEYS.iter().filter(|key| key.varies() && key.path != "load.mass") {
        let Some(literals) = literals(key) else { continue };
        let file = file_for(key.path);
        if !(file.contains("hanging-mass") || file.contains("antagonistic-joint"))
            || key.path.starts_with("initial.length")
        {
            continue;
        }
        let file = if file.contains("hanging-mass") { with_joint(&file) } else { file };
        let own = |literal: &str| format!("{file}[antagonist]\n{} = {literal}\n", key.path);
        both += usize::from(try_rows(&file, key.path, &literals));
        if is_of_antagonist(key.path) {
            second += usize::from(try_rows(&file, &format!("antagonist.{}", key.path), &literals));
            try_rows(&own(&literals[1]), key.path, &literals);
        }
    }
    assert!(both > 100 && second > 60, "{both} {second}");
    // The second takes over what it does not say itself, and only that.
    let vary = "[sweep.vary]\n\"initial.gauge_pressure\" = [\"1 bar\", \"2 bar\"]\nactuator.thread_length = [\"11 cm\", \"12 cm\"]\n";
    let of = |between: &str| {
        let text = format!("[actuator]\npreset = \"colbrunn-2001\"\n{}{between}{vary}", with_joint(BASE));
        let sweep = Document::parse(&text, "joint.toml").expect("TOML").sweep();
        let last = sweep.unwrap_or_else(|error| panic!("{error}")).expect("a sweep").scenario(3).expect("a row");
        let second = last.of_antagonist().expect("a joint");
        [last, second].map(|of| (of.initial.gauge_pressure, of.actuator.thread_length, of.actuator.min_length))
    };
    let long = (Some(2e5), 0.12, 0.12 / 3_f64.sqrt());
    assert_eq!(of(""), [long; 2]);
    let own = "[antagonist]\ninitial.gauge_pressure = \"3 bar\"\nactuator.min_length = \"6 cm\"\n";
    assert_eq!(of(own), [long, (Some(3e5), 0.12, 0.06)]);
}

#[test]
fn rows_are_joints_all_or_none() {
    let joint = with_joint(BASE);
    let of = |text: &str| Document::parse(text, "joint.toml").expect("TOML").sweep();
    let vary = "[sweep.vary]\nload.mass = [\"1 kg\", \"2 kg\"]\n";
    let sweep = of(&format!("{joint}{vary}")).unwrap_or_else(|error| panic!("{error}")).expect("a sweep");
    let Record::Reductions(all) = sweep.record() else { panic!("reductions") };
    assert!(sweep.has_joint() && all.iter().any(|of| of.name() == "stiffness.final"), "{all:?}");
    let mixed = format!("{joint}[sweep.vary]\nload.kind = [\"antagonistic-joint\", \"isometric\"]\n");
    assert!(of(&mixed).is_err());
    // Of one actuator a joint's reductions are refused, and the second actuator has no keys.
    let found = document(&format!("[sweep]\nreductions = [\"angle.final\"]\n{vary}")).sweep().expect_err("no joint");
    assert!(found.to_string().contains("of a joint, and there is none"), "{found}");
    let found =
        document("[sweep.vary]\n\"antagonist.valve.flow_area\" = [\"1 mm^2\"]\n").sweep().expect_err("no joint");
    assert!(found.to_string().contains("[antagonist] is not used"), "{found}");
    in_grid("\"antagonist.load.mass\" = [\"1 kg\"]", Class::UnknownKey, 1, &["no path to a key"]);
}

/// An entry of a list varies as a key does: each row is what its text says, of one actuator and of both of a joint.
#[test]
fn entries_of_lists_vary() {
    let pulses = "kind = \"pwm\"\nfrequency = \"25 Hz\"\nduty = 0.5";
    let table = "kind = \"table\"\ntime = [\"0 s\", \"50 ms\", \"90 ms\"]\nstate = [\"fill\", \"exhaust\", \"fill\"]";
    let base = BASE.replace(pulses, table);
    assert_ne!(base, BASE);
    let times = ["\"40 ms\"", "\"50 ms\"", "\"70 ms\""].map(str::to_owned);
    let states = ["\"fill\"", "\"exhaust\"", "\"exhaust\""].map(str::to_owned);
    let joint = with_joint(&base);
    let own = format!("{joint}[antagonist]\ncommand.time = [\"0 s\", \"10 ms\", \"80 ms\"]\n");
    for text in [&base, &joint, &own] {
        assert!(try_rows(text, "command.time[1]", &times), "{text}");
        assert!(try_rows(text, "command.state[1]", &states), "{text}");
    }
    assert!(try_rows(&own, "antagonist.command.time[1]", &times));
    let read = |vary: &str| {
        let text = format!("{base}[sweep.vary]\n{vary}\n");
        Document::parse(&text, "muscle.toml").expect("TOML").sweep()
    };
    // Ranges are for entries too; a row whose times do not rise has no run.
    let range = read("command.\"time[1]\" = { from = \"60 ms\", to = \"100 ms\", count = 3 }");
    let range = range.unwrap_or_else(|error| panic!("{error}")).expect("a sweep");
    for (row, time) in [0.06, 0.08, 0.1].into_iter().enumerate() {
        assert!((number(&range, 0, row as u64) - time).abs() < 1e-15, "row {row}");
    }
    assert_eq!(range.axes()[0].column(), "command_time_1_s");
    let runs = [0, 1, 2].map(|row| range.scenario(row).expect("a row").experiment().is_ok());
    assert_eq!(runs, [true, true, false]);
    for (vary, words) in [
        ("\"command.time[3]\" = [\"1 s\"]", "`command.time` has 3 entries, and none `[3]`"),
        ("\"command.time[x]\" = [\"1 s\"]", "none `[x]`"),
        ("\"pressure.time[0]\" = [\"1 s\"]", "the file has no list `pressure.time`"),
        ("\"load.mass[0]\" = [\"1 kg\"]", "the file has no list `load.mass`"),
        ("\"command.time[1]\" = [\"1 kg\"]", "`command.time[1]` is a time"),
        ("\"command.state[1]\" = [\"fil\"]", "\"fil\" is not a valid value of `command.state[1]`"),
        ("\"command.time[1]\" = [\"60 ms\"]\n\"command.time[01]\" = [\"60 ms\"]", "`command.time[01]` varies twice"),
    ] {
        let found = read(vary).expect_err(vary).to_string();
        assert!(found.contains(words), "{words}\n{found}");
    }
    // What the scenario has in other units than the file, and the lists of a controller, are read from the file again for each
    // value, and have no ranges.
    let law = "[actuator]\neffectiveness.polynomial = [0.9, 1e-3]\neffectiveness.pressure_unit = \"psi\"\n";
    let coefficients = ["1e-3", "2e-3", "1.5e-3"].map(str::to_owned);
    assert!(try_rows(&format!("{BASE}{law}"), "actuator.effectiveness.polynomial[1]", &coefficients));
    let path = "actuator.effectiveness.polynomial[1]";
    let range = document(&format!("{law}[sweep.vary]\n\"{path}\" = {{ from = 1e-3, to = 2e-3, count = 3 }}\n")).sweep();
    let range = range.expect_err("a range").to_string();
    assert!(range.contains("varies by a list of values") && range.contains("one by one"), "{range}");
    let controller = "[controller]\nkind = \"pid\"\nrate = \"100 Hz\"\nproportional_band = \"10 mm\"\n\
                      length = [\"90 mm\", \"80 mm\"]\ntime = [\"0 s\", \"20 ms\"]\n";
    let controlled = format!("{}{controller}", BASE.replace(pulses, "kind = \"controllers\""));
    assert!(try_rows(&controlled, "controller.length[1]", &["\"81 mm\"", "\"82 mm\"", "\"84 mm\""].map(str::to_owned)));
    assert!(try_rows(&controlled, "controller.time[1]", &times));
}

/// Entries of lists of a plant, by the names of its parts; a mistake has the path that the file has.
#[test]
fn entries_of_lists_of_a_plant_vary() {
    let arm = std::fs::read_to_string("../../examples/plant/arm.toml").expect("an example");
    let read =
        |vary: &str| Document::parse(&format!("{arm}\n[sweep.vary]\n{vary}\n"), "arm.toml").expect("TOML").sweep();
    let (time, state) = ("actuators.deltoid.command.time[1]", "actuators.deltoid.command.state[1]");
    let (times, states) = (["\"0.25 s\"", "\"0.35 s\""], ["\"hold\"", "\"exhaust\""]);
    let vary = format!("\"{time}\" = [{}]\n\"{state}\" = [{}]", times.join(", "), states.join(", "));
    let sweep = read(&vary).unwrap_or_else(|error| panic!("{error}")).expect("a sweep");
    let mut seen = Vec::new();
    for row in 0..4 {
        let mut document = Document::parse(&arm, "arm.toml").expect("TOML");
        document.set_text(time, times[row / 2]).expect("an entry");
        document.set_text(state, states[row % 2]).expect("an entry");
        let expected = document.plant_experiment().unwrap_or_else(|error| panic!("{error}")).expect("a plant");
        let found = sweep.plant(row as u64).expect("a plant").unwrap_or_else(|why| panic!("row {row}: {why}"));
        assert_eq!(found, expected, "row {row}");
        assert!(!seen.contains(&found), "row {row}");
        seen.push(found);
    }
    for (vary, words) in [
        ("\"actuators.biceps.command.time[9]\" = [\"1 s\"]", "none `[9]`"),
        ("\"actuators.flexor.command.time[0]\" = [\"1 s\"]", "the file has no list `actuators.flexor.command.time`"),
        (
            "\"mechanism.joints.elbow.damping\" = [\"-1 N*m*s/rad\"]",
            "`mechanism.joints.elbow.damping` = -1 N*m*s/rad is out of range",
        ),
        ("\"mechanism.joints.elbow.damping\" = [\"1 kg\"]", "`mechanism.joints.elbow.damping` is an angular damping"),
        ("\"mechanism.joints.elbow.inertia\" = \"1 kg*m^2\"", "`\"mechanism.joints.elbow.inertia\" = ["),
        ("\"actuators.biceps.coupling.arms.elbow\" = [\"1 kg\"]", "write it as in `elbow = "),
        ("\"supplies.manifold.inlet.flow_area\" = [\"1 kg\"]", "`supplies.manifold.inlet.flow_area` is an area"),
    ] {
        let found = read(vary).expect_err(vary).to_string();
        assert!(found.contains(words), "{words}\n{found}");
        assert!(!found.contains(".*"), "{found}");
    }
}

/// A given least length stays; one that is not given follows the thread, as in a file.
#[test]
fn the_least_length_follows_the_thread_unless_given() {
    let vary = "[sweep.vary]\n\"actuator.thread_length\" = [\"11 cm\", \"12 cm\"]\n";
    let free = sweep(&format!("[actuator]\npreset = \"colbrunn-2001\"\n{vary}"));
    let given = sweep(&format!("[actuator]\npreset = \"colbrunn-2001\"\nmin_length = \"6 cm\"\n{vary}"));
    let least = |sweep: &Sweep| sweep.scenario(1).expect("a row").actuator.min_length;
    assert_eq!((least(&free), least(&given)), (0.12 / 3_f64.sqrt(), 0.06));
}

/// Words change which keys there are; each combination is read from the file, whatever the order of the rows.
#[test]
fn words_are_read_with_their_numbers() {
    let sweep = sweep(
        "[air]\nheat_transfer = \"0.1 W/K\"\nprocess = \"energy-balance\"\n[sweep.vary]\n\
         \"valve.exhaust_temperature\" = [\"actuator\", \"ambient\"]\n\"load.mass\" = [\"1 kg\", \"2 kg\"]\n\
         \"run.method\" = [\"rk4\", \"stable\"]\n\"initial.length\" = [\"equilibrium\", \"3.5 in\"]\n",
    );
    for row in 0..16 {
        let scenario = sweep.scenario(row).unwrap_or_else(|error| panic!("{error}"));
        let word = |axis| match sweep.value(axis, row) {
            AxisValue::Word(word) => word,
            AxisValue::Number(number) => panic!("{number}"),
        };
        let valve = scenario.valve.expect("a valve");
        assert_eq!((valve.exhaust_temperature.name(), scenario.run.method.name()), (word(0), word(2)), "row {row}");
        let text = scenario.to_toml();
        assert!(text.contains(&format!("mass = \"{} kg\"", number(&sweep, 1, row))), "{text}");
        assert_eq!(text.contains("length = \"equilibrium\""), word(3) == "equilibrium");
    }
}

/// A key that only the sweep gives is not missing, and a value in a tail is an error of its row only.
#[test]
fn a_row_out_of_range_says_so_and_others_go_on() {
    let text = "[sweep]\ndesign = \"random\"\nrows = 64\n[sweep.vary]\n\
                \"valve.closing_delay\" = { normal = { mean = \"1 ms\", deviation = \"1 ms\" } }\n\
                \"load.mass\" = { from = \"1 kg\", to = \"2 kg\" }\n";
    let document = Document::parse(&format!("{}{text}", BASE.replace("mass = \"5 lb\"\n", "")), "muscle.toml");
    let sweep = document.and_then(|document| document.sweep()).unwrap_or_else(|error| panic!("{error}")).expect("one");
    let mut refused = 0;
    for row in 0..64 {
        let delay = number(&sweep, 0, row);
        match sweep.scenario(row) {
            Ok(scenario) => assert_eq!(scenario.valve.map(|valve| valve.closing_delay), Some(delay)),
            Err(error) => {
                assert!(delay < 0.0, "{error}");
                assert_eq!(error.row, row);
                assert!(error.to_string().contains("valve.closing_delay = -"), "{error}");
                refused += 1;
            }
        }
    }
    // A share of Φ(-1) = 0.159 is below zero.
    assert!((1..30).contains(&refused), "{refused}");
    let longer = "[sweep.vary]\n\"run.sample_interval\" = [\"1 ms\", \"3 s\"]\n";
    let error = self::sweep(longer).scenario(1).expect_err("longer than the run").to_string();
    assert!(error.contains("run.sample_interval") && error.contains("run.duration"), "{error}");
}

#[test]
fn what_is_recorded() {
    let vary = "[sweep.vary]\n\"load.mass\" = [\"1 kg\", \"2 kg\"]\n";
    let record = |text: &str| sweep(&format!("[sweep]\n{text}\n{vary}"));
    let Record::Reductions(all) = record("").record().clone() else { panic!("reductions") };
    assert!(all.iter().any(|reduction| reduction.name() == "length.final"));
    let two = record("reductions = [\"air.used\", \"length.overshoot\"]");
    let Record::Reductions(list) = two.record() else { panic!("reductions") };
    assert_eq!(
        list.iter().map(|reduction| reduction.column()).collect::<Vec<_>>(),
        ["air_used_kg", "length_overshoot"]
    );
    let samples = record("record = \"samples\"\nsample_times = [\"0.5 s\", \"1000 ms\"]\npart_rows = 7");
    assert_eq!(samples.record(), &Record::Samples(vec![0.5, 1.0]));
    assert_eq!(record("record = \"trajectories\"").record(), &Record::Trajectories);
    assert_eq!(samples.part_rows(), 2, "no more than there are");
}

#[test]
fn examples_are_good() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    for (name, rows, axes) in [("sweep-mass-pressure.toml", 63, 2), ("sweep-tolerances.toml", 512, 8)] {
        let document = Document::load(folder.join(name)).unwrap_or_else(|error| panic!("{error}"));
        document.experiment().unwrap_or_else(|error| panic!("{error}"));
        let sweep = document.sweep().unwrap_or_else(|error| panic!("{error}")).expect("a sweep");
        assert_eq!((sweep.rows(), sweep.axes().len()), (rows, axes));
        for row in 0..rows {
            let scenario = sweep.scenario(row).unwrap_or_else(|error| panic!("{name}: {error}"));
            scenario.experiment().unwrap_or_else(|error| panic!("{name}, row {row}: {error}"));
        }
    }
}

/// The one mistake of a sweep: its class, line (counted from the sweep's first), column and words.
fn check(text: &str, class: Class, at: (usize, usize), words: &[&str]) {
    let found = document(text).sweep().expect_err(text);
    assert_eq!(found.count(), 1, "{found}");
    let only: &Diagnostic = found.iter().next().expect("one");
    let shown = only.to_string();
    assert_eq!(only.class(), class, "{shown}");
    assert_eq!((only.line(), only.column()), (Some(FIRST + at.0 - 1), Some(at.1)), "{shown}");
    assert!(!only.remedies().is_empty(), "{shown}");
    for word in words {
        assert!(shown.contains(word), "`{word}` is not in\n{shown}");
    }
}

fn in_grid(line: &str, class: Class, column: usize, words: &[&str]) {
    check(&format!("[sweep.vary]\n{line}\n"), class, (2, column), words);
}

fn in_draw(line: &str, class: Class, column: usize, words: &[&str]) {
    check(&format!("[sweep]\ndesign = \"sobol\"\nrows = 8\n[sweep.vary]\n{line}\n"), class, (5, column), words);
}

#[test]
fn mistakes_of_the_design() {
    let vary = "[sweep.vary]\nload.mass = [\"1 kg\"]\n";
    let design = |line: &str, class, at, words: &[&str]| check(&format!("[sweep]\n{line}\n{vary}"), class, at, words);
    design("design = \"sobel\"", Class::InvalidChoice, (2, 10), &["did you mean \"sobol\"?"]);
    design("design = \"random\"", Class::Missing, (1, 2), &["`sweep.rows`", "rows = 4096"]);
    design("design = \"random\"\nrows = 0", Class::OutOfRange, (3, 8), &["at least 1"]);
    design("design = \"random\"\nrows = 2.5", Class::OutOfRange, (3, 8), &["a whole number"]);
    design("rows = 12", Class::NotApplicable, (2, 1), &["`sweep.design` = \"grid\"", "latin-hypercube"]);
    design("desing = \"grid\"", Class::UnknownKey, (2, 1), &["did you mean `design`?"]);
    design("reductions = [\"length.finale\"]", Class::InvalidChoice, (2, 15), &["did you mean \"length.final\"?"]);
    let unknown = "reductions = [\"angel.final\"]";
    let nearest = ["`mckibben keys sweep.reductions`", "did you mean \"angle.final\"?"];
    design(unknown, Class::InvalidChoice, (2, 15), &nearest);
    let found = document(&format!("[sweep]\n{unknown}\n{vary}")).sweep().expect_err("unknown").to_string();
    // Of one actuator neither a joint's nor a controller's are meant, and only a few are named.
    assert!(!found.contains("`angle") && !found.contains("_error") && found.len() < 700, "{found}");
    let twice = "reductions = [\"length.final\", \"air.used\", \"length.final\"]";
    design(twice, Class::Conflict, (2, 43), &["`length.final` is named twice", "first time"]);
    let error = "reductions = [\"length.final\", \"length_error.rms\"]";
    design(error, Class::NotApplicable, (2, 31), &["of a controller", "command.kind"]);
    design("record = \"samples\"", Class::Missing, (1, 2), &["sample_times"]);
    design("sample_times = [\"1 s\"]", Class::NotApplicable, (2, 1), &["`samples`"]);
    design("record = \"samples\"\nsample_times = [\"1 s\", \"1 s\"]", Class::BadList, (3, 24), &["increase"]);
    design(
        "record = \"samples\"\nsample_times = [\"1 s\", \"3 s\"]",
        Class::Inconsistent,
        (3, 24),
        &["the run lasts 2 s"],
    );
    design("part_rows = 0", Class::OutOfRange, (2, 13), &["at least 1"]);
    check("[sweep]\n", Class::Missing, (1, 2), &["[sweep.vary]"]);
    check("[sweep.vary]\n", Class::Missing, (1, 8), &["is empty"]);
    check("[sweep]\nvary = 3\n", Class::WrongType, (2, 8), &["is a section"]);
}

/// A law and its own keys vary together: rows of another law leave the keys out, those of the file as well.
#[test]
fn rows_leave_out_what_has_no_meaning_under_their_word() {
    let laws = "[actuator.force]\nend_factor_rise = 0.2\nend_factor_pressure = \"1 bar\"\n[sweep.vary]\n\
                \"actuator.force.law\" = [\"ideal-braid\", \"tondu-lopez\"]\n\"actuator.force.end_factor\" = [1.1, 1.3]\n";
    let sweep = sweep(laws);
    let law = |row| sweep.scenario(row).expect("a scenario").actuator.force;
    assert_eq!(sweep.rows(), 4);
    for row in [0, 1] {
        assert_eq!(law(row), Force::IdealBraid, "row {row}");
    }
    for (row, due) in [(2, 1.1), (3, 1.3)] {
        let Force::TonduLopez { end_factor, end_factor_rise, .. } = law(row) else {
            panic!("another law in row {row}")
        };
        assert_eq!([end_factor, end_factor_rise], [due, 0.2], "row {row}");
    }
    let left_out: Vec<_> = sweep.left_out().iter().map(|of| (of.key.as_str(), of.word.as_str())).collect();
    for key in ["end_factor", "end_factor_rise", "end_factor_pressure"] {
        assert!(left_out.contains(&(format!("actuator.force.{key}").as_str(), "ideal-braid")), "{left_out:?}");
    }
    assert_eq!(left_out.len(), 3, "{left_out:?}");
    // What is not used in any row is refused as before.
    let never =
        "[sweep.vary]\n\"actuator.force.law\" = [\"ideal-braid\"]\n\"actuator.force.end_factor\" = [1.1, 1.3]\n";
    let found = document(never).sweep().expect_err("no row has it").to_string();
    assert!(found.contains("`actuator.force.end_factor` is not used"), "{found}");
}

/// Presets of which the file replaces every value change no row.
#[test]
fn a_preset_that_reaches_nothing_is_refused() {
    let valve = "kind = \"three-way\"\nflow_area = \"1 mm^2\"\nefficiency = 0.8\nopening_delay = \"4 ms\"\n\
                 closing_delay = \"2 ms\"\n";
    let base = |valve: &str| {
        format!(
            "[supply]\ngauge_pressure = \"60 psi\"\n[valve]\n{valve}[command]\nkind = \"pwm\"\nfrequency = \"10 Hz\"\n\
             duty = 0.5\n[load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n[run]\nduration = \"0.1 s\"\n"
        )
    };
    let vary = "[sweep.vary]\n\"load.mass\" = [\"2 lb\", \"5 lb\"]\n\"valve.preset\" = [\"matrix-821\", \"matrix-eight-channel\"]\n";
    let of = |valve: &str| Document::parse(&format!("{}{vary}", base(valve)), "muscle.toml").expect("TOML").sweep();
    let set = |valve: &str| {
        let mut document = Document::parse(&base(valve), "muscle.toml").expect("TOML");
        document.set_plain_from("--set", "valve.preset", "matrix-821").expect("a path");
        document.scenario()
    };
    let whole = format!(
        "{valve}dead_time = \"0 ms\"\nopening_time = \"0 ms\"\nclosing_time = \"0 ms\"\nlaminar_ratio = 0.999\n"
    );
    let found = of(&whole).expect_err("equal rows").to_string();
    assert!(found.contains("`valve.preset` varies, and the file states every value"), "{found}");
    let found = set(&whole).expect_err("reaches nothing").to_string();
    assert!(found.contains("`valve.preset` = \"matrix-821\" is set") && found.contains("leave it out"), "{found}");
    // One value that the preset gives is enough.
    let part = "kind = \"three-way\"\nflow_area = \"1 mm^2\"\n";
    of(part).unwrap_or_else(|found| panic!("{found}"));
    set(part).unwrap_or_else(|found| panic!("{found}"));
}

#[test]
fn mistakes_of_the_keys() {
    in_grid("\"load.mas\" = [\"1 kg\"]", Class::UnknownKey, 1, &["did you mean `\"load.mass\"`?"]);
    in_grid("mass = [\"1 kg\"]", Class::UnknownKey, 1, &["did you mean `\"load.mass\"`?"]);
    in_grid("load = [\"1 kg\"]", Class::UnknownKey, 1, &["is a section"]);
    let twice = "[sweep.vary]\nload.mass = [\"1 kg\"]\n\"load.mass\" = [\"2 kg\"]\n";
    check(twice, Class::Conflict, (3, 1), &["varies twice", "first time"]);
    in_grid("\"sweep.rows\" = [1, 2]", Class::NotApplicable, 1, &["describes the sweep itself"]);
    in_grid("\"command.time\" = [\"1 s\"]", Class::NotApplicable, 1, &["is a list"]);
    in_grid("\"load.force\" = [\"1 N\"]", Class::NotApplicable, 1, &["is not used", "hanging-mass"]);
}

/// What a controller's keys take is in the unit of what it regulates.
#[test]
fn gains_are_in_the_unit_of_what_is_regulated() {
    let base = BASE.replace("kind = \"pwm\"\nfrequency = \"25 Hz\"\nduty = 0.5", "kind = \"controllers\"");
    let of = |controller: &str, vary: &str| {
        let text = format!("{base}[controller]\nrate = \"100 Hz\"\n{controller}\n[sweep.vary]\n{vary}\n");
        Document::parse(&text, "muscle.toml").expect("TOML").sweep()
    };
    let band = "\"controller.proportional_band\" = ";
    let by_length = of("kind = \"pid\"\nlength = \"85 mm\"", &format!("{band}[\"1 mm\", \"2 mm\"]"));
    let by_length = by_length.unwrap_or_else(|error| panic!("{error}")).expect("a sweep");
    assert_eq!(by_length.axes()[0].column(), "controller_proportional_band_m");
    // The set point may stand in the sweep alone.
    let vary = format!("{band}{{ from = \"1 mg\", to = \"9 mg\", count = 5 }}\ncontroller.air_mass = [\"60 mg\"]");
    let by_mass = of("kind = \"pid\"", &vary).unwrap_or_else(|error| panic!("{error}")).expect("a sweep");
    assert_eq!(by_mass.axes()[0].column(), "controller_proportional_band_kg");
    assert_eq!(number(&by_mass, 0, 1), 3e-6);
    let wrong = of("kind = \"pid\"\ngauge_pressure = \"1 bar\"", &format!("{band}[\"1 mm\"]"));
    let wrong = wrong.expect_err("a length").to_string();
    assert!(wrong.contains("a pressure") && wrong.contains("a length"), "{wrong}");
    let whole = of("kind = \"pid\"\nlength = \"85 mm\"\nproportional_band = \"1 mm\"", "controller.delay = [1, 1.5]");
    assert!(whole.expect_err("no half sample").to_string().contains("a whole number"));
    let range = "controller.delay = { from = 0, to = 4, count = 5 }";
    let range = of("kind = \"pid\"\nlength = \"85 mm\"\nproportional_band = \"1 mm\"", range);
    assert!(range.expect_err("a range").to_string().contains("a list of whole numbers"));
    // A sinusoid that a row takes below nothing is the error of that row.
    let wave =
        "kind = \"pid\"\nlength = \"85 mm\"\namplitude = \"1 mm\"\nfrequency = \"1 Hz\"\nproportional_band = \"1 mm\"";
    let wave = of(wave, "controller.amplitude = [\"1 mm\", \"90 mm\"]");
    let wave = wave.unwrap_or_else(|error| panic!("{error}")).expect("a sweep");
    assert!(wave.scenario(0).is_ok());
    assert!(wave.scenario(1).expect_err("a negative length").to_string().contains("controller.length"));
}

#[test]
fn a_sobol_sequence_has_its_dimensions() {
    let keys: Vec<String> = KEYS
        .iter()
        .filter(|key| key.varies() && matches!(key.kind, Kind::Quantity(_) | Kind::Choice(_)))
        .map(|key| format!("\"{}\" = [{}]", key.path, key.example))
        .collect();
    assert!(keys.len() > 128);
    let header = "[sweep]\ndesign = \"sobol\"\nrows = 8\n[sweep.vary]\n";
    check(&format!("{header}{}\n", keys[..129].join("\n")), Class::OutOfRange, (4, 8), &["129 keys", "128 dimensions"]);
}

#[test]
fn mistakes_of_lists() {
    in_grid("load.mass = []", Class::BadList, 13, &["empty"]);
    in_grid("load.mass = [\"1 kg\", \"2 N\"]", Class::WrongDimension, 22, &["a force", "a mass"]);
    in_grid("load.mass = [\"1 kg\", 2]", Class::MissingUnit, 22, &["needs a unit"]);
    in_grid("load.mass = [\"1 kg\", \"-1 kg\"]", Class::OutOfRange, 22, &["greater than 0 kg"]);
    in_grid("load.mass = \"1 kg\"", Class::WrongType, 13, &["a list, a range or a distribution", "= [\"5 lb\"]"]);
    in_grid("\"air.process\" = [\"isentropic\", \"adiabatic\"]", Class::InvalidChoice, 32, &["`isothermal`"]);
    in_grid("\"air.process\" = { from = 1, to = 2 }", Class::WrongType, 17, &["a list of words"]);
    in_grid("\"actuator.preset\" = [\"colbrunn-2002\"]", Class::InvalidChoice, 22, &["colbrunn-2001"]);
    assert_eq!(sweep("[sweep.vary]\n\"actuator.preset\" = [\"colbrunn-2001\"]\n").rows(), 1);
    // A word under which the file lacks a key; line 9 of the file is the header of [load].
    let found = document("[sweep.vary]\n\"load.kind\" = [\"hanging-mass\", \"constant-force\"]\n").sweep();
    let found = found.expect_err("no force").to_string();
    assert!(
        found.contains("muscle.toml:9:2") && found.contains("`load.kind = \"constant-force\"` of [sweep.vary]"),
        "{found}"
    );
}

#[test]
fn mistakes_of_ranges() {
    in_grid("load.mass = { from = \"1 kg\", to = \"2 kg\" }", Class::Missing, 13, &["`count`", "count = 9"]);
    in_grid("load.mass = { from = \"1 kg\", count = 3 }", Class::Missing, 13, &["`to` is missing"]);
    in_grid(
        "load.mass = { from = \"1 kg\", to = \"2 kg\", count = 1 }",
        Class::OutOfRange,
        51,
        &["at least 2", "as a list"],
    );
    in_grid(
        "load.mass = { from = \"1 kg\", to = \"2 kg\", cuont = 3 }",
        Class::UnknownKey,
        43,
        &["did you mean `count`?"],
    );
    in_grid("load.mass = { from = \"1 kg\", to = \"2 N\", count = 3 }", Class::WrongDimension, 35, &["a force"]);
    in_draw(
        "load.gravity = { from = \"0 m/s^2\", to = \"2 m/s^2\", spacing = \"logarithmic\" }",
        Class::OutOfRange,
        25,
        &["above zero"],
    );
    in_draw(
        "load.gravity = { from = \"5 m/s^2\", to = \"-2 m/s^2\", spacing = \"logarithmic\" }",
        Class::OutOfRange,
        41,
        &["above zero"],
    );
    in_draw(
        "load.mass = { from = \"1 kg\", to = \"2 kg\", spacing = \"log\" }",
        Class::InvalidChoice,
        53,
        &["`logarithmic`"],
    );
    let many = "load.mass = { from = \"1 kg\", to = \"2 kg\", count = 1e12 }\nvalve.efficiency = [0.8, 0.9]";
    check(&format!("[sweep.vary]\n{many}\n"), Class::OutOfRange, (1, 8), &["more than 1099511627776 rows"]);
}

#[test]
fn mistakes_of_distributions() {
    let normal = "load.mass = { normal = { mean = \"5 kg\", deviation = \"1 kg\" } }";
    in_grid(normal, Class::NotApplicable, 15, &["a grid", "latin-hypercube", "`count`"]);
    in_draw("load.mass = { normal = { mean = \"5 kg\" } }", Class::Missing, 24, &["`deviation` is missing", "0.5 ms"]);
    in_draw(
        "load.mass = { normal = { mean = \"5 kg\", deviation = \"0 kg\" } }",
        Class::OutOfRange,
        53,
        &["greater than 0 kg"],
    );
    in_draw(
        "load.mass = { normal = { mean = \"-5 kg\", deviation = \"1 kg\" } }",
        Class::OutOfRange,
        33,
        &["load.mass"],
    );
    in_draw(
        "load.mass = { normal = { mean = \"5 kg\", deviation = \"1 N\" } }",
        Class::WrongDimension,
        53,
        &["a force"],
    );
    in_draw(
        "supply.temperature = { normal = { mean = \"20 degC\", deviation = \"2 degC\" } }",
        Class::BadQuantity,
        68,
        &["an offset zero", "write `K`"],
    );
    in_draw(
        "load.mass = { log-normal = { median = \"5 kg\", factor = 1 } }",
        Class::OutOfRange,
        56,
        &["greater than 1"],
    );
    in_draw(
        "supply.gauge_pressure = { log-normal = { median = \"0 psi\", factor = 2 } }",
        Class::OutOfRange,
        51,
        &["above zero"],
    );
    in_draw("load.mass = { normal = 3 }", Class::WrongType, 24, &["a table is expected"]);
    let two = "load.mass = { normal = { mean = \"5 kg\", deviation = \"1 kg\" }, uniform = { from = \"1 kg\", to = \"2 kg\" } }";
    in_draw(two, Class::Conflict, 63, &["together with `normal`"]);
    in_draw(
        "load.mass = { normla = { mean = \"5 kg\", deviation = \"1 kg\" } }",
        Class::UnknownKey,
        15,
        &["did you mean `normal`?"],
    );
}

/// The scenario is read without the sweep, and with it the mistakes of the scenario are shown.
#[test]
fn the_base_scenario_ignores_the_sweep() {
    let plain = document("").scenario().expect("good");
    let swept = document("[sweep.vary]\nload.mass = [\"1 kg\"]\n\"nothing.known\" = 3\n");
    assert_eq!(swept.scenario().expect("good"), plain);
    let wrong = BASE.replace("duty = 0.5", "duty = 5") + "[sweep.vary]\nload.mass = [\"1 kg\"]\n";
    let found = Document::parse(&wrong, "muscle.toml").expect("TOML").sweep().expect_err("a duty of 5");
    assert!(found.to_string().contains("command.duty"), "{found}");
}

/// Rows of many actuators leave out as those of one do, under the law of each actuator alone.
#[test]
fn rows_of_plants_leave_out_what_has_no_meaning_under_their_word() {
    let arm = std::fs::read_to_string("../../examples/plant/arm.toml").expect("an example");
    let read = |sweep: &str| Document::parse(&format!("{arm}\n{sweep}"), "arm.toml").expect("TOML").sweep();
    let laws = "[sweep.vary]\n\"actuators.biceps.force.law\" = [\"ideal-braid\", \"tondu-lopez\"]\n\
                \"actuators.biceps.force.end_factor\" = [1.1, 1.3]\n";
    let sweep = read(laws).unwrap_or_else(|error| panic!("{error}")).expect("a sweep");
    let law = |row: u64| {
        let plant = sweep.plant(row).expect("a plant").unwrap_or_else(|why| panic!("row {row}: {why}"));
        let biceps = plant.names.actuators.iter().position(|name| name == "biceps").expect("its name");
        plant.plant.actuators()[biceps].actuator.static_force(0.08, 4e5)
    };
    let [ideal, again, little, much] = [0, 1, 2, 3].map(law);
    // A factor above one makes the neutral angle, and so the shortest length, come sooner: less force at a length.
    assert!(ideal == again && ideal > little && little > much, "{ideal} {again} {little} {much}");
    let [of] = sweep.left_out() else { panic!("{:?}", sweep.left_out()) };
    assert_eq!((of.key.as_str(), of.word.as_str()), ("actuators.biceps.force.end_factor", "ideal-braid"));
    assert_eq!(of.chooses, "actuators.biceps.force.law");
    let never = laws.replace(", \"tondu-lopez\"", "");
    let found = read(&never).expect_err("no row has it").to_string();
    assert!(found.contains("end_factor") && found.contains("is not used"), "{found}");
}

/// What varies is set from outside by its path, with or without the quotes of the file, whole or in a part of its range.
#[test]
fn what_varies_can_be_set_from_outside() {
    let masses = |file: &str, path: &str, value: &str| {
        let mut document = document(&format!("[sweep.vary]\n{file}\n"));
        document.set_plain_from("--set", path, value).unwrap_or_else(|error| panic!("{path}: {error}"));
        let sweep = document.sweep().unwrap_or_else(|error| panic!("{file}, {path}: {error}")).expect("a sweep");
        let axis = sweep.axes().iter().position(|axis| axis.path == "load.mass").expect("the mass varies");
        assert!(sweep.axes().iter().filter(|axis| axis.path == "load.mass").count() == 1);
        (0..sweep.rows()).map(|row| number(&sweep, axis, row)).collect::<Vec<_>>()
    };
    for file in ["\"load.mass\" = [\"1 kg\"]", "load.mass = [\"1 kg\"]", "load = { mass = [\"1 kg\"] }"] {
        for path in ["sweep.vary.\"load.mass\"", "sweep.vary.'load.mass'", "sweep.vary.load.mass"] {
            assert_eq!(masses(file, path, "[\"2 kg\", \"3 kg\"]"), [2.0, 3.0], "{file}, {path}");
        }
    }
    let range = "\"load.mass\" = { from = \"1 kg\", to = \"3 kg\", count = 2 }";
    for path in ["sweep.vary.\"load.mass\".count", "sweep.vary.load.mass.count"] {
        assert_eq!(masses(range, path, "3"), [1.0, 2.0, 3.0], "{path}");
    }
    // What does not vary yet is added.
    assert_eq!(masses("\"load.mass\" = [\"1 kg\"]", "sweep.vary.\"command.duty\"", "[0.4, 0.6]"), [1.0, 1.0]);
    let mut unknown = document("[sweep.vary]\n\"load.mass\" = [\"1 kg\"]\n");
    unknown.set_plain_from("--set", "sweep.vary.\"load.mas\"", "[\"1 kg\"]").expect("a path");
    assert!(unknown.sweep().expect_err("unknown").to_string().contains("did you mean"));
}
