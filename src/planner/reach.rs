//! A map of where an arm's hand can be: it says at once that a pose is hopeless, and where to start for one that is not.
//!
//! Turning the first joint turns the hand about that joint's axis, and turning the last one leaves that joint's own axis
//! where it is. So what an arm reaches depends, but for those two joints' limits, on four numbers: the distance of the last
//! joint from the first one's axis, its height along it, and the direction of the last axis seen from there. The map
//! divides them into cells and keeps a few configurations of each. It holds for every arm with a revolute joint at either
//! end, knows nothing of boards and people, and is made anew in some 20 ms: there is no file that could be out of date.

use std::f64::consts::PI;

use nalgebra::{Isometry3, Unit, UnitQuaternion, Vector3};
use rand::RngExt;
use rand_pcg::Pcg64;

use super::{person_map::direction_cell, propose::uniform};
use crate::{model::frames::Pose, robot::Chain};

/// Configurations that the map is made of.
const SAMPLES: usize = 24_000;
/// Configurations that a cell keeps.
const KEPT: usize = 4;
/// Side of a cell in distance and height, m.
const CELL_M: f64 = 0.1;
/// Cells along a side of each face of the cube that directions are sorted into: some 30 degrees.
const CELLS_A_SIDE: usize = 3;
const DIRECTIONS: usize = 6 * CELLS_A_SIDE * CELLS_A_SIDE;
/// The map's seed: it is the same for every search.
const SEED: u128 = 0x05ee_d0fa_11ab_0a2d;

/// The map of one arm.
#[derive(Clone, Debug)]
pub struct ReachMap {
    rings: usize,
    levels: usize,
    reach_m: f64,
    samples: Vec<Sample>,
    /// The numbers of the samples in each cell.
    cells: Vec<Vec<usize>>,
}

#[derive(Clone, Debug)]
struct Sample {
    /// Azimuth of the last joint about the first one's axis, rad.
    azimuth_rad: f64,
    q_rad: Vec<f64>,
    x_wg: Pose,
}

/// Where a hand is, seen from the first joint's axis.
struct Seen {
    cell: Option<usize>,
    azimuth_rad: f64,
}

impl ReachMap {
    /// The map of an arm.
    pub fn new(chain: &Chain) -> Self {
        let reach_m = chain.reach_m();
        let rings = (reach_m / CELL_M).ceil() as usize;
        let levels = 2 * rings;
        let cells = vec![Vec::new(); rings * levels * DIRECTIONS];
        let mut map = Self { rings, levels, reach_m, samples: Vec::new(), cells };
        let mut random = Pcg64::new(SEED, 0);
        for _ in 0..SAMPLES {
            let limits = chain.lower().iter().zip(chain.upper());
            let q_rad: Vec<_> = limits.map(|(&low, &high)| uniform(&mut random, low, high)).collect();
            let x_wg = chain.gripper_pose(&q_rad);
            let Seen { cell, azimuth_rad } = map.seen(chain, &x_wg);
            if let Some(cell) = cell.map(|cell| &mut map.cells[cell])
                && cell.len() < KEPT
            {
                cell.push(map.samples.len());
            }
            map.samples.push(Sample { azimuth_rad, q_rad, x_wg });
        }
        map
    }

    /// False when no configuration is known near this pose of the hand.
    pub fn reaches(&self, chain: &Chain, x_wg: &Pose) -> bool {
        self.seen(chain, x_wg).cell.is_some_and(|cell| !self.cells[cell].is_empty())
    }

    /// Configurations near those that bring the hand to this pose, within the joints' limits.
    pub fn seeds<'a>(&'a self, chain: &'a Chain, x_wg: &'a Pose) -> impl Iterator<Item = Vec<f64>> + 'a {
        let Seen { cell, azimuth_rad } = self.seen(chain, x_wg);
        let samples = cell.map_or(&[][..], |cell| &self.cells[cell]);
        samples.iter().filter_map(move |&number| {
            let sample = &self.samples[number];
            let mut q_rad = sample.q_rad.clone();
            let first = q_rad[0] + azimuth_rad - sample.azimuth_rad;
            let within = |joint: usize, q: f64| {
                let turns = [q, q - 2.0 * PI, q + 2.0 * PI];
                turns.into_iter().find(|q| (chain.lower()[joint]..=chain.upper()[joint]).contains(q))
            };
            q_rad[0] = within(0, first)?;
            let last = q_rad.len() - 1;
            q_rad[last] = within(last, chain.last_angle_towards(&q_rad, x_wg))?;
            Some(q_rad)
        })
    }

    /// A configuration that is one of the map's but for the first joint, which turns what the hand holds at `x_gb` to a drawn
    /// azimuth, and the pose of that; none when `accepts` does not want it or the joint does not turn so far.
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
        let turn_rad = uniform(random, chain.lower()[0], chain.upper()[0]) - q_rad[0];
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

    fn seen(&self, chain: &Chain, x_wg: &Pose) -> Seen {
        let (origin_w, axis_w) = chain.first_axis_w();
        let (p_w, direction_w) = chain.last_axis_w(x_wg);
        let from_axis = p_w - origin_w;
        let height_m = from_axis.dot(&axis_w);
        let outward = from_axis - axis_w * height_m;
        let distance_m = outward.norm();
        // Any direction will do as the azimuth's zero, as long as it is always the same.
        let zero = axis_w.cross(&if axis_w.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() }).normalize();
        let azimuth_rad = axis_w.cross(&zero).dot(&outward).atan2(zero.dot(&outward));
        let outward = outward / distance_m.max(f64::MIN_POSITIVE);
        let direction = [outward.dot(&direction_w), axis_w.cross(&outward).dot(&direction_w), axis_w.dot(&direction_w)];
        let ring = (distance_m / CELL_M) as usize;
        let level = ((height_m + self.reach_m) / CELL_M).floor();
        let inside = ring < self.rings && level >= 0.0 && (level as usize) < self.levels;
        let cell = inside
            .then(|| (ring * self.levels + level as usize) * DIRECTIONS + direction_cell(direction, CELLS_A_SIDE));
        Seen { cell, azimuth_rad }
    }
}
