//! Where panels and words stand. Nothing here depends on the frame, so that nothing jumps.

/// Lengths of the layout hold for a picture of this height (px) and grow with it.
const REFERENCE_HEIGHT: f64 = 720.0;
/// A panel narrower than this (px, at the reference height) gets smaller type.
const REFERENCE_WIDTH: f64 = 540.0;
/// A panel lower than this (px, at the reference height) gets smaller type.
const REFERENCE_PANEL_HEIGHT: f64 = 460.0;
/// Type smaller than this cannot be read and is left out (px).
const SMALLEST_TYPE: f64 = 5.0;

/// A rectangle: left, top, width, height (px).
pub type Rectangle = [u32; 4];

/// Divides a picture into panels, row by row; together they cover it without gaps. No panel is without a pixel as
/// long as the picture has enough of them.
pub(super) fn panels(size: [u32; 2], count: usize, columns: usize) -> Vec<Rectangle> {
    let columns = columns.clamp(1, count.max(1));
    let rows = count.div_ceil(columns);
    let cut = |length: u32, parts: usize, at: usize| (u64::from(length) * at as u64 / parts.max(1) as u64) as u32;
    (0..count)
        .map(|at| {
            let (column, row) = (at % columns, at / columns);
            let [left, right] = [column, column + 1].map(|at| cut(size[0], columns, at));
            let [top, bottom] = [row, row + 1].map(|at| cut(size[1], rows, at));
            [left, top, right - left, bottom - top]
        })
        .collect()
}

/// A panel without the room of its strip, and that room inside its margins.
pub(super) fn cut(panel: Rectangle, scale: Scale, with_strip: bool) -> (Rectangle, Rectangle) {
    let [left, top, width, height] = panel;
    if !with_strip {
        return (panel, [left, top, 0, 0]);
    }
    let strip = ((110.0 * scale.unit).round() as u32).min(height.saturating_sub(1));
    let margin = (scale.margin().round() as u32).min(width / 2);
    let above = ((16.0 * scale.unit).round() as u32).min(height - strip);
    ([left, top, width, height - strip], [left + margin, top + height - strip - above, width - 2 * margin, strip])
}

/// Sizes of type and lines of one picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    /// Pixels for one pixel of the reference picture.
    pub(super) unit: f64,
}

impl Scale {
    pub(super) fn new(size: [u32; 2], panel: Rectangle) -> Self {
        let [width, height] = [panel[2], panel[3]].map(f64::from);
        let unit =
            (f64::from(size[1]) / REFERENCE_HEIGHT).min(width / REFERENCE_WIDTH).min(height / REFERENCE_PANEL_HEIGHT);
        Self { unit }
    }

    /// Names, clock and count (px).
    pub(super) fn title(self) -> f64 {
        26.0 * self.unit
    }

    /// Everything else (px).
    pub(super) fn caption(self) -> f64 {
        16.0 * self.unit
    }

    /// Free space around and inside each panel (px).
    pub(super) fn margin(self) -> f64 {
        40.0 * self.unit
    }

    /// Between things beside each other (px).
    pub(super) fn gap(self) -> f64 {
        16.0 * self.unit
    }

    /// Whether type of `size` (px) can be read.
    pub(super) fn legible(size: f64) -> bool {
        size >= SMALLEST_TYPE
    }

    /// How thick lines are, in parts of their thickness in the reference picture. Thinner ones than at a third of
    /// that size would only be fainter.
    pub(super) fn line(self) -> f64 {
        self.unit.max(0.35)
    }
}

/// The lines of text in a panel (px from its top).
pub(super) struct Baselines {
    pub(super) title: f64,
    pub(super) second: f64,
    pub(super) count: f64,
    pub(super) caption: f64,
}

impl Baselines {
    pub(super) fn new(scale: Scale, panel: Rectangle) -> Self {
        let height = f64::from(panel[3]);
        Self {
            title: 60.0 * scale.unit,
            second: 86.0 * scale.unit,
            count: height - 58.0 * scale.unit,
            caption: height - 38.0 * scale.unit,
        }
    }
}

/// The part of a panel between its lines of text, inside its margins.
pub(super) fn clear_of_words(panel: Rectangle, scale: Scale) -> Rectangle {
    let [left, top, width, height] = panel;
    let lines = Baselines::new(scale, panel);
    let inside = |at: f64, length: u32| at.clamp(0.0, f64::from(length)) as u32;
    let side = inside(scale.margin(), width / 2);
    let above = inside(lines.second + scale.gap(), height);
    let below = inside(lines.count - scale.title() - scale.gap(), height).max(above);
    [left + side, top + above, width - 2 * side, below - above]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panels_cover_the_picture_without_gaps() {
        for (size, count, columns) in [([1280, 720], 2, 2), ([1281, 719], 6, 3), ([64, 64], 5, 2), ([8192, 100], 1, 4)]
        {
            let panels = panels(size, count, columns);
            assert_eq!(panels.len(), count);
            // Each begins where the one before it ends, and the last ones end at the picture's edges.
            let columns = columns.min(count);
            for (at, &[left, top, width, height]) in panels.iter().enumerate() {
                assert!(width > 0 && height > 0);
                let beside = if at % columns == 0 { 0 } else { panels[at - 1][0] + panels[at - 1][2] };
                let above = if at < columns { 0 } else { panels[at - columns][1] + panels[at - columns][3] };
                assert_eq!([left, top], [beside, above]);
                assert!(at % columns != columns - 1 || left + width == size[0]);
                assert!(at / columns < (count - 1) / columns || top + height == size[1]);
            }
        }
        assert_eq!(panels([1280, 720], 2, 2), [[0, 0, 640, 720], [640, 0, 640, 720]]);
    }

    #[test]
    fn the_ground_between_the_words_lies_inside_the_panel() {
        assert_eq!(clear_of_words([640, 0, 640, 720], Scale { unit: 1.0 }), [680, 102, 560, 518]);
        for panel in [[0, 0, 1, 1], [5, 7, 30, 12], [0, 0, 3000, 40]] {
            let [x, y, width, height] = clear_of_words(panel, Scale::new([64, 64], panel));
            assert!(x >= panel[0] && x + width <= panel[0] + panel[2]);
            assert!(y >= panel[1] && y + height <= panel[1] + panel[3]);
        }
    }

    #[test]
    fn type_grows_with_the_picture_and_shrinks_with_panels() {
        let unit = |size: [u32; 2], count, columns| Scale::new(size, panels(size, count, columns)[0]).unit;
        assert_eq!(unit([1280, 720], 2, 2), 1.0);
        assert_eq!(unit([1920, 1080], 2, 2), 1.5);
        assert!(unit([1280, 720], 6, 3) < 0.8);
        assert!(unit([64, 64], 2, 2) < 0.1);
    }
}
