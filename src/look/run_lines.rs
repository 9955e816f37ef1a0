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

/// The models that share a colour, by their keys, in the order of a palette's colours. Other models, recordings, and runs with
/// several models have colours that are left.
const MODELS: [&[&str]; 8] = [
    &["shape-based"],
    &["mass-spring", "limited-springs"],
    &["volume-springs"],
    &["linear"],
    &["corotational"],
    &["neo-hookean"],
    &["xpbd"],
    &["metric"],
];

/// What decides the line of a run.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Lined<'a> {
    /// The key of its model; `None` for a recording, and for a run with several models.
    pub model: Option<&'a str>,
    /// Its chosen colour.
    pub chosen: Option<Colour>,
}

/// The places of the colour and of the dashes of a run's line in a palette.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct LinePlace {
    pub(super) colour: usize,
    pub(super) dash: usize,
}

impl Palette {
    /// The places of the lines of runs: runs of one model have one colour, and runs of one colour differ in dashes. Colours that look like
    /// a chosen one are avoided, if others are left.
    pub(crate) fn places(&self, runs: &[Lined<'_>]) -> Vec<LinePlace> {
        let seen = |colour| readable(colour, self.background, LINE_CONTRAST);
        let is_like = |own: Colour, other: Colour| least_difference(seen(own), seen(other)) < RUNS_APART;
        let is_free =
            |own: &usize| !runs.iter().filter_map(|run| run.chosen).any(|other| is_like(self.runs[*own], other));
        let free: Vec<usize> = (0..self.runs.len()).filter(is_free).collect();
        let free = if free.is_empty() { (0..self.runs.len()).collect() } else { free };
        let home = |run: &Lined<'_>| {
            let own = MODELS.iter().position(|keys| run.model.is_some_and(|model| keys.contains(&model)));
            own.filter(|own| run.chosen.is_none() && free.contains(own))
        };
        let homes: Vec<_> = runs.iter().map(home).collect();
        let mut left =
            free.iter().copied().filter(|&one| !homes.contains(&Some(one))).chain(free.iter().copied().cycle());
        let mut places: Vec<LinePlace> = Vec::with_capacity(runs.len());
        for (at, run) in runs.iter().enumerate() {
            let is_alike =
                |other: &Lined<'_>| run.model.is_some() && other.model == run.model && other.chosen.is_none();
            let colour = match (run.chosen, homes[at], runs[..at].iter().position(is_alike)) {
                (Some(_), ..) => 0,
                (None, Some(home), _) => home,
                (None, None, Some(other)) => places[other].colour,
                (None, None, None) => left.next().unwrap_or_default(),
            };
            let dash = |colour: usize| {
                let is_taken = |dash: &usize| {
                    let mut before = runs.iter().zip(&places);
                    before.any(|(one, place)| one.chosen == run.chosen && (place.colour, place.dash) == (colour, *dash))
                };
                let mut dashes = (at..at + DASHES.len()).map(|dash| dash % DASHES.len()).filter(|dash| !is_taken(dash));
                dashes.next().map(|dash| LinePlace { colour, dash })
            };
            // A colour whose dashes are all taken gives way to another one.
            let place = dash(colour).or_else(|| left.by_ref().take(self.runs.len()).find_map(dash));
            places.push(place.unwrap_or(LinePlace { colour, dash: at % DASHES.len() }));
        }
        places
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::contrast;
    use crate::look::Theme;

    fn of(model: &str) -> Lined<'_> {
        Lined { model: Some(model), chosen: None }
    }

    #[test]
    fn models_have_their_colours_in_every_scene_and_runs_of_one_model_their_dashes() {
        let palette = Palette::of(Theme::Light);
        let lines = |runs: &[Lined<'_>]| palette.places(runs).iter().map(|at| [at.colour, at.dash]).collect::<Vec<_>>();
        assert_eq!(lines(&MODELS.map(|keys| of(keys[0]))), [0, 1, 2, 3, 4, 5, 6, 7].map(|at| [at, at]));
        assert_eq!(lines(&["mass-spring", "linear", "mass-spring"].map(of)), [[1, 0], [3, 1], [1, 2]]);
        // Recordings, and models without a colour of their own, have what is left.
        let all = [Lined::default(), of("shape-based"), of("another"), Lined::default(), of("another")];
        assert_eq!(lines(&all), [[1, 0], [0, 1], [2, 2], [3, 3], [2, 4]]);
        // Up to 64 lines differ.
        for model in [Lined::default(), of("linear")] {
            let many = lines(&vec![model; 64]);
            assert!((0..many.len()).all(|at| !many[..at].contains(&many[at])), "{many:?}");
        }
    }

    #[test]
    fn colours_step_aside_for_chosen_ones() {
        for palette in [Theme::Light, Theme::Dark].map(Palette::of) {
            for chosen in palette.runs {
                for at in 0..MODELS.len() {
                    let mut runs = MODELS.map(|keys| of(keys[0]));
                    runs[at].chosen = Some(chosen);
                    let places = palette.places(&runs);
                    let colours: Vec<_> = runs
                        .iter()
                        .zip(&places)
                        .map(|(run, place)| run.chosen.unwrap_or(palette.runs[place.colour]))
                        .collect();
                    for (one, colour) in colours.iter().enumerate() {
                        for other in &colours[..one] {
                            assert!(least_difference(*colour, *other) >= RUNS_APART, "{colours:x?}");
                        }
                        assert!(!places[..one].iter().any(|other| other.dash == places[one].dash), "{places:?}");
                    }
                }
            }
        }
    }

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
