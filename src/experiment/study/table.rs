//! The rows of a study as a table: one row a cell and choice.

use super::Study;
use crate::plan::document::{CellDocument, CellOutcome, CellRow, SimulatedOutcome};

/// The rows of all cells, in their order.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyTable {
    pub(super) columns: Vec<Column>,
    rows: usize,
}

/// A column and its name.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Column {
    pub(super) name: String,
    pub(super) values: Values,
}

/// What stands in the rows.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Values {
    Text(Vec<Option<String>>),
    Whole(Vec<Option<i64>>),
    Number(Vec<Option<f64>>),
}

/// A 95 % confidence interval of a mean is so many standard errors wide on each side.
const STANDARD_ERRORS: f64 = 1.959_964;

impl StudyTable {
    /// The table of cells, each with its number.
    pub(super) fn new(study: &Study, cells: &[(usize, CellDocument)]) -> Self {
        let rows: Vec<(usize, &CellDocument, &CellRow)> =
            cells.iter().flat_map(|(index, cell)| cell.rows.iter().map(move |row| (*index, cell, row))).collect();
        let mut table = Self { columns: Vec::new(), rows: rows.len() };
        let problems = study.problems();
        let settings: Vec<_> = cells.iter().map(|&(index, _)| study.cell(index)).collect();
        let at = |index: usize| &settings[cells.partition_point(|&(other, _)| other < index)];
        table.whole("cell", rows.iter().map(|&(index, ..)| Some(index)));
        table.text("problem", rows.iter().map(|&(index, ..)| Some(problems[at(index).problem].to_owned())));
        for (i, factor) in study.factors.iter().enumerate() {
            let level = |&(index, ..): &(usize, &CellDocument, &CellRow)| &at(index).levels[i];
            if rows.iter().all(|row| level(row).number.is_some()) {
                table.numbers(&factor.name, rows.iter().map(|row| level(row).number));
            } else {
                table.text(&factor.name, rows.iter().map(|row| Some(level(row).name.clone())));
            }
        }
        let named = |text: &String| Some(text.clone()).filter(|text| !text.is_empty());
        table.text("criterion", rows.iter().map(|(.., row)| named(&row.criterion)));
        table.whole("count", rows.iter().map(|(.., row)| row.count));
        table.text("method", rows.iter().map(|(.., row)| named(&row.method)));
        table.whole("seed", rows.iter().map(|(.., row)| row.seed.map(|seed| seed as usize)));
        table.text("reason", rows.iter().map(|(.., row)| row.reason.clone()));
        table.outcomes(&rows);
        table.text("problem_sha256", rows.iter().map(|(_, cell, _)| named(&cell.problem.sha256)));
        table.text("calipose", rows.iter().map(|(_, cell, _)| Some(cell.header.calipose.clone())));
        table.text("fingerprint", rows.iter().map(|(_, cell, _)| Some(cell.fingerprint.clone())));
        table
    }

    /// Whether every table has a column of that name, which no factor can have then.
    pub(super) fn has_own(name: &str) -> bool {
        const OWN: [&str; 23] = [
            "cell",
            "problem",
            "criterion",
            "count",
            "method",
            "seed",
            "reason",
            "configurations",
            "candidates",
            "views",
            "poses",
            "value",
            "bound",
            "efficiency",
            "map_error_px",
            "trials",
            "failed",
            "simulated_map_error_px",
            "simulated_low_px",
            "simulated_high_px",
            "problem_sha256",
            "calipose",
            "fingerprint",
        ];
        OWN.contains(&name) || name.starts_with("sigma_")
    }

    fn outcomes(&mut self, rows: &[(usize, &CellDocument, &CellRow)]) {
        let outcomes: Vec<Option<&CellOutcome>> = rows.iter().map(|(.., row)| row.outcome.as_ref()).collect();
        let of = |get: fn(&CellOutcome) -> usize| outcomes.iter().map(move |outcome| outcome.map(get));
        self.whole("configurations", of(|outcome| outcome.configurations));
        self.whole("candidates", of(|outcome| outcome.candidates));
        self.whole("views", of(|outcome| outcome.views));
        self.whole("poses", of(|outcome| outcome.poses));
        let of = |get: fn(&CellOutcome) -> Option<f64>| outcomes.iter().map(move |outcome| outcome.and_then(get));
        self.numbers("value", of(|outcome| outcome.value));
        self.numbers("bound", of(|outcome| outcome.bound));
        self.numbers("efficiency", of(|outcome| outcome.efficiency));
        self.numbers("map_error_px", of(|outcome| outcome.map_error_px));
        let mut names: Vec<&str> = Vec::new();
        for (name, _) in outcomes.iter().flatten().flat_map(|outcome| &outcome.sigma) {
            if !names.contains(&name.as_str()) {
                names.push(name);
            }
        }
        for name in names {
            let sigma = |outcome: Option<&CellOutcome>| {
                let sigma = &outcome?.sigma;
                sigma.iter().find(|(known, _)| known == name).map(|&(_, sigma)| sigma)
            };
            self.numbers(&format!("sigma_{name}"), outcomes.iter().copied().map(sigma));
        }
        let simulated: Vec<Option<&SimulatedOutcome>> =
            outcomes.iter().map(|outcome| outcome.and_then(|outcome| outcome.simulated.as_ref())).collect();
        if simulated.iter().all(Option::is_none) {
            return;
        }
        let ends = |side: f64| {
            let end = move |found: &SimulatedOutcome| {
                Some(found.map_error_px? + side * STANDARD_ERRORS * found.standard_error_px?)
            };
            simulated.iter().map(move |found| found.and_then(end))
        };
        self.whole("trials", simulated.iter().map(|found| found.map(|found| found.trials)));
        self.whole("failed", simulated.iter().map(|found| found.map(|found| found.failed)));
        self.numbers(
            "simulated_map_error_px",
            simulated.iter().map(|found| found.and_then(|found| found.map_error_px)),
        );
        self.numbers("simulated_low_px", ends(-1.0));
        self.numbers("simulated_high_px", ends(1.0));
    }

    fn text(&mut self, name: &str, values: impl Iterator<Item = Option<String>>) {
        self.columns.push(Column { name: name.to_owned(), values: Values::Text(values.collect()) });
    }

    fn whole(&mut self, name: &str, values: impl Iterator<Item = Option<usize>>) {
        let values = values.map(|value| value.map(|value| value.cast_signed() as i64)).collect();
        self.columns.push(Column { name: name.to_owned(), values: Values::Whole(values) });
    }

    fn numbers(&mut self, name: &str, values: impl Iterator<Item = Option<f64>>) {
        self.columns.push(Column { name: name.to_owned(), values: Values::Number(values.collect()) });
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.rows
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.rows == 0
    }

    /// The column of that name; the first of two that share it.
    pub(super) fn column(&self, name: &str) -> Option<&Values> {
        self.columns.iter().find(|column| column.name == name).map(|column| &column.values)
    }

    /// As CSV, under a header; what is not there is empty.
    ///
    /// # Errors
    /// Never in practice: the writer writes to memory.
    pub fn to_csv(&self) -> Result<Vec<u8>, csv::Error> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(self.columns.iter().map(|column| &column.name))?;
        for row in 0..self.rows {
            writer.write_record(self.columns.iter().map(|column| column.values.label(row).unwrap_or_default()))?;
        }
        writer.into_inner().map_err(|error| csv::Error::from(error.into_error()))
    }
}

impl Values {
    /// What stands in a row, as text.
    pub(super) fn label(&self, row: usize) -> Option<String> {
        match self {
            Self::Text(values) => values[row].clone(),
            Self::Whole(values) => values[row].map(|value| value.to_string()),
            Self::Number(values) => values[row].map(|value| value.to_string()),
        }
    }

    /// What stands in a row, as a number.
    pub(super) fn number(&self, row: usize) -> Option<f64> {
        match self {
            Self::Text(_) => None,
            Self::Whole(values) => values[row].map(|value| value as f64),
            Self::Number(values) => values[row],
        }
    }
}

#[cfg(feature = "parquet")]
mod parquet {
    use std::sync::Arc;

    use parquet::basic::Compression;
    use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
    use parquet::errors::ParquetError;
    use parquet::file::properties::WriterProperties;
    use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
    use parquet::schema::parser::parse_message_type;

    use super::{StudyTable, Values};

    impl StudyTable {
        /// As a Parquet file, Snappy-compressed: UTF-8, INT64 and DOUBLE columns, of which each may be null. Characters of names that
        /// are neither letters nor digits are underscores.
        ///
        /// # Errors
        /// Never in practice: the writer writes to memory.
        pub fn to_parquet(&self) -> Result<Vec<u8>, ParquetError> {
            let plain = |name: &str| name.replace(|c: char| !c.is_alphanumeric() && c != '_', "_");
            let fields: String = self
                .columns
                .iter()
                .map(|column| {
                    let name = plain(&column.name);
                    match column.values {
                        Values::Text(_) => format!("OPTIONAL BYTE_ARRAY {name} (UTF8);"),
                        Values::Whole(_) => format!("OPTIONAL INT64 {name};"),
                        Values::Number(_) => format!("OPTIONAL DOUBLE {name};"),
                    }
                })
                .collect();
            let schema = parse_message_type(&format!("message study {{ {fields} }}"))?;
            let properties = WriterProperties::builder().set_compression(Compression::SNAPPY).build();
            let mut file = SerializedFileWriter::new(Vec::new(), Arc::new(schema), Arc::new(properties))?;
            let mut group = file.next_row_group()?;
            for column in &self.columns {
                match &column.values {
                    Values::Text(values) => {
                        let bytes: Vec<_> = values.iter().map(|text| text.as_deref().map(ByteArray::from)).collect();
                        write::<ByteArrayType>(&mut group, bytes)?;
                    }
                    Values::Whole(values) => write::<Int64Type>(&mut group, values.clone())?,
                    Values::Number(values) => write::<DoubleType>(&mut group, values.clone())?,
                }
            }
            group.close()?;
            file.into_inner()
        }
    }

    fn write<T: DataType>(
        group: &mut SerializedRowGroupWriter<Vec<u8>>,
        values: Vec<Option<T::T>>,
    ) -> Result<(), ParquetError> {
        let Some(mut column) = group.next_column()? else { return Ok(()) };
        let levels: Vec<i16> = values.iter().map(|value| i16::from(value.is_some())).collect();
        let there: Vec<T::T> = values.into_iter().flatten().collect();
        column.typed::<T>().write_batch(&there, Some(&levels), None)?;
        column.close()
    }
}
