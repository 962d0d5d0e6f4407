//! The posture map: postures of the person's arm by what they ask of the board's pose.
//!
//! A person stands upright, anywhere, with any heading. So of the tool pose that a posture gives, only three numbers matter
//! to a robot that holds the board: the height of the tip and the direction of the vertical seen from the tool; where the
//! tool's roll is free, only the angle between the vertical and the tool's axis. The muscular comfort of a posture depends
//! on the posture alone. The map sorts postures by those numbers; in each cell the most promising come first: comfortable,
//! and with the tool far from the body.

use std::{f64::consts::PI, ops::Range};

use nalgebra::{Point3, Vector3};
use rand_pcg::Pcg64;
use rayon::prelude::*;

use super::direction::{direction_cell, direction_cells};
use crate::{
    human::{ArmAngles, BODY_POINTS, Human, Muscular},
    model::{frames::Pose, scenario::ComfortSettings, stop::Stop as _, wrench::Wrench},
    planner::{
        domain::uniform,
        params::{
            SearchBudget,
            library::{POSTURE_CELL_M, POSTURE_DIRECTIONS, POSTURE_HEIGHT_M, POSTURE_RINGS},
        },
        watch::{Counter, Phase, Watch},
    },
};

/// Body points of the medium set: a quarter ranks postures well enough for screening.
pub const MEDIUM_POINTS: usize = BODY_POINTS / 4;
/// The first points of the medium set, spread over the body, are the coarse set.
pub const COARSE_POINTS: usize = MEDIUM_POINTS / 4;

/// Joints of the person's arm: so many numbers are drawn for a posture.
const JOINTS: usize = 7;

/// A drawn posture: its rank, joint angles, rad, pose of the tool tip in the body frame, and regularised muscular comfort.
type Ranked = (f64, ArmAngles, Pose, f64);

/// Draws that a thread makes in a row.
const DRAWN_AT_ONCE: usize = 5_000;

/// A posture of the person's arm.
#[derive(Clone, Copy, Debug)]
pub struct Posture {
    /// Joint angles, rad.
    pub q_h_rad: ArmAngles,
    /// The tool tip's pose in the body frame.
    pub x_bt: Pose,
    /// Regularised muscular comfort, unweighted.
    pub muscular: f64,
    /// The medium set of body points, B.
    pub medium_points_b: [Point3<f64>; MEDIUM_POINTS],
}

impl Posture {
    /// The medium set of points of a body at a pose.
    pub fn medium_points_w(&self, x_wb: &Pose) -> [Point3<f64>; MEDIUM_POINTS] {
        self.medium_points_b.map(|p_b| x_wb * p_b)
    }
}

/// The load on the person that a posture map is made for.
#[derive(Clone, Copy, Debug)]
pub struct PostureLoad {
    /// Wrench about the tool tip, T axes.
    pub wrench_t: Wrench,
    /// The worked face's normal, T axes.
    pub normal_t: Vector3<f64>,
    /// True if the tool's roll is free.
    pub roll_is_free: bool,
}

/// The map.
pub struct PostureMap {
    roll_is_free: bool,
    cells: Vec<Vec<Posture>>,
    /// Places of the most promising postures in `cells`, the best first.
    ranked: Vec<[usize; 2]>,
    /// True if a posture within the limits of a natural one was drawn.
    has_natural: bool,
}

impl PostureMap {
    /// The map of a person with a tool under a load. `objective` ranks the postures of a cell. After a stop it is not complete.
    pub fn new(
        human: &Human,
        load: &PostureLoad,
        objective: &ComfortSettings,
        budget: &SearchBudget,
        seed: u64,
        watch: &dyn Watch,
    ) -> Self {
        let mut map =
            Self { roll_is_free: load.roll_is_free, cells: Vec::new(), ranked: Vec::new(), has_natural: false };
        let mut found = vec![Vec::new(); map.cell_count()];
        let draws = if human.posture().is_natural() { budget.natural_postures } else { budget.postures };
        let counter = Counter::new(watch, Phase::Postures, draws);
        let firsts: Vec<_> = (0..draws).step_by(DRAWN_AT_ONCE).collect();
        let part = |&first: &usize| {
            map.drawn(human, load, objective, seed, (first..draws.min(first + DRAWN_AT_ONCE), &counter))
        };
        let parts: Vec<_> = firsts.par_iter().map(part).collect();
        for (has_natural, kept) in parts {
            map.has_natural |= has_natural;
            kept.into_iter().for_each(|(cell, posture)| found[cell].push(posture));
        }
        let posture = |(_, q_h_rad, x_bt, muscular): &Ranked| {
            let points = human.body_points_w(&Pose::identity(), q_h_rad);
            // A permutation of 0 to 15 in which the first four are far apart.
            let spread = |place: usize| 4 * (place % COARSE_POINTS) + place / COARSE_POINTS;
            let medium_points_b = std::array::from_fn(|place| points[spread(place) * BODY_POINTS / MEDIUM_POINTS + 1]);
            Posture { q_h_rad: *q_h_rad, x_bt: *x_bt, muscular: *muscular, medium_points_b }
        };
        for cell in &mut found {
            cell.sort_by(|a, b| b.0.total_cmp(&a.0));
            cell.truncate(budget.postures_per_cell);
        }
        let mut ranked: Vec<_> = found
            .iter()
            .enumerate()
            .flat_map(|(cell, kept)| kept.iter().enumerate().map(move |(place, posture)| (posture.0, [cell, place])))
            .collect();
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
        map.ranked = ranked.into_iter().map(|(_, place)| place).collect();
        map.cells = found.iter().map(|cell| cell.iter().map(posture).collect()).collect();
        map
    }

    /// The draws with these numbers: whether one is within the limits of a natural posture, and those that are kept with their cells.
    /// They are the same whatever is drawn at once.
    fn drawn(
        &self,
        human: &Human,
        load: &PostureLoad,
        objective: &ComfortSettings,
        seed: u64,
        (numbers, counter): (Range<usize>, &Counter<'_>),
    ) -> (bool, Vec<(usize, Ranked)>) {
        let mut random = Pcg64::new(u128::from(seed), 0);
        random.advance((JOINTS * numbers.start) as u128);
        let mut has_natural = false;
        let mut kept = Vec::new();
        for _ in numbers {
            if counter.is_stopped() {
                break;
            }
            counter.advance();
            let q_h_rad = human.arm().ranges.at_shares([(); JOINTS].map(|()| uniform(&mut random, 0.0, 1.0)));
            let x_bt = human.tool_pose_b(&q_h_rad);
            if !human.arm().permits_shoulder(&q_h_rad) || human.work_violation(&x_bt, &load.normal_t).is_some() {
                continue;
            }
            has_natural = true;
            let muscular = posture_muscular(human, &q_h_rad, &x_bt, &load.wrench_t, objective);
            if !within_strength(&muscular) {
                continue;
            }
            let Some(cell) = self.cell(&x_bt, 0.0) else { continue };
            // The robot is where the board is: a long reach keeps the bodies apart.
            let rank = objective.weight_muscular * muscular.regularised
                + objective.weight_peripersonal * x_bt.translation.vector.xy().norm();
            kept.push((cell, (rank, q_h_rad, x_bt, muscular.regularised)));
        }
        (has_natural, kept)
    }

    /// The postures of all cells, the most promising first.
    pub fn ranked(&self) -> impl Iterator<Item = &Posture> {
        self.ranked.iter().map(|&[cell, place]| &self.cells[cell][place])
    }

    fn cell_count(&self) -> usize {
        (POSTURE_HEIGHT_M / POSTURE_CELL_M) as usize * self.cells_per_level()
    }

    fn cells_per_level(&self) -> usize {
        if self.roll_is_free { POSTURE_RINGS } else { direction_cells(POSTURE_DIRECTIONS) }
    }

    /// True if a posture within the limits of a natural one was drawn, strong enough or not.
    pub fn has_natural(&self) -> bool {
        self.has_natural
    }

    /// True if no posture is natural and within the person's strength.
    pub fn is_empty(&self) -> bool {
        self.cells.iter().all(Vec::is_empty)
    }

    /// Postures that nearly bring the tool to this pose in the world, the most promising first.
    pub fn postures(&self, x_wt: &Pose, floor_z_m: f64) -> &[Posture] {
        self.cell(x_wt, floor_z_m).map_or(&[], |cell| &self.cells[cell])
    }

    fn cell(&self, x_t: &Pose, floor_z_m: f64) -> Option<usize> {
        let level = ((x_t.translation.z - floor_z_m) / POSTURE_CELL_M).floor();
        let up_t = x_t.rotation.inverse() * Vector3::z();
        let direction = if self.roll_is_free {
            let ring = up_t.z.clamp(-1.0, 1.0).acos() / PI * POSTURE_RINGS as f64;
            (ring as usize).min(POSTURE_RINGS - 1)
        } else {
            direction_cell(up_t.into(), POSTURE_DIRECTIONS)
        };
        let cell = (level >= 0.0).then_some(level as usize * self.cells_per_level() + direction)?;
        (cell < self.cell_count()).then_some(cell)
    }
}

/// The muscular comfort of a posture. It does not depend on the person's place or heading: the operation's wrench is fixed in
/// the tool, and gravity is vertical.
pub fn posture_muscular(
    human: &Human,
    q_h_rad: &ArmAngles,
    x_bt: &Pose,
    wrench_t: &Wrench,
    settings: &ComfortSettings,
) -> Muscular {
    let wrench_b = Wrench::new(x_bt.rotation * wrench_t.force_n, x_bt.rotation * wrench_t.moment_nm);
    human.muscular(q_h_rad, &Pose::identity(), &wrench_b, settings)
}

/// True if every joint is strong enough.
pub fn within_strength(muscular: &Muscular) -> bool {
    muscular.activations.iter().all(|&activation| activation <= 1.0)
}
