//! A map of the person's comfort: the postures of the arm by what they ask of the board's pose.
//!
//! A person stands upright and may stand anywhere and look anywhere. So of the pose that a posture gives the tool only
//! three numbers matter to a robot that holds the board: the height of the tip and the direction of the vertical seen from
//! the tool; where the tool may roll, that direction counts by its angle to the tool's axis alone. What a posture is worth
//! in muscular comfort depends on nothing else than itself. The map sorts postures by those numbers, the best first in
//! each cell.

use std::f64::consts::PI;

use nalgebra::Vector3;
use rand_pcg::Pcg64;

use super::{Problem, assess, propose::uniform};
use crate::{human::ArmAngles, model::frames::Pose};

/// Height of a cell, m.
const CELL_M: f64 = 0.06;
/// Cells along a side of each face of the cube that directions are sorted into: some 18 degrees.
const CELLS_A_SIDE: usize = 5;
const DIRECTIONS: usize = 6 * CELLS_A_SIDE * CELLS_A_SIDE;
/// Rings about the tool's axis, where it may roll.
const RINGS: usize = 15;
/// Heights above the floor that are looked at, m: a person's arm does not get beyond them.
const HEIGHT_M: f64 = 3.0;

/// A posture of the person's arm.
#[derive(Clone, Copy, Debug)]
pub struct Posture {
    pub q_h_rad: ArmAngles,
    /// The tool tip's frame in the body's.
    pub x_bt: Pose,
    /// Weighted muscular comfort.
    pub worth: f64,
}

/// The map.
pub struct PersonMap {
    roll_is_free: bool,
    cells: Vec<Vec<Posture>>,
}

impl PersonMap {
    /// The map from so many random postures, of which `kept` stay in each cell.
    pub fn new(problem: &Problem<'_>, postures: usize, kept: usize, random: &mut Pcg64) -> Self {
        let roll_is_free = problem.scenario.operation.kind.roll_is_free();
        let levels = (HEIGHT_M / CELL_M) as usize;
        let mut map =
            Self { roll_is_free, cells: vec![Vec::new(); levels * if roll_is_free { RINGS } else { DIRECTIONS }] };
        let weight = problem.objective.weight_muscular;
        for _ in 0..postures {
            let q_h_rad = problem.human.arm().limits_rad.map(|[low, high]| uniform(random, low, high));
            let Some(muscular) = assess::posture_comfort(problem, &q_h_rad) else { continue };
            let x_bt = problem.human.tool_pose_b(&q_h_rad);
            let Some(cell) = map.cell(&x_bt, 0.0) else { continue };
            map.cells[cell].push(Posture { q_h_rad, x_bt, worth: weight * muscular.regularised });
        }
        for cell in &mut map.cells {
            // Stable: without a weight they stay in the order in which they were drawn.
            cell.sort_by(|a, b| b.worth.total_cmp(&a.worth));
            cell.truncate(kept);
        }
        map
    }

    /// True when no posture is known at all.
    pub fn is_empty(&self) -> bool {
        self.cells.iter().all(Vec::is_empty)
    }

    /// Postures that nearly bring the tool to this pose in the world, the most comfortable first.
    pub fn postures(&self, x_wt: &Pose, floor_z_m: f64) -> &[Posture] {
        self.cell(x_wt, floor_z_m).map_or(&[], |cell| &self.cells[cell])
    }

    fn cell(&self, x_t: &Pose, floor_z_m: f64) -> Option<usize> {
        let level = ((x_t.translation.z - floor_z_m) / CELL_M).floor();
        let up_t = x_t.rotation.inverse() * Vector3::z();
        let (directions, direction) = if self.roll_is_free {
            let ring = up_t.z.clamp(-1.0, 1.0).acos() / PI * RINGS as f64;
            (RINGS, (ring as usize).min(RINGS - 1))
        } else {
            (DIRECTIONS, direction_cell(up_t.into(), CELLS_A_SIDE))
        };
        let cell = (level >= 0.0).then_some(level as usize * directions + direction)?;
        (cell < self.cells.len()).then_some(cell)
    }
}

/// The cell of a direction: the face of a cube that it points through, and where on that face.
pub fn direction_cell(v: [f64; 3], cells_a_side: usize) -> usize {
    let axis = (0..3).max_by(|&a, &b| v[a].abs().total_cmp(&v[b].abs())).unwrap_or(0);
    let face = 2 * axis + usize::from(v[axis] < 0.0);
    let place = |other: usize| {
        // The angle, not its tangent: cells of equal size.
        let share = (v[other] / v[axis].abs()).atan() / (PI / 2.0) + 0.5;
        ((share * cells_a_side as f64) as usize).min(cells_a_side - 1)
    };
    (face * cells_a_side + place((axis + 1) % 3)) * cells_a_side + place((axis + 2) % 3)
}
