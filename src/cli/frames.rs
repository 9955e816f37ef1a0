//! The options `--frames`, `--at` and `--shard`: which frames are requested.

use crate::reading::words::short;
use std::str::FromStr;

/// Frames as typed: `5`, `0-119`, every third of them as `0-119x3`, or several of these as `5,9,40-60`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct FrameRanges(Vec<Span>);

/// `--at`: moments (s), such as `2s`, `500ms` or `2`, or several of these as `0.5,1`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Instants(Vec<f64>);

impl FromStr for Instants {
    type Err = String;

    fn from_str(typed: &str) -> Result<Self, String> {
        let moment = |part: &str| {
            let (number, unit) = match part.strip_suffix("ms") {
                Some(number) => (number, 1e-3),
                None => (part.strip_suffix('s').unwrap_or(part), 1.0),
            };
            let seconds = number.trim().parse::<f64>().ok().map(|number| number * unit);
            let seconds = seconds.filter(|seconds| seconds.is_finite() && *seconds >= 0.0);
            seconds.ok_or_else(|| format!("`{part}` is not a time; expected one such as 2s, 500ms or 2"))
        };
        typed.split(',').map(|part| moment(part.trim())).collect::<Result<_, _>>().map(Self)
    }
}

impl Instants {
    /// The nearest frame to each moment, of a scene of a duration (s) that ends with frame `last`, at a rate (1/s).
    pub(super) fn nearest(&self, last: u64, duration: f64, rate: f64) -> Result<Vec<(f64, u64)>, String> {
        let nearest = |&time: &f64| {
            let (frame, last_frame) = ((time * rate).round(), last as f64);
            // A moment after the last frame has that frame up to half a frame later, and in the duration.
            let is_there = frame <= last_frame || time <= duration;
            is_there.then_some((time, frame.min(last_frame) as u64)).ok_or_else(|| {
                format!("there is no frame at {} s; the last one is at {} s", short(time), short(last as f64 / rate))
            })
        };
        self.0.iter().map(nearest).collect()
    }
}

/// From `first` to `last`, ends included, in steps of `stride` ≥ 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Span {
    first: u64,
    last: u64,
    stride: u64,
}

/// The most frames of one command: more are a typing error, and their list alone would take a while.
const MOST_FRAMES: u64 = 10_000_000;

impl FrameRanges {
    pub(super) fn all(last: u64) -> Self {
        Self(vec![Span { first: 0, last, stride: 1 }])
    }

    /// The frames in rising order, each once, of a scene that ends with frame `last`.
    pub(super) fn select(&self, last: u64) -> Result<Vec<u64>, String> {
        if let Some(beyond) = self.0.iter().map(|span| span.last).find(|&frame| frame > last) {
            return Err(format!("there is no frame {beyond}; the last one is {last}"));
        }
        let count = |span: &Span| (span.last - span.first) / span.stride;
        let count = self.0.iter().map(count).fold(self.0.len() as u64, u64::saturating_add);
        if count > MOST_FRAMES {
            return Err(format!("{count} frames are too many; expected at most {MOST_FRAMES} in one command"));
        }
        let numbers =
            |span: &Span| (span.first..=span.last).step_by(usize::try_from(span.stride).unwrap_or(usize::MAX));
        let mut frames: Vec<u64> = self.0.iter().flat_map(numbers).collect();
        frames.sort_unstable();
        frames.dedup();
        Ok(frames)
    }
}

impl FromStr for FrameRanges {
    type Err = String;

    fn from_str(typed: &str) -> Result<Self, String> {
        typed.split(',').map(|part| span(part.trim())).collect::<Result<_, _>>().map(Self)
    }
}

/// One of several equal shares of the frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Shard {
    /// Counted from 1.
    number: usize,
    /// How many there are.
    of: usize,
}

impl Shard {
    /// The shard's share of some frames: `2/4` has the second frame and every fourth one after it.
    pub(super) fn select(self, frames: &[u64]) -> Result<Vec<u64>, String> {
        let share: Vec<_> = frames.iter().copied().skip(self.number - 1).step_by(self.of).collect();
        if share.is_empty() {
            let (number, of, count) = (self.number, self.of, frames.len());
            return Err(format!("shard {number}/{of} of {count} frames is empty; expected at most {count} shards"));
        }
        Ok(share)
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(typed: &str) -> Result<Self, String> {
        let numbers = typed
            .split_once('/')
            .and_then(|(number, of)| Some([number.trim().parse::<usize>().ok()?, of.trim().parse().ok()?]));
        let [number, of] = numbers.ok_or("expected the number of a shard and how many there are, such as 2/4")?;
        if of == 0 || !(1..=of).contains(&number) {
            let first = if of == 0 { "1/1".to_owned() } else { format!("1/{of} to {of}/{of}") };
            return Err(format!("there is no shard {number} of {of}; expected {first}"));
        }
        Ok(Self { number, of })
    }
}

fn span(part: &str) -> Result<Span, String> {
    let number = |digits: &str| -> Result<u64, String> {
        digits.trim().parse().map_err(|_| {
            format!("`{part}` is not a frame; expected a number or a range, such as 0-119, 0-119x3 or 5,9,40-60")
        })
    };
    let Some((first, rest)) = part.split_once('-') else {
        let frame = number(part)?;
        return Ok(Span { first: frame, last: frame, stride: 1 });
    };
    let (last, stride) = match rest.split_once(['x', '×']) {
        Some((last, stride)) => (last, number(stride)?),
        None => (rest, 1),
    };
    let span = Span { first: number(first)?, last: number(last)?, stride };
    if span.stride == 0 {
        return Err(format!("`{part}` has a stride of 0; expected at least 1 after x"));
    }
    if span.first > span.last {
        return Err(format!("`{part}` runs backwards; did you mean {}-{}?", span.last, span.first));
    }
    Ok(span)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frames(typed: &str) -> Vec<u64> {
        typed.parse::<FrameRanges>().unwrap().select(180).unwrap()
    }

    #[test]
    fn ends_are_included() {
        assert_eq!(frames("0-3"), [0, 1, 2, 3]);
        assert_eq!(frames("0-9x3"), [0, 3, 6, 9]);
        assert_eq!(frames("1-9x3"), [1, 4, 7]);
        assert_eq!(frames("9, 5 ,7-9"), [5, 7, 8, 9]);
        assert_eq!(frames("180"), [180]);
    }

    #[test]
    fn shards_share_out_all_frames() {
        let frames = frames("0-180x7");
        for of in 1..=frames.len() {
            let share = |number: usize| Shard { number, of }.select(&frames).unwrap();
            let mut all: Vec<_> = (1..=of).flat_map(share).collect();
            let sizes: Vec<_> = (1..=of).map(|number| share(number).len()).collect();
            assert!(sizes.iter().max().unwrap() - sizes.iter().min().unwrap() <= 1, "{sizes:?}");
            all.sort_unstable();
            assert_eq!(all, frames);
        }
        assert_eq!("2/4".parse::<Shard>().unwrap().select(&[3, 5, 8, 9, 10, 12]), Ok(vec![5, 12]));
        let error = "3/3".parse::<Shard>().unwrap().select(&[3, 5]).unwrap_err();
        assert_eq!(error, "shard 3/3 of 2 frames is empty; expected at most 2 shards");
        for (typed, message) in [
            ("0/4", "there is no shard 0 of 4; expected 1/4 to 4/4"),
            ("5/4", "there is no shard 5 of 4; expected 1/4 to 4/4"),
            ("1/0", "there is no shard 1 of 0; expected 1/1"),
            ("2", "such as 2/4"),
            ("-1/4", "such as 2/4"),
            ("1/4/2", "such as 2/4"),
        ] {
            let error = typed.parse::<Shard>().unwrap_err();
            assert!(error.contains(message), "{typed}: {error}");
        }
    }

    #[test]
    fn moments_have_the_nearest_frames() {
        let nearest = |typed: &str| typed.parse::<Instants>().and_then(|moments| moments.nearest(180, 3.0, 60.0));
        let frames = |typed: &str| nearest(typed).unwrap().into_iter().map(|(_, frame)| frame).collect::<Vec<_>>();
        assert_eq!(frames("2s"), [120]);
        assert_eq!(frames("2, 500ms,0.51 s,0"), [120, 30, 31, 0]);
        assert_eq!(frames("3.008"), [180]);
        assert_eq!(nearest("9s").unwrap_err(), "there is no frame at 9 s; the last one is at 3 s");
        // The last frame at 29.97 a second is at 0.9676 s.
        let late = |time: f64| Instants(vec![time]).nearest(29, 1.0, 29.97).map(|found| found[0].1);
        assert_eq!([late(0.99), late(1.0)], [Ok(29), Ok(29)]);
        assert_eq!(late(1.1).unwrap_err(), "there is no frame at 1.1 s; the last one is at 0.9676 s");
        for typed in ["", "s", "2m", "-1", "nan", "1s2", "1,,2"] {
            assert!(nearest(typed).unwrap_err().contains("expected one such as 2s, 500ms or 2"), "{typed}");
        }
    }

    #[test]
    fn mistakes_are_reported() {
        for (typed, message) in [
            ("", "`` is not a frame"),
            ("a", "`a` is not a frame"),
            ("1,,2", "`` is not a frame"),
            ("-3", "`-3` is not a frame"),
            ("3-", "`3-` is not a frame"),
            ("0-9x", "`0-9x` is not a frame"),
            ("1.5", "`1.5` is not a frame"),
            ("99999999999999999999", "is not a frame"),
            ("9-0", "did you mean 0-9?"),
            ("0-9x0", "a stride of 0"),
        ] {
            let error = typed.parse::<FrameRanges>().unwrap_err();
            assert!(error.contains(message), "{typed}: {error}");
        }
        let select = |typed: &str, last| typed.parse::<FrameRanges>().unwrap().select(last).unwrap_err();
        assert_eq!(select("0-9,170-181", 180), "there is no frame 181; the last one is 180");
        assert!(select("0-18446744073709551615", u64::MAX).contains("too many"));
    }
}
