//! Integration tests in one binary: linking dozens of them takes longer than running them.

mod bench;
mod command;
mod command_line;
mod first_use;
mod interrupt;
mod mistakes;
mod misuse;
mod new_files;
mod replay;
mod resume;
mod same_run;
mod shell;
mod store_faults;
mod sweep;
mod told;
