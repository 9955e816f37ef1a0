//! Time steps typed as text: a fraction of the cycle T, or `auto`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A step as text: `"auto"`, or a fraction of the cycle T. `"T/50"` and `"0.02 T"` may differ in the last bit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "String", into = "String")]
pub(super) enum NamedStep {
    /// A share of the predicted largest stable step.
    Auto,
    /// T over this number.
    Divided(f64),
    /// T times this number.
    Times(f64),
}

impl NamedStep {
    /// The time step (s) for a cycle T (s); `None` for `auto`.
    pub(super) fn of(self, cycle: f64) -> Option<f64> {
        match self {
            Self::Auto => None,
            Self::Divided(parts) => Some(cycle / parts),
            Self::Times(factor) => Some(cycle * factor),
        }
    }
}

impl TryFrom<String> for NamedStep {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let text = text.trim();
        let number = |text: &str| {
            let text = text.trim();
            let value: f64 = text.parse().ok()?;
            (text.starts_with(|c: char| c.is_ascii_digit() || c == '.') && value > 0.0 && value.is_finite())
                .then_some(value)
        };
        let read = if text == "auto" {
            Some(Self::Auto)
        } else if text == "T" {
            Some(Self::Times(1.0))
        } else if let Some(parts) = text.strip_prefix('T').and_then(|rest| rest.trim_start().strip_prefix('/')) {
            number(parts).map(Self::Divided)
        } else {
            text.strip_suffix('T').and_then(number).map(Self::Times)
        };
        read.ok_or_else(|| "expected a fraction of the cycle T such as \"T/50\" or \"0.02 T\", \"auto\"".into())
    }
}

impl From<NamedStep> for String {
    fn from(step: NamedStep) -> Self {
        match step {
            NamedStep::Auto => "auto".to_owned(),
            NamedStep::Divided(parts) => format!("T/{parts}"),
            NamedStep::Times(factor) => format!("{factor} T"),
        }
    }
}

#[cfg(test)]
#[path = "../../tests/inside/step.rs"]
mod tests;
