//! The results as text and as a table.

use super::degenerate::{CLASSES, Outcome};
use super::sample::{Kind, LEAST_GAP};
use super::{MANY, Measured, Method, Results};
use crate::study::Findings;
use crate::table::{Cell, Table};
use crate::turns::{kind_of_time, machine};

/// The strain and the largest increment (rad) of elements that a simulation is expected to have.
const USUAL: (f64, f64) = (0.5, 0.3);

impl Results {
    pub(super) fn findings(&self) -> Findings {
        Findings {
            text: self.text(),
            tables: vec![("rotation", self.table())],
            #[cfg(feature = "render")]
            pages: vec![("rotation", Box::new(self.page()))],
        }
    }

    /// The results for people.
    pub(super) fn text(&self) -> String {
        let protocol = &self.protocol;
        let (strain, _) = USUAL;
        /// The increment of the errors by strain (rad).
        const INCREMENT: f64 = 0.1;
        let mut text = format!(
            "# Solvers of rotations: error against time\n\n\
            Times are {} time of one thread on {}: medians of {} turns of {} elements each, in which all solvers take \
            turns. Other machines give other times, and much the same ratios. Errors are the greatest angles from the \
            optimum (rad), which is known to 1e-16; they are the same on every machine. Elements are cubes, stretched along random axes, and have turned by the increment since their last \
            rotation.\n\n",
            kind_of_time(),
            machine(),
            protocol.rounds,
            protocol.elements * protocol.repeats as usize,
        );
        text += &self.about_the_default();
        text += &format!("\n## Error (rad) at strains up to ±{strain}, for increments of so many radians\n\n");
        text += &self.errors(strain).markdown(1);
        text += "\n`any` are elements of all shapes, also flat, thin and inverted ones, from any last rotation, with a \
            unique optimum.\n";
        text += &format!("\n## Error (rad) for increments of {INCREMENT} rad, at strains of up to\n\n");
        text += &self.errors_by_strain(INCREMENT).markdown(1);
        text += "\nAt 1 one stretch is zero, so that elements are flat; beyond, it is negative, and they are turned inside \
            out.\n";
        text +=
            "\n## Time (ns for each element) for the elements of the first table, with quartiles in parentheses\n\n";
        text += &self.times(strain).markdown(1);
        text += "\n## Degenerate elements, from any last rotation\n\n";
        text += &self.robustness().markdown(1);
        text += &format!(
            "\n`{}`: the optimum, and where there are several the one nearest to the last rotation; `{}`: one of several, \
            but not the nearest; `{}`: a rotation that is no optimum; `{}`: not a number. Iterations have {MANY} passes. \
            `arctangent`, `vector-length`, `symmetric`, `cayley` and `quintic` go over to `davenport` \
            where the Hessian is not positive definite; what `linear-update` makes is no rotation, and the one nearest \
            to it is shown.\n",
            Outcome::Nearest.words(),
            Outcome::Some.words(),
            Outcome::Wrong.words(),
            Outcome::NotANumber.words(),
        );
        text
    }

    /// The errors and the cost of the default, as far as they decide for it.
    fn about_the_default(&self) -> String {
        let Some(facts) = self.facts() else { return String::new() };
        let (strain, increment) = USUAL;
        format!(
            "The default is `{}`. Its greatest error is {} rad for increments up to {increment} rad at strains up to \
            ±{strain}, and {} rad from any last rotation where the optimum is unique by {LEAST_GAP:e} of the largest \
            singular value; there {} % of the elements needed the global solver. It takes {} to {} of the time of two \
            passes of Eq. (15) as printed for increments up to {increment} rad.\n",
            facts.name,
            short(facts.warm),
            short(facts.cold),
            (100.0 * facts.global).round(),
            ratio(facts.ratios[0]),
            ratio(facts.ratios[1]),
        )
    }

    fn facts(&self) -> Option<Facts> {
        let number = self.methods.iter().position(Method::is_default)?;
        let printed = self.methods.iter().position(Method::is_printed)?;
        let usual = |kind: Kind| match kind {
            Kind::Warm { strain, increment } => strain <= USUAL.0 && increment <= USUAL.1,
            Kind::Cold => false,
        };
        let of = |method: usize| self.measured.iter().filter(move |one| one.method == method && usual(one.kind));
        let ratios = of(number).zip(of(printed)).map(|(one, other)| one.time.median / other.time.median);
        let ends = ratios.fold([f64::INFINITY, 0.0], |[low, high]: [f64; 2], one| [low.min(one), high.max(one)]);
        let cold = self.cold(number)?;
        Some(Facts {
            name: self.methods[number].name().to_owned(),
            warm: of(number).map(|one| one.worst).fold(0.0, f64::max),
            cold: cold.worst,
            global: cold.global?,
            ratios: ends,
        })
    }

    /// The errors by increment at a strain, and of any elements.
    fn errors(&self, strain: f64) -> Table {
        let kinds = self.protocol.increments.iter().map(|&increment| Kind::Warm { strain, increment });
        let heads = self.protocol.increments.iter().map(f64::to_string).chain(["any".to_owned()]);
        self.of_kinds(heads, &kinds.chain([Kind::Cold]).collect::<Vec<_>>(), |one| short(one.worst))
    }

    /// The errors by strain at an increment (rad).
    fn errors_by_strain(&self, increment: f64) -> Table {
        let kinds = self.protocol.strains.iter().map(|&strain| Kind::Warm { strain, increment });
        let heads = self.protocol.strains.iter().map(f64::to_string);
        self.of_kinds(heads, &kinds.collect::<Vec<_>>(), |one| short(one.worst))
    }

    /// The times in the order of [`Self::errors`].
    fn times(&self, strain: f64) -> Table {
        let kinds = self.protocol.increments.iter().map(|&increment| Kind::Warm { strain, increment });
        let heads = self.protocol.increments.iter().map(f64::to_string).chain(["any".to_owned()]);
        self.of_kinds(heads, &kinds.chain([Kind::Cold]).collect::<Vec<_>>(), |one| {
            let time = one.time;
            format!("{:.0} ({:.0}–{:.0})", time.median, time.lower, time.upper)
        })
    }

    /// A row for each method, and a column for each kind of elements.
    fn of_kinds(
        &self,
        heads: impl Iterator<Item = String>,
        kinds: &[Kind],
        cell: impl Fn(&Measured) -> String,
    ) -> Table {
        let heads = ["solver".to_owned()].into_iter().chain(heads).collect();
        let row = |(number, method): (usize, &Method)| {
            let of = |kind: &Kind| self.measured.iter().find(|one| one.method == number && one.kind == *kind);
            let cells = kinds.iter().map(|kind| of(kind).map(&cell).into());
            [method.title().into()].into_iter().chain(cells).collect()
        };
        Table { heads, rows: self.methods.iter().enumerate().map(row).collect() }
    }

    /// A row for each solver, and a column for each class.
    fn robustness(&self) -> Table {
        let heads = ["solver"].into_iter().chain(CLASSES.map(|class| class.name)).map(str::to_owned);
        let row = |(solver, outcomes): &(Method, [Outcome; CLASSES.len()])| {
            [solver.name()].into_iter().chain(outcomes.map(Outcome::words)).map(Cell::from).collect()
        };
        Table { heads: heads.collect(), rows: self.outcomes.iter().map(row).collect() }
    }

    /// All numbers, with all digits.
    pub(super) fn table(&self) -> Table {
        let row = |one: &Measured| {
            let method = &self.methods[one.method];
            let [strain, increment] = match one.kind {
                Kind::Warm { strain, increment } => [strain, increment].map(Cell::Given),
                Kind::Cold => ["any", "any"].map(Cell::from),
            };
            [
                ("solver", method.name().into()),
                ("passes", method.passes.into()),
                ("strain", strain),
                ("increment_rad", increment),
                ("error_median_rad", one.median.into()),
                ("error_worst_rad", one.worst.into()),
                ("ns_median", one.time.median.into()),
                ("ns_lower", one.time.lower.into()),
                ("ns_upper", one.time.upper.into()),
                ("ns_least", one.time.least.into()),
                ("global_share", one.global.map_or(Cell::Empty, Cell::Given)),
            ]
        };
        Table::of(self.measured.iter().map(row))
    }
}

/// What decides for the default.
struct Facts {
    name: String,
    /// The greatest errors of usual elements and from any last rotation (rad).
    warm: f64,
    cold: f64,
    /// The share of the latter that needed the global solver.
    global: f64,
    /// The least and the greatest ratio of its time to that of two printed passes.
    ratios: [f64; 2],
}

/// An error with one digit.
fn short(error: f64) -> String {
    if error.is_finite() { format!("{error:.0e}") } else { "NaN".to_owned() }
}

fn ratio(number: f64) -> String {
    format!("{number:.2}")
}
