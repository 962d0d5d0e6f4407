//! What the muscles of a person's arm do in a plan.

use std::fmt;

use nalgebra::Point3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The largest activation that can be held for hours: where the curve of Rohmert 1960 ends.
pub const ENDLESS_ACTIVATION: f64 = 0.15;

/// Activations at which a chart of them may end: the first one that the largest activation does not exceed.
const CHART_TOPS: [f64; 4] = [0.2, 0.3, 0.5, 1.0];

/// The work of the muscles of the working arm (`docs/method.md#4-muscular-comfort`): activations by static optimisation in a
/// musculoskeletal model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MuscleWork {
    /// Sum of the squares of all activations.
    pub effort: f64,
    /// The largest activation, 0 to 1.
    pub largest_activation: f64,
    /// How long the busiest muscle could hold, s: an estimate after Rohmert 1960. Absent up to an activation of 15 %, which
    /// that curve allows without end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub endurance_s: Option<f64>,
    /// The largest moment that the muscles cannot exert, N m; absent up to 0.1 N m. With it the arm is too weak.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub missing_nm: Option<f64>,
    /// The five busiest muscles.
    pub busiest: Vec<BusyMuscle>,
}

/// A muscle and its activation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BusyMuscle {
    /// Its name.
    pub name: String,
    /// The part of shoulder or arm where it is, such as `front of the upper arm`.
    pub region: String,
    /// Its activation, 0 to 1.
    pub activation: f64,
}

/// The muscles of one region as they are drawn: one spindle for all of them.
#[derive(Clone, Debug, PartialEq)]
pub struct MuscleBelly {
    /// The region, such as `front of the upper arm`.
    pub region: String,
    /// The ends of the spindle's axis in W, m.
    pub ends_w: [Point3<f64>; 2],
    /// Radius of the spindle in its middle, m.
    pub radius_m: f64,
    /// The busiest muscle of the region.
    pub busiest: BusyMuscle,
}

impl MuscleWork {
    /// Where the axis of a chart of the activations ends.
    #[must_use]
    pub fn chart_top(&self) -> f64 {
        CHART_TOPS.into_iter().find(|top| self.largest_activation <= *top).unwrap_or(1.0)
    }

    /// How long the arm can be held so, an estimate: `can be held about 4 min`, or why not: `cannot: 1.3 N m missing`.
    #[must_use]
    pub fn endurance_in_words(&self) -> String {
        match (self.missing_nm, self.endurance_s) {
            (Some(missing_nm), _) => format!("cannot: {missing_nm:.1} N m missing"),
            (None, None) => "can be held for hours".to_owned(),
            (None, Some(seconds)) if seconds < 99.5 => format!("can be held about {seconds:.0} s"),
            (None, Some(seconds)) => format!("can be held about {:.0} min", seconds / 60.0),
        }
    }

    /// The busiest muscles in words: `brachialis 12 %, middle deltoid 9 %`.
    #[must_use]
    pub fn busiest_in_words(&self) -> String {
        self.busiest.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
    }
}

/// Effort and endurance: `effort 0.046, largest activation 12 %; can be held for hours (estimate)`.
impl fmt::Display for MuscleWork {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (effort, percent) = (self.effort, 100.0 * self.largest_activation);
        let estimate = if self.missing_nm.is_some() { "" } else { " (estimate)" };
        write!(f, "effort {effort:.3}, largest activation {percent:.0} %; {}{estimate}", self.endurance_in_words())
    }
}

/// `brachialis 12 %`.
impl fmt::Display for BusyMuscle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {:.0} %", self.name, 100.0 * self.activation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn work(largest_activation: f64, endurance_s: Option<f64>, missing_nm: Option<f64>) -> MuscleWork {
        MuscleWork { effort: 0.0456, largest_activation, endurance_s, missing_nm, busiest: Vec::new() }
    }

    #[test]
    fn the_endurance_is_in_words_and_called_an_estimate() {
        let words = |work: MuscleWork| work.to_string();
        let head = "effort 0.046, largest activation";
        assert_eq!(words(work(0.12, None, None)), format!("{head} 12 %; can be held for hours (estimate)"));
        assert_eq!(words(work(0.3, Some(242.0), None)), format!("{head} 30 %; can be held about 4 min (estimate)"));
        assert_eq!(words(work(0.5, Some(66.4), None)), format!("{head} 50 %; can be held about 66 s (estimate)"));
        // A minute and a half is no round number of minutes.
        assert_eq!(words(work(0.4, Some(95.0), None)), format!("{head} 40 %; can be held about 95 s (estimate)"));
        assert_eq!(words(work(1.0, Some(6.0), Some(1.28))), format!("{head} 100 %; cannot: 1.3 N m missing"));
    }

    #[test]
    fn a_chart_ends_above_every_activation() {
        for (largest, top) in [(0.0, 0.2), (0.2, 0.2), (0.21, 0.3), (0.31, 0.5), (0.51, 1.0), (1.0, 1.0)] {
            assert_eq!(work(largest, None, None).chart_top(), top);
        }
    }
}
