//! The changes between two baselines.

use std::collections::BTreeSet;

use serde::Serialize;

use super::{
    baseline::{Baseline, ScenarioEntry, SweepEntry},
    noise::difference,
};

/// A figure of a sweep moved if it did by more than this many standard errors of the difference, and by more than the tolerance.
const ERRORS: f64 = 3.0;

/// The tolerance of smaller figures is that of this one: a slip of micrometres that doubles is no change.
const LEAST_FIGURE: f64 = 0.5;

/// What a change is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ChangeKind {
    /// Worse by more than the tolerance.
    Regression,
    /// Better by more than the tolerance.
    Improvement,
    /// Other, and neither worse nor better.
    Moved,
    /// Only in the second results.
    New,
}

/// A change.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Change {
    /// What it is.
    pub kind: ChangeKind,
    /// The scenario or sweep.
    pub name: String,
    /// What changed: a verdict, the margin of a check, a probability, a quantile.
    pub what: String,
    /// What it was.
    pub before: String,
    /// What it is.
    pub after: String,
    /// Why it counts, in words.
    pub by: String,
}

/// A comparison of two results.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// The changes, regressions first, then by name.
    pub changes: Vec<Change>,
    /// The number of scenarios and sweeps in both.
    pub compared: usize,
    /// Versions that differ: name, before, after.
    pub versions: Vec<(String, String, String)>,
}

impl Comparison {
    /// The number of changes of a kind.
    #[must_use]
    pub fn count(&self, kind: ChangeKind) -> usize {
        self.changes.iter().filter(|change| change.kind == kind).count()
    }
}

/// The changes from `before` to `after`. A margin changed if it did by more than `tolerance` times the limit, a probability if the
/// interval of the difference excludes 0 and it differs by more than `tolerance`.
#[must_use]
pub fn compare(before: &Baseline, after: &Baseline, tolerance: f64) -> Comparison {
    let mut changes = Vec::new();
    let mut compared = 0;
    for name in before.scenarios.keys().chain(after.scenarios.keys()).collect::<BTreeSet<_>>() {
        match (before.scenarios.get(name), after.scenarios.get(name)) {
            (Some(first), Some(second)) => {
                compared += 1;
                changes.extend(of_scenario(name, first, second, tolerance));
            }
            (first, second) => {
                let verdict = |of: Option<&ScenarioEntry>| of.map(|of| of.verdict.to_string());
                changes.push(one_sided(name, "verdict", verdict(first), verdict(second)));
            }
        }
    }
    for name in before.sweeps.keys().chain(after.sweeps.keys()).collect::<BTreeSet<_>>() {
        match (before.sweeps.get(name), after.sweeps.get(name)) {
            (Some(first), Some(second)) => {
                compared += 1;
                changes.extend(of_sweep(name, first, second, tolerance));
            }
            (first, second) => {
                let probability = |of: Option<&SweepEntry>| of.map(|of| format!("{:.4}", of.probability));
                changes.push(one_sided(name, "probability", probability(first), probability(second)));
            }
        }
    }
    changes.sort_by(|a, b| a.kind.cmp(&b.kind).then_with(|| a.name.cmp(&b.name)));
    let names: BTreeSet<_> = before.versions.keys().chain(after.versions.keys()).collect();
    let version = |of: &Baseline, name: &str| of.versions.get(name).cloned().unwrap_or_else(|| "none".into());
    let versions = names.into_iter().filter(|&name| before.versions.get(name) != after.versions.get(name));
    let versions = versions.map(|name| (name.clone(), version(before, name), version(after, name))).collect();
    Comparison { changes, compared, versions }
}

/// A result that one side lacks. One that is gone is a regression: nothing shows it any more.
fn one_sided(name: &str, what: &str, before: Option<String>, after: Option<String>) -> Change {
    let kind = if before.is_some() { ChangeKind::Regression } else { ChangeKind::New };
    let text = |of: Option<String>| of.unwrap_or_else(|| "none".into());
    let by = if before.is_some() { "gone" } else { "new" };
    Change { kind, name: name.into(), what: what.into(), before: text(before), after: text(after), by: by.into() }
}

/// Better by a positive amount, else worse: what is not a number is no improvement.
fn sided(by: f64) -> ChangeKind {
    if by > 0.0 { ChangeKind::Improvement } else { ChangeKind::Regression }
}

fn of_scenario(name: &str, before: &ScenarioEntry, after: &ScenarioEntry, tolerance: f64) -> Vec<Change> {
    let mut changes = Vec::new();
    if before.verdict != after.verdict || before.met != after.met {
        let kind = match (before.met, after.met) {
            (true, false) => ChangeKind::Regression,
            (false, true) => ChangeKind::Improvement,
            _ => ChangeKind::Moved,
        };
        let by = match kind {
            ChangeKind::Regression => "was expected, is not",
            ChangeKind::Improvement => "is expected, was not",
            _ => "another verdict",
        };
        let [before, after] = [before, after].map(|of| of.verdict.to_string());
        changes.push(Change { kind, name: name.into(), what: "verdict".into(), before, after, by: by.into() });
    }
    for (check, first) in &before.checks {
        let Some(second) = after.checks.get(check) else {
            // Without a simulation there are no checks at all, which the verdict tells.
            if !after.checks.is_empty() {
                changes.push(one_sided(name, check.name(), Some(format!("{:.3}", first.value)), None));
            }
            continue;
        };
        // Limits of zero have no share: the margin is compared with itself.
        let scale = if first.limit == 0.0 { first.margin.abs().max(1.0) } else { first.limit.abs() };
        let by = (second.margin - first.margin) / scale;
        // What failed before and fails still is told by the verdict.
        let both_fail = first.margin < 0.0 && second.margin < 0.0;
        // Not a number counts as changed.
        if by.abs() <= tolerance || both_fail {
            continue;
        }
        let unit = check.unit();
        let value = |of: f64| format!("{of:.3} {unit}").trim_end_matches(" 1").trim_end().to_owned();
        changes.push(Change {
            kind: sided(by),
            name: name.into(),
            what: check.to_string(),
            before: value(first.value),
            after: value(second.value),
            by: format!("margin {:+.1} % of the limit", 100.0 * by),
        });
    }
    changes
}

fn of_sweep(name: &str, before: &SweepEntry, after: &SweepEntry, tolerance: f64) -> Vec<Change> {
    let mut changes = Vec::new();
    if before.expected != after.expected || before.confidence != after.confidence {
        let of = |entry: &SweepEntry| format!("{} at {} confidence", entry.expected, entry.confidence);
        let by = "another expectation: not compared".to_owned();
        let (kind, what) = (ChangeKind::Moved, "expectation".to_owned());
        return vec![Change { kind, name: name.into(), what, before: of(before), after: of(after), by }];
    }
    let [first, second] = [before, after].map(|of| [of.probability, of.low, of.high]);
    let [low, high] = difference(first, second);
    let by = after.probability - before.probability;
    let is_shown = low > 0.0 || high < 0.0;
    let lost = before.met == Some(true) && after.met == Some(false);
    let gained = before.met == Some(false) && after.met == Some(true);
    if lost || gained || is_shown && by.abs() > tolerance {
        let kind = if lost {
            ChangeKind::Regression
        } else if gained {
            ChangeKind::Improvement
        } else {
            sided(by)
        };
        let interval = |of: &SweepEntry| format!("{:.4} ({:.4} to {:.4})", of.probability, of.low, of.high);
        let expected = if lost {
            "; no longer as expected"
        } else if gained {
            "; now as expected"
        } else {
            ""
        };
        changes.push(Change {
            kind,
            name: name.into(),
            what: "probability".into(),
            before: interval(before),
            after: interval(after),
            by: format!("{by:+.4}, {low:+.4} to {high:+.4}{expected}"),
        });
    }
    changes.extend(of_figures(name, before, after, tolerance));
    changes
}

/// The quantiles that changed.
fn of_figures(name: &str, before: &SweepEntry, after: &SweepEntry, tolerance: f64) -> Vec<Change> {
    let mut changes = Vec::new();
    for (figure, [first, first_error]) in &before.figures {
        let Some([second, second_error]) = after.figures.get(figure) else { continue };
        let of_all = figure.starts_with("predicted_load_factor");
        if before.screened != after.screened && !of_all {
            continue;
        }
        let (by, error) = (second - first, first_error.hypot(*second_error));
        if by.abs() <= ERRORS * error || by.abs() <= tolerance * first.abs().max(LEAST_FIGURE) {
            continue;
        }
        // A larger load factor is better, and so is a later failure; of other figures less is better.
        let better_by = if of_all || figure.starts_with("failed_at") { by } else { -by };
        changes.push(Change {
            kind: sided(better_by),
            name: name.into(),
            what: figure.clone(),
            before: format!("{first:.3}"),
            after: format!("{second:.3}"),
            by: format!("{by:+.3}, standard error {error:.3}"),
        });
    }
    changes
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::{
        compare::CheckEntry,
        model::verdict::{CheckKind, VerdictKind},
        sweep::{info::Fingerprints, interval::wilson},
    };

    fn scenario(verdict: VerdictKind, met: bool, deflection_mm: f64) -> ScenarioEntry {
        let deflection = CheckEntry { value: deflection_mm, limit: 5.0, margin: 5.0 - deflection_mm };
        let overlap = CheckEntry { value: -200.0, limit: 0.0, margin: 200.0 };
        ScenarioEntry {
            verdict,
            met,
            checks: BTreeMap::from([(CheckKind::Deflection, deflection), (CheckKind::PersonOverlap, overlap)]),
        }
    }

    fn sweep(seen: f64, runs: f64, deflection_mm: f64) -> SweepEntry {
        let [low, high] = wilson(seen / runs, runs, 0.95);
        SweepEntry {
            expected: VerdictKind::Holds,
            probability: seen / runs,
            confidence: 0.95,
            screened: false,
            low,
            high,
            runs: runs as u64,
            met: None,
            figures: BTreeMap::from([("deflection_mm 50 %".into(), [deflection_mm, 0.02])]),
            fingerprints: Fingerprints { program: String::new(), inputs: String::new() },
        }
    }

    fn scenarios(entries: &[(&str, ScenarioEntry)]) -> Baseline {
        let scenarios = entries.iter().map(|(name, entry)| ((*name).to_owned(), entry.clone())).collect();
        Baseline { scenarios, ..Baseline::empty() }
    }

    fn sweeps(entry: SweepEntry) -> Baseline {
        Baseline { sweeps: BTreeMap::from([("s".into(), entry)]), ..Baseline::empty() }
    }

    fn kinds(before: &Baseline, after: &Baseline) -> Vec<(ChangeKind, String)> {
        compare(before, after, 0.02).changes.into_iter().map(|change| (change.kind, change.what)).collect()
    }

    #[test]
    fn the_same_results_have_no_changes() {
        let both = scenarios(&[("a", scenario(VerdictKind::Holds, true, 4.0))]);
        let found = compare(&both, &both, 0.0);
        assert!(found.changes.is_empty() && found.compared == 1 && found.versions.is_empty());
        let both = sweeps(sweep(90.0, 100.0, 4.0));
        assert!(kinds(&both, &both).is_empty());
    }

    #[test]
    fn a_verdict_that_is_no_longer_expected_is_a_regression_and_the_reverse_an_improvement() {
        let holds = scenarios(&[("a", scenario(VerdictKind::Holds, true, 4.0))]);
        let slips = scenarios(&[("a", scenario(VerdictKind::Slips, false, 4.0))]);
        assert_eq!(kinds(&holds, &slips), [(ChangeKind::Regression, "verdict".to_owned())]);
        assert_eq!(kinds(&slips, &holds), [(ChangeKind::Improvement, "verdict".to_owned())]);
        let pivots = scenarios(&[("a", scenario(VerdictKind::Pivots, false, 4.0))]);
        assert_eq!(kinds(&slips, &pivots), [(ChangeKind::Moved, "verdict".to_owned())]);
    }

    #[test]
    fn a_margin_counts_beyond_the_tolerance_times_the_limit() {
        let at = |deflection_mm| scenarios(&[("a", scenario(VerdictKind::Holds, true, deflection_mm))]);
        // 2 % of 5 mm are 0.1 mm.
        assert!(kinds(&at(4.0), &at(4.09)).is_empty());
        assert_eq!(kinds(&at(4.0), &at(4.11)), [(ChangeKind::Regression, "deflection".to_owned())]);
        assert_eq!(kinds(&at(4.0), &at(3.8)), [(ChangeKind::Improvement, "deflection".to_owned())]);
        assert_eq!(kinds(&at(4.0), &at(f64::NAN)), [(ChangeKind::Regression, "deflection".to_owned())]);
    }

    #[test]
    fn a_result_that_is_gone_is_a_regression_and_a_new_one_is_not() {
        let [one, two] = [&["a"][..], &["a", "b"]].map(|names| {
            let entries: Vec<_> = names.iter().map(|name| (*name, scenario(VerdictKind::Holds, true, 4.0))).collect();
            scenarios(&entries)
        });
        assert_eq!(kinds(&two, &one), [(ChangeKind::Regression, "verdict".to_owned())]);
        assert_eq!(kinds(&one, &two), [(ChangeKind::New, "verdict".to_owned())]);
    }

    #[test]
    fn a_probability_counts_if_chance_does_not_explain_it() {
        let of = |seen: f64, runs: f64| sweeps(sweep(seen, runs, 4.0));
        // 0.95 and 0.90: of 100 runs chance, of 10000 not.
        assert!(kinds(&of(95.0, 100.0), &of(90.0, 100.0)).is_empty());
        assert_eq!(kinds(&of(9500.0, 1e4), &of(9000.0, 1e4)), [(ChangeKind::Regression, "probability".to_owned())]);
        assert_eq!(kinds(&of(9000.0, 1e4), &of(9500.0, 1e4)), [(ChangeKind::Improvement, "probability".to_owned())]);
        // Shown, and within the tolerance.
        assert!(kinds(&of(995_000.0, 1e6), &of(990_000.0, 1e6)).is_empty());
        let met = |met| Baseline {
            sweeps: BTreeMap::from([("s".into(), SweepEntry { met: Some(met), ..sweep(99.0, 100.0, 4.0) })]),
            ..Baseline::empty()
        };
        assert_eq!(kinds(&met(true), &met(false)), [(ChangeKind::Regression, "probability".to_owned())]);
    }

    #[test]
    fn a_quantile_counts_beyond_its_error_and_the_tolerance() {
        let at = |deflection_mm| sweeps(sweep(90.0, 100.0, deflection_mm));
        // Three errors of the difference are 0.085 mm, the tolerance is 0.08.
        assert!(kinds(&at(4.0), &at(4.083)).is_empty());
        assert_eq!(kinds(&at(4.0), &at(4.1)), [(ChangeKind::Regression, "deflection_mm 50 %".to_owned())]);
        assert_eq!(kinds(&at(4.0), &at(3.9)), [(ChangeKind::Improvement, "deflection_mm 50 %".to_owned())]);
        // Of small figures the tolerance is 0.01.
        let exact = |deflection_mm| {
            let figures = BTreeMap::from([("slip_mm 50 %".into(), [deflection_mm, 0.0])]);
            sweeps(SweepEntry { figures, ..sweep(90.0, 100.0, 4.0) })
        };
        assert!(kinds(&exact(0.0), &exact(0.009)).is_empty());
        assert_eq!(kinds(&exact(0.0), &exact(0.011)), [(ChangeKind::Regression, "slip_mm 50 %".to_owned())]);
        // A screen selects the simulated runs.
        let screened = sweeps(SweepEntry { screened: true, ..sweep(90.0, 100.0, 9.0) });
        assert!(kinds(&at(4.0), &screened).is_empty());
    }

    #[test]
    fn probabilities_of_different_verdicts_are_not_compared() {
        let slips = sweeps(SweepEntry { expected: VerdictKind::Slips, ..sweep(5.0, 100.0, 9.0) });
        let found = kinds(&sweeps(sweep(95.0, 100.0, 4.0)), &slips);
        assert_eq!(found, [(ChangeKind::Moved, "expectation".to_owned())]);
    }
}
