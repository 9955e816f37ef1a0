//! The program; see [`localshape::cli`].

use std::process::ExitCode;

fn main() -> ExitCode {
    let words: Vec<_> = std::env::args_os().collect();
    #[cfg(feature = "render")]
    localshape::cli::settle(&words);
    localshape::cli::run(words)
}
