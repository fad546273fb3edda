//! Apache Parquet. Rows are gathered into columns and written in row groups of [`GROUP_ROWS`], so that memory stays
//! constant however long a trace is.

use super::atomic::PartFile;
use super::sink::Sink;
use crate::table::{Cell, Column, Kind, Shape};
use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::Type;
use std::io;
use std::sync::Arc;

/// Rows of one row group.
const GROUP_ROWS: usize = 65_536;

/// The values of one column since the last row group. Texts and numbers can be missing: `present` holds 1 or 0 per row
/// (Parquet's definition level), the values only those that are there.
enum Gathered {
    Text { values: Vec<ByteArray>, present: Vec<i16> },
    Number { values: Vec<f64>, present: Vec<i16> },
    Count(Vec<i64>),
    Flag(Vec<bool>),
}

struct ParquetSink {
    writer: SerializedFileWriter<PartFile>,
    columns: Vec<Gathered>,
    rows: usize,
}

/// Writes the head of the file.
pub(super) fn open(file: PartFile, shape: &Shape) -> io::Result<Box<dyn Sink>> {
    let fields = shape.columns.iter().map(field).collect::<Result<Vec<_>, _>>();
    let schema = fields.and_then(|fields| Type::group_type_builder(shape.table).with_fields(fields).build());
    let properties = WriterProperties::builder().set_compression(Compression::SNAPPY).build();
    let writer = schema
        .and_then(|schema| SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties)))
        .map_err(to_io)?;
    Ok(Box::new(ParquetSink { writer, columns: shape.columns.iter().map(gathered).collect(), rows: 0 }))
}

fn field(column: &Column) -> Result<Arc<Type>, ParquetError> {
    let (physical, repetition, logical) = match column.kind {
        Kind::Text => (Physical::BYTE_ARRAY, Repetition::OPTIONAL, Some(LogicalType::String)),
        Kind::Number => (Physical::DOUBLE, Repetition::OPTIONAL, None),
        Kind::Count => (Physical::INT64, Repetition::REQUIRED, None),
        Kind::Flag => (Physical::BOOLEAN, Repetition::REQUIRED, None),
    };
    let builder = Type::primitive_type_builder(&column.name, physical).with_repetition(repetition);
    builder.with_logical_type(logical).build().map(Arc::new)
}

fn gathered(column: &Column) -> Gathered {
    match column.kind {
        Kind::Text => Gathered::Text { values: Vec::new(), present: Vec::new() },
        Kind::Number => Gathered::Number { values: Vec::new(), present: Vec::new() },
        Kind::Count => Gathered::Count(Vec::new()),
        Kind::Flag => Gathered::Flag(Vec::new()),
    }
}

/// The system's own error (disk full) where there is one behind the format's.
fn to_io(error: ParquetError) -> io::Error {
    match error {
        ParquetError::External(source) => match source.downcast::<io::Error>() {
            Ok(source) => *source,
            Err(other) => io::Error::other(other),
        },
        other => io::Error::other(other),
    }
}

impl Sink for ParquetSink {
    fn row(&mut self, cells: &mut dyn Iterator<Item = Cell<'_>>) -> io::Result<()> {
        for (column, cell) in self.columns.iter_mut().zip(cells) {
            match (column, cell) {
                (Gathered::Text { values, present }, Cell::Text(value)) => {
                    present.push(value.is_some().into());
                    values.extend(value.map(ByteArray::from));
                }
                (Gathered::Number { values, present }, Cell::Number(value)) => {
                    present.push(value.is_some().into());
                    values.extend(value);
                }
                (Gathered::Count(values), Cell::Count(value)) => {
                    values.push(value.try_into().map_err(io::Error::other)?);
                }
                (Gathered::Flag(values), Cell::Flag(value)) => values.push(value),
                _ => return Err(io::Error::other("the kind of a column changed")),
            }
        }
        self.rows += 1;
        if self.rows < GROUP_ROWS { Ok(()) } else { self.write_group().map_err(to_io) }
    }

    fn end(mut self: Box<Self>) -> io::Result<PartFile> {
        self.write_group().and_then(|()| self.writer.into_inner()).map_err(to_io)
    }
}

impl ParquetSink {
    fn write_group(&mut self) -> Result<(), ParquetError> {
        if self.rows == 0 {
            return Ok(());
        }
        self.rows = 0;
        let mut group = self.writer.next_row_group()?;
        for column in &mut self.columns {
            let Some(mut writer) = group.next_column()? else { break };
            match column {
                Gathered::Text { values, present } => flush::<ByteArrayType>(&mut writer, values, Some(present))?,
                Gathered::Number { values, present } => flush::<DoubleType>(&mut writer, values, Some(present))?,
                Gathered::Count(values) => flush::<Int64Type>(&mut writer, values, None)?,
                Gathered::Flag(values) => flush::<BoolType>(&mut writer, values, None)?,
            }
            writer.close()?;
        }
        group.close().map(drop)
    }
}

/// Writes what was gathered and empties it.
fn flush<T: DataType>(
    writer: &mut SerializedColumnWriter<'_>,
    values: &mut Vec<T::T>,
    present: Option<&mut Vec<i16>>,
) -> Result<(), ParquetError> {
    writer.typed::<T>().write_batch(values, present.as_ref().map(|levels| levels.as_slice()), None)?;
    values.clear();
    present.into_iter().for_each(Vec::clear);
    Ok(())
}
