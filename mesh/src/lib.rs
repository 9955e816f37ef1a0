//! Mesh files read, checked and mended, and surfaces filled with elements that carry them.
//!
//! [`read`] makes a [`Mesh`] of a file: a [`Volume`], whose cells become elements as they are, or a [`Surface`]. [`fill`] makes a
//! [`Cage`] of elements that contains a surface, and the weights by which the surface follows the nodes of the cage. No function
//! uses more memory or time than its [`Limits`] allow. Results have the same bits on every machine and for any number of threads.

#![cfg_attr(not(test), warn(clippy::disallowed_methods, clippy::disallowed_types))]
#![warn(clippy::print_stdout, clippy::print_stderr)]

mod boxes;
mod edges;
mod fill;
mod inside;
mod read;
mod surface;
mod volume;
mod weld;

pub use edges::Sets;
pub use fill::{Cage, Fill, FillError, Filled, Thin, fill};
pub use read::{
    Beside, CellKind, Cells, Format, Limits, Listed, Mesh, ReadError, converter, read, read_cells, read_cells_with,
    read_list, read_pieces,
};
pub use surface::{Flaws, Measures, Surface};
pub use volume::{Group, Volume};
