//! Sizes and opacities that shaders, vector files and the composition share. Shaders get them as the text [`WGSL`], so
//! that no number is written twice.

macro_rules! measures {
    ($($(#[$about:meta])* $name:ident = $value:literal;)*) => {
        $($(#[$about])* pub(crate) const $name: f32 = $value;)*
        /// All measures as constants of WGSL.
        pub(crate) const WGSL: &str = concat!($("const ", stringify!($name), " = ", $value, ";\n"),*);
    };
}

// Widths and distances in pixels of the reference picture.
measures! {
    /// Edges of elements in space.
    EDGE_WIDTH = 1.15;
    EDGE_ALPHA = 0.80;
    /// Edges of turned-over elements.
    ALARM_EDGE_WIDTH = 1.5;
    ALARM_EDGE_ALPHA = 0.95;
    /// The dark share and the opacity of the stripes of turned-over elements.
    STRIPE = 0.2;
    STRIPE_ALPHA = 0.62;
    /// Turned-over elements, springs and nodes are drawn this much nearer (sides), so that they win where they share faces
    /// with other elements.
    NEARER = 0.02;
    /// The opacity of a plate in front of bodies, relative to its own, so that they stay visible.
    OVER_BODIES = 0.6;
    /// The opacity of a solid obstacle in front of bodies, which it would hide otherwise.
    SOLID_OVER_BODIES = 0.5;
}

/// Elements without faces.
pub(crate) const BAR_WIDTH: f32 = 3.4;
pub(crate) const BAR_ALPHA: f32 = 0.95;
/// Elements smaller than this (px) get fainter edges, or edges would cover everything.
pub(crate) const SMALL_ELEMENT: f32 = 26.0;
/// Between these sizes of elements (px) edges fade out, because so close together they would flicker.
pub(crate) const SMALLEST_ELEMENT: f32 = 4.0;
const FADING_ELEMENT: f32 = 8.0;
/// The width of a casing relative to the line's, and the least (px).
pub(crate) const CASING: f32 = 0.24;
pub(crate) const LEAST_CASING: f32 = 0.6;
/// The rim of a node in space, relative to its radius.
pub(crate) const BEAD_RIM: f32 = 0.32;

/// The opacity of the edges of elements of a size (px), relative to that of large ones.
pub(crate) fn edging(element: f32) -> f32 {
    let share = ((element - SMALLEST_ELEMENT) / (FADING_ELEMENT - SMALLEST_ELEMENT)).clamp(0.0, 1.0);
    (element / SMALL_ELEMENT).min(1.0) * share * share * (3.0 - 2.0 * share)
}
