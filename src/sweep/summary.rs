//! What came of a sweep: `sweep.json`.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    agreement::Agreement,
    estimate::Estimate,
    indices::{Index, decorrelated, first_order},
    info::SweepInfo,
    record::{MeasuredRun, RunRecord},
};
use crate::model::{
    sweep::Quantity,
    verdict::{CheckKind, VerdictKind},
};

/// The probabilities of the quantiles.
pub const QUANTILES: [f64; 9] = [0.0, 0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99, 1.0];

/// What a sweep is and what came of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SweepSummary {
    /// What the sweep is.
    pub info: SweepInfo,
    /// The number of runs that were done.
    pub done: u64,
    /// The probability of the expected verdict.
    pub estimate: Estimate,
    /// Whether the expectation is met; absent without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub met: Option<bool>,
    /// The number of runs with each verdict.
    pub verdicts: BTreeMap<String, u64>,
    /// The number of failing runs by the check whose limit was crossed first.
    pub first_checks: BTreeMap<String, u64>,
    /// Quantiles of what was simulated and predicted.
    pub quantiles: Vec<Quantiles>,
    /// Which uncertainty matters: by quantity, the largest first.
    pub importance: Vec<Importance>,
    /// How well the prediction tells runs that hold from runs that fail.
    pub agreement: Agreement,
    /// The worst runs, the worst first.
    pub worst: Vec<WorstRun>,
}

/// Quantiles of a figure over the runs that have it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Quantiles {
    /// The figure: a column of `runs.csv`.
    pub figure: String,
    /// The number of runs that have it.
    pub runs: u64,
    /// Its quantiles at 0, 1, 5, 25, 50, 75, 95, 99 and 100 %; those of runs that were simulated, which are not a random choice if
    /// others were screened.
    pub values: Vec<f64>,
}

/// First-order Sobol indices of a quantity; those of its axes, arms or joints are added.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Importance {
    /// The quantity.
    pub quantity: Quantity,
    /// The name of its variable.
    pub variable: String,
    /// For the predicted load factor.
    pub load_factor: Index,
    /// For holding or not.
    pub holds: Index,
}

/// A run that is among the worst.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WorstRun {
    /// Its index.
    pub run: u64,
    /// Its verdict.
    pub verdict: VerdictKind,
    /// The multiple of the load at which a limit was crossed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failed_at: Option<f64>,
    /// The check of this limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_check: Option<CheckKind>,
    /// The predicted load factor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub load_factor: Option<f64>,
    /// The drawn values that are farthest from usual ones, in standard deviations of the runs: name and distance, the farthest first.
    pub unusual: Vec<(String, f64)>,
}

/// The number of drawn values that are named of each of the worst runs.
const UNUSUAL: usize = 3;

impl SweepSummary {
    /// The indices of the worst runs.
    #[must_use]
    pub fn worst_runs(&self) -> Vec<u64> {
        self.worst.iter().map(|run| run.run).collect()
    }

    /// False if an expected probability is not shown.
    #[must_use]
    pub fn is_met(&self) -> bool {
        self.met.unwrap_or(true)
    }
}

/// The summary of runs in the order of their indices.
#[must_use]
pub fn summarise(info: &SweepInfo, records: &[RunRecord]) -> SweepSummary {
    let estimate = Estimate::of(&info.expect, records);
    let mut verdicts = BTreeMap::new();
    let mut first_checks = BTreeMap::new();
    for run in records {
        *verdicts.entry(run.verdict.name().to_owned()).or_insert(0) += 1;
        if let Some(check) = run.measured.and_then(|measured| measured.first_check) {
            *first_checks.entry(check.name().to_owned()).or_insert(0) += 1;
        }
    }
    let simulated = records.iter().filter(|run| run.measured.is_some());
    let cases = simulated.filter_map(|run| Some((finite_load_factor(run)?, run.verdict == VerdictKind::Holds)));
    SweepSummary {
        done: records.len() as u64,
        // Shown, not only likely: the whole interval lies at or above the expected probability.
        met: info.expect.probability.map(|expected| estimate.low >= expected),
        estimate,
        verdicts,
        first_checks,
        quantiles: quantiles(records),
        importance: importance(info, records),
        agreement: Agreement::of(cases.collect()),
        worst: worst(info, records),
        info: info.clone(),
    }
}

/// The predicted load factor, but for an infinite one, of a load without a limit, which JSON cannot say.
fn finite_load_factor(run: &RunRecord) -> Option<f64> {
    run.predicted.map(|predicted| predicted.load_factor).filter(|load_factor| load_factor.is_finite())
}

/// The quantiles of each figure.
fn quantiles(records: &[RunRecord]) -> Vec<Quantiles> {
    let measured =
        |of: fn(&MeasuredRun) -> f64| records.iter().filter_map(|run| run.measured.as_ref().map(of)).collect();
    let figures: [(&str, Vec<f64>); 6] = [
        ("predicted_load_factor", records.iter().filter_map(finite_load_factor).collect()),
        ("slip_mm", measured(|run| run.slip_mm)),
        ("slip_deg", measured(|run| run.slip_deg)),
        ("deflection_mm", measured(|run| run.deflection_mm)),
        ("torque_ratio", measured(|run| run.torque_ratio)),
        ("failed_at", records.iter().filter_map(|run| run.measured?.failed_at).collect()),
    ];
    let some = figures.into_iter().filter(|(_, values)| !values.is_empty());
    some.map(|(figure, mut values)| {
        values.sort_by(f64::total_cmp);
        let at = |share: f64| values[(share * (values.len() - 1) as f64).round() as usize];
        Quantiles { figure: figure.into(), runs: values.len() as u64, values: QUANTILES.map(at).to_vec() }
    })
    .collect()
}

/// The indices of each quantity.
fn importance(info: &SweepInfo, records: &[RunRecord]) -> Vec<Importance> {
    let (with_prediction, load_factors): (Vec<&RunRecord>, Vec<f64>) =
        records.iter().filter_map(|run| Some((run, finite_load_factor(run)?))).unzip();
    let all_runs: Vec<&RunRecord> = records.iter().collect();
    let held: Vec<f64> = records.iter().map(|run| f64::from(run.verdict == info.expect.verdict)).collect();
    let mut places: BTreeMap<Quantity, Vec<usize>> = BTreeMap::new();
    for (place, dimension) in info.dimensions.iter().enumerate() {
        places.entry(dimension.quantity).or_default().push(place);
    }
    let of_quantity = |(quantity, places): (Quantity, Vec<usize>)| Importance {
        quantity,
        variable: info.dimensions[places[0]].name.split('.').next().unwrap_or_default().to_owned(),
        load_factor: index(&inputs(info, quantity, &places, &with_prediction), &load_factors),
        holds: index(&inputs(info, quantity, &places, &all_runs), &held),
    };
    let mut all: Vec<Importance> = places.into_iter().map(of_quantity).collect();
    all.sort_by(|a, b| b.load_factor.value.total_cmp(&a.load_factor.value).then(a.quantity.cmp(&b.quantity)));
    all
}

/// The sum of the indices of independent inputs.
fn index(inputs: &[Vec<f64>], output: &[f64]) -> Index {
    let indices = inputs.iter().map(|input| first_order(input, output).unwrap_or_default());
    indices.reduce(Index::and).unwrap_or_default()
}

/// Independent inputs with the drawn values of a quantity.
fn inputs(info: &SweepInfo, quantity: Quantity, places: &[usize], runs: &[&RunRecord]) -> Vec<Vec<f64>> {
    let columns: Vec<Vec<f64>> =
        places.iter().map(|&place| runs.iter().map(|run| run.values[place]).collect()).collect();
    let variable = info.variables.iter().find(|variable| variable.quantity == quantity);
    let correlation = variable.and_then(|variable| variable.correlation).or(quantity.usual_correlation());
    match correlation {
        Some(correlation) if columns.len() > 1 && correlation > 0.0 => decorrelated(&columns),
        _ => columns,
    }
}

/// The worst runs: without the expected verdict before others, then by the load at which they failed, then by the predicted load
/// factor, then by index.
fn worst(info: &SweepInfo, records: &[RunRecord]) -> Vec<WorstRun> {
    let rank = |run: &RunRecord| {
        let failed_at = run.measured.and_then(|measured| measured.failed_at).unwrap_or(f64::INFINITY);
        let load_factor = run.predicted.map_or(f64::INFINITY, |predicted| predicted.load_factor);
        (run.verdict == info.expect.verdict, failed_at, load_factor)
    };
    let mut order: Vec<(&RunRecord, (bool, f64, f64))> = records.iter().map(|run| (run, rank(run))).collect();
    order.sort_by(|(a, of_a), (b, of_b)| {
        let by_figures = of_a.1.total_cmp(&of_b.1).then(of_a.2.total_cmp(&of_b.2));
        of_a.0.cmp(&of_b.0).then(by_figures).then(a.index.cmp(&b.index))
    });
    let spreads = spreads(info, records);
    let worst = order.into_iter().take(info.recorded).map(|(run, _)| WorstRun {
        run: run.index,
        verdict: run.verdict,
        failed_at: run.measured.and_then(|measured| measured.failed_at),
        first_check: run.measured.and_then(|measured| measured.first_check),
        load_factor: finite_load_factor(run),
        unusual: unusual(info, run, &spreads),
    });
    worst.collect()
}

/// Mean and standard deviation of each drawn value.
fn spreads(info: &SweepInfo, records: &[RunRecord]) -> Vec<[f64; 2]> {
    let count = records.len().max(1) as f64;
    let spread = |place: usize| {
        let mean = records.iter().map(|run| run.values[place]).sum::<f64>() / count;
        let variance = records.iter().map(|run| (run.values[place] - mean).powi(2)).sum::<f64>() / count;
        [mean, variance.sqrt()]
    };
    (0..info.dimensions.len()).map(spread).collect()
}

fn unusual(info: &SweepInfo, run: &RunRecord, spreads: &[[f64; 2]]) -> Vec<(String, f64)> {
    let named = info.dimensions.iter().zip(&run.values).zip(spreads);
    let mut all: Vec<(String, f64)> = named
        .filter(|(_, [_, sd])| *sd > 0.0)
        .map(|((dimension, value), [mean, sd])| (dimension.name.clone(), (value - mean) / sd))
        .collect();
    all.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()).then_with(|| a.0.cmp(&b.0)));
    all.truncate(UNUSUAL);
    all
}

#[cfg(test)]
mod tests;
