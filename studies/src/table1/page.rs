//! Table 1 as a figure: our range on logarithmic axes, the paper's number as a ring.

use super::{Results, Summary};
use crate::page::{Ranges, RangesRow, power_of_ten};
use crate::spread::Spread;

impl Results {
    pub(super) fn page(&self) -> Ranges {
        let summaries = self.summaries();
        let ours: Vec<_> = summaries.iter().filter_map(|one| Some((one, one.case.printed()?))).collect();
        let same = |(one, _): &&(&Summary, _), (other, _): &&(&Summary, _)| one.case.stiffness == other.case.stiffness;
        let groups = ours.chunk_by(|one, other| same(&one, &other)).map(|group| {
            let power = group[0].0.case.stiffness_over_mass().log10().round() as i32;
            let rows = group.iter().map(|(summary, printed)| {
                let Summary { case, mean, maximum, .. } = summary;
                let passes = match case.row.passes {
                    1 => "1 pass".to_owned(),
                    passes => format!("{passes} passes"),
                };
                let range = |spread: &Spread| [spread.least, spread.median, spread.most];
                RangesRow {
                    letter: case.row.name,
                    words: format!("{passes}, ΔT {} ms", (case.step() * 1e6).round() / 1e3),
                    numbers: vec![(range(mean), printed.mean), (range(maximum), printed.maximum)],
                }
            });
            (format!("k/m = {} s⁻²", power_of_ten(power)), rows.collect())
        });
        let starts = self.protocol.orientations;
        let plural = if starts == 1 { "" } else { "s" };
        Ranges {
            title: "Table 1: errors of the rotations from Eq. (15)".to_owned(),
            caption: vec![
                format!(
                    "α of Eq. (18) in the {} s after the first contact, of a free falling cube.",
                    self.protocol.duration
                ),
                "Without a ring: too small for the paper to measure.".to_owned(),
            ],
            key: [format!("here: range and median over {starts} start{plural}"), "paper: one start".to_owned()],
            axes: vec!["mean of α (rad/s²)".to_owned(), "greatest α (rad/s²)".to_owned()],
            groups: groups.collect(),
        }
    }
}
