//! How far figures of sweeps move by chance.

/// The interval of the difference `second - first` of two probabilities with their intervals `[probability, low, high]`: Newcombe's
/// method 10 (Interval estimation for the difference between independent proportions, Statistics in Medicine 17, 1998), with the
/// confidence of both intervals.
#[must_use]
pub fn difference(first: [f64; 3], second: [f64; 3]) -> [f64; 2] {
    let ([p1, low1, high1], [p2, low2, high2]) = (first, second);
    let by = p2 - p1;
    [by - (p2 - low2).hypot(high1 - p1), by + (high2 - p2).hypot(p1 - low1)]
}

/// The standard error of a quantile at the probability `p` of this many values, `sqrt(p (1 - p) / n) / f`; `spread` is `1 / f`, the
/// derivative of the quantile by the probability.
#[must_use]
pub fn quantile_error(p: f64, runs: u64, spread: f64) -> f64 {
    (p * (1.0 - p) / runs.max(1) as f64).sqrt() * spread
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::interval::wilson;

    #[test]
    fn the_interval_of_a_difference_is_the_published_one() {
        // Newcombe 1998, table II, method 10: 56/70 - 48/80, 9/10 - 3/10, 10/10 - 0/20 at 95 %.
        for ((a, m), (b, n), ends) in [
            ((56.0, 70.0), (48.0, 80.0), [0.0524, 0.3339]),
            ((9.0, 10.0), (3.0, 10.0), [0.1705, 0.8090]),
            ((10.0, 10.0), (0.0, 20.0), [0.6791, 1.0000]),
        ] {
            let of = |seen: f64, count: f64| {
                let [low, high] = wilson(seen / count, count, 0.95);
                [seen / count, low, high]
            };
            let found = difference(of(b, n), of(a, m));
            for (found, expected) in found.into_iter().zip(ends) {
                assert!((found - expected).abs() < 6e-5, "{a}/{m} - {b}/{n}: {found} {expected}");
            }
        }
    }

    #[test]
    fn the_median_of_uniform_values_has_the_known_error() {
        // Uniform from 0 to 2: the derivative of the quantile is 2, and the error 1 / sqrt(n).
        assert!((quantile_error(0.5, 400, 2.0) - 0.05).abs() < 1e-15);
    }
}
