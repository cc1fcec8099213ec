//! Parquet: tables of rows as it has them, and designs from it.

use crate::column::{Cell, Column, Kind};
use crate::designs::Designs;
use crate::row::Row;
use crate::table::{Unlisted, listed};
use bytes::Bytes;
use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::record::Field;
use parquet::schema::types::{Type, TypePtr};
use std::panic::catch_unwind;
use std::sync::Arc;

/// Rows that are written together.
const GROUP: usize = 1 << 16;

/// The table as Parquet: 64-bit integers, doubles and UTF-8, each of which may be absent.
///
/// # Errors
/// If the library cannot write it.
pub fn parquet(columns: &[Column], rows: &[Row]) -> Result<Vec<u8>, ParquetError> {
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

fn schema(columns: &[Column]) -> Result<TypePtr, ParquetError> {
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
    let fields = columns.iter().map(field).collect::<Result<_, ParquetError>>()?;
    Ok(Type::group_type_builder("study").with_fields(fields).build()?.into())
}

/// Designs from a Parquet table: a column of numbers for each number under its name, a row for each design.
///
/// # Errors
/// What cannot be read, or everything in it that is no number, with its row, from 0.
pub fn designs(file: Vec<u8>) -> Result<Designs, Unlisted> {
    // The library panics where some files are damaged.
    catch_unwind(|| read(file)).unwrap_or_else(|_| Err(Unlisted::unreadable("it cannot be read: it is damaged".into())))
}

fn read(file: Vec<u8>) -> Result<Designs, Unlisted> {
    let unreadable = |why: ParquetError| {
        Unlisted::unreadable(format!("it cannot be read: {why}; tables are read plain or with Snappy"))
    };
    let reader = SerializedFileReader::new(Bytes::from(file)).map_err(unreadable)?;
    let fields = reader.metadata().file_metadata().schema().get_fields();
    let names: Vec<String> = fields.iter().map(|field| field.name().into()).collect();
    let (mut rows, mut faults) = (Vec::new(), Vec::new());
    for (k, row) in reader.get_row_iter(None).map_err(unreadable)?.enumerate() {
        let row = row.map_err(unreadable)?;
        let mut numbers = Vec::new();
        for (name, field) in row.get_column_iter() {
            match number(field).filter(|number| number.is_finite()) {
                Some(number) => numbers.push(number),
                None if matches!(field, Field::Null) => faults.push(format!("row {k}: there is no number for {name}")),
                None => faults.push(format!("row {k}: `{field}` is no number for {name}")),
            }
        }
        rows.push(numbers);
    }
    listed(names, &rows, faults)
}

fn number(field: &Field) -> Option<f64> {
    Some(match *field {
        Field::Byte(n) => n.into(),
        Field::Short(n) => n.into(),
        Field::Int(n) => n.into(),
        Field::Long(n) => n as f64,
        Field::UByte(n) => n.into(),
        Field::UShort(n) => n.into(),
        Field::UInt(n) => n.into(),
        Field::ULong(n) => n as f64,
        Field::Float(n) => n.into(),
        Field::Double(n) => n,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::designs;
    use parquet::data_type::DoubleType;
    use parquet::file::writer::SerializedFileWriter;
    use parquet::schema::parser::parse_message_type;
    use std::sync::Arc;

    /// Two columns of doubles, the second of which may be absent.
    fn table(first: &[f64], second: &[Option<f64>]) -> Vec<u8> {
        let schema = "message designs { required double links.thigh.mass; optional double gravity; }";
        let schema = Arc::new(parse_message_type(schema).unwrap());
        let mut writer = SerializedFileWriter::new(Vec::new(), schema, Default::default()).unwrap();
        let mut group = writer.next_row_group().unwrap();
        let mut column = group.next_column().unwrap().unwrap();
        column.typed::<DoubleType>().write_batch(first, None, None).unwrap();
        column.close().unwrap();
        let there: Vec<i16> = second.iter().map(|number| i16::from(number.is_some())).collect();
        let numbers: Vec<f64> = second.iter().copied().flatten().collect();
        let mut column = group.next_column().unwrap().unwrap();
        column.typed::<DoubleType>().write_batch(&numbers, Some(&there), None).unwrap();
        column.close().unwrap();
        group.close().unwrap();
        writer.into_inner().unwrap()
    }

    #[test]
    fn a_table_of_numbers_is_a_list_of_designs() {
        let read = designs(table(&[0.1, 2.0], &[Some(9.81), Some(1e-300)])).unwrap();
        assert_eq!((read.count(), read.names().join(" ")), (2, "links.thigh.mass gravity".into()));
        assert_eq!(read.numbers(1), [2.0, 1e-300]);
    }

    #[test]
    fn everything_that_is_wrong_with_a_table_is_told_with_its_row() {
        let told =
            designs(table(&[1.0, f64::NAN, 2.0], &[None, Some(9.81), Some(f64::INFINITY)])).unwrap_err().to_string();
        for fault in ["row 0: there is no number for gravity", "row 1: `NaN`", "row 2: `inf`"] {
            assert!(told.contains(fault), "{told}");
        }
    }

    /// Whatever a damaged file says, it is told or it is a table.
    #[test]
    fn damaged_files_are_told() {
        let whole = table(&[1.0, 2.0], &[Some(9.81), None]);
        for length in 0..whole.len() {
            assert!(designs(whole[..length].to_vec()).is_err());
        }
        for bit in 0..8 * whole.len() {
            let mut bytes = whole.clone();
            bytes[bit / 8] ^= 1 << (bit % 8);
            let _ = designs(bytes);
        }
    }
}
