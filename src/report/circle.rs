//! The strategies for a whole circle, as CSV and as console tables.

use super::{columns::aligned, csv_text::csv_text};
use crate::model::{frames::Pose, plan::Plan};

/// A strategy by name, with a plan for every point that it covers.
pub type Strategy<'a> = (&'static str, &'a [Option<Plan>]);

/// One pose of the motion from one point to the next.
#[derive(Clone, Debug)]
pub struct Step {
    /// The board's pose in W.
    pub x_wo: Pose,
    /// The joint angles of all arms, one arm after the other, rad.
    pub q_rad: Vec<f64>,
}

/// Objective, regularised muscular comfort and peripersonal comfort (m) of a plan.
fn comforts(plan: &Plan) -> Option<[f64; 3]> {
    plan.comfort.as_ref().map(|comfort| [comfort.objective, comfort.muscular_regularised, comfort.peripersonal_m])
}

/// One row per strategy and point; the figures are empty if the strategy does not cover the point.
#[must_use]
pub fn csv(strategies: &[Strategy<'_>]) -> String {
    let header = [
        "way",
        "point",
        "angle_deg",
        "served",
        "objective",
        "muscular_regularised",
        "peripersonal_m",
        "load_factor",
        "compliant_load_factor",
    ];
    let rows = strategies.iter().flat_map(|(name, plans)| {
        plans.iter().enumerate().map(|(index, plan)| {
            let angle_deg = 360.0 * index as f64 / plans.len() as f64;
            let covered = plan.as_ref().and_then(|plan| Some((comforts(plan)?, plan.stability.as_ref()?)));
            let figures =
                covered.map_or_else(Default::default, |([objective, muscular, peripersonal_m], stability)| {
                    [
                        format!("{objective:.4}"),
                        format!("{muscular:.4}"),
                        format!("{peripersonal_m:.6}"),
                        format!("{:.4}", stability.load_factor),
                        format!("{:.4}", stability.compliant_load_factor),
                    ]
                });
            let point = [(*name).to_owned(), (index + 1).to_string(), format!("{angle_deg:.1}")];
            point.into_iter().chain([covered.is_some().to_string()]).chain(figures).collect()
        })
    });
    csv_text(&header, rows)
}

/// One row per step: the points that it is between, the board's pose in the world (m, unit quaternion with the scalar last) and
/// the joint angles, rad.
#[must_use]
pub fn motion_csv(joints: &[String], motions: &[Vec<Step>]) -> String {
    let header = ["from_point", "to_point", "step", "x_m", "y_m", "z_m", "qx", "qy", "qz", "qw"].map(str::to_owned);
    let header: Vec<_> = header.into_iter().chain(joints.iter().map(|joint| format!("{joint}_rad"))).collect();
    let rows = motions.iter().enumerate().flat_map(|(index, motion)| {
        motion.iter().enumerate().map(move |(number, step)| {
            let numbers = [index + 1, index + 2, number].map(|number| number.to_string());
            let pose = step.x_wo.translation.vector.iter().chain(step.x_wo.rotation.coords.iter());
            numbers.into_iter().chain(pose.chain(&step.q_rad).map(|figure| format!("{figure:.6}"))).collect()
        })
    });
    csv_text(&header, rows)
}

/// One line per strategy: number of points that it covers, worst objective, mean objective and comforts, and the mean ratio of
/// its objective to that of the last strategy, over the points that both cover.
#[must_use]
pub fn table(strategies: &[Strategy<'_>]) -> String {
    let header = ["way", "points", "worst", "mean", "muscular", "peripersonal m", "kept %"];
    let mut rows = vec![header.map(str::to_owned).to_vec()];
    for (name, plans) in strategies {
        let served: Vec<_> = plans.iter().flatten().filter_map(comforts).collect();
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let column = |number: usize| mean(&served.iter().map(|comforts| comforts[number]).collect::<Vec<_>>());
        let cell = |value: f64, digits| if value.is_finite() { format!("{value:.digits$}") } else { "-".to_owned() };
        let reference = strategies.last().map_or(&[][..], |(_, plans)| plans);
        let shares: Vec<_> = plans
            .iter()
            .zip(reference)
            .filter_map(|(a, b)| Some(comforts(a.as_ref()?)?[0] / comforts(b.as_ref()?)?[0]))
            .collect();
        rows.push(vec![
            (*name).to_owned(),
            format!("{}/{}", served.len(), plans.len()),
            cell(served.iter().map(|comforts| comforts[0]).fold(f64::INFINITY, f64::min), 2),
            cell(column(0), 2),
            cell(column(1), 2),
            cell(column(2), 3),
            cell(100.0 * mean(&shares), 1),
        ]);
    }
    aligned(&rows, 1)
}
