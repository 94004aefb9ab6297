//! `chaindrive completion` and `man`: what shells and manuals are told of the command.

use std::fs::create_dir_all;
use std::path::PathBuf;

use clap::{Args, Command};
use clap_complete::{Shell, generate};
use clap_mangen::generate_to;

use crate::failure::Failure;
use crate::terminal::print;

/// Prints a script by which a shell completes commands and options.
///
/// bash: chaindrive completion bash > ~/.local/share/bash-completion/completions/chaindrive
///
/// zsh: chaindrive completion zsh > ~/.zfunc/_chaindrive, with ~/.zfunc in fpath
///
/// fish: chaindrive completion fish > ~/.config/fish/completions/chaindrive.fish
#[derive(Debug, Args)]
pub(crate) struct Completion {
    /// Shell that reads the script
    shell: Shell,
}

/// Writes the manual pages of the command into a folder, one a verb.
///
/// In ~/.local/share/man/man1 they are found by `man chaindrive-run`.
#[derive(Debug, Args)]
pub(crate) struct Man {
    /// Folder, which is made where it is missing
    folder: PathBuf,
}

pub(crate) fn completion(arguments: &Completion, mut command: Command) -> Result<(), Failure> {
    let mut script = Vec::new();
    let name = command.get_name().to_owned();
    generate(arguments.shell, &mut command, name, &mut script);
    print(String::from_utf8_lossy(&script).trim_end())
}

pub(crate) fn man(arguments: &Man, command: Command) -> Result<(), Failure> {
    let folder = &arguments.folder;
    create_dir_all(folder)
        .and_then(|()| generate_to(command, folder))
        .map_err(|source| Failure::File {
            path: folder.display().to_string(),
            source,
        })
}
