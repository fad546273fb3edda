//! Apache Parquet. Rows are gathered into columns and written in row groups of [`GROUP_ROWS`], so that memory stays
//! constant however long a trace is.

use super::PartFile;
use super::table::{Cell, Shape, Sink};
use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::column::writer::ColumnWriter;
use parquet::data_type::ByteArray;
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
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
    let fields = shape.columns.iter().map(|(name, kind)| field(name, *kind)).collect::<Result<Vec<_>, _>>();
    let schema = fields.and_then(|fields| Type::group_type_builder(shape.table).with_fields(fields).build());
    let properties = WriterProperties::builder().set_compression(Compression::SNAPPY).build();
    let writer = schema
        .and_then(|schema| SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties)))
        .map_err(to_io)?;
    Ok(Box::new(ParquetSink { writer, columns: shape.columns.iter().map(|(_, kind)| empty(*kind)).collect(), rows: 0 }))
}

fn field(name: &str, kind: Cell<'_>) -> Result<Arc<Type>, ParquetError> {
    let (physical, repetition, logical) = match kind {
        Cell::Text(_) => (Physical::BYTE_ARRAY, Repetition::OPTIONAL, Some(LogicalType::String)),
        Cell::Number(_) => (Physical::DOUBLE, Repetition::OPTIONAL, None),
        Cell::Count(_) => (Physical::INT64, Repetition::REQUIRED, None),
        Cell::Flag(_) => (Physical::BOOLEAN, Repetition::REQUIRED, None),
    };
    let builder = Type::primitive_type_builder(name, physical).with_repetition(repetition);
    builder.with_logical_type(logical).build().map(Arc::new)
}

fn empty(kind: Cell<'_>) -> Gathered {
    match kind {
        Cell::Text(_) => Gathered::Text { values: Vec::new(), present: Vec::new() },
        Cell::Number(_) => Gathered::Number { values: Vec::new(), present: Vec::new() },
        Cell::Count(_) => Gathered::Count(Vec::new()),
        Cell::Flag(_) => Gathered::Flag(Vec::new()),
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
    fn cell(&mut self, column: usize, cell: Cell<'_>) -> io::Result<()> {
        match (&mut self.columns[column], cell) {
            (Gathered::Text { values, present }, Cell::Text(value)) => {
                present.push(value.is_some().into());
                values.extend(value.map(ByteArray::from));
            }
            (Gathered::Number { values, present }, Cell::Number(value)) => {
                present.push(value.is_some().into());
                values.extend(value);
            }
            (Gathered::Count(values), Cell::Count(value)) => values.push(value.try_into().map_err(io::Error::other)?),
            (Gathered::Flag(values), Cell::Flag(value)) => values.push(value),
            _ => return Err(io::Error::other("the kind of a column changed")),
        }
        Ok(())
    }

    fn end_row(&mut self) -> io::Result<()> {
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
            write_column(writer.untyped(), column)?;
            writer.close()?;
        }
        group.close()?;
        Ok(())
    }
}

/// Writes what was gathered and empties it.
fn write_column(writer: &mut ColumnWriter<'_>, column: &mut Gathered) -> Result<(), ParquetError> {
    match (writer, column) {
        (ColumnWriter::ByteArrayColumnWriter(writer), Gathered::Text { values, present }) => {
            writer.write_batch(values, Some(present), None)?;
            values.clear();
            present.clear();
        }
        (ColumnWriter::DoubleColumnWriter(writer), Gathered::Number { values, present }) => {
            writer.write_batch(values, Some(present), None)?;
            values.clear();
            present.clear();
        }
        (ColumnWriter::Int64ColumnWriter(writer), Gathered::Count(values)) => {
            writer.write_batch(values, None, None)?;
            values.clear();
        }
        (ColumnWriter::BoolColumnWriter(writer), Gathered::Flag(values)) => {
            writer.write_batch(values, None, None)?;
            values.clear();
        }
        _ => return Err(ParquetError::General("a column's values are not of its type".into())),
    }
    Ok(())
}
