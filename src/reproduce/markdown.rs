//! `report.md`.

use std::fmt::Write as _;

use super::{
    claims,
    evaluation::{HoldRow, KINDS, Reproduction, Variant, task},
    printed::{self, Printed},
    statistics, table,
};
use crate::{
    model::{
        operation::OperationKind,
        plan::PostureFigures,
        scenario::PlannerKind,
        verdict::{CheckKind, VerdictKind},
    },
    report::explanation,
};

// Writing to a string does not fail, so the results of `writeln!` are ignored.

/// The report. It refers to pictures and CSV files in the same folder.
#[must_use]
pub fn report(reproduction: &Reproduction) -> String {
    let mut text = String::from("# The paper, reproduced and verified in simulation\n\n");
    text.push_str(
        "Written by `benchdog reproduce`; do not edit. `docs/reproduction.md` explains the figures and lists what is not\n\
         reproduced. \"The paper\" is Chen, Figueredo, Dogar, *Planning for Muscular and Peripersonal-Space Comfort during\n\
         Human-Robot Forceful Collaboration*, IEEE-RAS Humanoids 2018.\n",
    );
    if let Some(left_out) = &reproduction.left_out {
        let _ = writeln!(text, "\n**Not the whole evaluation**: {left_out}.");
    }
    table_one(&mut text, reproduction);
    claims_section(&mut text, reproduction);
    raw(&mut text, reproduction, PAPERS_METRIC);
    seeds(&mut text, reproduction);
    physics(&mut text, reproduction);
    best_case(&mut text, reproduction);
    pictures(&mut text, reproduction);
    text.push_str(
        "\n## Muscular comfort along the circle\n\nBest and worst posture of the person at each of the 16 cutting points, with the board upright in one place\n\
         (`muscular_curve.csv`).\n\n![Best and worst muscular comfort at 16 cutting points](muscular_curve.svg)\n",
    );
    sensitivity(&mut text, reproduction);
    text
}

/// The report of the evaluation for a person who stands naturally.
#[must_use]
pub fn natural_report(reproduction: &Reproduction) -> String {
    let mut text = String::from("# The paper's operations for a person who stands as people stand\n\n");
    text.push_str(
        "Written by `benchdog reproduce --natural`; do not edit. The operations, the planners and the robot are those of the\n\
         [reproduction](../report.md). The person keeps the limits of a natural posture, muscular comfort is the intrinsic\n\
         metric, and the knife is drawn towards the person: the defaults of a scenario. `docs/reproduction.md` compares the\n\
         two.\n",
    );
    if let Some(left_out) = &reproduction.left_out {
        let _ = writeln!(text, "\n**Not the whole evaluation**: {left_out}.");
    }
    table_one(&mut text, reproduction);
    claims_section(&mut text, reproduction);
    raw(&mut text, reproduction, INTRINSIC_METRIC);
    postures(&mut text, reproduction);
    seeds(&mut text, reproduction);
    physics(&mut text, reproduction);
    pictures(&mut text, reproduction);
    text
}

/// Mean and worst value of each figure of the posture, by task and planner.
fn postures(text: &mut String, reproduction: &Reproduction) {
    text.push_str(
        "\n## Postures\n\nMean over the plans with the first seed, and the smallest distance of any plan from the nearer limit (`postures.csv`).\n\n\
         | task | figure | limit |",
    );
    PlannerKind::ALL.iter().for_each(|planner| text.push_str(&format!(" {planner} |")));
    text.push_str("\n|---|---|---|---|---|---|---|\n");
    for kind in KINDS {
        let of = |planner: PlannerKind| -> Vec<PostureFigures> {
            let holds = reproduction.first_seeds().filter(|hold| hold.kind == kind && hold.planner == planner);
            holds.filter_map(HoldRow::posture).collect()
        };
        let by_planner = PlannerKind::ALL.map(of);
        let Some(any) = by_planner.iter().flatten().next() else { continue };
        for (place, (constraint, limits)) in any.iter().enumerate() {
            let limit = match (limits.min, limits.max) {
                (Some(min), Some(max)) => format!("{min} to {max}"),
                (Some(min), None) => format!("at least {min}"),
                (None, max) => format!("at most {}", figure(max, 1)),
            };
            let _ = write!(text, "| {} | {} | {limit} |", task(kind), constraint.key());
            for figures in &by_planner {
                let all = || figures.iter().filter_map(|figures| figures.iter().nth(place)).map(|(_, figure)| figure);
                let mean = statistics::mean(all().map(|figure| figure.value));
                let margin = all().map(|figure| figure.margin()).reduce(f64::min);
                let _ = write!(text, " {} ({}) |", figure(mean, 2), figure(margin.map(|m| m + 0.0), 3));
            }
            text.push('\n');
        }
    }
}

fn figure(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.digits$}"))
}

fn table_one(text: &mut String, reproduction: &Reproduction) {
    let _ = write!(
        text,
        "\n## Table I\n\nMeans over the operations, divided by those of the random planner ({} seeds per operation). The paper's figures are\n\
         in brackets (`table1.csv`).\n\n| task | planner | muscular | peripersonal |\n|---|---|---|---|\n",
        reproduction.random_seeds
    );
    for row in table::rows(reproduction.holds.iter()) {
        let paper = printed::table(row.kind, row.planner);
        let of_paper = |which: fn(&Printed) -> f64| figure(paper.as_ref().map(which), 2);
        let _ = writeln!(
            text,
            "| {} | {} | {} ({}) | {} ({}) |",
            task(row.kind),
            row.planner,
            figure(row.muscular_normalised, 2),
            of_paper(|paper| paper.muscular),
            figure(row.peripersonal_normalised, 2),
            of_paper(|paper| paper.peripersonal)
        );
    }
}

fn claims_section(text: &mut String, reproduction: &Reproduction) {
    text.push_str("\n## The paper's conclusions\n\n| confirmed | conclusion | figures |\n|---|---|---|\n");
    for claim in claims::claims(reproduction) {
        let mark = if claim.holds { "yes" } else { "**no**" };
        let _ = writeln!(text, "| {mark} | {} | {} |", claim.sentence, claim.figures);
    }
}

/// What the raw values of the paper's person are.
const PAPERS_METRIC: &str = "Muscular comfort is the regularised one, `1 / (||alpha||^2 + 0.01)`; `printed` is the median of `1 / ||alpha||^2`.";

/// What those of the natural person are.
const INTRINSIC_METRIC: &str = "Muscular comfort is the intrinsic one, `1 / (||alpha||^2 + 0.0175)`; `printed` is the median of the paper's metric.";

fn raw(text: &mut String, reproduction: &Reproduction, of_metric: &str) {
    let _ = write!(text, "\n## Raw values\n\n{of_metric}\n");
    text.push_str(
        "\
         Peripersonal comfort is the sum over 64 body points, as in the captions of the paper; the figures in brackets are those\n\
         of the one configuration per planner that the paper shows. `candidates` is the mean number of evaluated candidates: the\n\
         random planner draws until a candidate is feasible; the others might find better plans with more candidates. Single\n\
         plans are in `plans.csv`.\n\n\
         | task | planner | plans | candidates | muscular | printed | peripersonal |\n|---|---|---|---|---|---|---|\n",
    );
    for row in table::rows(reproduction.holds.iter()) {
        let paper = printed::caption(row.kind, row.planner);
        let of_paper = |which: fn(&Printed) -> f64| figure(paper.as_ref().map(which), 1);
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} ({}) | {} | {} ({}) |",
            task(row.kind),
            row.planner,
            row.plans,
            figure(row.candidates, 0),
            figure(row.muscular, 1),
            of_paper(|paper| paper.muscular),
            figure(row.muscular_printed_median, 1),
            figure(row.peripersonal_scaled, 1),
            of_paper(|paper| paper.peripersonal)
        );
    }
}

/// The spread, over the seeds, of the means over the operations of a kind.
fn seeds(text: &mut String, reproduction: &Reproduction) {
    text.push_str(
        "\n## Spread of the random planner\n\nEach seed gives a mean over the operations, as in the paper's single run. The table shows mean, standard deviation and\n\
         range of these means over the seeds (`random.csv`).\n\n\
         | task | comfort | mean | deviation | range |\n|---|---|---|---|---|\n",
    );
    for kind in KINDS {
        let of_seed = |seed: u64| {
            let draws = reproduction.holds.iter().filter(move |h| h.planner == PlannerKind::Random && h.kind == kind);
            draws.filter(move |hold| hold.seed == seed)
        };
        let means = |figure: fn(&HoldRow) -> Option<f64>| -> Vec<f64> {
            (1..=reproduction.random_seeds)
                .filter_map(|seed| statistics::mean(of_seed(seed).filter_map(figure)))
                .collect()
        };
        let muscular = means(HoldRow::muscular);
        let peripersonal = means(HoldRow::peripersonal_scaled);
        for (name, means) in [("muscular", muscular), ("peripersonal", peripersonal)] {
            let quantile = |share| figure(statistics::quantile(means.clone(), share), 2);
            let _ = writeln!(
                text,
                "| {} | {name} | {} | {} | {} to {} |",
                task(kind),
                figure(statistics::mean(means.iter().copied()), 2),
                figure(statistics::standard_deviation(&means), 2),
                quantile(0.0),
                quantile(1.0)
            );
        }
    }
}

fn physics(text: &mut String, reproduction: &Reproduction) {
    let simulated = || reproduction.first_seeds();
    let held = simulated().filter(|hold| claims::holds(hold)).count();
    let _ = write!(
        text,
        "\n## In simulation\n\n**{held} of {} plans hold** under the tool's full force, with at most 1 mm and 2 degrees of slip and 15 mm (cutting) or\n\
         5 mm (drilling) of deflection. The table shows the worst values of each planner (`physics.csv`). Load factors are the\n\
         smallest over the plans: `certificate` for the best contact forces, `predicted` for compliant arms, `simulated` by\n\
         raising the force until the grasp fails.\n\n\
         | task | planner | holds | slip mm | slip deg | deflection mm | torque | certificate | predicted | simulated |\n\
         |---|---|---|---|---|---|---|---|---|---|\n",
        simulated().count()
    );
    for kind in KINDS {
        for planner in PlannerKind::ALL {
            let of: Vec<_> = simulated().filter(|hold| hold.kind == kind && hold.planner == planner).collect();
            if !of.is_empty() {
                text.push_str(&physics_row(kind, planner, &of));
            }
        }
    }
    predictions(text, reproduction);
    failures(text, reproduction.first_seeds());
}

fn physics_row(kind: OperationKind, planner: PlannerKind, holds: &[&HoldRow]) -> String {
    let worst = |check| largest(holds.iter().filter_map(|hold| hold.value(check)));
    let stability = || holds.iter().filter_map(|hold| hold.plan.as_ref()?.stability.as_ref());
    let smallest = |values: Vec<f64>| largest(values.into_iter().map(|v| -v)).map(|v| -v);
    format!(
        "| {} | {planner} | {} of {} | {} | {} | {} | {} | {} | {} | {} |\n",
        task(kind),
        holds.iter().filter(|hold| claims::holds(hold)).count(),
        holds.len(),
        figure(worst(CheckKind::Slip), 3),
        figure(worst(CheckKind::SlipRotation), 2),
        figure(worst(CheckKind::Deflection), 2),
        figure(worst(CheckKind::TorqueRatio), 2),
        figure(smallest(stability().map(|s| s.load_factor).collect()), 2),
        figure(smallest(stability().map(|s| s.compliant_load_factor).collect()), 2),
        figure(smallest(holds.iter().filter_map(|hold| hold.load_factor_simulated).collect()), 2)
    )
}

fn largest(values: impl Iterator<Item = f64>) -> Option<f64> {
    values.reduce(f64::max)
}

/// The ratios of simulated to predicted values.
fn predictions(text: &mut String, reproduction: &Reproduction) {
    let stability = |hold: &HoldRow| Some(hold.plan.as_ref()?.stability.as_ref()?.clone());
    let ratios: [(&str, Vec<f64>); 3] = [
        (
            "deflection, simulated over predicted",
            collect(reproduction, |h| Some(h.value(CheckKind::Deflection)? / stability(h)?.predicted_deflection_mm)),
        ),
        (
            "load factor, simulated over predicted for compliant arms",
            collect(reproduction, |h| Some(h.load_factor_simulated? / stability(h)?.compliant_load_factor)),
        ),
        (
            "load factor, simulated over certificate",
            collect(reproduction, |h| Some(h.load_factor_simulated? / stability(h)?.load_factor)),
        ),
    ];
    text.push_str("\n| over all plans | n | smallest | median | largest |\n|---|---|---|---|---|\n");
    for (name, values) in ratios {
        let quantile = |share| figure(statistics::quantile(values.clone(), share), 3);
        let _ =
            writeln!(text, "| {name} | {} | {} | {} | {} |", values.len(), quantile(0.0), quantile(0.5), quantile(1.0));
    }
    let mut ended = std::collections::BTreeMap::<&str, usize>::new();
    for kind in reproduction.first_seeds().filter_map(|hold| hold.ended_by) {
        *ended.entry(kind.name()).or_default() += 1;
    }
    if !ended.is_empty() {
        let list: Vec<_> = ended.iter().map(|(name, count)| format!("{name} {count}")).collect();
        let _ = writeln!(text, "\nVerdicts when the force is raised: {}.", list.join(", "));
    }
}

fn collect(reproduction: &Reproduction, ratio: impl Fn(&HoldRow) -> Option<f64>) -> Vec<f64> {
    reproduction.first_seeds().filter_map(ratio).filter(|ratio| ratio.is_finite()).collect()
}

/// The results with the paper's stability constraint alone.
fn best_case(text: &mut String, reproduction: &Reproduction) {
    let holds = &reproduction.best_case;
    let _ = write!(
        text,
        "\n## With the paper's stability alone\n\nAll plans above resist the load with compliant arms. If the comfort planner requires only that *some* contact forces\n\
         balance the load (`stability = \"paper\"`), **{} of {} of its plans hold** in simulation (`best_case.csv`).\n",
        holds.iter().filter(|hold| claims::holds(hold)).count(),
        holds.len()
    );
    failures(text, holds.iter());
}

/// The plans that failed, and why.
fn failures<'a>(text: &mut String, holds: impl Iterator<Item = &'a HoldRow>) {
    let failed: Vec<_> = holds.filter(|hold| !claims::holds(hold)).collect();
    if failed.is_empty() {
        text.push_str("\nNo plan failed.\n");
        return;
    }
    text.push_str("\nPlans that failed:\n\n| operation | planner | verdict | reason |\n|---|---|---|---|\n");
    for hold in failed {
        let verdict = hold.verdict.as_ref();
        let kind = verdict.map_or(VerdictKind::Infeasible, |verdict| verdict.verdict);
        let why = verdict.map(explanation).or_else(|| hold.infeasible.clone()).unwrap_or_default();
        let _ = writeln!(text, "| {} | {} | {kind} | {why} |", hold.operation, hold.planner);
    }
}

/// The file name of a picture.
#[must_use]
pub fn picture_name(hold: &HoldRow) -> String {
    format!("{}-{}.svg", hold.operation, hold.planner)
}

/// The title of a picture.
#[must_use]
pub fn picture_title(hold: &HoldRow) -> String {
    format!(
        "{}, {} planner: muscular comfort {}, peripersonal comfort {}",
        hold.operation,
        hold.planner,
        figure(hold.muscular(), 1),
        figure(hold.peripersonal_scaled(), 1)
    )
}

fn pictures(text: &mut String, reproduction: &Reproduction) {
    text.push_str(
        "\n## Configurations\n\nThe plan of each planner for one operation of each kind. The red arrow is the tool's force on the board, the\n\
         dashed line the line of sight. For a natural posture the view from above shows the sector in front of the person that the\n\
         tool tip must be over.\n",
    );
    for operation in KINDS.into_iter().filter_map(|kind| reproduction.drawn(kind)) {
        for planner in PlannerKind::ALL {
            if let Some(hold) = reproduction.hold(operation, planner).filter(|hold| hold.plan.is_some()) {
                let _ = writeln!(text, "\n![{}](pictures/{})", picture_title(hold), picture_name(hold));
            }
        }
    }
}

fn sensitivity(text: &mut String, reproduction: &Reproduction) {
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
            sensitivity: vec![variant("as reproduced", holds)],
            sensitivity_seeds: 1,
            left_out: None,
        };
        let of = |reproduction: &Reproduction| {
            let mut text = String::new();
            sensitivity(&mut text, reproduction);
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
