//! The `chaindrive` command with laws of your own: `cargo run --release -- run timing_drive --set "…"`.

use std::process::ExitCode;

fn main() -> ExitCode {
    if let Err(error) = own_laws::register() {
        eprintln!("{error}");
        return ExitCode::FAILURE;
    }
    ExitCode::from(chaindrive_cli::run(std::env::args_os(), &|| false))
}
