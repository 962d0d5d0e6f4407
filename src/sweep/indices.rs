//! First-order Sobol indices: the share of an output's variance that one input explains (`docs/method.md#103-statistics`).
//!
//! They are estimated from the runs of the sweep itself, by a one-way analysis of variance over bins of the input, and need no
//! further runs.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::distribution::standard_normal;

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
/// not vary with `x` inside a bin. With `S` the index, `v` the variance of `y` and `d` the deviation of a bin's mean from that of all,
/// drawn in by `1 - w / b`, what one run adds to the estimate is `f = (d^2 + 2 d (y - mean - d) - S (y - mean)^2) / v` (the influence
/// function), and the standard error `sqrt(2 (B - 1) (w / n v)^2 + Var(f) / n)`. It holds for any distribution, such as the
/// indicator of a rare event.
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
    let deviation = |bin: &[usize]| bin.iter().map(|&run| y[run] - mean).sum::<f64>() / bin.len() as f64;
    let between: f64 = bins.iter().map(|bin| bin.len() as f64 * deviation(bin).powi(2)).sum();
    let (degrees, rest) = ((bins.len() - 1) as f64, (n - bins.len()) as f64);
    let (b, w) = (between / degrees, (total - between) / rest);
    let variance = total / (n - 1) as f64;
    let value = degrees * (b - w) / n as f64 / variance;
    let kept = if b > w { 1.0 - w / b } else { 0.0 };
    let influences = bins.iter().flat_map(|bin| {
        let d = kept * deviation(bin);
        bin.iter().map(move |&run| {
            let own = y[run] - mean;
            (d * d + 2.0 * d * (own - d) - value.clamp(0.0, 1.0) * own * own) / variance
        })
    });
    let [sum, squares] = influences.fold([0.0, 0.0], |[sum, squares], f| [sum + f, squares + f * f]);
    let of_runs = (squares - sum * sum / n as f64) / (n as f64 * n as f64);
    let of_bins = 2.0 * degrees * (w / (n as f64 * variance)).powi(2);
    Some(Index { value, error: (of_bins + of_runs.max(0.0)).sqrt() })
}

/// Independent inputs in place of inputs that a Gaussian copula correlates equally, one column each: the mean of their normal
/// scores, and of each but the first the difference of its score from the mean of those before it. Indices of correlated inputs
/// must not be added, since they count what the inputs have in common once for each; those of these columns can be.
#[must_use]
pub fn decorrelated(columns: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let scores: Vec<Vec<f64>> = columns.iter().map(|column| normal_scores(column)).collect();
    let mean_of = |first: usize, run: usize| scores[..first].iter().map(|of| of[run]).sum::<f64>() / first as f64;
    let column = |place: usize| {
        let difference = |run: usize| match place {
            0 => mean_of(scores.len(), run),
            _ => scores[place][run] - mean_of(place, run),
        };
        (0..columns[place].len()).map(difference).collect()
    };
    (0..columns.len()).map(column).collect()
}

/// The normal quantile at the rank of each value; equal values have that of their mean rank.
fn normal_scores(x: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..x.len()).collect();
    order.sort_by(|&a, &b| x[a].total_cmp(&x[b]));
    let mut scores = vec![0.0; x.len()];
    let mut before = 0;
    for equal in order.chunk_by(|&a, &b| x[a] == x[b]) {
        let rank = before as f64 + equal.len() as f64 / 2.0;
        equal.iter().for_each(|&run| scores[run] = standard_normal(rank / x.len() as f64));
        before += equal.len();
    }
    scores
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
    use crate::{model::sweep::Sampling, sweep::points::Points};

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

    /// Inputs with the correlation r that explain all of `sum of c x`: the indices of the inputs themselves, `(c_i + r sum of the
    /// others)^2 / Var`, add up to more than 1, those of the independent columns to 1.
    #[test]
    fn what_correlated_inputs_share_is_counted_once() {
        let (r, factors) = (0.8_f64, [1.0, 2.0, -0.5]);
        let normals = normals(4, 5);
        let mixed = |place: usize| {
            let of = |run: usize| r.sqrt() * normals[3][run] + (1.0 - r).sqrt() * normals[place][run];
            (0..RUNS as usize).map(of).collect::<Vec<_>>()
        };
        let inputs: Vec<Vec<f64>> = (0..3).map(mixed).collect();
        let output = of(&inputs, |x: [f64; 3]| x.iter().zip(factors).map(|(x, factor)| x * factor).sum());
        let sum_of = |columns: &[Vec<f64>]| {
            let all = columns.iter().map(|column| first_order(column, &output).unwrap());
            all.reduce(Index::and).unwrap()
        };
        let variance: f64 =
            (0..3).flat_map(|a| (0..3).map(move |b| factors[a] * factors[b] * if a == b { 1.0 } else { r })).sum();
        let twice: f64 = (0..3)
            .map(|own| {
                let covariance: f64 = (0..3).map(|b| factors[b] * if own == b { 1.0 } else { r }).sum();
                covariance.powi(2) / variance
            })
            .sum();
        assert!(twice > 2.0 && (sum_of(&inputs).value - twice).abs() < 0.03 * twice, "{twice}");
        let columns = decorrelated(&inputs);
        // Four standard errors, and the variance inside a bin.
        let found = sum_of(&columns);
        assert!((found.value - 1.0).abs() < 4.0 * found.error + 0.01, "{found:?}");
        for [a, b] in [[0, 1], [0, 2], [1, 2]] {
            let product = columns[a].iter().zip(&columns[b]).map(|(a, b)| a * b).sum::<f64>() / RUNS as f64;
            // Four standard errors of the mean of a product of variances of at most 1.
            assert!(product.abs() < 4.0 / (RUNS as f64).sqrt(), "{a} {b}: {product}");
        }
    }

    #[test]
    fn equal_values_have_equal_scores() {
        let scores = normal_scores(&[2.0, 1.0, 2.0, 5.0]);
        // Ranks 0.5, 2 (twice) and 3.5 of 4.
        assert_eq!(scores, [0.5, 0.125, 0.5, 0.875].map(standard_normal));
    }

    /// The stated errors are those that repeated samples show, for linear outputs and for indicators of common and rare events.
    #[test]
    fn the_standard_error_is_that_of_repeated_samples() {
        let thresholds = [None, Some(0.0), Some(1.645), Some(2.054)];
        for (threshold, runs) in thresholds.into_iter().flat_map(|of| [(of, 1000), (of, 4000)]) {
            // An input that explains 0.64 of a normal number, and one that explains nothing.
            let found: Vec<[Index; 2]> = (0..300)
                .map(|seed| {
                    let points = Points::new(Sampling::Independent, 77 + seed, 3);
                    let rows = (0..runs).map(|index| points.point(index).into_iter().map(standard_normal));
                    let rows: Vec<Vec<f64>> = rows.map(Iterator::collect).collect();
                    let output = rows.iter().map(|row| 0.8 * row[0] + 0.6 * row[1]);
                    let output = output.map(|y| threshold.map_or(y, |at| f64::from(y < at)));
                    let output: Vec<f64> = output.collect();
                    [0, 2].map(|place| {
                        let input: Vec<f64> = rows.iter().map(|row| row[place]).collect();
                        first_order(&input, &output).unwrap()
                    })
                })
                .collect();
            for place in 0..2 {
                let mean = found.iter().map(|of| of[place].value).sum::<f64>() / 300.0;
                let sd = (found.iter().map(|of| (of[place].value - mean).powi(2)).sum::<f64>() / 299.0).sqrt();
                let stated = found.iter().map(|of| of[place].error).sum::<f64>() / 300.0;
                println!("{threshold:?} {runs} {place}: {mean:.4}, sd {sd:.4}, stated {stated:.4}");
                // A standard deviation of 300 samples is known to about 5 %, three times that; rare events are skewed.
                assert!((0.8..1.5).contains(&(stated / sd)), "{threshold:?} {runs} {place}: {stated} {sd}");
            }
        }
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

    /// An input that the output does not depend on explains nothing, whatever pair of columns of independent points is taken. (Some
    /// pairs of columns of a hundred Sobol points feign an index of a half: docs/method.md#103-statistics.)
    #[test]
    fn independent_points_do_not_feign_an_index() {
        for runs in [100, 256, 360, 600] {
            let columns = normals(33, 8);
            for (place, output) in columns.iter().enumerate() {
                let others = columns.iter().enumerate().filter(|(other, _)| *other != place);
                for (other, input) in others {
                    let Index { value, error } = first_order(&input[..runs], &output[..runs]).unwrap();
                    // Sums of some squares: among 1056 pairs the largest is five standard errors.
                    assert!(value < 6.0 * error, "{runs} runs: {other} for {place}: {value} +- {error}");
                }
            }
        }
    }

    #[test]
    fn there_is_no_index_without_variance_or_runs() {
        let x: Vec<f64> = (0..50).map(f64::from).collect();
        assert_eq!(first_order(&x, &[0.3; 50]), None);
        assert_eq!(first_order(&[0.3; 50], &x), None);
        assert_eq!(first_order(&x[..19], &x[..19]), None);
    }
}
