//! Deformable bodies that keep their local shapes, simulated and drawn beside mass-spring models.
//!
//! This is the model of S. Miyazaki, J. Hasegawa, T. Yasuda and S. Yokoi, *A Deformable Object Model for Virtual
//! Manipulation Based on Maintaining Local Shapes*: elasticity belongs to volume elements that remember their shape, and
//! not to springs. [`paper`] maps its equations to this crate.
//!
//! # From a scene to a picture
//!
#![cfg_attr(feature = "render", doc = "```")]
#![cfg_attr(not(feature = "render"), doc = "```ignore")]
//! use localshape::gpu::{AdapterChoice, Gpu};
//! use localshape::scene::{Limits, Scene};
//! use localshape::runner::Runner;
//! use localshape::{picture, render::Renderer};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let scene = Scene::load("scenes/fig4b.toml".as_ref(), &Limits::default())?;
//! // Both runs, half a second after they touched the floor.
//! let frame = Runner::new(&scene, &[0, 1]).frame(30);
//! assert_eq!(frame.runs[0].snapshot.diagnostics.turned_over, 0);
//! assert_eq!(frame.runs[1].snapshot.diagnostics.turned_over, 9);
//! # if std::env::var_os("LOCALSHAPE_REQUIRE_GPU").is_none() && localshape::gpu::adapters().0.is_empty() { return Ok(()) }
//! let gpu = Gpu::new(&AdapterChoice::Auto)?;
//! let image = Renderer::new(&gpu, scene.view.size, 4)?.draw(&picture::compose(&scene, &frame))?;
//! # let folder = tempfile::tempdir()?; let path = folder.path().join("cubes.png");
//! # let _ = r#"
//! image.save("cubes.png")?;
//! # "#; image.save(path)?;
//! # Ok(())
//! # }
//! ```
//!
//! A body made in code becomes a scene by [`Scene::new`](scene::Scene::new), with a camera that shows it.
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
