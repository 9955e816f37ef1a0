//! Exit statuses and error messages.

use crate::output::OutputError;
use crate::scene::{Mistakes, Scene};
use std::error::Error;
use std::io::{self, Write as _};
use std::path::Path;
use std::process::ExitCode;

/// How the program ends. The numbers are part of its interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// All is done.
    Done = 0,
    /// A comparison found a difference.
    Difference = 1,
    /// Wrong usage, or mistakes in a scene.
    Usage = 2,
    /// No graphics adapter can be used.
    #[cfg(feature = "render")]
    Adapter = 3,
    /// Reading or writing failed.
    Files = 4,
    /// A signal asked the program to end.
    Interrupted = 130,
}

impl From<Status> for ExitCode {
    fn from(status: Status) -> Self {
        Self::from(status as u8)
    }
}

/// Why a command ended early.
#[derive(Debug)]
pub struct Failure {
    status: Status,
    /// The message; `None` if it was printed already.
    message: Option<String>,
}

impl Failure {
    /// Wrong usage, or mistakes in a scene.
    pub fn usage(message: impl Into<String>) -> Self {
        Self { status: Status::Usage, message: Some(message.into()) }
    }

    /// An error with its causes.
    pub(super) fn new(status: Status, error: &dyn Error) -> Self {
        Self { status, message: Some(with_causes(error)) }
    }

    /// Reading or writing failed.
    pub fn files(message: impl Into<String>) -> Self {
        Self { status: Status::Files, message: Some(message.into()) }
    }

    /// An end without a message.
    pub(super) fn silent(status: Status) -> Self {
        Self { status, message: None }
    }

    /// Adds a remedy to the message.
    #[cfg(feature = "render")]
    pub(super) fn advise(mut self, advice: &str) -> Self {
        self.message = self.message.map(|message| format!("{message}; {advice}"));
        self
    }

    /// The exit status and the message, unless it was printed already.
    pub fn told(&self) -> (Status, &str) {
        (self.status, self.message.as_deref().unwrap_or_default())
    }

    /// Prints the message and returns the exit status.
    pub fn report(self) -> Status {
        if let Some(message) = &self.message {
            complain(message);
        }
        self.status
    }
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        let status = match &error {
            // Another folder must be chosen; nothing was written.
            OutputError::Occupied { .. } | OutputError::NoFile { .. } | OutputError::InUse { .. } => Status::Usage,
            OutputError::States { .. } | OutputError::Checkpoint { .. } => Status::Usage,
            OutputError::NoFolder { .. } | OutputError::Write { .. } | OutputError::Read { .. } => Status::Files,
        };
        Self::new(status, &error)
    }
}

/// An error and its causes on one line.
pub(super) fn with_causes(error: &dyn Error) -> String {
    let causes = std::iter::successors(error.source(), |&cause| cause.source());
    causes.fold(error.to_string(), |text, cause| format!("{text}: {cause}"))
}

/// Prints the warnings of a scene.
pub(super) fn warn(file: &Path, scene: &Scene) {
    for one in &scene.warnings {
        let mistakes = Mistakes { file: file.display().to_string(), found: vec![one.clone()], total: 1 };
        let _ = writeln!(io::stderr(), "warning: {mistakes}");
    }
}

/// Prints a warning that is not a mistake in a scene.
pub(super) fn note(message: &str) {
    let _ = writeln!(io::stderr(), "warning: {message}");
}

/// Warns of what has no room in pictures of a file with a width and height (px).
pub(super) fn note_no_room(file: &str, [width, height]: [u32; 2], left_out: &[String]) {
    if !left_out.is_empty() {
        note(&format!("{file}: not everything has room in {width}×{height}: {}", left_out.join("; ")));
    }
}

/// Prints an error on standard error. If that fails there is nowhere to report it.
pub(super) fn complain(message: &str) {
    let _ = writeln!(io::stderr(), "error: {message}");
}
