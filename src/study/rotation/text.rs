//! The results as Markdown, CSV and JSON.

use super::degenerate::{CLASSES, Outcome};
use super::sample::{Kind, LEAST_GAP};
use super::{MANY, Measured, Method, Results};
use crate::output::exact;
use crate::table::Sheet;
use serde_json::{Value, json};

/// The strain and the largest increment (rad) of elements that a simulation is expected to have.
const USUAL: (f64, f64) = (0.5, 0.3);

impl Results {
    /// The results for people; `mark` is the command that repeats them.
    pub(crate) fn markdown(&self, mark: &str, machine: &str) -> String {
        let protocol = &self.protocol;
        let time = if self.is_processor_time { "Processor" } else { "Wall" };
        let (strain, _) = USUAL;
        /// The increment of the errors by strain (rad).
        const INCREMENT: f64 = 0.1;
        let mut text = format!(
            "<!-- {mark} -->\n\
            # Solvers of rotations: error against time\n\n\
            {time} time of one thread on {machine}: medians of {} turns of {} elements each, in which all solvers take \
            turns. Other machines give other times, and much the same ratios. Errors are the greatest angles from the \
            optimum (rad), which is known to 1e-16; they are the same on every machine. `rotation` in scenes has these \
            names. Elements are cubes, stretched along random axes, and have turned by the increment since their last \
            rotation.\n\n",
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
    fn errors(&self, strain: f64) -> Sheet {
        let kinds = self.protocol.increments.iter().map(|&increment| Kind::Warm { strain, increment });
        let heads = self.protocol.increments.iter().map(f64::to_string).chain(["any".to_owned()]);
        self.table(heads, &kinds.chain([Kind::Cold]).collect::<Vec<_>>(), |one| short(one.worst))
    }

    /// The errors by strain at an increment (rad).
    fn errors_by_strain(&self, increment: f64) -> Sheet {
        let kinds = self.protocol.strains.iter().map(|&strain| Kind::Warm { strain, increment });
        let heads = self.protocol.strains.iter().map(f64::to_string);
        self.table(heads, &kinds.collect::<Vec<_>>(), |one| short(one.worst))
    }

    /// The times in the order of [`Self::errors`].
    fn times(&self, strain: f64) -> Sheet {
        let kinds = self.protocol.increments.iter().map(|&increment| Kind::Warm { strain, increment });
        let heads = self.protocol.increments.iter().map(f64::to_string).chain(["any".to_owned()]);
        self.table(heads, &kinds.chain([Kind::Cold]).collect::<Vec<_>>(), |one| {
            let time = one.time;
            format!("{:.0} ({:.0}–{:.0})", time.median, time.lower, time.upper)
        })
    }

    /// A row for each method, and a column for each kind of elements.
    fn table(&self, heads: impl Iterator<Item = String>, kinds: &[Kind], cell: impl Fn(&Measured) -> String) -> Sheet {
        let heads = ["solver".to_owned()].into_iter().chain(heads).collect();
        let row = |(number, method): (usize, &Method)| {
            let of = |kind: &Kind| self.measured.iter().find(|one| one.method == number && one.kind == *kind);
            let cells = kinds.iter().map(|kind| of(kind).map_or_else(String::new, &cell));
            [method.title()].into_iter().chain(cells).collect()
        };
        Sheet { heads, rows: self.methods.iter().enumerate().map(row).collect() }
    }

    /// A row for each solver, and a column for each class.
    fn robustness(&self) -> Sheet {
        let mut sheet = Sheet { heads: vec!["solver".to_owned()], rows: Vec::new() };
        sheet.heads.extend(CLASSES.map(|class| class.name.to_owned()));
        for (solver, outcomes) in &self.outcomes {
            let outcomes = outcomes.map(|outcome| outcome.words().to_owned());
            sheet.rows.push([solver.name().to_owned()].into_iter().chain(outcomes).collect());
        }
        sheet
    }

    /// All numbers, with all digits.
    pub(crate) fn csv(&self) -> String {
        let row = |one: &Measured| {
            let method = &self.methods[one.method];
            let (strain, increment) = match one.kind {
                Kind::Warm { strain, increment } => (strain.to_string(), increment.to_string()),
                Kind::Cold => ("any".to_owned(), "any".to_owned()),
            };
            [
                ("solver", method.name().to_owned()),
                ("passes", method.passes.map_or_else(String::new, |passes| passes.to_string())),
                ("strain", strain),
                ("increment_rad", increment),
                ("error_median_rad", exact(one.median)),
                ("error_worst_rad", exact(one.worst)),
                ("ns_median", exact(one.time.median)),
                ("ns_lower", exact(one.time.lower)),
                ("ns_upper", exact(one.time.upper)),
                ("ns_least", exact(one.time.least)),
                ("global_share", one.global.map_or_else(String::new, |share| share.to_string())),
            ]
        };
        Sheet::of(self.measured.iter().map(row)).csv()
    }

    /// The results as one JSON document.
    pub(crate) fn json(&self, machine: &str) -> Value {
        let row = |one: &Measured| {
            let method = &self.methods[one.method];
            let (strain, increment) = match one.kind {
                Kind::Warm { strain, increment } => (Some(strain), Some(increment)),
                Kind::Cold => (None, None),
            };
            json!({
                "solver": method.name(),
                "passes": method.passes,
                "strain": strain,
                "increment": increment,
                "error_median": one.median,
                "error_worst": one.worst,
                "ns": one.time,
                "global_share": one.global,
            })
        };
        let rows: Vec<_> = self.measured.iter().map(row).collect();
        let outcomes = self.outcomes.iter().map(|(solver, outcomes)| {
            let named = CLASSES.iter().zip(outcomes);
            let of_class = named.map(|(class, outcome)| (class.name.to_owned(), json!(outcome.words())));
            json!({ "solver": solver.name(), "outcomes": of_class.collect::<serde_json::Map<_, _>>() })
        });
        let facts = self.facts().map(|facts| {
            json!({
                "solver": facts.name,
                "error_warm": facts.warm,
                "error_cold": facts.cold,
                "global_share_cold": facts.global,
                "time_over_printed": facts.ratios,
            })
        });
        json!({ "machine": machine, "default": facts, "rows": rows, "degenerate": outcomes.collect::<Vec<_>>() })
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
