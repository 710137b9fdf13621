//! A whole run of a scenario as columns.
//!
//! Checked by `tests/interface/simulation.rs`: the columns are those of [`Finished::columns`](mckibben_run::run::Finished::columns).

use crate::memory::{array_mut, reference, write};
use crate::plant::{document_at, document_of, entry};
use crate::status::{Refusal, Status, c_text, status, value};
use mckibben_run::record::{Filled, Values};
use mckibben_run::run::Ready;
use mckibben_run::settle::End;
use mckibben_scenario::Document;
use std::ffi::{CString, c_char, c_void};

/// Is called with the time in s that a run has reached, now and then, and the caller's `data`. A result other than 0 ends the run.
/// It must not throw an exception.
pub type Progress = Option<unsafe extern "C" fn(time: f64, data: *mut c_void) -> i32>;

/// A column of a run.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct ColumnInfo {
    /// Name with the unit at its end, such as "absolute_pressure_pa".
    pub name: *const c_char,
    /// SI unit, such as "Pa"; empty of words.
    pub unit: *const c_char,
    /// 0 where the column has numbers, 1 where it has words.
    pub has_words: i32,
}

/// A finished run: columns with a row at t = 0, at every sample interval of the scenario, and at the end.
#[derive(Debug)]
pub struct Run {
    rows: usize,
    columns: Vec<Column>,
}

#[derive(Debug)]
struct Column {
    name: CString,
    unit: CString,
    content: Content,
}

#[derive(Debug)]
enum Content {
    Numbers(Vec<f64>),
    /// Each word once, and which of them stands in each row.
    Words(Vec<CString>, Vec<usize>),
}

impl From<Filled> for Column {
    fn from(Filled { name, unit, values }: Filled) -> Self {
        let content = match values {
            Values::Numbers(numbers) => Content::Numbers(numbers),
            Values::Words(words) => {
                let mut known: Vec<&str> = Vec::new();
                let place = |word: &'static str| {
                    known.iter().position(|its| *its == word).unwrap_or_else(|| {
                        known.push(word);
                        known.len() - 1
                    })
                };
                let rows = words.into_iter().map(place).collect();
                Content::Words(known.into_iter().map(c_text).collect(), rows)
            }
        };
        Self { name: c_text(&name), unit: c_text(&unit), content }
    }
}

impl Column {
    fn len(&self) -> usize {
        match &self.content {
            Content::Numbers(numbers) => numbers.len(),
            Content::Words(_, rows) => rows.len(),
        }
    }
}

/// Runs a scenario and hands the run over.
///
/// # Safety
/// As the crate's documentation says of `run`; `progress` is a function or none.
unsafe fn simulate(
    document: impl FnOnce() -> Result<Document, Refusal>,
    (progress, data): (Progress, *mut c_void),
    run: *mut *mut Run,
) -> Result<(), Refusal> {
    // SAFETY: memory for a pointer, by the caller's promise.
    unsafe { write(run, "run", std::ptr::null_mut()) }?;
    let document = document()?;
    let mut reached = |time: f64| match progress {
        // SAFETY: a function of this type, by the caller's promise.
        Some(progress) if unsafe { progress(time, data) } != 0 => Err(mckibben::Error::Interrupted { time }),
        _ => Ok(()),
    };
    let (finished, _) = Ready::of(&document)?.run(&document, End::Duration, &mut reached)?;
    let columns: Vec<Column> = finished.columns()?.into_iter().map(Column::from).collect();
    let rows = columns.first().map_or(0, Column::len);
    // SAFETY: as at the head.
    unsafe { write(run, "run", Box::into_raw(Box::new(Run { rows, columns }))) }
}

/// Runs a scenario from its text in TOML to its end, with its own commands and controllers. `name` stands for a file's name in
/// messages; NULL for "scenario.toml". `progress` may be NULL. On success `*run` is to be freed by `mckibben_run_free`; otherwise
/// it is NULL. Warnings, events and the energy ledger of a run are not in this interface: `mckibben simulate` and Python have them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_simulate_text(
    text: *const c_char,
    name: *const c_char,
    progress: Progress,
    data: *mut c_void,
    run: *mut *mut Run,
) -> Status {
    status(|| {
        // SAFETY: the caller's promise.
        unsafe { simulate(|| document_of(text, name), (progress, data), run) }
    })
}

/// Runs a scenario from a file, whose path is UTF-8; otherwise as `mckibben_simulate_text`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_simulate_file(
    path: *const c_char,
    progress: Progress,
    data: *mut c_void,
    run: *mut *mut Run,
) -> Status {
    status(|| {
        // SAFETY: the caller's promise.
        unsafe { simulate(|| document_at(path), (progress, data), run) }
    })
}

/// Frees a run, with the texts that it has handed out. NULL is no mistake. A run that has been freed must not be given: that cannot
/// be checked.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_run_free(run: *mut Run) {
    value((), || {
        if !run.is_null() {
            // SAFETY: it was made by `Box::into_raw` here and has not been freed, by the caller's promise.
            drop(unsafe { Box::from_raw(run) });
        }
        Ok(())
    });
}

/// Returns how many rows each column of a run has; 0 for NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_run_row_count(run: *const Run) -> usize {
    value(0, || {
        // SAFETY: the caller's promise.
        unsafe { reference(run, "run") }.map(|run| run.rows)
    })
}

/// Returns how many columns a run has; 0 for NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_run_column_count(run: *const Run) -> usize {
    value(0, || {
        // SAFETY: the caller's promise.
        unsafe { reference(run, "run") }.map(|run| run.columns.len())
    })
}

/// Writes what a column of a run is, counted from 0. Its texts are valid while the run lives.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_run_column_describe(run: *const Run, column: usize, info: *mut ColumnInfo) -> Status {
    status(|| {
        // SAFETY: the caller's promise.
        let run = unsafe { reference(run, "run") }?;
        let Column { name, unit, content } = entry(&run.columns, column, "column")?;
        let has_words = i32::from(matches!(content, Content::Words(..)));
        // SAFETY: the caller's promise.
        unsafe { write(info, "info", ColumnInfo { name: name.as_ptr(), unit: unit.as_ptr(), has_words }) }
    })
}

/// Writes the numbers of a column of a run, in SI units: `count` of them, one for each row.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_run_column(
    run: *const Run,
    column: usize,
    numbers: *mut f64,
    count: usize,
) -> Status {
    status(|| {
        // SAFETY: the caller's promise.
        let run = unsafe { reference(run, "run") }?;
        let Content::Numbers(own) = &entry(&run.columns, column, "column")?.content else {
            return Err(Refusal::input(format!("column {column} has words"), "read it by mckibben_run_word"));
        };
        if count != run.rows {
            return Err(Refusal::count("numbers", count, run.rows, "mckibben_run_row_count"));
        }
        // SAFETY: the caller's promise.
        unsafe { array_mut(numbers, count, "numbers") }?.copy_from_slice(own);
        Ok(())
    })
}

/// Returns the word in a column and a row of a run, such as the length regime "taut"; NULL where there is none. Valid while the
/// run lives.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mckibben_run_word(run: *const Run, column: usize, row: usize) -> *const c_char {
    value(std::ptr::null(), || {
        // SAFETY: the caller's promise.
        let run = unsafe { reference(run, "run") }?;
        let Content::Words(words, rows) = &entry(&run.columns, column, "column")?.content else {
            return Err(Refusal::input(format!("column {column} has numbers"), "read it by mckibben_run_column"));
        };
        let word = *entry(rows, row, "row")?;
        entry(words, word, "word").map(|word| word.as_ptr())
    })
}
