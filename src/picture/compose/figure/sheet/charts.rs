//! Charts below the tiles: diagnostics of all rows over the time of their scene, with the moments of the columns.

use crate::picture::caption::{self, Writer};
use crate::picture::chart::NUMBERS;
use crate::picture::ends::Ends;
use crate::picture::flag::{self, Flag};
use crate::picture::layout::{CURVE_NAME, Scale};
use crate::picture::strip::{SplitChart, Strip};
use crate::runner::history::History;
use crate::scene::figure::Sheet;

/// The largest share of the picture's width for names at the ends of curves, and half of the gap between names of
/// two charts (px in the reference picture).
const NAMES: f64 = 0.16;
const NAMES_APART: f64 = 3.0;

/// The places of charts (px).
pub(super) struct ChartsRoom {
    /// The middle of the rings above all charts.
    pub(super) rings: f64,
    /// Left and right end of all charts.
    pub(super) span: [f64; 2],
    /// The left end of their names.
    pub(super) names: Option<f64>,
    /// Top and bottom of each chart.
    pub(super) charts: Vec<[f64; 2]>,
    /// The gap between charts.
    pub(super) between: f64,
}

/// The contents of charts.
pub(super) struct Charts<'a> {
    sheet: &'a Sheet,
    /// The last moment (s).
    end: f64,
    charts: Vec<Strip>,
    /// Names at the ends of curves, if there is room for them, the same beside all charts.
    ends: Option<Ends>,
    /// The widths of the names, and of the numbers beside the charts with gaps (px).
    pub(super) names_width: f64,
    pub(super) numbers_width: f64,
}

impl<'a> Charts<'a> {
    /// The charts of a sheet, with the time series of each of its scenes.
    pub(super) fn new(sheet: &'a Sheet, histories: &[History], writer: &Writer<'_>, width: f64) -> Self {
        let (fonts, scale) = (writer.fonts, writer.scale);
        // A common label of all rows of a run replaces the run's name.
        let label = |run: &str| {
            let mut labels = sheet.rows.iter().filter(|row| row.run == run).map(|row| &row.label);
            labels.next().filter(|first| labels.all(|label| label == *first)).map_or(run, |label| label).to_owned()
        };
        let of_scenes: Vec<_> = sheet.scenes.iter().zip(histories).collect();
        let one = |&diagnostic| Strip::new(diagnostic, &of_scenes, writer.palette, label);
        let charts: Vec<_> = sheet.strips.iter().map(one).collect();
        // The lines of all charts have the same names.
        let room = [NAMES * width, f64::INFINITY];
        let type_unit = scale.type_unit();
        let ends = charts.iter().find_map(|one| Ends::new(fonts, &one.series, type_unit, room, false));
        let numbers_width = charts.iter().map(|one| one.numbers_width(fonts, type_unit)).fold(0.0, f64::max);
        let names_width = charts.iter().map(|one| one.name_width(fonts, scale)).fold(0.0, f64::max);
        Self { sheet, end: histories[0].end, charts, ends, names_width, numbers_width }
    }

    /// The width of the names right of the charts (px).
    pub(super) fn ends_width(&self) -> f64 {
        self.ends.as_ref().map_or(0.0, |ends| ends.width)
    }

    /// The height that the names of all curves of a chart need (px in the reference picture).
    pub(super) fn ends_height(&self) -> f64 {
        let names = self.charts.iter().map(|one| one.series.len()).max().unwrap_or(0);
        self.ends.as_ref().map_or(0.0, |_| names as f64 * CURVE_NAME + 2.0 * NAMES_APART)
    }

    pub(super) fn count(&self) -> usize {
        self.charts.len()
    }

    /// Draws as many charts as fit, and explains bands if there is room below a name.
    pub(super) fn draw(&mut self, writer: &mut Writer<'_>, room: &ChartsRoom) {
        let (fonts, scale) = (writer.fonts, writer.scale);
        if !Scale::legible(NUMBERS * scale.type_unit()) || self.end <= 0.0 {
            return;
        }
        let (sheet, end, count) = (self.sheet, self.end, room.charts.len());
        let parts = |ends| SplitChart::new(scale, room.span, ends, [sheet.from, end], sheet.split);
        let all = [room.charts[0][0], room.charts[room.charts.len() - 1][1]];
        // A line through all charts at the moment of each column, with the column's letter in a ring above.
        let columns = sheet.columns.iter().enumerate();
        let colour = writer.palette.second_text;
        let flags = columns.filter_map(|(at, column)| {
            Some(Flag { at: parts(all).place(column.time?).1, text: caption::letter(at), colour })
        });
        let mut flags: Vec<_> = flags.collect();
        flags.sort_by(|one, other| one.at.total_cmp(&other.at));
        flag::draw(writer, &flags, room.rings, room.span, all);
        for (at, (one, &[top, bottom])) in self.charts.iter_mut().zip(&room.charts).enumerate() {
            // Names may extend beside the gaps between charts, but must stay apart from the names of another chart.
            let beyond = 0.5 * room.between - NAMES_APART * scale.type_unit();
            let between = [top - beyond, bottom + beyond];
            let parts = parts([top, bottom]);
            one.draw(writer, &parts, at + 1 == count, self.ends.as_ref(), between);
            if let Some(left) = room.names {
                let name_room = [room.span[0] - self.numbers_width - left, bottom - top + room.between];
                one.explain_bands(fonts, &parts, |one| {
                    one.name_width(fonts, scale) <= name_room[0] && one.name_height(scale) <= name_room[1]
                });
                one.write_name(writer, [left, 0.5 * (top + bottom)]);
            }
        }
    }
}
