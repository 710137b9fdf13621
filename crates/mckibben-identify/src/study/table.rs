//! Tables: CSV by the crate `csv`, Parquet by the crate `parquet`, to columns of numbers.
//!
//! | in a cell | is |
//! |---|---|
//! | nothing, `nan`, `NA`, `null`, `-`, a null of Parquet | no reading |
//! | anything else that is no number | a mistake, with its line; no reading in a column that the study does not name |
//!
//! Lines above the head that begin with `#` are comments, as in scenario files, and are skipped; directly above numbers a line with
//! as many cells is the head nevertheless. A head of numbers alone is refused, and so is a file without a head. Separators are
//! commas, semicolons or tabs, whichever the head has; with semicolons a decimal comma is read as a point.

use super::StudyError;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use std::path::{Path, PathBuf};

/// Columns of numbers by their names, as a file has them or a program hands them over.
#[derive(Clone, Debug)]
pub struct Table {
    pub(super) file: PathBuf,
    pub(super) columns: Vec<(String, Vec<f64>)>,
    /// The line of each row, or its number in a file without lines.
    pub(super) lines: Vec<usize>,
}

impl Table {
    /// A table from memory. A run of a study names it as it would a file. Numbers that are not finite are no readings.
    ///
    /// # Errors
    /// Columns of different lengths.
    pub fn new(name: &str, columns: Vec<(String, Vec<f64>)>) -> Result<Self, StudyError> {
        let (file, rows) = (PathBuf::from(name), columns.first().map_or(0, |(_, values)| values.len()));
        if let Some((of, values)) = columns.iter().find(|(_, values)| values.len() != rows) {
            let what = format!("the column `{of}` has {} numbers, but the first has {rows}", values.len());
            return Err(StudyError::new(
                &file,
                None,
                what,
                "give columns of one length; others stand in a separate table",
            ));
        }
        Ok(Self { file, columns, lines: (1..=rows).collect() })
    }

    pub(super) fn has(&self, name: &str) -> bool {
        self.columns.iter().any(|(of, _)| of == name)
    }

    /// How many columns have this name.
    pub(super) fn count(&self, name: &str) -> usize {
        self.columns.iter().filter(|(of, _)| of == name).count()
    }

    pub(super) fn heads(self) -> Vec<String> {
        self.columns.into_iter().map(|(name, _)| name).collect()
    }
}

/// Reads a table as the ending of its name says; `named` are the columns that must hold numbers.
pub(super) fn read(file: &Path, named: &[&str]) -> Result<Table, StudyError> {
    let ending = file.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    match ending.as_deref() {
        Some("csv" | "tsv" | "txt") => read_csv(file, named),
        Some("parquet") => read_parquet(file),
        _ => {
            let what = "its name ends in neither .csv nor .parquet";
            Err(StudyError::new(file, None, what, "give a table in one of the two formats"))
        }
    }
}

fn unreadable(file: &Path, error: impl std::fmt::Display) -> StudyError {
    StudyError::new(file, None, format!("it cannot be read ({error})"), "check the path, and that the file is whole")
}

fn read_csv(file: &Path, named: &[&str]) -> Result<Table, StudyError> {
    let text = std::fs::read_to_string(file).map_err(|error| match error.kind() {
        std::io::ErrorKind::InvalidData => StudyError::new(file, None, "its text is not UTF-8", "save it as UTF-8"),
        _ => unreadable(file, error),
    })?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    let Some((above, text)) = from_the_head(text) else {
        let what = if text.trim().is_empty() { "it is empty" } else { "it has comments alone" };
        let remedy = "give a table with a line of the names of its columns, such as `t_s,L_m,F_N`, above its readings";
        return Err(StudyError::new(file, None, what, remedy));
    };
    let first = text.lines().next().unwrap_or_default();
    let separator = separator(first);
    let mut reader =
        csv::ReaderBuilder::new().delimiter(separator as u8).trim(csv::Trim::All).from_reader(text.as_bytes());
    let heads = reader.headers().map_err(|error| unreadable(file, error))?.clone();
    if !heads.is_empty() && is_numbers(first, separator) {
        let what = "its first line is numbers, where the names of the columns are expected";
        return Err(StudyError::new(file, Some(above + 1), what, "put a line such as `t_s,L_m,F_N` above them"));
    }
    let mut columns: Vec<(String, Vec<f64>)> = heads.iter().map(|head| (head.to_owned(), Vec::new())).collect();
    let mut lines = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| {
            let line = error.position().map(|position| above + position.line() as usize);
            StudyError::new(file, line, "a line has more or fewer cells than the head", "mend or remove the line")
        })?;
        let line = record.position().map_or(0, |position| above + position.line() as usize);
        for ((name, column), cell) in columns.iter_mut().zip(&record) {
            let value = number(cell, separator);
            if value.is_none() && named.contains(&name.as_str()) {
                let what = format!("`{cell}` in the column `{name}` is no number");
                return Err(StudyError::new(file, Some(line), what, "give a number, or leave the cell empty"));
            }
            column.push(value.unwrap_or(f64::NAN));
        }
        lines.push(line);
    }
    Ok(Table { file: file.to_path_buf(), columns, lines })
}

/// How many lines stand above the head of a table, and the text from the head on; `None` where there is no head.
fn from_the_head(text: &str) -> Option<(usize, &str)> {
    let (mut above, mut rest) = (0, text);
    while !rest.is_empty() {
        let (line, below) = rest.split_once('\n').unwrap_or((rest, ""));
        let is_comment = line.starts_with('#');
        let is_head = match is_comment {
            true => is_head_of(line, below.lines().next().unwrap_or_default()),
            false => !line.trim().is_empty(),
        };
        if is_head {
            return Some((above, rest));
        }
        (above, rest) = (above + 1, below);
    }
    None
}

/// The separator of a line.
fn separator(line: &str) -> char {
    [';', '\t', ','].into_iter().find(|separator| line.contains(*separator)).unwrap_or(',')
}

/// Whether a line that begins with `#` names the columns of the numbers below it.
fn is_head_of(line: &str, below: &str) -> bool {
    let separator = separator(line);
    is_numbers(below, separator) && line.split(separator).count() == below.split(separator).count()
}

/// Whether a line is numbers alone, some of which may be missing.
fn is_numbers(line: &str, separator: char) -> bool {
    let mut cells = line.split(separator).map(|cell| number(cell.trim().trim_matches('"'), separator));
    cells.clone().all(|number| number.is_some()) && cells.any(|number| number.is_some_and(f64::is_finite))
}

/// The number of a cell; NaN when there is no reading, `None` when it is something else.
fn number(cell: &str, separator: char) -> Option<f64> {
    if ["", "nan", "na", "n/a", "null", "none", "-"].contains(&cell.to_ascii_lowercase().as_str()) {
        return Some(f64::NAN);
    }
    let point = if separator == ';' { cell.replace(',', ".") } else { cell.to_owned() };
    point.parse::<f64>().ok().filter(|number| number.is_finite())
}

fn read_parquet(file: &Path) -> Result<Table, StudyError> {
    let opened = std::fs::File::open(file).map_err(|error| unreadable(file, error))?;
    let reader = SerializedFileReader::new(opened).map_err(|error| unreadable(file, error))?;
    let rows = reader.get_row_iter(None).map_err(|error| unreadable(file, error))?;
    let (mut columns, mut lines): (Vec<(String, Vec<f64>)>, Vec<usize>) = (Vec::new(), Vec::new());
    for (place, row) in rows.enumerate() {
        let row = row.map_err(|error| unreadable(file, error))?;
        for (column, (name, field)) in row.get_column_iter().enumerate() {
            if place == 0 {
                columns.push((name.clone(), Vec::new()));
            }
            let value = match field {
                Field::Double(value) => *value,
                Field::Float(value) => f64::from(*value),
                Field::Int(value) => f64::from(*value),
                Field::Long(value) => *value as f64,
                // Columns may hold words, such as events and names. They are no readings.
                _ => f64::NAN,
            };
            columns[column].1.push(if value.is_finite() { value } else { f64::NAN });
        }
        lines.push(place + 1);
    }
    Ok(Table { file: file.to_path_buf(), columns, lines })
}
