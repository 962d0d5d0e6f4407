//! A grasp of another planner.

use crate::model::frames::Pose;

/// A grasp of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct ForeignGrasp {
    /// Its name.
    pub name: String,
    /// Its key in the file.
    pub key: String,
    /// The line of its pose, from 1.
    pub line: usize,
    /// The pose of the file's gripper frame in the frame `frame`.
    pub x_fh: Pose,
    /// The name of the frame that the pose is in.
    pub frame: String,
    /// The planner's confidence or quality.
    pub confidence: Option<f64>,
    /// The largest force on the object, N; `None` without a limit.
    pub max_force_n: Option<f64>,
}
