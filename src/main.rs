//! The program.

use localshape::internals;
use std::process::ExitCode;

fn main() -> ExitCode {
    let words: Vec<_> = std::env::args_os().collect();
    #[cfg(feature = "render")]
    internals::settle(&words);
    internals::run(words).into()
}
