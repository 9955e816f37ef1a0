//! The program; see `localshape::cli`.

fn main() {}
