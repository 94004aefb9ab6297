//! `chaindrive completion` and `man`: what shells and manuals are told of the command.

use std::path::PathBuf;

use clap::{Args, Command};
use clap_complete::{Shell, generate};
use clap_mangen::Man as Page;

use super::output::new_file;
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
    // The name of the command stands before that of a verb.
    let mut command = command.disable_help_subcommand(true);
    command.build();
    let verbs = command.get_subcommands().filter(|it| !it.is_hide_set());
    for command in verbs.cloned().chain([command.clone()]) {
        let page = Page::new(command);
        let path = arguments.folder.join(page.get_filename());
        let place = new_file(&path, true)?;
        let mut text = Vec::new();
        page.render(&mut text).map_err(|source| Failure::File {
            path: path.display().to_string(),
            source,
        })?;
        place.write(&text)?;
    }
    Ok(())
}
