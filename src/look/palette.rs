//! The colours of a picture. Those of a theme come from here; what a scene gives takes their place, and whatever belongs
//! to it follows. Vermilion means "turned over" and nothing else.

use super::typed::{ColoursFile, TypedColour};
use super::view::Theme;
use crate::colour::{Colour, Oklab, Sight, best_of, contrast, difference, from_oklab, mixed, oklab, readable};

/// The colours of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Palette {
    /// Behind everything.
    pub background: Colour,
    /// Around arrows and marks, so that they stand out from whatever they lie on.
    pub halo: Colour,
    /// The floor.
    pub floor: Colour,
    /// The lines on the floor.
    pub grid: Colour,
    /// What the floor's colour goes to in the shadow.
    pub shadow: Colour,
    /// How far it goes there for full shadow of the key light and of the sky.
    pub shadow_strength: [f32; 2],
    /// A sound element in space, before light falls on it.
    pub sound: Colour,
    /// A sound element in the plane.
    pub sound_flat: Colour,
    /// A node in the plane.
    pub node: Colour,
    /// A turned-over element, before light falls on it.
    pub alarm: Colour,
    /// Hatch and edges of turned-over elements.
    pub alarm_line: Colour,
    /// Words about turned-over elements.
    pub alarm_text: Colour,
    /// Signs of turned-over elements, which stand on white in any theme.
    pub alarm_on_white: Colour,
    /// Edges of sound elements, and steps of depth inside a body.
    pub edge: Colour,
    /// The outline of a body.
    pub outline: Colour,
    /// Opacity of the outline.
    pub outline_alpha: f32,
    /// A solid obstacle in space, before light falls on it.
    pub obstacle: Colour,
    /// A solid obstacle in the plane, and its outline.
    pub obstacle_flat: [Colour; 2],
    /// A transparent plate, and its sides.
    pub plate: Colour,
    /// The sides of a plate.
    pub plate_side: Colour,
    /// A wall or a slope.
    pub wall: Colour,
    /// Edges of what is transparent.
    pub pane_edge: Colour,
    /// Arrows of what moves, and marks of what is held.
    pub pointer: Colour,
    /// Names and numbers.
    pub text: Colour,
    /// Everything else that is written.
    pub second_text: Colour,
    /// The line of the floor in the plane.
    pub axis: Colour,
    /// Lines between panels.
    pub hairline: Colour,
    /// A square of the tally for a sound element.
    pub tally: Colour,
    /// A spring on the ground.
    pub spring: Colour,
    /// A spring on a surface.
    pub spring_on_body: Colour,
    /// The sides of lines that a field colours.
    pub casing: Colour,
    /// The lines that stand for runs, by their places: see [`Run::line`](crate::scene::Run::line).
    pub runs: [Colour; 8],
}

/// Lengths of the dashes of runs and of the gaps after them, by their places (px in the reference picture). They tell
/// runs apart where colours do not: in grey print, and where there are more runs than colours.
const DASHES: [&[f64]; 8] = [
    &[],
    &[7.0, 4.0],
    &[18.0, 4.0],
    &[2.2, 3.2],
    &[11.0, 3.0, 2.5, 3.0],
    &[18.0, 4.0, 6.0, 4.0],
    &[7.0, 3.0, 2.5, 3.0, 2.5, 3.0],
    &[4.0, 8.0],
];

/// What the line looks like that stands for a run: curves in charts, and samples of them beside names. Its arrows have
/// the same colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LineStyle {
    /// Its colour.
    pub colour: Colour,
    /// Lengths of its dashes and of the gaps after them, by turns (px in the reference picture); empty for a solid line.
    pub dash: &'static [f64],
}

impl Palette {
    /// The colours of a theme.
    pub(crate) fn of(theme: Theme) -> Self {
        match theme {
            Theme::Light => LIGHT,
            Theme::Dark => DARK,
        }
    }

    /// Signs on sound elements in the plane: their edges' colour, a third of the way to the elements' own.
    pub(crate) fn sign(&self) -> Colour {
        std::array::from_fn(|at| ((2 * u16::from(self.edge[at]) + u16::from(self.sound_flat[at])) / 3) as u8)
    }

    /// What ghosts of shapes on the background are tinted with.
    pub(crate) fn edge_on_ground(&self) -> Colour {
        if self.is_made_for_light() { self.edge } else { self.outline }
    }

    /// Whether it is made for light ground, such as paper. That does not change with [`Self::on_ground`].
    pub(crate) fn is_made_for_light(&self) -> bool {
        contrast(self.halo, [0; 3]) >= contrast(self.halo, [255; 3])
    }

    /// The line of a run, the same in every picture of its scene. Eight runs differ in colour and in dashes, more of them,
    /// up to 64, in one of both. Colours are made lighter or darker where they could not be seen on the background.
    /// `place` is that of the run ([`Self::places`]), `chosen` a colour of its own.
    pub(crate) fn line(&self, place: usize, chosen: Option<Colour>) -> LineStyle {
        let (colours, dashes) = (self.runs.len(), DASHES.len());
        let colour = chosen.unwrap_or(self.runs[place % colours]);
        LineStyle {
            // The halo's colour is that of the background, whatever ground a picture is laid on.
            colour: readable(colour, self.halo, LINE_CONTRAST),
            dash: DASHES[(place + place / colours) % dashes],
        }
    }

    /// The places of runs, some of which have chosen colours. Each has the dashes of its number. The others leave out
    /// colours that look like a chosen one, as far as there are any left.
    pub(crate) fn places(&self, chosen: &[Option<Colour>]) -> Vec<usize> {
        let (colours, dashes) = (self.runs.len(), DASHES.len());
        let seen = |colour| readable(colour, self.halo, LINE_CONTRAST);
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
            // The place of this colour that has these dashes.
            others.next().map_or(at, |colour| colour + colours * ((dash + dashes - colour) % dashes))
        };
        (0..chosen.len()).map(place).collect()
    }

    /// A colour in which words can be read on the background: the nearest to a given one.
    pub(crate) fn text_like(&self, colour: Colour) -> Colour {
        readable(colour, self.halo, LEAST_CONTRAST)
    }

    /// The same on another ground, into which the floor goes over without a border and what is far fades.
    pub(crate) fn on_ground(&self, ground: Colour) -> Self {
        Self { background: ground, floor: ground, ..*self }
    }

    /// The theme whose text can be read on a background: the one asked for, or else the better one.
    pub(crate) fn theme_on(background: Option<Colour>, theme: Theme) -> Theme {
        let Some(ground) = background else { return theme };
        let other = if theme == Theme::Light { Theme::Dark } else { Theme::Light };
        let [own, others] = [theme, other].map(|theme| contrast(Self::of(theme).text, ground));
        if own >= LEAST_CONTRAST || own >= others { theme } else { other }
    }

    /// The colours of a theme with those that a scene gives, and all that belongs to these.
    pub(crate) fn with(theme: Theme, background: Option<Colour>, given: &ColoursFile) -> Self {
        let theme = Self::of(theme);
        let mut own = theme;
        if let Some(ground) = background {
            (own.background, own.halo) = (ground, ground);
            own.floor = like(ground, theme.background, theme.floor);
            own.grid = like(ground, theme.background, theme.grid);
            if contrast(own.text, ground) < LEAST_CONTRAST {
                own.text = best_of(&[own.text, [0; 3], [255; 3]], ground);
            }
        }
        let typed = |role: &Option<TypedColour>| role.as_ref().map(|typed| typed.0);
        own.text = typed(&given.text).unwrap_or(own.text);
        if own.text != theme.text || own.background != theme.background {
            own.follow_text(&theme);
        }
        if let Some(body) = typed(&given.body) {
            own.sound = body;
            own.sound_flat = like(body, theme.sound, theme.sound_flat);
            own.tally = like(body, theme.sound, theme.tally);
            own.edge = readable(own.edge, body, LINE_CONTRAST);
            own.spring_on_body = readable(own.spring_on_body, body, LINE_CONTRAST);
        }
        if let Some(alarm) = typed(&given.turned_over) {
            own.alarm = alarm;
            own.alarm_line = hatch(alarm, &theme);
            own.alarm_text = alarm;
            own.alarm_on_white = readable(alarm, [255; 3], GOOD_CONTRAST);
        }
        own.alarm_text = readable(own.alarm_text, own.background, GOOD_CONTRAST.min(most_contrast(own.background)));
        if let Some(edge) = typed(&given.edge) {
            (own.edge, own.casing) = (edge, edge);
        }
        if let Some(outline) = typed(&given.outline) {
            (own.outline, own.outline_alpha) = (outline, 1.0);
        }
        if let Some(obstacle) = typed(&given.obstacle) {
            own.obstacle = obstacle;
            own.obstacle_flat = theme.obstacle_flat.map(|flat| like(obstacle, theme.obstacle, flat));
        }
        if let Some(plate) = typed(&given.plate) {
            own.plate = plate;
            own.plate_side = like(plate, theme.plate, theme.plate_side);
            own.wall = like(plate, theme.plate, theme.wall);
            own.pane_edge = like(plate, theme.plate, theme.pane_edge);
        }
        if let Some(spring) = typed(&given.spring) {
            own.spring = spring;
            own.spring_on_body = readable(spring, own.sound, LINE_CONTRAST);
        }
        let one_to_one = [
            (&mut own.floor, &given.floor),
            (&mut own.grid, &given.grid),
            (&mut own.shadow, &given.shadow),
            (&mut own.node, &given.node),
            (&mut own.pointer, &given.pointer),
        ];
        for (own, given) in one_to_one {
            *own = typed(given).unwrap_or(*own);
        }
        if let Some(arrow) = typed(&given.arrow) {
            own.runs = [arrow; 8];
        }
        own
    }

    /// What is written and ruled besides names and numbers stands between the text and the background, as far from
    /// each as in the theme; words remain readable.
    fn follow_text(&mut self, theme: &Self) {
        let (text, ground) = (self.text, self.background);
        let between = |colour: Colour| mixed(text, ground, share(theme.text, theme.background, colour));
        let least = LEAST_CONTRAST.min(contrast(text, ground));
        let own = share(theme.text, theme.background, theme.second_text);
        let fainter = (0..=20).map(|step| mixed(text, ground, own * f64::from(20 - step) / 20.0));
        self.second_text = { fainter }.find(|&second| contrast(second, ground) >= least).unwrap_or(text);
        self.axis = between(theme.axis);
        self.hairline = between(theme.hairline);
    }
}

/// The least contrast of words with their ground that all can read (WCAG 2.2, AA).
pub(crate) const LEAST_CONTRAST: f64 = 4.5;
/// How different the colours of two runs look at the least, to anybody (CIEDE2000).
const RUNS_APART: f64 = 15.0;
/// The contrast of words whose colour is chosen here, which leaves something for a floor below them.
const GOOD_CONTRAST: f64 = 5.0;
/// The least contrast of lines with what they lie on: they need less than words (WCAG 2.2, 1.4.11).
pub(crate) const LINE_CONTRAST: f64 = 3.0;
/// An alarm colour darker than this (lightness of Oklab) has a lighter hatch, and how much lighter.
const DARK_ALARM: f64 = 0.48;
const LIGHTER_HATCH: f64 = 0.36;

/// What is to a colour of the scene as another colour of a theme is to that colour's counterpart there: as much lighter
/// or darker, and as much more or less colourful.
fn like(own: Colour, counterpart: Colour, other: Colour) -> Colour {
    let [own, counterpart, other] = [own, counterpart, other].map(oklab);
    let Oklab([lightness, a, b]) = own;
    let lightness = (lightness + other.0[0] - counterpart.0[0]).clamp(0.0, 1.0);
    // Greys have hardly any colour to compare with.
    let times = ((other.chroma() + 0.01) / (counterpart.chroma() + 0.01)).min(1.5);
    from_oklab(Oklab([lightness, times * a, times * b]))
}

/// The hatch on turned-over elements of a colour: darker as in the theme, or lighter on dark ones.
fn hatch(alarm: Colour, theme: &Palette) -> Colour {
    let Oklab([lightness, a, b]) = oklab(alarm);
    if lightness < DARK_ALARM {
        return from_oklab(Oklab([lightness + LIGHTER_HATCH, a, b]));
    }
    like(alarm, theme.alarm, theme.alarm_line)
}

/// How different two colours look at the least, to all eyes.
fn least_difference(one: Colour, other: Colour) -> f64 {
    Sight::ALL.into_iter().map(|sight| difference(one, other, sight)).fold(f64::INFINITY, f64::min)
}

/// The contrast of black or white, whichever has more, with a ground; never less than 4.58.
fn most_contrast(ground: Colour) -> f64 {
    contrast([0; 3], ground).max(contrast([255; 3], ground))
}

/// How far a colour is on the way from one to another.
fn share(from: Colour, to: Colour, colour: Colour) -> f64 {
    let sum = |colour: Colour| f64::from(colour.map(u32::from).iter().sum::<u32>());
    ((sum(colour) - sum(from)) / (sum(to) - sum(from))).clamp(0.0, 1.0)
}

const LIGHT: Palette = Palette {
    background: [0xfb, 0xfb, 0xfa],
    halo: [0xfb, 0xfb, 0xfa],
    floor: [0xf3, 0xf4, 0xf5],
    grid: [0xc9, 0xce, 0xd6],
    shadow: [0x2d, 0x36, 0x45],
    shadow_strength: [0.38, 0.52],
    sound: [0x93, 0xa5, 0xba],
    sound_flat: [0xb9, 0xc7, 0xd6],
    node: [0xff, 0xff, 0xff],
    alarm: [0xe2, 0x66, 0x1c],
    alarm_line: [0x5a, 0x1f, 0x00],
    alarm_text: [0xb8, 0x4a, 0x00],
    alarm_on_white: [0xb8, 0x4a, 0x00],
    edge: [0x1f, 0x2a, 0x38],
    outline: [0x14, 0x1c, 0x27],
    outline_alpha: 1.0,
    obstacle: [0xc3, 0xbe, 0xb6],
    obstacle_flat: [[0xdd, 0xd8, 0xcf], [0x7a, 0x74, 0x6a]],
    plate: [0xd3, 0xd6, 0xda],
    plate_side: [0xb9, 0xc2, 0xcd],
    wall: [0xe3, 0xe7, 0xec],
    pane_edge: [0x2a, 0x33, 0x3e],
    pointer: [0x3c, 0x43, 0x4d],
    text: [0x1b, 0x23, 0x2e],
    second_text: [0x5c, 0x66, 0x72],
    axis: [0x7a, 0x84, 0x91],
    hairline: [0xd8, 0xdc, 0xe1],
    tally: [0xc0, 0xca, 0xd6],
    spring: [0x3c, 0x43, 0x4d],
    spring_on_body: [0x3c, 0x43, 0x4d],
    casing: [0x5c, 0x66, 0x72],
    runs: [
        [0x00, 0x72, 0xb2],
        [0x3c, 0x43, 0x4d],
        [0x1e, 0xa0, 0x87],
        [0x4d, 0x20, 0x01],
        [0x24, 0x9d, 0xb1],
        [0x40, 0x00, 0x54],
        [0x00, 0x00, 0xcb],
        [0x43, 0x5a, 0x44],
    ],
};

const DARK: Palette = Palette {
    background: [0x12, 0x16, 0x1c],
    halo: [0x12, 0x16, 0x1c],
    floor: [0x1a, 0x20, 0x28],
    grid: [0x3b, 0x45, 0x52],
    shadow: [0x00, 0x00, 0x00],
    shadow_strength: [0.62, 0.70],
    sound: [0xa3, 0xb5, 0xca],
    sound_flat: [0x6f, 0x83, 0x9b],
    node: [0xee, 0xf2, 0xf6],
    alarm: [0xf2, 0x7a, 0x2e],
    alarm_line: [0x3d, 0x14, 0x00],
    alarm_text: [0xff, 0x9b, 0x5c],
    alarm_on_white: [0xb8, 0x4a, 0x00],
    edge: [0x0b, 0x10, 0x17],
    outline: [0xdc, 0xe5, 0xef],
    outline_alpha: 0.62,
    obstacle: [0x6c, 0x69, 0x64],
    obstacle_flat: [[0x38, 0x36, 0x33], [0x9a, 0x94, 0x8a]],
    plate: [0x4a, 0x55, 0x63],
    plate_side: [0x6b, 0x79, 0x8a],
    wall: [0x24, 0x2c, 0x36],
    pane_edge: [0xa9, 0xb6, 0xc5],
    pointer: [0xdc, 0xe3, 0xea],
    text: [0xee, 0xf2, 0xf6],
    second_text: [0x9c, 0xa8, 0xb6],
    axis: [0x6b, 0x76, 0x83],
    hairline: [0x2c, 0x34, 0x3f],
    tally: [0x56, 0x63, 0x73],
    spring: [0xc3, 0xcb, 0xd5],
    spring_on_body: [0x1d, 0x25, 0x30],
    casing: [0x0b, 0x10, 0x17],
    runs: [
        [0x56, 0xb4, 0xe9],
        [0xc3, 0xcb, 0xd5],
        [0x3a, 0xa9, 0x96],
        [0xff, 0xfd, 0x00],
        [0xc5, 0xec, 0xb9],
        [0x93, 0x60, 0x93],
        [0x59, 0x74, 0xf0],
        [0x8b, 0x59, 0x3d],
    ],
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::{Lab, cie76, ciede2000, encoded, lab, linear, seen_by};

    const WHITE: Colour = [255; 3];

    fn typed(text: &str) -> Option<TypedColour> {
        Some(text.parse().unwrap_or_else(|error| panic!("{text}: {error}")))
    }

    /// All that words stand on.
    fn words(palette: &Palette) -> Vec<(Colour, Colour)> {
        let texts = [palette.text, palette.second_text, palette.alarm_text];
        let grounds = [palette.background, palette.floor];
        let mut pairs: Vec<_> = texts.iter().flat_map(|&text| grounds.map(|ground| (text, ground))).collect();
        pairs.push((palette.alarm_on_white, WHITE));
        pairs
    }

    #[test]
    fn words_can_be_read_on_whatever_they_stand_on() {
        for theme in [LIGHT, DARK] {
            for (text, ground) in words(&theme) {
                let found = contrast(text, ground);
                assert!(found >= LEAST_CONTRAST, "{text:x?} on {ground:x?} has a contrast of {found:.2}");
            }
        }
    }

    /// The light that falls on faces, as `shaders/surface.wgsl` has it: on all sides of the key light, facing up, level
    /// and down, standing on the floor and in the air.
    fn lights() -> Vec<[f64; 3]> {
        const KEY: [f64; 3] = [0.66, 0.635, 0.595];
        const SKY: [f64; 3] = [0.60, 0.635, 0.68];
        const GROUND: [f64; 3] = [0.27, 0.262, 0.25];
        let mut lights = vec![[1.0; 3]];
        for key in [0.0, 0.25, 0.5, 0.75, 1.0] {
            for upward in [-1.0, -0.5, 0.0, 0.5, 1.0_f64] {
                for contact in [0.72, 1.0] {
                    let contact = contact + (1.0 - contact) * upward.abs();
                    lights.push(std::array::from_fn(|at| {
                        let around = GROUND[at] + (SKY[at] - GROUND[at]) * (0.5 + 0.5 * upward);
                        KEY[at] * key + around * contact
                    }));
                }
            }
        }
        lights
    }

    fn brightness(light: [f64; 3]) -> f64 {
        0.2126 * light[0] + 0.7152 * light[1] + 0.0722 * light[2]
    }

    /// A turned-over element at a depth behind a sound one, from 0 to 1, as `shaders/surface.wgsl` mixes it.
    fn through(sound: [f64; 3], alarm: [f64; 3], light: [f64; 3], deep: f64) -> [f64; 3] {
        let colour: [f64; 3] = std::array::from_fn(|at| sound[at] * light[at]);
        let grey = brightness(colour);
        std::array::from_fn(|at| {
            let lit = alarm[at] * light[at];
            let unlit = lit * 0.86 / brightness(light).max(0.05);
            let alarm = lit + (unlit - lit) * 0.65 * deep;
            let grey = colour[at] + (grey - colour[at]) * 0.7;
            grey + (alarm - grey) * (1.0 - 0.4 * deep)
        })
    }

    /// The smallest difference of two colours to anybody who does not see as most do.
    fn apart(one: [f64; 3], other: [f64; 3], measure: fn(Lab, Lab) -> f64) -> f64 {
        let [one, other] = [one, other].map(|light| linear(encoded(light)));
        let sights = [Sight::Usual, Sight::Deuteranopia, Sight::Protanopia];
        let seen = sights.iter().flat_map(|&sight| seen_by(sight, one).into_iter().zip(seen_by(sight, other)));
        seen.map(|(one, other)| measure(lab(one), lab(other))).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn nobody_takes_turned_over_elements_for_sound_ones() {
        let mut least = [f64::INFINITY; 4];
        for theme in [LIGHT, DARK] {
            let [sound, flat, tally, alarm] = [theme.sound, theme.sound_flat, theme.tally, theme.alarm].map(linear);
            for measure in [ciede2000, cie76] {
                for sound in [sound, flat, tally] {
                    let found = apart(sound, alarm, measure);
                    least[0] = least[0].min(found);
                    assert!(found >= 20.0, "as they are: {found:.1}");
                }
                for light in lights() {
                    let lit = |colour: [f64; 3]| std::array::from_fn(|at| colour[at] * light[at]);
                    let found = apart(lit(sound), lit(alarm), measure);
                    least[1] = least[1].min(found);
                    assert!(found >= 20.0, "in the light {light:.2?}: {found:.1}");
                    let found = apart(lit(sound), through(sound, alarm, light, 0.0), measure);
                    least[2] = least[2].min(found);
                    assert!(found >= 20.0, "just behind, in the light {light:.2?}: {found:.1}");
                    let found = apart(lit(sound), through(sound, alarm, light, 1.0), measure);
                    least[3] = least[3].min(found);
                    assert!(found >= 20.0, "deep inside, in the light {light:.2?}: {found:.1}");
                }
            }
        }
        println!("as they are, lit, just behind, deep inside: {least:.1?}");
    }

    #[test]
    fn nobody_takes_a_run_for_another_or_for_what_has_turned_over() {
        for theme in [LIGHT, DARK] {
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
        // Where there are no colours, dashes say it.
        for (at, dash) in DASHES.iter().enumerate() {
            assert!(!DASHES[..at].contains(dash) && dash.len() % 2 == 0 && dash.len() <= 6, "{dash:?}");
        }
    }

    #[test]
    fn what_is_not_given_follows() {
        let given = ColoursFile { body: typed("#8fbc8f"), turned_over: typed("#7b2d8b"), ..ColoursFile::default() };
        for theme in [Theme::Light, Theme::Dark] {
            let (own, of_theme) = (Palette::with(theme, None, &given), Palette::of(theme));
            assert_eq!((own.sound, own.alarm), ([0x8f, 0xbc, 0x8f], [0x7b, 0x2d, 0x8b]));
            // Green, and lighter or darker than the body as in the theme.
            for (colour, others) in [(own.sound_flat, of_theme.sound_flat), (own.tally, of_theme.tally)] {
                assert!(colour[1] > colour[0] && colour[1] > colour[2], "{colour:x?}");
                let lighter = |one: Colour, other: Colour| oklab(one).0[0] - oklab(other).0[0];
                assert!((lighter(colour, own.sound) - lighter(others, of_theme.sound)).abs() < 0.02, "{colour:x?}");
            }
            assert!(contrast(own.alarm_line, own.alarm) > 1.5);
            for (text, ground) in words(&own) {
                assert!(contrast(text, ground) >= LEAST_CONTRAST, "{text:x?} on {ground:x?}");
            }
            let same = (own.background, own.text, own.grid, own.outline, own.second_text);
            assert_eq!(
                same,
                (of_theme.background, of_theme.text, of_theme.grid, of_theme.outline, of_theme.second_text)
            );
        }
        assert_eq!(Palette::with(Theme::Dark, None, &ColoursFile::default()), DARK);
        assert_eq!(Palette::with(Theme::Light, None, &ColoursFile::default()), LIGHT);
    }

    #[test]
    fn a_dark_body_gets_light_edges_and_a_dark_alarm_a_light_hatch() {
        let given = ColoursFile { body: typed("#202830"), turned_over: typed("#603000"), ..ColoursFile::default() };
        let own = Palette::with(Theme::Light, None, &given);
        assert!(oklab(own.edge).0[0] > oklab(own.sound).0[0] && contrast(own.edge, own.sound) >= LINE_CONTRAST);
        assert!(oklab(own.alarm_line).0[0] > oklab(own.alarm).0[0] + 0.2);
    }

    #[test]
    fn any_background_has_words_that_can_be_read() {
        for red in [0, 60, 120, 128, 150, 200, 255] {
            for green in [0, 60, 110, 120, 128, 180, 255] {
                for blue in [0, 120, 255] {
                    let ground = [red, green, blue];
                    for theme in [Theme::Light, Theme::Dark] {
                        let theme = Palette::theme_on(Some(ground), theme);
                        let own = Palette::with(theme, Some(ground), &ColoursFile::default());
                        for text in [own.text, own.second_text, own.alarm_text] {
                            assert!(contrast(text, ground) >= LEAST_CONTRAST, "{text:x?} on {ground:x?}");
                        }
                    }
                }
            }
        }
        assert_eq!(Palette::theme_on(Some([0; 3]), Theme::Light), Theme::Dark);
        assert_eq!(Palette::theme_on(Some([255; 3]), Theme::Dark), Theme::Light);
        assert_eq!(Palette::theme_on(Some([0xff, 0xf8, 0xe8]), Theme::Light), Theme::Light);
        assert_eq!(Palette::theme_on(None, Theme::Dark), Theme::Dark);
    }
}
