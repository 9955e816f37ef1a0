//! Lit bodies in space, with their floors, obstacles and lines. The passes, in order:
//!
//! 1. `surface`: turned-over elements, alone, to be seen through the body, and as surfaces of the body.
//! 2. `surface`: other elements and solid obstacles over them, in textures no larger than the bodies.
//! 3. `border`: smooth borders where colours change at a line.
//! 4. `visibility`, then `line`: edges and contours as opacities, with smooth borders of their own.
//! 5. `ground`: the floor with its grid and its shadows, into the picture.
//! 6. `composite`: bodies and lines over the ground.
//! 7. `stroke`: coloured lines and nodes in space, over the bodies, if there are any.
//! 8. `pane`: transparent obstacles, before and behind all of this, and `stroke` again for their edges.
//!
//! Every pixel has one sample. All borders are found from the geometry, which costs nothing without borders. Each pass has
//! one file here and one of the same name in `shaders/`.

use super::pane::Panes;
use super::panel;
use super::pass::Pass;
use super::stage::Stage;
use super::surface::{Set, Surfaces};
use super::target::{self, Bodies, Canvas};
use super::{RenderError, border, composite, ground, line, stroke};
use crate::gpu::{Gpu, Pending, ReadBack};
use crate::picture::Picture;

/// Draws the lit bodies of pictures of one size. The same picture gives the same bytes, whatever was drawn before.
#[derive(Debug)]
pub(super) struct Lit {
    stage: Stage,
    surfaces: Surfaces,
    lines: line::Lines,
    borders: border::Borders,
    grounds: ground::Grounds,
    composite: composite::Composite,
    /// Made when first needed.
    panes: Option<Panes>,
    strokes: Option<stroke::Strokes>,
    canvas: Canvas,
    bodies: Option<Bodies>,
    read_back: ReadBack,
}

impl Lit {
    /// Prepares to draw pictures of a width and height (px).
    ///
    /// # Errors
    /// The device fails.
    pub(super) fn new(gpu: &Gpu, size: [u32; 2]) -> Result<Self, RenderError> {
        let ([width, height], longest) = (size, gpu.longest_side());
        if width.max(height) > longest {
            return Err(RenderError::Size { width, height, longest });
        }
        let stage = Stage::new(gpu);
        let lit = Self {
            surfaces: Surfaces::new(&stage),
            lines: line::Lines::new(&stage),
            borders: border::Borders::new(&stage),
            grounds: ground::Grounds::new(gpu, &stage.panels),
            composite: composite::Composite::default(),
            panes: None,
            strokes: None,
            canvas: Canvas::new(gpu, size),
            bodies: None,
            read_back: ReadBack::new(gpu, width, height),
            stage,
        };
        gpu.check()?;
        Ok(lit)
    }

    /// Waits for a submitted picture, and returns its pixels: red, green, blue and opacity of each, in rows from the top left.
    ///
    /// # Errors
    /// The device fails.
    pub(super) fn collect(&self, pending: Pending) -> Result<Vec<u8>, RenderError> {
        Ok(self.read_back.collect(&self.stage.gpu, pending)?)
    }

    /// Submits a picture and returns at once. Collect it before the next one is submitted: there is one buffer for
    /// reading back.
    pub(super) fn submit(&mut self, picture: &Picture) -> Result<Pending, RenderError> {
        let gpu = self.stage.gpu.clone();
        let (places, needed) = panel::place(picture);
        // Items behind surfaces are drawn only where they are read: over turned-over elements, and by lines of turned-over
        // elements without faces.
        let has_behind = picture.panels.iter().any(|panel| panel::has_behind(panel) || line::has_alarm(panel));
        let made = || Bodies::new(&gpu, &self.stage.layouts, target::rounded(needed), has_behind);
        let bodies = self.bodies.take().filter(|bodies| bodies.suit(needed, has_behind)).unwrap_or_else(made);
        let bodies = &*self.bodies.insert(bodies);
        self.stage.panels.write(&gpu, picture, &places);
        let stage = &self.stage;
        self.surfaces.write(stage, picture);
        self.borders.write(stage, picture)?;
        self.composite.write(stage, picture);
        self.grounds.write(&gpu, picture);
        self.lines.write(stage, picture)?;
        let panes = Panes::are_in(picture).then(|| self.panes.get_or_insert_with(|| Panes::new(stage)));
        let panes = panes.map(|panes| {
            panes.write(stage, picture);
            &*panes
        });
        let strokes = stroke::Strokes::are_in(picture);
        let strokes = strokes.then(|| self.strokes.get_or_insert_with(|| stroke::Strokes::new(stage)));
        let strokes = strokes.map(|strokes| {
            strokes.write(stage, picture);
            &*strokes
        });

        let mut commands = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let (mut load, mut deep) = (CLEAR, FAR);
        if has_behind {
            // One drawing serves both uses: the other surfaces are drawn over it.
            let targets = [(&bodies.alarm_colour, CLEAR), (&bodies.colour, CLEAR)];
            let depth = Some((&bodies.alarm_depth, FAR));
            let mut pass = Pass::begin(&gpu, &mut commands, "turned over", &targets, depth);
            self.surfaces.draw(&mut pass, stage, bodies, &places, Set::TurnedOver);
            drop(pass);
            bodies.copy_depth(&mut commands);
            (load, deep) = (wgpu::LoadOp::Load, wgpu::LoadOp::Load);
        }
        {
            let depth = Some((&bodies.depth, deep));
            let mut pass = Pass::begin(&gpu, &mut commands, "bodies", &[(&bodies.colour, load)], depth);
            for set in [Set::Sound, Set::Obstacles] {
                self.surfaces.draw(&mut pass, stage, bodies, &places, set);
            }
        }
        {
            let mut pass = Pass::begin(&gpu, &mut commands, "borders", &[(&bodies.borders, CLEAR)], None);
            self.borders.draw(&mut pass, stage, bodies, &places);
        }
        self.lines.test(&mut commands, stage, bodies, &places);
        {
            let mut pass = Pass::begin(&gpu, &mut commands, "lines", &[(&bodies.lines, CLEAR)], None);
            self.lines.draw(&mut pass, stage, &places);
        }
        let [r, g, b] = panel::linear(picture.palette.background).to_array().map(f64::from);
        let background = wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a: 1.0 });
        {
            let mut pass = Pass::begin(&gpu, &mut commands, "picture", &[(&self.canvas.view, background)], None);
            self.grounds.draw(&mut pass, &stage.panels, picture);
            self.composite.draw(&mut pass, stage, bodies, picture);
            if let Some(strokes) = strokes {
                strokes.draw(&mut pass, stage, bodies, picture, false);
            }
            if let Some(panes) = panes {
                panes.draw(&mut pass, stage, bodies, picture);
            }
            if let Some(strokes) = strokes {
                strokes.draw(&mut pass, stage, bodies, picture, true);
            }
        }
        Ok(self.read_back.submit(&gpu, commands, &self.canvas.texture))
    }
}

/// Empty: transparent, and infinitely far away.
const CLEAR: wgpu::LoadOp<wgpu::Color> = wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT);
const FAR: wgpu::LoadOp<f32> = wgpu::LoadOp::Clear(0.0);
