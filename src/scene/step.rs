//! The notation for time steps: a fraction of the cycle T.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// A fraction of the cycle T, `"T/50"` or `"0.02 T"`. The two are kept apart because they may differ in the last bit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "String", into = "String")]
pub(super) enum FractionOfCycle {
    /// T over this number.
    Divided(f64),
    /// T times this number.
    Times(f64),
}

impl FractionOfCycle {
    /// The time step (s) for a cycle T (s).
    pub(super) fn of(self, cycle: f64) -> f64 {
        match self {
            Self::Divided(parts) => cycle / parts,
            Self::Times(factor) => cycle * factor,
        }
    }
}

impl FromStr for FractionOfCycle {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim();
        let number = |text: &str| {
            let text = text.trim();
            let value: f64 = text.parse().ok()?;
            (text.starts_with(|c: char| c.is_ascii_digit() || c == '.') && value > 0.0 && value.is_finite())
                .then_some(value)
        };
        let read = if text == "T" {
            Some(Self::Times(1.0))
        } else if let Some(parts) = text.strip_prefix('T').and_then(|rest| rest.trim_start().strip_prefix('/')) {
            number(parts).map(Self::Divided)
        } else {
            text.strip_suffix('T').and_then(number).map(Self::Times)
        };
        read.ok_or_else(|| "expected a fraction of the cycle T such as \"T/50\" or \"0.02 T\"".into())
    }
}

impl fmt::Display for FractionOfCycle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Divided(parts) => write!(f, "T/{parts}"),
            Self::Times(factor) => write!(f, "{factor} T"),
        }
    }
}

impl TryFrom<String> for FractionOfCycle {
    type Error = String;
    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl From<FractionOfCycle> for String {
    fn from(fraction: FractionOfCycle) -> Self {
        fraction.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::FractionOfCycle::{self, Divided, Times};

    #[test]
    fn fractions_are_read_in_either_order_and_with_any_spaces() {
        for (text, expected) in [
            ("T/50", Divided(50.0)),
            (" T / 12.5 ", Divided(12.5)),
            ("0.02 T", Times(0.02)),
            ("2e-2T", Times(0.02)),
            ("T", Times(1.0)),
        ] {
            assert_eq!(text.parse::<FractionOfCycle>(), Ok(expected), "{text}");
            assert_eq!(expected.to_string().parse::<FractionOfCycle>(), Ok(expected), "{expected}");
        }
    }

    #[test]
    fn anything_else_is_refused() {
        for text in ["", "T/", "T/0", "T/-3", "-1 T", "0 T", "t/50", "50", "T*2", "TT", "inf T", "T/nan", "T/50 s"] {
            assert!(text.parse::<FractionOfCycle>().is_err(), "{text}");
        }
    }
}
