//! A project of another user. `tests/goldens.rs` tests its scene.
