//! `completions`: shell completions.

use super::Cli;
use super::console::print;
use super::failure::{Failure, Status};
use clap::{Args, CommandFactory};
use clap_complete::Shell;

const EXAMPLES: &str = "\
Examples:
  localshape completions bash > ~/.local/share/bash-completion/completions/localshape
  localshape completions zsh > ~/.zfunc/_localshape
  localshape completions fish > ~/.config/fish/completions/localshape.fish";

/// Print shell completions
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct Completions {
    /// The shell
    #[arg(value_name = "SHELL")]
    shell: Shell,
}

impl Completions {
    pub(super) fn run(self) -> Result<Status, Failure> {
        let mut text = Vec::new();
        let mut command = Cli::command();
        let name = command.get_name().to_owned();
        clap_complete::generate(self.shell, &mut command, name, &mut text);
        print(&String::from_utf8_lossy(&text))?;
        Ok(Status::Done)
    }
}
