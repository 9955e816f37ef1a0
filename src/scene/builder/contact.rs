//! Contact in scenes made in code.

use crate::scene::file::{ContactFile, ContactRule, PairFile};

/// Says how the surfaces of bodies meet. Scenes without it are like [`Self::surfaces`].
///
/// ```
/// use localshape::scene::{BodyBuilder, ContactBuilder, Lattice, Limits, PairBuilder, Scene};
/// use localshape::sim::model::shape_based;
///
/// let cube = |name| BodyBuilder::lattice(Lattice::new([2, 2, 2], 0.1)).name(name);
/// let scene = Scene::builder("two cubes", cube("one").lowest(0.3))
///     .body(cube("other"))
///     .contact(ContactBuilder::surfaces().friction(0.5).pair(PairBuilder::of("one", "other").restitution(0.2)))
///     .run("Local shape", shape_based::Parameters::new(1e4))
///     .build(&Limits::default())?;
/// assert_eq!(scene.contacts.unwrap().pairs[0].restitution, Some(0.2));
/// # Ok::<(), localshape::scene::SceneError>(())
/// ```
#[derive(Clone, Debug)]
#[must_use = "a builder makes nothing until its scene is built"]
pub struct ContactBuilder(pub(super) ContactFile);

impl ContactBuilder {
    /// Points meet faces and edges meet edges, of bodies and of obstacles with an extent. Nodes meet half-spaces.
    pub fn surfaces() -> Self {
        Self(ContactFile { rule: Some(ContactRule::Surfaces), ..ContactFile::default() })
    }

    /// Nodes meet obstacles, as in the paper, and nothing else meets: bodies go through each other.
    pub fn nodes() -> Self {
        Self(ContactFile { rule: Some(ContactRule::Nodes), ..ContactFile::default() })
    }

    setters! {
        /// Coefficient of restitution e between bodies, 0 to 1.
        restitution(coefficient: f64) 0.restitution = coefficient;
        /// Coefficient of friction μ between bodies.
        friction(coefficient: f64) 0.friction = coefficient;
        /// Moves bodies that overlap or touch at the start apart before it, as wholes and by the shortest straight way. Obstacles stay, and of
        /// two bodies the first.
        separate() 0.separate = true;
    }

    /// Adds a pair that meets otherwise than usual.
    pub fn pair(mut self, pair: PairBuilder) -> Self {
        self.0.pair.push(pair.0);
        self
    }
}

/// Two bodies, or a body and an obstacle, that meet otherwise than usual.
#[derive(Clone, Debug)]
#[must_use = "a builder makes nothing until its scene is built"]
pub struct PairBuilder(PairFile);

impl PairBuilder {
    /// The pair of two bodies, or of a body and an obstacle, by name.
    pub fn of(one: impl Into<String>, other: impl Into<String>) -> Self {
        Self(PairFile { of: [one.into(), other.into()], ..PairFile::default() })
    }

    setters! {
        /// Coefficient of restitution e, 0 to 1.
        restitution(coefficient: f64) 0.restitution = Some(coefficient);
        /// Coefficient of friction μ.
        friction(coefficient: f64) 0.friction = Some(coefficient);
        /// The distance that they keep (m).
        thickness(distance: f64) 0.thickness = Some(distance);
    }
}
