//! What is said of two pictures: whether physics or drawing moved.

use super::picture::Pixels;
use crate::output::Tags;
use serde::Serialize;
use std::fmt;

/// Pixels differ visibly if a channel differs by more than this: drivers round in their own ways.
const CHANNEL: u8 = 2;
/// Pictures of different machines may differ visibly in this part of their pixels, and in so many in any
/// case: sample places along silhouettes, not more.
const PART: f64 = 1e-4;
const AT_LEAST: u64 = 8;

/// How far two pictures of one size are apart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Distance {
    /// Pixels that are not equal.
    pub unequal: u64,
    /// Pixels of which a channel differs by more than 2 of 255.
    pub visible: u64,
    /// The largest difference of a channel, of 255.
    pub largest: u8,
    /// How many visible ones are allowed: none between pictures of one machine, where not even unequal ones are.
    pub allowed: u64,
}

/// Whether two pictures show the same.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "verdict", rename_all = "kebab-case")]
pub enum Verdict {
    /// Every pixel is equal, and so are the states.
    Identical,
    /// The simulation gave the same; pixels differ no more than machines do.
    WithinTolerance(Distance),
    /// The simulation gave the same, but the picture is another one.
    DrawnDifferently {
        /// How far apart they are; `None` if their sizes or channels are not alike.
        distance: Option<Distance>,
    },
    /// The simulation gave other positions or velocities.
    StateMoved {
        /// The runs whose states differ.
        runs: Vec<String>,
    },
    /// There is nothing to compare with what was expected.
    Missing,
    /// Nothing like it was expected.
    Extra,
    /// At least one of the pictures does not say what it shows, so that only pixels could be compared.
    NoState {
        /// How far apart they are; `None` if their sizes or channels are not alike.
        distance: Option<Distance>,
    },
    /// One of the files is no picture that can be compared.
    Unreadable {
        /// Why.
        message: String,
    },
}

impl Verdict {
    /// The verdict on an actual picture beside the expected one.
    pub fn new(expected: &Pixels, actual: &Pixels) -> Self {
        let is_alike = expected.size == actual.size && expected.channels == actual.channels;
        let distance = is_alike.then(|| Distance::new(expected, actual));
        let Some((before, after)) = expected.tags.as_ref().zip(actual.tags.as_ref()) else {
            return Self::NoState { distance };
        };
        let runs = moved(before, after);
        match distance {
            _ if !runs.is_empty() => Self::StateMoved { runs },
            Some(Distance { unequal: 0, .. }) => Self::Identical,
            Some(distance) if distance.is_allowed() => Self::WithinTolerance(distance),
            distance => Self::DrawnDifferently { distance },
        }
    }

    /// Whether nothing is wrong.
    pub fn passes(&self) -> bool {
        match self {
            Self::Identical | Self::WithinTolerance(_) => true,
            Self::NoState { distance } => distance.is_some_and(|distance| distance.is_allowed()),
            Self::DrawnDifferently { .. }
            | Self::StateMoved { .. }
            | Self::Missing
            | Self::Extra
            | Self::Unreadable { .. } => false,
        }
    }
}

/// The names of the runs that differ, or are in one of the pictures only.
fn moved(before: &Tags, after: &Tags) -> Vec<String> {
    let absent = |states: &[(String, String)], state: &(String, String)| !states.contains(state);
    let gone = before.states.iter().filter(|state| absent(&after.states, state));
    let come = after.states.iter().filter(|state| absent(&before.states, state));
    let mut runs: Vec<String> = gone.chain(come).map(|(_, run)| run.clone()).collect();
    runs.sort();
    runs.dedup();
    runs
}

impl Distance {
    /// That of two pictures of one size and as many channels.
    fn new(expected: &Pixels, actual: &Pixels) -> Self {
        let adapter = |pixels: &Pixels| pixels.tags.as_ref().map(|tags| tags.adapter.clone());
        let one_machine = adapter(expected).is_some() && adapter(expected) == adapter(actual);
        let all = u64::from(expected.size[0]) * u64::from(expected.size[1]);
        let allowed = if one_machine { 0 } else { AT_LEAST.max((PART * all as f64) as u64) };
        let mut distance = Self { allowed, ..Self::default() };
        if expected.bytes == actual.bytes {
            return distance;
        }
        let channels = expected.channels;
        for (one, other) in expected.bytes.chunks_exact(channels).zip(actual.bytes.chunks_exact(channels)) {
            if one != other {
                let largest = one.iter().zip(other).map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0);
                distance.unequal += 1;
                distance.visible += u64::from(largest > CHANNEL);
                distance.largest = distance.largest.max(largest);
            }
        }
        distance
    }

    /// Whether it is no more than machines differ.
    pub fn is_allowed(self) -> bool {
        if self.allowed == 0 { self.unequal == 0 } else { self.visible <= self.allowed }
    }
}

impl fmt::Display for Distance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { unequal, visible, largest, allowed } = self;
        if *allowed == 0 {
            write!(f, "{unequal} pixels differ, by up to {largest} of 255; none may, for one machine drew both")
        } else {
            write!(f, "{visible} pixels differ by more than {CHANNEL} of 255, up to {largest}; {allowed} may")
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const SHAPE: &str = "width, height or opacities are not alike";
        let told = |distance: &Option<Distance>| distance.map_or(SHAPE.to_owned(), |distance| distance.to_string());
        match self {
            Self::Identical => f.write_str("identical"),
            Self::WithinTolerance(distance) => write!(f, "same state, pixels within tolerance: {distance}"),
            Self::DrawnDifferently { distance } => write!(f, "same state, drawn differently: {}", told(distance)),
            Self::StateMoved { runs } => write!(f, "state moved: {}", runs.join(", ")),
            Self::Missing => f.write_str("missing"),
            Self::Extra => f.write_str("extra"),
            Self::NoState { distance } => write!(f, "no state recorded (pixels only): {}", told(distance)),
            Self::Unreadable { message } => write!(f, "unreadable: {message}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixels(adapter: &str, state: &str, change: impl FnOnce(&mut [u8])) -> Pixels {
        let mut bytes = vec![100; 40 * 30 * 3];
        change(&mut bytes);
        let tags = Tags {
            scene: "s".into(),
            states: vec![("0".into(), "other".into()), (state.into(), "run".into())],
            frame: 3,
            time: 0.05,
            version: "0".into(),
            adapter: adapter.into(),
        };
        Pixels { size: [40, 30], channels: 3, bytes, tags: Some(tags) }
    }

    #[test]
    fn each_verdict_from_a_constructed_pair() {
        let golden = pixels("one", "1", |_| ());
        let of = |actual: &Pixels| Verdict::new(&golden, actual);
        let same = of(&golden);
        assert_eq!((&same, same.passes(), same.to_string().as_str()), (&Verdict::Identical, true, "identical"));
        // One machine draws the same bytes; another one rounds as it likes, at a few pixels more than that.
        let hardly = |bytes: &mut [u8]| bytes[0] += 1;
        assert!(!of(&pixels("one", "1", hardly)).passes());
        let other = of(&pixels("two", "1", hardly));
        assert!(matches!(other, Verdict::WithinTolerance(Distance { unequal: 1, visible: 0, largest: 1, allowed: 8 })));
        assert!(other.passes() && other.to_string().starts_with("same state, pixels within tolerance: 0 pixels"));
        let few = |count: usize| pixels("two", "1", move |bytes| (0..count).for_each(|at| bytes[30 * at] = 0));
        assert!(of(&few(8)).passes() && !of(&few(9)).passes());
        assert!(of(&few(9)).to_string().starts_with("same state, drawn differently: 9 pixels"));
        // Physics comes before drawing, also where no pixel tells.
        let moved = of(&pixels("one", "2", |_| ()));
        assert_eq!(moved, Verdict::StateMoved { runs: vec!["run".into()] });
        assert!(!moved.passes() && !of(&pixels("two", "2", |bytes| bytes.fill(0))).passes());
        // Without a state pixels alone are compared.
        let untold = Pixels { tags: None, ..golden.clone() };
        assert!(of(&untold).passes() && of(&untold).to_string().starts_with("no state recorded (pixels only)"));
        let wide = Pixels { size: [30, 40], ..golden.clone() };
        assert_eq!(of(&wide), Verdict::DrawnDifferently { distance: None });
    }
}
