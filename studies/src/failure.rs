//! How the program ends.

use std::io::Write as _;
use std::process::ExitCode;

/// Exit statuses. The numbers are those of `localshape`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Status {
    Done = 0,
    Usage = 2,
    #[cfg(feature = "render")]
    Adapter = 3,
    Files = 4,
    Interrupted = 130,
}

impl From<Status> for ExitCode {
    fn from(status: Status) -> Self {
        Self::from(status as u8)
    }
}

/// Why a study ended early: the message for the user.
#[derive(Debug)]
pub(crate) enum Failure {
    /// Wrong usage, or mistakes in a scene.
    Usage(String),
    /// There is no usable graphics adapter.
    #[cfg(feature = "render")]
    Adapter(String),
    /// Reading or writing failed.
    Files(String),
}

impl Failure {
    /// Prints the message and returns the exit status.
    pub(crate) fn report(self) -> Status {
        let (status, message) = match self {
            Self::Usage(message) => (Status::Usage, message),
            #[cfg(feature = "render")]
            Self::Adapter(message) => (Status::Adapter, message),
            Self::Files(message) => (Status::Files, message),
        };
        // If printing fails there is nowhere to report it.
        let _ = writeln!(std::io::stderr(), "error: {message}");
        status
    }
}
