//! How the program ends.

use std::io::Write as _;
use std::process::ExitCode;

/// Exit statuses, with the numbers of `localshape`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Status {
    Done = 0,
    Usage = 2,
    Files = 4,
    Interrupted = 130,
}

impl From<Status> for ExitCode {
    fn from(status: Status) -> Self {
        Self::from(status as u8)
    }
}

/// Why a study ended early: the status, and the message for the user.
#[derive(Debug)]
pub(crate) struct Failure(Status, String);

impl Failure {
    /// Wrong usage, or mistakes in a scene.
    pub(crate) fn usage(message: impl Into<String>) -> Self {
        Self(Status::Usage, message.into())
    }

    /// Reading or writing failed.
    pub(crate) fn files(message: impl Into<String>) -> Self {
        Self(Status::Files, message.into())
    }

    /// Prints the message and returns the exit status.
    pub(crate) fn report(self) -> Status {
        // If printing fails there is nowhere to report it.
        let _ = writeln!(std::io::stderr(), "error: {}", self.1);
        self.0
    }
}
