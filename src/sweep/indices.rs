//! First-order Sobol indices: the share of an output's variance that one input explains (`docs/method.md#103-statistics`).
//!
//! They are estimated from the runs of the sweep itself, by a one-way analysis of variance over bins of the input, and need no
//! further runs.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The most bins. The variance of a smooth output inside one of 24 bins is about a thousandth of the explained one.
const MOST_BINS: usize = 24;
/// The fewest runs a bin.
const LEAST_A_BIN: usize = 10;
/// The fewest runs for an estimate.
const LEAST_RUNS: usize = 2 * LEAST_A_BIN;

/// An index with its standard error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Index {
    /// The estimate. It is unbiased, so it may be below 0 where an input explains nothing.
    pub value: f64,
    /// Its standard error.
    pub error: f64,
}

impl Index {
    /// The sum of two indices of independent inputs.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self { value: self.value + other.value, error: self.error.hypot(other.error) }
    }
}

/// The first-order index `Var(E[y | x]) / Var(y)` of an input `x` for an output `y`; `None` for too few runs or an output that does
/// not vary.
///
/// The runs are sorted by `x` into bins of equal count, equal values in one bin. With `B` bins of the `n` runs and the mean squares
/// `b` between and `w` within the bins, the estimate of `Var(E[y | x])` is `(B - 1) (b - w) / n`: unbiased for an output that does
/// not vary with `x` inside a bin. With `S` the index and `v` the variance of `y`, the standard error is that for normal inputs and
/// outputs, `(1 - S) sqrt(2 w (2 b - w) (B - 1) / (n v)^2 + 4 S^2 / n)`.
#[must_use]
pub fn first_order(x: &[f64], y: &[f64]) -> Option<Index> {
    let n = x.len();
    if n < LEAST_RUNS || n != y.len() {
        return None;
    }
    let mean = y.iter().sum::<f64>() / n as f64;
    let total: f64 = y.iter().map(|value| (value - mean).powi(2)).sum();
    let bins = bins(x);
    // An output that differs by rounding alone does not vary.
    if total <= 1e-24 * (1.0 + mean * mean) * n as f64 || bins.len() < 2 {
        return None;
    }
    let sums = bins.iter().map(|bin| {
        let own = bin.iter().map(|&run| y[run]).sum::<f64>() / bin.len() as f64;
        bin.len() as f64 * (own - mean).powi(2)
    });
    let between: f64 = sums.sum();
    let (degrees, rest) = ((bins.len() - 1) as f64, (n - bins.len()) as f64);
    let (b, w) = (between / degrees, (total - between) / rest);
    let variance = total / (n - 1) as f64;
    let value = degrees * (b - w) / n as f64 / variance;
    let explained = value.clamp(0.0, 1.0);
    let of_bins = 2.0 * w * (2.0 * b - w).max(w) * degrees / (n as f64 * variance).powi(2);
    let error = (1.0 - explained) * (of_bins + 4.0 * explained * explained / n as f64).sqrt();
    Some(Index { value, error })
}

/// The runs of each bin.
fn bins(x: &[f64]) -> Vec<Vec<usize>> {
    let mut order: Vec<usize> = (0..x.len()).collect();
    order.sort_by(|&a, &b| x[a].total_cmp(&x[b]));
    let count = (x.len() / LEAST_A_BIN).clamp(2, MOST_BINS);
    let mut bins: Vec<Vec<usize>> = Vec::new();
    for (rank, &run) in order.iter().enumerate() {
        let begins = rank * count / x.len() != rank.saturating_sub(1) * count / x.len();
        let same = rank > 0 && x[order[rank - 1]] == x[run];
        match bins.last_mut() {
            Some(bin) if same || !begins && !is_tied(x, bin) => bin.push(run),
            _ => bins.push(vec![run]),
        }
    }
    bins
}

/// True for a bin that one value fills: the next value begins another.
fn is_tied(x: &[f64], bin: &[usize]) -> bool {
    bin.len() >= LEAST_A_BIN && bin.iter().all(|&run| x[run] == x[bin[0]])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        model::sweep::Sampling,
        sweep::{distribution::standard_normal, points::Points},
    };

    const RUNS: u64 = 20_000;

    /// Columns of independent numbers from 0 to 1.
    fn columns(dimensions: usize, seed: u64) -> Vec<Vec<f64>> {
        let points = Points::new(Sampling::Independent, seed, dimensions);
        let rows: Vec<Vec<f64>> = (0..RUNS).map(|index| points.point(index)).collect();
        (0..dimensions).map(|place| rows.iter().map(|row| row[place]).collect()).collect()
    }

    fn normals(dimensions: usize, seed: u64) -> Vec<Vec<f64>> {
        let columns = columns(dimensions, seed);
        columns.into_iter().map(|of| of.into_iter().map(standard_normal).collect()).collect()
    }

    /// Checks indices against closed forms, to four standard errors and the variance inside a bin: 1 % of the index.
    fn check(inputs: &[Vec<f64>], output: &[f64], expected: &[f64]) {
        for (place, (x, expected)) in inputs.iter().zip(expected).enumerate() {
            let Index { value, error } = first_order(x, output).unwrap();
            assert!(
                (value - expected).abs() < 4.0 * error + 0.01 * expected,
                "{place}: {value} +- {error}, {expected}"
            );
            assert!(error < 0.25 * expected + 0.01, "{place}: +- {error}");
        }
    }

    fn of<const N: usize>(inputs: &[Vec<f64>], output: impl Fn([f64; N]) -> f64) -> Vec<f64> {
        (0..RUNS as usize).map(|run| output(std::array::from_fn(|place| inputs[place][run]))).collect()
    }

    #[test]
    fn a_linear_output_has_the_shares_of_its_terms() {
        let inputs = normals(4, 1);
        let output = of(&inputs, |[a, b, c, _]: [f64; 4]| 3.0 * a - 2.0 * b + c);
        check(&inputs, &output, &[9.0 / 14.0, 4.0 / 14.0, 1.0 / 14.0, 0.0]);
    }

    #[test]
    fn ishigamis_function_has_the_published_indices() {
        // T. Ishigami, T. Homma 1990, with a = 7 and b = 0.1 on [-pi, pi]^3.
        let inputs = columns(3, 2);
        let to_pi = |u: f64| (2.0 * u - 1.0) * std::f64::consts::PI;
        let output = of(&inputs, |u: [f64; 3]| {
            let [x, y, z] = u.map(to_pi);
            x.sin() + 7.0 * y.sin().powi(2) + 0.1 * z.powi(4) * x.sin()
        });
        check(&inputs, &output, &[0.3139, 0.4424, 0.0]);
    }

    /// The slip load of a block between two pads, `2 mu N - m g`, with independent normal friction, grip force and mass: `Var =
    /// 4 (mu^2 s_N^2 + N^2 s_mu^2 + s_mu^2 s_N^2) + g^2 s_m^2`, of which friction alone explains `4 N^2 s_mu^2`.
    #[test]
    fn a_pinched_blocks_margin_has_the_closed_form() {
        let inputs = normals(3, 3);
        let ([mu, s_mu], [n, s_n], [m, s_m], g) = ([0.6, 0.09], [30.0, 3.0], [1.0, 0.2], 9.81);
        let output = of(&inputs, |[a, b, c]: [f64; 3]| 2.0 * (mu + s_mu * a) * (n + s_n * b) - (m + s_m * c) * g);
        let parts = [4.0 * (n * s_mu).powi(2), 4.0 * (mu * s_n).powi(2), (g * s_m).powi(2)];
        let whole = parts.iter().sum::<f64>() + 4.0 * (s_mu * s_n).powi(2);
        check(&inputs, &output, &parts.map(|part| part / whole));
    }

    #[test]
    fn an_input_of_few_values_has_a_bin_each() {
        let coins = columns(2, 4);
        let inputs: Vec<Vec<f64>> = coins.iter().map(|of| of.iter().map(|u| f64::from(*u < 0.3)).collect()).collect();
        // Variances of indicators are p (1 - p): 0.21 each, the second four times.
        let output = of(&inputs, |[a, b]: [f64; 2]| a + 2.0 * b);
        check(&inputs, &output, &[0.2, 0.8]);
        assert_eq!(bins(&inputs[0]).len(), 2);
    }

    #[test]
    fn a_small_sample_is_unbiased() {
        // An input that explains nothing, 200 samples of 60 runs: the mean of the indices is 0 within four of its standard errors.
        let values: Vec<f64> = (0..200)
            .map(|seed| {
                let inputs = normals(2, 1000 + seed);
                first_order(&inputs[0][..60], &inputs[1][..60]).unwrap().value
            })
            .collect();
        let mean = values.iter().sum::<f64>() / 200.0;
        let sd = (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / 199.0).sqrt();
        assert!(mean.abs() < 4.0 * sd / 200.0_f64.sqrt(), "{mean} +- {sd}");
    }

    #[test]
    fn there_is_no_index_without_variance_or_runs() {
        let x: Vec<f64> = (0..50).map(f64::from).collect();
        assert_eq!(first_order(&x, &[0.3; 50]), None);
        assert_eq!(first_order(&[0.3; 50], &x), None);
        assert_eq!(first_order(&x[..19], &x[..19]), None);
    }
}
