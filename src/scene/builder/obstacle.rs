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

    setters! {
        /// Restitution coefficient e, 0 to 1: the part of the normal velocity that a rebound gives back.
        restitution(coefficient: f64) 0.restitution = coefficient;
        /// Friction coefficient μ.
        friction(coefficient: f64) 0.friction = coefficient;
        /// What friction acts on.
        friction_of(what: FrictionOf) 0.friction_of = Some(what);
        /// The point about which it turns when it moves (m), instead of its middle.
        about(point: impl Into<Coordinates>) 0.about = Some(point.into());
        /// Moves it along a path, and not by a swing.
        path(path: MotionPath) 0.path = Some(path);
        /// Moves it to and fro, and not along a path.
        swing(swing: Swing) 0.swing = Some(swing);
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

    setters! {
        /// How it runs between two keys.
        ease(ease: Ease) ease = ease;
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

    setters! {
        /// Where in the swing it is at the start (rad).
        phase(phase: f64) phase = phase;
        /// The farthest shift (m).
        shift(shift: impl Into<Coordinates>) shift = Some(shift.into());
        /// The farthest turn.
        rotation(rotation: Rotation) rotation = Some(rotation);
    }
}
