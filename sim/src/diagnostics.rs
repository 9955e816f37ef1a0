//! The diagnostics: numbers that describe a state. One table defines the name, key, unit, meaning and formula of each;
//! files, strips, figures, goldens and the schema are derived from it.

use super::diagnose::BodyFacts;
use super::fill;
use super::placement::Placement;
use super::state::Nodes;
use glam::DVec3;
use std::fmt;

/// An element has turned over if its signed volume is below minus this fraction of the volume at rest.
///
/// The sign of a volume nearer to zero says nothing. For an element pressed exactly flat it is round-off. For one that lies
/// pressed flat on a floor it changes every few steps: in a step gravity moves nodes by g Δt² before contact moves them
/// back, with steps of T/50 by 1/63 of m g / k. That is a ten-thousandth of the height of the cubes of `scenes/springs.toml`.
const NO_SIGN: f64 = 1e-3;

/// An element is flat if its volume is below this fraction of the volume at rest and it has not turned over.
const FLAT: f64 = 0.01;

/// Whether an element with a volume at rest has lost it.
pub(super) fn is_flat(now: f64, at_rest: f64) -> bool {
    now.abs() < FLAT * at_rest.abs() && !is_turned_over(now, at_rest)
}

pub(super) fn is_turned_over(now: f64, at_rest: f64) -> bool {
    now * at_rest < -NO_SIGN * at_rest * at_rest
}

/// The sum of numbers of bodies, with the same bits for any order of the bodies.
fn total(of_bodies: impl Iterator<Item = f64>) -> f64 {
    let mut of_bodies: Vec<f64> = of_bodies.collect();
    of_bodies.sort_by(f64::total_cmp);
    of_bodies.into_iter().sum()
}

impl BodyFacts<'_> {
    /// The sum over its nodes, in order, of a function of mass (kg), position (m) and velocity (m/s).
    fn sum<T: Default + std::ops::AddAssign>(&self, of_node: impl Fn(f64, DVec3, DVec3) -> T) -> T {
        let Nodes { position, velocity } = self.state;
        let nodes = self.of.body.mass.iter().zip(position).zip(velocity);
        nodes.fold(T::default(), |mut sum, ((&mass, &position), &velocity)| {
            sum += of_node(mass, position, velocity);
            sum
        })
    }

    /// Whether each element has turned over.
    pub(super) fn turned_over(&self) -> impl Iterator<Item = bool> {
        self.are_whole(is_turned_over)
    }

    /// Whether each element is flat.
    pub(super) fn flat(&self) -> impl Iterator<Item = bool> {
        self.are_whole(is_flat)
    }

    /// Whether each element is not broken, and has a property by its volumes now and at rest.
    fn are_whole(&self, is: fn(f64, f64) -> bool) -> impl Iterator<Item = bool> {
        let is_gone = |at: usize| self.gone.get(at).copied().unwrap_or(false);
        let volumes = self.volumes.iter().zip(&self.of.volumes_at_rest).enumerate();
        volumes.map(move |(at, (&now, &at_rest))| is(now, at_rest) && !is_gone(at))
    }

    /// The volume of what is filled of the elements that are not broken (m³, in the plane m²).
    fn volume(&self) -> f64 {
        let fill = self.of.body.fill.as_deref();
        if !self.gone.contains(&true) {
            return fill::volume(fill, &self.volumes);
        }
        let whole: Vec<_> = self.volumes.iter().zip(&self.gone).map(|(&v, &gone)| if gone { 0.0 } else { v }).collect();
        fill::volume(fill, &whole)
    }

    /// The sum of the squared distances of the nodes from the placement (m²).
    fn squared_distances(&self) -> f64 {
        let Placement { centre, turn, .. } = *self.placement;
        let squared = self.of.centred.iter().zip(self.state.position);
        squared.map(|(&rest, &now)| (now - centre - turn * rest).length_squared()).sum()
    }
}

/// The facts of some bodies, whose diagnostics are computed together.
#[derive(Clone, Copy)]
pub(super) struct Facts<'f, 'a> {
    pub(super) bodies: &'f [BodyFacts<'a>],
    /// Acceleration of gravity (m/s²).
    pub(super) gravity: DVec3,
}

impl<'a> Facts<'_, 'a> {
    /// The sum over all nodes of a function of mass (kg), position (m) and velocity (m/s).
    fn sum(self, of_node: impl Fn(f64, DVec3, DVec3) -> f64) -> f64 {
        self.total(|body| body.sum(&of_node))
    }

    /// The same for vectors.
    fn sum_of_vectors(self, of_node: impl Fn(f64, DVec3, DVec3) -> DVec3) -> DVec3 {
        self.total_of_vectors(|body| body.sum(&of_node))
    }

    fn total_of_vectors(self, of_body: impl Fn(&BodyFacts<'a>) -> DVec3) -> DVec3 {
        let of_bodies: Vec<DVec3> = self.bodies.iter().map(of_body).collect();
        DVec3::from_array([0, 1, 2].map(|axis| total(of_bodies.iter().map(|sum| sum[axis]))))
    }

    /// The sum of vectors that bodies have or not; NaN if none has one.
    fn told(self, of_body: impl Fn(&BodyFacts<'a>) -> Option<DVec3>) -> DVec3 {
        if self.bodies.iter().all(|body| of_body(body).is_none()) {
            return DVec3::NAN;
        }
        self.total_of_vectors(|body| of_body(body).unwrap_or_default())
    }

    /// The sum of a number of each body.
    fn total(self, of_body: impl Fn(&BodyFacts<'a>) -> f64) -> f64 {
        total(self.bodies.iter().map(of_body))
    }

    /// The numbers of the bodies that have one, reduced to one; NaN if no body has any.
    fn reduced(self, of_body: impl Fn(&BodyFacts<'a>) -> f64, reduce: impl Fn(f64, f64) -> f64) -> f64 {
        self.bodies.iter().map(of_body).filter(|number| !number.is_nan()).reduce(reduce).unwrap_or(f64::NAN)
    }

    /// Pairs of triangles that cross; NaN if they are not counted.
    fn crossings(self) -> f64 {
        // Two of several bodies share a pair.
        let share = if self.bodies.len() > 1 { 0.5 } else { 1.0 };
        self.total(|body| body.outside.crossings.map_or(f64::NAN, |[own, shared]| own as f64 + share * shared as f64))
    }

    /// RMS distance of the nodes from the placements of their bodies (m).
    fn shape_error(self) -> f64 {
        let nodes: usize = self.bodies.iter().map(|body| body.state.position.len()).sum();
        (self.total(BodyFacts::squared_distances) / nodes as f64).sqrt()
    }
}

/// The value of a diagnostic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// A count.
    Count(usize),
    /// A number; NaN where a model or a body has none.
    Number(f64),
    /// A vector: three columns in files; where one number is shown, its length.
    Vector(DVec3),
}

impl Value {
    /// One number: for vectors, the length.
    pub fn size(self) -> f64 {
        match self {
            Self::Count(count) => count as f64,
            Self::Number(number) => number,
            Self::Vector(vector) => vector.length(),
        }
    }
}

impl From<usize> for Value {
    fn from(count: usize) -> Self {
        Self::Count(count)
    }
}

impl From<f64> for Value {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<DVec3> for Value {
    fn from(vector: DVec3) -> Self {
        Self::Vector(vector)
    }
}

/// Where a diagnostic is written, besides `diagnostics.csv` and charts over time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Scope {
    /// Nowhere else.
    Frames,
    /// Also to summaries of single states: `run.json`, and the JSON of figures.
    Summaries,
}

/// Whether two values are equal, or both NaN.
#[expect(clippy::eq_op, reason = "only NaN differs from itself")]
fn is_same<T: PartialEq>(one: &T, other: &T) -> bool {
    one == other || one != one && other != other
}

/// Defines a field of [`Diagnostics`] and a variant of [`Diagnostic`] for each entry. An entry has its meaning, with
/// the unit in parentheses; its name in code, its key in files and its type; its name in captions; its unit; its
/// [`Scope`]; and its formula, which can use the facts and the entries before it.
macro_rules! diagnostics {
    ($facts:ident: $(
        $(#[doc = $meaning:literal])+
        $variant:ident, $key:ident: $type:ty, $name:literal, $unit:literal, $scope:ident = $value:expr;
    )+) => {
        /// Numbers that describe a state, in SI units; in the plane volumes are areas. A number that the model or the
        /// body does not have is NaN: the elastic energy, `residual`, `global_rotations` and `broken` of some models, the volume ratio of a cloth,
        /// what is told of contact in a world that is not asked for it, and the work of loads in a world without them.
        /// Two that are both NaN are equal.
        #[derive(Clone, Copy, Debug, Default)]
        #[cfg_attr(feature = "scene", derive(serde::Serialize, serde::Deserialize))]
        pub struct Diagnostics {
            $($(#[doc = $meaning])+ pub $key: $type,)+
        }

        impl PartialEq for Diagnostics {
            fn eq(&self, other: &Self) -> bool {
                $(is_same(&self.$key, &other.$key))&&+
            }
        }

        impl Diagnostics {
            /// The wanted diagnostics; the others are zero.
            pub(super) fn of($facts: Facts<'_, '_>, wanted: &[Diagnostic]) -> Self {
                use Diagnostic::{Elastic, Energy, Gravitational, Kinetic};
                let is_part = |one| wanted.contains(&Energy) && [Kinetic, Elastic, Gravitational].contains(&one);
                let is_wanted = |one| wanted.contains(&one) || is_part(one);
                $(let $key: $type = if is_wanted(Diagnostic::$variant) { $value } else { Default::default() };)+
                Self { $($key),+ }
            }
        }

        /// A number that describes a state, to be shown over time.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[cfg_attr(feature = "scene", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
        #[cfg_attr(feature = "scene", serde(rename_all = "snake_case"))]
        pub enum Diagnostic {
            $($(#[doc = $meaning])+ $variant,)+
        }

        impl Diagnostic {
            /// All diagnostics, in the order of files.
            pub const ALL: &[Self] = &[$(Self::$variant),+];

            /// Its value.
            pub fn value(self, all: &Diagnostics) -> Value {
                match self {
                    $(Self::$variant => all.$key.into(),)+
                }
            }

            /// Its name in files.
            pub fn key(self) -> &'static str {
                match self {
                    $(Self::$variant => stringify!($key),)+
                }
            }

            /// Its name in captions.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name,)+
                }
            }

            /// Its unit; empty for a dimensionless number.
            pub fn unit(self) -> &'static str {
                match self {
                    $(Self::$variant => $unit,)+
                }
            }

            /// Its meaning: a sentence with the unit.
            pub fn meaning(self) -> &'static str {
                match self {
                    $(Self::$variant => concat!($($meaning),+).trim_ascii(),)+
                }
            }

            /// Where it is written.
            pub(crate) fn scope(self) -> Scope {
                match self {
                    $(Self::$variant => Scope::$scope,)+
                }
            }
        }
    };
}

diagnostics! { facts:
    /// Kinetic energy (J).
    Kinetic, kinetic: f64, "kinetic energy", "J", Frames =
        facts.sum(|mass, _, velocity| 0.5 * mass * velocity.length_squared());

    /// Elastic energy (J).
    Elastic, elastic: f64, "elastic energy", "J", Frames =
        facts.total(|body| body.report.energy.unwrap_or(f64::NAN));

    /// Potential energy in the field of gravity (J), zero at the origin.
    Gravitational, gravitational: f64, "energy in gravity", "J", Frames =
        facts.sum(|mass, position, _| -(mass * facts.gravity.dot(position)));

    /// Momentum (kg m/s); as one number, its length.
    Momentum, momentum: DVec3, "momentum", "kg m/s", Frames = facts.sum_of_vectors(|mass, _, velocity| velocity * mass);

    /// Angular momentum about the origin (kg m²/s); as one number, its length.
    AngularMomentum, angular_momentum: DVec3, "angular momentum", "kg m²/s", Frames =
        facts.sum_of_vectors(|mass, position, velocity| position.cross(velocity) * mass);

    /// The largest angular acceleration that errors of the rotations cause (rad/s²), α of Eq. (18).
    Residual, residual: f64, "residual α", "rad/s²", Frames =
        facts.reduced(|body| body.report.residual.unwrap_or(f64::NAN), f64::max);

    /// Number of elements that have turned over.
    TurnedOver, turned_over: usize, "turned over", "", Summaries =
        facts.bodies.iter().flat_map(BodyFacts::turned_over).filter(|&turned| turned).count();

    /// Total signed volume of what is filled of the elements, divided by that at rest; in the plane, area.
    VolumeRatio, volume_ratio: f64, "volume ratio", "", Summaries =
        facts.total(BodyFacts::volume) / facts.total(|body| body.of.volume_at_rest);

    /// RMS distance of the nodes from the best rigid placement of the rest shape of their body (m).
    ShapeError, shape_error: f64, "shape error", "m", Summaries = facts.shape_error();

    /// Total energy (J): kinetic, elastic and gravitational.
    Energy, energy: f64, "total energy", "J", Frames = kinetic + elastic + gravitational;

    /// Work that loads have done since the start (J).
    Work, work: f64, "work of loads", "J", Frames = facts.total(|body| body.outside.work.unwrap_or(f64::NAN));

    /// Number of rotations since the start that needed the global solver, because the element was pressed flat, turned
    /// inside out, or turned far in one step.
    GlobalRotations, global_rotations: f64, "global rotations", "", Frames =
        facts.reduced(|body| body.global_rotations, std::ops::Add::add);

    /// Number of elements, or of springs, that are broken.
    Broken, broken: f64, "broken", "", Frames = facts.reduced(|body| body.broken, std::ops::Add::add);

    /// Mean force of obstacles and other bodies where they touch (N), in the last interval between rows, or else frames; as one number, its
    /// length.
    ContactForce, contact_force: DVec3, "contact force", "N", Frames = facts.told(|body| body.outside.contact.map(|[force, _]| force));

    /// Its torque about the origin (N m); as one number, its length.
    ContactTorque, contact_torque: DVec3, "contact torque", "N m", Frames =
        facts.told(|body| body.outside.contact.map(|[_, torque]| torque));

    /// Mean force of what holds and drags nodes (N), in the last interval between rows, or else frames; as one number, its length.
    HoldForce, hold_force: DVec3, "holding force", "N", Frames = facts.told(|body| body.outside.grips.map(|[force, _]| force));

    /// Its torque about the origin (N m); as one number, its length.
    HoldTorque, hold_torque: DVec3, "holding torque", "N m", Frames =
        facts.told(|body| body.outside.grips.map(|[_, torque]| torque));

    /// Number of pairs of triangles, or of sides in the plane, of bodies and obstacles that cross each other where surfaces meet: 0 where all is
    /// well. The triangles of a body that lies inside another one count, too.
    Crossings, crossings: f64, "crossings", "", Frames = facts.crossings();
}

impl Diagnostic {
    /// Whether it tells of forces of contact or of constraints, and is NaN unless a world is [asked for
    /// them](super::World::keep_reactions).
    pub fn is_of_forces(self) -> bool {
        matches!(self, Self::ContactForce | Self::ContactTorque | Self::HoldForce | Self::HoldTorque)
    }

    /// Its value as one number; NaN where a model or a body has none.
    pub fn of(self, all: &Diagnostics) -> f64 {
        self.value(all).size()
    }

    /// The diagnostics that are written at least so widely.
    pub fn within(scope: Scope) -> impl Iterator<Item = Self> {
        Self::ALL.iter().copied().filter(move |diagnostic| diagnostic.scope() >= scope)
    }
}

/// Some diagnostics of a state. Serialised as a table from keys to numbers.
#[derive(Clone, PartialEq)]
pub struct Chosen(Vec<(Diagnostic, Value)>);

impl Chosen {
    /// The diagnostics that are written at least so widely.
    pub fn within(scope: Scope, all: &Diagnostics) -> Self {
        Self(Diagnostic::within(scope).map(|diagnostic| (diagnostic, diagnostic.value(all))).collect())
    }

    /// Each with its value.
    pub fn iter(&self) -> impl Iterator<Item = (Diagnostic, Value)> {
        self.0.iter().copied()
    }

    /// The value of one of them as one number; NaN if it is not among them.
    pub fn get(&self, diagnostic: Diagnostic) -> f64 {
        self.iter().find(|&(one, _)| one == diagnostic).map_or(f64::NAN, |(_, value)| value.size())
    }
}

impl fmt::Debug for Chosen {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_map().entries(self.iter().map(|(diagnostic, value)| (diagnostic.key(), value.size()))).finish()
    }
}

#[cfg(feature = "scene")]
impl serde::Serialize for Chosen {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        use serde::ser::SerializeMap;
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (diagnostic, value) in self.iter() {
            match value {
                Value::Count(count) => map.serialize_entry(diagnostic.key(), &count)?,
                Value::Number(number) => map.serialize_entry(diagnostic.key(), &number)?,
                Value::Vector(vector) => map.serialize_entry(diagnostic.key(), &vector.to_array())?,
            }
        }
        map.end()
    }
}

#[cfg(all(test, feature = "scene"))]
mod tests {
    use super::*;

    #[test]
    fn keys_are_those_of_scene_files() {
        for diagnostic in Diagnostic::ALL {
            assert_eq!(serde_json::to_value(diagnostic).expect("a key"), diagnostic.key());
        }
    }

    #[test]
    fn chosen_diagnostics_are_a_table() {
        let all = Diagnostics { kinetic: 0.1, turned_over: 3, volume_ratio: f64::NAN, ..Diagnostics::default() };
        let json = serde_json::to_string(&Chosen::within(Scope::Summaries, &all)).expect("plain data");
        assert_eq!(json, r#"{"turned_over":3,"volume_ratio":null,"shape_error":0.0}"#);
    }
}
