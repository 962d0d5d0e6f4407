//! The parts of a path that are worked on before, in and after a stage.

use crate::model::{staged_plan::StagedPlan, task::Task, tool_path::Piece, tool_path::Stroke};

/// Distance of two points of a drawn circle, m.
const SPACING_M: f64 = 0.01;

/// Rounding of lengths along the path, m.
const ROUNDING_M: f64 = 1e-6;

/// A part of a stroke as points on the worked face, m along x_O and y_O; one point of a hole.
pub type Trail = Vec<[f64; 2]>;

/// The path as a stage finds and leaves it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PathParts {
    /// What was worked on before the stage.
    pub done: Vec<Trail>,
    /// What is worked on in it.
    pub now: Vec<Trail>,
    /// What is still to come.
    pub to_come: Vec<Trail>,
}

impl PathParts {
    /// The parts for the stage of this number, from 0.
    #[must_use]
    pub fn of(plan: &StagedPlan, number: usize) -> Self {
        let pieces = |of: &dyn Fn(usize) -> bool| {
            let pieces = plan.worked_pieces().filter(|(stage, _)| of(*stage)).map(|(_, worked)| worked.piece);
            joined(pieces).iter().filter_map(|piece| trail(&plan.task, piece)).collect()
        };
        Self {
            done: pieces(&|stage| stage < number),
            now: pieces(&|stage| stage == number),
            to_come: pieces(&|stage| stage > number),
        }
    }
}

/// Pieces of which one begins where the one before ends are one.
fn joined(pieces: impl Iterator<Item = Piece>) -> Vec<Piece> {
    let mut joined: Vec<Piece> = Vec::new();
    for piece in pieces {
        match joined.last_mut() {
            Some(last)
                if last.stroke == piece.stroke
                    && piece.length_m() > 0.0
                    && (last.to_m - piece.from_m).abs() < ROUNDING_M =>
            {
                last.to_m = piece.to_m;
            }
            _ => joined.push(piece),
        }
    }
    joined
}

/// The points of a piece; `None` if its stroke does not exist.
fn trail(task: &Task, piece: &Piece) -> Option<Trail> {
    let stroke = task.path.get(piece.stroke)?;
    let Piece { from_m, to_m, .. } = *piece;
    let mut along_m = vec![from_m];
    match stroke {
        Stroke::Hole { .. } => {}
        Stroke::Line { points_m } => {
            let mut here_m = 0.0;
            for pair in points_m.windows(2) {
                here_m += libm::hypot(pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]);
                along_m.extend((here_m > from_m && here_m < to_m).then_some(here_m));
            }
            along_m.push(to_m);
        }
        Stroke::Circle { .. } => {
            let count = (piece.length_m() / SPACING_M).ceil().max(1.0) as usize;
            along_m.extend((1..=count).map(|k| from_m + piece.length_m() * k as f64 / count as f64));
        }
    }
    Some(along_m.into_iter().map(|along_m| stroke.at(along_m).point_m).collect())
}
