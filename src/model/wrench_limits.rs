//! Measured limits of the wrench with which a gripper holds a board (`docs/method.md#613-measured-grippers`).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::wrench::Wrench;

/// How the six limits act together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LimitShape {
    /// Each component has its own limit.
    Box,
    /// The shares of the limits that the components use are added up as squares.
    Ellipsoid,
}

impl LimitShape {
    /// The name in descriptions and tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Box => "box",
            Self::Ellipsoid => "ellipsoid",
        }
    }
}

/// The names of a wrench's components in tables.
pub const COMPONENTS: [&str; 6] = ["force x", "force y", "force z", "moment x", "moment y", "moment z"];

/// Limits of the wrench of a gripper on the board about its grasp point in G axes.
///
/// With the limits `l_i < 0 < h_i` of component i, the share that it uses is `u_i = max(w_i / h_i, w_i / l_i)`. The ratio of a
/// wrench to the limits is `max u_i` for a box and `|u|` for an ellipsoid; the limits are kept up to 1. The set of wrenches
/// that keep them is convex, and the ratio grows in proportion to the wrench.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WrenchLimits {
    /// How the components act together.
    pub shape: LimitShape,
    /// The lower limit of each component, N and N m, below 0.
    #[schemars(with = "[f64; 6]")]
    pub low: Wrench,
    /// The upper limit of each component, above 0.
    #[schemars(with = "[f64; 6]")]
    pub high: Wrench,
}

impl WrenchLimits {
    /// Limits that are the same in both directions, N and N m.
    #[must_use]
    pub fn symmetric(shape: LimitShape, most: Wrench) -> Self {
        Self { shape, low: most.scaled(-1.0), high: most }
    }

    /// The share u of its limit that each component of a wrench uses.
    #[must_use]
    pub fn shares(&self, wrench_g: &Wrench) -> [f64; 6] {
        let [low, high, wrench] = [self.low, self.high, *wrench_g].map(<[f64; 6]>::from);
        std::array::from_fn(|i| if wrench[i] < 0.0 { wrench[i] / low[i] } else { wrench[i] / high[i] })
    }

    /// The ratio of a wrench to the limits: they are kept up to 1. NaN for a wrench that is not a number.
    #[must_use]
    pub fn ratio(&self, wrench_g: &Wrench) -> f64 {
        let shares = self.shares(wrench_g);
        match self.shape {
            // `f64::max` would drop a NaN.
            LimitShape::Box => shares.into_iter().fold(0.0, |most, share| if share <= most { most } else { share }),
            LimitShape::Ellipsoid => shares.into_iter().fold(0.0, f64::hypot),
        }
    }

    /// The largest `v . w` of a wrench w within the limits, for a twist v of the grasp point in G axes.
    #[must_use]
    pub fn largest_work(&self, twist_g: &[f64; 6]) -> f64 {
        let [low, high] = [self.low, self.high].map(<[f64; 6]>::from);
        let most = (0..6).map(|i| f64::max(twist_g[i] * low[i], twist_g[i] * high[i]));
        match self.shape {
            LimitShape::Box => most.sum(),
            LimitShape::Ellipsoid => most.fold(0.0, f64::hypot),
        }
    }

    /// The limits times a factor.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self { low: self.low.scaled(factor), high: self.high.scaled(factor), ..*self }
    }

    /// Components of the wrenches with the largest size that each may have, N and N m.
    #[must_use]
    pub fn largest(&self) -> Wrench {
        let [low, high] = [self.low, self.high].map(<[f64; 6]>::from);
        Wrench::from(std::array::from_fn::<f64, 6, _>(|i| f64::max(-low[i], high[i])))
    }

    /// True if every pair of limits is finite and encloses 0.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        let [low, high] = [self.low, self.high].map(<[f64; 6]>::from);
        (0..6).all(|i| low[i].is_finite() && high[i].is_finite() && low[i] < 0.0 && high[i] > 0.0)
    }
}

impl std::fmt::Display for WrenchLimits {
    /// `box: force 200, 200, -60 to 300 N; moment 20, 20, 10 N m`: one number where both directions have the same limit.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [low, high] = [self.low, self.high].map(<[f64; 6]>::from);
        let text =
            |i: usize| if low[i] == -high[i] { format!("{}", high[i]) } else { format!("{} to {}", low[i], high[i]) };
        let three = |first: usize| [0, 1, 2].map(|i| text(first + i)).join(", ");
        write!(f, "{}: force {} N; moment {} N m", self.shape.name(), three(0), three(3))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn limits(shape: LimitShape, numbers: &[f64; 12]) -> WrenchLimits {
        let low = Wrench::from(std::array::from_fn::<f64, 6, _>(|i| -numbers[i]));
        let high = Wrench::from(std::array::from_fn::<f64, 6, _>(|i| numbers[6 + i]));
        WrenchLimits { shape, low, high }
    }

    #[test]
    fn limits_are_written_in_one_line() {
        let mut limits =
            WrenchLimits::symmetric(LimitShape::Box, Wrench::from([200.0, 200.0, 300.0, 20.0, 20.0, 10.0]));
        limits.low.force_n.z = -60.0;
        assert_eq!(limits.to_string(), "box: force 200, 200, -60 to 300 N; moment 20, 20, 10 N m");
    }

    #[test]
    fn a_wrench_uses_the_limit_of_its_direction() {
        let suction = WrenchLimits {
            shape: LimitShape::Box,
            low: Wrench::from([-20.0, -20.0, -50.0, -1.0, -1.0, -1.0]),
            high: Wrench::from([20.0, 20.0, 500.0, 1.0, 1.0, 1.0]),
        };
        assert_eq!(suction.ratio(&Wrench::from([0.0, 0.0, -25.0, 0.0, 0.0, 0.0])), 0.5);
        assert_eq!(suction.ratio(&Wrench::from([0.0, 0.0, 25.0, 0.0, 0.0, 0.0])), 0.05);
        assert_eq!(suction.ratio(&Wrench::from([10.0, 0.0, 0.0, 0.0, -0.75, 0.0])), 0.75);
        let ellipsoid = WrenchLimits { shape: LimitShape::Ellipsoid, ..suction };
        // 3, 4, 5.
        assert!((ellipsoid.ratio(&Wrench::from([12.0, 0.0, -40.0, 0.0, 0.0, 0.0])) - 1.0).abs() < 1e-15);
        assert!(ellipsoid.ratio(&Wrench::from([f64::NAN; 6])).is_nan());
        assert!(suction.ratio(&Wrench::from([f64::NAN; 6])).is_nan());
    }

    proptest! {
        /// The work on a twist is the support function of the limits: no wrench within them does more, and one does as much.
        #[test]
        fn the_largest_work_is_that_of_the_best_wrench(
            numbers in prop::array::uniform12(0.1..10.0_f64),
            twist in prop::array::uniform6(-1.0..1.0_f64),
            wrench in prop::array::uniform6(-1.0..1.0_f64),
            is_box in any::<bool>(),
        ) {
            let limits = limits(if is_box { LimitShape::Box } else { LimitShape::Ellipsoid }, &numbers);
            let work = |wrench: &Wrench| <[f64; 6]>::from(*wrench).iter().zip(&twist).map(|(w, v)| w * v).sum::<f64>();
            let wrench = Wrench::from(wrench);
            let kept = wrench.scaled(1.0 / limits.ratio(&wrench));
            let most = limits.largest_work(&twist);
            // Rounding of a dozen operations.
            prop_assert!(work(&kept) <= most * (1.0 + 1e-12));
            let end = |i: usize| if twist[i] < 0.0 { -numbers[i] } else { numbers[6 + i] };
            let best = Wrench::from(std::array::from_fn::<f64, 6, _>(|i| match limits.shape {
                LimitShape::Box => end(i),
                LimitShape::Ellipsoid => end(i) * (end(i) * twist[i]) / most,
            }));
            prop_assert!((limits.ratio(&best) - 1.0).abs() < 1e-12);
            prop_assert!((work(&best) - most).abs() < 1e-12 * most);
        }

        #[test]
        fn the_ratio_is_proportional_and_convex(
            numbers in prop::array::uniform12(0.1..10.0_f64),
            a in prop::array::uniform6(-1.0..1.0_f64),
            b in prop::array::uniform6(-1.0..1.0_f64),
            is_box in any::<bool>(),
        ) {
            let limits = limits(if is_box { LimitShape::Box } else { LimitShape::Ellipsoid }, &numbers);
            let (a, b) = (Wrench::from(a), Wrench::from(b));
            let ratio = limits.ratio(&a);
            prop_assert!((limits.ratio(&a.scaled(3.0)) - 3.0 * ratio).abs() < 1e-12 * ratio);
            prop_assert!((limits.scaled(2.0).ratio(&a) - ratio / 2.0).abs() < 1e-12 * ratio);
            prop_assert!(limits.ratio(&(a + b)) <= ratio + limits.ratio(&b) + 1e-12);
        }
    }
}
