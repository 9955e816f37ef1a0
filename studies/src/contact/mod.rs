//! Contact of surfaces: what must hold, measured.
//!
//! Each trial is a small world with a known outcome: momenta that stay, a closed form, or nothing that crosses.

mod bars;
mod bodies;
mod folded;
mod hertz;
mod impacts;
mod rest;
mod shapes;
mod slopes;
mod solids;

pub(crate) use bodies::{lattice, obstacle};

use crate::page::{Contents, Line, Page, Plot};
use crate::study::{Findings, Study, Watch, each};
use crate::table::{Cell, Table, figure};

/// The study.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Contact {
    /// Impacts for each stiffness and restitution.
    pub(crate) impacts: u64,
    /// The time for which a pile rests (s).
    pub(crate) rest: f64,
    /// Refinements of what has a closed form.
    pub(crate) refined: u32,
    /// Periods of a bar that bounces.
    pub(crate) periods: u32,
    /// Starts of each of the sharp shapes that fall on each other.
    pub(crate) starts: u64,
}

impl Contact {
    pub(crate) fn usual() -> Self {
        Self { impacts: 12, rest: 60.0, refined: 4, periods: 100, starts: 10 }
    }

    /// All trials, each with its group.
    fn trials(&self) -> Vec<(&'static str, Trial)> {
        [
            // The longest first.
            ("rest", rest::trials(self.rest)),
            ("hertz", hertz::trials(self.refined)),
            ("bars", bars::trials(self.refined, self.periods)),
            ("slopes", slopes::trials(self.refined)),
            ("shapes", shapes::trials(self.starts)),
            ("impacts", impacts::trials(self.impacts)),
            ("shapes", folded::trials()),
        ]
        .into_iter()
        .flat_map(|(group, trials)| trials.into_iter().map(move |trial| (group, trial)))
        .collect()
    }
}

impl Study for Contact {
    fn work(&self) -> u64 {
        self.trials().len() as u64
    }

    fn measure(&self, watch: &Watch<'_>) -> Option<Findings> {
        let results = measure(self, watch)?;
        let tables = vec![("contact", results.table())];
        Some(Findings { text: results.text(), tables, page: Some(results.page()) })
    }
}

/// A world with a known outcome.
type Trial = Box<dyn Fn() -> Vec<Measured> + Send + Sync>;

/// A measured figure, and what is asked of it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Measured {
    what: String,
    pub(crate) value: f64,
    asked: Asked,
    /// Its point in a plot.
    point: Option<Point>,
}

/// What is asked of a figure.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Asked {
    AtMost(f64),
    /// A value, and the relative distance from it.
    Near(f64, f64),
    /// It is shown only.
    Nothing,
}

/// A point of a curve.
#[derive(Clone, Debug, PartialEq)]
struct Point {
    plot: &'static str,
    axes: [&'static str; 2],
    curve: String,
    at: [f64; 2],
}

impl Measured {
    fn most(what: String, value: f64, most: f64) -> Self {
        Self { what, value, asked: Asked::AtMost(most), point: None }
    }

    fn near(what: String, value: f64, wanted: f64, within: f64) -> Self {
        Self { what, value, asked: Asked::Near(wanted, within), point: None }
    }

    fn shown(what: String, value: f64) -> Self {
        Self { what, value, asked: Asked::Nothing, point: None }
    }

    /// With a point in a plot, on a curve.
    fn at(self, plot: &'static str, axes: [&'static str; 2], curve: &str, at: [f64; 2]) -> Self {
        Self { point: Some(Point { plot, axes, curve: curve.to_owned(), at }), ..self }
    }

    /// Whether what is asked holds; `None` if nothing is.
    pub(crate) fn holds(&self) -> Option<bool> {
        match self.asked {
            Asked::AtMost(most) => Some(self.value <= most),
            Asked::Near(wanted, within) => Some((self.value - wanted).abs() <= within * wanted.abs()),
            Asked::Nothing => None,
        }
    }

    fn asked(&self) -> String {
        match self.asked {
            Asked::AtMost(most) => format!("≤ {}", figure(most)),
            Asked::Near(wanted, within) => format!("{} ± {} %", figure(wanted), figure(100.0 * within)),
            Asked::Nothing => "–".to_owned(),
        }
    }
}

/// The findings, which do not depend on the machine.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Results {
    /// With their groups.
    pub(crate) all: Vec<(&'static str, Measured)>,
}

/// Measures on the thread pool of the caller; `None` if `watch` stops it.
pub(crate) fn measure(study: &Contact, watch: &Watch<'_>) -> Option<Results> {
    let trials = study.trials();
    let found = each(&trials, watch, |(_, trial)| trial())?;
    let named = trials.iter().zip(found).flat_map(|((group, _), all)| all.into_iter().map(|one| (*group, one)));
    Some(Results { all: named.collect() })
}

/// The groups of trials, with their headings.
const GROUPS: [(&str, &str); 6] = [
    ("impacts", "Impacts"),
    ("rest", "Piles and a tower"),
    ("slopes", "Slopes, sliding and rolling"),
    ("bars", "Bars and waves"),
    ("hertz", "A ball on a block"),
    ("shapes", "Sharp shapes, and bodies that meet themselves"),
];

impl Results {
    fn text(&self) -> String {
        let of = |group: &str| {
            let rows = self.all.iter().filter(|(of, _)| *of == group).map(|(_, one)| {
                let holds = one.holds().map_or("", |holds| if holds { "yes" } else { "**no**" });
                [
                    ("what", one.what.as_str().into()),
                    ("measured", figure(one.value).into()),
                    ("asked", one.asked().into()),
                    ("holds", Cell::from(holds)),
                ]
            });
            Table::of(rows).markdown(1)
        };
        let tables: Vec<_> = GROUPS.map(|(group, heading)| format!("## {heading}\n\n{}", of(group))).to_vec();
        let asked = self.all.iter().filter_map(|(_, one)| one.holds());
        let [asked, held] = [asked.clone().count(), asked.filter(|&holds| holds).count()];
        format!(include_str!("text.md"), tables = tables.join("\n\n"), held = held, asked = asked)
    }

    /// All numbers, with all digits.
    fn table(&self) -> Table {
        Table::of(self.all.iter().map(|(group, one)| {
            [
                ("group", (*group).into()),
                ("what", one.what.as_str().into()),
                ("measured", one.value.into()),
                ("asked", one.asked().into()),
                ("holds", one.holds().map(|holds| if holds { "yes" } else { "no" }).into()),
            ]
        }))
    }

    /// Curves of all figures that have a point.
    fn page(&self) -> Page {
        let mut plots: Vec<Plot> = Vec::new();
        for Point { plot: name, axes, curve, at } in self.all.iter().filter_map(|(_, one)| one.point.as_ref()) {
            let known = plots.iter().position(|plot| plot.name == *name).unwrap_or_else(|| {
                plots.push(Plot { name: (*name).to_owned(), axes: *axes, curves: Vec::new(), slopes: None });
                plots.len() - 1
            });
            let curves = &mut plots[known].curves;
            match curves.iter_mut().find(|line| line.name == *curve) {
                Some(line) => line.points.push(*at),
                None => {
                    let (name, family) = (curve.clone(), curve.clone());
                    curves.push(Line { name, family, is_strong: false, points: vec![*at] });
                }
            }
        }
        let caption = vec![
            "Each dot is one world with a closed form: a bar, a ball on a block, a body on a slope.".to_owned(),
            "Lines that fall to the right show errors that vanish with refinement.".to_owned(),
        ];
        Page { title: "Contact beside closed forms".to_owned(), caption, contents: Contents::Plots(plots) }
    }
}

#[cfg(test)]
#[path = "../../tests/inside/contact.rs"]
mod tests;
