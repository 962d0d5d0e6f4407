//! A map of where an arm's gripper can be: it rejects hopeless poses at once and seeds inverse kinematics for the others.
//!
//! Turning the first joint turns the gripper about that joint's axis, and turning the last joint leaves the last axis where it
//! is. So what an arm reaches depends, but for the limits of these two joints, on four numbers: the distance of the last
//! joint from the first axis, its height along that axis, and the direction of the last axis seen from there. The map
//! divides them into cells and keeps a few configurations of each. If the first or the last joint
//! is prismatic, the seeds keep its position.

use std::f64::consts::PI;

use nalgebra::{Isometry3, Unit, UnitQuaternion, Vector3};
use rand::RngExt;
use rand_pcg::Pcg64;

use super::direction::{direction_cell, direction_cells};
use crate::{
    model::frames::Pose,
    planner::{
        domain::uniform,
        params::library::{REACH_CELL_M, REACH_DIRECTIONS, REACH_SAMPLES, REACH_SEED, REACH_SEEDS},
    },
    robot::Chain,
};

/// The map of one arm.
#[derive(Clone, Debug)]
pub struct ReachMap {
    rings: usize,
    levels: usize,
    reach_m: f64,
    samples: Vec<Sample>,
    /// Indices of the samples in each cell.
    cells: Vec<Vec<usize>>,
}

#[derive(Clone, Debug)]
struct Sample {
    /// Azimuth of the last joint about the first one's axis, rad.
    azimuth_rad: f64,
    q_rad: Vec<f64>,
    x_wg: Pose,
}

/// Where a gripper is relative to the first joint's axis.
struct Located {
    cell: Option<usize>,
    azimuth_rad: f64,
}

impl ReachMap {
    /// The map of an arm. It takes some hundredths of a second, too little to be stopped.
    pub fn new(chain: &Chain) -> Self {
        let reach_m = chain.reach_m();
        let rings = (reach_m / REACH_CELL_M).ceil() as usize;
        let levels = 2 * rings;
        let cells = vec![Vec::new(); rings * levels * direction_cells(REACH_DIRECTIONS)];
        let mut map = Self { rings, levels, reach_m, samples: Vec::new(), cells };
        let mut random = Pcg64::new(REACH_SEED, 0);
        for _ in 0..REACH_SAMPLES {
            let limits = chain.lower().iter().zip(chain.upper());
            let q_rad: Vec<_> = limits.map(|(&low, &high)| uniform(&mut random, low, high)).collect();
            let x_wg = chain.gripper_pose(&q_rad);
            let Located { cell, azimuth_rad } = map.locate(chain, &x_wg);
            if let Some(cell) = cell.map(|cell| &mut map.cells[cell])
                && cell.len() < REACH_SEEDS
            {
                cell.push(map.samples.len());
            }
            map.samples.push(Sample { azimuth_rad, q_rad, x_wg });
        }
        map
    }

    /// False if no configuration is known near this pose of the gripper.
    pub fn reaches(&self, chain: &Chain, x_wg: &Pose) -> bool {
        self.locate(chain, x_wg).cell.is_some_and(|cell| !self.cells[cell].is_empty())
    }

    /// Configurations near those that bring the gripper to this pose, within the joint limits.
    pub fn seeds<'a>(&'a self, chain: &'a Chain, x_wg: &'a Pose) -> impl Iterator<Item = Vec<f64>> + 'a {
        let Located { cell, azimuth_rad } = self.locate(chain, x_wg);
        let samples = cell.map_or(&[][..], |cell| &self.cells[cell]);
        samples.iter().filter_map(move |&number| {
            let sample = &self.samples[number];
            let mut q_rad = sample.q_rad.clone();
            // A prismatic joint does not turn the gripper about its axis.
            let first = if chain.begins_revolute() { q_rad[0] + azimuth_rad - sample.azimuth_rad } else { q_rad[0] };
            let within = |joint: usize, q: f64| {
                let turns = [q, q - 2.0 * PI, q + 2.0 * PI];
                turns.into_iter().find(|q| (chain.lower()[joint]..=chain.upper()[joint]).contains(q))
            };
            q_rad[0] = within(0, first)?;
            let last = q_rad.len() - 1;
            if let Some(angle_rad) = chain.last_angle_towards(&q_rad, x_wg) {
                q_rad[last] = within(last, angle_rad)?;
            }
            Some(q_rad)
        })
    }

    /// A configuration of the map with the first joint drawn at random, and the pose of a body that the gripper holds at
    /// `x_gb`; `None` if `accepts` refuses that pose.
    pub fn draw(
        &self,
        chain: &Chain,
        x_gb: &Pose,
        accepts: impl Fn(&Pose) -> bool,
        random: &mut Pcg64,
    ) -> Option<(Vec<f64>, Pose)> {
        if self.samples.is_empty() {
            return None;
        }
        let Sample { q_rad, x_wg, .. } = &self.samples[random.random_range(0..self.samples.len())];
        let drawn = uniform(random, chain.lower()[0], chain.upper()[0]);
        let turn_rad = if chain.begins_revolute() { drawn - q_rad[0] } else { 0.0 };
        let (origin_w, axis_w) = chain.first_axis_w();
        let turn = UnitQuaternion::from_axis_angle(&Unit::new_unchecked(axis_w), turn_rad);
        let x_wb = x_wg * x_gb;
        let p_wb = origin_w + turn * (x_wb.translation.vector - origin_w);
        let x_wb = Isometry3::from_parts(p_wb.into(), turn * x_wb.rotation);
        accepts(&x_wb).then(|| {
            let mut q_rad = q_rad.clone();
            q_rad[0] += turn_rad;
            (q_rad, x_wb)
        })
    }

    fn locate(&self, chain: &Chain, x_wg: &Pose) -> Located {
        let (origin_w, axis_w) = chain.first_axis_w();
        let (p_w, direction_w) = chain.last_axis_w(x_wg);
        let from_axis = p_w - origin_w;
        let height_m = from_axis.dot(&axis_w);
        let outward = from_axis - axis_w * height_m;
        let distance_m = outward.norm();
        // Any fixed direction serves as the azimuth's zero.
        let zero = axis_w.cross(&if axis_w.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() }).normalize();
        let azimuth_rad = axis_w.cross(&zero).dot(&outward).atan2(zero.dot(&outward));
        let outward = outward / distance_m.max(f64::MIN_POSITIVE);
        let direction = [outward.dot(&direction_w), axis_w.cross(&outward).dot(&direction_w), axis_w.dot(&direction_w)];
        let ring = (distance_m / REACH_CELL_M) as usize;
        let level = ((height_m + self.reach_m) / REACH_CELL_M).floor();
        let inside = ring < self.rings && level >= 0.0 && (level as usize) < self.levels;
        let cell = inside.then(|| {
            (ring * self.levels + level as usize) * direction_cells(REACH_DIRECTIONS)
                + direction_cell(direction, REACH_DIRECTIONS)
        });
        Located { cell, azimuth_rad }
    }
}
