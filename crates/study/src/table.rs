//! Rows as files: CSV, and Parquet where the crate is built with it.

use crate::column::{Cell, Column};
use crate::designs::Designs;
use crate::row::Row;

/// The table as CSV (RFC 4180, UTF-8). Numbers have all of their digits; what is not there is empty.
pub fn csv(columns: &[Column], rows: &[Row]) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(columns.iter().map(Column::name))?;
    for row in rows {
        writer.write_record(columns.iter().map(|column| written(column.of(row))))?;
    }
    writer.into_inner().map_err(|error| csv::Error::from(error.into_error()))
}

fn written(cell: Cell) -> String {
    match cell {
        Cell::Integer(integer) => integer.map_or(String::new(), |integer| integer.to_string()),
        // As short as it can be without losing a bit.
        Cell::Number(number) => number.map_or(String::new(), |number| format!("{number:?}")),
        Cell::Text(text) => text.unwrap_or_default(),
    }
}

/// Designs from a CSV table: a column for each number under its name, a line for each design.
///
/// # Errors
/// Everything in it that is no number, with its line.
pub fn designs(text: &str) -> Result<Designs, String> {
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).flexible(true).from_reader(text.as_bytes());
    let names: Vec<String> = reader.headers().map_err(|why| why.to_string())?.iter().map(String::from).collect();
    if names.iter().all(String::is_empty) {
        return Err("it has no names of numbers in its first line".into());
    }
    let (mut rows, mut faults) = (Vec::new(), Vec::new());
    for record in reader.records() {
        let record = record.map_err(|why| why.to_string())?;
        let line = record.position().map_or(0, csv::Position::line);
        if record.len() != names.len() {
            faults.push(format!("line {line}: {} numbers instead of {}", record.len(), names.len()));
        }
        let mut row = Vec::new();
        for (name, text) in names.iter().zip(&record) {
            match text.parse::<f64>() {
                Ok(number) if number.is_finite() => row.push(number),
                _ => faults.push(format!("line {line}: `{text}` is no number for {name}")),
            }
        }
        rows.push(row);
    }
    if faults.is_empty() { Designs::listed(names, &rows) } else { Err(faults.join("\n")) }
}

/// The table as Parquet: 64-bit integers, doubles and UTF-8, each of which may be absent.
///
/// # Errors
/// If the library cannot write it.
#[cfg(feature = "parquet")]
pub fn parquet(columns: &[Column], rows: &[Row]) -> Result<Vec<u8>, parquet::errors::ParquetError> {
    use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
    use parquet::file::properties::WriterProperties;
    use parquet::file::writer::SerializedFileWriter;
    use std::sync::Arc;

    /// Rows that are written together.
    const GROUP: usize = 1 << 16;

    let made_by = format!("piaffe {}", env!("CARGO_PKG_VERSION"));
    let properties = Arc::new(WriterProperties::builder().set_created_by(made_by).build());
    let mut writer = SerializedFileWriter::new(Vec::new(), schema(columns)?, properties)?;
    for rows in rows.chunks(GROUP) {
        let mut group = writer.next_row_group()?;
        for column in columns {
            let Some(mut target) = group.next_column()? else { break };
            let cells: Vec<Cell> = rows.iter().map(|row| column.of(row)).collect();
            let there: Vec<i16> = cells.iter().map(|cell| i16::from(cell.is_there())).collect();
            match column.kind() {
                Kind::Integer => {
                    let values: Vec<i64> = cells.iter().filter_map(|cell| cell.integer()?.try_into().ok()).collect();
                    target.typed::<Int64Type>().write_batch(&values, Some(&there), None)?;
                }
                Kind::Number => {
                    let values: Vec<f64> = cells.iter().filter_map(Cell::number).collect();
                    target.typed::<DoubleType>().write_batch(&values, Some(&there), None)?;
                }
                Kind::Text => {
                    let values: Vec<ByteArray> = cells.iter().filter_map(Cell::text).map(ByteArray::from).collect();
                    target.typed::<ByteArrayType>().write_batch(&values, Some(&there), None)?;
                }
            }
            target.close()?;
        }
        group.close()?;
    }
    writer.into_inner()
}

#[cfg(feature = "parquet")]
use crate::column::Kind;

#[cfg(feature = "parquet")]
fn schema(columns: &[Column]) -> Result<parquet::schema::types::TypePtr, parquet::errors::ParquetError> {
    use parquet::basic::{LogicalType, Repetition, Type as Physical};
    use parquet::schema::types::Type;
    let field = |column: &Column| {
        let (physical, logical) = match column.kind() {
            Kind::Integer => (Physical::INT64, None),
            Kind::Number => (Physical::DOUBLE, None),
            Kind::Text => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
        };
        let name = column.name();
        let field = Type::primitive_type_builder(&name, physical);
        Ok(field.with_repetition(Repetition::OPTIONAL).with_logical_type(logical).build()?.into())
    };
    let fields = columns.iter().map(field).collect::<Result<_, parquet::errors::ParquetError>>()?;
    Ok(Type::group_type_builder("study").with_fields(fields).build()?.into())
}

#[cfg(test)]
mod tests {
    use super::designs;

    #[test]
    fn a_table_of_numbers_is_a_list_of_designs() {
        let read = designs("links.thigh.mass, gravity\n1.5, 9.81\n2,1e0\n").unwrap();
        assert_eq!((read.count(), read.names().join(" ")), (2, "links.thigh.mass gravity".into()));
        assert_eq!(read.numbers(1), [2.0, 1.0]);
    }

    #[test]
    fn everything_that_is_wrong_with_a_table_is_told_with_its_line() {
        let told = designs("a,b\n1,2\nx,3\n4\n5,inf\n").unwrap_err();
        for fault in ["line 3: `x` is no number for a", "line 4: 1 numbers instead of 2", "line 5: `inf`"] {
            assert!(told.contains(fault), "{told}");
        }
        assert!(designs("").is_err());
    }
}
