//! Every class of mistake: its line and column, its words, its remedy; and that one reading finds them all.

use mckibben::Requirement;
use mckibben::parameter as p;
use mckibben_scenario::diagnostic::{Class, Diagnostic, Diagnostics, Style};
use mckibben_scenario::{Document, Scenario};

const GOOD: &str = r#"[actuator]
thread_length = "4.3218 in"
turns = 2.5
max_length = "3.85 in"
[supply]
gauge_pressure = "100 psi"
[valve]
kind = "three-way"
flow_area = "1.8e-5 ft^2"
efficiency = 0.85
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

fn mistakes(text: &str) -> Diagnostics {
    match Scenario::from_str(text, "muscle.toml") {
        Ok(scenario) => panic!("accepted:\n{text}\n{scenario:?}"),
        Err(mistakes) => mistakes,
    }
}

/// The one mistake that comes of replacing some text of the good file.
fn only(from: &str, to: &str) -> Diagnostic {
    assert!(GOOD.contains(from), "{from}");
    let found = mistakes(&GOOD.replacen(from, to, 1));
    assert_eq!(found.count(), 1, "{found}");
    found.iter().next().cloned().expect("one")
}

/// Replaces text, and checks class, line, column and some words of what is shown.
fn check(from: &str, to: &str, class: Class, at: (usize, usize), words: &[&str]) {
    let found = only(from, to);
    let shown = found.to_string();
    assert_eq!(found.class(), class, "{shown}");
    assert_eq!((found.line(), found.column()), (Some(at.0), Some(at.1)), "{shown}");
    assert!(shown.contains(&format!("muscle.toml:{}:{}", at.0, at.1)), "{shown}");
    for word in words {
        assert!(shown.contains(word), "`{word}` is not in\n{shown}");
    }
}

#[test]
fn the_good_file_is_good() {
    Scenario::from_str(GOOD, "muscle.toml").unwrap_or_else(|error| panic!("{error}"));
}

#[test]
fn syntax() {
    check("turns = 2.5", "turns 2.5", Class::Syntax, (3, 7), &["this is not TOML", "turns 2.5"]);
    check(
        "duty = 0.5",
        "duty = 0.5\nduty = 0.6",
        Class::Syntax,
        (15, 1),
        &["`duty` stands in the file twice", "keep one of the two"],
    );
}

#[test]
fn unknown_keys_and_sections() {
    check("turns = 2.5", "turns = 2.5\nturn = 2", Class::UnknownKey, (4, 1), &["[actuator]", "did you mean `turns`?"]);
    let study = "[study]\nkind = \"ring-down\"\nscenario = \"muscle.toml\"\n[load]";
    check("[load]", study, Class::UnknownKey, (15, 2), &["no section [study]", "fit it by `mckibben identify`"]);
    for tank in ["[supply.tank]\nvolume = \"1 L\"", "tank_volume = \"1 L\""] {
        let text = format!("{GOOD}\n").replacen(
            "[supply]\ngauge_pressure = \"100 psi\"\n",
            &format!("[supply]\ngauge_pressure = \"100 psi\"\n{tank}\n"),
            1,
        );
        let found = mistakes(&text).to_string();
        assert!(found.contains("give `reservoir_volume` in [supply]"), "{found}");
    }
    check("[load]", "[laod]", Class::UnknownKey, (15, 2), &["no section [laod]", "did you mean `load`?"]);
    check("duration", "pressure = 1\nduration", Class::UnknownKey, (19, 1), &["`pressure` is not a key of [run]"]);
    check(
        "kind = \"three-way\"",
        "kind = \"three-way\"\nduty = 1",
        Class::UnknownKey,
        (9, 1),
        &["is a key of [command]"],
    );
    check("[supply]", "[supply]\npressure = 3", Class::UnknownKey, (6, 1), &["did you mean `gauge_pressure`?"]);
    check("[actuator]", "turns = 2\n[actuator]", Class::UnknownKey, (1, 1), &["outside every section", "[actuator]"]);
    check("[actuator]", "[actuator.frictoin]\nx = 1\n[actuator]", Class::UnknownKey, (1, 11), &["`friction`"]);
}

#[test]
fn wrong_types() {
    check(
        "\"3.85 in\"",
        "true",
        Class::WrongType,
        (4, 14),
        &["a length, not a truth value", "max_length = \"3.85 in\""],
    );
    check("turns = 2.5", "turns = \"2.5\"", Class::WrongType, (3, 9), &["without quotes"]);
    check("\"three-way\"", "3", Class::WrongType, (8, 8), &["one of several words", "`fill-hold-exhaust`"]);
    check("[supply]", "[air]\nprocess = [1]\n[supply]", Class::WrongType, (6, 11), &["not a list"]);
    let found = mistakes(&format!("air = 3\n{GOOD}"));
    assert!(found.to_string().contains("`air` is a section, not a number"), "{found}");
}

#[test]
fn units_missing_superfluous_unknown_and_wrong() {
    check("\"3.85 in\"", "3.85", Class::MissingUnit, (4, 14), &["needs a unit", "\"3.85 m\"", "\"3.85 in\""]);
    check("\"3.85 in\"", "\"3.85\"", Class::MissingUnit, (4, 14), &["needs a unit"]);
    check(
        "efficiency = 0.85",
        "efficiency = \"0.85 bar\"",
        Class::UnexpectedUnit,
        (10, 14),
        &["a pure number", "a pressure"],
    );
    check(
        "100 psi",
        "100 PSI",
        Class::BadQuantity,
        (6, 23),
        &["`PSI` is not a unit", "did you mean \"psi\"?", "^^^ here"],
    );
    check("100 psi", "100 psig", Class::BadQuantity, (6, 23), &["gauge or absolute", "`gauge_pressure` are gauge"]);
    check("\"100 psi\"", "\"\\u0031 PSI\"", Class::BadQuantity, (6, 18), &["`PSI` is not a unit"]);
    check(
        "3.85 in",
        "3.85 psi",
        Class::WrongDimension,
        (4, 14),
        &["is a pressure, but `actuator.max_length` is a length"],
    );
    check("\"5 lb\"", "\"5 lbf\"", Class::WrongDimension, (17, 8), &["a force", "a mass", "`lb` or `kg`"]);
    check("25 Hz", "60 rpm", Class::WrongDimension, (13, 13), &["an angular speed", "a frequency", "1 Hz"]);
}

#[test]
fn values_out_of_range() {
    check(
        "duty = 0.5",
        "duty = 1.5",
        Class::OutOfRange,
        (14, 8),
        &["`command.duty` = 1.5", "at least 0 and at most 1", "0 to 1"],
    );
    check(
        "\"3.85 in\"",
        "\"-1 in\"",
        Class::OutOfRange,
        (4, 14),
        &["-0.0254 m", "greater than 0 m", "below the thread length"],
    );
    check("turns = 2.5", "turns = inf", Class::OutOfRange, (3, 9), &["inf"]);
    check("100 psi", "-20 psi", Class::OutOfRange, (6, 18), &["-101325 Pa", "vacuum"]);
}

#[test]
fn words_out_of_the_list() {
    check(
        "\"three-way\"",
        "\"threeway\"",
        Class::InvalidChoice,
        (8, 8),
        &["did you mean \"three-way\"?", "`fill-hold-exhaust`"],
    );
    check(
        "[run]",
        "[initial]\nlength = \"equilibrum\"\n[run]",
        Class::InvalidChoice,
        (19, 10),
        &["\"equilibrium\"?", "a length"],
    );
    check(
        "kind = \"pwm\"\nfrequency = \"25 Hz\"\nduty = 0.5",
        "kind = \"tabel\"",
        Class::InvalidChoice,
        (12, 8),
        &["\"table\"?"],
    );
    check("turns = 2.5", "turns = 2.5\npreset = \"colbrun\"", Class::InvalidChoice, (4, 10), &["`colbrunn-2001`"]);
}

#[test]
fn what_is_missing_is_shown_at_its_section() {
    check("duty = 0.5\n", "", Class::Missing, (11, 2), &["`command.duty` (d) is missing", "duty = 0.5"]);
    check("turns = 2.5\n", "", Class::Missing, (1, 2), &["`actuator.turns`", "`actuator.preset = \"colbrunn-2001\"`"]);
    check("flow_area = \"1.8e-5 ft^2\"\n", "", Class::Missing, (7, 2), &["`sonic_conductance`"]);
    check("kind = \"three-way\"\n", "", Class::Missing, (7, 2), &["`valve.kind`"]);
    check(
        "[supply]\ngauge_pressure = \"100 psi\"\n",
        "",
        Class::Missing,
        (5, 2),
        &["[supply] is missing, which [valve] needs"],
    );
    let found = only("[load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n", "");
    assert_eq!((found.class(), found.line()), (Class::Missing, None), "{found}");
    assert!(found.to_string().contains("[load] is missing") && found.to_string().contains("muscle.toml"), "{found}");
}

#[test]
fn keys_that_exclude_each_other() {
    let two = "flow_area = \"1 mm^2\"\nsonic_conductance = \"1 L/(s*bar)\"\ncritical_ratio = 0.3";
    check(
        "flow_area = \"1.8e-5 ft^2\"",
        two,
        Class::Conflict,
        (10, 1),
        &["two ways", "first way", "`flow_area`; `sonic_conductance`"],
    );
    let two = "[actuator.effectiveness]\nconstant = 0.9\npolynomial = [1]\npressure_unit = \"psi\"\n[supply]";
    check("[supply]", two, Class::Conflict, (7, 1), &["[actuator.effectiveness]"]);
    let half = "sonic_conductance = \"1 L/(s*bar)\"";
    check("flow_area = \"1.8e-5 ft^2\"", half, Class::Missing, (7, 2), &["`valve.critical_ratio`", "in addition"]);
}

#[test]
fn keys_without_meaning() {
    check(
        "[supply]",
        "[air]\npolytropic_index = 1.2\n[supply]",
        Class::NotApplicable,
        (6, 1),
        &["`air.process` = \"isentropic\"", "`polytropic`"],
    );
    check("\"5 lb\"", "\"5 lb\"\nforce = \"1 N\"", Class::NotApplicable, (18, 1), &["chosen here"]);
    check("duty = 0.5", "duty = 0.5\nrest = \"hold\"", Class::NotApplicable, (15, 1), &["fill-hold-exhaust"]);
    check(
        "kind = \"pwm\"\nfrequency = \"25 Hz\"\nduty = 0.5",
        "kind = \"hold\"",
        Class::NotApplicable,
        (12, 8),
        &["cannot hold", "`fill-hold-exhaust`"],
    );
    let table = "kind = \"table\"\ntime = [\"0 s\", \"1 s\"]\nstate = [\"fill\", \"hold\"]";
    check("kind = \"pwm\"\nfrequency = \"25 Hz\"\nduty = 0.5", table, Class::NotApplicable, (14, 18), &["cannot hold"]);
    let valve = "[valve]\nkind = \"three-way\"\nflow_area = \"1.8e-5 ft^2\"\nefficiency = 0.85\n";
    check(valve, "", Class::NotApplicable, (7, 2), &["no [valve]"]);
    let isometric = "kind = \"isometric\"\n[initial]\nlength = \"equilibrium\"";
    check("kind = \"hanging-mass\"\nmass = \"5 lb\"", isometric, Class::NotApplicable, (18, 10), &["must be a length"]);
}

#[test]
fn lists() {
    let command = |rows: &str| format!("kind = \"table\"\n{rows}");
    let pwm = "kind = \"pwm\"\nfrequency = \"25 Hz\"\nduty = 0.5";
    let rows = command("time = [\"1 s\", \"900 ms\"]\nstate = [\"fill\", \"exhaust\"]");
    check(pwm, &rows, Class::BadList, (13, 16), &["must increase", "entry 2"]);
    let rows = command("time = [\"0 s\", \"900 ms\"]\nstate = [\"fill\"]");
    check(pwm, &rows, Class::BadList, (14, 9), &["has 2 entries, but `command.state` has 1"]);
    check(pwm, &command("time = []\nstate = [\"fill\"]"), Class::BadList, (13, 8), &["is empty"]);
    let rows = command("time = [\"0 s\", 1]\nstate = [\"fill\", \"exhaust\"]");
    check(pwm, &rows, Class::MissingUnit, (13, 16), &["\"1 s\""]);
    check(pwm, &command("time = [\"0 s\"]\nstate = [\"open\"]"), Class::InvalidChoice, (14, 10), &["`fill`"]);
}

#[test]
fn values_that_contradict_each_other() {
    check(
        "\"2 s\"",
        "\"2 s\"\nsample_interval = \"3 s\"",
        Class::Inconsistent,
        (20, 19),
        &["longer than the run", "the run's duration"],
    );
    check("\"2 s\"", "\"0.1 ms\"", Class::Inconsistent, (19, 12), &["0.001 s is longer"]);
    let motion = "kind = \"prescribed-motion\"\nlength = \"1 in\"\namplitude = \"2 in\"\nfrequency = \"1 Hz\"";
    check("kind = \"hanging-mass\"\nmass = \"5 lb\"", motion, Class::OutOfRange, (18, 13), &["less than 0.0254 m"]);
}

#[test]
fn one_reading_finds_all_in_the_order_of_the_file() {
    let text = GOOD
        .replace("turns = 2.5", "turn = 2.5")
        .replace("100 psi", "100 PSI")
        .replace("duty = 0.5", "duty = 2")
        .replace("\"5 lb\"", "5")
        .replace("duration = \"2 s\"", "");
    let found = mistakes(&text);
    let lines: Vec<_> = found.iter().map(|one| (one.line().unwrap_or(0), one.class())).collect();
    let expected = [
        (3, Class::UnknownKey),
        (6, Class::BadQuantity),
        (14, Class::OutOfRange),
        (17, Class::MissingUnit),
        (18, Class::Missing),
    ];
    assert_eq!(lines, expected, "{found}");
}

#[test]
fn the_picture_is_as_promised() {
    let expected = r#"error: "3.85 psi" is a pressure, but `actuator.max_length` is a length
 --> muscle.toml:4:14
  |
4 | max_length = "3.85 psi"
  |              ^^^^^^^^^^ expected a quantity in m
  |
  = help: write it as in `max_length = "3.85 in"`"#;
    let found = only("3.85 in", "3.85 psi");
    assert_eq!(found.to_string(), expected);
    assert!(found.render(Style::Coloured).contains("\u{1b}["));
    assert!(!found.render(Style::Plain).contains('\u{1b}'));
}

#[test]
fn a_value_set_from_outside_is_shown_as_such() {
    let mut document = Document::parse(GOOD, "muscle.toml").unwrap_or_else(|error| panic!("{error}"));
    document.set("valve.efficiency", &toml::Value::Float(-1.0)).unwrap_or_else(|error| panic!("{error}"));
    let found = document.scenario().expect_err("out of range");
    let shown = found.to_string();
    assert!(shown.contains("value set from outside:1:20") && shown.contains("valve.efficiency = -1.0"), "{shown}");
}

#[test]
fn errors_of_the_core_are_shown_in_the_file() {
    let document = Document::parse(GOOD, "muscle.toml").unwrap_or_else(|error| panic!("{error}"));
    let requirement =
        Requirement { relation: "must be less than", other: "actuator.thread_length", value: 0.09, unit: "m" };
    let error = mckibben::Error::Inconsistent {
        parameter: &p::MAX_LENGTH,
        value: 0.1,
        requirement,
        remedy: "give a length below the thread length",
    };
    let shown = document.diagnose(&error);
    assert_eq!((shown.line(), shown.column()), (Some(4), Some(14)), "{shown}");
    for word in
        ["must be less than actuator.thread_length = 3.54331 in", "the other value", "thread_length = \"4.3218 in\""]
    {
        assert!(shown.to_string().contains(word), "{word}:\n{shown}");
    }
    // The number of the file as it stands there; one that it does not have is rounded.
    let of = |value, relation| {
        let requirement = Requirement { relation, other: "what follows", value: 0.005_999_999_999_999_9, unit: "m" };
        document.diagnose(&mckibben::Error::Inconsistent { parameter: &p::MAX_LENGTH, value, requirement, remedy: "" })
    };
    let shown = of(3.85 * 0.0254, "on a tendon must be at least").to_string();
    let words = "`actuator.max_length` = 3.85 in contradicts the rule that on a tendon it must be at least what follows = 0.23622 in";
    assert!(shown.contains(words), "{shown}");
    let absent = document.diagnose(&mckibben::Error::OutOfRange { parameter: &p::MIN_LENGTH, value: -1.0 });
    assert_eq!(absent.line(), Some(1), "{absent}");
    let nowhere = document.diagnose(&mckibben::Error::OutOfRange { parameter: &p::GAS_CONSTANT, value: -1.0 });
    assert_eq!((nowhere.line(), nowhere.file()), (None, "muscle.toml"), "{nowhere}");

    let text = GOOD.replace("turns = 2.5", "preset = \"colbrunn-2001\"");
    let document = Document::parse(&text, "muscle.toml").unwrap_or_else(|error| panic!("{error}"));
    let preset = document.diagnose(&mckibben::Error::OutOfRange { parameter: &p::TURNS, value: -1.0 });
    assert_eq!((preset.line(), preset.column()), (Some(3), Some(10)), "{preset}");
    assert!(preset.label().contains("the preset gives `actuator.turns`"), "{preset}");

    let text =
        GOOD.replace("[supply]", "[actuator.effectiveness]\npolynomial = [1.0, 2.0]\npressure_unit = \"Pa\"\n[supply]");
    let document = Document::parse(&text, "muscle.toml").unwrap_or_else(|error| panic!("{error}"));
    let table = document.diagnose(&mckibben::Error::Table {
        name: "actuator.effectiveness.polynomial",
        problem: "a coefficient is not finite",
        entry: 2,
        remedy: "give finite numbers",
    });
    assert_eq!((table.line(), table.column()), (Some(6), Some(20)), "{table}");
}

/// A wall closes the bore before the thread is straight, and a muscle at rest has a diameter in place of turns.
#[test]
fn remedies_fit_what_the_file_states() {
    let of = |wall: &str| {
        let text = format!(
            "[actuator]\nlength = \"200 mm\"\ndiameter = \"10 mm\"\nbraid_angle = \"25 deg\"\nwall_thickness = \"{wall}\"\n\
             [load]\nkind = \"isometric\"\n[initial]\nlength = \"300 mm\"\n[run]\nduration = \"1 s\"\n"
        );
        let document = Document::parse(&text, "muscle.toml").expect("TOML");
        let error = document.scenario().expect("readable").experiment().expect_err("a contradiction");
        document.diagnose(&error).to_string()
    };
    let thick = of("6 mm");
    assert!(thick.contains("a thinner wall, a larger diameter of the muscle at rest"), "{thick}");
    assert!(!thick.contains("turns"), "{thick}");
    let long = of("0.5 mm");
    assert!(long.contains("between 0 and this limit") && !long.contains("the thread length"), "{long}");
    assert!(of("0 mm").contains("between 0 and the thread length"));
}

#[test]
fn a_file_that_is_not_there() {
    let found = Scenario::load("no/such/file.toml").expect_err("no such file");
    assert!(found.to_string().contains("`no/such/file.toml` cannot be read"), "{found}");
    assert_eq!(found.iter().next().map(Diagnostic::class), Some(Class::Unreadable));
}

/// The remedy is a length and not the equilibrium, which an isometric load has none of.
#[test]
fn an_isometric_load_needs_a_length() {
    let (from, to) = ("kind = \"hanging-mass\"\nmass = \"5 lb\"", "kind = \"isometric\"");
    let words = [
        "`initial.length` (L(0)) is missing",
        "give `initial.length`, the distance between the attachments that the load holds",
        "`length = \"3.5 in\"` in [initial]",
    ];
    check(from, to, Class::Missing, (16, 8), &words);
    let section = "kind = \"isometric\"\n[initial]\ngauge_pressure = \"1 bar\"";
    check(from, section, Class::Missing, (17, 2), &words);
    for text in [to, section] {
        assert!(!only(from, text).to_string().contains("equilibrium"), "{text}");
    }
    let word = only(from, "kind = \"isometric\"\n[initial]\nlength = \"equilibrium\"").to_string();
    assert!(word.contains("write the distance between the attachments") && word.contains("\"3.5 in\""), "{word}");
}

/// Quantities that share a dimension are called what they are.
#[test]
fn a_dimension_of_two_quantities_names_neither_for_the_other() {
    let leakage = |value: &str| only("turns = 2.5", &format!("turns = 2.5\nleakage = \"{value}\"")).to_string();
    for (value, words) in [
        (
            "1 g/s",
            "\"1 g/s\" is a damping coefficient or a mass flow, but `actuator.leakage` is a volume flow over a pressure",
        ),
        ("1 L/min ANR", "`actuator.leakage` is a volume flow over a pressure"),
    ] {
        let shown = leakage(value);
        assert!(shown.contains(words), "{shown}");
        assert!(shown.contains("expected a quantity in m^3/(s*Pa)"), "{shown}");
        assert!(shown.contains("divide the volume flow at the mean pressure by the gauge pressure"), "{shown}");
    }
    let conductance = GOOD.replace("flow_area = \"1.8e-5 ft^2\"", "sonic_conductance = \"1 g/s\"");
    let conductance = mistakes(&conductance).to_string();
    assert!(conductance.contains("`valve.sonic_conductance` is a sonic conductance"), "{conductance}");
    let damping = only("[supply]", "[actuator.friction]\nviscous = \"1 kg\"\n[supply]").to_string();
    assert!(damping.contains("`actuator.friction.viscous` is a damping coefficient\n"), "{damping}");
}
