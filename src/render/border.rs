//! Smooth borders of surfaces: a pixel that a line between two colours crosses gets the colour of the other side for the
//! area there.

use super::line::{Depths, Segment};
use crate::picture::measures::NEARER;
use crate::picture::{Line, LineKind};
use glam::Vec2;

/// A line is hidden by depths that are nearer by more than this many pixels.
const HIDDEN_BY: f32 = 6.0;
/// Beyond this distance (px) from the line, rounding cannot put a pixel on the other side.
const SURE: f32 = 0.01;

/// Smooths the pixels of a panel, in rows of a width (px).
pub(super) fn smooth(depths: &Depths<'_>, pixels: &mut [u8], width: usize) {
    let region = depths.panel.region;
    if region[2] < 3 || region[3] < 3 {
        return;
    }
    let mut gains = Vec::new();
    for line in &depths.panel.borders {
        let nearer = if line.kind.is_alarm() { NEARER } else { 0.0 };
        if let Some(segment) = depths.segment([line.from, line.to], region, nearer) {
            along(depths, line, &segment, pixels, width, &mut gains);
        }
    }
    // Gains from several lines are summed, because each covers another part of the pixel. Each mixes the pixel with a
    // neighbour, so the result stays within the colours of all neighbours.
    gains.sort_unstable_by_key(|(at, _)| *at);
    let all = gains.chunk_by(|one, other| one.0 == other.0).map(|gains| {
        let at = gains[0].0;
        let near = [at, at - 4, at + 4, at - 4 * width, at + 4 * width];
        let mixed = [0, 1, 2].map(|channel| {
            let near = near.map(|at| pixels[at + channel]);
            let (low, high) = near.into_iter().fold((u8::MAX, 0), |(low, high), one| (low.min(one), high.max(one)));
            let gained: f32 = gains.iter().map(|(_, gain)| gain[channel]).sum();
            (f32::from(near[0]) + gained).round().clamp(low.into(), high.into()) as u8
        });
        (at, mixed)
    });
    for (at, colour) in all.collect::<Vec<_>>() {
        pixels[at..at + 3].copy_from_slice(&colour);
    }
}

/// The pixels that one line crosses, with the light that each gains.
fn along(
    depths: &Depths<'_>,
    line: &Line,
    Segment([from, to]): &Segment,
    pixels: &[u8],
    width: usize,
    gains: &mut Vec<(usize, [f32; 3])>,
) {
    let [left, top, wide, high] = depths.panel.region.map(|length| length as f32);
    let way = to - from;
    let is_flat = way.x.abs() >= way.y.abs();
    // The axis along which pixels are counted, and the one across.
    let [one, other] = if is_flat { [0, 1] } else { [1, 0] };
    if way[one] == 0.0 {
        return;
    }
    let (start, end) = (from[one].min(to[one]), from[one].max(to[one]));
    let is_crease = matches!(line.kind, LineKind::Edge | LineKind::AlarmEdge);
    for column in start.floor() as u32..=end.floor() as u32 {
        let middle = column as f32 + 0.5;
        let within = (middle + 0.5).min(end) - (middle - 0.5).max(start);
        let at = from.lerp(*to, ((middle - from[one]) / way[one]).clamp(0.0, 1.0));
        let row = at[other].floor();
        let place = |row: f32| if is_flat { Vec2::new(middle, row + 0.5) } else { Vec2::new(row + 0.5, middle) };
        let [before, own, after] = [row - 1.0, row, row + 1.0].map(place);
        // All neighbours lie in the region.
        if own.cmplt(Vec2::new(left, top) + 1.0).any() || own.cmpge(Vec2::new(left + wide, top + high) - 1.0).any() {
            continue;
        }
        let depth = |at: Vec2| match line.kind {
            kind if kind.is_alarm() => depths.depth_alone(at),
            LineKind::ObstacleEdge | LineKind::ObstacleContour => depths.depth(at),
            _ => depths.depth_of_bodies(at),
        };
        let [first, second, here] = [before, after, own].map(depth);
        // A crease has faces on both sides, so depths before the nearer one hide it. A contour has the surface on one side,
        // so it is hidden if all depths around it are before it.
        let beside = if is_crease { first.max(second) } else { first.min(second).min(here) };
        let is_hidden = depths.distance(at.z) * (1.0 - HIDDEN_BY / depths.panel.sight.focal) > depths.distance(beside);
        // Hidden edges of a set that is visible through others would count where they end at its outline.
        if is_hidden || within <= 0.0 || (line.kind == LineKind::AlarmEdge && first.min(second) <= 0.0) {
            continue;
        }
        let colour = |at: Vec2| {
            let place = 4 * (at.y as usize * width + at.x as usize);
            [0, 1, 2].map(|channel| f32::from(pixels[place + channel]))
        };
        // The side on which the middle of the pixel lies has its own colour.
        let share = at[other] - row;
        let one = colour(if share > 0.5 + SURE { own } else { before });
        let other = colour(if share < 0.5 - SURE { own } else { after });
        let here = colour(own);
        let gain = [0, 1, 2].map(|at| within * (share * one[at] + (1.0 - share) * other[at] - here[at]));
        gains.push((4 * (own.y as usize * width + own.x as usize), gain));
    }
}
