//! The lines of runs: colours and dashes.

use super::palette::Palette;
use crate::colour::{Colour, LINE_CONTRAST, least_difference, readable};

/// The least difference of the colours of two runs, for any colour vision (CIEDE2000).
const RUNS_APART: f64 = 15.0;
/// Lengths of the dashes and gaps of runs, by their places (px in the reference picture). They distinguish runs in
/// greyscale print, and if there are more runs than colours.
pub(super) const DASHES: [&[f64]; 8] = [
    &[],
    &[7.0, 4.0],
    &[18.0, 4.0],
    &[2.2, 3.2],
    &[11.0, 3.0, 2.5, 3.0],
    &[18.0, 4.0, 6.0, 4.0],
    &[7.0, 3.0, 2.5, 3.0, 2.5, 3.0],
    &[4.0, 8.0],
];

impl Palette {
    /// The places of runs. Some runs have chosen colours. Each has the dashes of its number. The others avoid
    /// colours that look like a chosen one, if enough are left.
    pub(crate) fn places(&self, chosen: &[Option<Colour>]) -> Vec<usize> {
        let (colours, dashes) = (self.runs.len(), DASHES.len());
        let seen = |colour| readable(colour, self.background, LINE_CONTRAST);
        let is_like = |own: Colour, other: &Colour| least_difference(seen(own), seen(*other)) < RUNS_APART;
        let is_free = self.runs.map(|own| !chosen.iter().flatten().any(|other| is_like(own, other)));
        let keeps = |at: usize| chosen[at].is_some() || is_free[at % colours];
        let is_taken = |colour: usize| (colour..chosen.len()).step_by(colours).any(|at| chosen[at].is_none());
        let free = || (0..colours).filter(|&colour| is_free[colour]);
        let mut others = free().filter(|&colour| !is_taken(colour)).chain(free().cycle());
        let place = |at: usize| {
            if keeps(at) {
                return at;
            }
            let dash = (at + at / colours) % dashes;
            // The place with this colour and these dashes.
            others.next().map_or(at, |colour| colour + colours * ((dash + dashes - colour) % dashes))
        };
        (0..chosen.len()).map(place).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::contrast;
    use crate::look::Theme;

    #[test]
    fn runs_differ_from_each_other_and_from_turned_over_elements() {
        for theme in [Theme::Light, Theme::Dark].map(Palette::of) {
            for (at, &colour) in theme.runs.iter().enumerate() {
                let found = contrast(colour, theme.background);
                assert!(found >= LINE_CONTRAST, "{colour:x?} has a contrast of {found:.2} with the background");
                let found = least_difference(colour, theme.alarm);
                assert!(found >= 20.0, "{colour:x?} and turned-over elements differ by {found:.1}");
                for other in &theme.runs[..at] {
                    let found = least_difference(colour, *other);
                    assert!(found >= RUNS_APART, "{colour:x?} and {other:x?} differ by {found:.1}");
                }
            }
        }
        // Without colours, dashes distinguish runs.
        for (at, dash) in DASHES.iter().enumerate() {
            assert!(!DASHES[..at].contains(dash) && dash.len() % 2 == 0 && dash.len() <= 6, "{dash:?}");
        }
    }
}
