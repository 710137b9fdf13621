//! A report: sections with words, figures, tables and findings, as one HTML page, as CSV and as text.
//!
//! A [`Report`] is data and words only; nothing here knows a muscle. What a finding may claim is part of its type: a
//! [`Verdict`] says whether its number can be compared with what the source states, and how it came out.
//!
//! | file | its idea |
//! |---|---|
//! | `html` | the page: self-contained, light and dark, for screen and print |
//! | `style.css` | how it looks |
//! | `text` | the findings for a terminal and as CSV |
//!
//! Words may hold `L_min` or `x_{eq}`, which become subscripts, and `` `code` ``; everything else is taken literally.
//!
//! Checked by the tests of `html` and `text`, and by the program's `tests/reproduce.rs`.

mod html;
mod text;

pub use html::{STYLE, escaped};

use crate::failure::Failure;
use crate::output;
use crate::progress::Progress;
use crate::table::{Cell, Column, Writer};
use crate::units;
use mckibben_plot::{Conversion, Figure, Format};
use std::borrow::Cow;
use std::path::{Path, PathBuf};

/// Everything that is reported.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// The heading of the page.
    pub title: String,
    /// What it is about, as paragraphs.
    pub introduction: Vec<String>,
    /// What was assumed, as rows of a table.
    pub assumptions: Table,
    /// The parts, in order.
    pub sections: Vec<Section>,
    /// What made it, for the foot of the page.
    pub colophon: String,
}

/// A part of a report.
#[derive(Clone, Debug, Default)]
pub struct Section {
    /// The anchor in the page, unique within it.
    pub id: &'static str,
    /// The short name that findings are listed under, such as `Fig. 3`.
    pub label: &'static str,
    /// What it is about.
    pub title: &'static str,
    /// Words before the figures.
    pub paragraphs: Vec<String>,
    /// The figures.
    pub plates: Vec<Plate>,
    /// Tables after the figures.
    pub tables: Vec<Table>,
    /// What was found.
    pub findings: Vec<Finding>,
    /// The input files, as (name, text).
    pub files: Vec<(Cow<'static, str>, Cow<'static, str>)>,
}

/// A figure with its words and its data.
#[derive(Clone, Debug)]
pub struct Plate {
    /// The name of its files, without an ending.
    pub stem: &'static str,
    /// Its caption.
    pub caption: String,
    /// The figure.
    pub figure: Figure,
    /// Its numbers.
    pub data: Data,
}

/// Columns of numbers.
#[derive(Clone, Debug, Default)]
pub struct Data {
    /// The columns; the name of each has its unit at the end, as in `length_m`.
    pub columns: Vec<Column>,
    /// The rows; where an optional column has no value stands NaN, and an empty cell in a file.
    pub rows: Vec<Vec<f64>>,
}

/// A small table of words.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// Its caption.
    pub caption: String,
    /// The heads of the columns.
    pub head: Vec<String>,
    /// The rows; the first cell of each names the row.
    pub rows: Vec<Vec<String>>,
}

/// One number that was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// What it is.
    pub quantity: String,
    /// Its value in `unit`.
    pub value: f64,
    /// How many decimals are worth showing.
    pub decimals: usize,
    /// The unit; may be empty.
    pub unit: &'static str,
    /// What the source states about it, empty for nothing.
    pub stated: String,
    /// Whether the two can be compared, and how that came out.
    pub verdict: Verdict,
}

/// Whether a number can be compared with its source.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// It can, and it is as stated.
    Agrees(String),
    /// It can, and it is not as stated.
    Differs(String),
    /// It is what was put in.
    Input(String),
    /// It was found in the outcome of what the source states, which was put in.
    RoundTrip(String),
    /// It cannot, and why.
    NotComparable(String),
}

impl Verdict {
    /// The verdict in one or two words.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Agrees(_) => "agrees",
            Self::Differs(_) => "differs",
            Self::Input(_) => "put in",
            Self::RoundTrip(_) => "round trip",
            Self::NotComparable(_) => "not comparable",
        }
    }

    /// The reason.
    pub fn reason(&self) -> &str {
        match self {
            Self::Agrees(reason)
            | Self::Differs(reason)
            | Self::Input(reason)
            | Self::RoundTrip(reason)
            | Self::NotComparable(reason) => reason,
        }
    }
}

impl Finding {
    /// A number with nothing stated about it and nothing to compare it with.
    pub fn new(quantity: impl Into<String>, value: f64, decimals: usize, unit: &'static str) -> Self {
        let verdict = Verdict::NotComparable("the text states no number".into());
        Self { quantity: quantity.into(), value, decimals, unit, stated: String::new(), verdict }
    }

    /// Adds what the source states, and the verdict.
    #[must_use]
    pub fn against(self, stated: impl Into<String>, verdict: Verdict) -> Self {
        Self { stated: stated.into(), verdict, ..self }
    }

    /// The value in the unit that was chosen, if one was, with its decimals and the unit.
    pub(crate) fn in_units(&self) -> (f64, usize, Cow<'static, str>) {
        match units::chosen(self.unit, self.value.abs()) {
            Some(Conversion { unit, factor, zero }) => {
                (factor * self.value - zero, units::decimals(self.decimals, factor), Cow::Owned(unit))
            }
            None => (self.value, self.decimals, Cow::Borrowed(self.unit)),
        }
    }

    /// The value with its unit.
    pub fn shown(&self) -> String {
        let (value, decimals, unit) = self.in_units();
        let number = number(value, decimals);
        if unit.is_empty() { number } else { format!("{number} {unit}") }
    }
}

/// A number with a true minus sign and no negative zero.
pub fn number(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let zero = text.chars().all(|c| matches!(c, '-' | '0' | '.'));
    match text.strip_prefix('-') {
        Some(size) if zero => size.to_owned(),
        Some(size) => format!("−{size}"),
        None => text,
    }
}

/// Symbols and units of scenario files as they are printed.
pub fn typeset(text: &str) -> String {
    let signs = [
        ("m^3", "m³"),
        ("m^2", "m²"),
        ("1.75e5", "1.75 × 10⁵"),
        ("*s", "·s"),
        ("sqrt(3)", "√3"),
        ("mu N", "μN"),
        ("'", "’"),
    ];
    signs.iter().fold(text.to_owned(), |text, (from, to)| text.replace(from, to))
}

/// The name of the page.
pub(crate) const PAGE: &str = "index.html";
/// The name of the table of findings.
const NUMBERS: &str = "numbers.csv";

impl Report {
    /// Writes the page, its figures and its numbers into a folder, which is made if it is not there; the path of the page. That
    /// comes last, so that where it stands everything that it refers to stands too.
    ///
    /// # Errors
    /// [`Failure::output`] for the file that could not be written; as [`Report::check`].
    pub fn write(&self, folder: &Path) -> Result<PathBuf, Failure> {
        self.check()?;
        std::fs::create_dir_all(folder).map_err(|error| Failure::output(folder, error))?;
        let progress = Progress::begin("drawing", Some(self.sections.len() as u64));
        for (section, done) in self.sections.iter().zip(1..) {
            section.plates.iter().try_for_each(|plate| plate.write(folder))?;
            progress.at(done);
        }
        if self.has_findings() {
            let path = folder.join(NUMBERS);
            output::write(&path, &self.numbers_csv(&path)?)?;
        }
        let path = folder.join(PAGE);
        let page = self.to_html().map_err(|error| Failure::output(&path, error))?;
        output::write(&path, page.as_bytes())?;
        Ok(path)
    }
}

impl Plate {
    /// Writes the figure as SVG and PNG and its numbers as CSV into a folder.
    ///
    /// # Errors
    /// [`Failure::output`] for the file that could not be written.
    pub fn write(&self, folder: &Path) -> Result<(), Failure> {
        let at = |ending: &str| folder.join(format!("{}.{ending}", self.stem));
        for (ending, format) in [("svg", Format::Svg), ("png", Format::Png)] {
            let path = at(ending);
            let bytes =
                units::drawn(self.figure.clone()).bytes(format).map_err(|error| Failure::output(&path, error))?;
            output::write(&path, &bytes)?;
        }
        let csv = self.data.to_csv(&at("csv"))?;
        output::write(&at("csv"), &csv)
    }
}

impl Data {
    /// No rows yet of columns with these names.
    pub fn new(columns: &[&'static str]) -> Self {
        let columns = columns.iter().map(|name| Column::number(*name, units::unit_of(name)));
        Self { columns: columns.collect(), rows: Vec::new() }
    }

    /// The table where not every row has a value in some of the columns.
    #[must_use]
    pub fn lacking(mut self, names: &[&'static str]) -> Self {
        self.columns.iter_mut().for_each(|column| column.optional |= names.contains(&column.name.as_str()));
        self
    }

    /// Checks that every value is finite.
    ///
    /// # Errors
    /// [`Failure::not_finite`] with the column and the row.
    pub fn check(&self) -> Result<(), Failure> {
        for (row, number) in self.rows.iter().zip(1..) {
            self.columns.iter().zip(self.cells(row)).try_for_each(|(column, cell)| column.check(&cell, number))?;
        }
        Ok(())
    }

    /// The cells of a row.
    fn cells<'r>(&'r self, row: &'r [f64]) -> impl Iterator<Item = Cell<'static>> + 'r {
        let cell = |(column, value): (&Column, &f64)| match column.optional && value.is_nan() {
            true => Cell::Nothing,
            false => Cell::Number(*value),
        };
        self.columns.iter().zip(row).map(cell)
    }

    /// The table as CSV; messages name `path`.
    ///
    /// # Errors
    /// As [`Data::check`]; [`Failure::output`] when the CSV cannot be made.
    pub fn to_csv(&self, path: &Path) -> Result<Vec<u8>, Failure> {
        let mut writer = Writer::csv(self.columns.clone(), path, Vec::new())?;
        for row in &self.rows {
            writer.row(&self.cells(row).collect::<Vec<_>>())?;
        }
        writer.finish(&[])
    }
}

#[cfg(test)]
mod tests {
    use super::{number, typeset};

    #[test]
    fn numbers_and_units_are_fit_to_print() {
        assert_eq!(typeset("3 cm^3 at 0.02 lbf*s/in"), "3 cm³ at 0.02 lbf·s/in");
        assert_eq!([number(-0.001, 2), number(-1.5, 1), number(2.0, 0)], ["0.00", "−1.5", "2"]);
    }
}
