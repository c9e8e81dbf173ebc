//! The views as a Parquet file.

use std::sync::Arc;

use parquet::basic::Compression;
use parquet::data_type::{DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;

use super::Table;
use crate::feasibility::View;
use crate::problem::Problem;

/// The views as a Parquet file: an INT64 column `id` and DOUBLE columns, Snappy-compressed.
///
/// # Errors
/// Never in practice: the writer writes to memory.
pub fn views_parquet(problem: &Problem, views: &[View]) -> Result<Vec<u8>, ParquetError> {
    let table = Table::new(problem, views);
    // Column names in a schema text end at blanks; a joint may be named anything.
    let plain = |name: &String| name.replace(|c: char| !c.is_alphanumeric() && c != '_', "_");
    let doubles: String = table.names.iter().map(|name| format!("REQUIRED DOUBLE {};", plain(name))).collect();
    let schema = parse_message_type(&format!("message candidates {{ REQUIRED INT64 id; {doubles} }}"))?;
    let properties = WriterProperties::builder().set_compression(Compression::SNAPPY).build();
    let mut file = SerializedFileWriter::new(Vec::new(), Arc::new(schema), Arc::new(properties))?;
    let mut group = file.next_row_group()?;
    if let Some(mut column) = group.next_column()? {
        column.typed::<Int64Type>().write_batch(&table.ids, None, None)?;
        column.close()?;
    }
    for numbers in &table.columns {
        if let Some(mut column) = group.next_column()? {
            column.typed::<DoubleType>().write_batch(numbers, None, None)?;
            column.close()?;
        }
    }
    group.close()?;
    file.into_inner()
}
