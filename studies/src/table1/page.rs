//! Table 1 as plots over k/m: for each row our median, least and greatest value of all starts, and the paper's number.

use super::printed::{Printed, ROWS};
use super::{Results, Summary};
use crate::page::{Contents, Line, Page, Plot};
use crate::spread::Spread;

impl Results {
    pub(super) fn page(&self) -> Page {
        let summaries = self.summaries();
        let plot = |name: &str, ours: fn(&Summary) -> Spread, paper: fn(Printed) -> Option<f64>| {
            let curves = ROWS.iter().flat_map(|row| {
                let of_row = summaries.iter().filter(|one| one.case.row.name == row.name);
                let printed: Vec<_> = of_row.filter_map(|one| Some((one, one.case.printed()?))).collect();
                let line = |name: String, is_strong, value: &dyn Fn(&Summary, Printed) -> Option<f64>| {
                    let point = |&(one, printed): &(&Summary, Printed)| {
                        Some([one.case.stiffness_over_mass(), value(one, printed)?])
                    };
                    Line {
                        name,
                        family: row.name.to_owned(),
                        is_strong,
                        points: printed.iter().filter_map(point).collect(),
                    }
                };
                [
                    line(String::new(), false, &|one, _| Some(ours(one).least)),
                    line(String::new(), false, &|one, _| Some(ours(one).most)),
                    line(row.name.to_owned(), true, &|one, _| Some(ours(one).median)),
                    line(format!("{}, paper", row.name), false, &|_, printed| paper(printed)),
                ]
            });
            let axes = ["k/m (1/s²)", "α (rad/s²)"];
            Plot { name: name.to_owned(), axes, curves: curves.collect(), slopes: None }
        };
        let starts = self.protocol.orientations;
        Page {
            title: "Table 1: errors of the rotations from Eq. (15)".to_owned(),
            caption: vec![
                format!(
                    "α of Eq. (18) in the {} s after the first contact, of a free falling cube. Thick: median over {starts} start{}, \
                     between the least and the greatest.",
                    self.protocol.duration,
                    if starts == 1 { "" } else { "s" },
                ),
                "The paper's numbers are of one start; those that it could not measure are left out.".to_owned(),
            ],
            contents: Contents::Plots(vec![
                plot("Mean of α", |one| one.mean, |printed| printed.mean),
                plot("Greatest α", |one| one.maximum, |printed| printed.maximum),
            ]),
        }
    }
}
