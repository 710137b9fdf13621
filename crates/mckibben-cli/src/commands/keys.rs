//! `mckibben keys`: what a key of a scenario file means, its unit, range, default and source, from the table that reads the file.

use crate::terminal::{self, FAINT, HEADING, entry, styled};
use mckibben_run::failure::Failure;
use mckibben_scenario::default_of;
use mckibben_scenario::keys::{Key, Kind, Section, all_keys, all_sections, nearest_path, paths_in};
use std::fmt::Write as _;

/// Arguments of `mckibben keys`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  mckibben keys                          sections with the names of their keys
  mckibben keys valve                    every key of a section in a line
  mckibben keys actuator.friction.viscous
  mckibben keys valve.kind               the words of a choice
  mckibben keys --names actuator.fr      paths that begin so, for scripts

Exit codes: 0 done; 2 there is no such section or key.")]
pub struct KeysArguments {
    /// A section or a key; without it, all sections.
    #[arg(value_name = "PATH")]
    pub path: Option<String>,
    /// Print nothing but the keys and sections whose paths begin with PATH, up to the next point; those of sections end with one.
    #[arg(long)]
    pub names: bool,
}

/// Width of the column of names.
const NAMES: usize = 26;

/// Prints what the table says.
///
/// # Errors
/// [`Failure::input`] for a path that is neither a section nor a key.
pub fn run(arguments: &KeysArguments) -> Result<(), Failure> {
    if arguments.names {
        return terminal::print(&names(arguments.path.as_deref().unwrap_or_default()));
    }
    let Some(path) = arguments.path.as_deref() else { return terminal::print(&sections()) };
    let path = path.strip_suffix('.').unwrap_or(path);
    let key = all_keys().find(|key| key.path == path);
    let section = all_sections().find(|section| section.path == path);
    match (key, section) {
        (Some(key), _) => terminal::print(&card(key)),
        (None, Some(section)) => terminal::print(&keys_of(section)),
        (None, None) => {
            let help = match nearest_path(path) {
                Some(known) => format!("did you mean `{known}`? `mckibben keys` prints every section"),
                None => "`mckibben keys` prints every section".to_owned(),
            };
            Err(Failure::input(format!("`{path}` is no section and no key of a scenario file"), help))
        }
    }
}

/// The paths that begin with a text, up to the next point, one a line.
fn names(text: &str) -> String {
    let section = text.rsplit_once('.').map_or("", |(section, _)| section);
    paths_in(section).into_iter().filter(|path| path.starts_with(text)).map(|path| path + "\n").collect()
}

/// Every section with its meaning and the names of its keys.
fn sections() -> String {
    let mut text = String::new();
    for section in all_sections() {
        let names: Vec<&str> = all_keys().filter(|key| key.section() == section.path).map(Key::name).collect();
        // Writing to a string cannot fail, here and below.
        let _ = writeln!(text, "{}  {}", styled(HEADING, format!("[{}]", section.path)), section.meaning);
        if !names.is_empty() {
            let _ = writeln!(text, "{}", styled(FAINT, terminal::wrap(&names.join(", "), "  ")));
        }
    }
    text
}

/// The keys of a section, each with unit, default and meaning.
fn keys_of(section: &Section) -> String {
    let mut text = format!("{}  {}\n\n", styled(HEADING, format!("[{}]", section.path)), section.meaning);
    for key in all_keys().filter(|key| key.section() == section.path) {
        let unit = key.parameter().filter(|row| !row.unit.is_empty()).map(|row| format!(" [{}]", row.unit));
        let default = default_of(key).map(|default| format!(" Default: {default}."));
        let about = format!("{}{}{}", key.meaning, unit.unwrap_or_default(), default.unwrap_or_default());
        text.push_str(&entry(key.name(), NAMES, &about));
    }
    let inner: Vec<&str> =
        all_sections().map(|of| of.path).filter(|path| path.starts_with(&format!("{}.", section.path))).collect();
    if !inner.is_empty() {
        text.push_str(&entry("sections inside", NAMES, &inner.join(", ")));
    }
    text
}

/// All that the table holds of a key.
fn card(key: &Key) -> String {
    let mut text = format!("{}  {}\n\n", styled(HEADING, key.path), key.meaning);
    let mut line = |name: &str, about: &str| text.push_str(&entry(name, 10, about));
    if let Some(row) = key.parameter() {
        line("symbol", row.symbol);
        line("unit", if row.unit.is_empty() { "none, a pure number" } else { row.unit });
        line("range", format!("{} {}", row.range, row.unit).trim_end());
    }
    if let Some(default) = default_of(key) {
        line("default", &default);
    }
    if let Some(when) = key.when {
        line("only with", &format!("{} = {}", when.key, when.words.join(" or ")));
    }
    if let Kind::Choice(choices) | Kind::Choices(choices) = key.kind {
        choices.iter().for_each(|choice| line(choice.name, choice.meaning));
    }
    if let Some(row) = key.parameter() {
        line("source", row.source);
        line("remedy", row.remedy);
    }
    line("example", &format!("{} = {}", key.name(), key.example));
    text
}
