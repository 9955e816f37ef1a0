//! Verdicts on two pictures: whether the simulation or the drawing changed.

use super::distance::Distance;
use super::picture::Pixels;
use super::states::Displacement;
use crate::output::Tags;
use serde::Serialize;
use std::fmt;

/// The verdict on two pictures.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "verdict")]
pub(crate) enum Verdict {
    /// All pixels and states are equal.
    #[serde(rename = "identical")]
    Identical,
    /// The states are equal; pixels differ within the tolerance for different machines.
    #[serde(rename = "same state, pixels within tolerance")]
    WithinTolerance(Distance),
    /// The states are equal; pixels differ by more than the tolerance.
    #[serde(rename = "same state, drawn differently")]
    DrawnDifferently {
        /// How far apart they are; `None` if their sizes or channels are not alike.
        distance: Option<Distance>,
        /// Width and height of both (px).
        sizes: [[u32; 2]; 2],
    },
    /// Positions or velocities differ.
    #[serde(rename = "state moved")]
    StateMoved {
        /// The runs whose states differ.
        runs: Vec<MovedHere>,
        /// How far apart the pictures are; `None` if their sizes or channels are not alike.
        distance: Option<Distance>,
    },
    /// The actual picture does not exist.
    #[serde(rename = "missing")]
    Missing,
    /// The expected picture does not exist.
    #[serde(rename = "extra")]
    Extra,
    /// One of the pictures records no state, so only pixels could be compared.
    #[serde(rename = "no state recorded")]
    NoState {
        /// How far apart they are; `None` if their sizes or channels are not alike.
        distance: Option<Distance>,
        /// Width and height of both (px).
        sizes: [[u32; 2]; 2],
    },
    /// One of the files cannot be compared as a picture.
    #[serde(rename = "unreadable")]
    Unreadable {
        /// The file and the reason.
        message: String,
    },
}

/// A run whose state in a picture is not as expected.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct MovedHere {
    /// Name of the run.
    pub run: String,
    /// The largest displacement of a node, if known.
    pub displacement: Option<Displacement>,
}

impl Verdict {
    /// The verdict on an actual picture beside the expected one.
    pub(super) fn new(expected: &Pixels, actual: &Pixels) -> Self {
        let (distance, sizes) = (Distance::new(expected, actual), [expected.size, actual.size]);
        let (Some(before), Some(after)) = (&expected.label, &actual.label) else {
            return Self::NoState { distance, sizes };
        };
        let runs = moved(before, after);
        match distance {
            _ if !runs.is_empty() => Self::StateMoved { runs, distance },
            Some(Distance { unequal: 0, .. }) => Self::Identical,
            Some(distance) if distance.is_allowed() => Self::WithinTolerance(distance),
            distance => Self::DrawnDifferently { distance, sizes },
        }
    }

    /// Whether the picture passes.
    pub(crate) fn passes(&self) -> bool {
        match self {
            Self::Identical | Self::WithinTolerance(_) => true,
            Self::NoState { distance, .. } => distance.is_some_and(|distance| distance.is_allowed()),
            _ => false,
        }
    }

    /// The verdict without details.
    pub(crate) fn kind(&self) -> &'static str {
        match self {
            Self::Identical => "identical",
            Self::WithinTolerance(_) => "same state, pixels within tolerance",
            Self::DrawnDifferently { .. } => "same state, drawn differently",
            Self::StateMoved { .. } => "state moved",
            Self::Missing => "missing",
            Self::Extra => "extra",
            Self::NoState { .. } => "no state recorded",
            Self::Unreadable { .. } => "unreadable",
        }
    }

    /// The distance of the pictures, if they could be compared.
    pub(crate) fn distance(&self) -> Option<&Distance> {
        match self {
            Self::WithinTolerance(distance) => Some(distance),
            Self::DrawnDifferently { distance, .. }
            | Self::StateMoved { distance, .. }
            | Self::NoState { distance, .. } => distance.as_ref(),
            Self::Identical | Self::Missing | Self::Extra | Self::Unreadable { .. } => None,
        }
    }
}

/// The runs that differ, or are in one of the pictures only.
fn moved(before: &Tags, after: &Tags) -> Vec<MovedHere> {
    let absent = |from: &Tags, state: &(String, String)| !from.states.contains(state);
    let gone = before.states.iter().filter(|state| absent(after, state));
    let come = after.states.iter().filter(|state| absent(before, state));
    let mut runs: Vec<String> = Vec::new();
    for (_, run) in gone.chain(come) {
        if !runs.contains(run) {
            runs.push(run.clone());
        }
    }
    runs.into_iter().map(|run| MovedHere { run, displacement: None }).collect()
}

impl fmt::Display for MovedHere {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.displacement {
            Some(displacement) => write!(f, "{}, {}", self.run, displacement.words("")),
            None => f.write_str(&self.run),
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.kind())?;
        let unlike = |[[a, b], [c, d]]: &[[u32; 2]; 2]| match [a, b] == [c, d] {
            true => "one of them has opacities, the other one has none".to_owned(),
            false => format!("{c}×{d} pixels instead of {a}×{b}"),
        };
        match self {
            Self::Identical | Self::Missing | Self::Extra => Ok(()),
            Self::WithinTolerance(distance) | Self::DrawnDifferently { distance: Some(distance), .. } => {
                write!(f, ": {distance}")
            }
            Self::DrawnDifferently { distance: None, sizes } => write!(f, ": {}", unlike(sizes)),
            Self::StateMoved { runs, .. } => {
                let runs: Vec<_> = runs.iter().map(MovedHere::to_string).collect();
                write!(f, ": {}", runs.join("; "))
            }
            Self::NoState { distance: Some(Distance { unequal: 0, .. }), .. } => f.write_str(" (the pixels are equal)"),
            Self::NoState { distance: Some(distance), .. } => write!(f, " (pixels only): {distance}"),
            Self::NoState { distance: None, sizes } => write!(f, " (pixels only): {}", unlike(sizes)),
            Self::Unreadable { message } => write!(f, ": {message}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::Shown;

    fn pixels(adapter: &str, state: &str, change: impl FnOnce(&mut [u8])) -> Pixels {
        let mut bytes = vec![100; 40 * 30 * 3];
        change(&mut bytes);
        let tags = Tags {
            shows: Shown::Frame { frame: 3, time: 0.05 },
            scenes: vec!["s".into()],
            states: vec![("0".into(), "other".into()), (state.into(), "run".into())],
            version: "0".into(),
            adapter: adapter.into(),
        };
        Pixels { size: [40, 30], channels: 3, bytes, label: Some(tags) }
    }

    #[test]
    fn each_verdict_from_a_constructed_pair() {
        let golden = pixels("soft (1)", "1", |_| ());
        let of = |actual: &Pixels| Verdict::new(&golden, actual);
        let same = of(&golden);
        assert_eq!((&same, same.passes(), same.to_string().as_str()), (&Verdict::Identical, true, "identical"));
        // One machine draws the same bytes; another one rounds as it likes, at a few pixels more than that.
        let hardly = |bytes: &mut [u8]| bytes[0] += 1;
        let alone = of(&pixels("soft (1)", "1", hardly));
        assert_eq!(
            (alone.passes(), alone.to_string().as_str()),
            (
                false,
                "same state, drawn differently: 1 pixel differs, by up to 1 of 255; none may, because one machine drew both"
            )
        );
        let other = of(&pixels("soft (2)", "1", hardly));
        assert!(other.passes() && matches!(other, Verdict::WithinTolerance(_)));
        let words = "same state, pixels within tolerance: 0 pixels differ by more than 2 of 255 (8 may), by up to 1";
        assert_eq!(other.to_string(), words);
        let few = |count: usize| pixels("soft (2)", "1", move |bytes| (0..count).for_each(|at| bytes[30 * at] = 0));
        assert!(of(&few(8)).passes() && !of(&few(9)).passes());
        assert!(
            of(&few(9))
                .to_string()
                .starts_with("same state, drawn differently: 9 pixels differ by more than 2 of 255 (8 may), ")
        );
        // Physics comes before drawing, also where no pixel tells.
        let moved = of(&pixels("soft (1)", "2", |_| ()));
        assert_eq!((moved.to_string().as_str(), moved.passes()), ("state moved: run", false));
        assert!(!of(&pixels("hard", "2", |bytes| bytes.fill(0))).passes());
        // A run that only the new picture has, and one that it lacks, are other states, too.
        let mut more = golden.clone();
        let Some(tags) = &mut more.label else { panic!("a frame") };
        tags.states.push(("2".into(), "new run".into()));
        assert_eq!((of(&more).to_string().as_str(), of(&more).passes()), ("state moved: new run", false));
        assert_eq!(Verdict::new(&more, &golden).to_string(), "state moved: new run");
        // Without a state pixels alone are compared.
        let untold = Pixels { label: None, ..golden.clone() };
        assert!(of(&untold).passes() && of(&untold).to_string() == "no state recorded (the pixels are equal)");
        let wide = Pixels { size: [30, 40], ..golden.clone() };
        assert_eq!(of(&wide).to_string(), "same state, drawn differently: 30×40 pixels instead of 40×30");
    }

    #[test]
    fn what_nobody_says_who_drew_passes_only_if_it_is_equal() {
        let golden = pixels("soft (1)", "1", |_| ());
        let untold = Pixels { label: None, ..golden.clone() };
        let of = |actual: &Pixels| Verdict::new(&golden, actual);
        let few_untold = |count: usize| Pixels {
            label: None,
            ..pixels("", "1", move |bytes| (0..count).for_each(|at| bytes[30 * at] = 0))
        };
        assert!(of(&few_untold(8)).passes() && !of(&few_untold(9)).passes());
        // Without recorded adapters there is no tolerance.
        let foreign = |other: &Pixels| Verdict::new(&untold, other);
        assert!(foreign(&untold).passes());
        let hardly = |bytes: &mut [u8]| bytes[0] += 1;
        let by_one = Pixels { label: None, ..pixels("", "1", hardly) };
        let told = "no state recorded (pixels only): 1 pixel differs, by up to 1 of 255; none may, because neither names its adapter";
        assert_eq!((foreign(&by_one).to_string().as_str(), foreign(&by_one).passes()), (told, false));
        assert!(!foreign(&Pixels { size: [30, 40], ..untold.clone() }).passes());
    }

    const LARGE: [usize; 2] = [400, 300];

    /// A large picture with a dark square of 200 × 200 pixels on light ground.
    fn large(adapter: &str, change: impl FnOnce(&mut [u8])) -> Pixels {
        let [width, height] = LARGE;
        let is_dark = |at: usize| (100..300).contains(&(at % width)) && (50..250).contains(&(at / width));
        let mut bytes: Vec<u8> = (0..width * height).flat_map(|at| [if is_dark(at) { 50 } else { 200 }; 3]).collect();
        change(&mut bytes);
        let small = pixels(adapter, "1", |_| ());
        Pixels { size: LARGE.map(|side| side as u32), bytes, ..small }
    }

    /// In large pictures the part of the pixels that may differ is more than the number that may in any case.
    #[test]
    fn the_limits_of_large_pictures_are_parts_of_them() {
        let [width, height] = LARGE;
        let golden = large("soft (1)", |_| ());
        let of = |adapter: &str, change: &dyn Fn(&mut [u8])| Verdict::new(&golden, &large(adapter, change));
        let dots = |value: u8, count: usize| move |bytes: &mut [u8]| (0..count).for_each(|at| bytes[30 * at] = value);
        // A ten-thousandth of them.
        let most = width * height / 10_000;
        assert!(most > 8 && of("soft (2)", &dots(0, most)).passes() && !of("soft (2)", &dots(0, most + 1)).passes());
        assert!(of("soft (2)", &dots(0, most)).to_string().contains(" (12 may)"));
        // One machine draws the same, however many pixels there are.
        assert!(!of("soft (1)", &dots(201, 1)).passes());
        // Between kinds a thousandth of what lies between silhouettes, here the square's border on its two sides.
        let silhouettes = 796 + 804;
        let most = (width * height - silhouettes) / 1000;
        assert!(most > 100 && of("hard (1)", &dots(204, most)).passes(), "{}", of("hard (1)", &dots(204, most)));
        assert!(!of("hard (1)", &dots(204, most + 1)).passes());
        let told = of("hard (1)", &dots(204, most + 1)).to_string();
        assert!(
            told.contains(&format!("between them {} pixels differ ({most} may), by up to 4 (8 at most)", most + 1)),
            "{told}"
        );
        // Of what stands in one picture only not more than in small ones.
        assert!(of("hard (1)", &dots(120, 8)).passes() && !of("hard (1)", &dots(120, 9)).passes());
        // A quarter of the silhouettes.
        let most = silhouettes / 4;
        let border = |count: usize| {
            move |bytes: &mut [u8]| {
                let on_border =
                    (0..200).flat_map(|at| [[100 + at, 50], [100 + at, 249], [100, 50 + at], [299, 50 + at]]);
                let mut places: Vec<_> = on_border.map(|[x, y]| 3 * (y * width + x)).collect();
                places.sort_unstable();
                places.dedup();
                places.into_iter().take(count).for_each(|at| bytes[at] = 53);
            }
        };
        assert!(of("hard (1)", &border(most)).passes(), "{}", of("hard (1)", &border(most)));
        assert!(!of("hard (1)", &border(most + 1)).passes());
    }

    /// A soft spot is no silhouette, and too few pixels to count: by its strength alone it is seen.
    #[test]
    fn between_silhouettes_nothing_differs_by_much_however_few_pixels_do() {
        let golden = large("soft (1)", |_| ());
        let spot = |top: usize, by: u8| {
            let [width, _] = LARGE;
            let slope = |bytes: &mut [u8]| {
                for (x, y) in (10..50).flat_map(|x| (10..40).map(move |y| (x, y))) {
                    let away = 30_usize.abs_diff(x).max(25_usize.abs_diff(y));
                    bytes[3 * (y * width + x) + 1] -= top.saturating_sub(usize::from(by) * away) as u8;
                }
            };
            Verdict::new(&golden, &large("hard (1)", slope))
        };
        let (faint, strong) = (spot(8, 4), spot(9, 4));
        for (verdict, largest, passes) in [(&faint, 8, true), (&strong, 9, false)] {
            let interiors = verdict.distance().unwrap().interiors.unwrap();
            assert!(interiors.visible < interiors.allowed && interiors.largest == largest, "{verdict}");
            assert_eq!(
                (verdict.distance().unwrap().one_sided.unwrap().visible, verdict.passes()),
                (0, passes),
                "{verdict}"
            );
        }
        assert!(
            strong
                .to_string()
                .starts_with("same state, drawn differently: another kind of adapter drew it; between them"),
            "{strong}"
        );
    }

    #[test]
    fn another_kind_of_adapter_is_judged_by_silhouettes_and_interiors() {
        // A dark square on light ground: 12 × 12 pixels, so 4 × 12 along its border on either side.
        let square = |bytes: &mut [u8], shift: usize, ground: u8, inside: u8| {
            bytes.fill(ground);
            for at in (0..144).map(|at| (10 + at / 12) * 40 + 10 + shift + at % 12) {
                bytes[3 * at..3 * at + 3].fill(inside);
            }
        };
        let golden = pixels("soft (1)", "1", |bytes| square(bytes, 0, 200, 50));
        let hard = |change: &dyn Fn(&mut [u8])| {
            Verdict::new(
                &golden,
                &pixels("hard (1)", "1", |bytes| {
                    square(bytes, 0, 200, 50);
                    change(bytes);
                }),
            )
        };
        let border = |count: usize| move |bytes: &mut [u8]| (0..count).for_each(|at| bytes[3 * (410 + at)] = 120);
        // A quarter of the pixels along the border: 29 of them. Its outermost ring has 44.
        assert!(hard(&border(12)).passes(), "{}", hard(&border(12)));
        let ring = hard(&|bytes| {
            let on_ring = |at: &usize| [0, 11].contains(&(at / 12)) || [0, 11].contains(&(at % 12));
            (0..144).filter(on_ring).for_each(|at| bytes[3 * ((10 + at / 12) * 40 + 10 + at % 12)] = 120);
        });
        assert!(!ring.passes(), "{ring}");
        // Between silhouettes little may differ, and nothing by much.
        let faint = |count: usize| move |bytes: &mut [u8]| (0..count).for_each(|at| bytes[3 * at] = 204);
        assert!(hard(&faint(8)).passes() && !hard(&faint(9)).passes(), "{}", hard(&faint(8)));
        assert!(
            hard(&faint(9)).to_string().contains("; between them 9 pixels differ (8 may), by up to 4 (8 at most); ")
        );
        // Hardly anything may be there that the other picture does not have, be it so small that no other limit sees it.
        let line = |count: usize| move |bytes: &mut [u8]| (0..count).for_each(|at| bytes[3 * (81 + at)] = 120);
        assert!(hard(&line(8)).passes() && !hard(&line(9)).passes(), "{}", hard(&line(9)));
        let told = "another kind of adapter drew it; in objects of one picture only, 9 pixels differ (8 may); along";
        assert!(hard(&line(9)).to_string().contains(told), "{}", hard(&line(9)));
        // Where silhouettes of both go on, a driver may see one more.
        let beside = hard(&|bytes| (0..9).for_each(|at| bytes[3 * (8 * 40 + 11 + at)] = 120));
        assert!(beside.distance().unwrap().one_sided.unwrap().visible == 0, "{beside}");
        // The whole square paler, its border as it was: nothing that a limit on all pixels would see at once.
        let paler = hard(&|bytes| (0..16).for_each(|at| bytes[3 * ((14 + at / 4) * 40 + 14 + at % 4)] = 56));
        assert!(!paler.passes(), "{paler}");
    }
}
