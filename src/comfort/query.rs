//! The input of the person's response.

use nalgebra::Point3;

use crate::{
    collision::{CollisionModel, Scene},
    human::Human,
    model::{frames::Pose, operation::Operation, scenario::ComfortSettings, stop::Stop},
    robot::Robot,
};

/// A person with a tool, and a board that a robot holds for them.
#[derive(Clone, Copy)]
pub struct ResponseQuery<'a> {
    /// The person and the tool.
    pub human: &'a Human,
    /// The collision model of the robot.
    pub collision: &'a CollisionModel,
    /// Metrics and weights.
    pub settings: ComfortSettings,
    /// The forceful operation. Free rolls of the tool are relative to this operation's.
    pub operation: Operation,
    /// Height of the floor in W, m.
    pub floor_z_m: f64,
    /// The robot's points of the peripersonal metric in W, m: [`robot_points_w`]. If empty, the robot is infinitely far.
    pub robot_points_w: &'a [Point3<f64>],
    /// Robot and board. The scene's person is ignored. Without link poses only the board is an obstacle.
    pub scene: Scene<'a>,
    /// Ends the search for responses: there are none then.
    pub stop: &'a dyn Stop,
}

/// The robot's points of the peripersonal metric, in W, m.
#[must_use]
pub fn robot_points_w(robot: &Robot, link_poses: &[Pose]) -> Vec<Point3<f64>> {
    robot.body_points.iter().map(|point| link_poses[point.link] * point.p_l).collect()
}
