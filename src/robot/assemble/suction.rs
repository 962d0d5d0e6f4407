//! Suction cups: one measured lip in place of two jaws.

use std::ops::RangeInclusive;

use nalgebra::Vector3;
use toml::Spanned;

use super::{Assembler, solid::Solid};
use crate::robot::{
    description::GripperEntry,
    geometry::Shape,
    holding::Holding,
    tree::{Cup, Gripper},
};

/// Diameter and height of a cup, m: from a cup for electronics to a plate of a vacuum lifter.
const CUP_SIDE_M: RangeInclusive<f64> = 0.002..=0.5;

/// Mass of a cup with its fitting, kg.
const CUP_MASS_KG: f64 = 0.05;
const CUP_RGBA: [f64; 4] = [0.15, 0.15, 0.15, 1.0];

impl Assembler<'_> {
    /// A suction cup: a cylinder before the palm that ends at the origin of G, where its lip touches the board.
    pub(super) fn suction(
        &mut self,
        arm: &str,
        entry: &GripperEntry,
        [frame_link, palm_link]: [usize; 2],
        holding: Option<Holding>,
    ) -> Option<Gripper> {
        self.refuse_keys_of_jaws(entry);
        if entry.wrench_limits.is_none() {
            self.fault(entry.frame_link.span(), "wrench_limits", "none", "the measured limits of the suction cup");
        }
        let diameter_m = self.cup_side("cup_diameter_m", entry.cup_diameter_m.as_ref(), entry);
        let height_m = self.cup_side("cup_height_m", entry.cup_height_m.as_ref(), entry);
        let (radius_m, height_m, holding) = (diameter_m? / 2.0, height_m?, holding?);
        let x_wl = self.robot.link_poses(&self.robot.positions(&[]));
        let x_pg = x_wl[palm_link].inverse() * x_wl[frame_link];
        let link = self.robot.add_frame(&format!("{arm}_cup"), palm_link, x_pg);
        self.effort.push(0.0);
        self.carriers = self.robot.carriers();
        let centre = Vector3::new(0.0, 0.0, -height_m / 2.0);
        let (across, along) = (
            CUP_MASS_KG * (3.0 * radius_m * radius_m + height_m * height_m) / 12.0,
            CUP_MASS_KG * radius_m * radius_m / 2.0,
        );
        let shape = Shape::Cylinder { radius_m, half_length_m: height_m / 2.0 };
        let solid = Solid { shape, mass_kg: CUP_MASS_KG, inertia: [across, across, along], rgba: CUP_RGBA };
        solid.add_to(&mut self.robot.links[link], centre);
        Some(Gripper {
            frame_link,
            palm_link,
            fingers: Vec::new(),
            cup: Some(Cup { link, radius_m }),
            opening_m: [0.0, f64::INFINITY],
            holding,
            linkage: None,
        })
    }

    fn refuse_keys_of_jaws(&mut self, entry: &GripperEntry) {
        let pairs = [&entry.opening_m, &entry.pad_size_m, &entry.pad_centre_m];
        for (key, given) in ["opening_m", "pad_size_m", "pad_centre_m"].into_iter().zip(pairs) {
            if let Some(given) = given {
                self.fault(given.span(), key, "a key of two jaws", "no such key: a suction cup has cup_diameter_m");
            }
        }
        if let Some(fingers) = &entry.fingers {
            self.fault(fingers.span(), "fingers", "fingers of a suction cup", "no such key");
        }
    }

    fn cup_side(&mut self, key: &str, given: Option<&Spanned<f64>>, entry: &GripperEntry) -> Option<f64> {
        let expected = format!("{} to {} m", CUP_SIDE_M.start(), CUP_SIDE_M.end());
        let Some(given) = given else {
            self.fault(entry.frame_link.span(), key, "none", expected);
            return None;
        };
        let side_m = *given.get_ref();
        self.check(CUP_SIDE_M.contains(&side_m), given.span(), key, side_m, &expected)?;
        Some(side_m)
    }
}
