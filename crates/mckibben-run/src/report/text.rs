//! Findings and tables for a terminal and as CSV.

use super::{Finding, Report, Table, number};
use crate::failure::Failure;
use crate::table::{Cell, Column, Writer};
use crate::text::{Alignment, GAP, Side, wrap};
use crate::units;
use mckibben_plot::Conversion;
use std::borrow::Cow;
use std::path::Path;

impl Report {
    /// The summary as text: one line for each finding.
    pub fn summary(&self) -> String {
        let head = ["Figure", "Quantity", "Paper's text", "Here", "Comparison"].map(String::from).to_vec();
        let rows = self.sections.iter().flat_map(|section| {
            section.findings.iter().map(|finding| {
                let stated = if finding.stated.is_empty() { "–".into() } else { plain(&finding.stated) };
                let verdict = finding.verdict.name().to_owned();
                vec![section.label.to_owned(), plain(&finding.quantity), stated, finding.shown(), verdict]
            })
        });
        Table { caption: String::new(), head, rows: rows.collect() }.to_text()
    }

    /// That every number that was found is finite.
    ///
    /// # Errors
    /// [`Failure::not_finite`] with what was found.
    pub fn check(&self) -> Result<(), Failure> {
        let mut findings = self.sections.iter().flat_map(|section| &section.findings);
        match findings.find(|finding| !finding.value.is_finite()) {
            Some(finding) => Err(Failure::not_finite(&format!("{}: {}", plain(&finding.quantity), finding.value))),
            None => Ok(()),
        }
    }

    /// The findings as CSV, with the reasons in full; messages name `path`.
    ///
    /// # Errors
    /// As [`Report::check`]; [`Failure::output`] when the CSV cannot be made.
    pub fn numbers_csv(&self, path: &Path) -> Result<Vec<u8>, Failure> {
        let columns =
            ["figure", "quantity", "value", "unit", "stated", "comparison", "reason"].map(|name| match name {
                "value" => Column::number(name, ""),
                word => Column::word(word),
            });
        let mut writer = Writer::csv(columns.to_vec(), path, Vec::new())?;
        for section in &self.sections {
            for finding in &section.findings {
                let Finding { quantity, stated, verdict, .. } = finding;
                let (value, _, unit) = finding.in_units();
                let [quantity, stated, reason] = [quantity.as_str(), stated, verdict.reason()].map(plain);
                let words = [section.label, &quantity, &*unit, &stated, verdict.name(), &reason].map(Cell::Word);
                let [label, quantity, rest @ ..] = words;
                writer.row(&[&[label, quantity, Cell::Number(value)], rest.as_slice()].concat())?;
            }
        }
        writer.finish(&[])
    }
}

impl Table {
    /// The table in the units that were chosen: columns of numbers whose heads end with a unit, as in `length mm`, and rows that have
    /// their unit in a column `unit`. Without a choice it stays.
    pub(super) fn in_units(&self) -> Cow<'_, Self> {
        let mut table = Cow::Borrowed(self);
        if let Some(place) = self.head.iter().position(|head| head == "unit") {
            let of_row = |row: &Vec<String>| {
                let numbers = row.iter().filter(|cell| is_numbers(cell)).flat_map(|cell| cell.split(' '));
                let largest = numbers.filter_map(value_of).fold(0.0, |largest: f64, value| largest.max(value.abs()));
                units::chosen(row.get(place)?, largest)
            };
            for (index, conversion) in
                self.rows.iter().enumerate().filter_map(|(index, row)| Some((index, of_row(row)?)))
            {
                for (column, cell) in table.to_mut().rows[index].iter_mut().enumerate() {
                    if column == place {
                        cell.clone_from(&conversion.unit);
                    } else if is_numbers(cell) {
                        *cell = converted(cell, &conversion);
                    }
                }
            }
            return table;
        }
        for column in 0..self.head.len() {
            let Some((name, unit)) = self.head[column].rsplit_once(' ') else { continue };
            let in_brackets = unit.strip_prefix('(').and_then(|unit| unit.strip_suffix(')'));
            let cells = || self.rows.iter().filter_map(|row| row.get(column));
            // What holds more than numbers and intervals stays, and so does its column.
            let is_whole = |cell: &String| is_numbers(cell) || !cell.contains(|c: char| c.is_ascii_digit());
            let numbers = cells().flat_map(|cell| cell.split(' ')).filter_map(value_of);
            let largest = numbers.fold(0.0, |largest: f64, value| largest.max(value.abs()));
            let Some(conversion) =
                units::chosen(in_brackets.unwrap_or(unit), largest).filter(|_| cells().all(is_whole))
            else {
                continue;
            };
            let table = table.to_mut();
            let unit = &conversion.unit;
            table.head[column] =
                if in_brackets.is_some() { format!("{name} ({unit})") } else { format!("{name} {unit}") };
            for cell in table.rows.iter_mut().filter_map(|row| row.get_mut(column)) {
                if is_numbers(cell) {
                    *cell = converted(cell, &conversion);
                }
            }
        }
        table
    }

    /// The cells as CSV; messages name `path`.
    ///
    /// # Errors
    /// [`Failure::output`] when the CSV cannot be made.
    pub fn to_csv(&self, path: &Path) -> Result<Vec<u8>, Failure> {
        let word = |cell: &String| plain(cell).replace('−', "-");
        let table = self.in_units();
        let columns = table.head.iter().map(|name| Column::word(word(name))).collect();
        let mut writer = Writer::csv(columns, path, Vec::new())?;
        for row in &table.rows {
            let words: Vec<String> = row.iter().map(word).collect();
            writer.row(&words.iter().map(|word| Cell::Word(word)).collect::<Vec<_>>())?;
        }
        writer.finish(&[])
    }

    /// Aligned columns: words to the left, numbers to the right.
    pub fn to_text(&self) -> String {
        self.to_text_within(usize::MAX)
    }

    /// The table as text in lines of at most so many characters, as far as words can be broken: the heads first, then
    /// the words of the widest column.
    pub fn to_text_within(&self, wide: usize) -> String {
        if self.head.is_empty() {
            return String::new();
        }
        let table = self.in_units();
        table.lines_within(wide)
    }

    /// Aligned columns in the units that the cells have, of a table that is more than columns of one quantity each.
    pub fn to_text_unconverted(&self) -> String {
        if self.head.is_empty() { String::new() } else { self.lines_within(usize::MAX) }
    }

    fn lines_within(&self, wide: usize) -> String {
        let widths = self.widths(wide);
        let side = |column| if self.is_numeric(column) { Side::Right } else { Side::Left };
        let columns = Alignment::new((0..).map(side).zip(widths.iter().copied()));
        // The lines of each cell; those of a head stand at its bottom.
        let fold = |row: &[String], is_head: bool| -> String {
            let lines = |(cell, width): (&String, &usize)| wrap(cell, "", *width).lines().map(String::from).collect();
            let cells: Vec<Vec<String>> = row.iter().zip(&widths).map(lines).collect();
            let height = cells.iter().map(Vec::len).max().unwrap_or(0);
            let line = |place: usize| {
                let cell = |lines: &Vec<String>| {
                    let above = if is_head { height - lines.len() } else { 0 };
                    place.checked_sub(above).and_then(|place| lines.get(place)).cloned().unwrap_or_default()
                };
                columns.line(&cells.iter().map(cell).collect::<Vec<_>>()) + "\n"
            };
            (0..height).map(line).collect()
        };
        let rows = self.rows.iter().map(|row| fold(row, false));
        [fold(&self.head, true), columns.rule() + "\n"].into_iter().chain(rows).collect()
    }

    /// The widths of the columns with which lines are at most so long, as far as that can be.
    fn widths(&self, wide: usize) -> Vec<usize> {
        let longest_word = |cell: &String| cell.split(' ').map(|word| word.chars().count()).max().unwrap_or(0);
        let of = |column: usize, of_head: &dyn Fn(&String) -> usize, of_cell: &dyn Fn(&String) -> usize| {
            let cells = self.rows.iter().filter_map(|row| row.get(column)).map(of_cell);
            cells.chain([of_head(&self.head[column])]).max().unwrap_or(0)
        };
        let whole = |cell: &String| cell.chars().count();
        let total = |widths: &[usize]| widths.iter().sum::<usize>() + GAP.len() * widths.len().saturating_sub(1);
        let mut widths: Vec<usize> = (0..self.head.len()).map(|column| of(column, &whole, &whole)).collect();
        if total(&widths) > wide {
            widths = (0..self.head.len()).map(|column| of(column, &longest_word, &whole)).collect();
        }
        let words = (0..widths.len()).filter(|column| !self.is_numeric(*column)).max_by_key(|column| widths[*column]);
        if let (Some(column), over @ 1..) = (words, total(&widths).saturating_sub(wide)) {
            let least = of(column, &longest_word, &longest_word);
            widths[column] = widths[column].saturating_sub(over).max(least);
        }
        widths
    }

    /// The caption on a separate line, then the columns.
    pub fn to_text_with_caption(&self) -> String {
        format!("{}\n\n{}", plain(&self.caption), self.to_text())
    }

    /// Whether every cell of a column begins as a number does.
    pub(super) fn is_numeric(&self, column: usize) -> bool {
        let cells = || self.rows.iter().filter_map(|row| row.get(column));
        let starts = |cell: &String| cell.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '−' | '–' | '±'));
        column > 0 && cells().all(starts) && cells().any(|cell| cell.starts_with(|c: char| c.is_ascii_digit()))
    }
}

/// The number that a cell is, if it is nothing else.
fn value_of(cell: &str) -> Option<f64> {
    cell.replace('−', "-").parse().ok().filter(|value: &f64| value.is_finite())
}

/// Whether a cell is a number, perhaps with half of its interval (`1.5 ± 0.1`), or an interval (`1.4 to 1.6`).
fn is_numbers(cell: &str) -> bool {
    let is_due = |(place, word): (usize, &str)| match place % 2 {
        0 => value_of(word).is_some(),
        _ => matches!(word, "±" | "to"),
    };
    cell.split(' ').enumerate().all(is_due)
}

/// Such a cell in another unit, to as many digits.
fn converted(cell: &str, Conversion { factor, zero, .. }: &Conversion) -> String {
    let mut is_half = false;
    let word = |word: &str| {
        let Some(value) = value_of(word) else {
            is_half = word == "±";
            return word.to_owned();
        };
        let value = factor * value - if is_half { 0.0 } else { *zero };
        let (mantissa, power) = word.split_once('e').map_or((word, None), |(mantissa, power)| (mantissa, Some(power)));
        let before = mantissa.split_once('.').map_or(0, |(_, decimals)| decimals.len());
        match power {
            Some(_) => format!("{value:.before$e}"),
            None => number(value, units::decimals(before, *factor)),
        }
    };
    cell.split(' ').map(word).collect::<Vec<_>>().join(" ")
}

/// Words without the marks that only the page understands.
fn plain(words: &str) -> String {
    words.replace(['`', '{', '}'], "")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::{Data, Section, Verdict};

    #[test]
    fn columns_line_up() {
        let table = Table {
            caption: String::new(),
            head: ["what", "N"].map(String::from).to_vec(),
            rows: vec![vec!["ä".into(), "10.5".into()], vec!["bcdef".into(), "−2.0".into()]],
        };
        assert_eq!(table.to_text(), "what      N\n─────  ────\nä      10.5\nbcdef  −2.0\n");
    }

    #[test]
    fn a_table_that_is_too_wide_breaks_its_heads_and_then_its_words() {
        let table = Table {
            caption: String::new(),
            head: ["law", "held out: worst %"].map(String::from).to_vec(),
            rows: vec![vec!["a longer name".into(), "10.5".into()], vec!["b".into(), "2.0".into()]],
        };
        assert_eq!(
            table.to_text_within(20),
            "                held\n                out:\n               worst\nlaw                %\n\
             ─────────────  ─────\na longer name   10.5\nb                2.0\n"
        );
        assert_eq!(
            table.to_text_within(15),
            "           held\n           out:\n          worst\nlaw           %\n\
             ────────  ─────\na longer   10.5\nname\nb           2.0\n"
        );
    }

    #[test]
    fn numbers_and_intervals_are_converted_to_as_many_digits() {
        let to_inches = Conversion { unit: "in".to_owned(), factor: 1.0 / 25.4, zero: 0.0 };
        for (cell, expected) in [
            ("25.40", "1.000"),
            ("25.40 ± 0.254", "1.000 ± 0.0100"),
            ("−25.4 to 50.8", "−1.00 to 2.00"),
            ("2.54e-7", "1.00e-8"),
        ] {
            assert!(is_numbers(cell), "{cell}");
            assert_eq!(converted(cell, &to_inches), expected);
        }
        let to_celsius = Conversion { unit: "°C".to_owned(), factor: 1.0, zero: 273.15 };
        assert_eq!(converted("293.15 ± 0.50", &to_celsius), "20.00 ± 0.50");
        assert!(["3 of 4", "1.5 mm", "", "± 2"].iter().all(|cell| !is_numbers(cell)));
    }

    #[test]
    fn numbers_are_quoted_where_they_must_be() {
        let finding = Finding::new("a, \"b\"", 0.1, 2, "in").against("x_{eq}", Verdict::Agrees("yes".into()));
        let section = Section { label: "Fig. 1", findings: vec![finding], ..Section::default() };
        let report = Report { sections: vec![section], ..Report::default() };
        let csv = String::from_utf8(report.numbers_csv(Path::new("numbers.csv")).unwrap()).unwrap();
        assert!(csv.ends_with("Fig. 1,\"a, \"\"b\"\"\",0.1,in,x_eq,agrees,yes\n"), "{csv}");
    }

    #[test]
    fn what_is_not_finite_is_no_cell_but_where_a_value_may_lack() {
        let path = Path::new("data.csv");
        let mut data = Data::new(&["time_s", "fitted_m"]).lacking(&["fitted_m"]);
        data.rows = vec![vec![0.0, 1.5], vec![1.0, f64::NAN]];
        assert_eq!(data.to_csv(path).unwrap(), b"time_s,fitted_m\n0.0,1.5\n1.0,\n");
        for bad in [vec![f64::NAN, 1.0], vec![2.0, f64::INFINITY]] {
            data.rows.truncate(2);
            data.rows.push(bad);
            let failure = data.to_csv(path).expect_err("no number");
            assert!(failure.to_string().contains("row 3"), "{failure}");
            assert_eq!(failure.code(), 3);
        }
    }
}
