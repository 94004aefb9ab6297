//! The verbs.

pub(crate) mod bench;
pub(crate) mod check;
pub(crate) mod describe;
pub(crate) mod design;
pub(crate) mod draw;
pub(crate) mod fmu;
pub(crate) mod lists;
pub(crate) mod output;
pub(crate) mod replay;
pub(crate) mod report;
pub(crate) mod resume;
pub(crate) mod run;
pub(crate) mod scenes;
pub(crate) mod schemas;
pub(crate) mod shell;
pub(crate) mod sweep;
