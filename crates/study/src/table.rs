//! Rows as CSV, and designs from tables.

use crate::column::{Cell, Column};
use crate::designs::Designs;
use crate::row::Row;
use piaffe_codegen::spec::BYTE_ORDER_MARK;
use std::fmt;

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

/// How Parquet begins.
const PARQUET: &[u8] = b"PAR1";

/// Designs from a table: CSV, or Parquet where the crate is built with it.
///
/// # Errors
/// What cannot be read, or everything in it that is no number, with its place.
pub fn designs(file: Vec<u8>) -> Result<Designs, Unlisted> {
    match file.starts_with(PARQUET) {
        #[cfg(feature = "parquet")]
        true => crate::columnar::designs(file),
        #[cfg(not(feature = "parquet"))]
        true => Err(Unlisted::unreadable("it is Parquet, without which this program was built: give CSV".into())),
        false => match String::from_utf8(file) {
            Ok(text) => of_text(&text),
            Err(_) => Err(Unlisted::unreadable("it is neither text nor Parquet".into())),
        },
    }
}

/// Designs from a CSV table: a column for each number under its name, a line for each design.
fn of_text(text: &str) -> Result<Designs, Unlisted> {
    let unreadable = |why: csv::Error| Unlisted::unreadable(why.to_string());
    // Spreadsheets say so that it is UTF-8.
    let text = text.trim_start_matches(BYTE_ORDER_MARK);
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).flexible(true).from_reader(text.as_bytes());
    let names: Vec<String> = reader.headers().map_err(unreadable)?.iter().map(String::from).collect();
    if names.iter().all(String::is_empty) {
        return Err(Unlisted::unreadable("it has no names of numbers in its first line".into()));
    }
    let nameless = names.iter().enumerate().filter(|(_, name)| name.is_empty());
    let mut faults: Vec<String> = nameless.map(|(k, _)| format!("line 1: column {} has no name", k + 1)).collect();
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record.map_err(unreadable)?;
        let line = record.position().map_or(0, csv::Position::line);
        if record.len() != names.len() {
            faults.push(format!("line {line}: {} numbers instead of {}", record.len(), names.len()));
        }
        let mut row = Vec::new();
        for (name, text) in names.iter().zip(&record) {
            match text.parse::<f64>() {
                Ok(number) if number.is_finite() => row.push(number),
                _ if name.is_empty() => {}
                _ if text.is_empty() => faults.push(format!("line {line}: there is no number for {name}")),
                _ => faults.push(format!("line {line}: `{text}` is no number for {name}")),
            }
        }
        rows.push(row);
    }
    listed(names, &rows, faults)
}

/// Faults that are told; who has seen them knows the others.
const TOLD: usize = 20;

/// What is wrong with a table of designs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Unlisted {
    /// Names of its columns, as far as they can be read: they may be wrong too.
    pub names: Vec<String>,
    pub faults: Vec<String>,
}

impl Unlisted {
    pub(crate) fn unreadable(why: String) -> Unlisted {
        Unlisted { faults: vec![why], ..Unlisted::default() }
    }
}

impl fmt::Display for Unlisted {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let more = self.faults.len().saturating_sub(TOLD);
        let told = self.faults.iter().take(TOLD).cloned().chain((more > 0).then(|| format!("and {more} more")));
        write!(f, "{}", told.collect::<Vec<_>>().join("\n"))
    }
}

/// The designs, if nothing is wrong with their table.
pub(crate) fn listed(names: Vec<String>, rows: &[Vec<f64>], faults: Vec<String>) -> Result<Designs, Unlisted> {
    if !faults.is_empty() {
        return Err(Unlisted { names, faults });
    }
    Designs::listed(names, rows).map_err(Unlisted::unreadable)
}

#[cfg(test)]
mod tests {
    use super::designs as of_file;
    use crate::designs::Designs;

    fn designs(text: &str) -> Result<Designs, String> {
        of_file(text.into()).map_err(|why| why.to_string())
    }

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
        let told = designs("a,\n1,\n,\n").unwrap_err();
        assert_eq!(told, "line 1: column 2 has no name\nline 3: there is no number for a");
        let many = designs(&format!("a\n{}", "x\n".repeat(1000))).unwrap_err();
        assert!(many.ends_with("and 980 more") && many.lines().count() == 21, "{many}");
        assert!(of_file(vec![0xff, 0xfe, 0x00]).unwrap_err().to_string().contains("neither text nor Parquet"));
    }

    #[test]
    fn a_mark_of_spreadsheets_is_no_part_of_a_name() {
        assert_eq!(designs("\u{feff}gravity\r\n9.81\r\n").unwrap().names(), ["gravity"]);
    }
}
