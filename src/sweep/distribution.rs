//! Quantiles of the distributions of a sweep (`docs/method.md#102-draws`).

use std::f64::consts::FRAC_1_SQRT_2;

use crate::model::sweep::{Distribution, Quantity, Variable};

/// The quantiles of a variable's values.
#[derive(Clone, Debug)]
pub struct Quantiles {
    /// Of discrete values those within the bounds, in increasing order, with weights that are not zero.
    distribution: Distribution,
    /// The sums of the weights of discrete values.
    cumulative: Vec<f64>,
    /// The shares of the values at the bounds.
    shares: [Share; 2],
    bounds: [f64; 2],
}

/// The shares of a distribution's values below and above a value. Each is exact where it is small.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Share {
    below: f64,
    above: f64,
}

/// What is wrong with a variable.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{key}: found {found}, expected {expected}")]
pub struct VariableFlaw {
    /// The key of the variable or of its distribution, such as `sd` or `min`.
    pub key: &'static str,
    /// What was found.
    pub found: String,
    /// What was expected.
    pub expected: String,
}

impl VariableFlaw {
    fn unless(fits: bool, key: &'static str, found: impl ToString, expected: &str) -> Result<(), Self> {
        if fits { Ok(()) } else { Err(Self { key, found: found.to_string(), expected: expected.to_owned() }) }
    }

    /// True if the key is one of the distribution.
    #[must_use]
    pub fn is_of_distribution(&self) -> bool {
        !["min", "max", "nominal", "correlation"].contains(&self.key)
    }
}

impl Quantiles {
    /// The least probability that draws tell apart, at either end: the values are those between the quantiles of this
    /// probability and of one minus it.
    pub const LEAST_PROBABILITY: f64 = 1e-9;

    /// The least share of a distribution that its bounds must leave.
    pub const LEAST_SHARE: f64 = 1e-6;

    /// The quantiles of a variable's distribution within its bounds.
    ///
    /// # Errors
    /// If a parameter, a bound, the correlation or the nominal value is not allowed, or the bounds leave next to no value.
    pub fn of(variable: &Variable) -> Result<Self, VariableFlaw> {
        check_parameters(&variable.distribution)?;
        check_variable(variable)?;
        let bounds = [variable.min.unwrap_or(f64::NEG_INFINITY), variable.max.unwrap_or(f64::INFINITY)];
        let expected = "bounds that leave at least a millionth of the distribution's values";
        let refused = || {
            let key = if variable.min.is_some() { "min" } else { "max" };
            let [min, max] = [variable.min, variable.max].map(|bound| bound.map_or("none".into(), |at| at.to_string()));
            VariableFlaw { key, found: format!("the bounds {min} and {max}"), expected: expected.to_owned() }
        };
        if let Distribution::Discrete { values, weights } = &variable.distribution {
            return Self::discrete(values, weights.as_deref(), bounds).ok_or_else(refused);
        }
        let distribution = variable.distribution.clone();
        let shares = [share(&distribution, bounds[0], false), share(&distribution, bounds[1], true)];
        let [low, high] = shares;
        let left = if low.below < 0.5 { high.below - low.below } else { low.above - high.above };
        if left < Self::LEAST_SHARE {
            return Err(refused());
        }
        Ok(Self { distribution, cumulative: Vec::new(), shares, bounds })
    }

    fn discrete(values: &[f64], weights: Option<&[f64]>, bounds: [f64; 2]) -> Option<Self> {
        let weight = |place: usize| weights.map_or(1.0, |weights| weights[place]);
        let all: f64 = (0..values.len()).map(weight).sum();
        let mut kept: Vec<[f64; 2]> = values.iter().enumerate().map(|(place, &value)| [value, weight(place)]).collect();
        kept.retain(|[value, weight]| *weight > 0.0 && (bounds[0]..=bounds[1]).contains(value));
        kept.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let sums = kept.iter().scan(0.0, |sum, [_, weight]| {
            *sum += weight;
            Some(*sum)
        });
        let cumulative: Vec<f64> = sums.collect();
        let values = kept.iter().map(|[value, _]| *value).collect();
        let leaves_enough = cumulative.last().is_some_and(|sum| *sum >= Self::LEAST_SHARE * all);
        let shares = [Share { below: 0.0, above: 1.0 }, Share { below: 1.0, above: 0.0 }];
        let distribution = Distribution::Discrete { values, weights: None };
        leaves_enough.then_some(Self { distribution, cumulative, shares, bounds })
    }

    /// The value that a share `probability` of the values does not exceed. Beyond [`Quantiles::LEAST_PROBABILITY`] at either
    /// end the quantile there is taken.
    #[must_use]
    pub fn at(&self, probability: f64) -> f64 {
        let below = probability.clamp(Self::LEAST_PROBABILITY, 1.0 - Self::LEAST_PROBABILITY);
        let [low, high] = self.shares;
        let share = Share {
            below: low.below + below * (high.below - low.below),
            above: high.above + (1.0 - below) * (low.above - high.above),
        };
        self.value(share).clamp(self.bounds[0], self.bounds[1])
    }

    /// The smallest and the largest value that is drawn.
    #[must_use]
    pub fn extremes(&self) -> [f64; 2] {
        [self.at(0.0), self.at(1.0)]
    }

    fn value(&self, share: Share) -> f64 {
        let Share { below, above } = share;
        match &self.distribution {
            Distribution::Normal { mean, sd } => mean + sd * standard_quantile(share),
            Distribution::LogNormal { median, sd_log } => median * libm::exp(sd_log * standard_quantile(share)),
            Distribution::Uniform { low, high } => low * above + high * below,
            Distribution::Triangular { low, mode, high } => {
                if below * (high - low) <= mode - low {
                    low + (below * (high - low) * (mode - low)).sqrt()
                } else {
                    high - (above * (high - low) * (high - mode)).sqrt()
                }
            }
            Distribution::Discrete { values, .. } => {
                let all = self.cumulative[self.cumulative.len() - 1];
                let place = self.cumulative.partition_point(|sum| *sum <= below * all);
                values[place.min(values.len() - 1)]
            }
            Distribution::Measured { values } => {
                let place = below * (values.len() - 1) as f64;
                let before = (place.floor() as usize).min(values.len() - 1);
                let after = (before + 1).min(values.len() - 1);
                values[before] + (place - before as f64) * (values[after] - values[before])
            }
        }
    }
}

/// The shares of a continuous distribution's values below and above a value; the value itself counts below if `inclusive`.
fn share(distribution: &Distribution, value: f64, inclusive: bool) -> Share {
    if value.is_infinite() {
        let below = if value > 0.0 { 1.0 } else { 0.0 };
        return Share { below, above: 1.0 - below };
    }
    match distribution {
        Distribution::Normal { mean, sd } => standard_share((value - mean) / sd),
        Distribution::LogNormal { median, sd_log } if value > 0.0 => standard_share(libm::log(value / median) / sd_log),
        Distribution::LogNormal { .. } => Share { below: 0.0, above: 1.0 },
        Distribution::Uniform { low, high } => {
            let part = |length: f64| (length / (high - low)).clamp(0.0, 1.0);
            Share { below: part(value - low), above: part(high - value) }
        }
        Distribution::Triangular { low, mode, high } => {
            if value < *mode {
                let below = (value - low).max(0.0).powi(2) / ((high - low) * (mode - low));
                Share { below, above: 1.0 - below }
            } else if value < *high {
                let above = (high - value).powi(2) / ((high - low) * (high - mode));
                Share { below: 1.0 - above, above }
            } else {
                Share { below: 1.0, above: 0.0 }
            }
        }
        Distribution::Discrete { values, .. } | Distribution::Measured { values } => {
            let below = measured_share(values, value, inclusive);
            Share { below, above: 1.0 - below }
        }
    }
}

/// The share of measured values below a value, by linear interpolation; of equal ones those below if not `inclusive`.
fn measured_share(values: &[f64], value: f64, inclusive: bool) -> f64 {
    let last = values.len() - 1;
    let place = values.partition_point(|other| if inclusive { *other <= value } else { *other < value });
    if place == 0 {
        return 0.0;
    }
    if place > last {
        return 1.0;
    }
    let [before, after] = [values[place - 1], values[place]];
    let part = if after > before { (value - before) / (after - before) } else { 0.0 };
    (((place - 1) as f64 + part) / last as f64).clamp(0.0, 1.0)
}

fn check_parameters(distribution: &Distribution) -> Result<(), VariableFlaw> {
    let finite = |key, value: f64| VariableFlaw::unless(value.is_finite(), key, value, "a finite number");
    let positive =
        |key, value: f64| VariableFlaw::unless(value.is_finite() && value > 0.0, key, value, "a positive number");
    let above = |key, value: f64, low: f64| {
        VariableFlaw::unless(value > low, key, value, &format!("a number above low, {low}"))
    };
    match distribution {
        Distribution::Normal { mean, sd } => finite("mean", *mean).and_then(|()| positive("sd", *sd)),
        Distribution::LogNormal { median, sd_log } => {
            positive("median", *median).and_then(|()| positive("sd_log", *sd_log))
        }
        Distribution::Uniform { low, high } => {
            finite("low", *low)?;
            finite("high", *high)?;
            above("high", *high, *low)
        }
        Distribution::Triangular { low, mode, high } => {
            finite("low", *low)?;
            finite("high", *high)?;
            above("high", *high, *low)?;
            let expected = format!("a number from low to high, {low} to {high}");
            VariableFlaw::unless((*low..=*high).contains(mode), "mode", mode, &expected)
        }
        Distribution::Discrete { values, weights } => check_discrete(values, weights.as_deref()),
        Distribution::Measured { values } => {
            let found = format!("{} values", values.len());
            VariableFlaw::unless(values.len() >= 2, "values", found, "at least 2 values")?;
            let ordered = values.iter().all(|value| value.is_finite()) && values.is_sorted();
            VariableFlaw::unless(ordered, "values", "other values", "finite values in increasing order")
        }
    }
}

fn check_discrete(values: &[f64], weights: Option<&[f64]>) -> Result<(), VariableFlaw> {
    let fits = !values.is_empty() && values.iter().all(|value| value.is_finite());
    VariableFlaw::unless(fits, "values", format!("{values:?}"), "at least one value, all of them finite")?;
    let Some(weights) = weights else { return Ok(()) };
    let expected = format!("{} weights, one a value", values.len());
    VariableFlaw::unless(weights.len() == values.len(), "weights", format!("{} weights", weights.len()), &expected)?;
    let sum: f64 = weights.iter().sum();
    let fits = weights.iter().all(|weight| *weight >= 0.0) && sum > 0.0 && sum.is_finite();
    VariableFlaw::unless(fits, "weights", format!("{weights:?}"), "numbers of at least 0, not all of them 0")
}

fn check_variable(variable: &Variable) -> Result<(), VariableFlaw> {
    for (key, bound) in [("min", variable.min), ("max", variable.max)] {
        let value = bound.unwrap_or(0.0);
        VariableFlaw::unless(value.is_finite(), key, value, "a finite number")?;
    }
    if let (Some(min), Some(max)) = (variable.min, variable.max) {
        VariableFlaw::unless(min < max, "max", max, &format!("a number above min, {min}"))?;
    }
    if let Some(nominal) = variable.nominal {
        let fits = nominal.is_finite() && nominal > 0.0;
        VariableFlaw::unless(fits, "nominal", nominal, "a positive number")?;
        let has_absolute =
            [Quantity::Friction, Quantity::GripForce, Quantity::BoardMass, Quantity::BoardThickness, Quantity::Force];
        let expected = "none: the values of this quantity are factors or offsets";
        VariableFlaw::unless(has_absolute.contains(&variable.quantity), "nominal", nominal, expected)?;
    }
    let Some(correlation) = variable.correlation else { return Ok(()) };
    let is_of_arms = variable.quantity.usual_correlation().is_some();
    let expected = "none: it belongs to friction and grip force, which each arm has";
    VariableFlaw::unless(is_of_arms, "correlation", correlation, expected)?;
    VariableFlaw::unless((0.0..=1.0).contains(&correlation), "correlation", correlation, "a number from 0 to 1")
}

/// The shares of the standard normal distribution below and above `z`.
fn standard_share(z: f64) -> Share {
    Share { below: 0.5 * libm::erfc(-z * FRAC_1_SQRT_2), above: 0.5 * libm::erfc(z * FRAC_1_SQRT_2) }
}

/// The share of the standard normal distribution below `z`.
pub fn standard_probability(z: f64) -> f64 {
    standard_share(z).below
}

/// The quantile of the standard normal distribution at a probability above 0 and below 1.
pub fn standard_normal(probability: f64) -> f64 {
    standard_quantile(Share { below: probability, above: 1.0 - probability })
}

fn standard_quantile(share: Share) -> f64 {
    if share.below <= share.above { lower_quantile(share.below) } else { -lower_quantile(share.above) }
}

/// The quantile of the standard normal distribution at a probability of at most 1/2, to a relative error of about 1e-16: M. J.
/// Wichura, Algorithm AS 241: The percentage points of the normal distribution, Applied Statistics 37 (1988). Written here,
/// on the logarithm of `libm`, so that the draws are the same bytes on every machine.
fn lower_quantile(probability: f64) -> f64 {
    let q = probability - 0.5;
    if q >= -0.425 {
        return q * ratio(&CENTRAL, 0.180_625 - q * q);
    }
    let r = (-libm::log(probability)).sqrt();
    if r <= 5.0 { -ratio(&TAIL, r - 1.6) } else { -ratio(&FAR_TAIL, r - 5.0) }
}

/// A ratio of two polynomials, of which the coefficients of the highest power come first.
fn ratio(of: &[[f64; 8]; 2], x: f64) -> f64 {
    let [above, below] = of.map(|polynomial| polynomial.iter().fold(0.0, |sum, coefficient| sum * x + coefficient));
    above / below
}

const CENTRAL: [[f64; 8]; 2] = [
    [
        2.509_080_928_730_122_7e3,
        3.343_057_558_358_813e4,
        6.726_577_092_700_87e4,
        4.592_195_393_154_987e4,
        1.373_169_376_550_946e4,
        1.971_590_950_306_551_3e3,
        1.331_416_678_917_843_8e2,
        3.387_132_872_796_366_5,
    ],
    [
        5.226_495_278_852_854e3,
        2.872_908_573_572_194_3e4,
        3.930_789_580_009_271e4,
        2.121_379_430_158_659_7e4,
        5.394_196_021_424_751e3,
        6.871_870_074_920_579e2,
        4.231_333_070_160_091e1,
        1.0,
    ],
];

const TAIL: [[f64; 8]; 2] = [
    [
        7.745_450_142_783_414e-4,
        2.272_384_498_926_918_4e-2,
        2.417_807_251_774_506e-1,
        1.270_458_252_452_368_4,
        3.647_848_324_763_204_5,
        5.769_497_221_460_691,
        4.630_337_846_156_546,
        1.423_437_110_749_683_5,
    ],
    [
        1.050_750_071_644_416_9e-9,
        5.475_938_084_995_345e-4,
        1.519_866_656_361_645_7e-2,
        1.481_039_764_274_800_8e-1,
        6.897_673_349_851e-1,
        1.676_384_830_183_803_8,
        2.053_191_626_637_759,
        1.0,
    ],
];

const FAR_TAIL: [[f64; 8]; 2] = [
    [
        2.010_334_399_292_288_1e-7,
        2.711_555_568_743_487_6e-5,
        1.242_660_947_388_078_4e-3,
        2.653_218_952_657_612_4e-2,
        2.965_605_718_285_048_7e-1,
        1.784_826_539_917_291_3,
        5.463_784_911_164_114,
        6.657_904_643_501_103,
    ],
    [
        2.044_263_103_389_939_7e-15,
        1.421_511_758_316_446e-7,
        1.846_318_317_510_054_8e-5,
        7.868_691_311_456_133e-4,
        1.487_536_129_085_061_5e-2,
        1.369_298_809_227_358e-1,
        5.998_322_065_558_88e-1,
        1.0,
    ],
];
