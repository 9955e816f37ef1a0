//! Deformable bodies that keep their local shapes, simulated and drawn beside mass-spring models.
//!
//! This is the model of S. Miyazaki, J. Hasegawa, T. Yasuda and S. Yokoi, *A Deformable Object Model for Virtual
//! Manipulation Based on Maintaining Local Shapes*: elasticity belongs to volume elements that remember their shape, and
//! not to springs. [`paper`] maps its equations to this crate.
//!
//! # From code to a picture
//!
#![cfg_attr(feature = "render", doc = "```")]
#![cfg_attr(not(feature = "render"), doc = "```ignore")]
//! use localshape::scene::{BodyBuilder, Lattice, Limits, ObstacleBuilder, Rotation, Scene};
//! use localshape::sim::model::{mass_spring, shape_based};
//! use localshape::{gpu::AdapterChoice, gpu::Gpu, picture, render::Renderer, runner::Runner};
//!
//! fn main() -> Result<(), Box<dyn std::error::Error>> {
//! #     if std::env::var_os("LOCALSHAPE_REQUIRE_GPU").is_none() && localshape::gpu::adapters().0.is_empty() { return Ok(()) }
//! #     let folder = tempfile::tempdir()?;
//!     // 27 cubes of 10 cm, tilted and dropped; any mesh will do: `BodyBuilder::arrays(nodes, elements)`.
//!     let cubes = BodyBuilder::lattice(Lattice::new([3, 3, 3], 0.1));
//!     let scene = Scene::builder("cubes", cubes.rotation(Rotation::about([1.0, 0.0, 1.0], 0.4)).lowest(0.2))
//!         .gravity([0.0, -9.8, 0.0])
//!         .obstacle(ObstacleBuilder::floor(0.0).restitution(0.5))
//!         .run("Local shape", shape_based::Parameters::new(1e4))
//!         .run("Springs", mass_spring::Parameters::new(1e4))
//!         .build(&Limits::default())?;
//!     // Both runs half a second after the start, beside each other.
//!     let frame = Runner::new(&scene, &[0, 1]).frame(30);
//!     let gpu = Gpu::new(&AdapterChoice::Auto)?;
//!     let image = Renderer::new(&gpu, scene.view.size, 4)?.draw(&picture::compose(&scene, &frame))?;
//! #     let _ = r#"
//!     image.save("cubes.png")?;
//! #     "#; image.save(folder.path().join("cubes.png"))?;
//!     Ok(())
//! }
//! ```
//!
//! [`Scene::load`](scene::Scene::load) reads the same from a file.
//!
//! # The way of the data
//!
//! ```text
//! scene file ─▶ Scene ─▶ World (one per run) ─▶ Frame of Snapshots ─▶ Picture ─▶ image ─▶ files
//! ```
//!
//! [`scene`] reads and resolves, [`sim`] simulates in double precision, [`runner`] advances runs and hands out frames,
//! `picture` makes plain data of a frame, `render` draws it, `artist` does both, [`history`] tells what comes before and after it, [`moments`] takes the
//! states that a figure shows, [`table`] measures what the paper tells in numbers, [`output`] writes files, `animation` makes
//! one file of frames, [`cli`] is the program. Without the feature `render` (on by default) the crate simulates and needs no
//! graphics library.

/// The vectors in which positions are given, of the version that this crate uses.
pub use glam;

#[cfg(feature = "render")]
pub mod animation;
#[cfg(feature = "render")]
pub mod artist;
pub mod cli;
pub mod colour;
pub mod golden;
#[cfg(feature = "render")]
pub mod gpu;
pub mod history;
pub mod look;
pub mod moments;
pub mod output;
pub mod paper;
#[cfg(feature = "render")]
pub mod picture;
mod reading;
#[cfg(feature = "render")]
pub mod render;
pub mod runner;
pub mod scene;
mod shell;
pub mod sim;
pub mod table;
