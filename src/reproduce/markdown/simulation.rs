//! What became of the plans in simulation.

use std::fmt::Write as _;

use super::words::figure;
use crate::{
    model::{
        operation::OperationKind,
        scenario::PlannerKind,
        verdict::{CheckKind, VerdictKind},
    },
    report::explanation,
    reproduce::{
        claims,
        evaluation::{HoldRow, KINDS, Reproduction, task},
        statistics,
    },
};

/// The worst values of each planner, predictions beside simulations, and the plans that failed.
pub fn section(text: &mut String, reproduction: &Reproduction) {
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
pub fn best_case(text: &mut String, reproduction: &Reproduction) {
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
