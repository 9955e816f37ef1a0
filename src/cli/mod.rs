//! The command line: one file per command, texts and exit statuses, no physics.
//!
//! It is part of the library so that tests and other programs can call it. Exit statuses: 0 done; 1 a comparison found a
//! difference; 2 wrong usage or a wrong scene; 3 no usable graphics adapter; 4 reading or writing failed;
//! 130 interrupted.

/// Ends a function with wrong usage, with a message as of `format!`.
macro_rules! bail {
    ($($message:tt)*) => { return Err($crate::cli::failure::Failure::usage(format!($($message)*))) };
}

#[cfg(feature = "render")]
mod animate;
mod check;
mod compare;
mod completions;
mod console;
#[cfg(feature = "render")]
mod drawing;
#[cfg(feature = "render")]
mod driver;
mod failure;
#[cfg(feature = "render")]
mod figure;
#[cfg(feature = "render")]
mod film;
mod frames;
mod info;
mod interrupt;
mod options;
mod record;
#[cfg(feature = "render")]
mod render;
mod report;
mod results;
mod scenes;
mod schema;
mod simulate;
#[cfg(feature = "render")]
mod still;

#[cfg(feature = "render")]
pub use {
    animate::{animate, check_animation},
    driver::{settle, width_to_set},
    still::{doubts, unprintable},
};
pub use {
    console::print,
    failure::{Failure, Status},
    interrupt::{listen, requested},
    options::ThreadOptions,
};

use clap::{Parser, Subcommand};
use std::ffi::OsString;

const STATUSES: &str = "\
Exit status:
    0  done, even if a run diverges, which is recorded
    1  a comparison found a difference
    2  wrong usage, or mistakes in a scene file
    3  no usable graphics adapter
    4  reading or writing failed
  130  interrupted by Ctrl-C, SIGTERM or SIGHUP; files made until then are complete
       (a second Ctrl-C, a second later, ends the program at once)";

#[cfg(not(feature = "render"))]
const EXAMPLES: &str = "\
Examples:
  localshape simulate scenes/fig4b.toml        diagnostics and a summary in output/fig4b/
  localshape check scenes/*.toml               what scenes contain, or every mistake in them

This program was built without the feature `render`: it cannot draw pictures.";

#[cfg(feature = "render")]
const EXAMPLES: &str = "\
Examples:
  localshape render scenes/fig4b.toml          frames, diagnostics and a summary in output/fig4b/
  localshape simulate scenes/fig4b.toml        diagnostics and a summary, without pictures
  localshape check scenes/*.toml               what scenes contain, or every mistake in them
  localshape animate output/fig4b -o fig4b.gif frames as an animation
  localshape figure all                        the paper's figures in output/figures/";

/// Simulate deformable bodies that keep their local shapes, and draw them beside mass-spring models
#[derive(Debug, Parser)]
#[command(name = "localshape", version, after_help = format!("{EXAMPLES}\n\n{STATUSES}"))]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    #[cfg(feature = "render")]
    Render(render::Render),
    Simulate(simulate::Simulate),
    #[cfg(feature = "render")]
    Figure(figure::FigureCommand),
    #[cfg(feature = "render")]
    Animate(animate::Animate),
    Check(check::Check),
    Compare(compare::Compare),
    Info(info::Info),
    Schema(schema::Schema),
    Completions(completions::Completions),
}

/// Runs the program with the arguments of a command line, the program's name first, and returns its exit status.
///
/// Results go to standard output, progress and errors to standard error. Signals are handled from the start of the
/// first scene.
pub fn run(words: impl IntoIterator<Item = OsString>) -> Status {
    let words: Vec<_> = words.into_iter().collect();
    interrupt::outlive_file_limits();
    match Cli::try_parse_from(&words) {
        Ok(cli) => cli.command.run(&words).unwrap_or_else(Failure::report),
        // Help and version are such errors, too. If printing fails, there is nowhere to report it.
        Err(error) => {
            let _ = error.print();
            if error.use_stderr() { Status::Usage } else { Status::Done }
        }
    }
}

impl Command {
    fn run(self, words: &[OsString]) -> Result<Status, Failure> {
        match self {
            #[cfg(feature = "render")]
            Self::Render(render) => render.run(words),
            Self::Simulate(simulate) => simulate.run(words),
            #[cfg(feature = "render")]
            Self::Figure(figure) => figure.run(),
            #[cfg(feature = "render")]
            Self::Animate(animate) => animate.run(words),
            Self::Check(check) => check.run(),
            Self::Compare(compare) => compare.run(),
            Self::Info(info) => info.run(),
            Self::Schema(schema) => schema.run(),
            Self::Completions(completions) => completions.run(),
        }
    }
}
