//! A table as a MAT-file of level 5, which MATLAB, Octave and SciPy read: a variable for each column.
//!
//! Numbers are column vectors, words are cell arrays; where a row has nothing stands NaN or an empty text. A name becomes a name of
//! MATLAB: what is no letter, digit or underscore becomes an underscore, as in `flexor_length_m`. Notes are texts.
//!
//! A MAT-file says in front of each variable how long it is, so columns are kept until all rows are there. The header has no date:
//! equal tables have equal bytes. The crates that write such files stamp them with the time or want a path in place of a writer.
//!
//! Source: The MathWorks, "MAT-File Format", R2024b, chapter 1 (level 5).

use super::{Cell, Column, Kind};
use std::io::{Error, ErrorKind, Result, Write};

/// Types of elements.
const INT8: u32 = 1;
const UINT16: u32 = 4;
const INT32: u32 = 5;
const UINT32: u32 = 6;
const DOUBLE: u32 = 9;
const MATRIX: u32 = 14;
/// Classes of arrays.
const CELLS: u32 = 1;
const TEXT: u32 = 4;
const NUMBERS: u32 = 6;
/// Longest name of a variable.
const LONGEST_NAME: usize = 63;
/// Most bytes of a variable.
const MOST_BYTES: usize = 1 << 31;

pub(super) struct Rows<W: Write> {
    sink: W,
    columns: Vec<(String, Values)>,
}

enum Values {
    Numbers(Vec<f64>),
    Words(Vec<String>),
}

impl<W: Write> Rows<W> {
    pub(super) fn begin(columns: &[Column], sink: W) -> Result<Self> {
        let mut named: Vec<(String, Values)> = Vec::with_capacity(columns.len());
        for column in columns {
            let name = variable(&column.name);
            if name.len() > LONGEST_NAME || named.iter().any(|(known, _)| *known == name) {
                let reason = if name.len() > LONGEST_NAME { "is longer than 63 characters" } else { "stands twice" };
                return Err(refused(&format!("the name `{name}` of a column {reason}")));
            }
            let values = match column.kind {
                Kind::Count | Kind::Number => Values::Numbers(Vec::new()),
                Kind::Word => Values::Words(Vec::new()),
            };
            named.push((name, values));
        }
        Ok(Self { sink, columns: named })
    }

    pub(super) fn row(&mut self, cells: &[Cell<'_>]) -> Result<()> {
        for ((name, values), cell) in self.columns.iter_mut().zip(cells) {
            match (&mut *values, *cell) {
                (Values::Numbers(numbers), Cell::Number(number)) => numbers.push(number),
                (Values::Numbers(numbers), Cell::Count(count)) => numbers.push(count as f64),
                (Values::Numbers(numbers), _) => numbers.push(f64::NAN),
                (Values::Words(words), Cell::Word(word)) => words.push(word.to_owned()),
                (Values::Words(words), _) => words.push(String::new()),
            }
            if matches!(values, Values::Numbers(numbers) if 8 * numbers.len() >= MOST_BYTES) {
                return Err(refused(&format!("`{name}` has more rows than a variable may have")));
            }
        }
        Ok(())
    }

    pub(super) fn finish(self, notes: &[(String, String)]) -> Result<W> {
        let Self { mut sink, columns } = self;
        let mut header = [b' '; 128];
        let about = b"MATLAB 5.0 MAT-file, written by mckibben";
        header[..about.len()].copy_from_slice(about);
        header[116..124].fill(0);
        header[124..126].copy_from_slice(&0x0100_u16.to_le_bytes());
        header[126..128].copy_from_slice(b"IM");
        sink.write_all(&header)?;
        for (name, values) in columns {
            let array = match values {
                Values::Numbers(numbers) => of_numbers(&name, &numbers),
                Values::Words(words) => of_words(&name, &words),
            };
            sink.write_all(&whole(array)?)?;
        }
        for (key, value) in notes {
            sink.write_all(&whole(of_text(&variable(key), value))?)?;
        }
        Ok(sink)
    }
}

fn refused(what: &str) -> Error {
    Error::new(ErrorKind::InvalidInput, format!("{what}; a MAT-file cannot hold that, so write .parquet or .csv"))
}

/// The name of a variable.
fn variable(name: &str) -> String {
    let plain: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if plain.starts_with(|c: char| c.is_ascii_alphabetic()) { plain } else { format!("x{plain}") }
}

/// An element: type, length, data, and zeros up to the next eighth byte.
fn element(kind: u32, data: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(data.len() + 16);
    bytes.extend(kind.to_le_bytes());
    bytes.extend((data.len() as u32).to_le_bytes());
    bytes.extend(data);
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    bytes
}

/// An array as an element, where it is not too long for one.
fn whole(array: Vec<u8>) -> Result<Vec<u8>> {
    if array.len() >= MOST_BYTES { Err(refused("a column is longer than 2 GB")) } else { Ok(element(MATRIX, &array)) }
}

/// What stands before the data of an array.
fn head(class: u32, [rows, columns]: [usize; 2], name: &str) -> Vec<u8> {
    let flags: Vec<u8> = [class, 0].into_iter().flat_map(u32::to_le_bytes).collect();
    let dimensions: Vec<u8> = [rows as u32, columns as u32].into_iter().flat_map(u32::to_le_bytes).collect();
    [element(UINT32, &flags), element(INT32, &dimensions), element(INT8, name.as_bytes())].concat()
}

fn of_numbers(name: &str, numbers: &[f64]) -> Vec<u8> {
    let data: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
    [head(NUMBERS, [numbers.len(), 1], name), element(DOUBLE, &data)].concat()
}

fn of_text(name: &str, text: &str) -> Vec<u8> {
    let data: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
    [head(TEXT, [usize::from(!data.is_empty()), data.len() / 2], name), element(UINT16, &data)].concat()
}

fn of_words(name: &str, words: &[String]) -> Vec<u8> {
    let mut bytes = head(CELLS, [words.len(), 1], name);
    words.iter().for_each(|word| bytes.extend(element(MATRIX, &of_text("", word))));
    bytes
}
