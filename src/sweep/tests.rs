//! Draws against closed forms.

use proptest::prelude::*;

use super::{
    ArmJoints, Draws,
    distribution::{Quantiles, standard_normal, standard_probability},
    points::Points,
};
use crate::model::{
    sweep::{Distribution, Quantity, Sampling, Sweep, Variable},
    uncertainty::Uncertainty,
};

fn variable(quantity: Quantity, distribution: Distribution) -> Variable {
    Variable { quantity, distribution, min: None, max: None, nominal: None, correlation: None, source: None }
}

fn within(distribution: Distribution, min: Option<f64>, max: Option<f64>) -> Quantiles {
    Quantiles::of(&Variable { min, max, ..variable(Quantity::Force, distribution) }).unwrap()
}

fn quantiles(distribution: Distribution) -> Quantiles {
    within(distribution, None, None)
}

fn close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found} is not {expected}");
}

fn arms(joints: &[usize]) -> Vec<ArmJoints> {
    let names = ["left", "right", "third"];
    joints.iter().zip(names).map(|(&joints, name)| ArmJoints { name: name.into(), joints }).collect()
}

fn sweep(sampling: Sampling, variables: Vec<Variable>) -> Sweep {
    Sweep { runs: 100, sampling, seed: 3, variables }
}

const NORMAL: Distribution = Distribution::Normal { mean: 0.0, sd: 1.0 };

/// Quantiles of the standard normal distribution, to 15 digits (Abramowitz and Stegun, Handbook of mathematical functions,
/// table 26.5, and its inverse by any table of the distribution function).
#[test]
fn normal_quantiles_are_the_published_ones() {
    for (probability, quantile) in [
        (0.5, 0.0),
        (0.75, 0.674_489_750_196_081_7),
        (0.9, 1.281_551_565_544_600_5),
        (0.95, 1.644_853_626_951_472_7),
        (0.975, 1.959_963_984_540_054),
        (0.995, 2.575_829_303_548_900_4),
        (0.001, -3.090_232_306_167_813_5),
        (1e-9, -5.997_807_015_007_686),
        // The argument of the far tail is beyond 5 from a probability of 1.4e-11 on.
        (1e-20, -9.262_340_089_798_408),
    ] {
        // Rounding of the probability moves a quantile by 1e-16 / density: at 0.995 by 1e-14.
        close(standard_normal(probability), quantile, 2e-14);
    }
}

#[test]
fn a_quantile_and_its_probability_invert_each_other() {
    for step in 1..2000 {
        let z = -0.005 * f64::from(step);
        // erfc is exact to some 1e-16 relative, and the rounding of its argument adds z^2 times as much; a quantile moves by
        // about 1/z of that.
        let back = standard_normal(standard_probability(z));
        close(back, z, 1e-14);
    }
}

#[test]
fn quantiles_are_those_of_the_closed_forms() {
    let uniform = quantiles(Distribution::Uniform { low: -2.0, high: 6.0 });
    let triangular = quantiles(Distribution::Triangular { low: 1.0, mode: 2.0, high: 5.0 });
    let log_normal = quantiles(Distribution::LogNormal { median: 0.5, sd_log: 0.3 });
    for step in 1..100 {
        let probability = f64::from(step) / 100.0;
        close(uniform.at(probability), -2.0 + 8.0 * probability, 1e-14);
        let value = triangular.at(probability);
        let below = if value < 2.0 { (value - 1.0).powi(2) / 4.0 } else { 1.0 - (5.0 - value).powi(2) / 12.0 };
        close(below, probability, 1e-14);
        close((log_normal.at(probability) / 0.5).ln() / 0.3, standard_normal(probability), 1e-13);
    }
    // A quarter of the values is below the mode.
    close(triangular.at(0.25), 2.0, 1e-14);
}

#[test]
fn discrete_values_have_their_weights() {
    let by_weight =
        Distribution::Discrete { values: vec![3.0, 1.0, 2.0, 9.0], weights: Some(vec![1.0, 2.0, 1.0, 0.0]) };
    let of = quantiles(by_weight.clone());
    assert_eq!([0.0, 0.49, 0.51, 0.74, 0.76, 1.0].map(|at| of.at(at)), [1.0, 1.0, 2.0, 2.0, 3.0, 3.0]);
    let bounded = within(by_weight, Some(1.5), None);
    assert_eq!([0.0, 0.49, 0.51, 1.0].map(|at| bounded.at(at)), [2.0, 2.0, 3.0, 3.0]);
    let single = quantiles(Distribution::Discrete { values: vec![4.0], weights: None });
    assert_eq!(single.extremes(), [4.0, 4.0]);
}

#[test]
fn measured_values_are_interpolated_between_their_quantiles() {
    let of = quantiles(Distribution::Measured { values: vec![1.0, 2.0, 2.0, 5.0, 7.0] });
    for (probability, value) in [(0.25, 2.0), (0.5, 2.0), (0.625, 3.5), (0.75, 5.0), (0.125, 1.5)] {
        close(of.at(probability), value, 1e-12);
    }
    // Between 2 and 5, of which 2 itself has a quarter: half of what is left.
    let bounded = within(Distribution::Measured { values: vec![1.0, 2.0, 2.0, 5.0, 7.0] }, Some(2.0), Some(5.0));
    close(bounded.at(0.5), 2.0, 1e-12);
    close(bounded.at(0.75), 3.5, 1e-12);
    let equal = quantiles(Distribution::Measured { values: vec![0.4, 0.4] });
    assert_eq!(equal.extremes(), [0.4, 0.4]);
}

/// The mean of a normal value between bounds is `(density(a) - density(b)) / share`, also far out in a tail.
#[test]
fn truncated_normal_values_have_the_mean_of_their_closed_form() {
    let density = |z: f64| (-z * z / 2.0).exp() / std::f64::consts::TAU.sqrt();
    for [low, high] in [[-1.0, 2.0], [0.5, 0.6], [3.0, 4.5], [-4.5, -3.0]] {
        let of = within(NORMAL, Some(low), Some(high));
        let mean = (0..10_000).map(|step| of.at((f64::from(step) + 0.5) / 1e4)).sum::<f64>() / 1e4;
        // By symmetry from the lower tail, where shares are exact.
        let share = if low > 0.0 {
            standard_probability(-low) - standard_probability(-high)
        } else {
            standard_probability(high) - standard_probability(low)
        };
        // The midpoint rule leaves out at most the curvature of the quantiles at an end.
        close(mean, (density(low) - density(high)) / share, 1e-5);
    }
}

/// Means and variances of 100,000 independent draws, within 4 standard errors of the closed forms.
#[test]
fn draws_have_the_moments_of_their_distribution() {
    let count = 100_000;
    let (sd_log, median): (f64, f64) = (0.25, 2.0);
    let log_mean = median * (sd_log * sd_log / 2.0).exp();
    let log_variance = log_mean * log_mean * ((sd_log * sd_log).exp() - 1.0);
    let cases = [
        (Distribution::Normal { mean: 1.0, sd: 0.2 }, 1.0, 0.04),
        (Distribution::Uniform { low: 0.0, high: 1.0 }, 0.5, 1.0 / 12.0),
        (Distribution::LogNormal { median, sd_log }, log_mean, log_variance),
        (Distribution::Triangular { low: 0.0, mode: 1.0, high: 2.0 }, 1.0, 1.0 / 6.0),
        (Distribution::Discrete { values: vec![0.0, 1.0], weights: Some(vec![3.0, 1.0]) }, 0.25, 3.0 / 16.0),
        (Distribution::Measured { values: vec![0.0, 1.0, 2.0] }, 1.0, 1.0 / 3.0),
    ];
    for (distribution, mean, variance) in cases {
        let draws =
            Draws::new(&sweep(Sampling::Independent, vec![variable(Quantity::Force, distribution.clone())]), &[]);
        let draws = draws.unwrap();
        let values: Vec<f64> = (0..count).map(|index| draws.draw(index).values[0]).collect();
        let found_mean = values.iter().sum::<f64>() / count as f64;
        close(found_mean, mean, 4.0 * (variance / count as f64).sqrt());
        let found = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count as f64;
        // The fourth central moment is at most 3.4 times the squared variance in these distributions.
        close(found, variance, 4.0 * variance * (2.4 / count as f64).sqrt());
    }
}

/// Correlated hands: the normal scores of the two hands have the correlation of the copula, and each the distribution.
#[test]
fn correlated_hands_have_their_correlation() {
    for correlation in [0.0, 0.3, 0.9] {
        let friction = Variable { correlation: Some(correlation), ..variable(Quantity::Friction, NORMAL) };
        let draws = Draws::new(&sweep(Sampling::Independent, vec![friction]), &arms(&[7, 7, 7])).unwrap();
        let names: Vec<_> = draws.dimensions().iter().map(|dimension| dimension.name.as_str()).collect();
        assert_eq!(names, ["friction_factor.left", "friction_factor.right", "friction_factor.third"]);
        let count = 20_000;
        let values: Vec<_> = (0..count).map(|index| draws.draw(index).values).collect();
        for [a, b] in [[0, 1], [0, 2], [1, 2]] {
            let found = values.iter().map(|value| value[a] * value[b]).sum::<f64>() / count as f64;
            // The product of two standard normal numbers has the variance 1 + correlation^2.
            close(found, correlation, 4.0 * ((1.0 + correlation * correlation) / count as f64).sqrt());
            let square = values.iter().map(|value| value[b] * value[b]).sum::<f64>() / count as f64;
            close(square, 1.0, 4.0 * (2.0 / count as f64).sqrt());
        }
    }
}

fn of_every_quantity() -> Vec<Variable> {
    let quantities = [
        Quantity::Friction,
        Quantity::GripForce,
        Quantity::ContactStiffness,
        Quantity::JointStiffness,
        Quantity::BoardMass,
        Quantity::BoardThickness,
        Quantity::Force,
        Quantity::ToolTilt,
        Quantity::ToolOffset,
        Quantity::PersonOffset,
        Quantity::JointOffset,
        Quantity::RampTime,
    ];
    let of = Distribution::Uniform { low: 0.5, high: 1.5 };
    quantities.map(|quantity| variable(quantity, of.clone())).into()
}

#[test]
fn every_value_reaches_the_simulation() {
    let draws = Draws::new(&sweep(Sampling::Sobol, of_every_quantity()), &arms(&[2, 3])).unwrap();
    let names: Vec<_> = draws.dimensions().iter().map(|dimension| dimension.name.as_str()).collect();
    assert_eq!(names[..3], ["friction_factor", "grip_force_factor.left", "grip_force_factor.right"]);
    assert_eq!(names[8..10], ["tool_tilt_deg.x", "tool_tilt_deg.y"]);
    assert_eq!(names[14..17], ["joint_offset_deg.left.1", "joint_offset_deg.left.2", "joint_offset_deg.right.1"]);
    let drawn = draws.draw(5);
    let of = &drawn.uncertainty;
    let mut expected = vec![of.friction_scale, of.grip_force_scales[0], of.grip_force_scales[1]];
    expected.extend([of.contact_stiffness_scale, of.joint_stiffness_scale, of.board_mass_scale]);
    expected.extend([of.board_thickness_mm, of.force_scale]);
    expected.extend([of.tool_tilt_deg, of.tool_offset_mm, of.person_offset_mm].concat());
    expected.extend(of.joint_offset_deg.concat());
    expected.push(of.ramp_scale);
    assert_eq!(drawn.values, expected);
    assert_eq!(of.joint_offset_deg.iter().map(Vec::len).collect::<Vec<_>>(), [2, 3]);
    assert_eq!((of.grip_force_scale, of.friction_scales.len()), (1.0, 0));
}

#[test]
fn absolute_values_become_factors_and_offsets() {
    let of = |quantity, value, nominal| Variable {
        nominal: Some(nominal),
        ..variable(quantity, Distribution::Discrete { values: vec![value], weights: None })
    };
    let variables = vec![
        of(Quantity::Friction, 0.3, 0.6),
        of(Quantity::BoardThickness, 29.0, 30.0),
        of(Quantity::Force, 30.0, 15.0),
    ];
    let draws = Draws::new(&sweep(Sampling::Sobol, variables), &arms(&[7, 7])).unwrap();
    let names: Vec<_> =
        draws.dimensions().iter().map(|dimension| (dimension.name.as_str(), dimension.unit.as_str())).collect();
    assert_eq!(names, [("friction", "a Coulomb coefficient"), ("board_thickness_mm", "mm"), ("force_n", "N")]);
    let drawn = draws.draw(0);
    assert_eq!(drawn.values, [0.3, 29.0, 30.0]);
    let expected =
        Uncertainty { friction_scale: 0.5, board_thickness_mm: -1.0, force_scale: 2.0, ..Uncertainty::default() };
    assert_eq!(drawn.uncertainty, expected);
}

#[test]
fn a_run_does_not_depend_on_the_number_of_runs() {
    for sampling in [Sampling::Sobol, Sampling::Independent] {
        let [few, many] = [100, 100_000]
            .map(|runs| Draws::new(&Sweep { runs, ..sweep(sampling, of_every_quantity()) }, &arms(&[7, 7])).unwrap());
        for index in [0, 1, 57, 99] {
            assert_eq!(few.draw(index), many.draw(index));
        }
    }
}

#[test]
fn too_many_dimensions_are_refused() {
    let joints = vec![variable(Quantity::JointOffset, NORMAL)];
    let error = Draws::new(&sweep(Sampling::Sobol, joints.clone()), &arms(&[200, 57])).unwrap_err();
    let expected = "found 257 numbers to draw for each run, expected at most 256 with sampling = \"sobol\"";
    assert_eq!(error.to_string(), expected);
    assert!(Draws::new(&sweep(Sampling::Sobol, joints.clone()), &arms(&[200, 56])).is_ok());
    assert!(Draws::new(&sweep(Sampling::Independent, joints), &arms(&[200, 57])).is_ok());
}

#[test]
fn a_variable_that_is_not_valid_is_refused() {
    let bad = vec![variable(Quantity::Force, Distribution::Normal { mean: 1.0, sd: 0.0 })];
    let error = Draws::new(&sweep(Sampling::Sobol, bad), &[]).unwrap_err();
    assert_eq!(error.to_string(), "force_factor.sd: found 0, expected a positive number");
    let beyond = Variable { min: Some(7.0), ..variable(Quantity::Force, NORMAL) };
    let error = Quantiles::of(&beyond).unwrap_err();
    assert_eq!((error.key, error.found.as_str()), ("min", "the bounds 7 and none"));
    for quantity in [Quantity::Force, Quantity::ToolTilt] {
        let correlated = Variable { correlation: Some(0.5), ..variable(quantity, NORMAL) };
        assert_eq!(Quantiles::of(&correlated).unwrap_err().key, "correlation");
    }
}

/// The bytes of draws are part of the format: a sweep's seed must keep its meaning. These are of the first version.
#[test]
fn draws_stay_what_they_were() {
    let hands = Variable { correlation: Some(0.5), ..variable(Quantity::GripForce, NORMAL) };
    let variables = vec![hands, variable(Quantity::Force, Distribution::LogNormal { median: 1.0, sd_log: 0.1 })];
    for (sampling, expected) in [(Sampling::Sobol, SOBOL_DRAW), (Sampling::Independent, INDEPENDENT_DRAW)] {
        let draws = Draws::new(&sweep(sampling, variables.clone()), &arms(&[7, 7])).unwrap();
        let bits: Vec<u64> = draws.draw(12).values.iter().map(|value| value.to_bits()).collect();
        assert_eq!(bits, expected, "{:?}", draws.draw(12).values);
    }
}

const SOBOL_DRAW: [u64; 3] = [4612683055725663237, 4607462718384518475, 4607227434324122851];
const INDEPENDENT_DRAW: [u64; 3] = [4612438542703655323, 4607055505034694721, 4607283972994717850];

fn any_distribution() -> impl Strategy<Value = Distribution> {
    let scale = 0.01..2.0_f64;
    prop_oneof![
        (-3.0..3.0, scale.clone()).prop_map(|(mean, sd)| Distribution::Normal { mean, sd }),
        (0.1..3.0, 0.01..1.0).prop_map(|(median, sd_log)| Distribution::LogNormal { median, sd_log }),
        (-3.0..3.0, scale.clone()).prop_map(|(low, width)| Distribution::Uniform { low, high: low + width }),
        (-3.0..3.0, scale, 0.0..=1.0).prop_map(|(low, width, at)| Distribution::Triangular {
            low,
            mode: low + at * width,
            high: low + width
        }),
        proptest::collection::vec((-3.0..3.0, 0.1..1.0), 1..6).prop_map(|pairs| {
            let (values, weights) = pairs.into_iter().unzip();
            Distribution::Discrete { values, weights: Some(weights) }
        }),
        proptest::collection::vec(-3.0..3.0, 2..30).prop_map(|mut values| {
            values.sort_by(f64::total_cmp);
            Distribution::Measured { values }
        }),
    ]
}

proptest! {
    /// Quantiles grow with the probability, keep to the bounds, and those within bounds are those without at the share between
    /// the shares of the bounds.
    #[test]
    fn quantiles_are_monotone_and_within_their_bounds(
        distribution in any_distribution(),
        ends in (0.01..0.4, 0.6..0.99),
        shares in proptest::collection::vec(0.0..=1.0, 2..20),
    ) {
        let free = quantiles(distribution.clone());
        let (min, max) = (free.at(ends.0), free.at(ends.1));
        prop_assume!(min < max);
        let bounded = within(distribution.clone(), Some(min), Some(max));
        let mut shares = shares;
        shares.sort_by(f64::total_cmp);
        let is_continuous = !matches!(distribution, Distribution::Discrete { .. } | Distribution::Measured { .. });
        for pair in shares.windows(2) {
            prop_assert!(free.at(pair[0]) <= free.at(pair[1]));
            prop_assert!(bounded.at(pair[0]) <= bounded.at(pair[1]));
            prop_assert!((min..=max).contains(&bounded.at(pair[0])));
            if is_continuous && pair[0] > 1e-6 && pair[0] < 1.0 - 1e-6 {
                let same = free.at(ends.0 + pair[0] * (ends.1 - ends.0));
                prop_assert!((bounded.at(pair[0]) - same).abs() < 1e-9, "{} {same}", bounded.at(pair[0]));
            }
        }
    }

    #[test]
    fn points_lie_within_the_open_cube(seed: u64, index in 0_u64..1 << 32, dimensions in 1_usize..40) {
        for sampling in [Sampling::Sobol, Sampling::Independent] {
            let point = Points::new(sampling, seed, dimensions).point(index);
            prop_assert_eq!(point.len(), dimensions);
            prop_assert!(point.iter().all(|&coordinate| coordinate > 0.0 && coordinate < 1.0));
        }
    }
}
