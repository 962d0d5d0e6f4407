//! Mean, standard deviation and quantiles of a sample.

/// The mean; `None` of an empty sample.
#[must_use]
pub fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (count, sum) = values.fold((0_u32, 0.0), |(count, sum), value| (count + 1, sum + value));
    (count > 0).then(|| sum / f64::from(count))
}

/// The standard deviation of a sample, `sqrt(sum (x - mean)^2 / (n - 1))`; `None` for fewer than two values.
#[must_use]
pub fn standard_deviation(values: &[f64]) -> Option<f64> {
    let mean = mean(values.iter().copied())?;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (values.len() > 1).then(|| (squares / (values.len() - 1) as f64).sqrt())
}

/// The quantile at `share` from 0 to 1, interpolated linearly; `None` of an empty sample.
#[must_use]
pub fn quantile(mut values: Vec<f64>, share: f64) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let last = values.len().checked_sub(1)?;
    let position = share * last as f64;
    let below = (position as usize).min(last);
    let above = (below + 1).min(last);
    Some(values[below] + (values[above] - values[below]) * (position - below as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_between_neighbours() {
        let values = || vec![4.0, 1.0, 2.0, 3.0];
        assert_eq!(quantile(values(), 0.5), Some(2.5));
        assert_eq!((quantile(values(), 0.0), quantile(values(), 1.0)), (Some(1.0), Some(4.0)));
        assert_eq!((quantile(vec![7.0], 0.9), quantile(Vec::new(), 0.5)), (Some(7.0), None));
    }

    #[test]
    fn the_deviation_is_that_of_a_sample() {
        assert_eq!(standard_deviation(&[1.0, 3.0]), Some(2.0_f64.sqrt()));
        assert_eq!(standard_deviation(&[1.0]), None);
    }
}
