//! The table of a body in a scene, and its nodes and elements before the body is made.

use super::elements;
use super::lists::Lists;
use crate::reading::collector::Here;
use crate::scene::SceneBody;
use crate::scene::file::BodyFile;
use crate::scene::generate::Generator;
use crate::sim::{Body, BodyError, Solids, State};
use glam::DVec3;
use localshape_mesh::{Filled, Group};
use std::sync::Arc;

/// The table of a body.
#[derive(Debug)]
pub(super) struct BodyTable<'a> {
    pub(super) file: &'a BodyFile,
    /// Its place in the scene.
    pub(super) here: Here<'a>,
    /// Whether keys were left out because of mistakes, or lists have some.
    pub(super) flawed: bool,
}

impl<'a> BodyTable<'a> {
    /// The name of its mesh file.
    pub(super) fn mesh(&self) -> &'a str {
        self.file.mesh.as_deref().unwrap_or_default()
    }

    /// The interpretation of elements with four, five, six and eight nodes, unless they say.
    pub(super) fn solids(&self, usual: Solids) -> Solids {
        if self.file.convex { Solids::Convex } else { usual }
    }

    /// A body, or `None` after reporting a mistake that the checks of its table have not found.
    pub(super) fn sound(&self, made: Result<Body, BodyError>) -> Option<Body> {
        made.map_err(|error| self.here.wrong(error.to_string(), "correct its nodes, elements or masses")).ok()
    }

    /// The resolved body in an initial state, whose edges have a length (m), or else their mean one.
    pub(super) fn resolved(&self, body: Body, initial: State, side: Option<f64>) -> SceneBody {
        SceneBody {
            name: self.file.name.clone().unwrap_or_default(),
            side: side.unwrap_or_else(|| elements::mean_edge(&body)),
            body: Arc::new(body),
            initial,
            separated: DVec3::ZERO,
            has_cells: false,
            springs: None,
            groups: Vec::new(),
            surface_groups: Vec::new(),
            regions: Vec::new(),
        }
    }
}

/// The nodes and elements of a body before it is made.
#[derive(Debug)]
pub(super) enum Content<'a> {
    Generated(Generator<'a>),
    /// Listed ones, and groups of nodes.
    Listed(Box<Lists<'a>>, Vec<Group>),
    /// A surface with the elements that fill it, and the length of their edges (m).
    Filled(Box<Filled>, f64),
}
