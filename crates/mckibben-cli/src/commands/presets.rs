//! `mckibben presets`: the named actuators and valves, each number with its value, source and whether it is assumed.

use crate::terminal::{self, FAINT, HEADING, NOTABLE, styled};
use mckibben_run::failure::Failure;
use mckibben_scenario::presets::{ACTUATORS, Preset, PresetValue, VALVES};
use mckibben_scenario::quantity;
use std::fmt::Write as _;

/// What `mckibben presets` is asked.
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
    let rows: Vec<[String; 4]> = preset.values.iter().map(row).collect();
    let head = ["key", "symbol", "value", "SI"].map(str::to_owned);
    let width =
        |column: usize| rows.iter().chain([&head]).map(|row| row[column].chars().count()).max().unwrap_or_default();
    let widths = [0, 1, 2, 3].map(width);
    let line = |row: &[String; 4]| {
        let cells = row.iter().zip(widths).map(|(cell, width)| format!("{cell:<width$}"));
        cells.collect::<Vec<_>>().join("  ")
    };
    let _ = writeln!(text, "  {}", styled(FAINT, format!("{}  source", line(&head))));
    for (path, word) in preset.words {
        let cells = [(*path).to_owned(), String::new(), (*word).to_owned(), String::new()];
        let _ = writeln!(text, "  {}", line(&cells).trim_end());
    }
    for (value, cells) in preset.values.iter().zip(&rows) {
        let source = match value.source.strip_prefix("assumed: ") {
            Some(ground) => format!("{}  {ground}", styled(NOTABLE, "assumed")),
            None if value.assumed => format!("{}  {}", styled(NOTABLE, "assumed"), value.source),
            None => value.source.to_owned(),
        };
        let _ = writeln!(text, "  {}  {source}", line(cells));
    }
    text
}

/// Key, symbol, value as the source writes it, and value in SI.
fn row(value: &PresetValue) -> [String; 4] {
    let parameter = value.parameter;
    let si = match value.value() {
        // A pure number is the same in every unit.
        Some(number) if !parameter.unit.is_empty() => quantity::format(short(number), parameter.unit),
        _ => String::new(),
    };
    [parameter.key.to_owned(), parameter.symbol.to_owned(), value.text.to_owned(), si]
}

/// The value with six digits, which is more than any source has.
fn short(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}
