//! The times at which frames are shown.

/// A frame and its duration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shot {
    /// The number of the frame.
    pub frame: usize,
    /// Duration (s), more than 0.
    pub duration: f64,
}

/// The frames and their durations, in order.
#[derive(Clone, Debug, PartialEq)]
pub struct Timeline {
    shots: Vec<Shot>,
    /// Pictures per second, if chosen by the user.
    rate: Option<f64>,
}

/// Duration of the only frame (s).
const ALONE: f64 = 1.0;
/// Greatest number of pictures per second of films without a chosen rate: screens show no more.
const MOST_RATE: f64 = 60.0;

impl Timeline {
    /// Each frame is shown until the time of the next one, the last one as long as the one before it; `moments` are
    /// numbers and times (s) of frames, both rising.
    ///
    /// Frames show the end of a step, so their times differ by up to a step from their number divided by the rate. If
    /// they differ by no more, that rate is used.
    pub fn of(moments: &[(u64, f64)]) -> Self {
        let (Some(&(first, start)), Some(&(last, end))) = (moments.first(), moments.last()) else {
            return Self { shots: Vec::new(), rate: None };
        };
        if moments.len() == 1 {
            return Self { shots: vec![Shot { frame: 0, duration: ALONE }], rate: None };
        }
        let interval = (end - start) / (last - first) as f64;
        let even = |number: u64| start + (number - first) as f64 * interval;
        let is_even = moments.iter().all(|&(number, time)| (time - even(number)).abs() < interval / 2.0);
        let unit = 1.0 / likely_rate(1.0 / interval, last - first);
        let duration = |pair: &[(u64, f64)]| {
            if is_even { (pair[1].0 - pair[0].0) as f64 * unit } else { pair[1].1 - pair[0].1 }
        };
        let mut durations: Vec<f64> = moments.windows(2).map(duration).collect();
        durations.extend(durations.last().copied());
        let shots = durations.into_iter().enumerate().map(|(frame, duration)| Shot { frame, duration }).collect();
        Self { shots, rate: None }
    }

    /// The shots in order.
    pub fn shots(&self) -> &[Shot] {
        &self.shots
    }

    /// Total duration (s).
    pub fn duration(&self) -> f64 {
        self.shots.iter().map(|shot| shot.duration).sum()
    }

    /// Faster by a factor.
    pub fn faster(mut self, times: f64) -> Self {
        self.shots.iter_mut().for_each(|shot| shot.duration /= times);
        self
    }

    /// With a fixed number of pictures per second. Each picture is the frame at its time.
    pub fn at_rate(mut self, rate: f64) -> Self {
        // Sums of thirds may be slightly above a whole number.
        let tick = |time: f64| (time * rate - 1e-6).ceil().max(0.0) as u64;
        let mut starts: Vec<(usize, u64)> = Vec::new();
        let mut time = 0.0;
        for shot in &self.shots {
            match starts.last_mut() {
                Some((frame, start)) if *start == tick(time) => *frame = shot.frame,
                _ => starts.push((shot.frame, tick(time))),
            }
            time += shot.duration;
        }
        let ends: Vec<u64> = starts.iter().skip(1).map(|(_, start)| *start).chain([tick(time)]).collect();
        let shots = starts.iter().zip(ends).filter(|((_, start), end)| start < end);
        self.shots =
            shots.map(|(&(frame, start), end)| Shot { frame, duration: (end - start) as f64 / rate }).collect();
        self.rate = Some(rate);
        self
    }

    /// With at most `most` pictures per second: halved as often as needed, so that the remaining ones are evenly
    /// spaced.
    pub(super) fn at_most(&self, most: f64) -> Self {
        let own = self.own_rate();
        let mut rate = own;
        while rate > most * 1.001 {
            rate /= 2.0;
        }
        if rate < own { self.clone().at_rate(rate) } else { self.clone() }
    }

    /// For a film: with at most as many pictures per second as screens show, unless the user has chosen more.
    pub(super) fn for_screens(&self) -> Self {
        if self.rate.is_some() { self.clone() } else { self.at_most(MOST_RATE) }
    }

    /// With the last frame longer by `time` (s).
    pub fn holding(mut self, time: f64) -> Self {
        if let Some(last) = self.shots.last_mut() {
            last.duration += time;
        }
        self
    }

    /// The rate at which the shortest shot is one picture.
    fn own_rate(&self) -> f64 {
        let shortest = self.shots.iter().map(|shot| shot.duration).fold(f64::INFINITY, f64::min);
        self.rate.unwrap_or(1.0 / shortest)
    }

    /// Pictures per second that show every frame at its time, as numerator and denominator.
    pub(super) fn rate(&self) -> [u32; 2] {
        fraction(self.own_rate(), 1 << 20)
    }

    /// The shots in whole ticks of a clock with `rate` ticks per second, each at least `least` ticks. Every shot begins
    /// at the tick nearest to its time, so errors do not add up. Shots that would be shorter are omitted, but never the
    /// last one.
    pub(super) fn ticks(&self, rate: f64, least: u64) -> Vec<(usize, u64)> {
        let mut starts: Vec<(usize, u64)> = Vec::new();
        let mut time = 0.0;
        for (at, shot) in self.shots.iter().enumerate() {
            // Sums of thirds may be slightly below a half.
            let start = (time * rate + 1e-6).round() as u64;
            match starts.last_mut() {
                Some((frame, before)) if start < *before + least => {
                    if at + 1 == self.shots.len() {
                        *frame = shot.frame;
                    }
                }
                _ => starts.push((shot.frame, start)),
            }
            time += shot.duration;
        }
        let end = (time * rate + 1e-6).round() as u64;
        let ends = starts.iter().skip(1).map(|(_, start)| *start).chain([end]);
        starts.iter().zip(ends).map(|((frame, start), end)| (*frame, end.saturating_sub(*start).max(least))).collect()
    }
}

/// Common rates (pictures per second).
const USUAL: [f64; 10] = [60.0, 30.0, 50.0, 25.0, 100.0, 120.0, 24.0, 20.0, 15.0, 10.0];
/// Greatest difference between the end of a step and the time of its frame, relative to the time between two frames.
const STRAY: f64 = 0.15;

/// The intended rate for a rate measured over `count` frames: a common one or a whole number, if it is near enough.
fn likely_rate(rate: f64, count: u64) -> f64 {
    let is_near = |other: &f64| (rate - other).abs() <= STRAY / count as f64 * other;
    let mut candidates = USUAL.into_iter().chain([rate.round()]).filter(|candidate| *candidate >= 1.0);
    candidates.find(is_near).unwrap_or(rate)
}

/// The simplest fraction within a relative error of 1e-9 of a number, or the nearest one with numerator and denominator
/// up to `most`.
pub(super) fn fraction(number: f64, most: u32) -> [u32; 2] {
    let (mut before, mut here) = ([0.0, 1.0], [1.0, 0.0]);
    let mut rest = number;
    loop {
        let whole = rest.floor();
        let next = [whole * here[0] + before[0], whole * here[1] + before[1]];
        if next.iter().any(|part| *part > f64::from(most)) {
            break;
        }
        (before, here) = (here, next);
        if (here[0] / here[1] - number).abs() <= 1e-9 * number || rest - whole < 1e-9 {
            break;
        }
        rest = 1.0 / (rest - whole);
    }
    // The number is above all such fractions.
    if here[1] == 0.0 { [most, 1] } else { here.map(|part| part as u32) }
}

#[cfg(test)]
#[path = "../../tests/inside/timeline.rs"]
mod tests;
