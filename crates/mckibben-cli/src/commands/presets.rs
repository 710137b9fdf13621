//! `mckibben presets`: the named actuators and valves, each number with its value, source and whether it is assumed.

use crate::terminal::{self, FAINT, HEADING, NOTABLE, styled};
use mckibben_run::failure::Failure;
use mckibben_run::text::{Alignment, Side};
use mckibben_scenario::presets::{ACTUATORS, Preset, PresetValue, VALVES};
use mckibben_scenario::quantity;
use std::fmt::Write as _;

/// Arguments of `mckibben presets`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  mckibben presets
  mckibben presets colbrunn-2001

Exit codes: 0 done; 2 there is no such preset.")]
pub struct PresetsArguments {
    /// The name of one preset; without it, all are shown.
    #[arg(value_name = "NAME")]
    pub name: Option<String>,
}

/// Shows the presets.
///
/// # Errors
/// [`Failure::input`] for a name that no preset has.
pub fn run(arguments: &PresetsArguments) -> Result<(), Failure> {
    let all =
        ACTUATORS.iter().map(|preset| ("actuator", *preset)).chain(VALVES.iter().map(|preset| ("valve", *preset)));
    let wanted = |preset: &Preset| arguments.name.as_deref().is_none_or(|name| name == preset.name);
    let shown: Vec<String> =
        all.clone().filter(|(_, preset)| wanted(preset)).map(|(section, preset)| table(section, preset)).collect();
    if shown.is_empty() {
        let names: Vec<&str> = all.map(|(_, preset)| preset.name).collect();
        let name = arguments.name.as_deref().unwrap_or_default();
        return Err(Failure::input(format!("there is no preset `{name}`"), format!("known: {}", names.join(", "))));
    }
    terminal::print(&shown.join("\n"))
}

/// A preset as a table.
fn table(section: &str, preset: &Preset) -> String {
    let mut text = format!("{}  {}\n", styled(HEADING, preset.name), preset.meaning);
    // Writing to a string cannot fail, here and below.
    let _ = writeln!(text, "{}\n", styled(FAINT, format!("in a file: {section}.preset = \"{}\"", preset.name)));
    let word = |(path, word): &(&str, &str)| [path, "", word, "", ""].map(str::to_owned);
    let rows: Vec<[String; 5]> = preset.words.iter().map(word).chain(preset.values.iter().map(row)).collect();
    let head = ["key", "symbol", "value", "SI", "source"].map(str::to_owned);
    // Nothing stands behind the source, which may have colours.
    let columns = Alignment::new([(Side::Left, 0); 5]).fit(rows.iter().chain([&head]).map(|row| &row[..4]));
    let _ = writeln!(text, "  {}", styled(FAINT, columns.line(&head)));
    for row in &rows {
        let _ = writeln!(text, "  {}", columns.line(row));
    }
    text
}

/// Key, symbol, value as the source writes it, value in SI, and source.
fn row(value: &PresetValue) -> [String; 5] {
    let parameter = value.parameter;
    let si = match value.value() {
        // A pure number is the same in every unit.
        Some(number) if !parameter.unit.is_empty() => quantity::format(short(number), parameter.unit),
        _ => String::new(),
    };
    let source = match value.source.strip_prefix("assumed: ") {
        Some(ground) => format!("{}  {ground}", styled(NOTABLE, "assumed")),
        None if value.assumed => format!("{}  {}", styled(NOTABLE, "assumed"), value.source),
        None => value.source.to_owned(),
    };
    [parameter.key.to_owned(), parameter.symbol.to_owned(), value.text.to_owned(), si, source]
}

/// The value with six digits, which is more than any source has.
fn short(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}
