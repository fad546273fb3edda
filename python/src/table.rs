//! Tables in Arrow's memory layout, handed to other libraries without a copy through the PyCapsule interface
//! (Arrow's documentation, "The Arrow PyCapsule Interface").

use crate::error::plain;
use arrow_array::builder::{BooleanBuilder, Float64Builder, Int64Builder, StringBuilder};
use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::{
    Array, ArrayRef, BooleanArray, Float64Array, Int64Array, RecordBatch, RecordBatchIterator, StringArray,
};
use arrow_schema::{DataType, Field, Schema, SchemaRef, ffi::FFI_ArrowSchema};
use numpy::{PyArray1, PyArrayMethods};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field as Value;
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::{PyCapsule, PyList};
use serde::Deserialize;
use std::collections::{BTreeMap, HashMap};
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A table of a result.
#[pyclass(frozen, module = "sumo_mfc")]
pub struct Table {
    batch: RecordBatch,
}

#[pymethods]
impl Table {
    /// The table as a stream of Arrow's C data interface, for pandas, polars, pyarrow, DuckDB and others.
    #[pyo3(signature = (requested_schema=None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        // Consumers may not rely on it being followed.
        drop(requested_schema);
        let batches = RecordBatchIterator::new([Ok(self.batch.clone())], self.batch.schema());
        PyCapsule::new_with_value(py, FFI_ArrowArrayStream::new(Box::new(batches)), c"arrow_array_stream")
    }

    /// The schema of Arrow's C data interface.
    fn __arrow_c_schema__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyCapsule>> {
        let schema = FFI_ArrowSchema::try_from(&*self.batch.schema()).map_err(plain)?;
        PyCapsule::new_with_value(py, schema, c"arrow_schema")
    }

    fn __len__(&self) -> usize {
        self.batch.num_rows()
    }

    /// The names of the columns, in order.
    #[getter]
    fn columns(&self) -> Vec<String> {
        self.batch.schema().fields().iter().map(|field| field.name().clone()).collect()
    }

    /// Unit and meaning of every column; the unit of texts, counts and ratios is None.
    #[getter]
    fn meanings(&self) -> BTreeMap<String, (Option<String>, String)> {
        let schema = self.batch.schema();
        let told = |field: &Arc<Field>| {
            let metadata = field.metadata();
            (
                field.name().clone(),
                (metadata.get("unit").cloned(), metadata.get("meaning").cloned().unwrap_or_default()),
            )
        };
        schema.fields().iter().map(told).collect()
    }

    /// A column: numbers as a NumPy array of floats with nan where there is no value, flags as one of bools, texts as a list.
    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let column = self
            .batch
            .column_by_name(name)
            .ok_or_else(|| PyKeyError::new_err(format!("{name}: wanted one of {}", self.columns().join(", "))))?;
        let any = column.as_any();
        if let Some(texts) = any.downcast_ref::<StringArray>() {
            return Ok(PyList::new(py, texts.iter())?.into_any());
        }
        if let Some(flags) = any.downcast_ref::<BooleanArray>() {
            return Ok(PyArray1::from_iter(py, flags.iter().map(|flag| flag == Some(true))).into_any());
        }
        let numbers: Vec<f64> = match any.downcast_ref::<Int64Array>() {
            Some(counts) => counts.iter().map(|count| count.map_or(f64::NAN, |count| count as f64)).collect(),
            None => {
                let numbers = any.downcast_ref::<Float64Array>().into_iter().flatten();
                numbers.map(|number| number.unwrap_or(f64::NAN)).collect()
            }
        };
        let array = PyArray1::from_vec(py, numbers);
        array.readwrite().make_nonwriteable();
        Ok(array.into_any())
    }

    fn __repr__(&self) -> String {
        format!("<sumo_mfc.Table of {} rows: {}>", self.batch.num_rows(), self.columns().join(", "))
    }
}

impl Table {
    /// A table of numbers: name, unit, meaning and values of each column.
    pub fn of_numbers(columns: Vec<(&str, &str, &str, Vec<f64>)>) -> PyResult<Self> {
        let fields = columns.iter().map(|(name, unit, meaning, _)| {
            described(
                Field::new(*name, DataType::Float64, true),
                Some(unit).filter(|u| !u.is_empty()).copied(),
                meaning,
            )
        });
        let schema = Arc::new(Schema::new(fields.collect::<Vec<_>>()));
        let arrays = columns.into_iter().map(|(.., values)| Arc::new(Float64Array::from(values)) as ArrayRef);
        RecordBatch::try_new(schema, arrays.collect()).map(|batch| Self { batch }).map_err(plain)
    }
}

/// `schema.json`, as far as tables need it.
#[derive(Deserialize)]
struct Described {
    files: BTreeMap<String, DescribedFile>,
}

#[derive(Deserialize)]
struct DescribedFile {
    #[serde(default)]
    columns: Vec<DescribedColumn>,
}

#[derive(Deserialize)]
struct DescribedColumn {
    name: String,
    #[serde(rename = "type")]
    kind: String,
    unit: Option<String>,
    meaning: String,
}

fn described(field: Field, unit: Option<&str>, meaning: &str) -> Field {
    let unit = unit.map(|unit| ("unit".to_owned(), unit.to_owned()));
    let meaning = ("meaning".to_owned(), meaning.to_owned());
    field.with_metadata(unit.into_iter().chain([meaning]).collect::<HashMap<_, _>>())
}

/// Reads a table of a result folder, as its `schema.json` describes it.
#[pyfunction]
pub fn read_table(py: Python<'_>, dir: PathBuf, name: &str) -> PyResult<Table> {
    py.detach(|| {
        let path = dir.join("schema.json");
        let text = std::fs::read_to_string(&path).map_err(|error| plain(format!("{}: {error}", path.display())))?;
        let described: Described =
            serde_json::from_str(&text).map_err(|error| plain(format!("{}: {error}", path.display())))?;
        let tables = described.files.iter().filter(|(_, file)| !file.columns.is_empty());
        let Some((file, DescribedFile { columns })) = tables.clone().find(|(file, _)| stem(file) == name) else {
            let there: Vec<&str> = tables.map(|(file, _)| stem(file)).collect();
            return Err(plain(format!("{}: found no table {name}, wanted one of {}", dir.display(), there.join(", "))));
        };
        let path = dir.join(file);
        let read = match path.extension().and_then(|e| e.to_str()) {
            Some("csv") => of_csv(&path, columns),
            Some("parquet") => of_parquet(&path, columns),
            _ => Err("found a format that is not read here, wanted .csv or .parquet".into()),
        };
        read.map(|batch| Table { batch }).map_err(|error| plain(format!("{}: {error}", path.display())))
    })
}

/// The name of a table: that of its file without the suffix.
fn stem(file: &str) -> &str {
    file.rsplit_once('.').map_or(file, |(stem, _)| stem)
}

/// A column that is being read.
enum Builder {
    Text(StringBuilder),
    Number(Float64Builder),
    Count(Int64Builder),
    Flag(BooleanBuilder),
}

type Failed = Box<dyn std::error::Error + Send + Sync>;

impl Builder {
    fn new(kind: &str) -> Result<Self, Failed> {
        match kind {
            "string" => Ok(Self::Text(StringBuilder::new())),
            "number" => Ok(Self::Number(Float64Builder::new())),
            "integer" => Ok(Self::Count(Int64Builder::new())),
            "boolean" => Ok(Self::Flag(BooleanBuilder::new())),
            other => Err(format!("found the type {other}, wanted string, number, integer or boolean").into()),
        }
    }

    /// Takes a field of CSV; an empty one is no value.
    fn take_text(&mut self, text: &str) -> Result<(), Failed> {
        let some = (!text.is_empty()).then_some(text);
        match self {
            Self::Text(builder) => builder.append_option(some),
            Self::Number(builder) => builder.append_option(some.map(str::parse).transpose()?),
            Self::Count(builder) => builder.append_option(some.map(str::parse).transpose()?),
            Self::Flag(builder) => builder.append_option(some.map(str::parse).transpose()?),
        }
        Ok(())
    }

    /// Takes a value of Parquet.
    fn take_value(&mut self, value: &Value) -> Result<(), Failed> {
        match (self, value) {
            (Self::Text(builder), Value::Str(text)) => builder.append_value(text),
            (Self::Number(builder), Value::Double(number)) => builder.append_value(*number),
            (Self::Count(builder), Value::Long(count)) => builder.append_value(*count),
            (Self::Count(builder), Value::ULong(count)) => builder.append_value(i64::try_from(*count)?),
            (Self::Flag(builder), Value::Bool(flag)) => builder.append_value(*flag),
            (Self::Text(builder), Value::Null) => builder.append_null(),
            (Self::Number(builder), Value::Null) => builder.append_null(),
            (Self::Count(builder), Value::Null) => builder.append_null(),
            (Self::Flag(builder), Value::Null) => builder.append_null(),
            (_, other) => return Err(format!("found {other}, which is not of the type that schema.json says").into()),
        }
        Ok(())
    }

    fn finish(self) -> ArrayRef {
        match self {
            Self::Text(mut builder) => Arc::new(builder.finish()),
            Self::Number(mut builder) => Arc::new(builder.finish()),
            Self::Count(mut builder) => Arc::new(builder.finish()),
            Self::Flag(mut builder) => Arc::new(builder.finish()),
        }
    }
}

fn builders(columns: &[DescribedColumn]) -> Result<Vec<Builder>, Failed> {
    columns.iter().map(|column| Builder::new(&column.kind)).collect()
}

fn of_csv(path: &Path, columns: &[DescribedColumn]) -> Result<RecordBatch, Failed> {
    let mut reader = csv::Reader::from_path(path)?;
    if !reader.headers()?.iter().eq(columns.iter().map(|column| &column.name)) {
        return Err("the header is not the one that schema.json says".into());
    }
    let mut builders = builders(columns)?;
    for row in reader.records() {
        let row = row?;
        builders.iter_mut().zip(&row).try_for_each(|(builder, text)| builder.take_text(text))?;
    }
    batch(columns, builders)
}

fn of_parquet(path: &Path, columns: &[DescribedColumn]) -> Result<RecordBatch, Failed> {
    let reader = SerializedFileReader::new(File::open(path)?)?;
    let mut builders = builders(columns)?;
    for row in reader.get_row_iter(None)? {
        let row = row?;
        if !row.get_column_iter().map(|(name, _)| name).eq(columns.iter().map(|column| &column.name)) {
            return Err("the columns are not those that schema.json says".into());
        }
        builders.iter_mut().zip(row.get_column_iter()).try_for_each(|(b, (_, value))| b.take_value(value))?;
    }
    batch(columns, builders)
}

fn batch(columns: &[DescribedColumn], builders: Vec<Builder>) -> Result<RecordBatch, Failed> {
    let arrays: Vec<ArrayRef> = builders.into_iter().map(Builder::finish).collect();
    let fields = columns.iter().zip(&arrays).map(|(column, array)| {
        let field = Field::new(&column.name, array.data_type().clone(), true);
        described(field, column.unit.as_deref(), &column.meaning)
    });
    let schema: SchemaRef = Arc::new(Schema::new(fields.collect::<Vec<_>>()));
    Ok(RecordBatch::try_new(schema, arrays)?)
}
