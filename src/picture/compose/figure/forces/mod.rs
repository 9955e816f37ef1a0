//! Diagrams of forces: the forces of each model on the nodes at the start of a scene.

mod cell;
mod drawn;
mod key;
mod marks;

use super::{NoRoom, header};
use crate::look::Labels;
use crate::picture::Item;
use crate::picture::Picture;
use crate::picture::caption::Writer;
use crate::picture::compose::Composer;
use crate::picture::layout::Scale;
use crate::picture::text::{Fonts, Weight};
use crate::runner::history::History;
use crate::runner::moments::Moments;
use crate::scene::Scene;
use crate::scene::figure::{Figure, Forces};
use crate::sim::Shape;
use cell::{Cell, fit};
use drawn::Drawn;
use key::Key;

/// Room inside a cell for labels at each side (px in the reference picture).
const LABEL_ROOM: f64 = 88.0;
const BARE_ROOM: f64 = 84.0;
/// Heights of the heads of columns and of the key at the bottom (px in the reference picture).
const HEADS: f64 = 106.0;
const KEY: f64 = 74.0;
/// Baselines of a column's name, the part of that for its type, and baselines of its note and of a row's name below its
/// top (px in the reference picture).
const NAME: f64 = 60.0;
const NAME_TYPE: f64 = 20.0;
const NOTE: f64 = 86.0;
const ROW_NAME: f64 = 20.0;
/// The gap below the figure's title and caption, which heads need less margin for (px in the reference picture).
const BELOW_HEADER: f64 = 16.0;
const UNDER_TITLE: f64 = 20.0;

/// Composes a diagram.
pub(super) fn compose(figure: &Figure, forces: &Forces, moments: &Moments) -> Result<Picture, NoRoom> {
    let scenes: Vec<Scene> = forces.scenes.iter().map(|scene| bare(scene, figure)).collect();
    let composers: Vec<_> = scenes.iter().map(|scene| Composer::new(scene, &History::default())).collect();
    let fonts = Fonts::new(&figure.look.font);
    let palette = figure.look.palette();
    let runs = scenes[0].runs.len();
    // Scenes of one run stand beside each other.
    let (columns, rows) = if runs > 1 { (runs, scenes.len()) } else { (scenes.len(), 1) };
    let [width, height] = figure.size.map(f64::from);
    let scale = Scale::new(figure.size, [0, 0, figure.size[0] / columns as u32, figure.size[1]]).with(&scenes[0].view);
    let (marks, curves, words) = Default::default();
    let mut writer = Writer { palette: &palette, fonts: &fonts, scale, marks, curves, words };
    let unit = scale.unit;
    let last = header::write(&mut writer, figure, &[], false);
    let top = if last > 0.0 { last + BELOW_HEADER * unit } else { 0.0 };
    // Below a title, names need no margin above.
    let raised = if top > 0.0 { UNDER_TITLE * unit } else { 0.0 };
    let has_notes = runs > 1 && forces.notes.iter().any(|note| !note.is_empty());
    let heads = scale.of_type(if has_notes { HEADS } else { HEADS - (NOTE - NAME) }) * unit - raised;
    let cells_top = top + heads;
    // The key's line grows upward, out of the margin.
    let cells_bottom = height - KEY * unit - (scale.caption() - Scale::at(unit).caption());
    let mut cells: Vec<Cell<'_>> = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let (scene, run) = if runs > 1 { (row, column) } else { (column, 0) };
            let left = width * column as f64 / columns as f64;
            let room = [left, cells_top, width / columns as f64, cells_bottom - cells_top];
            let compare = forces.compare.filter(|&compare| compare != run);
            cells.push(Cell::new(&composers[scene], &moments.forces[scene], run, compare, room));
        }
    }
    let side_room = if forces.numbers { scale.of_type(LABEL_ROOM) } else { BARE_ROOM } * unit;
    let boxes = fit(&mut cells, columns, side_room, scale, runs > 1 && rows > 1);
    let (pixels, centres) = boxes.ok_or(NoRoom)?;

    let (mut panels, mut under, mut above) = (Vec::new(), Vec::new(), Vec::new());
    for (cell, &centre) in cells.iter().zip(&centres) {
        let view = Drawn::new(cell, pixels, centre, scale, figure);
        panels.push(view.panel(&mut under, &mut above));
        view.draw(forces, &mut writer, &mut above);
    }
    for column in 0..columns {
        let left = width * column as f64 / columns as f64 + scale.margin();
        let room = width / columns as f64 - 2.0 * scale.margin();
        let run = &scenes[0].runs[if runs > 1 { column } else { 0 }];
        let (name, note) = if runs > 1 {
            (run.name.as_str(), forces.notes[column].as_str())
        } else {
            (scenes[column].title.as_str(), "")
        };
        let baseline = top + (NAME - NAME_TYPE + scale.of_type(NAME_TYPE)) * unit - raised;
        let name = fonts.shortened(name, Weight::SemiBold, scale.title(), room);
        writer.left(&name, Weight::SemiBold, scale.title(), palette.text, left, baseline);
        let note = fonts.shortened(note, Weight::Regular, scale.caption(), room);
        let below = baseline + scale.of_type(NOTE - NAME) * unit;
        writer.left(&note, Weight::Regular, scale.caption(), palette.second_text, left, below);
        if column > 0 {
            let x = (width * column as f64 / columns as f64).round();
            let thickness = unit.round().max(1.0);
            let from = top + scale.margin() - raised;
            let line = [x, from, thickness, cells_bottom - from];
            // Above the fading at the sides of the cells.
            above.push(Item::rectangle(line, palette.hairline));
        }
    }
    if runs > 1 && rows > 1 {
        for (at, cell) in cells.iter().enumerate() {
            let [left, top, width, _] = cell.room;
            let room = width - 2.0 * scale.margin();
            let name = fonts.shortened(&scenes[at / columns].title, Weight::SemiBold, scale.caption(), room);
            let baseline = top + scale.of_type(ROW_NAME) * unit;
            writer.left(&name, Weight::SemiBold, scale.caption(), palette.text, left + scale.margin(), baseline);
        }
    }
    Key { figure, forces, scene: &scenes[0], pixels, columns, scale }.draw(&mut writer, &mut above);
    above.extend(writer.items());
    Ok(Picture { size: figure.size, palette, fonts, ramp: Vec::new(), panels, under, above })
}

/// A scene for a diagram: in the figure's colours, without fields, charts, words, arrows and floors.
fn bare(scene: &Scene, figure: &Figure) -> Scene {
    let mut scene = scene.clone();
    let view = &mut scene.view;
    view.look = figure.look.clone();
    (view.colour, view.charts) = (None, Vec::new());
    view.visible.displacements = false;
    // There is no scale bar, but its room is kept.
    view.labels = Labels { scale_bar: view.labels.scale_bar, ..Labels::NONE };
    // Floors are not drawn, so they cover nothing.
    scene.obstacles.retain(|obstacle| !matches!(obstacle.shape, Shape::Floor { .. }));
    scene
}
