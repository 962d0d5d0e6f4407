//! A map of the person's comfort: the postures of the arm by what they ask of the board's pose.
//!
//! A person stands upright and may stand anywhere and look anywhere. So of the pose that a posture gives the tool only
//! three numbers matter to a robot that holds the board: the height of the tip and the direction of the vertical seen from
//! the tool; where the tool may roll, that direction counts by its angle to the tool's axis alone. What a posture is worth
//! in muscular comfort depends on nothing else than itself. The map sorts postures by those numbers, the most promising
//! first in each cell: comfortable, and with the tool at arm's length.

use std::f64::consts::PI;

use nalgebra::{Point3, Vector3};
use rand_pcg::Pcg64;

use super::{Effort, assess, propose::uniform};
use crate::{
    human::{ArmAngles, BODY_POINTS, Human},
    model::{frames::Pose, scenario::Scenario},
};

/// Height of a cell, m.
const CELL_M: f64 = 0.06;
/// Cells along a side of each face of the cube that directions are sorted into: some 18 degrees.
const CELLS_A_SIDE: usize = 5;
const DIRECTIONS: usize = 6 * CELLS_A_SIDE * CELLS_A_SIDE;
/// Rings about the tool's axis, where it may roll.
const RINGS: usize = 15;
/// Heights above the floor that are looked at, m: a person's arm does not get beyond them.
const HEIGHT_M: f64 = 3.0;
/// How many of the body's points a posture keeps: a quarter tells promising postures from others.
pub const SKETCH_POINTS: usize = BODY_POINTS / 4;

/// The first so many of them, spread over the body, do for a first look.
pub const GLANCE_POINTS: usize = SKETCH_POINTS / 4;

/// A posture of the person's arm.
#[derive(Clone, Copy, Debug)]
pub struct Posture {
    pub q_h_rad: ArmAngles,
    /// The tool tip's frame in the body's.
    pub x_bt: Pose,
    /// Regularised muscular comfort; what it weighs is the asking problem's affair.
    pub muscular: f64,
    /// Some of the body's points, B.
    pub sketch_b: [Point3<f64>; SKETCH_POINTS],
}

impl Posture {
    /// Some of the points of a body that stands there.
    pub fn sketch_w(&self, x_wb: &Pose) -> [Point3<f64>; SKETCH_POINTS] {
        self.sketch_b.map(|p_b| x_wb * p_b)
    }
}

/// The map.
pub struct PersonMap {
    roll_is_free: bool,
    cells: Vec<Vec<Posture>>,
}

impl PersonMap {
    /// The map of a scenario's person.
    pub fn of(scenario: &Scenario, human: &Human) -> Self {
        let objective = scenario.planner.kind.objective(scenario.comfort);
        let Effort { postures, postures_a_cell: kept, .. } = Effort::of(scenario.planner.budget);
        let wrench_t = super::wrench_t(&scenario.operation);
        let mut map = Self { roll_is_free: scenario.operation.kind.roll_is_free(), cells: Vec::new() };
        let mut found = vec![Vec::new(); map.cell_count()];
        let mut random = Pcg64::new(u128::from(scenario.planner.seed), 0);
        for _ in 0..postures {
            let q_h_rad = human.arm().limits_rad.map(|[low, high]| uniform(&mut random, low, high));
            let (x_bt, direction) = (human.tool_pose_b(&q_h_rad), objective.direction);
            let Some(muscular) = assess::posture_comfort(human, &q_h_rad, &x_bt, &wrench_t, direction) else {
                continue;
            };
            let Some(cell) = map.cell(&x_bt, 0.0) else { continue };
            // The robot is where the board is: who works at arm's length keeps away from it by as much.
            let rank = objective.weight_muscular * muscular.regularised
                + objective.weight_peripersonal * x_bt.translation.vector.xy().norm();
            found[cell].push((rank, q_h_rad, x_bt, muscular.regularised));
        }
        let sketched = |(_, q_h_rad, x_bt, muscular): &(f64, ArmAngles, Pose, f64)| {
            let points = human.body_points_w(&Pose::identity(), q_h_rad);
            // A permutation of 0 to 15 in which the first four are far apart.
            let spread = |place: usize| 4 * (place % GLANCE_POINTS) + place / GLANCE_POINTS;
            let sketch_b = std::array::from_fn(|place| points[spread(place) * BODY_POINTS / SKETCH_POINTS + 1]);
            Posture { q_h_rad: *q_h_rad, x_bt: *x_bt, muscular: *muscular, sketch_b }
        };
        map.cells = found
            .into_iter()
            .map(|mut cell| {
                cell.sort_by(|a, b| b.0.total_cmp(&a.0));
                cell.iter().take(kept).map(sketched).collect()
            })
            .collect();
        map
    }

    fn cell_count(&self) -> usize {
        (HEIGHT_M / CELL_M) as usize * if self.roll_is_free { RINGS } else { DIRECTIONS }
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
        (cell < self.cell_count()).then_some(cell)
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
