//! Table I under other assumptions.

use std::fmt::Write as _;

use super::words::figure;
use crate::{
    model::scenario::PlannerKind,
    reproduce::{
        evaluation::{HoldRow, KINDS, Reproduction, Variant, task},
        printed, table,
    },
};

/// The table, and what the mean response changes; nothing without an analysis.
pub fn section(text: &mut String, reproduction: &Reproduction) {
    let Some(Variant { holds, .. }) = reproduction.sensitivity.first() else { return };
    let mut operations: Vec<_> = holds.iter().map(|hold| hold.operation.as_str()).collect();
    operations.dedup();
    let _ = write!(
        text,
        "\n## Sensitivity\n\nTable I for {} only, with {} seeds of the random planner, under other assumptions where the paper states none\n\
         (`sensitivity.csv`). Each line changes one assumption of the first. Cells: muscular, peripersonal.\n\n\
         | assumption | task | comfort | peripersonal | muscular | random, raw |\n|---|---|---|---|---|---|\n",
        operations.join(", "),
        reproduction.sensitivity_seeds
    );
    for variant in &reproduction.sensitivity {
        let rows = table::rows(variant.holds.iter());
        for kind in KINDS {
            let of_kind: Vec<_> = rows.iter().filter(|row| row.kind == kind).collect();
            if of_kind.is_empty() {
                continue;
            }
            let _ = write!(text, "| {} | {} |", variant.name, task(kind));
            for row in of_kind {
                let pair = match row.planner {
                    PlannerKind::Random => [figure(row.muscular, 1), figure(row.peripersonal_scaled, 1)],
                    _ => [figure(row.muscular_normalised, 2), figure(row.peripersonal_normalised, 2)],
                };
                let _ = write!(text, " {}, {} |", pair[0], pair[1]);
            }
            text.push('\n');
        }
    }
    mean_responses(text, reproduction);
}

/// Explains the mean over the person's responses, and compares it with the paper's ratios.
fn mean_responses(text: &mut String, reproduction: &Reproduction) {
    let is_rated_by_mean = |hold: &HoldRow| hold.comfort().is_some_and(|comfort| comfort.average.is_some());
    let by_mean = |variant: &&Variant| variant.holds.iter().any(is_rated_by_mean);
    let Some(mean) = reproduction.sensitivity.iter().find(by_mean) else { return };
    text.push_str(
        "\nThe mean is taken over all feasible responses of the person on a uniform grid, for the random planner too. The other\n\
         planners still search with the best response and rank the best few plans by the mean, so a better mean may exist.\n",
    );
    let muscular = |holds: &[HoldRow], kind, planner| {
        table::rows(holds.iter()).iter().find(|row| row.kind == kind && row.planner == planner)?.muscular
    };
    let ratios = KINDS.into_iter().filter_map(|kind| {
        let best = muscular(&reproduction.sensitivity[0].holds, kind, PlannerKind::Comfort)?;
        let ratio = best / muscular(&mean.holds, kind, PlannerKind::Random)?;
        let paper = printed::table(kind, PlannerKind::Comfort).map(|paper| paper.muscular);
        Some(format!("{ratio:.2} in {} ({})", task(kind), figure(paper, 2)))
    });
    let ratios: Vec<_> = ratios.collect();
    let _ = writeln!(
        text,
        "\nWith the mean response for the random planner and the best response for the comfort planner, the ratio of their muscular\n\
         comforts is, with the paper's in brackets: {}.",
        ratios.join(", ")
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{model::plan::MeanComfort, reproduce::testing::hold};

    #[test]
    fn the_best_response_of_comfort_is_compared_with_the_mean_response_of_random() {
        let holds =
            vec![hold("cut-01", PlannerKind::Comfort, 1, 60.0, 1.0), hold("cut-01", PlannerKind::Random, 1, 20.0, 0.5)];
        let mut by_mean = holds.clone();
        for hold in &mut by_mean {
            let comfort = hold.plan.as_mut().and_then(|plan| plan.comfort.as_mut()).unwrap();
            comfort.average = Some(MeanComfort { responses: 2, muscular_regularised: 8.0, peripersonal_m: 0.5 });
        }
        let variant = |name: &str, holds| Variant { name: name.to_owned(), holds };
        let mut reproduction = Reproduction {
            holds: holds.clone(),
            random_seeds: 1,
            best_case: Vec::new(),
            by_muscles: Vec::new(),
            sensitivity: vec![variant("as reproduced", holds)],
            sensitivity_seeds: 1,
            left_out: None,
        };
        let of = |reproduction: &Reproduction| {
            let mut text = String::new();
            section(&mut text, reproduction);
            text
        };
        assert!(!of(&reproduction).contains("mean"));
        reproduction.sensitivity.push(variant("mean", by_mean));
        let text = of(&reproduction);
        // The means of both planners are equal; the best response over the mean is 60 / 8.
        assert!(text.contains("| mean | cutting | 1.00, 1.00 | -, - | -, - | 8.0, 32.0 |"), "{text}");
        assert!(text.contains("brackets: 7.50 in cutting (11.19)."), "{text}");
    }
}
