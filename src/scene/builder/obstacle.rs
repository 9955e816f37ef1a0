//! Obstacles and motions made in code.

use crate::scene::file::{Coordinates, KeyFile, MotionPath, ObstacleFile, Rotation, ShapeFile, Swing};
use crate::sim::{Ease, FrictionOf};

/// Builds a rigid obstacle that bodies collide with. It is fixed unless a path or a swing moves it.
#[derive(Clone, Debug)]
#[must_use = "a builder makes nothing until its scene is built"]
pub struct ObstacleBuilder(pub(super) ObstacleFile);

impl ObstacleBuilder {
    fn new(shape: ShapeFile) -> Self {
        let (name, about, path, swing) = (None, None, None, None);
        Self(ObstacleFile { shape, name, restitution: 0.0, friction: 0.0, friction_of: None, about, path, swing })
    }

    /// A level floor at a height (m).
    pub fn floor(height: f64) -> Self {
        Self::new(ShapeFile::Floor { normal: None, height })
    }

    /// A floor or wall with an outward normal, at a distance from the origin along it (m).
    pub fn wall(normal: impl Into<Coordinates>, distance: f64) -> Self {
        Self::new(ShapeFile::Floor { normal: Some(normal.into()), height: distance })
    }

    /// A half-space that is drawn as a plate around a point of its surface (m), with an outward normal.
    pub fn plate(point: impl Into<Coordinates>, normal: impl Into<Coordinates>) -> Self {
        Self::new(ShapeFile::Plate { point: point.into(), normal: normal.into() })
    }

    /// A ball, in the plane a disc, with its centre and radius (m).
    pub fn sphere(centre: impl Into<Coordinates>, radius: f64) -> Self {
        Self::new(ShapeFile::Sphere { centre: centre.into(), radius })
    }

    /// A rod with round ends: their centres and its radius (m).
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
        /// The name, which pairs of a [`ContactBuilder`](super::ContactBuilder) use. No body has it.
        name(name: impl Into<String>) 0.name = Some(name.into());
        /// Coefficient of restitution e, 0 to 1: the part of the normal velocity that a rebound keeps.
        restitution(coefficient: f64) 0.restitution = coefficient;
        /// Coefficient of friction μ.
        friction(coefficient: f64) 0.friction = coefficient;
        /// The motion that friction acts on.
        friction_of(what: FrictionOf) 0.friction_of = Some(what);
        /// The point about which motions rotate (m), instead of the centre.
        about(point: impl Into<Coordinates>) 0.about = Some(point.into());
        /// Keyframes along which the obstacle moves. Not together with a swing.
        path(path: MotionPath) 0.path = Some(path);
        /// An oscillation. Not together with a path.
        swing(swing: Swing) 0.swing = Some(swing);
    }
}

impl MotionPath {
    /// A path without keys, which must be added.
    #[expect(clippy::new_without_default, reason = "no path is meant to have no keys")]
    pub fn new() -> Self {
        Self { keys: Vec::new(), ease: Ease::default(), repeat: false }
    }

    /// Adds a key with a translation (m) from the place without a path, at a time (s) after all others.
    pub fn key(mut self, time: f64, shift: impl Into<Coordinates>) -> Self {
        self.keys.push(KeyFile { time, shift: Some(shift.into()), rotation: None });
        self
    }

    /// Adds a key with a translation (m) and a rotation, at a time (s) after all others.
    pub fn turned_key(mut self, time: f64, shift: impl Into<Coordinates>, rotation: Rotation) -> Self {
        self.keys.push(KeyFile { time, shift: Some(shift.into()), rotation: Some(rotation) });
        self
    }

    setters! {
        /// The interpolation between two keys.
        ease(ease: Ease) ease = ease;
    }

    /// Begins again at the last key, whose pose must be that of the first.
    pub fn repeating(self) -> Self {
        Self { repeat: true, ..self }
    }
}

impl Swing {
    /// An oscillation with a period (s), which needs a translation or a rotation.
    pub fn new(period: f64) -> Self {
        Self { period, phase: 0.0, shift: None, rotation: None }
    }

    setters! {
        /// The phase at the start (rad).
        phase(phase: f64) phase = phase;
        /// The amplitude of the translation (m).
        shift(shift: impl Into<Coordinates>) shift = Some(shift.into());
        /// The amplitude of the rotation.
        rotation(rotation: Rotation) rotation = Some(rotation);
    }
}
