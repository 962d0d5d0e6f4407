//! A sweep on the console.

use std::fmt::Write;

use super::{super::columns::aligned, sentence};
use crate::sweep::{
    indices::Index,
    summary::{Importance, SweepSummary},
};

/// The quantities that are listed: those that explain at least this share of the variance of the load factor.
const LEAST_INDEX: f64 = 0.005;

/// The result, the runs by verdict, quantiles, what matters and the worst runs.
#[must_use]
pub fn text(summary: &SweepSummary) -> String {
    let mark = match summary.met {
        Some(true) => "ok    ",
        Some(false) => "FAIL  ",
        None => "",
    };
    let mut text = format!("{mark}{}: {}\n{}\n", summary.info.name, sentence(summary), decided(summary));
    let tables = [(verdicts(summary), 1), (quantiles(summary), 1), (importance(summary), 1), (worst(summary), 3)];
    // A table of a head alone says nothing.
    for (rows, left) in tables.into_iter().filter(|(rows, _)| rows.len() > 1) {
        text.push('\n');
        text.push_str(&aligned(&rows, left));
    }
    if let Some(area) = summary.agreement.area {
        // Writing to a text does not fail.
        let _ = writeln!(
            text,
            "\nprediction: {area:.3} of the area under its curve over {} simulated runs",
            summary.agreement.runs
        );
    }
    text
}

fn texts<const N: usize>(cells: [&str; N]) -> Vec<String> {
    cells.map(str::to_owned).to_vec()
}

fn verdicts(summary: &SweepSummary) -> Vec<Vec<String>> {
    let mut verdicts: Vec<_> = summary.verdicts.iter().collect();
    verdicts.sort_by(|a, b| b.1.cmp(a.1).then(a.0.cmp(b.0)));
    let row = |(verdict, &runs): (&String, &u64)| {
        let share = runs as f64 / summary.done.max(1) as f64;
        vec![verdict.clone(), runs.to_string(), format!("{:.1} %", 100.0 * share)]
    };
    std::iter::once(texts(["verdict", "runs", "share"])).chain(verdicts.into_iter().map(row)).collect()
}

fn quantiles(summary: &SweepSummary) -> Vec<Vec<String>> {
    let rows = summary.quantiles.iter().map(|of| {
        let shown = [1, 3, 4, 5, 7].map(|place| format!("{:.3}", of.values[place]));
        [of.figure.clone(), of.runs.to_string()].into_iter().chain(shown).collect()
    });
    std::iter::once(texts(["figure", "runs", "1 %", "25 %", "50 %", "75 %", "99 %"])).chain(rows).collect()
}

fn importance(summary: &SweepSummary) -> Vec<Vec<String>> {
    let shown = summary.importance.iter().filter(|of| of.load_factor.value >= LEAST_INDEX.max(of.load_factor.error));
    let rows = shown.map(|of: &Importance| vec![of.variable.clone(), share(of.load_factor), share(of.holds)]);
    std::iter::once(texts(["what matters", "of the load factor", "of holding or not"])).chain(rows).collect()
}

/// An index with its standard error. An estimate below 0 is shown as 0: no share is negative.
fn share(Index { value, error }: Index) -> String {
    format!("{:.1} ± {:.1} %", 100.0 * value.max(0.0), 100.0 * error)
}

fn worst(summary: &SweepSummary) -> Vec<Vec<String>> {
    let rows = summary.worst.iter().map(|run| {
        let unusual: Vec<String> = run.unusual.iter().map(|(name, sds)| format!("{name} {sds:+.1} sd")).collect();
        let at = run.failed_at.map(|at| format!(" at {at:.2} of the load")).unwrap_or_default();
        vec![format!("{:06}", run.run), format!("{}{at}", run.verdict), unusual.join(", ")]
    });
    std::iter::once(texts(["worst run", "verdict", "unusual values"])).chain(rows).collect()
}

/// How the runs were decided.
pub fn decided(summary: &SweepSummary) -> String {
    let estimate = &summary.estimate;
    let part = summary.info.shard.map(|shard| format!(", part {shard}")).unwrap_or_default();
    let simulated = summary.done - estimate.screened;
    let mut text = format!("{} runs{part}: {simulated} simulated", summary.done);
    if estimate.screened + estimate.audited > 0 {
        let _ = write!(
            text,
            ", {} decided by the statics; of {} that were simulated as a check {} were mistakes",
            estimate.screened, estimate.audited, estimate.mistakes
        );
    }
    text
}
