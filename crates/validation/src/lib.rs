//! The cases of `tests/validation`: how a test reads one, and how it judges what it found.
//!
//! A [`Case`] hands out numbers by their place in `reference.json`. Its [`judge`](Case::judge) asserts, and, when the
//! environment variable `CHAINDRIVE_VERDICTS` names a file, appends the verdict to that file before it asserts. From
//! these lines `tests/validation/report.py` makes `docs/validation.md`; a row that is judged without this crate would be
//! missing there.
//!
//! Beside them stands [`run_again`], for tests that must hold on other instruction sets as well.
//!
//! For tests only: no crate depends on this one but for its own tests.

mod case;
mod rerun;
mod verdict;

pub use case::Case;
pub use rerun::run_again;
pub use verdict::Tolerance;
