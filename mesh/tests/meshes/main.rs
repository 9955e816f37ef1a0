//! Files of meshes read, and surfaces filled, by the public interface.

mod common;
mod cubes;
mod cut;
mod read;
mod real;
mod shells;
mod steps;
mod surfaces;
