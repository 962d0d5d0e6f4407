//! Intervals of a probability that was counted (`docs/method.md#103-statistics`).

use super::distribution::standard_normal;

/// Accuracy of a bound by bisection.
const BISECTIONS: u32 = 60;

/// Two ends of an interval.
pub type Ends = [f64; 2];

/// The interval of Wilson (1927) of a probability that was seen in the share `share` of `count` independent cases:
///
/// `(p + z^2 / 2n ± z sqrt(p (1 - p) / n + z^2 / 4n^2)) / (1 + z^2 / n)`, `z` the normal quantile of `(1 + confidence) / 2`.
/// Without cases it is from 0 to 1.
#[must_use]
pub fn wilson(share: f64, count: f64, confidence: f64) -> Ends {
    if count <= 0.0 {
        return [0.0, 1.0];
    }
    let z = standard_normal((1.0 + confidence) / 2.0);
    let (z2, n) = (z * z, count);
    let centre = share + z2 / (2.0 * n);
    let half = z * (share * (1.0 - share) / n + z2 / (4.0 * n * n)).sqrt();
    [((centre - half) / (1.0 + z2 / n)).max(0.0), ((centre + half) / (1.0 + z2 / n)).min(1.0)]
}

/// The upper bound of Clopper and Pearson (1934) of a probability that was seen in `seen` of `count` cases: with it so few, or
/// fewer, have the probability `1 - confidence`. 1 without cases.
#[must_use]
pub fn upper_bound(seen: u64, count: u64, confidence: f64) -> f64 {
    if seen >= count {
        return 1.0;
    }
    where_at_most(seen, count, 1.0 - confidence)
}

/// The lower bound of Clopper and Pearson (1934): with it so many, or more, have the probability `1 - confidence`. 0 without cases.
#[must_use]
pub fn lower_bound(seen: u64, count: u64, confidence: f64) -> f64 {
    if seen == 0 {
        return 0.0;
    }
    where_at_most(seen - 1, count, confidence)
}

/// The probability of a case with which at most `seen` of `count`, fewer than all, occur with the probability `share`.
fn where_at_most(seen: u64, count: u64, share: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..BISECTIONS {
        let middle = (low + high) / 2.0;
        if at_most(seen, count, middle) > share { low = middle } else { high = middle }
    }
    high
}

/// The probability that at most `seen` of `count` independent cases with this probability occur.
#[must_use]
pub fn at_most(seen: u64, count: u64, probability: f64) -> f64 {
    (0..=seen.min(count)).map(|k| exactly(k, count, probability)).sum::<f64>().min(1.0)
}

/// The probability that exactly `seen` of `count` independent cases with this probability occur.
#[must_use]
pub fn exactly(seen: u64, count: u64, probability: f64) -> f64 {
    let (k, n) = (seen as f64, count as f64);
    let choices = libm::lgamma(n + 1.0) - libm::lgamma(k + 1.0) - libm::lgamma(n - k + 1.0);
    // 0 ln 0 is 0.
    let times = |many: f64, log: f64| if many == 0.0 { 0.0 } else { many * log };
    libm::exp(choices + times(k, libm::log(probability)) + times(n - k, libm::log1p(-probability)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wilsons_interval_is_the_published_one() {
        // R. G. Newcombe, Two-sided confidence intervals for the single proportion, Statistics in Medicine 17 (1998), table I,
        // method 3: 81/263, 15/148, 0/20 and 1/29 at 95 %.
        for (seen, count, ends) in [
            (81.0, 263.0, [0.2553, 0.3662]),
            (15.0, 148.0, [0.0624, 0.1605]),
            (0.0, 20.0, [0.0, 0.1611]),
            (1.0, 29.0, [0.0061, 0.1718]),
        ] {
            let found = wilson(seen / count, count, 0.95);
            for (found, expected) in found.into_iter().zip(ends) {
                assert!((found - expected).abs() < 5.1e-5, "{seen}/{count}: {found} {expected}");
            }
        }
        assert_eq!(wilson(0.5, 0.0, 0.95), [0.0, 1.0]);
    }

    #[test]
    fn the_upper_bound_has_its_probability() {
        for (seen, count) in [(0, 1), (0, 300), (3, 300), (40, 80), (7, 100_000)] {
            let bound = upper_bound(seen, count, 0.975);
            assert!((at_most(seen, count, bound) - 0.025).abs() < 1e-6, "{seen} of {count}: {bound}");
        }
        // The rule of three: 1 - 0.05^(1/n).
        assert!((upper_bound(0, 300, 0.95) - (1.0 - 0.05_f64.powf(1.0 / 300.0))).abs() < 1e-9);
        assert_eq!((upper_bound(5, 5, 0.95), upper_bound(0, 0, 0.95)), (1.0, 1.0));
    }

    #[test]
    fn both_bounds_mirror_each_other_and_cover_at_least_as_often_as_they_say() {
        assert_eq!((lower_bound(0, 5, 0.95), lower_bound(0, 0, 0.95)), (0.0, 0.0));
        // All of n: 0.05^(1/n).
        assert!((lower_bound(30, 30, 0.95) - 0.05_f64.powf(1.0 / 30.0)).abs() < 1e-12);
        for (seen, count) in [(1, 2), (3, 20), (40, 80), (299, 300)] {
            let mirrored = 1.0 - upper_bound(count - seen, count, 0.975);
            assert!((lower_bound(seen, count, 0.975) - mirrored).abs() < 1e-12, "{seen} of {count}");
        }
        for count in [1_u64, 10, 120] {
            let bounds: Vec<_> =
                (0..=count).map(|seen| (lower_bound(seen, count, 0.9), upper_bound(seen, count, 0.9))).collect();
            for part in 1..40 {
                let p = f64::from(part) / 40.0;
                let covered = |holds: &dyn Fn(&(f64, f64)) -> bool| -> f64 {
                    let of = bounds.iter().enumerate().filter(|(_, bound)| holds(bound));
                    of.map(|(seen, _)| exactly(seen as u64, count, p)).sum()
                };
                // Rounding of the sum, and of bounds that are equal to the probability.
                assert!(covered(&|bound| bound.0 <= p + 1e-12) >= 0.9 - 1e-9, "{count} {p}");
                assert!(covered(&|bound| bound.1 >= p - 1e-12) >= 0.9 - 1e-9, "{count} {p}");
            }
        }
    }

    #[test]
    fn the_probabilities_of_all_counts_sum_to_one() {
        for (count, probability) in [(1, 0.3), (50, 0.0), (50, 1.0), (400, 0.98), (2000, 0.5)] {
            let all: f64 = (0..=count).map(|seen| exactly(seen, count, probability)).sum();
            // Rounding of lgamma, 1e-15 of values of up to 1e4.
            assert!((all - 1.0).abs() < 1e-10, "{count} {probability}: {all}");
        }
    }

    /// The exact probability that Wilson's interval contains the true one is near the confidence, for all of a range.
    #[test]
    fn wilsons_interval_covers_as_often_as_it_says() {
        for count in [20_u64, 100, 1000] {
            let mut total = 0.0;
            let probabilities: Vec<f64> = (1..100).map(|part| f64::from(part) / 100.0).collect();
            for &p in &probabilities {
                let contains = |seen: &u64| {
                    let [low, high] = wilson(*seen as f64 / count as f64, count as f64, 0.95);
                    (low..=high).contains(&p)
                };
                let covered: f64 = (0..=count).filter(contains).map(|seen| exactly(seen, count, p)).sum();
                // Agresti and Coull 1998: near 0 and 1 it falls to 0.83.
                assert!(covered > 0.83, "{count} {p}: {covered}");
                total += covered;
            }
            let mean = total / probabilities.len() as f64;
            assert!((mean - 0.95).abs() < 0.01, "{count}: {mean}");
        }
    }
}
