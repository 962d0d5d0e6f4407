//! The shape of a pad for engines with point contacts: solids whose contact points together have the load capacity of a
//! face under uniform pressure (docs/method.md#72-grippers-and-pads).

use nalgebra::{Isometry3, Matrix2, Point3, Vector2};

use super::{
    bodies::ArmBodies,
    world::{drive_inertia_kg, inertial_mass_kg},
};
use crate::{
    model::{frames::Pose, plan::PlacedObject},
    robot::{Arm, Pad},
};

/// Depth of the solids behind a pad's face, m; nothing penetrates that far.
const DEPTH_M: f64 = 0.004;

/// Share of the normal force at the central contact of a uniformly pressed pad; the corners of the core carry the rest.
/// In theory the five contacts then resist force and torsion together within 4 % of a uniform patch of 40.4 x 36.0 mm
/// in every direction; with 0 up to 9 % less, with 0.2 up to 6 % more.
const CENTRE_SHARE: f64 = 0.17;

/// Recess of the whole face behind the core's corners, as a multiple of their penetration. A uniform elastic face has
/// the same torsional resistance at any tilt as long as all of it is in contact; so has the core alone. With 3 the
/// face's edge makes contact once the core tilts on two of its corners, at half of the tilting moment that the pad
/// holds; with 2 it does so earlier and adds to the torsion of unevenly pressed pads.
const FACE_RECESS: f64 = 3.0;

/// Mean distance of a rectangle's points from its centre, m: `(1/A) integral of r dA` for half sides a and b, `(d +
/// a^2/(2b) ln((b+d)/a) + b^2/(2a) ln((a+d)/b)) / 3` with `d` the half diagonal (docs/method.md#62-pad-limits).
fn mean_radius_m([a, b]: [f64; 2]) -> f64 {
    let d = a.hypot(b);
    (d + a * a / (2.0 * b) * ((b + d) / a).ln() + b * b / (2.0 * a) * ((a + d) / b).ln()) / 3.0
}

/// A hand and its grasp.
pub(super) struct GraspingHand<'a> {
    /// Its arm.
    pub arm: &'a Arm,
    /// The arm's moving bodies.
    pub bodies: &'a ArmBodies,
    /// X_OG.
    pub x_og: Pose,
}

/// The load on a pad and the compliance of its contacts with the board.
#[derive(Clone, Copy)]
pub(super) struct PadLoading {
    /// The grip force, N.
    force_n: f64,
    /// Mass of a finger with its drive, kg.
    finger_kg: f64,
    /// Inertia of the board as a mass, kg.
    board_kg: f64,
    board: BoardTurning,
    /// X_OC, C with the axes of G at the centre between the pads.
    x_oc: Pose,
    /// Softness `1 / omega^2` of the contacts, s^2.
    softness_s2: f64,
}

impl PadLoading {
    /// Pads of a robot's hand on a board, with contacts of the softness `1 / omega^2`.
    pub fn new(hand: &GraspingHand<'_>, object: &PlacedObject, force_n: f64, softness_s2: f64) -> Self {
        let GraspingHand { arm, bodies, x_og } = hand;
        let finger = &bodies.bodies[bodies.body_of_joint[arm.joints.len()]];
        Self {
            force_n,
            finger_kg: finger.mass.mass_kg + drive_inertia_kg(object),
            board_kg: inertial_mass_kg(object),
            board: BoardTurning::of(object),
            x_oc: *x_og * Isometry3::from(arm.gripper.grasp_point_g()),
            softness_s2,
        }
    }

    /// Compliance of a contact at `[x, z]` from the centre along x_G and z_G, m/N: `1 / (m omega^2)`, with `1/m =
    /// 1/m_finger + 1/m_board + (r x z) I^-1 (r x z)` the inverse effective mass of the two bodies along the board's
    /// normal, `r` from its centre of mass. The palm's motion is neglected.
    fn compliance_m_n(&self, [x, z]: [f64; 2]) -> f64 {
        let p_o = self.x_oc * Point3::new(x, 0.0, z);
        let turning = self.board.turning(&p_o);
        self.softness_s2 * (1.0 / self.finger_kg + (1.0 + turning) / self.board_kg)
    }

    /// Mean compliance of the contacts at the corners of a box with these half sides, m/N.
    fn corner_compliance_m_n(&self, [x, z]: [f64; 2]) -> f64 {
        let corners = [[x, z], [x, -z], [-x, z], [-x, -z]];
        corners.iter().map(|corner| self.compliance_m_n(*corner)).sum::<f64>() / 4.0
    }
}

/// How a board turns if a force along z_O acts beside its centre of mass.
#[derive(Clone, Copy)]
enum BoardTurning {
    /// A box about its centre, with these sides, m.
    Box([f64; 3]),
    /// Any other board.
    Plate {
        /// Its centre of mass along x_O and y_O, m.
        com_m: Vector2<f64>,
        /// The inverse of its inertia about x_O and y_O for a mass of 1 kg, 1/m^2.
        inverse_per_m2: Matrix2<f64>,
    },
}

impl BoardTurning {
    fn of(object: &PlacedObject) -> Self {
        if object.is_uniform_box() {
            return Self::Box(object.size_m);
        }
        let inertia_m2 = object.shape().inertia_o(1.0).fixed_view::<2, 2>(0, 0).into_owned();
        // The inertia of a board with a thickness is positive definite.
        let inverse_per_m2 = inertia_m2.try_inverse().unwrap_or_else(Matrix2::zeros);
        Self::Plate { com_m: object.com_o().xy(), inverse_per_m2 }
    }

    /// `m (r x z) I^-1 (r x z)` of a point in O: how many times the board's inverse mass its turning adds.
    fn turning(&self, p_o: &Point3<f64>) -> f64 {
        match self {
            Self::Box(sides_m) => {
                let [size_x, size_y, size_z] = sides_m.map(|side| side * side);
                12.0 * (p_o.y * p_o.y / (size_y + size_z) + p_o.x * p_o.x / (size_x + size_z))
            }
            Self::Plate { com_m, inverse_per_m2 } => {
                let r_m = p_o.coords.xy() - com_m;
                let lever_m = Vector2::new(r_m.y, -r_m.x);
                lever_m.dot(&(inverse_per_m2 * lever_m))
            }
        }
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
    /// Its name.
    pub name: &'static str,
    /// Its shape.
    pub solid: Solid,
    /// Pose of its centre in P.
    pub x_pc: Pose,
    /// Mean compliance of its contacts with the board, m/N.
    pub compliance_m_n: f64,
}

/// The parts of a pad: the core, the ball at its centre, and the whole face.
///
/// Engines connect two flat boxes at four corner contacts. The corners of the core and the ball between them have the
/// torsional resistance of a uniformly pressed face if their mean distance from the centre, weighted by their share of
/// the force, is the face's: `(1 - share) r = e`. Four corners alone resist too little if the pad turns about one of
/// them. The recessed face makes contact if the pad tilts.
pub(super) fn pad_parts(pad: &Pad, loading: &PadLoading) -> [PadPart; 3] {
    let half_m = pad.size_m.map(|side| side / 2.0);
    let corner_m = mean_radius_m(half_m) / (1.0 - CENTRE_SHARE);
    let core_m = half_m.map(|half| half * corner_m / half_m[0].hypot(half_m[1]));
    let [core_m_n, ball_m_n, face_m_n] = [
        loading.corner_compliance_m_n(core_m),
        loading.compliance_m_n([0.0; 2]),
        loading.corner_compliance_m_n(half_m),
    ];
    // Penetration of the corners of the core, and of the ball at the centre under its share.
    let core_penetration_m = (1.0 - CENTRE_SHARE) / 4.0 * loading.force_n * core_m_n;
    let ball_penetration_m = CENTRE_SHARE * loading.force_n * ball_m_n;
    let part = |name, solid, recess_m: f64, compliance_m_n| PadPart {
        name,
        solid,
        x_pc: Isometry3::translation(0.0, 0.0, -recess_m - DEPTH_M / 2.0),
        compliance_m_n,
    };
    let flat = |[x, y]: [f64; 2]| Solid::Box { half_m: [x, y, DEPTH_M / 2.0] };
    [
        part("core", flat(core_m), 0.0, core_m_n),
        part("ball", Solid::Ball { radius_m: DEPTH_M / 2.0 }, core_penetration_m - ball_penetration_m, ball_m_n),
        part("face", flat(half_m), FACE_RECESS * core_penetration_m, face_m_n),
    ]
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::model::plate::PlateRecord;

    #[test]
    fn the_mean_radius_is_that_of_the_rectangle() {
        // 14.63 mm for the pad of 40.4 x 36.0 mm (docs/method.md#62-pad-limits), to four digits.
        assert!((mean_radius_m([0.0202, 0.018]) - 0.01463).abs() < 5e-6);
    }

    #[test]
    fn a_rectangle_as_an_outline_turns_as_the_box_does() {
        let cuboid = PlacedObject::cuboid([0.5, 0.4, 0.03], 0.8, Pose::identity());
        let outline_m = cuboid.shape().outline_m();
        let plate = Some(PlateRecord { outline_m, holes_m: Vec::new() }.into());
        let of_plate = BoardTurning::of(&PlacedObject { plate, ..cuboid.clone() });
        let of_box = BoardTurning::of(&cuboid);
        for (x, y) in [(0.2, 0.0), (0.0, 0.15), (0.2, -0.1), (-0.05, 0.19)] {
            let p_o = Point3::new(x, y, 0.015);
            // Rounding of the moments and of their inverse.
            assert!((of_plate.turning(&p_o) / of_box.turning(&p_o) - 1.0).abs() < 1e-12);
        }
        let shifted = BoardTurning::of(&PlacedObject { com_m: Some([0.1, 0.0, 0.0]), ..cuboid });
        let [at, from_com] = [0.3, 0.2].map(|x| Point3::new(x, 0.0, 0.0));
        assert!((shifted.turning(&at) / of_box.turning(&from_com) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_compliance_of_a_contact_is_that_of_the_effective_mass() {
        let at = |x: f64| PadLoading {
            force_n: 30.0,
            finger_kg: 0.2,
            board_kg: 0.2,
            board: BoardTurning::Box([0.5, 0.4, 0.03]),
            x_oc: Isometry3::from(Vector3::new(x, 0.0, 0.0)),
            softness_s2: 1e-8,
        };
        // Two bodies of 0.2 kg, pushed through their centres: 1e-8 * (5 + 5).
        assert!((at(0.0).compliance_m_n([0.0; 2]) - 1e-7).abs() < 1e-20);
        // 0.23 m off the centre the board turns too: I_y = 0.2 (0.25 + 0.0009) / 12.
        let turning = 1e-8 * 0.23 * 0.23 / (0.2 * 0.2509 / 12.0);
        assert!((at(0.23).compliance_m_n([0.0; 2]) - (1e-7 + turning)).abs() < 1e-20);
        // The hand's x_G is in the plane of the board.
        assert!(at(0.23).compliance_m_n([0.01, 0.0]) > at(0.23).compliance_m_n([-0.01, 0.0]));
    }
}
