//! Text whose columns align themselves: tabs divide its cells.
//!
//! Names stand left, figures right, and words at the end of lines left. Lines with one tab are a name and what is said of it.

/// Width of the names where several tables stand below each other, so that all of them begin to speak in one column.
pub(crate) const NAMES: usize = 24;

/// Writes lines into a text, one a format.
macro_rules! lines {
    ($to:expr; $($text:literal $(, $value:expr)*;)*) => {
        $(writeln!($to, $text $(, $value)*)?;)*
    };
}
pub(crate) use lines;

/// The text with its tables aligned, each by itself; `names`: least width of its first columns.
///
/// A table ends with its lines of several cells, or where a line without indentation, the heading of the next, follows an indented one.
///
/// ```
/// let text = "stop\tteeth\twrap [deg]\n  crank\t19\t187.5\n  cam\t38\t172.5";
/// let aligned = "stop     teeth  wrap [deg]\n  crank     19       187.5\n  cam       38       172.5";
/// assert_eq!(chaindrive::aligned(text, 0), aligned);
/// ```
pub fn aligned(text: &str, names: usize) -> String {
    let lines: Vec<Vec<&str>> = text
        .split('\n')
        .map(|it| it.split('\t').collect())
        .collect();
    let kind = |line: &[&str]| line.len().min(3);
    let is_inside = |line: &[&str]| line[0].starts_with(' ');
    let tables =
        lines.chunk_by(|one, next| kind(one) == kind(next) && (is_inside(next) || !is_inside(one)));
    let lines = tables.flat_map(|table| table.iter().map(move |line| laid(line, table, names)));
    lines.collect::<Vec<_>>().join("\n")
}

/// A line of a table.
fn laid(line: &[&str], table: &[Vec<&str>], names: usize) -> String {
    let last = table.iter().map(Vec::len).max().unwrap_or(0) - 1;
    let cells = |column: usize| table.iter().filter_map(move |line| line.get(column));
    let figures = cells(last).filter(|it| is_figure(it)).count();
    // The heading is none of them.
    let ends_in_words = last == 1 || 2 * figures < cells(last).count();
    let gap = if last == 1 { " " } else { "  " };
    let cell = |(column, cell): (usize, &&str)| {
        let widths = cells(column).map(|it| it.chars().count());
        let width = widths.max().unwrap_or(0);
        match column {
            0 => format!("{cell:0$}", width.max(names)),
            _ if column == last && ends_in_words => format!("{gap}{cell}"),
            _ => format!("{gap}{cell:>width$}"),
        }
    };
    let text: String = line.iter().enumerate().map(cell).collect();
    text.trim_end().to_owned()
}

/// Whether a cell is a number, or the dash of none.
fn is_figure(cell: &str) -> bool {
    cell.starts_with(|it: char| it.is_ascii_digit() || "+-–×".contains(it))
}

#[cfg(test)]
mod tests {
    use super::aligned;

    /// Each table has its own widths; names reach as far as all of them are to begin.
    #[test]
    fn tables_are_aligned_each_by_itself() {
        let text =
            "a\tb\tfirst\n  one\t1.5\tleft, right\n  two\t–\t–\nnext\tb\tlast\n  x\t2\t10.25\nends";
        let wanted = "a         b  first\n  one   1.5  left, right\n  two     –  –\nnext    b   last\n  x     2  10.25\nends";
        assert_eq!(aligned(text, 6), wanted);
    }

    /// What is said of a name begins in one column, whatever it is; the end of the text stays as it was.
    #[test]
    fn what_is_said_of_a_name_stands_left() {
        let text = "  mass\t12 kg\n  a longer name\tnone\n";
        let wanted = "  mass          12 kg\n  a longer name none\n";
        assert_eq!(aligned(text, 0), wanted);
    }
}
