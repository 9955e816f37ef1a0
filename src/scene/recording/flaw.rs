//! Mistakes in the files of recordings.

use crate::reading::words::count;
use crate::scene::limits::Limits;
use std::fmt;

/// A mistake in a file.
#[derive(Clone, Debug)]
pub(crate) struct Flaw {
    /// The array or entry; empty for the whole file.
    pub(in crate::scene) place: String,
    pub(in crate::scene) message: String,
    pub(in crate::scene) help: Option<String>,
}

impl Flaw {
    pub(crate) fn new(place: impl Into<String>, message: impl Into<String>) -> Self {
        Self { place: place.into(), message: message.into(), help: None }
    }

    /// With a remedy.
    pub(crate) fn with_help(self, help: impl Into<String>) -> Self {
        Self { help: Some(help.into()), ..self }
    }
}

impl fmt::Display for Flaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { place, message, help } = self;
        if !place.is_empty() {
            write!(f, "`{place}` ")?;
        }
        write!(f, "{message}")?;
        help.iter().try_for_each(|help| write!(f, "; {help}"))
    }
}

/// Refuses recordings that are too long to be copied.
pub(in crate::scene) fn check_length(moments: u64, nodes: u64, limits: &Limits) -> Result<(), Flaw> {
    // As many as 64 bits can count bytes of.
    let most = limits.recorded.min(u64::MAX / 48);
    if moments.saturating_mul(nodes) <= most {
        return Ok(());
    }
    let [moments, nodes, most] = [moments, nodes, most].map(|number| count(number.into()));
    let message = format!("has {moments} moments of {nodes} points; the limit is {most} points in all moments");
    let help = "record fewer moments, or allow it with --allow-large (in code, `Limits::NONE`)";
    Err(Flaw::new("", message).with_help(help))
}
