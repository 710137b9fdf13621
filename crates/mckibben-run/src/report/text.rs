//! Findings for a terminal and as CSV, and data as CSV.

use super::{Data, Report, Table};
use crate::failure::Failure;
use crate::text::wrap;
use std::fmt::Write as _;
use std::path::Path;

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
    /// The columns as CSV, each number in the fewest digits that read back as itself, and an empty cell where there is none.
    ///
    /// # Errors
    /// As [`Data::check`]; [`Failure::output`], which names `path`, when the CSV cannot be made.
    pub fn to_csv(&self, path: &Path) -> Result<Vec<u8>, Failure> {
        self.check()?;
        let failed = |error: csv::Error| Failure::output(path, error);
        let mut out = csv::Writer::from_writer(Vec::new());
        out.write_record(&self.columns).map_err(failed)?;
        for row in &self.rows {
            let cells = row.iter().map(|value| if value.is_finite() { value.to_string() } else { String::new() });
            out.write_record(cells).map_err(failed)?;
        }
        out.into_inner().map_err(|error| Failure::output(path, error.into_error()))
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
        self.to_text_within(usize::MAX)
    }

    /// The same in lines of at most so many characters, as far as words can be broken: the heads first, then the words of the
    /// widest column.
    pub fn to_text_within(&self, wide: usize) -> String {
        if self.head.is_empty() {
            return String::new();
        }
        let widths = self.widths(wide);
        let right: Vec<bool> = (0..widths.len()).map(|column| self.is_numeric(column)).collect();
        let fold = |line: &Vec<String>| -> Vec<Vec<String>> {
            let lines = |(cell, width): (&String, &usize)| wrap(cell, "", *width).lines().map(String::from).collect();
            line.iter().zip(&widths).map(lines).collect()
        };
        let mut out = String::new();
        let mut put = |cells: &[Vec<String>], from_below: bool| {
            let height = cells.iter().map(Vec::len).max().unwrap_or(0);
            for row in 0..height {
                let mut text = String::new();
                for (column, lines) in cells.iter().enumerate() {
                    let above = if from_below { height - lines.len() } else { 0 };
                    let cell = row.checked_sub(above).and_then(|row| lines.get(row)).map_or("", String::as_str);
                    let (gap, room) = (if column == 0 { "" } else { GAP }, widths[column]);
                    // Writing to a string cannot fail.
                    let _ = match right[column] {
                        true => write!(text, "{gap}{cell:>room$}"),
                        false => write!(text, "{gap}{cell:<room$}"),
                    };
                }
                out.push_str(text.trim_end());
                out.push('\n');
            }
        };
        put(&fold(&self.head), true);
        put(&[vec![widths.iter().map(|width| "─".repeat(*width)).collect::<Vec<_>>().join(GAP)]], false);
        self.rows.iter().for_each(|row| put(&fold(row), false));
        out
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
    fn numbers_are_quoted_where_they_must_be() {
        let finding = Finding::new("a, \"b\"", 0.1, 2, "in").against("x_{eq}", Verdict::Agrees("yes".into()));
        let section = Section { label: "Fig. 1", findings: vec![finding], ..Section::default() };
        let report = Report { sections: vec![section], ..Report::default() };
        let csv = String::from_utf8(report.numbers_csv().unwrap()).unwrap();
        assert!(csv.ends_with("Fig. 1,\"a, \"\"b\"\"\",0.1,in,x_eq,agrees,yes\n"), "{csv}");
    }

    #[test]
    fn what_is_not_finite_is_no_cell_but_where_a_value_may_lack() {
        let path = Path::new("data.csv");
        let mut data = Data::new(&["time_s", "fitted_m"]).lacking(&["fitted_m"]);
        data.rows = vec![vec![0.0, 1.5], vec![1.0, f64::NAN]];
        assert_eq!(data.to_csv(path).unwrap(), b"time_s,fitted_m\n0,1.5\n1,\n");
        for bad in [vec![f64::NAN, 1.0], vec![2.0, f64::INFINITY]] {
            data.rows.truncate(2);
            data.rows.push(bad);
            let failure = data.to_csv(path).expect_err("no number");
            assert!(failure.to_string().contains("row 3"), "{failure}");
            assert_eq!(failure.code(), 3);
        }
    }
}
