//! Attributes of an instance in a model file, to a scenario and what the plugin needs besides.
//!
//! | attribute | meaning |
//! |---|---|
//! | `scenario` | path of a scenario file; without it, one actuator by the keys below |
//! | `scenario_text` | the text of a scenario file |
//! | `command_mode` | what `ctrl` is: `duty`, `request`, `position`, `set-point`; by default each valve's own |
//! | `pulse_frequency` | of duty cycles, such as `25 Hz`; by default that of the scenario's PWM |
//! | `max_step` | the longest part of a step, such as `0.5 ms`: the air takes several in a long step of MuJoCo |
//! | `length_offset` | what is added to MuJoCo's length for the distance between the ends of a muscle, such as `-30 mm` for fittings; for several, `biceps = -30 mm, triceps = -25 mm` |
//! | `actuator.thread_length`, … | any key of a scenario file by its path, as there: `4.3 in`, `0.9`, `isentropic` |

use crate::instance::{index_of, plain_name};
use mckibben_run::failure::Failure;
use mckibben_run::host::{HostOptions, HostPlant};
use mckibben_scenario::keys::{PLANT_KEYS, all_keys};
use mckibben_scenario::{Document, quantity};

/// Attributes other than keys of a scenario.
const OWN: [&str; 6] = ["scenario", "scenario_text", "command_mode", "pulse_frequency", "max_step", "length_offset"];
/// Sections of scenario files in whose place MuJoCo's model stands, with what to do.
const OF_MODEL: [(&str, &str); 2] = [
    (
        "coupling.",
        "leave it out: the tendon of the muscle in <tendon>, by its sites or its coefficients of joints, determines where it pulls",
    ),
    ("mechanism.", "leave it out: the muscles move the bodies and joints of the model"),
];
/// What a muscle alone has unless its attributes say otherwise. MuJoCo moves its ends, so the load and the times are unused.
const ALONE: [(&str, &str); 3] =
    [("load.kind", "\"isometric\""), ("initial.length", "\"1 m\""), ("run.duration", "\"1 s\"")];

/// Where a value stands that the user has not written, in messages.
const PLACE: &str = "the plugin";

/// What a valve may be commanded before `ctrl` says it: the first that it takes.
const AT_REST: [&str; 4] = [
    "{ kind = \"exhaust\" }",
    "{ kind = \"hold\" }",
    "{ kind = \"set-points\", time = [\"0 s\"], gauge_pressure = [\"0 Pa\"] }",
    "{ kind = \"positions\", time = [\"0 s\"], position = [0.0] }",
];

/// What an instance is made of.
#[derive(Clone, Debug)]
pub(crate) struct Config {
    pub(crate) host: HostPlant,
    /// What is added to MuJoCo's lengths.
    pub(crate) offsets: Offsets,
}

/// What is added to MuJoCo's length for the distance between the ends of a muscle, in m, as `length_offset` gives it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Offsets {
    /// One number for every actuator of the plant.
    OfAll(f64),
    /// The text of the attribute, and its numbers by names; zero for the others.
    ByName(String, Vec<(String, f64)>),
}

/// The names of all attributes.
pub(crate) fn attributes() -> impl Iterator<Item = &'static str> {
    // A plugin has no load and no run; how it is commanded at the start is said by `ctrl`.
    let elsewhere = ["load.", "run.", "sweep.", "controller."];
    let keys = all_keys().map(|key| key.path);
    OWN.into_iter().chain(keys.filter(move |path| !elsewhere.iter().any(|section| path.starts_with(section))))
}

/// Reads the attributes of an instance; `attribute` has the value of each, empty where it is not given.
pub(crate) fn read<'m>(attribute: impl Fn(&str) -> Option<&'m str>) -> Result<Config, Failure> {
    let given = |name: &str| attribute(name).map(str::trim).filter(|value| !value.is_empty());
    let document = document(&given)?;
    let time = |name: &str, unit: &str| given(name).map(|text| number(name, text, unit)).transpose();
    let options = HostOptions {
        command_mode: given("command_mode"),
        pulse_frequency: time("pulse_frequency", "Hz")?,
        max_step: time("max_step", "s")?,
        ..HostOptions::default()
    };
    let is_alone = given("scenario").or(given("scenario_text")).is_none();
    let made = |document: Document, options: &HostOptions<'_>| {
        HostPlant::read(&if is_alone { alone(document)? } else { document }, options)
    };
    let host = match document.contains("valve") && !document.contains("command") {
        false => made(document, &options)?,
        true => at_rest(&document, made, &options)?,
    };
    let offsets = given("length_offset").map_or(Ok(Offsets::OfAll(0.0)), Offsets::read)?;
    Ok(Config { host, offsets })
}

/// The scenario with the values of all keys that are given.
fn document<'m>(given: &impl Fn(&str) -> Option<&'m str>) -> Result<Document, Failure> {
    let mut document = match (given("scenario"), given("scenario_text")) {
        (Some(_), Some(_)) => {
            return Err(Failure::input(
                "`scenario` and `scenario_text` are both given",
                "give the path or the text, not both",
            ));
        }
        (Some(path), None) => Document::load(path)?,
        (None, Some(text)) => Document::parse(text, "scenario_text")?,
        (None, None) => Document::parse("", "the model")?,
    };
    for path in attributes().filter(|name| !OWN.contains(name)) {
        if let Some(value) = given(path) {
            check_attribute(path, given("scenario").or(given("scenario_text")).is_some())?;
            document.set_plain_from("the model", path, value)?;
        }
    }
    Ok(document)
}

/// Refuses a key that no attribute can give; `has_file` where the model gives a scenario.
fn check_attribute(path: &str, has_file: bool) -> Result<(), Failure> {
    let refused = |what: &str, remedy: &str| Err(Failure::input(format!("`{path}` {what}"), remedy));
    if let Some((_, remedy)) = OF_MODEL.iter().find(|(section, _)| path.starts_with(section)) {
        return refused("cannot be an attribute", remedy);
    }
    if !has_file && PLANT_KEYS.iter().any(|key| key.path == path) {
        let remedy = "leave it out, or write it into such a file, and give that by `scenario` or `scenario_text`";
        return refused("is for files in which actuators have names", remedy);
    }
    Ok(())
}

/// The scenario of a muscle alone with what its attributes need not say.
fn alone(mut document: Document) -> Result<Document, Failure> {
    let is_said = document.contains("initial.length");
    for (path, value) in ALONE {
        if !document.contains(path) {
            document.set_text_from(PLACE, path, value)?;
        }
    }
    if !is_said {
        // MuJoCo says how long it is.
        let longest = document.scenario()?.actuator.max_length;
        document.set_text_from(PLACE, "initial.length", &format!("\"{longest} m\""))?;
    }
    Ok(document)
}

/// Reads a scenario whose valve is commanded by `ctrl` alone; `made` reads one with options.
fn at_rest(
    document: &Document,
    made: impl Fn(Document, &HostOptions<'_>) -> Result<HostPlant, Failure>,
    options: &HostOptions<'_>,
) -> Result<HostPlant, Failure> {
    let with = |command: &str, options: &HostOptions<'_>| {
        let mut document = document.clone();
        document.set_text_from(PLACE, "command", command)?;
        made(document, options)
    };
    let mut failures = Vec::new();
    for command in AT_REST {
        match with(command, options) {
            Ok(host) => return Ok(host),
            // The valve takes this command, so the options are wrong.
            Err(failure) if with(command, &HostOptions::default()).is_ok() => return Err(failure),
            Err(failure) => failures.push(failure),
        }
    }
    // What is wrong with anything else is wrong with every command; the user has written none of them.
    let of_file = failures.iter().position(|failure| !failure.to_string().contains(&format!("--> {PLACE}:")));
    Err(failures.swap_remove(of_file.unwrap_or(0)))
}

/// A number in SI from a text with a unit.
fn number(name: &str, text: &str, unit: &str) -> Result<f64, Failure> {
    let wrong = |problem: String| {
        Failure::input(format!("{name} = \"{text}\": {problem}"), format!("give a number with a unit of {unit}"))
    };
    let read = quantity::parse(text).map_err(|error| wrong(error.to_string()))?;
    let (dimension, _) = quantity::parse_unit(unit).map_err(|error| wrong(error.to_string()))?;
    if read.dimension != dimension || !read.has_unit {
        return Err(wrong("this is no quantity in that unit".to_owned()));
    }
    Ok(read.value)
}

impl Offsets {
    fn read(text: &str) -> Result<Self, Failure> {
        if !text.contains('=') {
            return Ok(Self::OfAll(number("length_offset", text, "m")?));
        }
        let entries = text.split(',').map(|entry| {
            let (name, value) = entry.split_once('=').unwrap_or((entry, ""));
            Ok((name.trim().to_owned(), number("length_offset", value.trim(), "m")?))
        });
        Ok(Self::ByName(text.to_owned(), entries.collect::<Result<_, Failure>>()?))
    }

    /// What is added to the length of each actuator of the plant; `muscle` is the name in MuJoCo of one that is alone.
    pub(crate) fn of_each(&self, names: &[String], muscle: Option<&str>) -> Result<Vec<f64>, Failure> {
        let (text, entries) = match self {
            Self::OfAll(offset) => return Ok(vec![*offset; names.len()]),
            Self::ByName(text, entries) => (text, entries),
        };
        let of_muscle = |name: &str| muscle.filter(|own| plain_name(own) == plain_name(name)).map(|_| 0);
        let mut offsets = vec![None; names.len()];
        for (name, offset) in entries {
            let Some(at) = index_of(name, names).or_else(|| of_muscle(name)) else {
                return Err(Failure::input(
                    format!("length_offset = \"{text}\" names `{name}`, which is no actuator"),
                    format!("name {}", muscle.map_or_else(|| names.join(", "), str::to_owned)),
                ));
            };
            if offsets[at].replace(*offset).is_some() {
                return Err(Failure::input(
                    format!("length_offset = \"{text}\" names `{name}` twice"),
                    "give one offset for each actuator",
                ));
            }
        }
        Ok(offsets.into_iter().map(Option::unwrap_or_default).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(pairs: &[(&str, &str)]) -> Result<Config, Failure> {
        let pairs: Vec<(String, String)> = pairs.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned())).collect();
        let value = |name: &str| pairs.iter().find(|(key, _)| key == name).map(|(_, value)| value.as_str());
        let config = read(value)?;
        config.offsets.of_each(config.host.actuators(), None)?;
        Ok(config)
    }

    #[test]
    fn a_muscle_by_its_keys() {
        let muscle = [
            ("supply.gauge_pressure", "100 psi"),
            ("valve.preset", "matrix-eight-channel"),
            ("air.process", "isothermal"),
        ];
        let of = with(&[&muscle[..], &[("pulse_frequency", "25 Hz"), ("length_offset", "-30 mm")]].concat())
            .expect("a muscle");
        assert_eq!((of.offsets, of.host.commands()[0].name.as_str()), (Offsets::OfAll(-0.03), "actuator.duty"));
        let of = with(&muscle).expect("a muscle");
        assert_eq!(of.host.commands()[0].name, "actuator.request", "no frequency is said");
        let regulator = [
            ("supply.gauge_pressure", "100 psi"),
            ("valve.kind", "pressure-regulator"),
            ("valve.flow_area", "1.8e-5 ft^2"),
            ("valve.time_constant", "30 ms"),
            ("valve.rate_limit", "20 bar/s"),
        ];
        assert_eq!(with(&regulator).expect("a regulator").host.commands()[0].name, "actuator.set_point");
    }

    #[test]
    fn mistakes_are_named_with_what_to_do() {
        for (pairs, words) in [
            (vec![("actuator.thread_length", "4.3 kg")], "is a mass"),
            (vec![("actuator.turns", "-2")], "actuator.turns"),
            (vec![("length_offset", "elbow = 1 mm")], "name actuator"),
            (vec![("length_offset", "3")], "unit of m"),
            (vec![("length_offset", "actuator = -1 mm, actuator = -9 mm")], "names `actuator` twice"),
            (vec![("max_step", "1 m")], "unit of s"),
            (vec![("command_mode", "force")], "duty"),
            (vec![("scenario", "a.toml"), ("scenario_text", "[load]")], "not both"),
            (vec![("scenario", "nowhere/a.toml")], "nowhere/a.toml"),
            (vec![("scenario_text", "[load")], "scenario_text"),
            (vec![("coupling.rest_length", "90 mm")], "in <tendon>"),
            (vec![("mechanism.mass", "2 kg")], "bodies and joints of the model"),
            (vec![("valve.output", "b")], "give that by `scenario`"),
        ] {
            let pairs = [&pairs[..], &[("supply.gauge_pressure", "100 psi"), ("valve.preset", "matrix-eight-channel")]]
                .concat();
            let failure = with(&pairs).expect_err("a mistake").to_string();
            assert!(failure.contains(words), "{words}: {failure}");
        }
    }

    /// A muscle alone has a name in the model and one in the scenario; what stands before `/` in attached models does not count.
    #[test]
    fn an_offset_goes_by_either_name_of_a_muscle() {
        let names = ["actuator".to_owned()];
        for (text, muscle) in [
            ("biceps = -30 mm", Some("biceps")),
            ("biceps = -30 mm", Some("left/biceps")),
            ("left/biceps = -30 mm", Some("left/biceps")),
            ("actuator = -30 mm", Some("biceps")),
            ("actuator = -30 mm", None),
        ] {
            let offsets = Offsets::read(text).and_then(|offsets| offsets.of_each(&names, muscle));
            assert_eq!(offsets.expect(text), [-0.03], "{text} of {muscle:?}");
        }
        let refused = |text: &str| {
            let offsets = Offsets::read(text).and_then(|offsets| offsets.of_each(&names, Some("biceps")));
            offsets.expect_err(text).to_string()
        };
        assert!(refused("bicep = -30 mm").contains("name biceps"), "{}", refused("bicep = -30 mm"));
        assert!(refused("biceps = -1 mm, actuator = -9 mm").contains("names `actuator` twice"));
    }

    /// Of the plant of a file an attribute sets what all actuators share; one that each replaces would change nothing.
    #[test]
    fn an_attribute_that_reaches_no_part_is_refused() {
        const PLANT: &str = "[supplies.tank]\ngauge_pressure = \"6 bar\"\n[valve]\npreset = \"matrix-eight-channel\"\n\
            [load]\nkind = \"isometric\"\n[initial]\nlength = \"90 mm\"\n[run]\nduration = \"1 s\"\n\
            [actuators.a]\nsupply = \"tank\"\nvalve.opening_delay = \"3 ms\"\n";
        let text = ("scenario_text", PLANT);
        with(&[text, ("valve.closing_delay", "2 ms")]).expect("a delay of all");
        for (key, value, words) in [
            ("supply.gauge_pressure", "3 bar", "[supplies.tank]"),
            ("valve.opening_delay", "4 ms", "[actuators.a.valve]"),
        ] {
            let failure = with(&[text, (key, value)]).expect_err(key).to_string();
            assert!(failure.contains(key) && failure.contains("in the file") && failure.contains(words), "{failure}");
        }
    }

    /// The command before the first `ctrl` is the plugin's, so no message is about it.
    #[test]
    fn no_message_is_about_a_command_that_the_user_has_not_written() {
        let regulator = [
            ("supply.gauge_pressure", "6 bar"),
            ("valve.kind", "pressure-regulator"),
            ("valve.flow_area", "1 mm^2"),
            ("valve.time_constant", "20 ms"),
            ("valve.rate_limit", "20 bar/s"),
        ];
        let spool = [
            ("supply.gauge_pressure", "6 bar"),
            ("valve.kind", "proportional-spool"),
            ("valve.flow_area", "2 mm^2"),
            ("valve.spool.natural_frequency", "60 Hz"),
            ("valve.spool.damping_ratio", "0.7"),
        ];
        let duty = ("command_mode", "duty");
        let said = |keys: &[(&str, &str)], with_wrong: (&str, &str)| {
            with(&[keys, &[with_wrong]].concat()).expect_err("a mistake").to_string()
        };
        for (said, words) in [
            (said(&regulator, duty), "command_mode=\"set-point\""),
            (said(&spool, duty), "command_mode=\"position\""),
            (said(&regulator, ("max_step", "0 s")), "max_step"),
            (said(&regulator, ("initial.gauge_pressure", "-3 bar")), "initial.gauge_pressure"),
            (said(&spool, ("initial.gauge_pressure", "-3 bar")), "initial.gauge_pressure"),
        ] {
            assert!(
                said.contains(words) && !said.contains("exhaust") && !said.contains("the plugin"),
                "{words}: {said}"
            );
        }
    }

    #[test]
    fn attributes_are_keys_of_scenarios() {
        let names: Vec<&str> = attributes().collect();
        assert!(names.contains(&"actuator.thread_length") && names.contains(&"valve.opening_delay"));
        assert!(!names.iter().any(|name| name.starts_with("run.")));
        assert!(names.iter().all(|name| !name.is_empty() && name.len() < 100));
    }
}
