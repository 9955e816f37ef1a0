//! Scenes that are made in code instead of being read from a file.

use super::resolve;
use super::{Run, Scene};
use crate::look::file::ViewFile;
use crate::look::{self, View, Visible};
use crate::sim::body::Body;
use crate::sim::integrate::Integrator;
use crate::sim::model::ElasticModel;
use crate::sim::state::State;
use crate::sim::world::Kernel;
use glam::DVec3;
use std::sync::Arc;

impl Run {
    /// A run of a name that is unique in its scene, with a time step (s). Its lines get their
    /// look from [`Scene::framed`].
    pub fn new(name: &str, model: Arc<dyn ElasticModel>, integrator: Integrator, step: f64) -> Self {
        let kernel = Kernel::of(model.as_ref());
        Self { name: name.into(), model, integrator, step, kernel, place: 0, colour: None }
    }
}

impl Scene {
    /// A body made in code, at rest in its rest shape: a second of it at 60 frames per second, without gravity, obstacles
    /// and grips, and looked at as if a file had said nothing of its view. All of it can be changed; a change of what is to
    /// be seen is followed by [`Self::framed`].
    ///
    #[cfg_attr(feature = "render", doc = "```")]
    #[cfg_attr(not(feature = "render"), doc = "```ignore")]
    /// use localshape::glam::DVec3;
    /// use localshape::gpu::{AdapterChoice, Gpu};
    /// use localshape::scene::{Run, Scene};
    /// use localshape::runner::Runner;
    /// use localshape::sim::body::{Body, Dimension, Solids};
    /// use localshape::sim::integrate::Integrator;
    /// use localshape::sim::model::shape_based::ShapeBased;
    /// use localshape::{picture, render::Renderer};
    /// use std::sync::Arc;
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// // A tetrahedron, thrown upwards.
    /// let rest = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    /// let elements = [&[0, 1, 2, 3][..]].into_iter().collect();
    /// let body = Body::new(Dimension::Space, rest, vec![1.0; 4], elements, Solids::Ordered, None);
    /// let model = ShapeBased {
    ///     stiffness: 1e4,
    ///     damping: 0.0,
    ///     passes: 2,
    ///     rotation: Default::default(),
    ///     damping_of: Default::default(),
    /// };
    /// let run = Run::new("Local shape", Arc::new(model), Integrator::SemiImplicitEuler, 1e-3);
    /// let mut scene = Scene::new("tetrahedron", body, vec![run]);
    /// scene.gravity = -9.8 * DVec3::Y;
    /// scene.initial.velocity.fill(DVec3::Y);
    ///
    /// let frame = Runner::new(&scene, &[0]).frame(6);
    /// # if std::env::var_os("LOCALSHAPE_REQUIRE_GPU").is_none() && localshape::gpu::adapters().0.is_empty() { return Ok(()) }
    /// let gpu = Gpu::new(&AdapterChoice::Auto)?;
    /// let image = Renderer::new(&gpu, scene.view.size, 4)?.draw(&picture::compose(&scene, &frame))?;
    /// # let _ = image;
    /// # Ok(())
    /// # }
    /// ```
    pub fn new(title: &str, body: Body, runs: Vec<Run>) -> Self {
        let side = resolve::mean_edge(&body);
        let visible = Visible::usual(body.dimension, body.len());
        let (columns, clock) = (look::columns(runs.len()), ViewFile::default().clock);
        let view = View { side, visible, columns, clock, ..View::default() };
        let scene = Self {
            title: title.into(),
            name: title.into(),
            file: None,
            digest: String::new(),
            gravity: DVec3::ZERO,
            duration: 1.0,
            frames_per_second: 60.0,
            initial: State::at_rest(body.rest.clone()),
            body: Arc::new(body),
            runs,
            obstacles: Vec::new(),
            grips: Vec::new(),
            view,
            warnings: Vec::new(),
        };
        scene.framed()
    }

    /// The same scene with the camera that it has if a file says nothing of one: it shows the body and what comes near it.
    /// It follows from the body, its start, obstacles, grips and duration. Each run has its colour and dashes.
    pub fn framed(mut self) -> Self {
        self.place_runs();
        self.view.camera = resolve::camera(&self);
        self
    }
}
