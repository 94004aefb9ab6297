//! One table on standard output: CSV, or an Arrow IPC stream, in which every column knows its unit.

use std::collections::HashMap;
use std::fmt;
use std::io::{self, Stdout, Write};
use std::sync::Arc;
use std::time::{Duration, Instant};

use arrow_array::{ArrayRef, Float64Array, Int64Array, RecordBatch, StringArray};
use arrow_ipc::writer::StreamWriter;
use arrow_schema::{ArrowError, DataType, Field, Schema, SchemaRef};
use chaindrive::record::Ending;
use chaindrive::{Channel, Recording, Simulation};
use clap::ValueEnum;

use crate::csv::{columns, digits, incomplete, named};
use crate::failure::Failure;

/// Formats of a table on standard output.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// Comma separated values, with the units in the headings
    #[default]
    Csv,
    /// Arrow IPC stream, with the units in the metadata of the columns
    Arrow,
}

/// A column: name, unit and what there is of it.
#[derive(Debug)]
pub(crate) struct Column {
    pub(crate) name: String,
    pub(crate) unit: Option<String>,
    pub(crate) cells: Cells,
}

/// Entries of a column.
#[derive(Debug)]
pub(crate) enum Cells {
    Whole(Vec<i64>),
    Numbers(Vec<f64>),
    Texts(Vec<String>),
}

impl Cells {
    /// An entry as a text; numbers with the shortest digits that read back to the same number.
    pub(crate) fn text(&self, row: usize) -> String {
        match self {
            Self::Whole(numbers) => numbers[row].to_string(),
            Self::Numbers(numbers) => digits(numbers[row]),
            Self::Texts(texts) => texts[row].clone(),
        }
    }

    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Whole(numbers) => numbers.len(),
            Self::Numbers(numbers) => numbers.len(),
            Self::Texts(texts) => texts.len(),
        }
    }

    fn kind(&self) -> DataType {
        match self {
            Self::Whole(_) => DataType::Int64,
            Self::Numbers(_) => DataType::Float64,
            Self::Texts(_) => DataType::Utf8,
        }
    }

    fn clear(&mut self) {
        match self {
            Self::Whole(numbers) => numbers.clear(),
            Self::Numbers(numbers) => numbers.clear(),
            Self::Texts(texts) => texts.clear(),
        }
    }

    /// Takes the entries out as an array.
    fn take(&mut self) -> ArrayRef {
        match self {
            Self::Whole(numbers) => Arc::new(Int64Array::from(std::mem::take(numbers))),
            Self::Numbers(numbers) => Arc::new(Float64Array::from(std::mem::take(numbers))),
            Self::Texts(texts) => Arc::new(StringArray::from(std::mem::take(texts))),
        }
    }
}

/// A table in the making.
#[derive(Debug)]
pub(crate) struct Stream {
    columns: Vec<Column>,
    form: Form,
    written: Instant,
}

enum Form {
    Csv(Box<csv::Writer<Stdout>>),
    Arrow(SchemaRef, Box<StreamWriter<Stdout>>),
}

impl fmt::Debug for Form {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Csv(_) => "Csv",
            Self::Arrow(..) => "Arrow",
        })
    }
}

/// Rows are written when there are so many, or after so long.
const ROWS: usize = 4096;
const EVERY: Duration = Duration::from_secs(1);

impl Stream {
    /// Writes the headings.
    pub(crate) fn begin(format: Format, columns: Vec<Column>) -> Result<Self, Failure> {
        let form = match format {
            Format::Csv => {
                let mut table = csv::Writer::from_writer(io::stdout());
                let headings = columns.iter().map(|it| named(&it.name, it.unit.as_deref()));
                let written = table.write_record(headings);
                written.map_err(|error| refused(error.into()))?;
                Form::Csv(Box::new(table))
            }
            Format::Arrow => {
                let field = |column: &Column| {
                    let unit = column.unit.clone().map(|unit| ("unit".to_owned(), unit));
                    let field = Field::new(&column.name, column.cells.kind(), false);
                    field.with_metadata(HashMap::from_iter(unit))
                };
                let fields: Vec<Field> = columns.iter().map(field).collect();
                let schema = Arc::new(Schema::new(fields));
                let writer = StreamWriter::try_new(io::stdout(), &schema).map_err(broken)?;
                Form::Arrow(schema, Box::new(writer))
            }
        };
        Ok(Self {
            columns,
            form,
            written: Instant::now(),
        })
    }

    /// A table of samples.
    pub(crate) fn of_samples(
        format: Format,
        simulation: &Simulation,
        channels: &[Channel],
    ) -> Result<Self, Failure> {
        let empty = |(name, unit): (String, &str)| Column {
            name,
            unit: Some(unit.to_owned()),
            cells: Cells::Numbers(Vec::new()),
        };
        let columns = columns(simulation, channels).into_iter().map(empty);
        Self::begin(format, columns.collect())
    }

    /// Takes a sample.
    pub(crate) fn push(&mut self, sample: &Recording) -> Result<(), Failure> {
        let numbers = sample.columns.iter().flat_map(|column| &column.values);
        for (column, number) in self
            .columns
            .iter_mut()
            .zip(sample.time.iter().chain(numbers))
        {
            if let Cells::Numbers(numbers) = &mut column.cells {
                numbers.push(*number);
            }
        }
        let rows = self.columns.first().map_or(0, |column| column.cells.len());
        if rows < ROWS && self.written.elapsed() < EVERY {
            return Ok(());
        }
        self.write()
    }

    /// Writes the rows that there are.
    fn write(&mut self) -> Result<(), Failure> {
        self.written = Instant::now();
        match &mut self.form {
            Form::Csv(table) => {
                let rows = self.columns.first().map_or(0, |column| column.cells.len());
                for row in 0..rows {
                    let cells = self.columns.iter().map(|column| column.cells.text(row));
                    let written = table.write_record(cells);
                    written.map_err(|error| refused(error.into()))?;
                }
                for column in &mut self.columns {
                    column.cells.clear();
                }
                table.flush().map_err(refused)
            }
            Form::Arrow(schema, writer) => {
                let arrays = self.columns.iter_mut().map(|column| column.cells.take());
                let batch = RecordBatch::try_new(Arc::clone(schema), arrays.collect());
                let written = batch.and_then(|batch| writer.write(&batch));
                written.and_then(|()| writer.flush()).map_err(broken)
            }
        }
    }

    /// Writes the last rows and how it ended: CSV in a last line, Arrow by the mark of its end, which only a complete table has.
    pub(crate) fn finish(mut self, ending: &Ending) -> Result<(), Failure> {
        self.write()?;
        let last = incomplete(ending);
        match (self.form, last) {
            (Form::Csv(_), Some(last)) => {
                let mut out = io::stdout();
                let written = out.write_all(last.as_bytes());
                written.and_then(|()| out.flush()).map_err(refused)
            }
            (Form::Arrow(_, mut writer), None) => writer.finish().map_err(broken),
            _ => Ok(()),
        }
    }
}

fn broken(error: ArrowError) -> Failure {
    refused(match error {
        ArrowError::IoError(_, source) => source,
        other => io::Error::other(other.to_string()),
    })
}

fn refused(source: io::Error) -> Failure {
    Failure::File {
        path: "stdout".to_owned(),
        source,
    }
}
