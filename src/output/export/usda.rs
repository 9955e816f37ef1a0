//! Pixar's Universal Scene Description as text: one file for each run, with a mesh for each body whose points have a sample for
//! each frame. Numbers have single precision, as the format has for points.

use super::course::Course;
use super::narrow::singles;
use super::surface::Surface;
use super::{FilesOf, OfBody};
use crate::sim::geometry::bounds;
use glam::DVec3;
use std::collections::BTreeSet;
use std::io::{self, Write};

/// Writes a run. The file has a mark, the name of the run, and the frames per second of the scene (1/s).
pub(super) fn write(
    to: &mut impl Write,
    (mark, name): (&str, &str),
    rate: f64,
    run: &FilesOf<Surface>,
    course: &mut Course<'_>,
) -> io::Result<()> {
    // The unit of time is a frame.
    let codes: Vec<f64> = course.times.iter().map(|time| time * rate).collect();
    let (first, last) = (codes[0], codes[codes.len() - 1]);
    let mut names = Names::default();
    let root = names.of(name);
    write!(
        to,
        "#usda 1.0\n(\n    doc = \"{mark}\"\n    defaultPrim = \"{root}\"\n    upAxis = \"Y\"\n    metersPerUnit = 1\n    \
         startTimeCode = {first}\n    endTimeCode = {last}\n    timeCodesPerSecond = {rate}\n    framesPerSecond = {rate}\n)\n\n\
         def Xform \"{root}\" (\n    displayName = {}\n    kind = \"component\"\n)\n{{\n",
        quoted(name)
    )?;
    let mut names = Names::default();
    for body in &run.bodies {
        let surface = &body.shown;
        if !surface.faces.is_empty() || surface.lines.is_empty() {
            begin(to, "Mesh", &names.of(body.title()), body.title())?;
            to.write_all(
                b"        uniform token subdivisionScheme = \"none\"\n        uniform bool doubleSided = 1\n",
            )?;
            numbers(to, "int[] faceVertexCounts", surface.faces.iter().map(<[u32]>::len))?;
            numbers(to, "int[] faceVertexIndices", surface.faces.indices().iter())?;
            let all = |points: &[DVec3]| points.to_vec();
            samples(to, body, course, &codes, &all)?;
            to.write_all(b"    }\n")?;
        }
        if !surface.lines.is_empty() {
            begin(to, "BasisCurves", &names.of(&format!("{} lines", body.title())), body.title())?;
            to.write_all(b"        uniform token type = \"linear\"\n")?;
            numbers(to, "int[] curveVertexCounts", surface.lines.iter().map(|_| 2))?;
            let ends = |points: &[DVec3]| surface.lines.iter().flatten().map(|&point| points[point as usize]).collect();
            samples(to, body, course, &codes, &ends)?;
            to.write_all(b"    }\n")?;
        }
    }
    to.write_all(b"}\n")
}

fn begin(to: &mut impl Write, kind: &str, name: &str, shown: &str) -> io::Result<()> {
    write!(to, "    def {kind} \"{name}\" (\n        displayName = {}\n    )\n    {{\n", quoted(shown))
}

/// The box, the points and the velocities in each frame, of the points that `of` takes from those of the surface.
fn samples(
    to: &mut impl Write,
    body: &OfBody<Surface>,
    course: &mut Course<'_>,
    codes: &[f64],
    of: &dyn Fn(&[DVec3]) -> Vec<DVec3>,
) -> io::Result<()> {
    let shown =
        [("float3[] extent", "position"), ("point3f[] points", "position"), ("vector3f[] velocities", "velocity")];
    for (what, quantity) in shown {
        writeln!(to, "        {what}.timeSamples = {{")?;
        for (frame, code) in codes.iter().enumerate() {
            let of_nodes = course.read(quantity, frame, &body.nodes)?;
            let mut vectors = of(&body.shown.points(&of_nodes));
            if what == "float3[] extent" {
                let (low, high) = bounds(&vectors);
                vectors = vec![low, high];
            }
            write!(to, "            {code}: [")?;
            for (at, vector) in vectors.into_iter().enumerate() {
                let [x, y, z] = singles(vector);
                write!(to, "{}({x}, {y}, {z})", if at == 0 { "" } else { ", " })?;
            }
            to.write_all(b"],\n")?;
        }
        to.write_all(b"        }\n")?;
    }
    Ok(())
}

fn numbers(to: &mut impl Write, what: &str, numbers: impl Iterator<Item = impl std::fmt::Display>) -> io::Result<()> {
    write!(to, "        {what} = [")?;
    for (at, number) in numbers.enumerate() {
        write!(to, "{}{number}", if at == 0 { "" } else { ", " })?;
    }
    to.write_all(b"]\n")
}

/// Names of objects beside each other, of letters, digits and underscores.
#[derive(Default)]
struct Names(BTreeSet<String>);

impl Names {
    /// A name for an object, like its own and unlike the others.
    fn of(&mut self, name: &str) -> String {
        let mut plain: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
        if !plain.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') {
            plain.insert(0, '_');
        }
        let numbered = (1..).map(|number| if number == 1 { plain.clone() } else { format!("{plain}_{number}") });
        let free = numbered.into_iter().find(|name| !self.0.contains(name)).expect("a free number");
        self.0.insert(free.clone());
        free
    }
}

/// A text in quotation marks. Names have no control characters.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_plain_and_unlike() {
        let mut names = Names::default();
        let made = ["ball", "a b", "a-b", "2", "Würfel", "a_b_2"].map(|name| names.of(name));
        assert_eq!(made, ["ball", "a_b", "a_b_2", "_2", "W_rfel", "a_b_2_2"]);
        assert_eq!(quoted("a\"b\\c"), "\"a\\\"b\\\\c\"");
    }
}
