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
use crate::look::Labels;
use crate::picture::Item;
use crate::picture::Picture;
use crate::picture::caption::Writer;
use crate::picture::compose::Composer;
use crate::picture::layout::steps::{GAP, MARGIN, NAME_ROW, ROOM, ROW};
use crate::picture::layout::tree::{self, Node};
use crate::picture::layout::{self, ASCENT, Part, Scale, Wanted};
use crate::picture::legend::{Legend, Sample, SampleKind};
use crate::picture::number::round_below;
use crate::picture::text::{Fonts, Weight};
use crate::runner::history::History;
use crate::runner::moments::Moments;
use crate::scene::Scene;
use crate::scene::figure::{Figure, Forces};
use crate::sim::Shape;
use cell::Cell;
use drawn::Drawn;
use glam::DVec2;

/// Composes a diagram, and tells what has no room in it.
pub(super) fn compose(figure: &Figure, forces: &Forces, moments: &Moments) -> Result<(Picture, Vec<String>), NoRoom> {
    let scenes: Vec<Scene> = forces.scenes.iter().map(|scene| bare(scene, figure)).collect();
    let composers: Vec<_> = scenes.iter().map(|scene| Composer::new(scene, &History::default())).collect();
    let fonts = Fonts::new(&figure.look.font);
    let palette = figure.look.palette();
    let runs = &scenes[0].runs;
    // Scenes of one run stand beside each other.
    let (columns, rows) = if runs.len() > 1 { (runs.len(), scenes.len()) } else { (scenes.len(), 1) };
    let place = |at: usize| if runs.len() > 1 { (at / columns, at % columns) } else { (at, 0) };
    let [width, height] = figure.size.map(f64::from);
    let scale = Scale::new(figure.size, [0, 0, figure.size[0] / columns as u32, figure.size[1]]).with(&scenes[0].view);
    let mut writer = Writer::new(&palette, &fonts, scale);
    let (unit, type_unit) = (scale.unit, scale.type_unit());

    let cells = (0..rows * columns).map(|at| {
        let (scene, run) = place(at);
        let compare = forces.compare.filter(|&compare| compare != run);
        Cell::new(&composers[scene], &moments.forces[scene], run, compare)
    });
    let cells: Vec<_> = cells.collect();
    let samples = 2 + usize::from(forces.compare.is_some());
    let key = Legend::new(figure.size, scale, samples as f64, false);

    let in_columns = |part, length: f64, inside: &[Node<Part>]| {
        let column = Node::new(part, 0.0).stretched().with(inside.to_vec());
        Node::new(Part::Edge, length).with(vec![column; columns])
    };
    let titles = writer.titles(scale, [&figure.title, &figure.caption], width - 2.0 * scale.margin());
    let lines = titles.each_ref().map(Vec::len);
    let wanted = Wanted { titles: lines, is_figure: true, legend: Some(key.height), ..Wanted::default() };
    let has_notes = runs.len() > 1 && forces.notes.iter().any(|note| !note.is_empty());
    let rows_of_page = [
        Node::new(Part::Edge, if lines == [0; 2] { MARGIN } else { GAP } * unit),
        in_columns(Part::Name, NAME_ROW * type_unit, &[]),
        in_columns(Part::Second, if has_notes { ROW * type_unit } else { 0.0 }, &[]),
        layout::row(f64::INFINITY, height, false),
    ];
    let page = tree::column(&layout::page(scale, wanted, rows_of_page.into_iter()), [0.0, 0.0, width, height]);
    for (part, lines) in [Part::Title, Part::Caption].into_iter().zip(&titles) {
        writer.lines(&page, part, scale, lines, scale.margin());
    }

    // Bodies of one scale are aligned in columns and rows, which share the height by their needs.
    let extents: Vec<_> = cells.iter().map(Cell::extent).collect();
    let joined = |all: &[[DVec2; 2]]| {
        let all = all.iter().copied();
        all.reduce(|[low, high], other| [low.min(other[0]), high.max(other[1])]).unwrap_or_default()
    };
    let of_rows: Vec<_> = extents.chunks(columns).map(joined).collect();
    let [low, high] = joined(&of_rows);
    let scene = Node::new(Part::Heading, if runs.len() > 1 && rows > 1 { ROW * type_unit } else { 0.0 });
    let scene = scene.after(GAP * unit);
    // Labels need room on all sides.
    let beside = ROOM * if forces.numbers { type_unit } else { unit };
    let words = (if runs.len() > 1 && rows > 1 { 3.0 } else { 2.0 }) * ROW * type_unit + GAP * unit;
    let place_of_cells = page.get(Part::Row).unwrap_or_default();
    let needed: f64 = of_rows.iter().map(|[low, high]| high.y - low.y).sum();
    let across = (width / columns as f64 - 2.0 * beside) / (high.x - low.x).max(1e-9);
    let down = (place_of_cells[3] - rows as f64 * words) / needed.max(1e-9);
    let pixels = across.min(down);
    if !(pixels > 0.0 && pixels.is_finite()) {
        return Err(NoRoom);
    }
    let body = Node::new(Part::Body, 0.0).stretched();
    let row = |[low, high]: &[DVec2; 2]| {
        in_columns(Part::Panel, words + (high.y - low.y) * pixels, &[scene.clone(), body.clone()]).stretched()
    };
    let places = tree::column(&of_rows.iter().map(row).collect::<Vec<_>>(), place_of_cells);

    let (mut panels, mut under, mut above) = (Vec::new(), Vec::new(), Vec::new());
    let bodies = places.all(Part::Panel).zip(places.all(Part::Body));
    for ((at, cell), (room, [left, top, width, height])) in cells.iter().enumerate().zip(bodies) {
        let [lowest, highest] = of_rows[at / columns].map(|end| end.y);
        let from_middle = DVec2::new(-low.midpoint(high).x, lowest.midpoint(highest));
        let centre = DVec2::new(left, top) + 0.5 * DVec2::new(width, height) + pixels * from_middle;
        let view =
            Drawn { cell, draft: cell.draft(room, scale, pixels, centre.round()), room, scale, palette: &palette };
        panels.push(view.panel(&mut under));
        view.draw(forces, &mut writer, &mut above);
    }
    // Above the fading at the sides of the cells.
    let top = page.get(Part::Name).map_or(0.0, |[_, top, ..]| top);
    for [left, ..] in page.all(Part::Name).skip(1) {
        let line = [left.round(), top, unit.round().max(1.0), place_of_cells[1] + place_of_cells[3] - top];
        above.push(Item::rectangle(line, palette.hairline));
    }
    let mut write = |text: &str, weight, size, colour, [left, top, width, _]: tree::Place| {
        let text = fonts.shortened(text, weight, size, width - 2.0 * scale.margin());
        writer.left(&text, weight, size, colour, left + scale.margin(), top + ASCENT * size);
    };
    for (column, (name, note)) in page.all(Part::Name).zip(page.all(Part::Second)).enumerate() {
        let text = if runs.len() > 1 { &runs[column].name } else { &scenes[column].title };
        write(text, Weight::SemiBold, scale.title(), palette.text, name);
        if has_notes {
            write(&forces.notes[column], Weight::Regular, scale.caption(), palette.second_text, note);
        }
    }
    for (at, place_of_scene) in places.all(Part::Heading).enumerate().filter(|_| runs.len() > 1 && rows > 1) {
        write(&scenes[place(at).0].title, Weight::SemiBold, scale.caption(), palette.text, place_of_scene);
    }
    if let Some([_, top, ..]) = page.get(Part::Legend) {
        let side = scenes[0].view.side * pixels;
        let share = round_below(key.arrow_length() / side);
        let arrow = if forces.vectors {
            "from r to R: the force on the node over k".to_owned()
        } else {
            format!("{share} k × side")
        };
        let of_compared = forces.compare.map(|run| {
            let names = vec![format!("forces of “{}”, for comparison", runs[run].name).into()];
            Sample { names, kind: SampleKind::Outlined(runs[run].line(&palette).colour, scale.line()) }
        });
        let samples = [
            Sample { names: vec![arrow.into()], kind: SampleKind::Arrow([share * side, scale.line()]) },
            Sample { names: vec!["rest shape, best fit".into()], kind: SampleKind::Ghost(palette.second_text) },
        ];
        let samples: Vec<_> = samples.into_iter().chain(of_compared).collect();
        key.draw(&mut writer, [width, top], &samples, None);
    }
    above.extend(writer.items());
    let picture = Picture { size: figure.size, palette, fonts, ramp: Vec::new(), panels, under, above };
    Ok((picture, layout::told(&page, &[])))
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
