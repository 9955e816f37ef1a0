//! The distribution of numbers.

/// Median, quartiles and range of some numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Spread {
    pub(crate) least: f64,
    /// The lower quartile.
    pub(crate) lower: f64,
    pub(crate) median: f64,
    /// The upper quartile.
    pub(crate) upper: f64,
    /// The greatest.
    pub(crate) most: f64,
}

impl Spread {
    /// The quantiles of `values`, interpolated linearly, as in most programs; NaN for no values.
    pub(crate) fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let mut sorted: Vec<f64> = values.into_iter().collect();
        sorted.sort_by(f64::total_cmp);
        let quantile = |quarters: usize| {
            let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
            let (below, rest) = (last * quarters / 4, (last * quarters % 4) as f64 / 4.0);
            // At an exact position the next value has no weight; it may be NaN.
            if rest == 0.0 {
                return sorted[below];
            }
            sorted[below] + (sorted[below + 1] - sorted[below]) * rest
        };
        let [least, lower, median, upper, most] = [0, 1, 2, 3, 4].map(quantile);
        Self { least, lower, median, upper, most }
    }
}

#[cfg(test)]
#[path = "../tests/inside/spread.rs"]
mod tests;
