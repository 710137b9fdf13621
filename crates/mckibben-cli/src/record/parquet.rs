//! A run as Parquet: columns of 64-bit floating-point numbers and one of words, compressed with Zstandard.
//!
//! | key of the metadata | value |
//! |---|---|
//! | `mckibben.version` | version of this program |
//! | `mckibben.units` | JSON: the unit of each column |
//! | `mckibben.scenario_file` | name of the scenario file |
//! | `mckibben.scenario` | its text |
//! | `mckibben.set` | JSON: what was set on the command line beside it |
//! | `mckibben.resolved` | the scenario as it was understood: every value in SI, no preset, no default |
//!
//! Nothing in a file depends on the clock or the machine: the same run gives the same bytes.

use super::{COLUMNS, Provenance, VALVE};
use crate::engine::Outcome;
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

pub(super) fn write(
    outcome: &Outcome<'_>,
    interval: f64,
    provenance: &Provenance<'_>,
    path: &Path,
    out: &mut (dyn Write + Send),
) -> Result<(), Failure> {
    let failed = |error: ParquetError| Failure::output(path, error);
    let properties = WriterProperties::builder()
        .set_compression(Compression::ZSTD(ZstdLevel::default()))
        .set_created_by(format!("mckibben {}", env!("CARGO_PKG_VERSION")))
        .set_key_value_metadata(Some(metadata(provenance)))
        .build();
    let schema = schema().map_err(failed)?;
    let mut writer = SerializedFileWriter::new(out, schema, Arc::new(properties)).map_err(failed)?;
    let mut group = Group::default();
    outcome.each_sample(interval, &mut |sample| {
        for (column, values) in COLUMNS.iter().zip(&mut group.numbers) {
            values.push((column.value)(sample));
        }
        group.words.push(ByteArray::from(sample.ports.name()));
        if group.words.len() == GROUP { group.flush(&mut writer).map_err(failed) } else { Ok(()) }
    })?;
    group.flush(&mut writer).map_err(failed)?;
    writer.close().map_err(failed)?;
    Ok(())
}

/// Rows that wait to be written.
#[derive(Debug, Default)]
struct Group {
    numbers: [Vec<f64>; COLUMNS.len()],
    words: Vec<ByteArray>,
}

impl Group {
    fn flush<W: Write + Send>(&mut self, writer: &mut SerializedFileWriter<W>) -> Result<(), ParquetError> {
        if self.words.is_empty() {
            return Ok(());
        }
        let mut group = writer.next_row_group()?;
        for values in &mut self.numbers {
            if let Some(mut column) = group.next_column()? {
                column.typed::<DoubleType>().write_batch(values, None, None)?;
                column.close()?;
            }
            values.clear();
        }
        if let Some(mut column) = group.next_column()? {
            column.typed::<ByteArrayType>().write_batch(&self.words, None, None)?;
            column.close()?;
        }
        self.words.clear();
        group.close()?;
        Ok(())
    }
}

fn schema() -> Result<TypePtr, ParquetError> {
    let required = |name, physical| Type::primitive_type_builder(name, physical).with_repetition(Repetition::REQUIRED);
    let mut fields = Vec::new();
    for column in &COLUMNS {
        fields.push(Arc::new(required(column.name, Physical::DOUBLE).build()?));
    }
    let words = required(VALVE, Physical::BYTE_ARRAY).with_logical_type(Some(LogicalType::String)).build()?;
    fields.push(Arc::new(words));
    Ok(Arc::new(Type::group_type_builder("run").with_fields(fields).build()?))
}

fn metadata(provenance: &Provenance<'_>) -> Vec<KeyValue> {
    let units: serde_json::Map<String, serde_json::Value> =
        COLUMNS.iter().map(|column| (column.name.to_owned(), column.unit.into())).collect();
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
        ("mckibben.resolved", provenance.scenario.to_toml()),
    ];
    pairs.into_iter().map(|(key, value)| KeyValue::new(key.to_owned(), value)).collect()
}
