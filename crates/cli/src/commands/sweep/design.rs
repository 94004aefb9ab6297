//! The table of `--design`: a column a path, a row a variant.

use std::path::Path;

use chaindrive::sweep::Setting;

use crate::failure::Failure;

/// Reads the paths and their values.
pub(super) fn read(path: &Path) -> Result<Vec<(String, Vec<Setting>)>, Failure> {
    let refuse =
        |error: csv::Error| Failure::Argument(format!("--design {}: {error}", path.display()));
    let mut reader = csv::ReaderBuilder::new();
    let mut table = reader
        .trim(csv::Trim::All)
        .from_path(path)
        .map_err(refuse)?;
    let paths = table.headers().map_err(refuse)?.iter();
    let mut columns: Vec<_> = paths.map(|it| (it.to_owned(), Vec::new())).collect();
    for row in table.records() {
        for ((_, values), cell) in columns.iter_mut().zip(&row.map_err(refuse)?) {
            values.push(Setting::Text(cell.to_owned()));
        }
    }
    Ok(columns)
}
