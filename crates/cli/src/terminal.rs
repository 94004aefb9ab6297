//! The one place that writes texts to a terminal: nothing in them commands it, wherever they come from.

use std::fmt::Display;
use std::io::{self, ErrorKind, Write};

use chaindrive::plain;

use crate::failure::Failure;

/// Writes a text to stdout and ends the line; a reader that has seen enough is not an error.
pub(crate) fn print(text: impl Display) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match writeln!(out, "{}", plain(&text.to_string())).and_then(|()| out.flush()) {
        Err(source) if source.kind() != ErrorKind::BrokenPipe => Err(Failure::File {
            path: "stdout".into(),
            source,
        }),
        _ => Ok(()),
    }
}

/// Tells of a failure on stderr, with an excerpt of the scene where there is one.
pub(crate) fn tell(failure: &Failure) {
    say(format_args!("{failure:#}"));
}

/// Writes a text to stderr and ends the line.
pub(crate) fn say(text: impl Display) {
    // Nobody hears where stderr is closed.
    let _ = writeln!(io::stderr(), "{}", plain(&text.to_string()));
}
