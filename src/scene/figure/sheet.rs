//! Resolves a contact sheet.

use super::file::{ColumnFile, RowFile, SheetFile};
use super::resolve::{Scenes, share_lines};
use super::{Column, Row, Sheet};
use crate::look::Plot;
use crate::scene::view;
use crate::scene::{Scene, SceneError};
use std::mem::take;

impl Scenes<'_> {
    /// The columns of a sheet; `None` after reporting a mistake.
    fn columns(&mut self, file: &mut SheetFile) -> Result<Option<Vec<Column>>, SceneError> {
        let sheet = self.report.to("sheet");
        let before = self.report.total();
        let moment = |&time: &f64| ColumnFile { scene: None, time: Some(time), label: None };
        let wrong = match &file.moments {
            Some(_) if !file.column.is_empty() => "both `moments` and `column` are given; keep one of them",
            Some(_) if file.scene.is_none() => "the moments have no `scene`",
            _ => "",
        };
        if !wrong.is_empty() {
            sheet.to("moments").wrong_key(wrong, None);
            return Ok(None);
        }
        let moments = file.moments.iter().flatten().map(moment);
        let columns: Vec<_> = moments.chain(take(&mut file.column)).collect();
        if columns.is_empty() {
            sheet.to("").wrong("the sheet has no columns: expected `moments` or `[[sheet.column]]`", None);
            return Ok(None);
        }
        let usual = match &file.scene {
            Some(named) => self.scene(named, &sheet.to("scene"))?,
            None => None,
        };
        let mut resolved = Vec::new();
        for (index, column) in columns.into_iter().enumerate() {
            let here = sheet.to("column").to(index).to("scene");
            let scene = match (&column.scene, &file.scene) {
                (Some(named), _) => self.scene(named, &here)?,
                (None, Some(_)) => usual,
                (None, None) => {
                    here.wrong("the column has no scene: expected `scene` here or in `[sheet]`", None);
                    None
                }
            };
            resolved.extend(scene.map(|scene| Column { scene, time: column.time, label: column.label }));
        }
        Ok(Some(resolved).filter(|_| self.report.total() == before))
    }

    /// The sheet of a file; `None` after reporting a mistake.
    pub(super) fn sheet(mut self, mut file: SheetFile) -> Result<Option<Sheet>, SceneError> {
        let before = self.report.total();
        let Some(columns) = self.columns(&mut file)? else { return Ok(None) };
        let rows = if file.row.is_empty() {
            let all = self.scenes[0].runs.iter();
            all.map(|run| RowFile { run: run.name.clone(), time: None, label: None, note: None }).collect()
        } else {
            file.row
        };
        self.check_cells(&rows, &columns, file.moments.is_some());
        let ends: Vec<_> = self.scenes.iter().map(end).collect();
        if let Some(other) = ends.iter().position(|end| *end != ends[0]).filter(|_| !file.charts.is_empty()) {
            let [one, two] = [0, other].map(|at| format!("“{}” ends at {} s", self.scenes[at].title, ends[at]));
            let message = format!("charts over several scenes have one axis of time, but {one} and {two}");
            let help = "give the scenes the same duration and frame rate";
            self.report.to("sheet").to("charts").wrong_key(message, help);
        }
        Scene::check_charts(&file.charts, &self.scenes, "sheet", self.report);
        self.check_times(&file.charts, file.from, file.split, &columns);
        if let Some(index) = rows.iter().position(|row| row.time.is_some()).filter(|_| !file.charts.is_empty()) {
            let time = self.report.to("sheet").to("row").to(index).to("time");
            let message = "charts mark the moments of columns, but here a row has one of its own";
            time.wrong_key(message, "leave out `sheet.charts`, or give the moments of columns");
        }
        let row = |row: RowFile| Row {
            label: row.label.unwrap_or_else(|| row.run.clone()),
            run: row.run,
            time: row.time,
            note: row.note.unwrap_or_default(),
        };
        let rows = rows.into_iter().map(row).collect();
        let Self { report, mut scenes, .. } = self;
        share_lines(&mut scenes);
        if let Some(typed) = &file.colour {
            let scales = view::colour(typed, &scenes, "sheet", report).unwrap_or_default();
            scenes.iter_mut().zip(scales).for_each(|(scene, scale)| scene.view.colour = Some(scale));
        }
        let SheetFile { charts, number, from, split, .. } = file;
        let sheet = Sheet { scenes, columns, rows, charts, number, from: from.unwrap_or(0.0), split };
        Ok((report.total() == before).then_some(sheet))
    }

    /// Whether the time axis includes its start, the change of its scale, and the moments of columns.
    fn check_times(&mut self, charts: &[Plot], from: Option<f64>, split: Option<f64>, columns: &[Column]) {
        let sheet = self.report.to("sheet");
        for (key, _) in [("from", from), ("split", split)].iter().filter(|(_, time)| time.is_some()) {
            if charts.is_empty() {
                let here = sheet.to(*key);
                here.wrong_key(format!("`{here}` is about charts, but there are none"), None);
                return;
            }
        }
        let end = end(&self.scenes[0]);
        let earliest = columns.iter().filter_map(|column| column.time).fold(end, f64::min);
        if let Some(from) = from.filter(|&from| from > earliest || from >= end) {
            let message = match earliest < end {
                true => format!("the axis of time begins at {from} s, but there is a moment at {earliest} s"),
                false => format!("the axis of time begins at {from} s, but the scene ends at {end} s"),
            };
            sheet.to("from").wrong(message, "expected an earlier one");
        } else if let Some(split) = split.filter(|&split| split >= end || split <= from.unwrap_or(0.0)) {
            let from = from.unwrap_or(0.0);
            let message =
                format!("the axis of time goes from {from} to {end} s; expected a moment between, found {split}");
            sheet.to("split").wrong(message, None);
        }
    }

    /// Whether each cell has a run and a moment.
    fn check_cells(&mut self, rows: &[RowFile], columns: &[Column], are_moments: bool) {
        let sheet = self.report.to("sheet");
        for (index, row) in rows.iter().enumerate() {
            let here = sheet.to("row").to(index);
            for scene in &self.scenes {
                if !scene.runs.iter().any(|run| run.name == row.run) {
                    let (message, help) = scene.no_run(&row.run);
                    here.to("run").wrong(message, help);
                }
                if row.time.is_some_and(|time| time > end(scene)) {
                    here.to("time").wrong(too_late(scene), None);
                }
            }
        }
        let timed = rows.iter().position(|row| row.time.is_some());
        if let Some(index) = timed.filter(|_| columns.iter().any(|column| column.time.is_some())) {
            let message = "both a row and a column give the moment of the same picture";
            sheet.to("row").to(index).to("time").wrong_key(message, "keep the moments of either rows or columns");
        }
        let timeless = rows.iter().find(|row| row.time.is_none());
        for (index, column) in columns.iter().enumerate() {
            let scene = &self.scenes[column.scene];
            let time = sheet.to("column").to(index).to("time");
            if column.time.is_some_and(|time| time > end(scene)) {
                let place = if are_moments { &sheet.to("moments").to(index) } else { &time };
                place.wrong(too_late(scene), None);
            }
            if let Some(row) = timeless.filter(|_| column.time.is_none()) {
                let message = format!("the column has no `time`, and neither has the row “{}”", row.run);
                time.wrong(message, "give it in one of them");
            }
        }
    }
}

/// The last moment of a scene (s).
fn end(scene: &Scene) -> f64 {
    scene.frame_time(scene.last_frame())
}

fn too_late(scene: &Scene) -> String {
    format!("the scene “{}” ends at {} s; expected a moment up to then", scene.title, end(scene))
}
