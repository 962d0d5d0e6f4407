//! The first screen of the report: four pictures, and what was found in five sentences.

use std::fmt::Write as _;

use super::{figure, picture_name, picture_title, tables};
use crate::{
    model::{operation::OperationKind, scenario::PlannerKind},
    reproduce::{
        claims,
        evaluation::{HoldRow, KINDS, Reproduction, Results, task},
        printed, table,
    },
};

/// Pictures of the comfort planner's holds of both evaluations, and the sentences.
pub fn opening(text: &mut String, results: &Results) {
    text.push_str(
        "The holds of Chen, Figueredo and Dogar, *Planning for Muscular and Peripersonal-Space Comfort during Human-Robot\n\
         Forceful Collaboration* (IEEE-RAS Humanoids 2018, \"the paper\"), planned twice: for a person who stands as people stand, and\n\
         by the paper's formulas as printed. Each plan was then loaded in simulation.\n\n\
         | | natural | as printed |\n|---|---|---|\n",
    );
    for kind in KINDS {
        let cells = [(&results.natural, ""), (&results.printed, "printed/")]
            .map(|(reproduction, folder)| picture(reproduction, kind, folder).unwrap_or_default());
        if cells.iter().any(|cell| !cell.is_empty()) {
            let _ = writeln!(text, "| {} | {} | {} |", task(kind), cells[0], cells[1]);
        }
    }
    text.push('\n');
    let sentences = [orders(results), postures(results), effort(results), conclusions(results), holds(results)];
    let sentences: Vec<_> = sentences.into_iter().flatten().collect();
    text.push_str(&sentences.join("\n"));
    text.push_str(
        "\n\nWritten by `benchdog reproduce`; do not edit. `docs/reproduction.md` explains the figures, and lists what is not reproduced;\n\
         [the evaluation as printed](printed/report.md) has a report of its own.\n",
    );
}

/// The picture of the comfort planner's hold for the operation that is drawn.
fn picture(reproduction: &Reproduction, kind: OperationKind, folder: &str) -> Option<String> {
    let row = reproduction.hold(reproduction.drawn(kind)?, PlannerKind::Comfort)?;
    row.plan.as_ref()?;
    Some(format!("![{}]({folder}pictures/{})", picture_title(row), picture_name(row)))
}

/// Both kinds of operation, `cutting 1.73, drilling 1.69`; `None` without any.
fn by_task(of: impl Fn(OperationKind) -> Option<String>) -> Option<String> {
    let parts: Vec<_> = KINDS.into_iter().filter_map(|kind| Some(format!("{} in {}", of(kind)?, task(kind)))).collect();
    (!parts.is_empty()).then(|| parts.join(" and "))
}

/// How much better than random holds.
fn orders(results: &Results) -> Option<String> {
    let ratios = |reproduction: &Reproduction| {
        let rows = table::rows(reproduction.holds.iter());
        by_task(|kind| {
            let row = rows.iter().find(|row| row.kind == kind && row.planner == PlannerKind::Comfort)?;
            let (muscular, peripersonal) = (row.muscular_normalised?, row.peripersonal_normalised?);
            Some(format!("{muscular:.2} and {peripersonal:.2} times"))
        })
    };
    let paper = by_task(|kind| {
        let paper = printed::table(kind, PlannerKind::Comfort)?;
        Some(format!("{:.2} and {:.2} times", paper.muscular, paper.peripersonal))
    })?;
    Some(format!(
        "**Planned for comfort, a natural person has {} the muscular and the peripersonal comfort of random holds**; as printed it is {}, in\n\
         the paper's Table I {paper}.",
        ratios(&results.natural)?,
        ratios(&results.printed)?
    ))
}

/// Who stands naturally.
fn postures(results: &Results) -> Option<String> {
    let limits = tables::PostureBounds::of(&results.natural)?;
    let kept = |reproduction: &Reproduction| {
        let of_comfort: Vec<_> = comfort(reproduction).collect();
        let kept = of_comfort.iter().filter(|row| limits.are_kept(row)).count();
        format!("{kept} of {}", of_comfort.len())
    };
    Some(format!(
        "**{} of its plans keep all twelve limits of a natural posture; of the plans as printed {} do**, for the printed metric is best where\n\
         two axes of the shoulder coincide: a straight arm, raised beside the board.",
        kept(&results.natural),
        kept(&results.printed)
    ))
}

/// What an independent model of the muscles says.
fn effort(results: &Results) -> Option<String> {
    let random = |kind| tables::mean_effort(results.natural.holds.iter(), kind, Some(PlannerKind::Random));
    let of = |holds: &[HoldRow], planner| {
        by_task(|kind| {
            let share = 100.0 * tables::mean_effort(holds.iter(), kind, planner)? / random(kind)?;
            Some(format!("{share:.0} %"))
        })
    };
    let natural = of(&results.natural.holds, Some(PlannerKind::Comfort))?;
    let printed = of(&results.printed.holds, Some(PlannerKind::Comfort))?;
    let by_muscles = of(&results.natural.by_muscles, None)
        .map_or_else(String::new, |shares| format!(", and planned by the muscles themselves {shares}"));
    Some(format!(
        "**By a model of the arm's fifty muscles, which no planner of the paper knows, it needs {natural} of the effort of random natural\n\
         holds**; the plans as printed need {printed} of it{by_muscles}."
    ))
}

/// How many of the paper's conclusions are confirmed.
fn conclusions(results: &Results) -> Option<String> {
    let of = |reproduction: &Reproduction| {
        let claims = claims::claims(reproduction);
        (!claims.is_empty())
            .then(|| format!("{} of {}", claims.iter().filter(|claim| claim.holds).count(), claims.len()))
    };
    Some(format!(
        "**{} conclusions are confirmed for the natural person, {} as printed.**",
        of(&results.natural)?,
        of(&results.printed)?
    ))
}

/// What holds in simulation, and the whole circle.
fn holds(results: &Results) -> Option<String> {
    let of = |reproduction: &Reproduction| {
        let held = reproduction.first_seeds().filter(|row| claims::holds(row)).count();
        format!("{held} of {}", reproduction.first_seeds().count())
    };
    let mut sentence =
        format!("**{} natural plans hold in simulation, and {} as printed", of(&results.natural), of(&results.printed));
    let random = |circle: &crate::reproduce::evaluation::Circle| {
        let random = circle.rows.iter().find(|row| row.strategy.starts_with("random"))?;
        Some((circle.rows.first()?.mean_effort, 100.0 * random.staged_ratio?))
    };
    match results.circle.as_ref().and_then(random) {
        Some((effort, share)) => sentence.push_str(&format!(
            "**; while the robot turns the board along the whole circle the effort is {}, {share:.0} % of that of random holds.",
            figure(effort, 2)
        )),
        None => sentence.push_str(".**"),
    }
    Some(sentence)
}

/// The comfort planner's results.
fn comfort(reproduction: &Reproduction) -> impl Iterator<Item = &HoldRow> {
    reproduction.first_seeds().filter(|row| row.planner == PlannerKind::Comfort)
}
