//! Tables that are written and read back.

use super::*;
use crate::output::Pending;
use ::parquet::file::reader::{FileReader as _, SerializedFileReader};
use ::parquet::record::Field;
use std::fs::File;

const SEALED: Layout = Layout { schema: "test", group: 2, sealed: true };

/// Every kind of column, and names that CSV must quote.
fn columns() -> Vec<Column> {
    vec![
        Column::count("run"),
        Column::number("load, \"mass\"", "kg"),
        Column::number("angle_rad", "rad").optional(),
        Column::word("valve"),
        Column::word("error").optional(),
    ]
}

/// Numbers that lose digits or their sign where they are not written with care, and words that must be quoted or are empty.
fn rows() -> Vec<[Cell<'static>; 5]> {
    use Cell::{Count, Nothing, Number, Word};
    vec![
        [Count(0), Number(0.1 + 0.2), Nothing, Word(""), Nothing],
        [Count(1), Number(-0.0), Number(f64::MIN_POSITIVE / 8.0), Word("a, b"), Word("")],
        [Count(u64::MAX), Number(f64::MAX), Nothing, Word("say \"no\""), Word("two\nlines")],
        [Count(1 << 53), Number(1e-7), Number(5e-324), Word("ü"), Nothing],
        [Count(4), Number(1e22), Number(-1.0 / 3.0), Word("exhaust"), Word("late")],
    ]
}

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("mckibben-table-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn written(format: Format) -> Vec<u8> {
    let mut writer = Writer::begin(format, columns(), SEALED, Path::new("test"), Vec::new()).unwrap();
    rows().iter().for_each(|row| writer.row(row).unwrap());
    writer.finish(&[("key".to_owned(), "value".to_owned())]).unwrap()
}

#[test]
fn csv_gives_every_cell_back_to_the_bit() {
    let bytes = written(Format::Csv);
    let head = "run,\"load, \"\"mass\"\"\",angle_rad,valve,error\n0,0.30000000000000004,,,\n1,-0.0,";
    assert!(bytes.starts_with(head.as_bytes()), "{}", String::from_utf8_lossy(&bytes));
    let mut reader = ::csv::Reader::from_reader(bytes.as_slice());
    let names: Vec<String> = columns().into_iter().map(|column| column.name).collect();
    assert_eq!(reader.headers().unwrap(), names);
    let found: Vec<_> = reader.records().map(|record| record.unwrap()).collect();
    assert_eq!(found.len(), rows().len());
    for (row, record) in rows().iter().zip(&found) {
        for (cell, field) in row.iter().zip(record) {
            match cell {
                Cell::Count(count) => assert_eq!(field.parse(), Ok(*count)),
                Cell::Number(number) => assert_eq!(field.parse::<f64>().unwrap().to_bits(), number.to_bits()),
                Cell::Word(word) => assert_eq!(field, *word),
                Cell::Nothing => assert_eq!(field, ""),
            }
        }
    }
}

#[test]
fn parquet_gives_every_cell_back_to_the_bit_in_groups_of_rows_under_a_checksum() {
    let folder = folder("parquet");
    let path = folder.join("test.parquet");
    std::fs::write(&path, written(Format::Parquet)).unwrap();
    assert_eq!(seal(&mut File::open(&path).unwrap()).unwrap(), Seal::Whole);
    let reader = SerializedFileReader::new(File::open(&path).unwrap()).unwrap();
    assert_eq!(reader.num_row_groups(), 3);
    let notes = reader.metadata().file_metadata().key_value_metadata().unwrap();
    assert_eq!((notes[0].key.as_str(), notes[0].value.as_deref()), ("key", Some("value")));
    let found: Vec<_> = reader.get_row_iter(None).unwrap().map(|row| row.unwrap()).collect();
    assert_eq!(found.len(), rows().len());
    for (row, found) in rows().iter().zip(&found) {
        for ((cell, (name, field)), column) in row.iter().zip(found.get_column_iter()).zip(columns()) {
            assert_eq!(*name, column.name);
            match (cell, field) {
                (Cell::Count(count), Field::ULong(found)) => assert_eq!(count, found),
                (Cell::Number(number), Field::Double(found)) => assert_eq!(number.to_bits(), found.to_bits()),
                (Cell::Word(word), Field::Str(found)) => assert_eq!(word, found),
                (Cell::Nothing, Field::Null) => {}
                other => panic!("{name}: {other:?}"),
            }
        }
    }
    std::fs::remove_dir_all(folder).unwrap();
}

/// Read back by SciPy in the tests of the Python package; here what a reader looks at first, and names that MATLAB has not.
#[test]
fn a_mat_file_has_a_header_without_a_date_and_names_of_matlab() {
    let bytes = written(Format::Mat);
    assert!(bytes.starts_with(b"MATLAB 5.0 MAT-file") && &bytes[124..128] == b"\0\x01IM");
    assert_eq!(bytes, written(Format::Mat));
    let has = |name: &[u8]| bytes.windows(name.len()).any(|window| window == name);
    assert!(has(b"load___mass_") && has(b"angle_rad") && has(b"mckibben_units"));
    // Elements fill the file to its last byte.
    let mut at = 128;
    let mut count = 0;
    while at < bytes.len() {
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
        assert_eq!(word(at), 14);
        at += 8 + word(at + 4).next_multiple_of(8);
        count += 1;
    }
    assert_eq!((at, count), (bytes.len(), 7));
    for names in [["a.b", "a_b"], ["a", &"x".repeat(64)]] {
        let columns = names.map(|name| Column::number(name, "")).to_vec();
        let refused = Writer::begin(Format::Mat, columns, SEALED, Path::new("test.mat"), Vec::new()).unwrap_err();
        assert!(refused.to_string().contains(".parquet"), "{refused}");
    }
}

#[test]
fn a_file_without_a_checksum_says_so() {
    let folder = folder("unsealed");
    let path = folder.join("test.parquet");
    let layout = Layout { sealed: false, ..SEALED };
    let file = Pending::create(&path).unwrap();
    let mut writer = Writer::parquet(columns(), layout, &path, file).unwrap();
    rows().iter().for_each(|row| writer.row(row).unwrap());
    writer.finish(&[]).unwrap().commit().unwrap();
    assert_eq!(seal(&mut File::open(&path).unwrap()).unwrap(), Seal::Missing);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_cell_that_is_none_of_its_column_is_refused() {
    let refused = |format, cells: &[Cell<'_>]| {
        let mut writer = Writer::begin(format, columns(), SEALED, Path::new("test"), Vec::new()).unwrap();
        writer.row(&rows()[0]).unwrap();
        writer.row(cells).unwrap_err().to_string()
    };
    for format in [Format::Csv, Format::Parquet, Format::Mat] {
        let with = |place: usize, cell| {
            let mut row = rows()[0];
            row[place] = cell;
            refused(format, &row)
        };
        assert!(with(1, Cell::Number(f64::NAN)).contains("column load, \"mass\", row 2: NaN"));
        assert!(with(2, Cell::Number(f64::INFINITY)).contains("column angle_rad, row 2: inf"));
        for (place, cell) in [(0, Cell::Number(1.0)), (1, Cell::Nothing), (3, Cell::Nothing), (4, Cell::Count(1))] {
            assert!(with(place, cell).contains("is no cell of it"), "{place}");
        }
        assert!(refused(format, &rows()[0][..4]).contains("row 2 has 4 cells for 5 columns"));
    }
}

#[test]
fn an_older_file_stays_whole_when_writing_fails() {
    let folder = folder("older");
    for (name, format) in [("run.csv", Format::Csv), ("run.parquet", Format::Parquet), ("run.mat", Format::Mat)] {
        let path = folder.join(name);
        std::fs::write(&path, "old").unwrap();
        let mut writer = Writer::begin(format, columns(), SEALED, &path, Pending::create(&path).unwrap()).unwrap();
        rows().iter().for_each(|row| writer.row(row).unwrap());
        writer.row(&[Cell::Nothing; 5]).unwrap_err();
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        drop(writer);
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
    }
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 3);
    std::fs::remove_dir_all(folder).unwrap();
}
