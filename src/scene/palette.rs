//! The colours of a picture. Those of a theme come from here; what a scene gives takes their place, and whatever belongs
//! to it follows. Vermilion means "turned over" and nothing else.

use super::file::{ColoursFile, TypedColour};
use super::view::Theme;
use crate::colour::{Colour, Oklab, best_of, contrast, from_oklab, mixed, oklab, readable};

/// The colours of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Palette {
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
    /// An arrow of a model without springs, and of one with springs.
    pub arrows: [Colour; 2],
}

impl Palette {
    /// The colours of a theme.
    pub fn of(theme: Theme) -> Self {
        match theme {
            Theme::Light => LIGHT,
            Theme::Dark => DARK,
        }
    }

    /// Signs on sound elements in the plane: their edges' colour, a third of the way to the elements' own.
    pub fn sign(&self) -> Colour {
        std::array::from_fn(|at| ((2 * u16::from(self.edge[at]) + u16::from(self.sound_flat[at])) / 3) as u8)
    }

    /// Whether it is dark on light ground, as on paper.
    pub fn is_light(&self) -> bool {
        contrast(self.background, [0; 3]) >= contrast(self.background, [255; 3])
    }

    /// The same on another ground, into which the floor goes over without a border and what is far fades.
    pub fn on_ground(&self, ground: Colour) -> Self {
        Self { background: ground, floor: ground, ..*self }
    }

    /// The theme whose text can be read on a background: the one asked for, or else the better one.
    pub(super) fn theme_on(background: Option<Colour>, theme: Theme) -> Theme {
        let Some(ground) = background else { return theme };
        let other = if theme == Theme::Light { Theme::Dark } else { Theme::Light };
        let [own, others] = [theme, other].map(|theme| contrast(Self::of(theme).text, ground));
        if own >= LEAST_CONTRAST || own >= others { theme } else { other }
    }

    /// The colours of a theme with those that a scene gives, and all that belongs to these.
    pub(super) fn with(theme: Theme, background: Option<Colour>, given: &ColoursFile) -> Self {
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
            own.alarm_on_white = readable(alarm, [255; 3], LEAST_CONTRAST);
        }
        own.alarm_text = readable(own.alarm_text, own.background, LEAST_CONTRAST);
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
            own.arrows = [arrow; 2];
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
pub(super) const LEAST_CONTRAST: f64 = 4.5;
/// The least contrast of lines with the body they lie on: they need less than words (WCAG 2.2, 1.4.11).
const LINE_CONTRAST: f64 = 3.0;
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
    arrows: [[0x00, 0x72, 0xb2], [0x3c, 0x43, 0x4d]],
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
    arrows: [[0x56, 0xb4, 0xe9], [0xc3, 0xcb, 0xd5]],
};
