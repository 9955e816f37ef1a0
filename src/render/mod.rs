//! From a [`Picture`] to an image: the passes, in order.
//!
//! 1. `surface`: turned-over elements, alone, to be seen through the body, and as surfaces of the body.
//! 2. `surface`: other elements over them, in textures no larger than the bodies, with solid obstacles (`obstacle`).
//! 3. `border`: smooth borders where colours change at a line.
//! 4. `visibility`, then `line`: edges and contours as opacities, with smooth borders of their own.
//! 5. `ground`: the floor with its grid and its shadows, into the picture.
//! 6. `composite`: bodies and lines over the ground, between transparent obstacles (`obstacle`).
//! 7. `stroke`: coloured lines and nodes in space, over the bodies, if there are any.
//! 8. `overlay`: marks and words, with flat curves (`curve`) between them, if there are any.
//!
//! Every pixel has one sample. All borders are found from the geometry, which costs nothing without borders.
//!
//!
//! With a scalar field, `tint` takes the place of `surface`.
//!
//! Each pass has one file here and one of the same name in `shaders/`.

mod border;
mod composite;
mod curve;
mod glyphs;
mod ground;
mod line;
mod obstacle;
mod overlay;
mod panel;
mod pass;
mod pipeline;
mod segment;
#[cfg(test)]
mod shader_tests;
mod stroke;
mod surface;
mod target;
mod tint;
mod visibility;

use crate::gpu::{Gpu, GpuError, Pending, ReadBack};
use crate::picture::Picture;
use image::RgbImage;
use obstacle::{Slabs, Solids};
use panel::Panels;
use pass::Pass;
use target::{Bodies, Canvas};

const PANEL_SHADER: &str = include_str!("../../shaders/panel.wgsl");
const SEGMENT_SHADER: &str = include_str!("../../shaders/segment.wgsl");

/// The shaders that read around a point, read the drawn bodies, and read the turned-over set.
const TAPS_SHADER: &str = include_str!("../../shaders/taps.wgsl");
const BODIES_SHADER: &str = include_str!("../../shaders/bodies.wgsl");
const TURNED_OVER_SHADER: &str = include_str!("../../shaders/turned_over.wgsl");

/// A reason why a picture cannot be drawn.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RenderError {
    /// The picture is larger than the device can draw, or empty.
    #[error("pictures of {width}×{height} pixels cannot be drawn: each side may have 1 to {longest} pixels here")]
    Size {
        /// Requested width (px).
        width: u32,
        /// Requested height (px).
        height: u32,
        /// The longest side that the device can draw (px).
        longest: u32,
    },
    /// A picture has another size than the renderer was made for.
    #[error("a picture of {} × {} pixels was given to a renderer for {} × {}", found[0], found[1], expected[0], expected[1])]
    OtherSize {
        /// Size of the picture (px).
        found: [u32; 2],
        /// Size that the renderer was made for (px).
        expected: [u32; 2],
    },
    /// A picture has more lines than the device can draw.
    #[error(
        "the picture has {count} lines, this device can draw {most}: leave out edges (`view.edges`), draw fewer panels, or a coarser body"
    )]
    Lines {
        /// Edges and contours in the picture, or borders of surfaces.
        count: usize,
        /// The most that the device can draw.
        most: usize,
    },
    /// The device failed.
    #[error(transparent)]
    Gpu(#[from] GpuError),
}

/// Draws pictures of one size. The same picture gives the same bytes, independent of pictures before it.
#[derive(Debug)]
pub struct Renderer {
    gpu: Gpu,
    size: [u32; 2],
    panels: Panels,
    surfaces: surface::Surfaces,
    lines: line::Lines,
    borders: border::Borders,
    /// Made when first needed.
    solids: Option<Solids>,
    slabs: Option<Slabs>,
    grounds: ground::Grounds,
    composite: composite::Composite,
    /// Made when first needed, like the tint.
    strokes: Option<stroke::Strokes>,
    tint: Option<tint::Tint>,
    overlay: overlay::Overlay,
    /// Made when first needed.
    curves: Option<curve::Curves>,
    canvas: Canvas,
    bodies: Option<Bodies>,
    read_back: ReadBack,
}

impl Renderer {
    /// Prepares to draw pictures of a width and height (px).
    ///
    /// # Errors
    /// The device cannot draw pictures of this size, or fails.
    pub fn new(gpu: &Gpu, size: [u32; 2]) -> Result<Self, RenderError> {
        let [width, height] = size;
        let longest = gpu.longest_side();
        if size.contains(&0) || width.max(height) > longest {
            return Err(RenderError::Size { width, height, longest });
        }
        let panels = Panels::new(gpu);
        let renderer = Self {
            size,
            surfaces: surface::Surfaces::new(gpu),
            lines: line::Lines::new(gpu),
            borders: border::Borders::new(gpu),
            solids: None,
            slabs: None,
            grounds: ground::Grounds::new(gpu, &panels),
            composite: composite::Composite::new(gpu),
            strokes: None,
            tint: None,
            overlay: overlay::Overlay::new(gpu),
            curves: None,
            canvas: Canvas::new(gpu, size),
            bodies: None,
            read_back: ReadBack::new(gpu, width, height),
            panels,
            gpu: gpu.clone(),
        };
        gpu.check()?;
        Ok(renderer)
    }

    /// Draws a picture.
    ///
    /// # Errors
    /// The picture has another size, or the device fails.
    pub fn draw(&mut self, picture: &Picture) -> Result<RgbImage, RenderError> {
        let pending = self.submit(picture)?;
        let pixels = self.collect(pending)?;
        let [width, height] = self.size;
        // The read-back gives exactly three bytes for each pixel.
        Ok(RgbImage::from_raw(width, height, pixels).expect("three bytes a pixel"))
    }

    /// Waits for a submitted picture, and returns its pixels: three bytes each, in rows from the top left.
    ///
    /// # Errors
    /// The device fails.
    pub(crate) fn collect(&self, pending: Pending) -> Result<Vec<u8>, RenderError> {
        Ok(self.read_back.collect(&self.gpu, pending)?)
    }

    /// Submits a picture and returns at once. Collect it before the next one is submitted: there is one buffer for
    /// reading back.
    pub(crate) fn submit(&mut self, picture: &Picture) -> Result<Pending, RenderError> {
        if picture.size != self.size {
            return Err(RenderError::OtherSize { found: picture.size, expected: self.size });
        }
        let gpu = self.gpu.clone();
        let (places, needed) = panel::place(picture);
        // Items behind surfaces are drawn only where they are read: over turned-over elements, and by lines of turned-over
        // elements without faces.
        let has_behind = picture.panels.iter().any(|panel| panel::has_behind(panel) || line::has_alarm(panel));
        let bodies = match self.bodies.take().filter(|bodies| bodies.suit(needed, has_behind)) {
            Some(bodies) => bodies,
            None => {
                let bodies = Bodies::new(&gpu, target::rounded(needed), has_behind);
                self.surfaces.retarget(&gpu, &bodies);
                self.lines.retarget(&gpu, &bodies);
                self.borders.retarget(&gpu, &bodies);
                self.composite.retarget(&gpu, &bodies);
                if let Some(slabs) = &mut self.slabs {
                    slabs.retarget(&gpu, &bodies);
                }
                self.strokes.iter_mut().for_each(|strokes| strokes.retarget(&gpu, &bodies));
                self.tint.iter_mut().for_each(|tint| tint.retarget(&gpu, &bodies));
                bodies
            }
        };
        self.panels.write(&gpu, picture, &places);
        self.surfaces.write(&gpu, picture);
        self.borders.write(&gpu, &self.panels, picture)?;
        self.composite.write(&gpu, &self.panels, picture);
        self.grounds.write(&gpu, picture);
        self.overlay.write(&gpu, picture);
        if !picture.curves.is_empty() {
            self.curves.get_or_insert_with(|| curve::Curves::new(&gpu, self.size)).write(&gpu, picture);
        }
        let curves = self.curves.as_ref().filter(|_| !picture.curves.is_empty());
        let [with_solids, with_slabs] = [Solids::are_in(picture), Slabs::are_in(picture)];
        self.lines.write(&gpu, &self.panels, &bodies, picture, with_solids)?;
        if with_solids {
            self.solids.get_or_insert_with(|| Solids::new(&gpu, &self.panels)).write(&gpu, picture);
        }
        if with_slabs {
            let new = || {
                let mut slabs = Slabs::new(&gpu, &self.panels);
                slabs.retarget(&gpu, &bodies);
                slabs
            };
            self.slabs.get_or_insert_with(new).write(&gpu, picture);
        }
        let solids = self.solids.as_ref().filter(|_| with_solids);
        let slabs = self.slabs.as_ref().filter(|_| with_slabs);
        let occluders = surface::occluders(picture);
        let colouring = if picture.ramp.is_empty() {
            self.surfaces.prepare(&gpu, &self.panels, picture);
            self.surfaces.plain(occluders)
        } else {
            let tint = self.tint.get_or_insert_with(|| tint::Tint::new(&gpu, &bodies));
            tint.prepare(&gpu, &self.panels, picture);
            tint.write(&gpu, picture);
            tint.colouring(occluders)
        };
        if stroke::Strokes::are_in(picture) {
            let made = || stroke::Strokes::new(&gpu, &self.panels, &bodies);
            self.strokes.get_or_insert_with(made).write(&gpu, picture);
        }
        let strokes = self.strokes.as_ref().filter(|_| stroke::Strokes::are_in(picture));

        let mut commands = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let (mut load, mut deep) = (CLEAR, FAR);
        if has_behind {
            // One drawing serves both uses: the other surfaces are drawn over it.
            let targets = [(&bodies.alarm_colour, CLEAR), (&bodies.colour, CLEAR)];
            let depth = Some((&bodies.alarm_depth, FAR));
            let mut pass = Pass::begin(&gpu, &mut commands, "turned over", &targets, depth);
            self.surfaces.draw_turned_over(&mut pass, &self.panels, &places, colouring);
            drop(pass);
            bodies.copy_depth(&mut commands);
            (load, deep) = (wgpu::LoadOp::Load, wgpu::LoadOp::Load);
        }
        {
            let depth = Some((&bodies.depth, deep));
            let mut pass = Pass::begin(&gpu, &mut commands, "bodies", &[(&bodies.colour, load)], depth);
            self.surfaces.draw_sound(&mut pass, &self.panels, &places, colouring);
            if let Some(solids) = solids {
                solids.draw(&mut pass, &self.panels, &places);
            }
        }
        {
            let mut pass = Pass::begin(&gpu, &mut commands, "borders", &[(&bodies.borders, CLEAR)], None);
            self.borders.draw(&mut pass, &self.panels, &places);
        }
        self.lines.test(&gpu, &mut commands, &self.panels, &places, with_solids);
        {
            let mut pass = Pass::begin(&gpu, &mut commands, "lines", &[(&bodies.lines, CLEAR)], None);
            self.lines.draw(&mut pass, &self.panels, &places);
        }
        let [r, g, b] = panel::linear(picture.palette.background).to_array().map(f64::from);
        let mut background = wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a: 1.0 });
        if !picture.under.is_empty() {
            let [r, g, b] = picture.palette.background.map(|byte| f64::from(byte) / 255.0);
            let encoded = wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a: 1.0 });
            let mut pass = Pass::begin(&gpu, &mut commands, "under", &[(&self.canvas.encoded, encoded)], None);
            self.overlay.draw_under(&mut pass);
            background = wgpu::LoadOp::Load;
        }
        {
            let mut pass = Pass::begin(&gpu, &mut commands, "picture", &[(&self.canvas.linear, background)], None);
            self.grounds.draw(&mut pass, &self.panels, picture);
            if let Some(slabs) = slabs {
                slabs.draw(&mut pass, &self.panels, picture, false);
            }
            self.composite.draw(&mut pass, &self.panels, picture);
            if let Some(strokes) = strokes {
                strokes.draw(&mut pass, &self.panels, picture);
            }
            if let Some(slabs) = slabs {
                slabs.draw(&mut pass, &self.panels, picture, true);
            }
        }
        {
            let mut pass =
                Pass::begin(&gpu, &mut commands, "overlay", &[(&self.canvas.encoded, wgpu::LoadOp::Load)], None);
            self.overlay.draw_marks(&mut pass);
            if let Some(curves) = curves {
                curves.draw(&mut pass);
            }
            self.overlay.draw_words(&mut pass);
        }
        self.bodies = Some(bodies);
        Ok(self.read_back.submit(&gpu, commands, &self.canvas.texture))
    }
}

/// Empty: transparent, and infinitely far away.
const CLEAR: wgpu::LoadOp<wgpu::Color> = wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT);
const FAR: wgpu::LoadOp<f32> = wgpu::LoadOp::Clear(0.0);
