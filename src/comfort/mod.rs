//! How comfortable a hold is: what the person's answers to it are worth.
//!
//! A robot that holds a board in place leaves the person a set of answers, Q_h: where to stand and look, how to turn a
//! tool that is free to roll, how to lift the elbow. `most` is the best of them, `average` their mean (METHOD section 3).
//! This module stands between the person and the planner: it knows bodies, collisions and both metrics; it does not know
//! how a hold is searched for, nor whether it stands.

mod best_response;
pub mod curve;
mod responses;
#[cfg(test)]
mod tests;

use nalgebra::Point3;

pub use best_response::{best_response, response_near};
pub use responses::Response;

use crate::{
    collision::{CollisionModel, Scene},
    human::{ArmAngles, BODY_POINTS, Human, Muscular, peripersonal_m},
    model::{
        frames::Pose,
        operation::Operation,
        plan::{Comfort, MeanComfort},
        scenario::ComfortSettings,
        wrench::Wrench,
    },
    robot::Robot,
};

/// A robot that holds a board for a person with a tool.
#[derive(Clone, Copy)]
pub struct ResponseQuery<'a> {
    /// The person and the tool.
    pub human: &'a Human,
    /// Who touches whom.
    pub collision: &'a CollisionModel,
    /// How comfort is measured.
    pub settings: ComfortSettings,
    /// The forceful operation. Rolls that the tool is free to take are counted from this one's.
    pub operation: Operation,
    /// Height of the floor in W, m.
    pub floor_z_m: f64,
    /// The robot's points of the peripersonal metric in W, m: [`robot_points_w`]. Without any, the robot is infinitely far.
    pub robot_points_w: &'a [Point3<f64>],
    /// Robot and board. The scene's person is not looked at; without link poses the board alone is in the way.
    pub scene: Scene<'a>,
}

/// The robot's points of the peripersonal metric, in W, m.
pub fn robot_points_w(robot: &Robot, link_poses: &[Pose]) -> Vec<Point3<f64>> {
    robot.body_points.iter().map(|point| link_poses[point.link] * point.p_l).collect()
}

/// The comfort of one posture of the person (METHOD sections 4 and 5): planner and check both take it from here.
/// `wrench_w` is the operation's about the tool tip in world axes.
pub fn posture_comfort(
    human: &Human,
    settings: &ComfortSettings,
    robot_points_w: &[Point3<f64>],
    x_wb: &Pose,
    q_rad: &ArmAngles,
    wrench_w: &Wrench,
) -> Comfort {
    let Muscular { activations, printed, regularised } = human.muscular(q_rad, x_wb, wrench_w, settings.direction);
    let body = human.body_points_w(x_wb, q_rad);
    let peripersonal_m = peripersonal_m(settings.peripersonal, settings.saturation_m, &body, robot_points_w);
    Comfort {
        muscular: printed,
        muscular_regularised: regularised,
        peripersonal_m,
        peripersonal_scaled: Some(BODY_POINTS as f64 * peripersonal_m),
        objective: objective(settings, regularised, peripersonal_m),
        activations,
        average: None,
        rula: Some(human.rula(q_rad, wrench_w)),
    }
}

/// The weighted sum of both comforts, `w_M muscular + w_P peripersonal`, by the weights of either form of the objective.
fn objective(settings: &ComfortSettings, muscular_regularised: f64, peripersonal_m: f64) -> f64 {
    let [weight_muscular, weight_peripersonal] = settings.weights();
    weight_muscular * muscular_regularised + weight_peripersonal * peripersonal_m
}

/// A comfort with the objective of other weights: of the mean, where it has one.
pub fn weighted(comfort: Comfort, settings: &ComfortSettings) -> Comfort {
    let (muscular_regularised, peripersonal_m) = match comfort.average {
        Some(average) => (average.muscular_regularised, average.peripersonal_m),
        None => (comfort.muscular_regularised, comfort.peripersonal_m),
    };
    Comfort { objective: objective(settings, muscular_regularised, peripersonal_m), ..comfort }
}

/// Makes the mean over all answers the objective of a posture's comfort.
pub fn use_mean_response(comfort: &mut Comfort, average: MeanComfort, settings: &ComfortSettings) {
    comfort.objective = objective(settings, average.muscular_regularised, average.peripersonal_m);
    comfort.average = Some(average);
}

/// The mean comfort over the person's answers to a query, discretised uniformly (METHOD section 3; the steps are those of
/// [`Response`]); none when there is no response.
pub fn mean_response(query: &ResponseQuery<'_>) -> Option<MeanComfort> {
    let (mut responses, mut muscular, mut peripersonal_m) = (0_u64, 0.0, 0.0);
    responses::visit(query, |_, response| {
        responses += 1;
        muscular += response.muscular.regularised;
        peripersonal_m += response.peripersonal_m;
    });
    let n = responses as f64;
    (responses > 0).then(|| MeanComfort {
        responses,
        muscular_regularised: muscular / n,
        peripersonal_m: peripersonal_m / n,
    })
}
