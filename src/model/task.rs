//! A task: a path that a person cuts or drills while the robot holds, moves and regrasps the board
//! (`docs/method.md#11-tasks`).

use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    operation::{Operation, OperationKind},
    tool_path::{Piece, Stroke, ToolPlace},
};

/// A path that is cut or drilled, and what its plan weighs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Task {
    /// `drill` if the path is holes, otherwise `cut`.
    pub kind: OperationKind,
    /// The tool's force, N: along the path, or into the board.
    pub force_n: f64,
    /// The strokes in their order; the tool is lifted between them.
    pub path: Vec<Stroke>,
    /// Speed of the tool along a cut, m/s.
    pub speed_m_s: f64,
    /// Longest piece of the path for which posture and stability are computed once, m.
    pub piece_m: f64,
    /// The least objective at a piece, as a share of that of the best hold for this piece alone.
    pub least_comfort: f64,
    /// What letting go and gripping again with one hand costs, in pieces of the path: as much as this many pieces that lose
    /// all of their comfort.
    pub regrasp_cost: f64,
    /// The same for a motion of the board.
    pub move_cost: f64,
    /// Limits of the arms' motions.
    pub motion: MotionSettings,
}

/// Limits of the motions of arms between the holds of a task.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct MotionSettings {
    /// Largest speed of a joint, as a share of the URDF's limit.
    pub speed_share: f64,
    /// Largest acceleration of a joint, rad/s^2.
    pub acceleration_rad_s2: f64,
}

impl Default for MotionSettings {
    /// A fifth of the robot's speed, as beside a person; an acceleration that it reaches in some tenths of a second (assumed).
    fn default() -> Self {
        Self { speed_share: 0.2, acceleration_rad_s2: 1.0 }
    }
}

impl Task {
    /// Default speed of a knife, m/s (assumed): a slow hand that cuts along a line.
    pub const SPEED_M_S: f64 = 0.03;
    /// Default length of a piece, m: 16 pieces of the circle of the paper's evaluation.
    pub const PIECE_M: f64 = 0.05;
    /// Default least comfort: half of what is possible.
    pub const LEAST_COMFORT: f64 = 0.5;
    /// Default cost of a regrasp.
    pub const REGRASP_COST: f64 = 1.0;
    /// Default cost of a motion.
    pub const MOVE_COST: f64 = 0.1;

    /// The pieces of the path in their order.
    #[must_use]
    pub fn pieces(&self) -> Vec<Piece> {
        let of_stroke = |(number, stroke): (usize, &Stroke)| {
            let ends = stroke.pieces(self.piece_m).into_iter();
            ends.map(move |[from_m, to_m]| Piece { stroke: number, from_m, to_m }).collect::<Vec<_>>()
        };
        self.path.iter().enumerate().flat_map(of_stroke).collect()
    }

    /// The operation at a length along a stroke; `None` if there is no such stroke.
    #[must_use]
    pub fn operation_at(&self, stroke: usize, along_m: f64, thickness_m: f64) -> Option<Operation> {
        let ToolPlace { point_m, direction } = self.path.get(stroke)?.at(along_m);
        Some(match direction {
            Some([x, y]) => Operation::cut(point_m, Vector3::new(x, y, 0.0), self.force_n, thickness_m),
            None => Operation::drill(point_m, self.force_n, thickness_m),
        })
    }

    /// The operation in the middle of a piece.
    #[must_use]
    pub fn operation_of(&self, piece: &Piece, thickness_m: f64) -> Option<Operation> {
        self.operation_at(piece.stroke, piece.middle_m(), thickness_m)
    }

    /// How long the tool works on a piece, s: its length at the tool's speed, or `hold_s` at a hole.
    #[must_use]
    pub fn work_s(&self, piece: &Piece, hold_s: f64) -> f64 {
        let length_m = piece.length_m();
        if length_m > 0.0 { length_m / self.speed_m_s } else { hold_s }
    }

    /// The length of all strokes, m.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.path.iter().map(Stroke::length_m).sum()
    }
}
