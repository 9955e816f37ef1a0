//! Obstacles as typed.

use super::{Coordinates, MotionPath, Rotation, Swing};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A rigid obstacle that nodes collide with. It is fixed unless a `path` or a `swing` moves it.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub(in crate::scene) enum ObstacleFile {
    /// A half-space, drawn as ground. It rotates about its point nearest to the origin.
    Floor(FloorFile),
    /// A half-space, drawn as a plate around its `point`, about which it rotates.
    Plate(PlateFile),
    /// A ball; in the plane a disc. It rotates about its centre.
    Sphere(SphereFile),
    /// A rod with round ends: all points near a line segment. It rotates about its centre.
    Capsule(CapsuleFile),
    /// A cuboid; in the plane a rectangle. It rotates about its centre.
    Box(BoxFile),
}

/// What every obstacle has besides its shape.
#[derive(Clone, Copy, Debug)]
pub(in crate::scene) struct Common<'a> {
    pub(in crate::scene) restitution: f64,
    pub(in crate::scene) friction: f64,
    pub(in crate::scene) about: Option<&'a Coordinates>,
    pub(in crate::scene) path: Option<&'a MotionPath>,
    pub(in crate::scene) swing: Option<&'a Swing>,
}

/// The same, to be set.
#[derive(Debug)]
pub(in crate::scene) struct CommonMut<'a> {
    pub(in crate::scene) restitution: &'a mut f64,
    pub(in crate::scene) friction: &'a mut f64,
    pub(in crate::scene) about: &'a mut Option<Coordinates>,
    pub(in crate::scene) path: &'a mut Option<MotionPath>,
    pub(in crate::scene) swing: &'a mut Option<Swing>,
}

/// Defines the tables of the kinds: their own keys, and those that all have.
macro_rules! kinds {
    ($($(#[$doc:meta])* $table:ident as $kind:ident { $($(#[$key_doc:meta])* $key:ident: $type:ty,)* })*) => {
        $(
            $(#[$doc])*
            #[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
            #[serde(deny_unknown_fields)]
            #[schemars(extend("not" = { "required": ["path", "swing"] }))]
            pub(in crate::scene) struct $table {
                $($(#[$key_doc])* pub(in crate::scene) $key: $type,)*
                /// Coefficient of restitution e: the part of the normal velocity that is kept in a rebound.
                #[serde(default)]
                #[schemars(range(min = 0.0, max = 1.0))]
                restitution: f64,
                /// Coefficient of friction μ.
                #[serde(default)]
                #[schemars(range(min = 0.0))]
                friction: f64,
                /// The point about which `path` and `swing` rotate (m): a sphere swings like a pendulum about a point above
                /// it. Default: as said for this kind.
                about: Option<Coordinates>,
                /// A path of keyframes along which it moves. Not together with `swing`.
                path: Option<MotionPath>,
                /// An oscillation, such as `{ period = 1.2, shift = [0.1, 0, 0] }`. Not together with `path`.
                swing: Option<Swing>,
            }

            impl $table {
                /// One that stays where it is, without rebound and friction.
                #[expect(clippy::new_ret_no_self, reason = "it is wanted as one of all kinds")]
                pub(in crate::scene) fn new($($key: $type),*) -> ObstacleFile {
                    let (about, path, swing) = (None, None, None);
                    ObstacleFile::$kind(Self { $($key,)* restitution: 0.0, friction: 0.0, about, path, swing })
                }
            }
        )*

        impl ObstacleFile {
            /// What a kind has besides its shape, to be set.
            pub(in crate::scene) fn common_mut(&mut self) -> CommonMut<'_> {
                match self {
                    $(Self::$kind($table { restitution, friction, about, path, swing, .. }) => {
                        CommonMut { restitution, friction, about, path, swing }
                    })*
                }
            }

            pub(in crate::scene) fn common(&self) -> Common<'_> {
                match self {
                    $(Self::$kind($table { restitution, friction, about, path, swing, .. }) => Common {
                        restitution: *restitution,
                        friction: *friction,
                        about: about.as_ref(),
                        path: path.as_ref(),
                        swing: swing.as_ref(),
                    },)*
                }
            }
        }
    };
}

kinds! {
    /// A half-space, drawn as ground. It rotates about its point nearest to the origin.
    FloorFile as Floor {
        /// Outward normal, of any length but zero. Default: up, along y.
        normal: Option<Coordinates>,
        /// Distance of the surface from the origin along `normal` (m).
        #[serde(default)]
        height: f64,
    }
    /// A half-space, drawn as a plate around its point. It rotates about that point.
    PlateFile as Plate {
        /// A point of the surface (m).
        point: Coordinates,
        /// Outward normal, towards the body, of any length but zero.
        normal: Coordinates,
    }
    /// A ball, in the plane a disc. It rotates about its centre.
    SphereFile as Sphere {
        /// Centre (m).
        centre: Coordinates,
        /// Radius (m).
        #[schemars(extend("exclusiveMinimum" = 0))]
        radius: f64,
    }
    /// All points near a line: a rod with round ends. It rotates about its centre.
    CapsuleFile as Capsule {
        /// Centre of one round end (m).
        from: Coordinates,
        /// Centre of the other (m).
        to: Coordinates,
        /// Radius of rod and ends (m).
        #[schemars(extend("exclusiveMinimum" = 0))]
        radius: f64,
    }
    /// A cuboid, in the plane a rectangle. It rotates about its centre.
    BoxFile as Box {
        /// Centre (m).
        centre: Coordinates,
        /// Lengths of its sides (m), each greater than zero.
        #[schemars(extend("items" = { "type": "number", "exclusiveMinimum": 0 }))]
        size: Coordinates,
        /// Orientation of its sides. Default: along the axes.
        rotation: Option<Rotation>,
    }
}
