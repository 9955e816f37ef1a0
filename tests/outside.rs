//! The crate and the program as their users see them, in one executable: each further one would link everything once more.

mod architecture;
mod cli;
mod code;
mod damaged;
mod instructions;
mod report;
