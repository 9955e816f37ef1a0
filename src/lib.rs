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
//! use localshape::sim::model::{mass_spring, shape_based};
//! use localshape::{
//!     AdapterChoice, BodyBuilder, FrameFolder, Gpu, Lattice, Limits, ObstacleBuilder, Renderer, Rotation, Runner, Scene,
//!     compose,
//! };
//!
//! fn main() -> Result<(), Box<dyn std::error::Error>> {
//! #     if std::env::var_os("LOCALSHAPE_REQUIRE_GPU").is_none() && localshape::gpu::adapters().0.is_empty() { return Ok(()) }
//! #     let place = tempfile::tempdir()?;
//!     // 27 cubes of 10 cm, tilted and dropped; any mesh will do: `BodyBuilder::arrays(nodes, elements)`.
//!     let cubes = BodyBuilder::lattice(Lattice::new([3, 3, 3], 0.1));
//!     let mut scene = Scene::builder("cubes", cubes.rotation(Rotation::about([1.0, 0.0, 1.0], 0.4)).lowest(0.2))
//!         .gravity([0.0, -9.8, 0.0])
//!         .obstacle(ObstacleBuilder::floor(0.0).restitution(0.5))
//!         .run("Local shape", shape_based::Parameters { damping_ratio: Some(0.1), ..shape_based::Parameters::new(1e4) })
//!         .run("Springs", mass_spring::Parameters { damping_ratio: Some(0.1), ..mass_spring::Parameters::new(1e4) })
//!         .build(&Limits::default())?;
//!     scene.view.labels.letters = true; // `View` has all that pictures show.
//!     // Both runs half a second after the start, beside each other.
//!     let frame = Runner::new(&scene, &[0, 1]).frame(30);
//!     let gpu = Gpu::new(&AdapterChoice::Auto)?;
//!     let image = Renderer::new(&gpu, scene.view.size)?.draw(&compose(&scene, &frame))?;
//!     // `frame_00030.png` and a row of `diagnostics.csv` for each run.
//! #     let _ = r#"
//!     let mut folder = FrameFolder::create("cubes", &scene)?;
//! #     "#; let mut folder = FrameFolder::create(place.path(), &scene)?;
//!     folder.write_picture(&frame, &image, &gpu)?;
//!     folder.write_diagnostics(&frame)?;
//!     folder.finish()?;
//!     Ok(())
//! }
//! ```
//!
//! [`Scene::load`](scene::Scene::load) reads the same from a file. Models have the parameters of scene files: the shape model
//! ([`shape_based::Parameters`](sim::model::shape_based::Parameters)) `damping` or `damping_ratio`, `damping_of`, and the
//! solver of its rotations, such as `rotation: Some(RotationReading::Arctangent)` with `passes: Some(2)` for the paper's.
//! [`RunBuilder`] sets time step and integrator of a run, [`View`](look::View) the contents of pictures.
//!
//! # Modules
//!
//! ```text
//! scene file or builder ─▶ Scene ─▶ Runner ─▶ Frame of Snapshots ─▶ Picture ─▶ image
//! ```
//!
//! [`scene`] makes scenes, in code or from files: a body, models on it, and their surroundings. [`runner`] advances the runs
//! of a scene side by side and returns frames. [`sim`] simulates a run in double precision: states, diagnostics, the
//! elastic models, and the traits for models of your own ([`sim::model`]). [`look`] has the view, `picture`
//! lays out a frame, `render` draws it on the device of `gpu`, and `animation` makes one file of many images. [`golden`]
//! tests scenes of your own against stored results in `cargo test`. [`paper`] maps the paper's equations to this crate.
//!
//! # Features
//!
//! `render`, on by default, is everything that draws. Without it the crate simulates, and needs no graphics library.

/// The vectors in which positions are given, of the version that this crate uses.
pub use glam;
/// Mesh files, and bodies that fill surfaces.
pub use localshape_mesh as mesh;
/// The simulation.
pub use localshape_sim as sim;
/// Keys of scene files in memory, of the version that this crate uses.
pub use toml;

#[cfg(test)]
extern crate self as localshape;

#[cfg(feature = "render")]
pub use gpu::{AdapterChoice, Gpu};
pub use output::FrameFolder;
#[cfg(feature = "render")]
pub use render::Renderer;
pub use runner::Runner;
pub use scene::{
    BodyBuilder, Lattice, Limits, LoadBuilder, NodeSet, ObstacleBuilder, Rotation, RunBuilder, Scene, SceneBuilder,
    SceneError,
};

#[cfg(feature = "render")]
pub mod animation;
#[cfg(feature = "render")]
mod bins;
mod carried;
mod cli;
mod colour;
pub mod golden;
#[cfg(feature = "render")]
pub mod gpu;
#[doc(hidden)]
pub mod internals;
pub mod look;
mod output;
#[allow(rustdoc::private_intra_doc_links, reason = "it maps equations to code inside, which few readers build")]
pub mod paper;
#[cfg(feature = "render")]
pub mod picture;
mod reading;
#[cfg(feature = "render")]
pub mod render;
pub mod runner;
pub mod scene;
#[cfg(feature = "render")]
pub mod vector;

/// Composes a frame of a scene, as the program does.
///
/// Pictures may show the course of the scene: a camera that follows takes its scale from it, and charts and paths show it.
/// The runs of the frame are then simulated over the whole scene. For many frames, a [`Composer`](picture::Composer) with
/// [`History::for_pictures`](runner::History::for_pictures) does that only once.
#[cfg(feature = "render")]
pub fn compose(scene: &Scene, frame: &runner::Frame) -> picture::Picture {
    let runs: Vec<_> = frame.runs.iter().map(|run| run.run).collect();
    picture::Composer::new(scene, &runner::History::for_pictures(scene, &runs)).compose(frame)
}

// Tests of the inside, as large as other crates.
#[cfg(test)]
#[path = "../tests/physics/mod.rs"]
mod physics_tests;
#[cfg(all(test, feature = "render"))]
#[path = "../tests/render/mod.rs"]
mod render_tests;
#[cfg(test)]
#[path = "../tests/scene/mod.rs"]
mod scene_tests;
