//! Table 1 of the paper (section 4), as printed.

/// Mean, standard deviation and maximum of α (rad/s²), as printed; `None` if it was too small for the paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Printed {
    pub(crate) mean: Option<f64>,
    pub(crate) deviation: Option<f64>,
    /// max(α).
    pub(crate) maximum: Option<f64>,
}

/// One row of the paper's Table 1 for all its k/m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PrintedRow {
    /// Its letter.
    pub(crate) name: &'static str,
    /// "Number of iteration": the number of passes, each of which solves Eq. (15), at each evaluation.
    pub(crate) passes: u32,
    /// For each of [`STIFFNESSES`] the time step ΔT (s), as printed, and the paper's results.
    pub(crate) cases: [(f64, Printed); 3],
}

/// The ratios k/m of the paper (1/s²), in its order.
pub(crate) const STIFFNESSES: [f64; 3] = [1e4, 1e5, 1e6];

/// The paper's Table 1 as printed.
pub(crate) const ROWS: [PrintedRow; 4] = {
    /// A value that was too small for the paper to measure.
    const LESS: f64 = 0.0;
    const fn measured(number: f64) -> Option<f64> {
        if number > LESS { Some(number) } else { None }
    }
    const fn case(step: f64, [mean, deviation, maximum]: [f64; 3]) -> (f64, Printed) {
        (step, Printed { mean: measured(mean), deviation: measured(deviation), maximum: measured(maximum) })
    }
    let a = [
        case(0.006, [4.52554, 4.49862, 30.87597]),
        case(0.002, [1.987712, 1.68312, 9.119262]),
        case(0.0006, [1.301888, 1.297613, 7.570902]),
    ];
    let b = [
        case(0.0006, [0.032915, 0.037503, 0.320008]),
        case(0.0002, [0.030974, 0.028445, 0.157926]),
        case(0.00006, [0.005511, 0.005129, 0.034552]),
    ];
    let c =
        [case(0.006, [0.000493, 0.00211, 0.060352]), case(0.002, [LESS, 0.000001, 0.000017]), case(0.0006, [LESS; 3])];
    let d = [case(0.006, [LESS, LESS, 0.000001]), case(0.002, [LESS; 3]), case(0.0006, [LESS; 3])];
    [
        PrintedRow { name: "A", passes: 1, cases: a },
        PrintedRow { name: "B", passes: 1, cases: b },
        PrintedRow { name: "C", passes: 2, cases: c },
        PrintedRow { name: "D", passes: 3, cases: d },
    ]
};

/// A number in the paper's format: three digits, or fewer if its six decimals end before.
pub(super) fn as_printed(number: f64) -> String {
    let short = format!("{number:.2e}");
    let exponent = short.split_once('e').and_then(|(_, exponent)| exponent.parse::<i32>().ok()).unwrap_or(0);
    format!("{number:.*}", (2 - exponent).clamp(0, 6) as usize)
}

#[cfg(test)]
#[path = "../../tests/inside/table1_printed.rs"]
mod tests;
