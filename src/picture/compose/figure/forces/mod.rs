//! Diagrams of forces: the forces of each model on the nodes at the start of a scene.
//!
//! ```text
//! title and caption
//! │ name      │ name      │
//! │ note      │ note      │
//! │ scene     │ scene     │
//! │   body    │   body    │
//! │ scene     │ scene     │
//! │   body    │   body    │
//! key
//! ```

mod cell;
mod drawn;

use super::NoRoom;
use crate::look::{Labels, Palette, print};
use crate::picture::Item;
use crate::picture::Picture;
use crate::picture::arrows::{outlined, with_halo};
use crate::picture::caption::Writer;
use crate::picture::compose::Composer;
use crate::picture::layout::steps::{GAP, MARGIN, NAME_ROW, ROOM, ROW};
use crate::picture::layout::tree::{self, Node, Solved};
use crate::picture::layout::{self, ASCENT, Part, Scale, Wanted};
use crate::picture::legend::{Legend, Sample, SampleKind};
use crate::picture::number::round_below;
use crate::picture::text::{Fonts, Weight};
use crate::runner::history::History;
use crate::runner::moments::Moments;
use crate::scene::figure::{Figure, Forces};
use crate::scene::{Run, Scene};
use crate::sim::Shape;
use cell::Cell;
use drawn::CellView;
use glam::DVec2;

/// Composes a diagram, and tells what has no room in it.
pub(super) fn compose(figure: &Figure, forces: &Forces, moments: &Moments) -> Result<(Picture, Vec<String>), NoRoom> {
    let scenes: Vec<Scene> = forces.scenes.iter().map(|scene| bare(scene, figure)).collect();
    let composers: Vec<_> = scenes.iter().map(|scene| Composer::new(scene, &History::default())).collect();
    let fonts = Fonts::new(&figure.look.font);
    let palette = figure.look.palette();
    let diagram = Diagram::new(figure, forces, &composers, moments);
    let mut writer = Writer::new(&palette, &fonts, diagram.scale);
    let samples = 2 + usize::from(forces.compare.is_some());
    let key = Legend::new(figure.size, diagram.scale, samples as f64, false);
    let [width, _] = diagram.size;
    let titles = writer.titles(diagram.scale, [&figure.title, &figure.caption], width - 2.0 * diagram.scale.margin());
    let page = diagram.page(titles.each_ref().map(Vec::len), key.height);
    for (part, lines) in [Part::Title, Part::Caption].into_iter().zip(&titles) {
        writer.lines(&page, part, diagram.scale, lines, diagram.scale.margin());
    }
    let bodies = diagram.bodies(&page)?;
    let (mut panels, mut under, mut above) = (Vec::new(), Vec::new(), Vec::new());
    for (at, cell) in diagram.cells.iter().enumerate() {
        let Some((room, centre)) = bodies.place(at, diagram.columns) else { break };
        let draft = cell.draft(room, diagram.scale, bodies.pixels, centre);
        let view = CellView { cell, draft, room, scale: diagram.scale, palette: &palette };
        panels.push(view.panel(&mut under));
        view.draw(forces, &mut writer, &mut above);
    }
    // Above the fading at the sides of the cells.
    let top = page.get(Part::Name).map_or(0.0, |[_, top, ..]| top);
    let [_, first, _, height] = page.get(Part::Row).unwrap_or_default();
    for [left, ..] in page.all(Part::Name).skip(1) {
        let line = [left.round(), top, diagram.scale.unit.round().max(1.0), first + height - top];
        above.push(Item::rectangle(line, palette.hairline));
    }
    diagram.write(&mut writer, &page, &bodies.places);
    if let Some([_, top, ..]) = page.get(Part::Legend) {
        key.draw(&mut writer, [width, top], &diagram.samples(&palette, key, bodies.pixels), None);
    }
    above.extend(writer.items());
    let picture = Picture { size: figure.size, palette, fonts, ramp: Vec::new(), panels, under, above };
    Ok((picture, layout::told(&page, &[])))
}

/// A diagram of several scenes.
struct Diagram<'a> {
    forces: &'a Forces,
    composers: &'a [Composer<'a>],
    /// The runs, which all scenes have.
    runs: &'a [Run],
    /// The numbers of columns and rows. Each run has a column; scenes of one run stand beside each other.
    columns: usize,
    rows: usize,
    /// Row by row.
    cells: Vec<Cell<'a>>,
    /// Width and height (px).
    size: [f64; 2],
    scale: Scale,
}

/// The bodies of a diagram, at one scale.
struct Bodies {
    /// The cells, row by row, and the rooms for scenes' titles and for bodies in them.
    places: Solved<Part>,
    /// The boxes around the contents of each row: to the right and up from the middles of the bodies (m).
    of_rows: Vec<[DVec2; 2]>,
    /// The scale (px/m).
    pixels: f64,
}

impl<'a> Diagram<'a> {
    fn new(figure: &Figure, forces: &'a Forces, composers: &'a [Composer<'a>], moments: &Moments) -> Self {
        let runs = &composers[0].scene.runs;
        let several = runs.len() > 1;
        let (columns, rows) = if several { (runs.len(), composers.len()) } else { (composers.len(), 1) };
        let cells = (0..rows * columns).map(|at| {
            let (scene, run) = if several { (at / columns, at % columns) } else { (at, 0) };
            let compare = forces.compare.filter(|&compare| compare != run);
            Cell::new(&composers[scene], &moments.forces[scene], run, compare)
        });
        let [width, height] = figure.size;
        let scale =
            Scale::at(print::unit(figure.size, [width / columns as u32, height])).with(&composers[0].scene.view);
        let (cells, size) = (cells.collect(), figure.size.map(f64::from));
        Self { forces, composers, runs, columns, rows, cells, size, scale }
    }

    /// Whether each scene has a title above its row.
    fn has_headings(&self) -> bool {
        self.runs.len() > 1 && self.rows > 1
    }

    /// Whether runs have notes below their names.
    fn has_notes(&self) -> bool {
        self.runs.len() > 1 && self.forces.notes.iter().any(|note| !note.is_empty())
    }

    /// A box of a height (px) for each column, with boxes inside.
    fn in_columns(&self, part: Part, height: f64, inside: &[Node<Part>]) -> Node<Part> {
        let column = Node::new(part, 0.0).stretched().with(inside.to_vec());
        Node::new(Part::Edge, height).with(vec![column; self.columns])
    }

    /// The boxes of the page, with numbers of lines of title and caption, and a key of a height (px).
    fn page(&self, titles: [usize; 2], key: f64) -> Solved<Part> {
        let (unit, type_unit, [width, height]) = (self.scale.unit, self.scale.type_unit(), self.size);
        let wanted = Wanted { titles, is_figure: true, legend: Some(key), ..Wanted::default() };
        let rows = [
            Node::new(Part::Edge, if titles == [0; 2] { MARGIN } else { GAP } * unit),
            self.in_columns(Part::Name, NAME_ROW * type_unit, &[]),
            self.in_columns(Part::Second, if self.has_notes() { ROW * type_unit } else { 0.0 }, &[]),
            layout::row(f64::INFINITY, height, false),
        ];
        tree::column(&layout::page(self.scale, wanted, rows.into_iter()), [0.0, 0.0, width, height])
    }

    /// The bodies on a page. Columns and rows align them, and rows share the height by their needs.
    fn bodies(&self, page: &Solved<Part>) -> Result<Bodies, NoRoom> {
        let (unit, type_unit) = (self.scale.unit, self.scale.type_unit());
        let extents: Vec<_> = self.cells.iter().map(Cell::extent).collect();
        let of_rows: Vec<_> = extents.chunks(self.columns).map(joined).collect();
        let [low, high] = joined(&of_rows);
        let title = Node::new(Part::Heading, if self.has_headings() { ROW * type_unit } else { 0.0 });
        let title = title.after(GAP * unit);
        // Labels need room on all sides.
        let beside = ROOM * if self.forces.numbers { type_unit } else { unit };
        let words = (if self.has_headings() { 3.0 } else { 2.0 }) * ROW * type_unit + GAP * unit;
        let place = page.get(Part::Row).unwrap_or_default();
        let needed: f64 = of_rows.iter().map(|[low, high]| high.y - low.y).sum();
        let across = (self.size[0] / self.columns as f64 - 2.0 * beside) / (high.x - low.x).max(1e-9);
        let down = (place[3] - self.rows as f64 * words) / needed.max(1e-9);
        let pixels = across.min(down);
        if !(pixels > 0.0 && pixels.is_finite()) {
            return Err(NoRoom);
        }
        let body = Node::new(Part::Body, 0.0).stretched();
        let row = |[low, high]: &[DVec2; 2]| {
            let height = words + (high.y - low.y) * pixels;
            self.in_columns(Part::Panel, height, &[title.clone(), body.clone()]).stretched()
        };
        let places = tree::column(&of_rows.iter().map(row).collect::<Vec<_>>(), place);
        Ok(Bodies { places, of_rows, pixels })
    }

    /// Writes the names and notes of columns and the titles of rows.
    fn write(&self, writer: &mut Writer<'_>, page: &Solved<Part>, places: &Solved<Part>) {
        let (scale, palette, fonts) = (self.scale, writer.palette, writer.fonts);
        let title = |at: usize| self.composers[at].scene.title.as_str();
        let mut write = |text: &str, weight, size, colour, [left, top, width, _]: tree::Place| {
            let text = fonts.shortened(text, weight, size, width - 2.0 * scale.margin());
            writer.left(&text, weight, size, colour, left + scale.margin(), top + ASCENT * size);
        };
        for (column, (name, note)) in page.all(Part::Name).zip(page.all(Part::Second)).enumerate() {
            let text = if self.runs.len() > 1 { &self.runs[column].name } else { title(column) };
            write(text, Weight::SemiBold, scale.title(), palette.text, name);
            if self.has_notes() {
                write(&self.forces.notes[column], Weight::Regular, scale.caption(), palette.second_text, note);
            }
        }
        for (at, place) in places.all(Part::Heading).enumerate().filter(|_| self.has_headings()) {
            write(title(at / self.columns), Weight::SemiBold, scale.caption(), palette.text, place);
        }
    }

    /// The contents of the key, with bodies at a scale (px/m).
    fn samples(&self, palette: &Palette, key: Legend, pixels: f64) -> Vec<Sample> {
        let side = self.composers[0].scene.view.side * pixels;
        let share = round_below(key.arrow_length() / side);
        let arrow = match self.forces.vectors {
            true => "from r to R: the force on the node over k".to_owned(),
            false => format!("{share} k × side"),
        };
        let of_compared = self.forces.compare.map(|run| {
            let run = &self.runs[run];
            let names = vec![format!("forces of “{}”, for comparison", run.name)];
            let lengths = [key.arrow_length(), self.scale.line()];
            Sample { names, kind: SampleKind::Arrow(lengths, run.line(palette).colour, outlined) }
        });
        let samples = [
            Sample {
                names: vec![arrow],
                kind: SampleKind::Arrow([share * side, self.scale.line()], palette.text, with_halo),
            },
            Sample { names: vec!["rest shape, best fit".into()], kind: SampleKind::Ghost(palette.second_text) },
        ];
        samples.into_iter().chain(of_compared).collect()
    }
}

impl Bodies {
    /// The room of a cell, and the pixel of the middle of its body; `None` without room.
    fn place(&self, at: usize, columns: usize) -> Option<(tree::Place, DVec2)> {
        let [low, high] = joined(&self.of_rows);
        let [lowest, highest] = self.of_rows[at / columns].map(|end| end.y);
        let (room, body) = (self.places.all(Part::Panel).nth(at)?, self.places.all(Part::Body).nth(at)?);
        let [left, top, width, height] = body;
        let from_middle = DVec2::new(-low.midpoint(high).x, lowest.midpoint(highest));
        let centre = DVec2::new(left, top) + 0.5 * DVec2::new(width, height) + self.pixels * from_middle;
        Some((room, centre.round()))
    }
}

/// The box around boxes.
fn joined(all: &[[DVec2; 2]]) -> [DVec2; 2] {
    let all = all.iter().copied();
    all.reduce(|[low, high], other| [low.min(other[0]), high.max(other[1])]).unwrap_or_default()
}

/// A scene for a diagram: in the figure's colours, without fields, charts, words, arrows and floors.
fn bare(scene: &Scene, figure: &Figure) -> Scene {
    let mut scene = scene.clone();
    let view = &mut scene.view;
    view.look = figure.look.clone();
    (view.colour, view.charts, view.labels) = (None, Vec::new(), Labels::NONE);
    view.visible.displacements = false;
    // Floors are not drawn, so they cover nothing.
    scene.obstacles.retain(|obstacle| !matches!(obstacle.shape, Shape::Floor { .. }));
    scene
}
