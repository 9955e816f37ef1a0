//! The runs of a scene.

use super::{Recorded, Scene, SceneBody};
use crate::colour::Colour;
use crate::look::{LinePlace, Lined};
use crate::sim::model::ElasticModel;
use crate::sim::{
    Assembly, Body, Contacts, Grip, Integrator, Kernel, Load, Loading, Obstacle, PairContact, Side, State, Surroundings,
};
use glam::DVec3;
use serde::Serialize;
use std::ops::Range;
use std::sync::Arc;

/// Bodies of the scene with their models, and one panel of the picture.
#[derive(Clone, Debug)]
pub struct Run {
    /// Unique in its scene.
    pub name: String,
    /// The places of its bodies in [`Scene::bodies`].
    pub of: Vec<usize>,
    /// Its bodies. Runs of the same bodies share them.
    pub bodies: Arc<Assembly>,
    /// The initial state of all its bodies.
    pub initial: State,
    /// What is left of the forces at the start, if it starts at rest.
    pub rest: Option<Rest>,
    /// When it comes to rest, if the scene ends then.
    pub comes_to_rest: Option<AtRest>,
    /// Where its nodes are placed (m), if it starts at rest elsewhere.
    pub(crate) placed: Option<Vec<DVec3>>,
    /// The elastic model of each body; empty for a recording.
    pub models: Vec<Arc<dyn ElasticModel>>,
    /// The recording that it shows.
    pub recording: Option<Arc<Recorded>>,
    /// Kinematic constraints: nodes that are held or dragged, counted over all its bodies.
    pub grips: Vec<Grip>,
    /// The name of each in files, such as `hold[0]`.
    pub grip_names: Vec<String>,
    /// Loads on nodes and faces, counted over all its bodies.
    pub loads: Vec<Arc<Loading>>,
    /// The integrator.
    pub integrator: Integrator,
    /// Time step ΔT (s); the time between frames for an integrator that chooses its steps.
    pub step: f64,
    /// The error allowed in each step of an integrator that chooses its steps, as a share of the body's size; `None`
    /// for others.
    pub tolerance: Option<f64>,
    /// The code that computes a step.
    pub kernel: Kernel,
    /// The place of its line in the palette ([`Self::line`]). In a figure of several scenes, runs of one name have one place.
    pub(crate) place: LinePlace,
    /// A chosen colour of the run's lines. Other runs get different colours.
    pub colour: Option<Colour>,
}

/// How near to rest a run starts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Rest {
    /// The forces that are left, as a share of the load: see [`Equilibrium::residual`](crate::sim::Equilibrium::residual).
    pub residual: f64,
    /// How often forces were evaluated to find it.
    pub evaluations: u64,
}

/// When a run comes to rest.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AtRest {
    /// The first frame at which it is at rest.
    pub frame: u64,
    /// The greatest kinetic energy of a body since the frame before (J).
    pub kinetic_energy: f64,
    /// The mean forces that were left on a body since the frame before, as a share of gravity and loads on it, or else of the greatest that
    /// were left on it before: the largest share of all bodies.
    pub residual: f64,
}

impl Run {
    /// What decides its line.
    pub(super) fn lined(&self) -> Lined<'static> {
        let mut kinds = self.models_and_bodies().map(|(model, body)| model.properties(body).kind);
        let model = kinds.next().filter(|first| kinds.all(|other| other == *first));
        Lined { model, chosen: self.colour }
    }

    /// All its bodies as one.
    pub fn body(&self) -> &Arc<Body> {
        self.bodies.whole()
    }

    /// The names of its bodies in order; none if its only body has no name.
    pub(crate) fn body_names<'a>(&'a self, scene: &'a Scene) -> impl Iterator<Item = &'a str> {
        self.of.iter().map(|&body| &*scene.bodies[body].name).filter(|name| !name.is_empty())
    }

    /// The threads within this run, if it is one of so many that share all threads.
    pub(crate) fn threads(&self, all: usize) -> usize {
        /// The least number of elements for each additional thread.
        const LEAST: usize = 2000;
        let share = rayon::current_num_threads() / all.max(1);
        share.min(self.body().elements().len() / LEAST).max(1)
    }

    /// The name and the nodes of each of its bodies, if it has several.
    pub(crate) fn several<'a>(&'a self, scene: &'a Scene) -> impl Iterator<Item = (&'a str, Range<usize>)> + Clone {
        let bodies = if self.of.len() > 1 { self.of.len() } else { 0 };
        (0..bodies).map(|body| (&*scene.bodies[self.of[body]].name, self.bodies.nodes(body)))
    }

    /// Each model with its body.
    pub(crate) fn parts<'a>(&'a self, scene: &'a Scene) -> impl Iterator<Item = (&'a dyn ElasticModel, &'a SceneBody)> {
        self.models.iter().map(|model| &**model).zip(self.of.iter().map(|&body| &scene.bodies[body]))
    }

    /// Each model with its body at rest.
    pub(crate) fn models_and_bodies(&self) -> impl Iterator<Item = (&dyn ElasticModel, &Arc<Body>)> {
        self.models.iter().map(|model| &**model).zip(self.bodies.bodies())
    }

    /// Where its nodes are placed (m), from which displacements count.
    pub(crate) fn placed(&self) -> &[DVec3] {
        self.placed.as_ref().unwrap_or(&self.initial.position)
    }

    /// What acts on its bodies: gravity (m/s²), damping of masses (1/s), obstacles, contact as the scene says, and its own constraints and loads.
    pub(crate) fn surroundings(
        &self,
        (gravity, mass_damping): (DVec3, f64),
        obstacles: &[Obstacle],
        contacts: Option<&Contacts>,
    ) -> Surroundings {
        Surroundings {
            gravity,
            mass_damping,
            obstacles: obstacles.to_vec(),
            contacts: contacts.map(|contacts| self.contacts(contacts)),
            grips: self.grips.clone(),
            loads: self.loads.iter().map(|load| Arc::clone(load) as Arc<dyn Load>).collect(),
        }
    }

    /// Contact of its bodies, counted from its first one, from that of the bodies of the scene.
    pub(crate) fn contacts(&self, of_scene: &Contacts) -> Contacts {
        let own = |side: Side| match side {
            Side::Body(body) => Some(Side::Body(self.of.iter().position(|&of| of == body)?)),
            Side::Obstacle(_) => Some(side),
        };
        let pair = |pair: &PairContact| Some(PairContact { of: [own(pair.of[0])?, own(pair.of[1])?], ..*pair });
        Contacts {
            bodies: self.of.iter().map(|&body| of_scene.bodies.get(body).copied().unwrap_or_default()).collect(),
            pairs: of_scene.pairs.iter().filter_map(pair).collect(),
            ..*of_scene
        }
    }

    /// The shortest period of a node of any of its bodies (s).
    pub(crate) fn shortest_period(&self) -> f64 {
        let periods = self.models_and_bodies().map(|(model, body)| model.properties(body).shortest_period(body));
        periods.fold(f64::INFINITY, f64::min)
    }
}
