//! The title of a figure: a sentence that says what is shown.
//!
//! It is the first sentence of the comments at the head of a scenario file, where they have one. Else it is made of the load and of
//! what drives the valve.

use crate::quantities::{digits, given, given_percent, plain};
use mckibben::parameter as p;
use mckibben_scenario::{Command, Document, Load, Motion, Regulator, Scenario, Sweep};

/// Words that end with a point without ending a sentence.
const ABBREVIATED: [&str; 10] = ["Fig", "fig", "No", "e.g", "i.e", "vs", "al", "approx", "ca", "Eq"];
/// The longest sentence that is a title, in letters.
const LONGEST: usize = 220;

/// The title of a document's runs. `set` are the values that differ from the file, as `KEY=VALUE`.
pub fn of(document: &Document, set: &[String]) -> String {
    made(document, set, || document.scenario().ok().map(|scenario| composed(&scenario, &[])))
}

/// The title of a sweep of a document: as [`of`], without what varies and how, which the figure shows.
pub fn of_sweep(document: &Document, sweep: &Sweep, set: &[String]) -> String {
    let set: Vec<String> = set.iter().filter(|set| !set.starts_with("sweep.")).cloned().collect();
    let varied: Vec<&str> = sweep.axes().iter().map(|axis| axis.path.as_str()).collect();
    made(document, &set, || sweep.scenario(0).ok().map(|first| composed(&first, &varied)))
}

fn made(document: &Document, set: &[String], of_one: impl FnOnce() -> Option<String>) -> String {
    let sentence = sentence(document.source().text());
    let title = sentence.or_else(of_one).unwrap_or_else(|| plant(document));
    if set.is_empty() { title } else { format!("{title} ({})", set.join(", ").replace('=', " = ")) }
}

/// The title of runs of several documents: what they have in common, or their names.
pub fn of_several(documents: &[Document]) -> String {
    let titles: Vec<String> = documents.iter().map(|document| of(document, &[])).collect();
    match titles.split_first() {
        Some((first, rest)) if rest.iter().all(|title| title == first) => first.clone(),
        _ => {
            let names: Vec<&str> = documents.iter().map(|document| document.source().name()).map(base).collect();
            match names.split_last() {
                Some((last, rest)) if !rest.is_empty() => format!("Runs of {} and {last}", rest.join(", ")),
                _ => names.concat(),
            }
        }
    }
}

/// The last part of a path.
pub(super) fn base(name: &str) -> &str {
    name.rsplit(['/', '\\']).next().unwrap_or(name)
}

/// The first sentence of the comments at the head of a text.
fn sentence(text: &str) -> Option<String> {
    let comments = text.trim_start_matches('\u{feff}').lines().map_while(|line| line.strip_prefix('#'));
    let paragraph: Vec<&str> =
        comments.map(str::trim).skip_while(|line| line.is_empty()).take_while(|line| !line.is_empty()).collect();
    let words = paragraph.join(" ").replace('`', "");
    let mut sentence = String::new();
    for word in words.split_whitespace() {
        if !sentence.is_empty() {
            sentence.push(' ');
        }
        sentence.push_str(word);
        if let Some(bare) = word.strip_suffix('.') {
            let is_short = ABBREVIATED.contains(&bare.trim_start_matches('('));
            if !is_short {
                sentence.pop();
                break;
            }
        }
    }
    let is_sentence = sentence.split(' ').count() > 2 && !sentence.starts_with("mckibben ");
    (is_sentence && sentence.chars().count() <= LONGEST).then_some(sentence)
}

/// What a scenario of one actuator or of a joint is, in a sentence without the keys that vary.
fn composed(of: &Scenario, varied: &[&str]) -> String {
    let varies = |key: &str| varied.contains(&key);
    let moves = [p::MOTION_AMPLITUDE.key, p::MOTION_FREQUENCY.key].into_iter().any(varies);
    let load = match &of.load {
        _ if varies("load.kind") => "A muscle".to_owned(),
        Load::HangingMass { .. } if varies("load.mass") => "A muscle under a load".to_owned(),
        Load::ConstantForce { .. } if varies("load.force") => "A muscle under a constant force".to_owned(),
        Load::PrescribedMotion(Motion::Sinusoid { .. }) if moves => "A muscle that is moved".to_owned(),
        Load::HangingMass { mass, .. } => format!("A muscle under a load of {}", kilograms(*mass)),
        Load::ConstantForce { force, .. } => format!("A muscle under a constant force of {}", given(*force, "N")),
        Load::Isometric => "A muscle at constant length".to_owned(),
        Load::PrescribedMotion(Motion::Sinusoid { amplitude, frequency, .. }) => {
            format!("A muscle moved by ±{} at {}", given(*amplitude, "m"), given(*frequency, "Hz"))
        }
        Load::PrescribedMotion(_) => "A muscle moved by a table".to_owned(),
        Load::AntagonisticJoint(_) => "A joint of two muscles".to_owned(),
    };
    let drive = match &of.command {
        _ if of.pressure.is_some() => "at a pressure that is given over time".to_owned(),
        _ if varies("command.kind") || varies("command.state") => return load,
        None => "sealed".to_owned(),
        Some(_) if of.valve.is_none() => "sealed".to_owned(),
        Some(Command::Pwm { frequency, duty, .. }) => {
            let frequency = (!varies("command.frequency")).then(|| given(*frequency, "Hz"));
            let duty = (!varies("command.duty")).then(|| given_percent(*duty));
            let parts: Vec<String> = frequency.into_iter().chain(duty).collect();
            if parts.is_empty() { "pulsed".to_owned() } else { format!("pulsed at {}", parts.join(" and ")) }
        }
        Some(Command::Constant(state)) => format!("with the valve at {}", state.name()),
        Some(Command::SetPoints { .. }) => "with set points of its regulator".to_owned(),
        Some(Command::Positions { .. }) => "with positions of its spool".to_owned(),
        Some(Command::Table { .. }) => "with commands of its valve".to_owned(),
        Some(Command::Controller(of)) => match of.regulator {
            Regulator::Relay { .. } => "under a relay".to_owned(),
            Regulator::Pid { .. } => "under a PID controller".to_owned(),
        },
    };
    format!("{load}, {drive}")
}

fn kilograms(mass: f64) -> String {
    if mass >= 0.1 { format!("{} kg", plain(&digits(mass))) } else { given(mass, "kg") }
}

/// A plant by its muscles.
fn plant(document: &Document) -> String {
    let names: Vec<String> = document.muscles().into_iter().map(|(name, _)| name).collect();
    match names.len() {
        0 | 1 => "A muscle on its mechanism".to_owned(),
        few @ 2..=4 => format!("{few} muscles on their mechanisms: {}", names.join(", ")),
        many => format!("{many} muscles on their mechanisms"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_sentence_of_the_comments_is_the_title() {
        let of = |text: &str| sentence(text);
        let long = "# Fig. 11 of Colbrunn, Nelson & Quinn (2001): length over\n# time, 1 lb. More words.\n[run]";
        let first = "Fig. 11 of Colbrunn, Nelson & Quinn (2001): length over time, 1 lb";
        assert_eq!(of(long).as_deref(), Some(first));
        assert_eq!(of("#\n# A leg steps on its belt.\n").as_deref(), Some("A leg steps on its belt"));
        assert_eq!(of("# muscle\n[run]"), None);
        assert_eq!(of("#   mckibben simulate a.toml --plot a.svg\n"), None);
        assert_eq!(of("[run]\n# A comment in a table is none of the file."), None);
    }

    #[test]
    fn without_a_sentence_the_title_is_made_of_load_and_drive() {
        let text = "[load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n[valve]\npreset = \"matrix-821\"\n[supply]\n\
                    gauge_pressure = \"60 psi\"\n[command]\nkind = \"pwm\"\nfrequency = \"25 Hz\"\nduty = 0.4\n[run]\n\
                    duration = \"1 s\"\n";
        let document = Document::parse(text, "muscle.toml").unwrap();
        assert_eq!(of(&document, &[]), "A muscle under a load of 2.268 kg, pulsed at 25 Hz and 40 %");
        let set = ["load.mass=1 kg".to_owned()];
        assert!(of(&document, &set).ends_with("40 % (load.mass = 1 kg)"));
    }

    #[test]
    fn the_title_of_a_sweep_leaves_out_what_varies() {
        let text = "[load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n[valve]\npreset = \"matrix-821\"\n[supply]\n\
                    gauge_pressure = \"60 psi\"\n[command]\nkind = \"pwm\"\nfrequency = \"25 Hz\"\nduty = 0.4\n[run]\n\
                    duration = \"1 s\"\n[sweep.vary]\n";
        for (vary, due) in [
            ("\"command.duty\" = [0.2, 0.4]", "A muscle under a load of 2.268 kg, pulsed at 25 Hz"),
            ("\"command.frequency\" = [\"20 Hz\", \"30 Hz\"]", "A muscle under a load of 2.268 kg, pulsed at 40 %"),
            (
                "\"load.mass\" = [\"1 kg\"]\n\"command.duty\" = [0.2]\n\"command.frequency\" = [\"9 Hz\"]",
                "A muscle under a load, pulsed",
            ),
            ("\"load.gravity\" = [9.8]", "A muscle under a load of 2.268 kg, pulsed at 25 Hz and 40 %"),
        ] {
            let document = Document::parse_in_si(&format!("{text}{vary}\n"), "muscle.toml").unwrap();
            let sweep = document.sweep().unwrap().unwrap();
            assert_eq!(of_sweep(&document, &sweep, &[]), due, "{vary}");
        }
    }
}
