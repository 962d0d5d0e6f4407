//! The shape of a pad for engines that know contacts in points only: solids whose few points hold together what a face
//! under even pressure holds.

use nalgebra::{Isometry3, Point3};

use super::bodies::ArmBodies;
use crate::{
    model::{frames::Pose, plan::PlacedObject},
    robot::{Arm, Pad},
};

/// Depth of the solids behind a pad's face, m: nothing reaches their back.
const DEPTH_M: f64 = 0.004;

/// The part of an evenly pressed pad's force that the point at its centre carries; the corners of the core carry the
/// rest. By the theory of five points, force and torsion together then stay within 4 % of what a uniform patch of
/// 40.4 x 36.0 mm holds, in every direction: with 0 they fall short by 9 %, with 0.2 they exceed it by 6 %.
const CENTRE_SHARE: f64 = 0.17;

/// How far the whole face lies behind the core's corners, as a multiple of what they sink in. A uniform elastic face
/// turns as hard about its centre, however it tilts, as long as it touches all over, and so does the core alone. With 3
/// the face's edge comes to bear once the core tilts on two of its corners, at half of the tilt that the pad holds; with
/// 2, earlier, and then it adds to the torsion of pads that are pressed unevenly.
const FACE_RECESS: f64 = 3.0;

/// Mean distance of a rectangle's points from its centre, m: `(1/A) integral of r dA` for half sides a and b,
/// `(d + a^2/(2b) ln((b+d)/a) + b^2/(2a) ln((a+d)/b)) / 3` with `d` the half diagonal (METHOD section 6).
fn mean_radius_m([a, b]: [f64; 2]) -> f64 {
    let d = a.hypot(b);
    (d + a * a / (2.0 * b) * ((b + d) / a).ln() + b * b / (2.0 * a) * ((a + d) / b).ln()) / 3.0
}

/// A hand, and where it holds.
pub(super) struct GraspingHand<'a> {
    /// The arm that it ends.
    pub arm: &'a Arm,
    /// What of it moves.
    pub bodies: &'a ArmBodies,
    /// G in O.
    pub x_og: Pose,
}

/// What presses a pad on a board, and what gives way there.
#[derive(Clone, Copy)]
pub(super) struct PadLoading {
    /// The grip force, N.
    force_n: f64,
    /// Mass of a finger with its drive, kg.
    finger_kg: f64,
    /// Mass of the board, kg.
    board_kg: f64,
    /// Sides of the board, m.
    board_m: [f64; 3],
    /// The frame with the axes of G at the centre between the pads, in O.
    x_oc: Pose,
    /// `1 / omega^2` of the contacts, s^2.
    softness_s2: f64,
}

impl PadLoading {
    /// Pads of a robot's hand on a board, by contacts of the softness `1 / omega^2`.
    pub fn new(hand: &GraspingHand<'_>, object: &PlacedObject, force_n: f64, softness_s2: f64) -> Self {
        let GraspingHand { arm, bodies, x_og } = hand;
        let finger = &bodies.bodies[bodies.body_of_joint[arm.joints.len()]];
        Self {
            force_n,
            // The drive has the inertia of the board: see the gripper.
            finger_kg: finger.mass.mass_kg + object.mass_kg,
            board_kg: object.mass_kg,
            board_m: object.size_m,
            x_oc: *x_og * Isometry3::from(arm.gripper.grasp_point_g()),
            softness_s2,
        }
    }

    /// How far a contact at `[x, z]` from the centre along x_G and z_G gives way under a force, m/N:
    /// `1 / (m omega^2)`, with `1/m = 1/m_finger + 1/m_board + y^2/I_x + x^2/I_y` the inverse of the mass that two
    /// bodies oppose to a push along the board's normal. The palm behind the finger gives way by little.
    fn compliance_m_n(&self, [x, z]: [f64; 2]) -> f64 {
        let p_o = self.x_oc * Point3::new(x, 0.0, z);
        let [size_x, size_y, size_z] = self.board_m.map(|side| side * side);
        let turning = 12.0 * (p_o.y * p_o.y / (size_y + size_z) + p_o.x * p_o.x / (size_x + size_z));
        self.softness_s2 * (1.0 / self.finger_kg + (1.0 + turning) / self.board_kg)
    }

    /// How far the corners of a core with these half sides sink in, and a ball at the centre that carries its share, m.
    fn penetrations_m(&self, [x, z]: [f64; 2]) -> [f64; 2] {
        let corners = [[x, z], [x, -z], [-x, z], [-x, -z]];
        let corner_m_n = corners.iter().map(|corner| self.compliance_m_n(*corner)).sum::<f64>() / 4.0;
        let corner_n = (1.0 - CENTRE_SHARE) / 4.0 * self.force_n;
        [corner_n * corner_m_n, CENTRE_SHARE * self.force_n * self.compliance_m_n([0.0; 2])]
    }
}

/// A solid of a pad.
#[derive(Clone, Copy)]
pub(super) enum Solid {
    /// Half sides along the axes of P.
    Box {
        /// m.
        half_m: [f64; 3],
    },
    /// A ball.
    Ball {
        /// m.
        radius_m: f64,
    },
}

/// A part of a pad.
#[derive(Clone, Copy)]
pub(super) struct PadPart {
    /// What it is called.
    pub name: &'static str,
    /// Its shape.
    pub solid: Solid,
    /// Pose of its centre in P.
    pub x_pc: Pose,
}

/// The parts of a pad: the core, the ball at its centre, and the whole face.
///
/// Engines hold two flat boxes together in four corners. The corners of the core, with the ball between them, turn
/// exactly as hard as an evenly pressed face when the mean distance from the centre, each point counted by its share of
/// the force, is the face's: `(1 - share) r = e`. Four corners alone would give too little when the pad turns about one
/// of them. The whole face, recessed, comes to bear where the pad tilts.
pub(super) fn pad_parts(pad: &Pad, loading: &PadLoading) -> [PadPart; 3] {
    let half_m = pad.size_m.map(|side| side / 2.0);
    let corner_m = mean_radius_m(half_m) / (1.0 - CENTRE_SHARE);
    let core_m = half_m.map(|half| half * corner_m / half_m[0].hypot(half_m[1]));
    let [core_penetration_m, ball_penetration_m] = loading.penetrations_m(core_m);
    let part = |name, solid, recess_m: f64| PadPart {
        name,
        solid,
        x_pc: Isometry3::translation(0.0, 0.0, -recess_m - DEPTH_M / 2.0),
    };
    let flat = |[x, y]: [f64; 2]| Solid::Box { half_m: [x, y, DEPTH_M / 2.0] };
    [
        part("core", flat(core_m), 0.0),
        part("ball", Solid::Ball { radius_m: DEPTH_M / 2.0 }, core_penetration_m - ball_penetration_m),
        part("face", flat(half_m), FACE_RECESS * core_penetration_m),
    ]
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    #[test]
    fn the_mean_radius_is_that_of_the_rectangle() {
        // 14.63 mm for the pad of 40.4 x 36.0 mm (METHOD section 6), given to four digits.
        assert!((mean_radius_m([0.0202, 0.018]) - 0.01463).abs() < 5e-6);
    }

    #[test]
    fn a_contact_gives_way_as_the_masses_that_meet_there() {
        let at = |x: f64| PadLoading {
            force_n: 30.0,
            finger_kg: 0.2,
            board_kg: 0.2,
            board_m: [0.5, 0.4, 0.03],
            x_oc: Isometry3::from(Vector3::new(x, 0.0, 0.0)),
            softness_s2: 1e-8,
        };
        // Two bodies of 0.2 kg, pushed through their centres: 1e-8 * (5 + 5).
        assert!((at(0.0).compliance_m_n([0.0; 2]) - 1e-7).abs() < 1e-20);
        // 0.23 m aside the board turns too: I_y = 0.2 (0.25 + 0.0009) / 12.
        let turning = 1e-8 * 0.23 * 0.23 / (0.2 * 0.2509 / 12.0);
        assert!((at(0.23).compliance_m_n([0.0; 2]) - (1e-7 + turning)).abs() < 1e-20);
        // x_G of a hand that looks along x_O is in the plane of the board.
        assert!(at(0.23).compliance_m_n([0.01, 0.0]) > at(0.23).compliance_m_n([-0.01, 0.0]));
    }
}
