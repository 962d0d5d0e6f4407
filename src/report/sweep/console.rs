//! A sweep on the console.

use std::fmt::Write;

use super::sentence;
use crate::sweep::summary::{Importance, SweepSummary};

/// The quantities that are listed: those that explain at least this share of the variance of the load factor.
const LEAST_INDEX: f64 = 0.005;

/// The result, the runs by verdict, quantiles, what matters and the worst runs.
#[must_use]
pub fn text(summary: &SweepSummary) -> String {
    let mut text = String::new();
    let mark = match summary.met {
        Some(true) => "ok    ",
        Some(false) => "FAIL  ",
        None => "",
    };
    // Writing to a text does not fail.
    let _ = writeln!(text, "{mark}{}: {}", summary.info.name, sentence(summary));
    let _ = writeln!(text, "{}", decided(summary));
    let _ = writeln!(text, "\nverdict          runs   share");
    let mut verdicts: Vec<_> = summary.verdicts.iter().collect();
    verdicts.sort_by(|a, b| b.1.cmp(a.1).then(a.0.cmp(b.0)));
    for (verdict, &runs) in verdicts {
        let share = runs as f64 / summary.done.max(1) as f64;
        let _ = writeln!(text, "{verdict:<14} {runs:>6}  {:>5.1} %", 100.0 * share);
    }
    let _ = writeln!(text, "\nfigure                   runs        1 %      25 %      50 %      75 %      99 %");
    for quantiles in &summary.quantiles {
        let [at_1, at_25, at_50, at_75, at_99] = [1, 3, 4, 5, 7].map(|place| quantiles.values[place]);
        let (figure, runs) = (&quantiles.figure, quantiles.runs);
        let _ =
            writeln!(text, "{figure:<22} {runs:>6}  {at_1:>9.3} {at_25:>9.3} {at_50:>9.3} {at_75:>9.3} {at_99:>9.3}");
    }
    let _ = writeln!(text, "\nwhat matters              of the load factor's variance   of holding or not");
    for Importance { variable, load_factor, holds, .. } in
        summary.importance.iter().filter(|of| of.load_factor.value >= LEAST_INDEX)
    {
        let percent = |value: f64| 100.0 * value;
        let _ = writeln!(
            text,
            "{variable:<26} {:>5.1} % ± {:>4.1}                  {:>5.1} % ± {:>4.1}",
            percent(load_factor.value),
            percent(load_factor.error),
            percent(holds.value),
            percent(holds.error)
        );
    }
    if let Some(area) = summary.agreement.area {
        let _ = writeln!(
            text,
            "\nprediction     {area:.3} of the area under its curve over {} simulated runs",
            summary.agreement.runs
        );
    }
    for run in &summary.worst {
        let unusual: Vec<String> = run.unusual.iter().map(|(name, sds)| format!("{name} {sds:+.1} sd")).collect();
        let at = run.failed_at.map(|at| format!(" at {at:.2} of the load")).unwrap_or_default();
        let _ = writeln!(text, "worst          run {:06}: {}{at}; {}", run.run, run.verdict, unusual.join(", "));
    }
    text
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
