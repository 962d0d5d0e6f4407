//! The CSV files. Missing figures are empty. Equal runs give equal text, except `timing.csv`.

use super::{
    evaluation::{Circle, FIRST_SEED, HoldRow, Reproduction, Results, task},
    table,
};
use crate::{
    model::{
        plan::{Comfort, PostureConstraint},
        scenario::PlannerKind,
        verdict::CheckKind,
    },
    report::csv_text::csv_text,
};

/// Six decimals, to which results of different machines must agree.
pub(super) fn cell(value: Option<f64>) -> String {
    value.map(|value| format!("{value:.6}")).unwrap_or_default()
}

/// `table1.csv`: the paper's Table I. The random planner's figures are means over all seeds.
#[must_use]
pub fn table1(reproduction: &Reproduction) -> String {
    let rows = table::rows(reproduction.holds.iter()).into_iter().map(|row| {
        vec![
            task(row.kind).to_owned(),
            row.planner.to_string(),
            cell(row.muscular),
            cell(row.muscular_printed_median),
            cell(row.peripersonal_scaled),
            cell(row.muscular_normalised),
            cell(row.peripersonal_normalised),
        ]
    });
    csv_text(
        &[
            "task",
            "planner",
            "muscular",
            "muscular_printed_median",
            "peripersonal_scaled",
            "muscular_normalised",
            "peripersonal_normalised",
        ],
        rows,
    )
}

/// `plans.csv`: the plans with the first seed. `muscular` is the regularised comfort.
#[must_use]
pub fn plans(reproduction: &Reproduction) -> String {
    let rows = reproduction.first_seeds().map(|hold| {
        let (comfort, stability) = (hold.comfort(), hold.plan.as_ref().and_then(|plan| plan.stability.as_ref()));
        vec![
            hold.operation.clone(),
            hold.planner.to_string(),
            cell(comfort.map(|comfort| comfort.muscular_regularised)),
            cell(comfort.map(|comfort| comfort.peripersonal_m)),
            cell(comfort.map(|comfort| comfort.objective)),
            cell(stability.map(|stability| stability.load_factor)),
            cell(stability.map(|stability| stability.compliant_load_factor)),
        ]
    });
    csv_text(
        &["operation", "planner", "muscular", "peripersonal_m", "objective", "load_factor", "compliant_load_factor"],
        rows,
    )
}

/// `postures.csv`: how the person stands and sees the work in the plans with the first seed, with the scores.
#[must_use]
pub fn postures(reproduction: &Reproduction) -> String {
    let keys = PostureConstraint::ALL.map(PostureConstraint::key);
    let rows = reproduction.first_seeds().map(|hold| {
        let figures = hold.posture().map(|figures| figures.iter().map(|(_, figure)| Some(figure.value)).collect());
        let figures: Vec<_> = figures.unwrap_or_else(|| vec![None; keys.len()]);
        let score = |of: fn(&Comfort) -> Option<u8>| {
            hold.comfort().and_then(of).map(|score| score.to_string()).unwrap_or_default()
        };
        let mut row = vec![hold.operation.clone(), hold.planner.to_string()];
        row.extend(figures.into_iter().map(cell));
        row.extend([
            score(|comfort| Some(comfort.rula?.score)),
            score(|comfort| Some(comfort.rula?.arm_and_wrist)),
            score(|comfort| Some(comfort.reba?.score)),
        ]);
        row
    });
    let head = ["operation", "planner"].into_iter().chain(keys).chain(["rula", "rula_arm", "reba"]);
    csv_text(&head.collect::<Vec<_>>(), rows)
}

/// `physics.csv` and `best_case.csv`: the simulated plans. `load_factor_simulated` is the largest load factor that holds;
/// empty if it was not searched.
#[must_use]
pub fn physics<'a>(holds: impl Iterator<Item = &'a HoldRow>) -> String {
    let rows = holds.map(|hold| {
        let predicted_mm = hold.plan.as_ref().and_then(|plan| Some(plan.stability.as_ref()?.predicted_deflection_mm));
        vec![
            hold.operation.clone(),
            hold.planner.to_string(),
            hold.verdict.as_ref().map(|verdict| verdict.verdict.to_string()).unwrap_or_default(),
            cell(hold.value(CheckKind::Slip)),
            cell(hold.value(CheckKind::SlipRotation)),
            cell(hold.value(CheckKind::Deflection)),
            cell(predicted_mm),
            cell(hold.value(CheckKind::TorqueRatio)),
            cell(hold.load_factor_simulated),
        ]
    });
    csv_text(
        &[
            "operation",
            "planner",
            "verdict",
            "slip_mm",
            "slip_deg",
            "deflection_mm",
            "predicted_deflection_mm",
            "torque_ratio",
            "load_factor_simulated",
        ],
        rows,
    )
}

/// `random.csv`: every plan of the random planner.
#[must_use]
pub fn random(reproduction: &Reproduction) -> String {
    let draws = reproduction.holds.iter().filter(|hold| hold.planner == PlannerKind::Random).map(|hold| {
        let comfort = hold.comfort();
        vec![
            hold.operation.clone(),
            hold.seed.to_string(),
            cell(hold.muscular()),
            cell(comfort.map(|comfort| comfort.muscular)),
            cell(hold.peripersonal_scaled()),
        ]
    });
    csv_text(&["operation", "seed", "muscular", "muscular_printed", "peripersonal_scaled"], draws)
}

/// `sensitivity.csv`: Table I under each assumption.
#[must_use]
pub fn sensitivity(reproduction: &Reproduction) -> String {
    let rows = reproduction.sensitivity.iter().flat_map(|variant| {
        table::rows(variant.holds.iter()).into_iter().map(|row| {
            vec![
                variant.name.clone(),
                task(row.kind).to_owned(),
                row.planner.to_string(),
                row.plans.to_string(),
                cell(row.muscular),
                cell(row.peripersonal_scaled),
                cell(row.muscular_normalised),
                cell(row.peripersonal_normalised),
            ]
        })
    });
    csv_text(
        &[
            "assumption",
            "task",
            "planner",
            "plans",
            "muscular",
            "peripersonal_scaled",
            "muscular_normalised",
            "peripersonal_normalised",
        ],
        rows,
    )
}

/// `effort.csv`: the effort of the muscles in every plan; `by-muscles` is the comfort planner by this effort.
#[must_use]
pub fn effort(reproduction: &Reproduction) -> String {
    let holds = reproduction.holds.iter().map(|hold| (hold, hold.planner.to_string()));
    let by_muscles = reproduction.by_muscles.iter().map(|hold| (hold, "by-muscles".to_owned()));
    let rows = holds.chain(by_muscles).map(|(hold, planner)| {
        let muscles = hold.plan.as_ref().and_then(|plan| plan.muscles.as_ref());
        vec![
            hold.operation.clone(),
            planner,
            hold.seed.to_string(),
            cell(muscles.map(|muscles| muscles.effort)),
            cell(muscles.map(|muscles| muscles.largest_activation)),
        ]
    });
    csv_text(&["operation", "planner", "seed", "effort", "largest_activation"], rows)
}

/// `front.csv`: what the comfort planner keeps of the front of both comforts.
#[must_use]
pub fn front(results: &Results) -> String {
    let rows = results.fronts.iter().map(|front| {
        let kept = front.kept(&results.natural);
        vec![
            front.operation.clone(),
            front.points.to_string(),
            cell(Some(front.optima[0])),
            cell(Some(front.optima[1])),
            cell(Some(front.best_objective)),
            cell(kept.map(|kept| kept.muscular)),
            cell(kept.map(|kept| kept.peripersonal)),
            cell(kept.map(|kept| kept.objective)),
        ]
    });
    csv_text(
        &[
            "operation",
            "points",
            "best_muscular",
            "best_peripersonal_m",
            "best_objective",
            "muscular_kept",
            "peripersonal_kept",
            "objective_kept",
        ],
        rows,
    )
}

/// `circle.csv`: the staged plan for the whole circle and what it is compared with.
#[must_use]
pub fn circle(circle: &Circle) -> String {
    let rows = circle.rows.iter().map(|row| {
        vec![
            row.strategy.clone(),
            row.served.to_string(),
            cell(row.mean_effort),
            cell(row.staged_ratio),
            cell(row.mean_objective),
        ]
    });
    csv_text(&["strategy", "pieces", "mean_effort", "staged_ratio", "mean_objective"], rows)
}

/// `timing.csv`: durations of planning and simulation. They differ between runs.
#[must_use]
pub fn timing(reproduction: &Reproduction) -> String {
    let of = |hold: &HoldRow| {
        vec![
            hold.operation.clone(),
            hold.planner.to_string(),
            format!("{:.3}", hold.plan_ms),
            hold.simulate_ms.map(|ms| format!("{ms:.3}")).unwrap_or_default(),
        ]
    };
    let rows = reproduction.holds.iter().filter(|hold| hold.seed == FIRST_SEED).map(of);
    csv_text(&["operation", "planner", "plan_ms", "simulate_ms"], rows)
}
