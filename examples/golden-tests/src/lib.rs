//! A project of somebody else: whatever it does, `tests/goldens.rs` watches over its scene.
