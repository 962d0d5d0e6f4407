//! Durations of planning and simulation. They differ between runs, so they are printed and not part of `report.md`.

use std::fmt::Write as _;

use super::{evaluation::Reproduction, printed, statistics};
use crate::model::scenario::PlannerKind;

/// Mean, standard deviation and percentiles of the durations of planning, by planner, and of simulation.
#[must_use]
pub fn summary(reproduction: &Reproduction) -> String {
    let mut text = String::from("time, ms      n    mean      sd     p50     p90     max\n");
    for planner in PlannerKind::ALL {
        let of_planner = reproduction.holds.iter().filter(|hold| hold.planner == planner);
        line(&mut text, &planner.to_string(), of_planner.map(|hold| hold.plan_ms).collect());
    }
    let simulated = reproduction.holds.iter().filter_map(|hold| hold.simulate_ms);
    line(&mut text, "simulation", simulated.collect());
    let paper = printed::plan_time();
    // Writing to a string does not fail.
    let _ =
        writeln!(text, "the paper     {} s per plan, standard deviation {} s", paper.mean, paper.standard_deviation);
    text
}

fn line(text: &mut String, name: &str, times_ms: Vec<f64>) {
    if times_ms.is_empty() {
        return;
    }
    let quantile = |share| statistics::quantile(times_ms.clone(), share);
    let figures = [
        statistics::mean(times_ms.iter().copied()),
        statistics::standard_deviation(&times_ms),
        quantile(0.5),
        quantile(0.9),
        quantile(1.0),
    ];
    let cells = figures.map(|figure| figure.map_or("       -".to_owned(), |ms| format!("{ms:8.1}")));
    let _ = writeln!(text, "{name:<12} {:>3}{}", times_ms.len(), cells.concat());
}
