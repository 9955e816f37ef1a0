//! Wavefront's OBJ: the surfaces of all bodies of a run in one frame. Numbers have all their digits.

use super::surface::Surface;
use glam::DVec3;
use std::fmt::Write;

/// A file of bodies at a time (s) of a run with a time step (s), each with its name, its surface and the positions of its nodes (m).
pub(super) fn document<'b>(
    mark: &str,
    [time, step]: [f64; 2],
    bodies: impl Iterator<Item = (&'b str, &'b Surface, &'b [DVec3])>,
) -> String {
    let mut text = format!("# {mark}\n# time {time}\n# step {step}\n");
    let mut first = 1;
    for (name, surface, nodes) in bodies {
        let points = surface.points(nodes);
        text += &format!("o {name}\n");
        for DVec3 { x, y, z } in &*points {
            writeln!(text, "v {x} {y} {z}").expect("writing to a string");
        }
        let mut list = |word: &str, points: &[u32]| {
            text += word;
            points
                .iter()
                .for_each(|&point| write!(text, " {}", first + u64::from(point)).expect("writing to a string"));
            text.push('\n');
        };
        surface.faces.iter().for_each(|face| list("f", face));
        surface.lines.iter().for_each(|line| list("l", line));
        first += points.len() as u64;
    }
    text
}
