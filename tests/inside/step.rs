//! Tests of `src/scene/step.rs`.

use super::NamedStep::{self, Auto, Divided, Times};

#[test]
fn fractions_are_read_in_either_order_and_with_any_spaces() {
    for (text, expected) in [
        ("T/50", Divided(50.0)),
        (" T / 12.5 ", Divided(12.5)),
        ("0.02 T", Times(0.02)),
        ("2e-2T", Times(0.02)),
        ("T", Times(1.0)),
        ("auto", Auto),
    ] {
        assert_eq!(NamedStep::try_from(text.to_owned()), Ok(expected), "{text}");
        assert_eq!(NamedStep::try_from(String::from(expected)), Ok(expected), "{text}");
    }
}

#[test]
fn anything_else_is_refused() {
    for text in [
        "", "T/", "T/0", "T/-3", "-1 T", "0 T", "t/50", "50", "T*2", "TT", "inf T", "T/nan", "T/50 s", "Auto", "auto/2",
    ] {
        assert!(NamedStep::try_from(text.to_owned()).is_err(), "{text}");
    }
}
