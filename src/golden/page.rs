//! The report page of a comparison.

use super::distance::{CHANNEL, differences};
use super::picture::Pixels;
use super::report::{FAINT, INTERIOR, PicturePair, Report, SILHOUETTE};
use super::side::Kind;
use super::silhouettes::{Location, silhouettes};
use super::{Compared, Comparison, Verdict};
use crate::output::{Compression, encode};
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Number of frames whose pictures are in a page; failed ones come first.
const MOST_FAILED: usize = 40;
const MOST_PASSED: usize = 8;

impl Comparison {
    /// The contents of its page. Of long sequences the page has the pictures of some frames.
    pub(crate) fn report(&self) -> Report {
        let [expected, actual] = &self.sides;
        let shown = self.shown();
        let first = self.worst().unwrap_or(0);
        let pairs: Vec<(PicturePair, [Option<String>; 2])> =
            self.pictures.par_iter().enumerate().map(|(at, picture)| self.pair(picture, shown.contains(&at))).collect();
        let adapters = [0, 1].map(|side| pairs.iter().find_map(|(_, adapters)| adapters[side].clone()));
        let mut findings: Vec<String> = self.moved.iter().map(ToString::to_string).collect();
        if expected.kind == Kind::Absent {
            findings.push("There is no golden yet.".to_owned());
        }
        if !self.pictures.is_empty() {
            findings.push(format!("{}.", self.failures().unwrap_or_else(|| self.pass())));
        }
        if self.same_scene == Some(false) {
            findings.push("The scene files are not the same.".to_owned());
        }
        findings.extend(self.notes.iter().cloned());
        if shown.len() < self.pictures.len() {
            findings.push(format!(
                "This page holds the pictures of {} of {} frames.",
                shown.len(),
                self.pictures.len()
            ));
        }
        let title = match actual.kind {
            Kind::Drawn => actual.origin.file_stem(),
            _ => expected.origin.file_name(),
        };
        Report {
            title: title.map_or_else(|| "comparison".to_owned(), |name| name.to_string_lossy().into_owned()),
            expected: expected.origin.display().to_string(),
            actual: actual.origin.display().to_string(),
            passes: self.passes(),
            verdict: self.verdict().to_owned(),
            findings,
            accept: self.command_to_accept(),
            drawn_by: adapters,
            runs: self.differences.clone(),
            first,
            pictures: pairs.into_iter().map(|(pair, _)| pair).collect(),
        }
    }

    /// The pictures on the page: failures and a few others, evenly spaced if there are too many.
    fn shown(&self) -> BTreeSet<usize> {
        let chosen = |passes: bool, most: usize| -> Vec<usize> {
            let all = self.pictures.iter().enumerate().filter(|(_, picture)| picture.verdict.passes() == passes);
            let all: Vec<usize> = all.map(|(at, _)| at).collect();
            if all.len() <= most {
                return all;
            }
            (0..most).map(|at| all[at * (all.len() - 1) / (most - 1)]).collect()
        };
        chosen(false, MOST_FAILED).into_iter().chain(chosen(true, MOST_PASSED)).chain(self.worst()).collect()
    }

    /// The picture that failed with the largest displacement of a node at its frame, or else with most pixels that differ.
    fn worst(&self) -> Option<usize> {
        let failed = self.pictures.iter().enumerate().filter(|(_, picture)| !picture.verdict.passes());
        let how_bad = |picture: &Compared| {
            let moments = self.differences.iter().flat_map(|run| &run.moments);
            let here = moments.filter(|moment| picture.frame == Some(moment.frame));
            let distances = here.filter_map(|moment| Some(moment.displacement?.distance));
            let pixels = picture.verdict.distance().map_or(0, |distance| distance.nearest_to_limit().visible);
            (distances.fold(0.0, f64::max), pixels)
        };
        let worse = |one: (usize, (f64, u64)), other: (usize, (f64, u64))| if other.1 > one.1 { other } else { one };
        failed.map(|(at, picture)| (at, how_bad(picture))).reduce(worse).map(|(at, _)| at)
    }

    /// A picture on the page, and the adapters that drew both sides.
    fn pair(&self, picture: &Compared, is_shown: bool) -> (PicturePair, [Option<String>; 2]) {
        let source = |at: usize| self.sides[at].source(&picture.name);
        // Files that are not pictures are not shown.
        let pixels = [0, 1].map(|at| source(at).filter(|_| is_shown).and_then(|source| source.pixels().ok()));
        let bytes = [0, 1].map(|at| pixels[at].as_ref().and_then(|_| Some(source(at)?.bytes().ok()?.into_owned())));
        let label = |at: usize| pixels[at].as_ref().and_then(|pixels| pixels.label.as_ref());
        let frame = picture.frame.or_else(|| [1, 0].into_iter().find_map(|at| label(at)?.frame()));
        let time = frame.and_then(|frame| {
            let moments = self.differences.iter().flat_map(|run| &run.moments);
            moments.filter(|moment| moment.frame == frame).find_map(|moment| moment.time)
        });
        let difference = match &pixels {
            [Some(expected), Some(actual)] => difference(expected, actual),
            _ => None,
        };
        let size = pixels.iter().rev().flatten().next().map(|pixels| pixels.size);
        let nearest = picture.verdict.distance().map(|distance| distance.nearest_to_limit());
        let adapters = [0, 1].map(|at| label(at).map(|label| label.adapter.clone()));
        let [expected, actual] = bytes;
        let is_identical = picture.verdict == Verdict::Identical;
        let pair = PicturePair {
            name: picture.name.clone(),
            frame,
            time,
            verdict: picture.verdict.kind().to_owned(),
            words: picture.verdict.to_string(),
            passes: picture.verdict.passes(),
            visible: nearest.map(|count| count.visible).or(is_identical.then_some(0)),
            allowed: nearest.map(|count| count.allowed),
            size,
            expected,
            actual,
            difference,
            distances: self.sides[1].distances.get(&picture.name).filter(|_| is_shown).cloned(),
        };
        (pair, adapters)
    }
}

/// The differences of two pictures over a faint copy of the expected one, as a PNG file; `None` if their sizes or channels
/// differ.
fn difference(expected: &Pixels, actual: &Pixels) -> Option<Vec<u8>> {
    if expected.size != actual.size || expected.channels != actual.channels {
        return None;
    }
    let faint = |pixel: &[u8]| {
        let [red, green, blue] = [0, 1, 2].map(|at| u32::from(pixel[at]));
        // Transparent pixels on white; a quarter of the luminance.
        let grey = (red * 54 + green * 183 + blue * 19) / 256;
        let opacity = pixel.get(3).map_or(255, |&opacity| u32::from(opacity));
        let grey = 255 - (255 - grey) * opacity / 255;
        [(255 - (255 - grey) / 5) as u8; 3]
    };
    let mut bytes: Vec<u8> = expected.bytes.chunks_exact(expected.channels).flat_map(faint).collect();
    if expected.bytes != actual.bytes {
        let mask = silhouettes([expected, actual]);
        differences(expected, actual, |at, difference| {
            let colour = match mask[at] {
                _ if difference <= CHANNEL => FAINT,
                Location::Silhouette | Location::Beside => SILHOUETTE,
                Location::OneSided | Location::Interior => INTERIOR,
            };
            bytes[3 * at..3 * at + 3].copy_from_slice(&colour);
        });
    }
    Some(encode(expected.size, &bytes, &[], Compression::High))
}
