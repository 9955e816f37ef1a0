//! Rotations of elements (Eqs. 6–16).
