//! Grippers: frame, pads, fingers, opening.

use nalgebra::{Isometry3, Rotation3, UnitQuaternion, Vector3};
use toml::Spanned;

use super::{Assembler, solid::Solid};
use crate::{
    model::frames::Pose,
    robot::{
        description::{Exactly, FingerEntry, GripperEntry, GripperKind},
        geometry::Shape,
        holding::Holding,
        tree::{Face, Finger, Gripper, Joint, JointKind, Linkage, Pad},
    },
};

/// Maximum sine of the angle between a finger's axis and y_G: the rounding of quarter turns with six digits.
const AXIS_TOLERANCE: f64 = 1e-5;

/// Tolerance of a gripper's opening relative to the finger joints' limits, m: published gaps are rounded to 0.1 mm.
const OPENING_TOLERANCE_M: f64 = 1e-4;

/// Thickness, m, and mass, kg, of a jaw of a clamp: a steel plate of the size of a hand's pad.
const JAW_THICKNESS_M: f64 = 0.010;
const JAW_MASS_KG: f64 = 0.1;
const JAW_RGBA: [f64; 4] = [0.35, 0.35, 0.4, 1.0];

/// The values of a gripper that do not depend on its fingers.
struct Hand {
    frame_link: usize,
    palm_link: usize,
    /// Poses of all links with every joint at rest.
    x_wl: Vec<Pose>,
    opening_m: [f64; 2],
    pad_size_m: [f64; 2],
    pad_centre_m: [f64; 2],
    holding: Holding,
}

/// Where the face of a sliding finger is.
struct SlidingFace {
    /// Side of the plane y_G = 0, 1 or -1.
    side: f64,
    /// 1 if the joint's position increases as the finger opens, else -1.
    opening_sign: f64,
    /// The joint's position when closed, m.
    closed_m: f64,
    /// Distance of the face from the plane y_G = 0 when closed, m.
    offset_m: f64,
}

impl Hand {
    fn pad(&self, name: &str, link: usize, offset_m: f64) -> Pad {
        Pad { name: name.into(), link, size_m: self.pad_size_m, centre_m: self.pad_centre_m, offset_m }
    }

    /// Where the pads are, along x and z of G, m.
    fn rectangle(&self) -> [[f64; 2]; 2] {
        [0, 1].map(|axis| {
            let (centre_m, half_m) = (self.pad_centre_m[axis], self.pad_size_m[axis] / 2.0);
            [centre_m - half_m, centre_m + half_m]
        })
    }

    fn gripper(&self, fingers: [Finger; 2], linkage: Option<Linkage>) -> Gripper {
        Gripper {
            frame_link: self.frame_link,
            palm_link: self.palm_link,
            fingers: fingers.into(),
            cup: None,
            opening_m: self.opening_m,
            holding: self.holding.clone(),
            linkage,
        }
    }
}

impl Assembler<'_> {
    /// The gripper of an arm.
    pub(super) fn gripper(&mut self, arm: &str, entry: &GripperEntry) -> Option<Gripper> {
        self.carriers = self.robot.carriers();
        let given_frame = self.link("frame_link", &entry.frame_link);
        let palm = entry.palm_link.as_ref().map_or(Some(given_frame), |name| self.link("palm_link", name).map(Some));
        let holding = self.holding(entry);
        let jaw = match entry.kind {
            GripperKind::Suction => None,
            GripperKind::Fingers | GripperKind::Clamp => self.jaw(entry),
        };
        let (given_frame, palm_link) = (given_frame?, palm??);
        if self.carriers[palm_link] != self.carriers[given_frame] {
            let (key, at) = entry.palm_link.as_ref().map(|palm| (palm.get_ref().clone(), palm.span()))?;
            let expected = format!("a link fixed to {}", entry.frame_link.get_ref());
            self.fault(at, "palm_link", key, expected);
            return None;
        }
        let frame_link = self.gripper_frame(arm, given_frame, entry)?;
        if entry.kind == GripperKind::Suction {
            return self.suction(arm, entry, [frame_link, palm_link], holding);
        }
        let (opening_m, pad_size_m, pad_centre_m) = jaw?;
        let hand = Hand {
            frame_link,
            palm_link,
            x_wl: self.robot.link_poses(&self.robot.positions(&[])),
            opening_m,
            pad_size_m,
            pad_centre_m,
            holding: holding?,
        };
        if entry.kind == GripperKind::Clamp {
            return self.clamp(arm, &hand, entry);
        }
        let Some(fingers) = &entry.fingers else {
            self.fault(entry.frame_link.span(), "fingers", "none", "two fingers, or kind = \"clamp\" or \"suction\"");
            return None;
        };
        match fingers.get_ref().0.each_ref().map(|finger| finger.joint.as_ref()) {
            [Some(first), Some(second)] => self.prismatic_fingers(&hand, entry, fingers, [first, second]),
            _ => self.linkage(&hand, entry, fingers),
        }
    }

    /// Opening, and size and centre of the pads, of two jaws.
    fn jaw(&mut self, entry: &GripperEntry) -> Option<([f64; 2], [f64; 2], [f64; 2])> {
        for (key, given) in [("cup_diameter_m", &entry.cup_diameter_m), ("cup_height_m", &entry.cup_height_m)] {
            if let Some(given) = given {
                self.fault(given.span(), key, given.get_ref(), "no such key: it belongs to kind = \"suction\"");
            }
        }
        let keys = [
            ("opening_m", &entry.opening_m, "the gaps between the pads when closed and when open, m"),
            ("pad_size_m", &entry.pad_size_m, "the sides of a pad along x and z of G, m"),
            ("pad_centre_m", &entry.pad_centre_m, "the centre of a pad along x and z of G, m"),
        ];
        let found = keys.map(|(key, given, expected)| {
            if given.is_none() {
                self.fault(entry.frame_link.span(), key, "none", expected);
            }
            given.as_ref()
        });
        let [opening, size, centre] = found;
        if let Some(size) = size {
            self.positive("pad_size_m", size, &size.get_ref().0);
        }
        let centre_m = centre.and_then(|centre| self.finite("pad_centre_m", centre, "m"));
        Some((opening?.get_ref().0, size?.get_ref().0, centre_m?))
    }

    /// The link whose frame is G: that of the description, or a new one at a pose in it.
    fn gripper_frame(&mut self, arm: &str, link: usize, entry: &GripperEntry) -> Option<usize> {
        if entry.frame_xyz_m.is_none() && entry.frame_rpy_deg.is_none() {
            return Some(link);
        }
        let keys = ["frame_xyz_m", "frame_rpy_deg"];
        let x_lg = self.pose_of(keys, entry.frame_xyz_m.as_ref(), entry.frame_rpy_deg.as_ref())?;
        let x_lg = Isometry3::from_parts(x_lg.translation, squared(&x_lg));
        let frame = self.robot.add_frame(&format!("{arm}_gripper_frame"), link, x_lg);
        self.effort.push(0.0);
        self.carriers = self.robot.carriers();
        Some(frame)
    }

    /// Adds a jaw: a link that slides along y of its frame between limits, m.
    fn add_jaw(&mut self, name: &str, parent_link: usize, x_pj: Pose, limits_m: [f64; 2]) -> usize {
        let link = self.robot.add_frame(name, parent_link, x_pj);
        self.effort.push(0.0);
        let joint = self.robot.joints.len() - 1;
        let of_jaw = &mut self.robot.joints[joint];
        (of_jaw.kind, of_jaw.axis_j) = (JointKind::Prismatic, Vector3::y_axis());
        [of_jaw.lower, of_jaw.upper] = limits_m;
        of_jaw.rest = of_jaw.lower;
        link
    }

    /// A clamp: two jaws of the size of the pads that slide along y_G.
    fn clamp(&mut self, arm: &str, hand: &Hand, entry: &GripperEntry) -> Option<Gripper> {
        let [narrow_m, wide_m] = hand.opening_m;
        let met = narrow_m.is_finite() && wide_m.is_finite() && 0.0 <= narrow_m && narrow_m < wide_m;
        let found = format!("{narrow_m} to {wide_m}");
        self.check(met, opening_span(entry), "opening_m", found, "two gaps from 0 m, the narrower first")?;
        if let Some(fingers) = &entry.fingers {
            self.fault(fingers.span(), "fingers", "fingers of a clamp", "no such key: a clamp has jaws of its own");
            return None;
        }
        let [x_m, z_m] = hand.pad_centre_m;
        let half_m = [hand.pad_size_m[0] / 2.0, JAW_THICKNESS_M / 2.0, hand.pad_size_m[1] / 2.0];
        let x_palm_g = hand.x_wl[hand.palm_link].inverse() * self.frame_pose(hand);
        let fingers = [("upper", 1.0), ("lower", -1.0)].map(|(name, side)| {
            let turn = UnitQuaternion::from_axis_angle(
                &Vector3::z_axis(),
                if side > 0.0 { 0.0 } else { std::f64::consts::PI },
            );
            let x_gj = Isometry3::from_parts(Vector3::zeros().into(), turn);
            let limits_m = [narrow_m / 2.0, wide_m / 2.0];
            let link = self.add_jaw(&format!("{arm}_{name}_jaw"), hand.palm_link, x_palm_g * x_gj, limits_m);
            // In the frame of a jaw that is turned about z_G, x_G is -x.
            let centre = Vector3::new(side * x_m, JAW_THICKNESS_M / 2.0, z_m);
            let sides = half_m.map(|half| 2.0 * half);
            let of = |a: f64, b: f64| JAW_MASS_KG * (a * a + b * b) / 12.0;
            let inertia = [of(sides[1], sides[2]), of(sides[0], sides[2]), of(sides[0], sides[1])];
            let solid = Solid { shape: Shape::Box { half_m }, mass_kg: JAW_MASS_KG, inertia, rgba: JAW_RGBA };
            solid.add_to(&mut self.robot.links[link], centre);
            let joint = self.robot.links[link].parent_joint.unwrap_or_default();
            Finger {
                joint,
                closed_m: limits_m[0],
                opening_sign: 1.0,
                max_travel_m: limits_m[1] - limits_m[0],
                pad: hand.pad(name, link, limits_m[0]),
            }
        });
        Some(hand.gripper(fingers, None))
    }

    fn frame_pose(&self, hand: &Hand) -> Pose {
        self.robot.link_poses(&self.robot.positions(&[]))[hand.frame_link]
    }

    /// Two fingers on prismatic joints of their own.
    fn prismatic_fingers(
        &mut self,
        hand: &Hand,
        entry: &GripperEntry,
        fingers: &Spanned<Exactly<FingerEntry, 2>>,
        joints: [&Spanned<String>; 2],
    ) -> Option<Gripper> {
        let [first, second] = &fingers.get_ref().0;
        let first = self.finger(hand, first, joints[0]);
        let second = self.finger(hand, second, joints[1]);
        let ((first, first_side), (second, second_side)) = (first?, second?);
        if first_side == second_side {
            self.fault(fingers.span(), "fingers", "both on one side of y_G = 0", "one on either side");
            return None;
        }
        let fingers = if first_side > 0.0 { [first, second] } else { [second, first] };
        for finger in &fingers {
            // The gripper couples its fingers.
            self.robot.joints[finger.joint].mimic = None;
        }
        let closed: f64 = fingers.iter().map(|finger| finger.pad.offset_m).sum();
        let travel: f64 = fingers.iter().map(|finger| finger.max_travel_m).sum();
        self.check_opening(entry, [closed.max(0.0), closed + travel])?;
        Some(hand.gripper(fingers, None))
    }

    /// Fingers that a linkage moves.
    fn linkage(
        &mut self,
        hand: &Hand,
        entry: &GripperEntry,
        fingers: &Spanned<Exactly<FingerEntry, 2>>,
    ) -> Option<Gripper> {
        let [first, second] = &fingers.get_ref().0;
        let (first_links, second_links) = (self.pad_links(first), self.pad_links(second));
        let pads = [first_links?, second_links?];
        let pad_links = [pads[0][0], pads[1][0]];
        let linkage = Linkage::new(&self.robot, [hand.frame_link, hand.palm_link], pads, Some(hand.rectangle()))
            .and_then(|linkage| linkage.range_m(&self.robot, hand.frame_link).map(|range_m| (linkage, range_m)));
        let (linkage, range_m) = match linkage {
            Ok(found) => found,
            Err(problem) => {
                self.problem(fingers.span(), format!("fingers: {problem}"));
                return None;
            }
        };
        self.check_opening(entry, range_m)?;
        // Joint and travel follow from a gap, see `Robot::at_gap`.
        let finger = |entry: &FingerEntry, link: usize| Finger {
            joint: self.carriers[link].unwrap_or_default(),
            closed_m: 0.0,
            opening_sign: 1.0,
            max_travel_m: 0.0,
            pad: hand.pad(&entry.name, link, 0.0),
        };
        let fingers = [finger(first, pad_links[0]), finger(second, pad_links[1])];
        Some(hand.gripper(fingers, Some(linkage)))
    }

    /// The links of a linkage's pad.
    fn pad_links(&mut self, entry: &FingerEntry) -> Option<Vec<usize>> {
        let named = std::iter::once(self.link("pad_link", &entry.pad_link));
        let others: Vec<_> = entry.beside.iter().map(|name| self.link("beside", name)).collect();
        named.chain(others).collect()
    }

    /// Checks the opening against the gaps that the joints allow.
    fn check_opening(&mut self, entry: &GripperEntry, possible_m: [f64; 2]) -> Option<()> {
        let [narrow, wide] = entry.opening_m.as_ref()?.get_ref().0;
        let within = narrow >= possible_m[0] - OPENING_TOLERANCE_M && wide <= possible_m[1] + OPENING_TOLERANCE_M;
        let expected =
            format!("two gaps within {:.4} to {:.4}, which the finger joints allow", possible_m[0], possible_m[1]);
        self.check(narrow < wide && within, opening_span(entry), "opening_m", format!("{narrow} to {wide}"), &expected)
    }

    /// A finger on a prismatic joint, and the side of the plane y_G = 0 of its pad, 1 or -1.
    fn finger(&mut self, hand: &Hand, finger: &FingerEntry, name: &Spanned<String>) -> Option<(Finger, f64)> {
        let found = self.moving_joint("joint", name);
        let link = self.link("pad_link", &finger.pad_link);
        let (joint_index, link) = (found?, link?);
        let joint = self.robot.joints[joint_index].clone();
        if joint.kind != JointKind::Prismatic {
            let expected = "a prismatic joint; leave `joint` out of both fingers of a linkage";
            self.fault(name.span(), "joint", format!("{}, a revolute joint", joint.name), expected);
            return None;
        }
        if joint.parent_link != hand.palm_link {
            let palm = &self.robot.links[hand.palm_link].name;
            let expected = format!("a joint that hangs on the palm_link {palm}");
            self.fault(name.span(), "joint", &joint.name, expected);
            return None;
        }
        if let Some(other) = finger.beside.first() {
            self.fault(
                other.span(),
                "beside",
                other.get_ref(),
                "no such key: one joint carries all of a sliding finger",
            );
            return None;
        }
        if self.carriers[link] != Some(joint_index) || self.robot.links[link].shapes.is_empty() {
            let expected = format!("a link with collision geometry that {} moves", joint.name);
            self.fault(finger.pad_link.span(), "pad_link", finger.pad_link.get_ref(), expected);
            return None;
        }
        let x_gw = hand.x_wl[hand.frame_link].inverse();
        let axis_g = (x_gw * hand.x_wl[hand.palm_link] * joint.x_pj) * joint.axis_j;
        if axis_g.xz().norm() > AXIS_TOLERANCE {
            let found = format!(
                "{} along ({:.4}, {:.4}, {:.4}) of the gripper's frame",
                joint.name, axis_g.x, axis_g.y, axis_g.z
            );
            let expected = "an axis along its y; frame_rpy_deg turns the frame of frame_link";
            self.fault(name.span(), "joint", found, expected);
            return None;
        }
        let SlidingFace { side, opening_sign, closed_m, offset_m } =
            self.sliding_face(hand, link, &joint, axis_g.y.signum());
        let pad =
            Pad { name: finger.name.clone(), link, size_m: hand.pad_size_m, centre_m: hand.pad_centre_m, offset_m };
        let max_travel_m = joint.upper - joint.lower;
        Some((Finger { joint: joint_index, closed_m, opening_sign, max_travel_m, pad }, side))
    }

    /// The face of a finger whose joint moves it along y_G, in the sense of `along_y`, 1 or -1.
    fn sliding_face(&self, hand: &Hand, link: usize, joint: &Joint, along_y: f64) -> SlidingFace {
        let x_gw = hand.x_wl[hand.frame_link].inverse();
        // `x_wl` has the finger at rest; its side is determined half open.
        let here = joint.rest;
        let middle = (joint.lower + joint.upper) / 2.0 - here;
        let of_link = Face::of_links(&self.robot, &[link]);
        let side = (of_link.mean_y(&self.robot, &hand.x_wl, &x_gw) + along_y * middle).signum();
        let face = of_link.across(&self.robot, &hand.x_wl, &x_gw, &hand.rectangle());
        let opening_sign = side * along_y;
        let closed_m = if opening_sign > 0.0 { joint.lower } else { joint.upper };
        let nearest_m = face.nearest_m(&self.robot, &hand.x_wl, &x_gw, side);
        let offset_m = nearest_m + opening_sign * (closed_m - here);
        SlidingFace { side, opening_sign, closed_m, offset_m }
    }
}

/// Where the opening of two jaws is in the file.
fn opening_span(entry: &GripperEntry) -> std::ops::Range<usize> {
    entry.opening_m.as_ref().map_or_else(|| entry.frame_link.span(), Spanned::span)
}

/// The rotation of a pose; angles in degrees that are quarter turns give exact axes.
fn squared(pose: &Pose) -> UnitQuaternion<f64> {
    let matrix = pose.rotation.to_rotation_matrix();
    let rounded = matrix.matrix().map(f64::round);
    let is_square = (matrix.matrix() - rounded).amax() < AXIS_TOLERANCE * AXIS_TOLERANCE;
    // Not `UnitQuaternion::from_matrix`: its search for the nearest rotation begins at none and does not leave half turns.
    if is_square {
        UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rounded))
    } else {
        pose.rotation
    }
}
