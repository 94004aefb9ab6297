//! The one place that writes to stdout.

use std::fmt::Display;
use std::io::{self, ErrorKind, Write};

use crate::failure::Failure;

/// Writes a text and ends the line; a reader that has seen enough is not an error.
pub(crate) fn print(text: impl Display) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match writeln!(out, "{text}").and_then(|()| out.flush()) {
        Err(source) if source.kind() != ErrorKind::BrokenPipe => Err(Failure::File {
            path: "stdout".into(),
            source,
        }),
        _ => Ok(()),
    }
}
