//! Obstacles and motions made in code.

use crate::scene::file::{Coordinates, KeyFile, MotionPath, ObstacleFile, Rotation, ShapeFile, Swing};
use crate::sim::contact::FrictionOf;
use crate::sim::motion::Ease;

/// Makes something rigid that nodes bounce off. It stays where it is unless a path or a swing moves it.
#[derive(Clone, Debug)]
#[must_use = "a builder makes nothing until its scene is built"]
pub struct ObstacleBuilder(pub(super) ObstacleFile);

impl ObstacleBuilder {
    fn new(shape: ShapeFile) -> Self {
        let (about, path, swing) = (None, None, None);
        Self(ObstacleFile { shape, restitution: 0.0, friction: 0.0, friction_of: None, about, path, swing })
    }

    /// A level floor at a height (m).
    pub fn floor(height: f64) -> Self {
        Self::new(ShapeFile::Floor { normal: None, height })
    }

    /// A floor or wall at a distance from the origin (m) along a direction out of it.
    pub fn wall(normal: impl Into<Coordinates>, distance: f64) -> Self {
        Self::new(ShapeFile::Floor { normal: Some(normal.into()), height: distance })
    }

    /// A half-space that is drawn as a plate around a point of its surface (m), with a direction out of it.
    pub fn plate(point: impl Into<Coordinates>, normal: impl Into<Coordinates>) -> Self {
        Self::new(ShapeFile::Plate { point: point.into(), normal: normal.into() })
    }

    /// A ball, in the plane a disc, with its centre and radius (m).
    pub fn sphere(centre: impl Into<Coordinates>, radius: f64) -> Self {
        Self::new(ShapeFile::Sphere { centre: centre.into(), radius })
    }

    /// A rod with round ends, with the centres of these and its radius (m).
    pub fn capsule(from: impl Into<Coordinates>, to: impl Into<Coordinates>, radius: f64) -> Self {
        Self::new(ShapeFile::Capsule { from: from.into(), to: to.into(), radius })
    }

    /// A cuboid along the axes, in the plane a rectangle, with its centre and sides (m).
    pub fn cuboid(centre: impl Into<Coordinates>, size: impl Into<Coordinates>) -> Self {
        Self::new(ShapeFile::Box { centre: centre.into(), size: size.into(), rotation: None })
    }

    /// A rotated cuboid.
    pub fn turned_cuboid(centre: impl Into<Coordinates>, size: impl Into<Coordinates>, rotation: Rotation) -> Self {
        Self::new(ShapeFile::Box { centre: centre.into(), size: size.into(), rotation: Some(rotation) })
    }

    /// Restitution coefficient e, 0 to 1: the part of the normal velocity that a rebound gives back.
    pub fn restitution(mut self, coefficient: f64) -> Self {
        self.0.restitution = coefficient;
        self
    }

    /// Friction coefficient μ.
    pub fn friction(mut self, coefficient: f64) -> Self {
        self.0.friction = coefficient;
        self
    }

    /// What friction acts on.
    pub fn friction_of(mut self, what: FrictionOf) -> Self {
        self.0.friction_of = Some(what);
        self
    }

    /// The point about which it turns when it moves (m), instead of its middle.
    pub fn about(mut self, point: impl Into<Coordinates>) -> Self {
        self.0.about = Some(point.into());
        self
    }

    /// Moves it along a path, and not by a swing.
    pub fn path(mut self, path: MotionPath) -> Self {
        self.0.path = Some(path);
        self
    }

    /// Moves it to and fro, and not along a path.
    pub fn swing(mut self, swing: Swing) -> Self {
        self.0.swing = Some(swing);
        self
    }
}

impl MotionPath {
    /// A path without keys, which needs some.
    #[expect(clippy::new_without_default, reason = "no path is meant to have no keys")]
    pub fn new() -> Self {
        Self { keys: Vec::new(), ease: Ease::default(), repeat: false }
    }

    /// Adds a time (s), later than those before, at which it is shifted (m) from where it stands without a path.
    pub fn key(mut self, time: f64, shift: impl Into<Coordinates>) -> Self {
        self.keys.push(KeyFile { time, shift: Some(shift.into()), rotation: None });
        self
    }

    /// Adds a time (s) at which it is shifted (m) and turned.
    pub fn turned_key(mut self, time: f64, shift: impl Into<Coordinates>, rotation: Rotation) -> Self {
        self.keys.push(KeyFile { time, shift: Some(shift.into()), rotation: Some(rotation) });
        self
    }

    /// How it runs between two keys.
    pub fn ease(self, ease: Ease) -> Self {
        Self { ease, ..self }
    }

    /// Begins again at the last key, which must be where the first one is.
    pub fn repeating(self) -> Self {
        Self { repeat: true, ..self }
    }
}

impl Swing {
    /// A swing of a period (s), which needs a shift or a rotation.
    pub fn new(period: f64) -> Self {
        Self { period, phase: 0.0, shift: None, rotation: None }
    }

    /// Where in the swing it is at the start (rad).
    pub fn phase(self, phase: f64) -> Self {
        Self { phase, ..self }
    }

    /// The farthest shift (m).
    pub fn shift(self, shift: impl Into<Coordinates>) -> Self {
        Self { shift: Some(shift.into()), ..self }
    }

    /// The farthest turn.
    pub fn rotation(self, rotation: Rotation) -> Self {
        Self { rotation: Some(rotation), ..self }
    }
}
