//! The table of `--design`: a column a path, a row a variant.

use std::path::Path;

use chaindrive::scene::read_file;
use chaindrive::sweep::Setting;

use crate::failure::Failure;

/// Reads the paths and their values.
pub(super) fn read(path: &Path) -> Result<Vec<(String, Vec<Setting>)>, Failure> {
    let said = |error: String| Failure::Argument(format!("--design {}: {error}", path.display()));
    let refuse = |error: csv::Error| said(error.to_string());
    let text = read_file(path).map_err(said)?;
    let mut reader = csv::ReaderBuilder::new();
    let mut table = reader.trim(csv::Trim::All).from_reader(text.as_bytes());
    let paths = table.headers().map_err(refuse)?.iter();
    let mut columns: Vec<_> = paths.map(|it| (it.to_owned(), Vec::new())).collect();
    for row in table.records() {
        for ((_, values), cell) in columns.iter_mut().zip(&row.map_err(refuse)?) {
            values.push(Setting::Text(cell.to_owned()));
        }
    }
    Ok(columns)
}
