//! Sizes of type and lines, which follow the size of a picture.

use super::steps::{self, BESIDE, GAP, MARGIN, SHORT, SMALL};
use crate::look::{View, print};

/// Smaller type cannot be read in any picture and is left out (px).
pub(in crate::picture) const SMALLEST_TYPE: f64 = 5.0;
/// The least distance of lines, and the height of letters, in sizes of their type.
pub(super) const LINE: f64 = 1.25;
pub(in crate::picture) const ASCENT: f64 = 0.77;

/// A rectangle: left, top, width, height (px).
pub(crate) type Rectangle = [u32; 4];

/// Pixels of the picture of a view per pixel of the reference picture.
pub(super) fn unit(view: &View) -> f64 {
    let [width, height] = view.size.map(|length| f64::from(length.max(1)));
    // Panels that arrange themselves stand side by side in a wide picture.
    let columns = view.columns.unwrap_or(if width < height { 1 } else { 2 }).clamp(1, 2) as u32;
    let usual = print::unit(view.size, [(width / f64::from(columns)) as u32, u32::MAX]);
    // In a tall picture type follows the area: the rows of a column as wide would have few words.
    const TALL: f64 = 1.14e-3;
    usual.min(TALL * (width * height).sqrt())
}

/// Sizes of type and lines of one picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::picture) struct Scale {
    /// Pixels per pixel of the reference picture.
    pub(in crate::picture) unit: f64,
    /// The size of type, with its rows, relative to the usual one.
    type_factor: f64,
    /// The smallest type (px).
    least: f64,
    /// The heights above and below the words of a panel (px in the reference picture).
    pub(in crate::picture) edges: [f64; 2],
}

impl Scale {
    /// The sizes of the reference picture.
    pub(in crate::picture) const REFERENCE: Self = Self { unit: 1.0, type_factor: 1.0, least: 0.0, edges: [BESIDE; 2] };

    /// The sizes of a picture with a number of pixels per pixel of the reference picture.
    pub(in crate::picture) fn at(unit: f64) -> Self {
        Self { unit, ..Self::REFERENCE }
    }

    /// The sizes with another unit.
    pub(in crate::picture) fn with_unit(self, unit: f64) -> Self {
        Self { unit, ..self }
    }

    /// The sizes with the type of a scene.
    pub(in crate::picture) fn with(self, view: &View) -> Self {
        Self { type_factor: view.look.text_scale, ..self }
    }

    /// The sizes for a part of the picture of a scene, whose type is not smaller than the picture's smallest type.
    pub(super) fn within(self, view: &View) -> Self {
        // The outermost words keep the margins of the picture.
        let above = if view.title.is_empty() { MARGIN } else { BESIDE };
        let has_parts_below = !view.charts.is_empty() || view.has_key() || !view.caption.is_empty();
        let below = if has_parts_below { BESIDE } else { SHORT + BESIDE };
        Self { least: SMALL * unit(view) * view.look.text_scale.min(1.0), edges: [above, below], ..self.with(view) }
    }

    /// Pixels per pixel of the reference picture, for type and for objects in its rows.
    pub(in crate::picture) fn type_unit(self) -> f64 {
        self.unit * self.type_factor
    }

    /// The same for names, clocks and counts, which are larger than other type. Where that is large, as in small pictures for print, they grow
    /// less.
    pub(super) fn name_unit(self) -> f64 {
        /// The factor of type up to which names grow with it, and their least size relative to larger type.
        const GROWN: f64 = 1.5;
        const LARGER: f64 = 1.25;
        self.type_unit() * (GROWN / self.type_factor).clamp(LARGER * steps::TEXT / steps::NAME, 1.0)
    }

    /// The heights of the rows of a count and of the words below it (px).
    pub(super) fn numbers(self) -> [f64; 2] {
        let words = (SHORT * self.type_unit()).max(LINE * self.caption());
        [ASCENT * self.title() + 0.5 * self.caption(), words]
    }

    /// Size of the title above all panels (px).
    pub(in crate::picture) fn heading(self) -> f64 {
        1.16 * self.title()
    }

    /// Size of names, clock and count (px).
    pub(in crate::picture) fn title(self) -> f64 {
        (steps::NAME * self.name_unit()).max(self.least)
    }

    /// Size of all other type (px).
    pub(in crate::picture) fn caption(self) -> f64 {
        (steps::TEXT * self.type_unit()).max(self.least)
    }

    /// Size of numbers in charts and in rings (px).
    pub(in crate::picture) fn small(self) -> f64 {
        (SMALL * self.type_unit()).max(self.least)
    }

    /// The margin around and inside each panel (px).
    pub(in crate::picture) fn margin(self) -> f64 {
        MARGIN * self.unit
    }

    /// The gap between adjacent parts (px).
    pub(in crate::picture) fn gap(self) -> f64 {
        GAP * self.unit
    }

    /// Whether type of `size` (px) can be read.
    pub(in crate::picture) fn legible(size: f64) -> bool {
        size >= SMALLEST_TYPE
    }

    /// The thickness of lines relative to the reference picture. It is at least that at a third of the size, below
    /// which lines would only be fainter.
    pub(in crate::picture) fn line(self) -> f64 {
        self.unit.max(0.35)
    }
}
