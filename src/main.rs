//! The program; see [`localshape::cli`].

use std::process::ExitCode;

fn main() -> ExitCode {
    localshape::cli::run(std::env::args_os())
}
