//! How well the predicted load factor tells runs that hold from runs that fail (`docs/method.md#105-agreement`).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::interval::wilson;

/// The most points of a curve.
const POINTS: usize = 100;
/// The number of bins of the calibration.
const BINS: usize = 10;

/// A predicted load factor, and whether the simulation held.
pub type Case = (f64, bool);

/// Agreement of prediction and simulation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Agreement {
    /// The simulated runs with a prediction.
    pub runs: u64,
    /// The probability that a run that holds has a larger predicted load factor than one that fails, half for equal ones: the area
    /// under the curve. Absent if all hold or all fail.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub area: Option<f64>,
    /// The curve from (0, 0) to (1, 1): of a threshold of the load factor, the share of failing runs above it and that of holding
    /// ones. Empty if all hold or all fail.
    pub curve: Vec<[f64; 2]>,
    /// Bins of the predicted load factor with about equally many runs.
    pub calibration: Vec<CalibrationBin>,
}

/// Runs with similar predicted load factors.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CalibrationBin {
    /// Mean predicted load factor.
    pub load_factor: f64,
    /// The number of runs.
    pub runs: u64,
    /// The share that holds in simulation.
    pub held: f64,
    /// The lower end of its interval at 95 %.
    pub low: f64,
    /// The upper end.
    pub high: f64,
}

impl Agreement {
    /// The agreement over these cases; infinite and absent load factors are left out by the caller.
    #[must_use]
    pub fn of(mut cases: Vec<Case>) -> Self {
        cases.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let held = cases.iter().filter(|(_, held)| *held).count();
        let both = held > 0 && held < cases.len();
        let curve = if both { curve(&cases, held) } else { Vec::new() };
        let area = both.then(|| curve.windows(2).map(|pair| trapezium(pair[0], pair[1])).sum());
        Self { runs: cases.len() as u64, area, curve: thinned(curve), calibration: calibration(&cases) }
    }
}

/// One point after each group of equal load factors, from the largest on.
fn curve(cases: &[Case], held: usize) -> Vec<[f64; 2]> {
    let failed = cases.len() - held;
    let (mut true_positives, mut false_positives) = (0, 0);
    let mut curve = vec![[0.0, 0.0]];
    for group in cases.chunk_by(|a, b| a.0 == b.0) {
        let holding = group.iter().filter(|(_, held)| *held).count();
        true_positives += holding;
        false_positives += group.len() - holding;
        curve.push([false_positives as f64 / failed as f64, true_positives as f64 / held as f64]);
    }
    curve
}

fn trapezium(from: [f64; 2], to: [f64; 2]) -> f64 {
    (to[0] - from[0]) * (to[1] + from[1]) / 2.0
}

/// The curve with at most [`POINTS`] points, its corners among them where there are few.
fn thinned(curve: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    if curve.len() <= POINTS {
        return curve;
    }
    let last = curve.len() - 1;
    (0..POINTS).map(|point| curve[point * last / (POINTS - 1)]).collect()
}

fn calibration(cases: &[Case]) -> Vec<CalibrationBin> {
    let bin = |number: usize| {
        let [from, to] = [number, number + 1].map(|edge| edge * cases.len() / BINS);
        let of = &cases[from..to];
        let runs = of.len();
        let held = of.iter().filter(|(_, held)| *held).count() as f64 / runs.max(1) as f64;
        let [low, high] = wilson(held, runs as f64, 0.95);
        let load_factor = of.iter().map(|(load_factor, _)| load_factor).sum::<f64>() / runs.max(1) as f64;
        (runs > 0).then_some(CalibrationBin { load_factor, runs: runs as u64, held, low, high })
    };
    // From the smallest load factor on.
    (0..BINS).rev().filter_map(bin).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_area_is_the_share_of_pairs_in_the_right_order() {
        let cases = [(1.3, true), (1.2, true), (1.1, false), (1.1, true), (1.0, false), (0.9, true), (0.8, false)];
        let mut pairs = 0.0;
        for (holding, _) in cases.iter().filter(|case| case.1) {
            for (failing, _) in cases.iter().filter(|case| !case.1) {
                pairs += if holding > failing {
                    1.0
                } else if holding == failing {
                    0.5
                } else {
                    0.0
                };
            }
        }
        let found = Agreement::of(cases.to_vec());
        assert!((found.area.unwrap() - pairs / 12.0).abs() < 1e-15);
        assert_eq!((found.curve[0], *found.curve.last().unwrap()), ([0.0, 0.0], [1.0, 1.0]));
    }

    #[test]
    fn a_perfect_prediction_has_the_area_one_and_a_useless_one_a_half() {
        let cases = |held: &dyn Fn(usize) -> bool| (0..1000).map(|k| (k as f64 / 500.0, held(k))).collect::<Vec<_>>();
        assert_eq!(Agreement::of(cases(&|k| k >= 400)).area, Some(1.0));
        let useless = Agreement::of((0..1000).map(|k| (1.0, k % 3 == 0)).collect()).area.unwrap();
        assert!((useless - 0.5).abs() < 1e-12);
        let perfect = Agreement::of(cases(&|k| k >= 500));
        assert_eq!(perfect.calibration.len(), 10);
        assert!(perfect.calibration.windows(2).all(|pair| pair[0].load_factor < pair[1].load_factor));
        assert!(perfect.calibration.iter().all(|bin| bin.held == f64::from(bin.load_factor >= 1.0)));
        assert!(perfect.curve.len() <= 100);
    }

    #[test]
    fn without_two_outcomes_there_is_no_curve() {
        for cases in [Vec::new(), vec![(1.0, true); 5], vec![(1.0, false); 5]] {
            let found = Agreement::of(cases);
            assert!(found.area.is_none() && found.curve.is_empty());
        }
    }
}
