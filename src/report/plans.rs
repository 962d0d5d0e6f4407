//! A table of several plans of one scenario.

use super::columns::aligned;
use crate::model::{
    grasp::grasped_edge,
    plan::{Comfort, Plan, Stability},
};

/// One line per plan: the edges that the arms hold, comforts, scores of the posture, load factors.
#[must_use]
pub fn table(plans: &[Plan]) -> String {
    let header = [
        "plan",
        "edges",
        "objective",
        "muscular",
        "peripersonal m",
        "RULA",
        "RULA arm",
        "REBA",
        "load",
        "compliant load",
    ];
    let mut rows = vec![header.map(str::to_owned).to_vec()];
    for (index, plan) in plans.iter().enumerate() {
        let comfort = |figure: fn(&Comfort) -> f64| plan.comfort.as_ref().map(figure);
        let stability = |figure: fn(&Stability) -> f64| plan.stability.as_ref().map(figure);
        let score = |score: fn(&Comfort) -> Option<u8>| {
            plan.comfort.as_ref().and_then(score).map_or("-".to_owned(), |score| score.to_string())
        };
        let cell = |figure: Option<f64>, digits| figure.map_or("-".to_owned(), |figure| format!("{figure:.digits$}"));
        rows.push(vec![
            (index + 1).to_string(),
            edges(plan),
            cell(comfort(|comfort| comfort.objective), 2),
            cell(comfort(|comfort| comfort.muscular_regularised), 2),
            cell(comfort(|comfort| comfort.peripersonal_m), 3),
            score(|comfort| Some(comfort.rula?.score)),
            score(|comfort| Some(comfort.rula?.arm_and_wrist)),
            score(|comfort| Some(comfort.reba?.score)),
            cell(stability(|stability| stability.load_factor), 2),
            cell(stability(|stability| stability.compliant_load_factor), 2),
        ]);
    }
    aligned(&rows, 2)
}

/// The edges that the arms hold: `left +x, right -x`.
#[must_use]
pub fn edges(plan: &Plan) -> String {
    let board = plan.object.shape();
    let edge = |x_og| grasped_edge(x_og, &board).map_or("-".to_owned(), |edge| board.edge_name(edge));
    let holds: Vec<_> = plan.arms.iter().map(|arm| format!("{} {}", arm.name, edge(&arm.x_og))).collect();
    holds.join(", ")
}
