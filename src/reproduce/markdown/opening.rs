//! The first screen of the report: four pictures, and what was found in five sentences.

use std::fmt::Write as _;

use super::{
    tables,
    words::{figure, picture_name, picture_title},
};
use crate::{
    model::{operation::OperationKind, scenario::PlannerKind},
    report::comparison::StrategyKind,
    reproduce::{
        claims,
        evaluation::{Circle, HoldRow, KINDS, Reproduction, Results, task},
        printed::{self, Printed},
        table::{self, Row},
    },
};

/// Pictures of the comfort planner's holds of both evaluations, and the sentences.
pub fn opening(text: &mut String, results: &Results) {
    text.push_str(
        "The holds of Chen, Figueredo and Dogar, *Planning for Muscular and Peripersonal-Space Comfort during Human-Robot\n\
         Forceful Collaboration* (IEEE-RAS Humanoids 2018, \"the paper\"), planned twice: for a person who stands as people stand, and\n\
         by the paper's formulas as printed. Each plan was then loaded in a simulation. The comfort planner's holds:\n\n\
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
    let found = [comfort(results), posture(results), effort(results), conclusions(results), simulation(results)];
    for sentence in found.into_iter().flatten() {
        let _ = writeln!(text, "- {sentence}");
    }
    text.push_str(
        "\nWritten by `benchdog reproduce`; do not edit. `docs/reproduction.md` explains the figures, and lists what is not reproduced;\n\
         [the evaluation as printed](printed/report.md) has a report of its own.\n",
    );
}

/// The picture of the comfort planner's hold for the operation that is drawn.
fn picture(reproduction: &Reproduction, kind: OperationKind, folder: &str) -> Option<String> {
    let row = reproduction.hold(reproduction.drawn(kind)?, PlannerKind::Comfort)?;
    row.plan.as_ref()?;
    Some(format!("![{}]({folder}pictures/{})", picture_title(row), picture_name(row)))
}

/// The figures of both kinds of operation, `1.73 and 1.69`; `None` without any.
fn pair(of: impl Fn(OperationKind) -> Option<String>) -> Option<String> {
    let parts: Vec<_> = KINDS.into_iter().filter_map(of).collect();
    (!parts.is_empty()).then(|| parts.join(" and "))
}

/// The same with their names, `1.73 in cutting and 1.69 in drilling`.
fn by_task(of: impl Fn(OperationKind) -> Option<String>) -> Option<String> {
    pair(|kind| Some(format!("{} in {}", of(kind)?, task(kind))))
}

/// A column of Table I.
type Column = fn(&Row) -> Option<f64>;

/// How much better than random holds.
fn comfort(results: &Results) -> Option<String> {
    let ratio = |reproduction: &Reproduction, kind, of: Column| {
        let rows = table::rows(reproduction.holds.iter());
        let row = rows.into_iter().find(|row| row.kind == kind && row.planner == PlannerKind::Comfort)?;
        of(&row).map(|ratio| format!("{ratio:.2}"))
    };
    let paper = |kind, of: fn(&Printed) -> f64| {
        printed::table(kind, PlannerKind::Comfort).map(|paper| format!("{:.2}", of(&paper)))
    };
    let (natural, printed) = (&results.natural, &results.printed);
    let muscular: Column = |row| row.muscular_normalised;
    let peripersonal: Column = |row| row.peripersonal_normalised;
    Some(format!(
        "**Comfort.** The comfort planner gives a natural person {} times the muscular comfort of random holds, and {} times their\n  \
         peripersonal comfort; as printed it is {} and {}; the paper's Table I has {} and {}.",
        by_task(|kind| ratio(natural, kind, muscular))?,
        pair(|kind| ratio(natural, kind, peripersonal))?,
        pair(|kind| ratio(printed, kind, muscular))?,
        pair(|kind| ratio(printed, kind, peripersonal))?,
        pair(|kind| paper(kind, |paper| paper.muscular))?,
        pair(|kind| paper(kind, |paper| paper.peripersonal))?
    ))
}

/// Who stands naturally.
fn posture(results: &Results) -> Option<String> {
    let limits = tables::PostureBounds::of(&results.natural)?;
    let kept = |reproduction: &Reproduction| {
        let of_comfort: Vec<_> = reproduction.first_seeds().filter(|row| row.planner == PlannerKind::Comfort).collect();
        let kept = of_comfort.iter().filter(|row| limits.are_kept(row)).count();
        format!("{kept} of {}", of_comfort.len())
    };
    Some(format!(
        "**Posture.** {} of its natural plans keep all twelve limits of how people stand and see; of those as printed {} do: the printed metric is\n  \
         largest where two axes of the shoulder coincide, at a straight arm that is raised beside the board.",
        kept(&results.natural),
        kept(&results.printed)
    ))
}

/// What an independent model of the muscles says.
fn effort(results: &Results) -> Option<String> {
    let random = |kind| tables::mean_effort(results.natural.holds.iter(), kind, Some(PlannerKind::Random));
    let share = |holds: &[HoldRow], kind, planner| {
        let share = 100.0 * tables::mean_effort(holds.iter(), kind, planner)? / random(kind)?;
        Some(format!("{share:.0} %"))
    };
    let comfort = Some(PlannerKind::Comfort);
    let natural = by_task(|kind| share(&results.natural.holds, kind, comfort))?;
    let printed = pair(|kind| share(&results.printed.holds, kind, comfort))?;
    let by_muscles = pair(|kind| share(&results.natural.by_muscles, kind, None))
        .map_or_else(String::new, |shares| format!("; planned by the muscles themselves it would be {shares}"));
    Some(format!(
        "**Effort.** By a model of the arm's fifty muscles, which none of these planners knows, the natural comfort plans need {natural}\n  \
         of the effort of random natural holds, and those as printed {printed}{by_muscles}."
    ))
}

/// How many of the paper's conclusions are confirmed.
fn conclusions(results: &Results) -> Option<String> {
    let of = |reproduction: &Reproduction| {
        let claims = claims::claims(reproduction);
        let confirmed = claims.iter().filter(|claim| claim.holds).count();
        (!claims.is_empty()).then(|| format!("{confirmed} of {}", claims.len()))
    };
    Some(format!(
        "**Conclusions.** {} conclusions are confirmed for the natural person, {} as printed.",
        of(&results.natural)?,
        of(&results.printed)?
    ))
}

/// What holds in simulation, and the whole circle.
fn simulation(results: &Results) -> Option<String> {
    let of = |reproduction: &Reproduction| {
        let held = reproduction.first_seeds().filter(|row| claims::holds(row)).count();
        format!("{held} of {}", reproduction.first_seeds().count())
    };
    let random = |circle: &Circle| {
        let random = circle.rows.iter().find(|row| row.strategy == StrategyKind::Random.title())?;
        Some((circle.rows.first()?.mean_effort, 100.0 * random.staged_ratio?))
    };
    let circle = results.circle.as_ref().and_then(random).map_or_else(String::new, |(effort, share)| {
        format!(
            "; while the robot turns the board along the whole circle the effort\n  is {}, {share:.0} % of that of random holds",
            figure(effort, 2)
        )
    });
    Some(format!(
        "**Simulation.** {} natural plans hold, and {} as printed{circle}.",
        of(&results.natural),
        of(&results.printed)
    ))
}
