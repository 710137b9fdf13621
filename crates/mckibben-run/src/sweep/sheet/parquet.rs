//! A table as Parquet, compressed with Zstandard.
//!
//! Its footer holds a checksum of the whole file. Lines are gathered into row groups of a fixed number, so the bytes depend on
//! the lines alone and not on how they came.

use super::sealed::{CHECKSUM, Sealed, UNKNOWN};
use super::{Sheet, Sink};
use crate::failure::Failure;
use crate::sweep::table::{Cell, Column, Kind};
use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical, ZstdLevel};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::{Type, TypePtr};
use std::path::PathBuf;
use std::sync::Arc;

/// Lines of a row group: what is held in memory at a time.
const GROUP: usize = 1 << 16;

pub(super) struct ParquetSheet<W: Sink> {
    path: PathBuf,
    writer: SerializedFileWriter<Sealed<W>>,
    buffers: Vec<Buffer>,
    lines: usize,
}

/// The cells of a column that wait to be written.
#[derive(Debug)]
struct Buffer {
    values: Values,
    /// For each line whether it has a value, where it may have none.
    present: Option<Vec<i16>>,
}

#[derive(Debug)]
enum Values {
    Counts(Vec<i64>),
    Numbers(Vec<f64>),
    Words(Vec<ByteArray>),
}

impl<W: Sink> std::fmt::Debug for ParquetSheet<W> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ParquetSheet").field("path", &self.path).field("lines", &self.lines).finish_non_exhaustive()
    }
}

impl<W: Sink> ParquetSheet<W> {
    pub(super) fn begin(columns: &[Column], file: W) -> Result<Self, Failure> {
        let path = file.path().to_owned();
        let failed = |error: ParquetError| Failure::output(&path, error);
        let properties = WriterProperties::builder()
            .set_compression(Compression::ZSTD(ZstdLevel::default()))
            .set_created_by(format!("mckibben {}", env!("CARGO_PKG_VERSION")))
            .build();
        let schema = schema(columns).map_err(failed)?;
        let writer = SerializedFileWriter::new(Sealed::new(file), schema, Arc::new(properties)).map_err(failed)?;
        let buffers = columns.iter().map(Buffer::new).collect();
        Ok(Self { path, writer, buffers, lines: 0 })
    }

    fn flush(&mut self) -> Result<(), Failure> {
        if self.lines > 0 {
            self.lines = 0;
            write_group(&mut self.writer, &mut self.buffers).map_err(|error| Failure::output(&self.path, error))?;
        }
        Ok(())
    }
}

impl<W: Sink> Sheet for ParquetSheet<W> {
    fn line(&mut self, cells: &[Cell<'_>]) -> Result<(), Failure> {
        for (buffer, cell) in self.buffers.iter_mut().zip(cells) {
            buffer.push(cell);
        }
        self.lines += 1;
        if self.lines == GROUP { self.flush() } else { Ok(()) }
    }

    fn finish(mut self: Box<Self>, notes: &[(String, String)]) -> Result<(), Failure> {
        self.flush()?;
        let Self { path, mut writer, .. } = *self;
        for (key, value) in notes {
            writer.append_key_value_metadata(KeyValue::new(key.clone(), value.clone()));
        }
        writer.append_key_value_metadata(KeyValue::new(CHECKSUM.to_owned(), UNKNOWN.to_owned()));
        writer.flush().map_err(|error| Failure::output(&path, error))?;
        writer.inner_mut().begin_end();
        writer.into_inner().map_err(|error| Failure::output(&path, error))?.commit(&path)
    }
}

impl Buffer {
    fn new(column: &Column) -> Self {
        let values = match column.kind {
            Kind::Count => Values::Counts(Vec::new()),
            Kind::Number => Values::Numbers(Vec::new()),
            Kind::Word => Values::Words(Vec::new()),
        };
        Self { values, present: column.optional.then(Vec::new) }
    }

    fn push(&mut self, cell: &Cell<'_>) {
        match (&mut self.values, cell) {
            (Values::Counts(values), Cell::Count(count)) => values.push(count.cast_signed()),
            (Values::Numbers(values), Cell::Number(number)) => values.push(*number),
            (Values::Words(values), Cell::Word(word)) => values.push(ByteArray::from(*word)),
            _ => {}
        }
        if let Some(present) = &mut self.present {
            present.push(i16::from(*cell != Cell::Nothing));
        }
    }

    fn clear(&mut self) {
        match &mut self.values {
            Values::Counts(values) => values.clear(),
            Values::Numbers(values) => values.clear(),
            Values::Words(values) => values.clear(),
        }
        self.present.iter_mut().for_each(Vec::clear);
    }
}

fn write_group<W: Sink>(
    writer: &mut SerializedFileWriter<Sealed<W>>,
    buffers: &mut [Buffer],
) -> Result<(), ParquetError> {
    let mut group = writer.next_row_group()?;
    for buffer in buffers {
        if let Some(mut column) = group.next_column()? {
            let present = buffer.present.as_deref();
            match &buffer.values {
                Values::Counts(values) => column.typed::<Int64Type>().write_batch(values, present, None)?,
                Values::Numbers(values) => column.typed::<DoubleType>().write_batch(values, present, None)?,
                Values::Words(values) => column.typed::<ByteArrayType>().write_batch(values, present, None)?,
            };
            column.close()?;
        }
        buffer.clear();
    }
    group.close()?;
    Ok(())
}

fn schema(columns: &[Column]) -> Result<TypePtr, ParquetError> {
    let mut fields = Vec::new();
    for column in columns {
        let (physical, logical) = match column.kind {
            Kind::Count => (Physical::INT64, Some(LogicalType::integer(64, false))),
            Kind::Number => (Physical::DOUBLE, None),
            Kind::Word => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
        };
        let repetition = if column.optional { Repetition::OPTIONAL } else { Repetition::REQUIRED };
        let field = Type::primitive_type_builder(&column.name, physical).with_repetition(repetition);
        fields.push(Arc::new(field.with_logical_type(logical).build()?));
    }
    Ok(Arc::new(Type::group_type_builder("sweep").with_fields(fields).build()?))
}
