//! The tables agree with each other: every row of the core's parameter table has its key, every example and every
//! number of a preset is accepted, the schema is a valid schema that accepts what the reading accepts.

use mckibben::parameter::{self as p, TABLE};
use mckibben_scenario::keys::{KEYS, Kind, SECTIONS, key_at};
use mckibben_scenario::presets::{ACTUATORS, COLBRUNN_2001, VALVES};
use mckibben_scenario::{Document, Starter, quantity, schema};
use serde_json::{Value, json};

#[test]
fn every_parameter_has_its_key() {
    let without_key = [&p::SET_TORQUE, &p::PULLEY_ARM, &p::ARM_SLOPE];
    let of_controllers = p::CONTROL.iter().filter(|row| without_key.iter().all(|other| other.key != row.key));
    for row in TABLE.iter().chain(of_controllers) {
        let key = key_at(row.key).unwrap_or_else(|| panic!("{} has no key", row.key));
        assert!(key.parameter().is_some_and(|of| std::ptr::eq(of, *row)), "{}", row.key);
    }
}

#[test]
fn keys_are_unique_sorted_by_section_and_explained() {
    for (index, key) in KEYS.iter().enumerate() {
        assert!(KEYS[index + 1..].iter().all(|other| other.path != key.path), "{}", key.path);
        assert!(SECTIONS.iter().any(|section| section.path == key.section()), "{}", key.path);
        assert!(key.meaning.ends_with('.'), "{}", key.path);
        if let Some(when) = key.when {
            assert!(key_at(when.key).is_some(), "{}", key.path);
        }
    }
    let order: Vec<usize> =
        KEYS.iter().filter_map(|key| SECTIONS.iter().position(|section| section.path == key.section())).collect();
    assert!(order.is_sorted());
}

#[test]
fn every_unit_of_the_tables_parses_with_size_one() {
    for row in KEYS.iter().filter_map(|key| key.parameter()) {
        assert_eq!(quantity::parse_unit(row.unit).map(|(_, size)| size), Ok(1.0), "{}", row.key);
    }
}

/// A file in which a key applies, for trying its example.
fn file_for(path: &str) -> String {
    if let Some(key) = path.strip_prefix("controller.") {
        if matches!(key, "angle" | "stiffness") {
            return text_for("load.torque").to_owned()
                + "\n[supply]\ngauge_pressure = \"1 bar\"\n[valve]\nkind = \"three-way\"\nflow_area = \"1 mm^2\"\n\
                   [command]\nkind = \"controllers\"\n[controller]\nrate = \"10 Hz\"\nkind = \"air-mass\"\nangle = \"1 deg\"\n\
                   stiffness = \"1 N*m/rad\"\nhighest_gauge_pressure = \"1 bar\"\ndead_band = \"1 mg\"";
        }
        let of = match key {
            "length" => "kind = \"pid\"\nlength = \"9 cm\"\nproportional_band = \"1 mm\"",
            "air_mass" => "kind = \"pid\"\nair_mass = \"1 g\"\nproportional_band = \"1 g\"",
            "force" => "kind = \"pid\"\nforce = \"1 N\"\nproportional_band = \"1 N\"",
            "dead_band" | "hysteresis" => "kind = \"bang-bang\"\ngauge_pressure = \"1 bar\"\ndead_band = \"50 mbar\"",
            "highest_gauge_pressure" | "temperature" => {
                "kind = \"air-mass\"\nforce = \"1 N\"\nhighest_gauge_pressure = \"1 bar\"\ndead_band = \"1 mg\""
            }
            _ => {
                "kind = \"pid\"\ngauge_pressure = \"1 bar\"\namplitude = \"1 mbar\"\nfrequency = \"1 Hz\"\n\
                 proportional_band = \"1 bar\""
            }
        };
        return format!(
            "[supply]\ngauge_pressure = \"1 bar\"\n[valve]\nkind = \"three-way\"\nflow_area = \"1 mm^2\"\n\
             [command]\nkind = \"controllers\"\n[controller]\nrate = \"10 Hz\"\n{of}"
        );
    }
    text_for(path).to_owned()
}

fn text_for(path: &str) -> &'static str {
    match path {
        "air.polytropic_index" => "[air]\nprocess = \"polytropic\"",
        "air.heat_transfer" | "air.wall_temperature" => "[air]\nprocess = \"energy-balance\"",
        "command.pulse" | "command.rest" => {
            "[supply]\ngauge_pressure = \"1 bar\"\n[valve]\nkind = \"fill-hold-exhaust\"\nflow_area = \"1 mm^2\"\n\
             [command]\nkind = \"pwm\"\nfrequency = \"1 Hz\"\nduty = 0.5"
        }
        "valve.time_constant" | "valve.dead_time" | "valve.rate_limit" | "command.gauge_pressure" => {
            "[supply]\ngauge_pressure = \"5 bar\"\n[valve]\nkind = \"pressure-regulator\"\nflow_area = \"1 mm^2\"\n\
             time_constant = \"30 ms\"\nrate_limit = \"20 bar/s\"\n\
             [command]\nkind = \"set-points\"\ntime = [\"0 s\", \"1 s\"]\ngauge_pressure = [\"2 bar\", \"1 bar\"]"
        }
        "valve.spool.natural_frequency"
        | "valve.spool.damping_ratio"
        | "valve.spool.supply_overlap"
        | "valve.spool.exhaust_overlap"
        | "command.position" => {
            "[supply]\ngauge_pressure = \"5 bar\"\n[valve]\nkind = \"proportional-spool\"\nflow_area = \"1 mm^2\"\n\
             spool.natural_frequency = \"80 Hz\"\nspool.damping_ratio = 0.8\n\
             [command]\nkind = \"positions\"\ntime = [\"0 s\", \"1 s\"]\nposition = [0.2, -0.4]"
        }
        "pressure.at"
        | "pressure.time"
        | "pressure.gauge_pressure"
        | "pressure.offset"
        | "pressure.scale"
        | "pressure.shift" => "[pressure]\ntime = [\"0 s\", \"1 s\"]\ngauge_pressure = [\"1 bar\", \"2 bar\"]",
        "command.time" | "command.state" => {
            "[supply]\ngauge_pressure = \"1 bar\"\n[valve]\npreset = \"matrix-eight-channel\"\n\
             [command]\nkind = \"table\"\ntime = [\"0 s\", \"1 s\"]\nstate = [\"fill\", \"exhaust\"]"
        }
        "load.force" => "[load]\nkind = \"constant-force\"\nmass = \"1 kg\"\nforce = \"1 N\"",
        "load.length" | "load.amplitude" | "load.frequency" | "load.phase" => {
            "[load]\nkind = \"prescribed-motion\"\nlength = \"9 cm\"\namplitude = \"1 mm\"\nfrequency = \"1 Hz\""
        }
        "load.time" | "load.table_length" => {
            "[load]\nkind = \"prescribed-motion\"\ntime = [\"0 s\", \"1 s\"]\ntable_length = [\"9 cm\", \"8 cm\"]"
        }
        "load.moment_arm_angle" | "load.moment_arm" => {
            "[load]\nkind = \"antagonistic-joint\"\nmass = \"1 kg\"\ndistance = \"10 cm\"\nrest_length = \"8 cm\"\n\
             moment_arm_angle = [\"-1 rad\", \"1 rad\"]\nmoment_arm = [\"1 cm\", \"2 cm\"]"
        }
        "load.pulley_radius"
        | "load.rest_length"
        | "load.distance"
        | "load.inertia"
        | "load.hanging_angle"
        | "load.torque"
        | "load.damping"
        | "load.min_angle"
        | "load.max_angle"
        | "load.stop_stiffness"
        | "load.stop_damping"
        | "initial.angle"
        | "initial.angular_velocity" => {
            "[load]\nkind = \"antagonistic-joint\"\nmass = \"1 kg\"\ndistance = \"10 cm\"\npulley_radius = \"15 mm\"\n\
             rest_length = \"8 cm\""
        }
        "actuator.effectiveness.polynomial" | "actuator.effectiveness.pressure_unit" => {
            "[actuator.effectiveness]\npolynomial = [1.0]\npressure_unit = \"Pa\""
        }
        "actuator.effectiveness.gauge_pressure" | "actuator.effectiveness.value" => {
            "[actuator.effectiveness]\ngauge_pressure = [\"0 Pa\", \"1 Pa\"]\nvalue = [1.0, 1.0]"
        }
        "actuator.force.end_factor" | "actuator.force.end_factor_rise" | "actuator.force.end_factor_pressure" => {
            "[actuator.force]\nlaw = \"tondu-lopez\""
        }
        "actuator.force.radius" | "actuator.force.a" | "actuator.force.b" => {
            "[actuator.force]\nlaw = \"tondu-lopez\"\nradius = \"3 mm\"\na = 11.0\nb = 4.0"
        }
        "actuator.force.coefficients" | "actuator.force.pressure_unit" | "actuator.force.force_unit" => {
            "[actuator.force]\nlaw = \"sarosi\"\ncoefficients = [1, 2, 3, 4, 5, 6]\npressure_unit = \"kPa\"\nforce_unit = \"N\""
        }
        "actuator.force.membrane_thickness"
        | "actuator.force.modulus"
        | "actuator.force.modulus_unit"
        | "actuator.force.length_unit" => {
            "[actuator.force]\nlaw = \"martens-boblan\"\nmembrane_thickness = \"0.3 mm\"\nmodulus = [4, -60, 300, 100]\nmodulus_unit = \"MPa\"\nlength_unit = \"m\""
        }
        "actuator.force.thread_stiffness" => {
            "[actuator.force]\nlaw = \"extensible-braid\"\nthread_stiffness = \"30 kN/m\""
        }
        "actuator.force.max_force"
        | "actuator.force.max_pressure"
        | "actuator.force.max_contraction"
        | "actuator.force.shape" => {
            "[actuator.force]\nlaw = \"bolen\"\nmax_force = \"90 N\"\nmax_pressure = \"620 kPa\"\nmax_contraction = 0.3\nshape = [0.26, 6.4, 1.3]"
        }
        "actuator.force.gauge_pressure" | "actuator.force.length" | "actuator.force.tension" => {
            "[actuator.force]\nlaw = \"map\"\ngauge_pressure = [\"1 bar\", \"2 bar\"]\n\
             length = [\"7 cm\", \"8 cm\"]\ntension = [\"1 N\", \"2 N\", \"3 N\", \"4 N\"]"
        }
        "actuator.friction.hysteresis.width"
        | "actuator.friction.hysteresis.beta"
        | "actuator.friction.hysteresis.gamma" => {
            "[actuator.friction.hysteresis]\nlaw = \"bouc-wen\"\nwidth = \"0.1 mm\"\nbeta = \"4000 m^-1\""
        }
        "actuator.friction.hysteresis.bristle_reach"
        | "actuator.friction.hysteresis.static_ratio"
        | "actuator.friction.hysteresis.stribeck_velocity"
        | "actuator.friction.hysteresis.damping_time" => {
            "[actuator.friction.hysteresis]\nlaw = \"lugre\"\nwidth = \"0.1 mm\"\nbristle_reach = \"0.05 mm\""
        }
        _ if path.starts_with("actuator.friction.hysteresis") => {
            "[actuator.friction.hysteresis]\nreach = [\"0.1 mm\", \"1 mm\"]\nstiffness_ratio = [0.5, 0.1]"
        }
        _ if path.starts_with("actuator.friction.viscoelastic") => {
            "[actuator.friction.viscoelastic]\nrelaxation_time = [\"1 s\"]\nstiffness_ratio = [0.1]"
        }
        "actuator.force.pressure_coefficients" | "actuator.force.passive_coefficients" => {
            "[actuator.force]\nlaw = \"polynomial\"\npressure_coefficients = [1, 2]\npassive_coefficients = [1, 2]\n\
             pressure_unit = \"MPa\"\nforce_unit = \"N\""
        }
        _ if path.starts_with("actuator.taper") => "[actuator.taper]\nend_radius = \"2.8 mm\"\nlength_ratio = 1",
        _ if path.starts_with("actuator.bladder.s") => {
            "[actuator.bladder]\nform = \"saturating\"\nforce = \"10 N\"\nscale = 0.1"
        }
        _ if path.starts_with("actuator.bladder") => "[actuator.bladder]\nform = \"linear\"\nforce = \"10 N\"",
        "valve.sonic_conductance" | "valve.critical_ratio" => {
            "[supply]\ngauge_pressure = \"1 bar\"\n[command]\nkind = \"fill\"\n\
             [valve]\nkind = \"three-way\"\nsonic_conductance = \"1 L/(s*bar)\"\ncritical_ratio = 0.5"
        }
        "valve.kv" | "valve.pressure_drop_ratio" => {
            "[supply]\ngauge_pressure = \"1 bar\"\n[command]\nkind = \"fill\"\n\
             [valve]\nkind = \"two-way\"\nkv = \"1 m^3/h\""
        }
        "valve.cv" => {
            "[supply]\ngauge_pressure = \"1 bar\"\n[command]\nkind = \"fill\"\n[valve]\nkind = \"three-way\"\ncv = 1"
        }
        "valve.exhaust.sonic_conductance" | "valve.exhaust.critical_ratio" => {
            "[supply]\ngauge_pressure = \"1 bar\"\n[command]\nkind = \"fill\"\n[valve]\nkind = \"three-way\"\ncv = 1\n\
             [valve.exhaust]\nsonic_conductance = \"1 L/(s*bar)\"\ncritical_ratio = 0.5"
        }
        "valve.exhaust.pressure_drop_ratio" => {
            "[supply]\ngauge_pressure = \"1 bar\"\n[command]\nkind = \"fill\"\n[valve]\nkind = \"three-way\"\ncv = 1\n\
             [valve.exhaust]\ncv = 2"
        }
        "sweep.rows" | "sweep.seed" => "[sweep]\ndesign = \"random\"\nrows = 2",
        "sweep.design" => "[sweep]\nrows = 2",
        "sweep.sample_times" => "[sweep]\nrecord = \"samples\"",
        "supply.reservoir_gauge_pressure" | "supply.reservoir_index" | "supply.reservoir_volume" => {
            "[supply]\ngauge_pressure = \"1 bar\"\nreservoir_volume = \"1 L\""
        }
        "supply.compressor_displacement"
        | "supply.compressor_clearance"
        | "supply.cut_in_gauge_pressure"
        | "supply.cut_out_gauge_pressure" => {
            "[supply]\ngauge_pressure = \"1 bar\"\nreservoir_volume = \"1 L\"\ncompressor_displacement = \"10 L/min\"\n\
             cut_in_gauge_pressure = \"6 bar\"\ncut_out_gauge_pressure = \"8 bar\""
        }
        "supply.lag" | "supply.droop" | "supply.dead_band" | "supply.actuators" => {
            "[supply]\ngauge_pressure = \"1 bar\"\nlag = \"10 ms\""
        }
        _ if path.starts_with("tendon") => "[tendon]\nstiffness = \"10 kN/m\"",
        _ if path.starts_with("hose") => {
            "[supply]\ngauge_pressure = \"1 bar\"\n[valve]\npreset = \"matrix-eight-channel\"\n\
             [hose]\nkind = \"distributed\"\nlength = \"1 m\"\ndiameter = \"2 mm\"\n[command]\nkind = \"fill\""
        }
        _ if path.starts_with("valve") || path.starts_with("command") => {
            "[supply]\ngauge_pressure = \"1 bar\"\n[valve]\nkind = \"three-way\"\nflow_area = \"1 mm^2\"\n\
             [command]\nkind = \"pwm\"\nfrequency = \"1 Hz\"\nduty = 0.5"
        }
        _ if path.starts_with("supply") => "[supply]\ngauge_pressure = \"1 bar\"",
        "actuator.length" | "actuator.diameter" | "actuator.braid_angle" => {
            "[actuator]\nlength = \"190 mm\"\ndiameter = \"11 mm\"\nbraid_angle = \"24 deg\""
        }
        "actuator.turns" | "actuator.thread_length" | "actuator.max_length" => "[actuator]\npreset = \"colbrunn-2001\"",
        _ => "",
    }
}

fn complete(path: &str) -> Document {
    let given = file_for(path);
    let load = if given.contains("[load]") { "" } else { "\n[load]\nkind = \"hanging-mass\"\nmass = \"1 kg\"" };
    let text = format!("{given}{load}\n[run]\nduration = \"1 s\"\n");
    Document::parse(&text, "example.toml").unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn every_example_is_accepted() {
    let validator = boon_validator();
    for key in KEYS {
        let mut document = complete(key.path);
        document.set_text(key.path, key.example).unwrap_or_else(|error| panic!("{error}"));
        document.scenario().unwrap_or_else(|error| panic!("{}:\n{error}", key.path));
        let mut table = json_for(key.path);
        let value: toml::Table = format!("{} = {}", key.path, key.example).parse().expect("an example is TOML");
        merge(&mut table, &serde_json::to_value(value).expect("TOML without dates is JSON"));
        validator(&table).unwrap_or_else(|error| panic!("{}: {error}", key.path));
    }
}

fn json_for(path: &str) -> Value {
    let document = complete(path);
    let table: toml::Table = document.source().text().parse().expect("parsed before");
    serde_json::to_value(table).expect("TOML without dates is JSON")
}

fn merge(into: &mut Value, from: &Value) {
    match (into, from) {
        (Value::Object(into), Value::Object(from)) => {
            for (key, value) in from {
                merge(into.entry(key.clone()).or_insert(json!({})), value);
            }
        }
        (into, from) => *into = from.clone(),
    }
}

/// The schema compiled, which also checks it against the schema of schemas.
fn boon_validator() -> impl Fn(&Value) -> Result<(), String> {
    let mut schemas = boon::Schemas::new();
    let mut compiler = boon::Compiler::new();
    compiler.add_resource("http://localhost/scenario.json", schema()).expect("a JSON document");
    let index = compiler
        .compile("http://localhost/scenario.json", &mut schemas)
        .unwrap_or_else(|error| panic!("the schema is not valid: {error:#}"));
    move |value| schemas.validate(value, index).map_err(|error| format!("{error:#}"))
}

#[test]
fn the_schema_refuses_what_is_plainly_wrong() {
    let valid = boon_validator();
    let good = json!({ "load": { "kind": "hanging-mass", "mass": "5 lb" }, "run": { "duration": "1 s" } });
    valid(&good).unwrap_or_else(|error| panic!("{error}"));
    let bad = [
        json!({ "load": { "kind": "hanging-mass" } }),
        json!({ "load": { "kind": "hanging-mass", "force": "1 N" } }),
        json!({ "load": { "kind": "isometric", "gravity": "1 m/s^2" } }),
        json!({ "load": { "mass": 5 } }),
        json!({ "load": { "mass": "5" } }),
        json!({ "loads": {} }),
        json!({ "air": { "process": "adiabatic" } }),
        json!({ "air": { "polytropic_index": 1.2 } }),
        json!({ "air": { "heat_capacity_ratio": 3 } }),
        json!({ "valve": { "kind": "three-way" } }),
        json!({ "sweep": { "design": "random" } }),
        json!({ "sweep": { "rows": 12 } }),
        json!({ "sweep": { "vary": {} } }),
        json!({ "sweep": { "vary": { "load.mas": ["5 lb"] } } }),
        json!({ "sweep": { "vary": { "load.mass": "5 lb" } } }),
        json!({ "sweep": { "vary": { "load.mass": { "from": "5 lb" } } } }),
        json!({ "sweep": { "vary": { "load.mass": { "normal": { "mean": "5 lb", "deviation": 1 } } } } }),
        json!({ "sweep": { "vary": { "sweep.rows": [1] } } }),
        json!({ "sweep": { "vary": { "command.time[x]": ["1 s"] } } }),
        json!({ "sweep": { "vary": { "load.mass[0]": ["5 lb"] } } }),
        json!({ "sweep": { "vary": { "air.process": ["adiabatic"] } } }),
    ];
    for change in bad {
        let mut changed = good.clone();
        merge(&mut changed, &change);
        if change.pointer("/load/kind").is_some() && change.pointer("/load/mass").is_none() {
            changed["load"] = change["load"].clone();
        }
        assert!(valid(&changed).is_err(), "{changed}");
    }
}

#[test]
fn the_schema_accepts_every_way_to_vary() {
    let valid = boon_validator();
    let text = r#"
        load = { kind = "hanging-mass", mass = "5 lb" }
        run = { duration = "1 s" }
        sweep.design = "sobol"
        sweep.rows = 8
        [sweep.vary]
        "load.mass" = ["3 lb", "5 lb"]
        load.gravity = { from = "1 m/s^2", to = "10 m/s^2", spacing = "logarithmic" }
        "air.process" = ["isentropic", "isothermal"]
        "actuator.turns" = { from = 2, to = 3, count = 3 }
        "antagonist.initial.gauge_pressure" = ["1 bar", "2 bar"]
        antagonist.valve.flow_area = { from = "1 mm^2", to = "2 mm^2", count = 3 }
        "controller.proportional_band" = { from = "1 mm", to = "9 mm", count = 3 }
        controller.delay = [0, 1]
        controller.length = ["85 mm"]
        "command.time[1]" = { from = "40 ms", to = "80 ms", count = 3 }
        command."state[1]" = ["fill", "exhaust"]
        "antagonist.command.time[0]" = ["1 ms", "2 ms"]
        "initial.length" = ["equilibrium", "3.5 in"]
        "valve.opening_delay" = { normal = { mean = "4 ms", deviation = "0.5 ms" } }
        "valve.efficiency" = { uniform = { from = 0.8, to = 0.9 } }
        [sweep.vary.actuator.friction]
        viscous = { log-normal = { median = "0.02 lbf*s/in", factor = 1.5 } }
    "#;
    let table: toml::Table = text.parse().expect("TOML");
    valid(&serde_json::to_value(table).expect("no dates")).unwrap_or_else(|error| panic!("{error}"));
}

#[test]
fn the_starter_is_a_scenario_that_the_schema_accepts() {
    let text = Starter::default().text();
    let document = Document::parse(&text, "starter.toml").unwrap_or_else(|error| panic!("{error}"));
    let scenario = document.scenario().unwrap_or_else(|error| panic!("{error}"));
    let table: toml::Table = text.parse().expect("parsed before");
    boon_validator()(&serde_json::to_value(table).expect("no dates")).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(scenario.supply.map(|supply| supply.gauge_pressure), Some(689_475.729_316_836_1));
    for key in KEYS {
        assert!(text.contains(&format!("{} = {}", key.name(), key.example)), "{}", key.path);
    }
}

#[test]
fn presets_are_in_range_and_follow_the_paper() {
    for preset in ACTUATORS.iter().chain(VALVES) {
        for value in preset.values {
            let key = value.parameter.key;
            assert_eq!(value.assumed, value.source.starts_with("assumed"), "{key}");
            if matches!(key_at(key).map(|key| key.kind), Some(Kind::Quantities(_))) {
                assert!(value.list().is_some_and(|list| !list.is_empty()), "{}: {key}", preset.name);
                continue;
            }
            assert!(value.value().is_some(), "{}: {key}", preset.name);
            let unit = quantity::parse_unit(value.parameter.unit).map(|(dimension, _)| dimension);
            assert_eq!(quantity::parse(value.text).map(|read| read.dimension), unit, "{key}");
        }
        for (path, word) in preset.words {
            let known = match key_at(path).map(|key| key.kind) {
                Some(Kind::Choice(choices)) => choices.iter().any(|choice| choice.name == *word),
                Some(Kind::Unit(like)) => {
                    let dimension = |unit| quantity::parse_unit(unit).map(|(dimension, _)| dimension);
                    dimension(word) == dimension(like)
                }
                _ => false,
            };
            assert!(known, "{}: {path} = {word}", preset.name);
        }
    }
    let of = |row| COLBRUNN_2001.get(row).and_then(|value| value.value()).expect("the preset has it");
    let (b, n, longest) = (of(&p::THREAD_LENGTH), of(&p::TURNS), of(&p::MAX_LENGTH));
    let from_diameter = (longest * longest + (0.25 * 0.0254 * std::f64::consts::PI * n).powi(2)).sqrt();
    assert!((b / from_diameter - 1.0).abs() < 1e-4, "{b} {from_diameter}");
    assert!((of(&p::MIN_LENGTH) * 3_f64.sqrt() / b - 1.0).abs() < 1e-4);
}

/// What the grammar of quantities accepts, the schema's pattern accepts, so that it refuses no valid file.
#[test]
fn the_schema_s_pattern_is_no_stricter_than_the_grammar() {
    let valid = boon_validator();
    for text in ["2s", " 2.e0 s\n", "+.5 (s)", "\u{2212}2 s", "2 1/Hz", "2/Hz", "2 \u{b5}s", "2e3%*s"] {
        assert!(quantity::parse(text).is_ok_and(|read| read.has_unit), "{text}");
        let file = json!({ "load": { "kind": "isometric" }, "run": { "duration": text } });
        valid(&file).unwrap_or_else(|error| panic!("{text}: {error}"));
    }
}
