//! What one arm does in a part of a stage.

use crate::model::frames::Pose;

/// A grasp by which an arm grips the board again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewGrasp {
    /// The number of the arm in the plan.
    pub arm: usize,
    /// X_OG.
    pub x_og: Pose,
    /// The force with which each finger closes, N.
    pub grip_force_n: f64,
}

/// What an arm does at a time.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmCommand {
    /// Joint angles, rad.
    pub q_rad: Vec<f64>,
    /// Joint speeds, rad/s.
    pub speed_rad_s: Vec<f64>,
    /// Torques for the arm's own weight, N m.
    pub arm_nm: Vec<f64>,
    /// Torques for its share of the board's weight, N m.
    pub board_nm: Vec<f64>,
    /// Share of the grip force with which the gripper closes; negative while it opens.
    pub grip_share: f64,
}

/// A point of an arm's path.
#[derive(Clone, Debug)]
pub struct Knot {
    pub time_s: f64,
    pub q_rad: Vec<f64>,
    pub arm_nm: Vec<f64>,
    pub board_nm: Vec<f64>,
}

/// An arm in a segment.
#[derive(Clone, Debug)]
pub struct ArmSegment {
    /// In the order of time, at least one.
    pub knots: Vec<Knot>,
    /// Share of the grip force at the beginning and at the end.
    pub grip: [f64; 2],
}

impl ArmSegment {
    /// What the arm does at a time since the beginning, s, after a share of the whole.
    pub fn at(&self, time_s: f64, share: f64) -> ArmCommand {
        let grip_share = self.grip[0] + share * (self.grip[1] - self.grip[0]);
        let next = self.knots.partition_point(|knot| knot.time_s <= time_s);
        let [last, next] = [next.saturating_sub(1), next.min(self.knots.len() - 1)].map(|number| &self.knots[number]);
        let whole_s = next.time_s - last.time_s;
        let part = if whole_s > 0.0 { (time_s - last.time_s) / whole_s } else { 0.0 };
        let between = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a + part * (b - a)).collect();
        let rate = |(a, b): (&f64, &f64)| if whole_s > 0.0 { (b - a) / whole_s } else { 0.0 };
        ArmCommand {
            q_rad: between(&last.q_rad, &next.q_rad),
            speed_rad_s: last.q_rad.iter().zip(&next.q_rad).map(rate).collect(),
            arm_nm: between(&last.arm_nm, &next.arm_nm),
            board_nm: between(&last.board_nm, &next.board_nm),
            grip_share,
        }
    }
}
