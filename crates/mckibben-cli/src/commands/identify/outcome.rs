//! What a study comes to: words for the terminal, a page, a scenario file, and the numbers.

use crate::failure::Failure;
use crate::output;
use crate::plot::{Axis, Legend, Panel, Series};
use crate::report::{Report, Section, Table};
use crate::terminal;
use mckibben_identify::least_squares::Estimate;
use mckibben_scenario::Scenario;
use std::path::{Path, PathBuf};

/// How a sentence begins that is a warning, among those that are good to know.
pub const WARNED: &str = "! ";

/// A scenario file of what was found.
pub(super) fn file(scenario: &Scenario) -> String {
    format!("# By `mckibben identify`.\n\n{}", scenario.to_toml())
}

/// A scenario file for each run whose scenario differs, or one for all.
pub(super) fn files<'a>(named: impl Iterator<Item = (&'a str, &'a Scenario)>) -> Vec<(String, String)> {
    let texts: Vec<(&str, String)> = named.map(|(run, scenario)| (run, file(scenario))).collect();
    match texts.windows(2).all(|pair| pair[0].1 == pair[1].1) {
        true => texts.into_iter().take(1).map(|(_, text)| ("scenario.toml".to_owned(), text)).collect(),
        false => texts.into_iter().map(|(run, text)| (format!("scenario-{run}.toml"), text)).collect(),
    }
}

/// The part of a page with the numbers that were found, and the scenario files that have them.
pub(super) fn numbers(tables: Vec<Table>, scenarios: &[(String, String)]) -> Section {
    Section {
        id: "numbers",
        label: "Numbers",
        title: "What was found",
        tables,
        files: scenarios.iter().map(|(name, text)| (name.clone().into(), text.clone().into())).collect(),
        ..Section::default()
    }
}

/// The panel below a figure with how far what was found is off.
pub(super) fn off(words: impl Into<String>, unit: &str, series: Series) -> Panel {
    Panel::new(Axis::new(words, unit)).horizontal(0.0, "").legend(Legend::Hidden).height_mm(20.0).series(series)
}

/// What was found.
#[derive(Debug, Default)]
pub struct Outcome {
    /// The heading of the page.
    pub(super) title: String,
    /// What was done, in a few sentences.
    pub introduction: Vec<String>,
    /// The parts of the page behind the one that says what was found in the data.
    pub(super) sections: Vec<Section>,
    /// The table that is printed.
    pub(super) table: Table,
    /// The values that are printed.
    pub(super) values: Table,
    /// The same as numbers.
    pub estimates: Vec<Estimate>,
    /// What a reader should know before believing them; warnings begin with [`WARNED`].
    pub warnings: Vec<String>,
    /// The scenarios with the values found, each with the name of its file.
    pub scenarios: Vec<(String, String)>,
}

impl Outcome {
    /// For the terminal.
    pub(super) fn told(&self) -> String {
        let wide = terminal::width();
        let mut text = String::new();
        for paragraph in &self.introduction {
            text.push_str(&format!("{}\n", terminal::wrap(&paragraph.replace('`', ""), "", wide)));
        }
        for table in [&self.table, &self.values] {
            if !table.head.is_empty() {
                let caption = terminal::wrap(&table.caption, "", wide);
                text.push_str(&format!("\n{caption}\n\n{}", table.to_text_within(wide)).replace('`', ""));
            }
        }
        if !self.warnings.is_empty() {
            text.push('\n');
        }
        for warning in &self.warnings {
            let (mark, words) = match warning.strip_prefix(WARNED) {
                Some(words) => (terminal::styled(terminal::NOTABLE, "!"), words),
                None => (" ".to_owned(), warning.as_str()),
            };
            let words = terminal::wrap(&words.replace('`', ""), "  ", wide);
            text.push_str(&format!("{mark} {}\n", words.trim_start()));
        }
        text
    }

    /// Writes everything into a folder; the page comes last, so that where it stands everything that it refers to stands too.
    ///
    /// # Errors
    /// [`Failure::output`] when a file cannot be written.
    pub fn write(&self, folder: &Path) -> Result<PathBuf, Failure> {
        std::fs::create_dir_all(folder).map_err(|error| Failure::output(folder, error))?;
        for plate in self.sections.iter().flat_map(|section| &section.plates) {
            plate.write(folder)?;
        }
        for (name, text) in &self.scenarios {
            output::write(&folder.join(name), text.as_bytes())?;
        }
        for (table, name) in [(&self.table, "comparison.csv"), (&self.values, "values.csv")] {
            if !table.head.is_empty() {
                let path = folder.join(name);
                let csv = table.to_csv().map_err(|error| Failure::output(&path, error))?;
                output::write(&path, &csv)?;
            }
        }
        let report = Report {
            title: self.title.clone(),
            introduction: self.introduction.clone(),
            sections: std::iter::once(self.data()).chain(self.sections.iter().cloned()).collect(),
            colophon: format!("Made by mckibben {} with `mckibben identify`.", env!("CARGO_PKG_VERSION")),
            ..Report::default()
        };
        let path = folder.join("index.html");
        let page = report.to_html().map_err(|error| Failure::output(&path, error))?;
        output::write(&path, page.as_bytes())?;
        Ok(path)
    }

    /// What was found in the data.
    fn data(&self) -> Section {
        let paragraphs = match self.warnings.is_empty() {
            true => vec!["Nothing odd was found in the data.".to_owned()],
            false => self.warnings.clone(),
        };
        Section { id: "data", label: "Data", title: "What was measured", paragraphs, ..Section::default() }
    }
}
