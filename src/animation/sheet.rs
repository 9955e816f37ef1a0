//! A still picture with frames side by side, each with its time.

use super::order::in_order;
use super::{Animation, AnimationError, Image, Written, resized};
use crate::colour::{Colour, best_of, mixed};
use crate::output::{Compression, encode};
use crate::picture::{Fonts, Weight};

/// The layout of a sheet.
#[derive(Clone, Debug)]
pub struct Sheet {
    /// Width and height of the picture (px).
    pub size: [u32; 2],
    /// The time of each frame of the reel (s), written below it; if there are fewer times than frames, none is written.
    pub times: Vec<f64>,
}

impl Default for Sheet {
    fn default() -> Self {
        Self { size: [1920, 1080], times: Vec::new() }
    }
}

/// Positions of the frames.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Grid {
    columns: u32,
    /// Width and height of a frame (px).
    frame: [u32; 2],
    /// Distance from frame to frame (px).
    pitch: [u32; 2],
    /// Left and top of the first (px).
    origin: [u32; 2],
}

/// Least width of a frame (px).
const LEAST: u32 = 32;

impl Sheet {
    /// Default number of frames.
    pub const FRAMES: usize = 12;

    /// Space between frames (px).
    fn gap(&self) -> u32 {
        (self.size[0].min(self.size[1]) / 60).max(4)
    }

    /// Font size (px).
    fn type_size(&self) -> u32 {
        (self.size[0].min(self.size[1]) / 54).max(11)
    }

    /// Rows and columns for which `count` frames are as large as possible, but not enlarged.
    fn grid(&self, count: u32, [width, height]: [u32; 2]) -> Option<Grid> {
        let (gap, label) = (self.gap(), self.type_size() * 8 / 5);
        let fit = |columns: u32| {
            let rows = count.div_ceil(columns);
            let room = |side: u32, parts: u32| side.checked_sub(gap * (parts + 1)).map(|room| room / parts);
            let wide = room(self.size[0], columns)?;
            let high = room(self.size[1], rows)?.checked_sub(label)?;
            let scale = (f64::from(wide) / f64::from(width)).min(f64::from(high) / f64::from(height)).min(1.0);
            let frame = [width, height].map(|side| (f64::from(side) * scale) as u32);
            let pitch = [frame[0] + gap, frame[1] + label + gap];
            let origin = [columns * pitch[0] - gap, rows * pitch[1] - gap];
            let origin = [0, 1].map(|axis| (self.size[axis] - origin[axis]) / 2);
            (frame[0] >= LEAST && frame[1] > 0).then_some(Grid { columns, frame, pitch, origin })
        };
        let mut best: Option<Grid> = None;
        for grid in (1..=count).filter_map(fit) {
            // If several are equally large, the one with more columns: its last row has fewer gaps.
            if best.is_none_or(|best| grid.frame[0] > best.frame[0]) {
                best = Some(grid);
            }
        }
        best
    }

    /// Encodes the picture as a PNG file.
    ///
    /// # Errors
    /// If a frame cannot be read, or there is no room for all of them.
    pub(crate) fn encode(&self, animation: &Animation<'_>) -> Result<(Vec<u8>, Written), AnimationError> {
        let shots = animation.timeline.shots();
        let grid = self.grid(shots.len() as u32, animation.reel.size()).ok_or_else(|| {
            let [width, height] = self.size;
            AnimationError::Wrong(match shots.len() {
                1 => format!("a frame has no room on a sheet of {width}×{height}; choose a larger --size"),
                count => format!(
                    "{count} frames are too many for a sheet of {width}×{height}; choose fewer with --frames, or a larger \
                     --size"
                ),
            })
        })?;
        let ground = animation.reel.image(shots[0].frame)?.corner();
        let ink = mixed(best_of(&[[0; 3], [255; 3]], ground), ground, 0.25);
        let mut sheet = Image::plain(self.size, ground);
        let fonts = Fonts::default();
        let small = |at: usize| Ok(resized(&animation.reel.image(shots[at].frame)?, grid.frame));
        in_order(shots.len(), animation.threads, small, |at, image| {
            let place = [at as u32 % grid.columns, at as u32 / grid.columns];
            let [left, top] = [0, 1].map(|axis| grid.origin[axis] + place[axis] * grid.pitch[axis]);
            sheet.paste(&image, [left, top]);
            if let Some(time) = self.times.get(shots[at].frame) {
                let size = self.type_size() as f32;
                let middle = left as f32 + grid.frame[0] as f32 / 2.0;
                let baseline = (top + grid.frame[1]) as f32 + 1.15 * size;
                write_centred(&mut sheet, &fonts, &time_in_words(*time), [middle, baseline.round()], size, ink);
            }
            animation.report((at + 1) as f64 / shots.len() as f64)
        })?;
        let comment = [("comment", animation.comment.to_owned())];
        let bytes = encode(sheet.size, &sheet.pixels, &comment, Compression::High);
        Ok((bytes, Written { pictures: shots.len(), duration: 0.0, size: self.size }))
    }
}

/// A time as text.
fn time_in_words(time: f64) -> String {
    if time.abs() < 0.9995 { format!("{:.0} ms", time * 1e3) } else { format!("{time:.2} s") }
}

/// Writes a line of text around `middle`.
fn write_centred(sheet: &mut Image, fonts: &Fonts, text: &str, [middle, baseline]: [f32; 2], size: f32, ink: Colour) {
    let width = fonts.width(text, Weight::Regular, size.into());
    let left = f64::from(middle) - width / 2.0;
    let run = fonts.lay_out(text, Weight::Regular, size.into(), ink, left, baseline.into());
    let [wide, high] = sheet.size.map(i64::from);
    for glyph in run.glyphs {
        let whole = glyph.x.floor();
        let Some(outline) = fonts.face(glyph.face).outline(glyph.id, size, glyph.x - whole) else { continue };
        let bounds = outline.px_bounds();
        let corner = [whole + bounds.min.x, baseline + bounds.min.y].map(|place| place as i64);
        outline.draw(|x, y, covered| {
            let [x, y] = [corner[0] + i64::from(x), corner[1] + i64::from(y)];
            if (0..wide).contains(&x) && (0..high).contains(&y) {
                let at = 3 * (y * wide + x) as usize;
                let below = [sheet.pixels[at], sheet.pixels[at + 1], sheet.pixels[at + 2]];
                sheet.pixels[at..at + 3].copy_from_slice(&mixed(below, ink, f64::from(covered)));
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_fill_the_sheet() {
        let sheet = Sheet { size: [1920, 1080], times: Vec::new() };
        for (count, columns) in [(1, 1), (2, 2), (4, 2), (6, 3), (9, 3), (12, 4)] {
            let grid = sheet.grid(count, [1280, 800]).unwrap();
            assert_eq!(grid.columns, columns, "{count}: {grid:?}");
            let rows = count.div_ceil(columns);
            assert!(grid.origin[0] + columns * grid.pitch[0] <= 1920 + sheet.gap());
            assert!(grid.origin[1] + rows * grid.pitch[1] <= 1080 + sheet.gap());
        }
        assert_eq!(sheet.grid(1, [96, 64]).unwrap().frame, [96, 64], "never larger than they are");
        assert!(sheet.grid(100_000, [1280, 800]).is_none());
    }

    #[test]
    fn times_are_short() {
        assert_eq!([0.0, 0.0664, 0.99999, 2.5].map(time_in_words), ["0 ms", "66 ms", "1.00 s", "2.50 s"]);
    }
}
