//! Findings for a terminal and as CSV, and data as CSV.

use super::{Data, Report, Table};
use std::fmt::Write as _;

/// From one column to the next.
const GAP: &str = "  ";

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

    /// The findings as CSV, with the reasons in full.
    ///
    /// # Errors
    /// When the CSV cannot be made.
    pub fn numbers_csv(&self) -> Result<Vec<u8>, csv::Error> {
        let mut out = csv::Writer::from_writer(Vec::new());
        out.write_record(["figure", "quantity", "value", "unit", "stated", "comparison", "reason"])?;
        for section in &self.sections {
            for finding in &section.findings {
                let value = finding.value.to_string();
                let (quantity, stated) = (plain(&finding.quantity), plain(&finding.stated));
                let verdict = &finding.verdict;
                let reason = plain(verdict.reason());
                out.write_record([section.label, &quantity, &value, finding.unit, &stated, verdict.name(), &reason])?;
            }
        }
        out.into_inner().map_err(|error| error.into_error().into())
    }
}

impl Data {
    /// The columns as CSV, each number in the fewest digits that read back as itself; what is not finite stays empty.
    ///
    /// # Errors
    /// When the CSV cannot be made.
    pub fn to_csv(&self) -> Result<Vec<u8>, csv::Error> {
        let mut out = csv::Writer::from_writer(Vec::new());
        out.write_record(&self.columns)?;
        for row in &self.rows {
            out.write_record(row.iter().map(|v| if v.is_finite() { v.to_string() } else { String::new() }))?;
        }
        out.into_inner().map_err(|error| error.into_error().into())
    }
}

impl Table {
    /// The cells as CSV.
    ///
    /// # Errors
    /// When the CSV cannot be made.
    pub fn to_csv(&self) -> Result<Vec<u8>, csv::Error> {
        let mut out = csv::Writer::from_writer(Vec::new());
        for line in std::iter::once(&self.head).chain(&self.rows) {
            out.write_record(line.iter().map(|cell| plain(cell).replace('−', "-")))?;
        }
        out.into_inner().map_err(|error| error.into_error().into())
    }

    /// Aligned columns: words to the left, numbers to the right.
    pub fn to_text(&self) -> String {
        let columns = self.head.len();
        let lines = || std::iter::once(&self.head).chain(&self.rows);
        let width = |column: usize| {
            lines().map(|line| line.get(column).map_or(0, |cell| cell.chars().count())).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..columns).map(width).collect();
        let right: Vec<bool> = (0..columns).map(|column| self.is_numeric(column)).collect();
        let mut out = String::new();
        for (place, line) in lines().enumerate() {
            let mut text = String::new();
            for (column, cell) in line.iter().enumerate() {
                let room = widths.get(column).copied().unwrap_or(0);
                let gap = if column == 0 { "" } else { GAP };
                // Writing to a string cannot fail.
                let _ = match right.get(column) {
                    Some(true) => write!(text, "{gap}{cell:>room$}"),
                    _ => write!(text, "{gap}{cell:<room$}"),
                };
            }
            out.push_str(text.trim_end());
            out.push('\n');
            if place == 0 {
                let rule: Vec<String> = widths.iter().map(|w| "─".repeat(*w)).collect();
                out.push_str(&rule.join(GAP));
                out.push('\n');
            }
        }
        out
    }

    /// The caption on a line of its own, then the columns.
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

/// Words without the marks that only the page understands.
fn plain(words: &str) -> String {
    words.replace(['`', '{', '}'], "")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::{Finding, Section, Verdict};

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
    fn numbers_are_quoted_where_they_must_be() {
        let finding = Finding::new("a, \"b\"", 0.1, 2, "in").against("x_{eq}", Verdict::Agrees("yes".into()));
        let section = Section { label: "Fig. 1", findings: vec![finding], ..Section::default() };
        let report = Report { sections: vec![section], ..Report::default() };
        let csv = String::from_utf8(report.numbers_csv().unwrap()).unwrap();
        assert!(csv.ends_with("Fig. 1,\"a, \"\"b\"\"\",0.1,in,x_eq,agrees,yes\n"), "{csv}");
    }
}
