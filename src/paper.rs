#![doc = include_str!("../docs/paper.md")]
