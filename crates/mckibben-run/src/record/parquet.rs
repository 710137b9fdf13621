//! A run as Parquet: columns of 64-bit floating-point numbers and one of words, compressed with Zstandard.
//!
//! | key of the metadata | value |
//! |---|---|
//! | `mckibben.version` | version of this program |
//! | `mckibben.units` | JSON: the unit of each column |
//! | `mckibben.scenario_file` | name of the scenario file |
//! | `mckibben.scenario` | its text |
//! | `mckibben.set` | JSON: what was set on the command line beside it |
//! | `mckibben.resolved` | the scenario as it was understood: every value in SI, no preset, no default; not of a plant |
//!
//! Nothing in a file depends on the clock or the machine: the same run gives the same bytes.

use super::field::{Field, Value};
use super::{Provenance, Rows};
use crate::failure::Failure;
use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical, ZstdLevel};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::{Type, TypePtr};
use std::io::Write;
use std::path::Path;
use std::sync::Arc;

/// Rows of a row group: what is held in memory at a time.
const GROUP: usize = 1 << 17;

pub(super) fn write<S>(
    fields: &[Field<S>],
    rows: Rows<'_, S>,
    provenance: &Provenance<'_>,
    path: &Path,
    out: &mut (dyn Write + Send),
) -> Result<(), Failure> {
    let failed = |error: ParquetError| Failure::output(path, error);
    let properties = WriterProperties::builder()
        .set_compression(Compression::ZSTD(ZstdLevel::default()))
        .set_created_by(format!("mckibben {}", env!("CARGO_PKG_VERSION")))
        .set_key_value_metadata(Some(metadata(fields, provenance)))
        .build();
    let schema = schema(fields).map_err(failed)?;
    let mut writer = SerializedFileWriter::new(out, schema, Arc::new(properties)).map_err(failed)?;
    let (mut group, mut row) = (Group::of(fields), 0);
    rows(&mut |sample| {
        row += 1;
        group.push(fields, sample, row)?;
        if group.rows == GROUP { group.flush(&mut writer).map_err(failed) } else { Ok(()) }
    })?;
    group.flush(&mut writer).map_err(failed)?;
    writer.close().map_err(failed)?;
    Ok(())
}

/// Rows that wait to be written, column by column.
struct Group {
    rows: usize,
    columns: Vec<Waiting>,
}

enum Waiting {
    Numbers(Vec<f64>),
    Words(Vec<ByteArray>),
}

impl Group {
    fn of<S>(fields: &[Field<S>]) -> Self {
        let columns = fields.iter().map(|field| match field.value {
            Value::Number(_) => Waiting::Numbers(Vec::new()),
            Value::Word(_) => Waiting::Words(Vec::new()),
        });
        Self { rows: 0, columns: columns.collect() }
    }

    fn push<S>(&mut self, fields: &[Field<S>], sample: &S, row: u64) -> Result<(), Failure> {
        self.rows += 1;
        for (field, column) in fields.iter().zip(&mut self.columns) {
            match (&field.value, column) {
                (Value::Number(value), Waiting::Numbers(numbers)) => numbers.push(field.finite(value(sample), row)?),
                (Value::Word(value), Waiting::Words(words)) => words.push(ByteArray::from(value(sample))),
                // The columns were made from the fields.
                _ => {}
            }
        }
        Ok(())
    }

    fn flush<W: Write + Send>(&mut self, writer: &mut SerializedFileWriter<W>) -> Result<(), ParquetError> {
        if self.rows == 0 {
            return Ok(());
        }
        let mut group = writer.next_row_group()?;
        for waiting in &mut self.columns {
            let Some(mut column) = group.next_column()? else { continue };
            match waiting {
                Waiting::Numbers(values) => {
                    column.typed::<DoubleType>().write_batch(values, None, None)?;
                    values.clear();
                }
                Waiting::Words(values) => {
                    column.typed::<ByteArrayType>().write_batch(values, None, None)?;
                    values.clear();
                }
            }
            column.close()?;
        }
        self.rows = 0;
        group.close()?;
        Ok(())
    }
}

fn schema<S>(fields: &[Field<S>]) -> Result<TypePtr, ParquetError> {
    let mut types = Vec::new();
    for field in fields {
        let (physical, logical) = match field.value {
            Value::Number(_) => (Physical::DOUBLE, None),
            Value::Word(_) => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
        };
        let column = Type::primitive_type_builder(&field.name, physical).with_repetition(Repetition::REQUIRED);
        types.push(Arc::new(column.with_logical_type(logical).build()?));
    }
    Ok(Arc::new(Type::group_type_builder("run").with_fields(types).build()?))
}

fn metadata<S>(fields: &[Field<S>], provenance: &Provenance<'_>) -> Vec<KeyValue> {
    let numbers = fields.iter().filter(|field| matches!(field.value, Value::Number(_)));
    let units: serde_json::Map<String, serde_json::Value> =
        numbers.map(|field| (field.name.clone(), field.unit.into())).collect();
    let source = provenance.document.source();
    // Only the file's name: where it lies on the machine is nobody else's business and would change the bytes.
    let name =
        Path::new(source.name()).file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let pairs = [
        ("mckibben.version", env!("CARGO_PKG_VERSION").to_owned()),
        ("mckibben.units", serde_json::Value::Object(units).to_string()),
        ("mckibben.scenario_file", name),
        ("mckibben.scenario", source.text().to_owned()),
        ("mckibben.set", serde_json::Value::from(provenance.set).to_string()),
    ];
    let resolved = provenance.scenario.map(|scenario| ("mckibben.resolved", scenario.to_toml()));
    pairs.into_iter().chain(resolved).map(|(key, value)| KeyValue::new(key.to_owned(), value)).collect()
}
