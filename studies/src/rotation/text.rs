//! The results as text and as a table.

use super::degenerate::{CLASSES, Outcome};
use super::sample::{Kind, LEAST_GAP};
use super::{MANY, Measured, Results, Solver};
use crate::table::{Cell, Table};
use crate::turns::{kind_of_time, machine};

/// The strain and the largest increment (rad) of elements in a usual simulation.
const USUAL: (f64, f64) = (0.5, 0.3);

impl Results {
    /// The results as text.
    pub(super) fn text(&self) -> String {
        let (strain, _) = USUAL;
        let error = |one: &Measured| short(one.worst);
        let time = |one: &Measured| format!("{:.0} ({:.0}–{:.0})", one.time.median, one.time.lower, one.time.upper);
        format!(
            include_str!("text.md"),
            kind_of_time = kind_of_time(),
            machine = machine(),
            rounds = self.protocol.rounds,
            elements = self.protocol.elements * self.protocol.repeats as usize,
            default = self.about_the_default().unwrap_or_default(),
            strain = strain,
            errors = self.by_increment(strain, error).markdown(1),
            times = self.by_increment(strain, time).markdown(1),
            outcomes = self.robustness().markdown(1),
            nearest = Outcome::Nearest.words(),
            other = Outcome::Some.words(),
            wrong = Outcome::Wrong.words(),
            none = Outcome::NotANumber.words(),
            many = MANY,
        )
    }

    /// The error and the cost of the default, which justify it.
    fn about_the_default(&self) -> Option<String> {
        let number = self.solvers.iter().position(Solver::is_default)?;
        let printed = self.solvers.iter().position(Solver::is_printed)?;
        let (most_strain, most_increment) = USUAL;
        let is_usual = |kind: Kind| match kind {
            Kind::Warm { strain, increment } => strain <= most_strain && increment <= most_increment,
            Kind::Cold => false,
        };
        let of = |solver: usize| self.measured.iter().filter(move |one| one.solver == solver);
        let usual = |solver: usize| of(solver).filter(|one| is_usual(one.kind));
        let ratios = usual(number).zip(usual(printed)).map(|(one, other)| one.time.median / other.time.median);
        let [low, high] = ratios.fold([f64::INFINITY, 0.0], |[low, high]: [f64; 2], one| [low.min(one), high.max(one)]);
        let cold = of(number).find(|one| one.kind == Kind::Cold)?;
        Some(format!(
            "The default is `{}`. Its greatest error is {} rad for increments up to {most_increment} rad at strains up to \
            ±{most_strain}, and {} rad from any last rotation where the optimum is unique by {LEAST_GAP:e} of the largest \
            singular value; there {} % of the elements needed the global solver. It takes {low:.2} to {high:.2} of the time of two \
            passes of Eq. (15) as printed for increments up to {most_increment} rad.\n",
            self.solvers[number].name,
            short(usual(number).map(|one| one.worst).fold(0.0, f64::max)),
            short(cold.worst),
            (100.0 * cold.global?).round(),
        ))
    }

    /// A row for each solver with a cell for each increment at a strain, and for any elements.
    fn by_increment(&self, strain: f64, cell: impl Fn(&Measured) -> String) -> Table {
        let increments = &self.protocol.increments;
        let kinds = increments.iter().map(|&increment| Kind::Warm { strain, increment }).chain([Kind::Cold]);
        let row = |(number, solver): (usize, &Solver)| {
            let of = |kind: Kind| self.measured.iter().find(|one| one.solver == number && one.kind == kind);
            let cells = kinds.clone().map(|kind| of(kind).map(&cell).into());
            [solver.title().into()].into_iter().chain(cells).collect()
        };
        let columns = increments.iter().map(f64::to_string).chain(["any".to_owned()]);
        Table::wide(&["solver"], columns, self.solvers.iter().enumerate().map(row).collect())
    }

    /// A row for each solver, and a column for each class.
    fn robustness(&self) -> Table {
        let row = |(name, outcomes): &(&'static str, [Outcome; CLASSES.len()])| {
            [*name].into_iter().chain(outcomes.map(Outcome::words)).map(Cell::from).collect()
        };
        let columns = CLASSES.map(|(name, ..)| name.to_owned());
        Table::wide(&["solver"], columns, self.outcomes.iter().map(row).collect())
    }

    /// All numbers, with all digits.
    pub(super) fn table(&self) -> Table {
        let row = |one: &Measured| {
            let solver = &self.solvers[one.solver];
            let [strain, increment] = match one.kind {
                Kind::Warm { strain, increment } => [strain, increment].map(Cell::Given),
                Kind::Cold => ["any", "any"].map(Cell::from),
            };
            [
                ("solver", solver.name.into()),
                ("passes", solver.passes.into()),
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

/// An error with one digit.
fn short(error: f64) -> String {
    if error.is_finite() { format!("{error:.0e}") } else { "NaN".to_owned() }
}
