//! The three ways to hold a board for a circle, as tables for programs and readers.

use std::fmt::Write as _;

use super::console::aligned;
use crate::model::{frames::Pose, plan::Plan};

/// A way by its name, with a plan for every point that it serves.
pub type Way<'a> = (&'static str, &'a [Option<Plan>]);

/// A pose on the way from one point to the next.
#[derive(Clone, Debug)]
pub struct Step {
    /// The board's pose.
    pub x_wo: Pose,
    /// The joint angles of all arms, arm after arm, rad.
    pub q_rad: Vec<f64>,
}

/// What a plan is worth: objective, regularised muscular and peripersonal comfort (m).
fn comforts(plan: &Plan) -> Option<[f64; 3]> {
    plan.comfort.as_ref().map(|comfort| [comfort.objective, comfort.muscular_regularised, comfort.peripersonal_m])
}

/// A row a way and point; no figures where the way does not serve the point.
pub fn csv(ways: &[Way<'_>]) -> String {
    let mut text = String::from(
        "way,point,angle_deg,served,objective,muscular_regularised,peripersonal_m,load_factor,compliant_load_factor\n",
    );
    for (name, plans) in ways {
        for (index, plan) in plans.iter().enumerate() {
            let angle_deg = 360.0 * index as f64 / plans.len() as f64;
            let served = plan.as_ref().and_then(|plan| Some((comforts(plan)?, plan.stability.as_ref()?)));
            let figures = served.map_or_else(
                || "false,,,,,".to_owned(),
                |([objective, muscular, peripersonal_m], stability)| {
                    let [load, compliant] = [stability.load_factor, stability.compliant_load_factor];
                    format!("true,{objective:.4},{muscular:.4},{peripersonal_m:.6},{load:.4},{compliant:.4}")
                },
            );
            // Writing to a string does not fail.
            let _ = writeln!(text, "{name},{},{angle_deg:.1},{figures}", index + 1);
        }
    }
    text
}

/// A row a step: which points it lies between, the board's pose in the world (m, unit quaternion with the scalar last) and
/// the joint angles, rad.
pub fn motion_csv(joints: &[String], motions: &[Vec<Step>]) -> String {
    let mut text = String::from("from_point,to_point,step,x_m,y_m,z_m,qx,qy,qz,qw");
    for joint in joints {
        let _ = write!(text, ",{joint}_rad");
    }
    text.push('\n');
    for (index, motion) in motions.iter().enumerate() {
        for (number, step) in motion.iter().enumerate() {
            let _ = write!(text, "{},{},{number}", index + 1, index + 2);
            let figures =
                step.x_wo.translation.vector.iter().chain(step.x_wo.rotation.coords.iter()).chain(&step.q_rad);
            for figure in figures {
                let _ = write!(text, ",{figure:.6}");
            }
            text.push('\n');
        }
    }
    text
}

/// A line a way: how many points it serves, its worst and its mean comfort, and the mean of what it keeps of the last way at
/// the points that both serve.
pub fn table(ways: &[Way<'_>]) -> String {
    let header = ["way", "points", "worst", "mean", "muscular", "peripersonal m", "kept %"];
    let mut rows = vec![header.map(str::to_owned).to_vec()];
    for (name, plans) in ways {
        let served: Vec<_> = plans.iter().flatten().filter_map(comforts).collect();
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let column = |number: usize| mean(&served.iter().map(|comforts| comforts[number]).collect::<Vec<_>>());
        let told = |value: f64, digits| if value.is_finite() { format!("{value:.digits$}") } else { "-".to_owned() };
        let reference = ways.last().map_or(&[][..], |(_, plans)| plans);
        let shares: Vec<_> = plans
            .iter()
            .zip(reference)
            .filter_map(|(a, b)| Some(comforts(a.as_ref()?)?[0] / comforts(b.as_ref()?)?[0]))
            .collect();
        rows.push(vec![
            (*name).to_owned(),
            format!("{}/{}", served.len(), plans.len()),
            told(served.iter().map(|comforts| comforts[0]).fold(f64::INFINITY, f64::min), 2),
            told(column(0), 2),
            told(column(1), 2),
            told(column(2), 3),
            told(100.0 * mean(&shares), 1),
        ]);
    }
    aligned(&rows, 1)
}
