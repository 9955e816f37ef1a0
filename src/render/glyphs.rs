//! The glyph atlas: one texture with each used glyph, rasterised once.

use super::pipeline::written_texture;
use crate::gpu::{Gpu, Work};
use crate::picture::{Face, Fonts, Glyph, TextRun};
use std::collections::HashMap;

/// Width of the texture (px).
const WIDTH: u32 = 2048;
/// The number of places between two pixels at which glyphs are rasterised.
const PLACES: f32 = 4.0;

/// The key of a rasterised glyph.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Key {
    /// The font, of any scene.
    font: u64,
    id: u16,
    /// Size of the type, as bits for hashing.
    size: u32,
    place: u8,
}

/// A glyph in the texture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Raster {
    /// Left and top in the texture.
    pub(super) at: [u32; 2],
    /// Width and height (px).
    pub(super) size: [u32; 2],
    /// Its start, from the whole pixel of its origin on the baseline (px).
    pub(super) offset: [f32; 2],
}

/// All glyphs in use.
#[derive(Debug)]
pub(super) struct Glyphs {
    rasters: HashMap<Key, Option<Raster>>,
    coverage: Vec<u8>,
    height: u32,
    /// Left end, top and height of the row that is being filled.
    pen: [u32; 3],
    texture: wgpu::Texture,
    /// The first new row of the texture.
    changed: Option<u32>,
}

impl Glyphs {
    pub(super) fn new(gpu: &Gpu) -> Self {
        Self {
            rasters: HashMap::new(),
            coverage: Vec::new(),
            height: 0,
            pen: [0; 3],
            texture: create(gpu, 1),
            changed: None,
        }
    }

    /// The raster of a glyph of a text, and its whole pixel; `None` for blanks.
    pub(super) fn raster(&mut self, fonts: &Fonts, run: &TextRun, glyph: &Glyph) -> Option<(Raster, [f32; 2])> {
        let quarter = (glyph.x * PLACES).round();
        let pixel = (quarter / PLACES).floor();
        let place = quarter - pixel * PLACES;
        let face = fonts.face(glyph.face);
        let key = Key { font: face.key, id: glyph.id, size: run.size.to_bits(), place: place as u8 };
        let raster = match self.rasters.get(&key) {
            Some(known) => *known,
            None => {
                let new = self.rasterise(face, run.size, glyph.id, place / PLACES);
                self.rasters.insert(key, new);
                new
            }
        };
        // Baselines on whole pixels make all lines equally sharp.
        raster.map(|raster| (raster, [pixel, run.baseline.round()]))
    }

    fn rasterise(&mut self, face: &Face, size: f32, id: u16, place: f32) -> Option<Raster> {
        let outlined = face.outline(id, size, place)?;
        let bounds = outlined.px_bounds();
        let [width, height] = [bounds.width(), bounds.height()].map(|length| length as u32);
        // Fonts may give a wrong size of their glyphs.
        if width == 0 || height == 0 || width > WIDTH || height > WIDTH {
            return None;
        }
        let at = self.reserve(width, height);
        outlined.draw(|x, y, covered| {
            let index = (at[1] + y) as usize * WIDTH as usize + (at[0] + x) as usize;
            self.coverage[index] = (covered.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
        });
        self.changed = Some(self.changed.map_or(at[1], |row| row.min(at[1])));
        Some(Raster { at, size: [width, height], offset: [bounds.min.x, bounds.min.y] })
    }

    fn reserve(&mut self, width: u32, height: u32) -> [u32; 2] {
        let [mut left, mut top, mut row] = self.pen;
        if left + width > WIDTH {
            (left, top, row) = (0, top + row, 0);
        }
        self.pen = [left + width, top, row.max(height)];
        self.height = self.height.max(top + self.pen[2]);
        self.coverage.resize(WIDTH as usize * self.height as usize, 0);
        [left, top]
    }

    /// Uploads new glyphs. Returns true if the texture was replaced.
    pub(super) fn upload(&mut self, gpu: &Gpu) -> bool {
        let Some(changed) = self.changed.take() else { return false };
        let replaced = self.texture.height() < self.height;
        if replaced {
            self.texture = create(gpu, self.height.next_power_of_two().min(gpu.longest_side()));
        }
        let top = if replaced { 0 } else { changed };
        let height = self.height.min(self.texture.height()).saturating_sub(top);
        let new = &self.coverage[(WIDTH * top) as usize..][..(WIDTH * height) as usize];
        gpu.note(Work::Upload("glyphs", new.len()));
        gpu.queue().write_texture(
            wgpu::TexelCopyTextureInfo {
                origin: wgpu::Origin3d { x: 0, y: top, z: 0 },
                ..self.texture.as_image_copy()
            },
            new,
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(WIDTH), rows_per_image: None },
            wgpu::Extent3d { width: WIDTH, height, depth_or_array_layers: 1 },
        );
        replaced
    }

    pub(super) fn view(&self) -> wgpu::TextureView {
        self.texture.create_view(&wgpu::TextureViewDescriptor::default())
    }
}

fn create(gpu: &Gpu, height: u32) -> wgpu::Texture {
    written_texture(gpu, "glyphs", [WIDTH, height, 1], wgpu::TextureFormat::R8Unorm)
}
