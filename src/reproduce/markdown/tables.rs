//! The tables that have both evaluations.

use std::fmt::Write as _;

use super::words::figure;
use crate::{
    model::{
        operation::OperationKind,
        plan::{Comfort, PostureConstraint, PostureFigure},
        scenario::PlannerKind,
    },
    reproduce::{
        claims::{self, Claim},
        evaluation::{HoldRow, KINDS, Kept, Reproduction, Results, task},
        paper::Evaluation,
        printed::{self, Printed},
        statistics,
        table::{self, Row},
    },
};

/// Both evaluations with their names.
fn both(results: &Results) -> [(&'static str, &Reproduction); 2] {
    [(Evaluation::Natural.name(), &results.natural), (Evaluation::Printed.name(), &results.printed)]
}

/// Rows of Table I of both evaluations, by task and planner.
fn rows_of_both(results: &Results) -> Vec<[Option<Row>; 2]> {
    let tables = both(results).map(|(_, reproduction)| table::rows(reproduction.holds.iter()));
    let find =
        |table: &[Row], kind, planner| table.iter().find(|row| row.kind == kind && row.planner == planner).cloned();
    let keys = KINDS.into_iter().flat_map(|kind| PlannerKind::ALL.map(|planner| (kind, planner)));
    keys.map(|(kind, planner)| tables.each_ref().map(|table| find(table, kind, planner)))
        .filter(|rows| rows.iter().any(Option::is_some))
        .collect()
}

/// Table I of both evaluations beside the paper's.
pub fn table_one(text: &mut String, results: &Results) {
    let _ = write!(
        text,
        "\n## Table I\n\nMeans over the operations, divided by those of the random planner of the same evaluation ({} seeds per operation;\n\
         `table1.csv`, `printed/table1.csv`).\n\n\
         | task | planner | muscular: natural | as printed | paper | peripersonal: natural | as printed | paper |\n\
         |---|---|---|---|---|---|---|---|\n",
        results.natural.random_seeds
    );
    for rows in rows_of_both(results) {
        let Some(Row { kind, planner, .. }) = rows.iter().flatten().next() else { continue };
        let of = |column: fn(&Row) -> Option<f64>| {
            rows.each_ref().map(|row| figure(row.as_ref().and_then(column), 2)).join(" | ")
        };
        let paper = printed::table(*kind, *planner);
        let of_paper = |which: fn(&Printed) -> f64| figure(paper.as_ref().map(which), 2);
        let _ = writeln!(
            text,
            "| {} | {planner} | {} | {} | {} | {} |",
            task(*kind),
            of(|row| row.muscular_normalised),
            of_paper(|paper| paper.muscular),
            of(|row| row.peripersonal_normalised),
            of_paper(|paper| paper.peripersonal)
        );
    }
}

/// The paper's conclusions, tested on both evaluations.
pub fn claims(text: &mut String, results: &Results) {
    text.push_str("\n## The paper's conclusions\n\n| conclusion | natural | as printed |\n|---|---|---|\n");
    let [natural, printed] = both(results).map(|(_, reproduction)| claims::claims(reproduction));
    let cell = |claim: Option<&Claim>| {
        claim.map_or_else(
            || "-".to_owned(),
            |claim| format!("{}: {}", if claim.holds { "yes" } else { "**no**" }, claim.figures),
        )
    };
    for claim in &natural {
        let other = printed.iter().find(|other| other.sentence == claim.sentence);
        let _ = writeln!(text, "| {} | {} | {} |", claim.sentence, cell(Some(claim)), cell(other));
    }
}

/// The mean comforts in their own units, beside the captions of the paper.
pub fn raw(text: &mut String, results: &Results) {
    text.push_str(
        "\n## Values beside the paper's captions\n\nMuscular comfort is the intrinsic one, `1 / (||alpha||^2 + 0.0175)`, for the natural person, and the regularised one,\n\
         `1 / (||alpha||^2 + 0.01)`, as printed; the two are not comparable. In brackets the median of `1 / ||alpha||^2`, the metric of\n\
         the paper. Peripersonal comfort is the sum over 64 body points. A caption is one configuration. `candidates` is the mean\n\
         number of evaluated candidates of both: the random planner draws until a candidate is feasible. Single plans are in `plans.csv`.\n\n\
         | task | planner | candidates | muscular: natural | as printed | caption | peripersonal: natural | as printed | caption |\n\
         |---|---|---|---|---|---|---|---|---|\n",
    );
    for rows in rows_of_both(results) {
        let Some(Row { kind, planner, .. }) = rows.iter().flatten().next() else { continue };
        let of = |cell: fn(&Row) -> String, separator: &str| {
            rows.each_ref().map(|row| row.as_ref().map_or_else(|| "-".to_owned(), cell)).join(separator)
        };
        let paper = printed::caption(*kind, *planner);
        let of_paper = |which: fn(&Printed) -> f64| figure(paper.as_ref().map(which), 1);
        let _ = writeln!(
            text,
            "| {} | {planner} | {} | {} | {} | {} | {} |",
            task(*kind),
            of(|row| figure(row.candidates, 0), ", "),
            of(|row| format!("{} ({})", figure(row.muscular, 1), figure(row.muscular_printed_median, 1)), " | "),
            of_paper(|paper| paper.muscular),
            of(|row| figure(row.peripersonal_scaled, 1), " | "),
            of_paper(|paper| paper.peripersonal)
        );
    }
}

/// How far a value may be beyond a limit: rounding.
const LIMIT_ROUNDING: f64 = 1e-6;

/// The limits of a natural posture, as a plan of the natural evaluation states them.
pub struct PostureBounds(Vec<(PostureConstraint, PostureFigure)>);

impl PostureBounds {
    /// Those of an evaluation with natural postures; `None` without any plan.
    pub fn of(natural: &Reproduction) -> Option<Self> {
        natural.first_seeds().find_map(|row| Some(Self(row.posture()?.iter().collect())))
    }

    /// True if the posture of a plan keeps all of them, whatever limits it was planned with.
    pub fn are_kept(&self, row: &HoldRow) -> bool {
        let is_kept = |value: f64, limit: &PostureFigure| PostureFigure { value, ..*limit }.margin() >= -LIMIT_ROUNDING;
        row.posture().is_some_and(|posture| {
            posture.iter().zip(&self.0).all(|((_, figure), (_, limit))| is_kept(figure.value, limit))
        })
    }

    /// A limit in words.
    fn words(&self, constraint: PostureConstraint) -> String {
        let limit = self.0.iter().find(|(found, _)| *found == constraint);
        limit.and_then(|(_, limit)| limit.limits_in_words()).unwrap_or_default()
    }
}

/// The figures of the ergonomist's table, with their headings.
const ERGONOMIC: [(PostureConstraint, &str); 6] = [
    (PostureConstraint::UpperArm, "upper arm, deg"),
    (PostureConstraint::Facing, "facing, deg"),
    (PostureConstraint::Reach, "reach"),
    (PostureConstraint::Elbow, "elbow, deg"),
    (PostureConstraint::View, "view, deg"),
    (PostureConstraint::FaceElevation, "face up, deg"),
];

/// What an ergonomist asks: elevation, facing, sight, reach, limits and scores, by evaluation and planner.
pub fn ergonomics(text: &mut String, results: &Results) {
    let Some(limits) = PostureBounds::of(&results.natural) else { return };
    text.push_str(
        "\n## As an ergonomist sees it\n\nMeans over the plans with the first seed: elevation of the upper arm, how far the work is to the side, distance of the wrist\n\
         as a share of the straight arm, flexion of the elbow, angle at which the face is seen, and how far the face looks up. `limits`:\n\
         how many plans keep all twelve limits of a natural posture; `sight`: how many have a clear line of sight; scores: mean and\n\
         largest (`postures.csv`, `printed/postures.csv`).\n\n| person | task | planner | limits | sight |",
    );
    ERGONOMIC.iter().for_each(|(_, heading)| text.push_str(&format!(" {heading} |")));
    text.push_str(" RULA | REBA |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n| limit | | | | clear |");
    ERGONOMIC.iter().for_each(|(constraint, _)| text.push_str(&format!(" {} |", limits.words(*constraint))));
    text.push_str(" | |\n");
    for (name, reproduction) in both(results) {
        for (kind, planner) in KINDS.into_iter().flat_map(|kind| PlannerKind::ALL.map(|planner| (kind, planner))) {
            let of = reproduction.first_seeds().filter(|row| row.kind == kind && row.planner == planner);
            let of: Vec<_> = of.filter(|row| row.plan.is_some()).collect();
            if !of.is_empty() {
                let _ = writeln!(text, "| {name} | {} | {planner} |{}", task(kind), ergonomic_cells(&of, &limits));
            }
        }
    }
}

/// The cells of a row of the ergonomist's table behind its key.
fn ergonomic_cells(rows: &[&HoldRow], limits: &PostureBounds) -> String {
    let count = rows.len();
    let values = |constraint: PostureConstraint| -> Vec<f64> {
        let of = |row: &&HoldRow| {
            row.posture()?.iter().find(|(found, _)| *found == constraint).map(|(_, figure)| figure.value)
        };
        rows.iter().filter_map(of).collect()
    };
    let kept = rows.iter().filter(|row| limits.are_kept(row)).count();
    let clear = values(PostureConstraint::LineOfSight).iter().filter(|&&share| share >= 1.0 - LIMIT_ROUNDING).count();
    let mut cells = format!(" {kept} of {count} | {clear} of {count} |");
    for (constraint, _) in ERGONOMIC {
        let digits = if constraint == PostureConstraint::Reach { 2 } else { 0 };
        let _ = write!(cells, " {} |", figure(statistics::mean(values(constraint).into_iter()), digits));
    }
    for score in [(|comfort: &Comfort| Some(comfort.rula?.score)) as fn(&Comfort) -> Option<u8>, |comfort: &Comfort| {
        Some(comfort.reba?.score)
    }] {
        let scores: Vec<_> = rows.iter().filter_map(|row| score(row.comfort()?)).map(f64::from).collect();
        let largest = scores.iter().copied().reduce(f64::max);
        let _ = write!(cells, " {}, {} |", figure(statistics::mean(scores.into_iter()), 1), figure(largest, 0));
    }
    cells
}

/// The mean effort of plans of a kind of operation, of one planner or of all.
pub fn mean_effort<'a>(
    holds: impl Iterator<Item = &'a HoldRow>,
    kind: OperationKind,
    planner: Option<PlannerKind>,
) -> Option<f64> {
    let of = holds.filter(|row| row.kind == kind && planner.is_none_or(|planner| row.planner == planner));
    statistics::mean(of.filter_map(HoldRow::effort))
}

/// The effort of the muscles by evaluation and planner.
pub fn effort(text: &mut String, results: &Results) {
    text.push_str(
        "\n## Effort by muscles\n\nThe sum of the squared activations of the fifty muscles of the working arm, by a musculoskeletal model that none of the paper's\n\
         planners uses: the mean over the operations, of the random planner over all seeds, and as a share of that of natural random\n\
         holds. `busiest`: the largest activation of a muscle, mean over the plans. `by muscles` plans for this effort in place of the\n\
         intrinsic metric, for the natural person (`effort.csv`).\n\n\
         | person | planner | cutting: effort | of random's | busiest | drilling: effort | of random's | busiest |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    let random = |kind| mean_effort(results.natural.holds.iter(), kind, Some(PlannerKind::Random));
    let mut line = |name: &str, planner: &str, holds: &[&HoldRow]| {
        let cells = KINDS.map(|kind| {
            let of = || holds.iter().copied().filter(move |row| row.kind == kind);
            let effort = mean_effort(of(), kind, None);
            let share = effort.zip(random(kind)).map(|(effort, random)| 100.0 * effort / random);
            let activation = |row: &HoldRow| Some(row.plan.as_ref()?.muscles.as_ref()?.largest_activation);
            let busiest = statistics::mean(of().filter_map(activation));
            format!("{} | {} % | {}", figure(effort, 4), figure(share, 0), figure(busiest, 2))
        });
        let _ = writeln!(text, "| {name} | {planner} | {} |", cells.join(" | "));
    };
    for (name, reproduction) in both(results) {
        for planner in PlannerKind::ALL {
            let of: Vec<_> = reproduction.holds.iter().filter(|row| row.planner == planner).collect();
            line(name, &planner.to_string(), &of);
        }
        if !reproduction.by_muscles.is_empty() {
            line(name, "comfort, by muscles", &reproduction.by_muscles.iter().collect::<Vec<_>>());
        }
    }
}

/// What the comfort planner keeps of either optimum, and how near it is to the front.
pub fn kept(text: &mut String, results: &Results) {
    if results.fronts.is_empty() {
        return;
    }
    text.push_str(
        "\n## What the comfort planner keeps\n\nOf the best muscular and the best peripersonal comfort that any plan for the operation has, on the Pareto front of both\n\
         (`benchdog front`); and its objective as a share of the best on that front at the same weights, of the operation where it is\n\
         least (`front.csv`).\n\n| task | muscular kept: mean | least | peripersonal kept: mean | least | objective: least |\n|---|---|---|---|---|---|\n",
    );
    for kind in KINDS {
        let of: Vec<_> = results.fronts.iter().filter(|front| front.kind == kind).collect();
        let kept: Vec<_> = of.iter().filter_map(|front| front.kept(&results.natural)).collect();
        let column = |share: fn(&Kept) -> f64| kept.iter().map(share).collect::<Vec<_>>();
        let percent = |share: Option<f64>, digits| format!("{} %", figure(share.map(|share| 100.0 * share), digits));
        let mean = |values: &[f64]| percent(statistics::mean(values.iter().copied()), 0);
        let least = |values: &[f64], digits| percent(values.iter().copied().reduce(f64::min), digits);
        let [muscular, peripersonal, objective] =
            [column(|kept| kept.muscular), column(|kept| kept.peripersonal), column(|kept| kept.objective)];
        if !kept.is_empty() {
            let _ = writeln!(
                text,
                "| {} | {} | {} | {} | {} | {} |",
                task(kind),
                mean(&muscular),
                least(&muscular, 0),
                mean(&peripersonal),
                least(&peripersonal, 0),
                least(&objective, 1)
            );
        }
    }
}
