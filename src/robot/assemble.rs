//! Combines a description with its URDF and checks every entry against the tree.

use std::ops::{Range, RangeInclusive};

use nalgebra::{Point3, Vector3};
use toml::Spanned;

use super::{
    description::{ArmEntry, Description, FingerEntry, GripperEntry, Source},
    tree::{Arm, BodyPoint, Finger, Gripper, JointKind, Pad, Robot, RobotError},
    urdf::Tree,
};
use crate::model::frames::Pose;

/// Placeholders for the name of an arm and for its first letter.
const PLACEHOLDERS: [&str; 2] = ["{arm}", "{a}"];

/// Maximum sine of the angle between a finger's axis and y_G: the rounding of quarter turns with six digits.
const AXIS_TOLERANCE: f64 = 1e-5;

/// Tolerance of a gripper's opening relative to the finger joints' limits, m: published gaps are rounded to 0.1 mm.
const OPENING_TOLERANCE_M: f64 = 1e-4;

/// Stiffness of a pad, N/m, from softer than a foam cushion to stiffer than a steel block of its size.
const PAD_STIFFNESS_N_M: RangeInclusive<f64> = 1e4..=1e9;

/// Combines a description with its URDF.
pub(super) fn assemble(
    name: &str,
    source: &Source,
    description: &Description,
    tree: Tree,
) -> Result<Robot, RobotError> {
    let Tree { links, joints, effort } = tree;
    let floor_z_m = *description.floor_z_m.get_ref();
    let mut robot = Robot {
        description: name.into(),
        links,
        joints,
        arms: Vec::new(),
        allowed_collisions: Vec::new(),
        body_points: Vec::new(),
        floor_z_m,
    };
    let context = Context { source, carriers: robot.carriers() };
    if !floor_z_m.is_finite() {
        return Err(context.error(&description.floor_z_m, "floor_z_m", floor_z_m, "a finite height in m"));
    }
    if description.arms.get_ref().is_empty() {
        return Err(context.error(&description.arms, "arms", "none", "at least one arm"));
    }
    for entry in description.arms.get_ref() {
        let arm = context.arm(&robot, entry, &effort)?;
        if robot.arm_index(&arm.name).is_some() {
            return Err(context.error(&entry.name, "name", &arm.name, "a name that no other arm has"));
        }
        robot.arms.push(arm);
    }
    robot.allowed_collisions = context.allowed_collisions(&robot, description)?;
    robot.body_points = context.body_points(&robot, description)?;
    Ok(robot)
}

/// The shared input of all checks.
struct Context<'a> {
    source: &'a Source<'a>,
    /// See [`Robot::carriers`].
    carriers: Vec<Option<usize>>,
}

impl Context<'_> {
    fn error<T>(
        &self,
        at: &Spanned<T>,
        key: &str,
        found: impl std::fmt::Display,
        expected: impl std::fmt::Display,
    ) -> RobotError {
        self.source.error(at.span(), &format!("{key}: found {found}, expected {expected}"))
    }

    fn link(&self, robot: &Robot, key: &str, name: &Spanned<String>) -> Result<usize, RobotError> {
        self.link_named(robot, key, name.get_ref(), name.span())
    }

    fn link_named(&self, robot: &Robot, key: &str, name: &str, span: Range<usize>) -> Result<usize, RobotError> {
        robot.link_index(name).ok_or_else(|| {
            self.source.error(span, &format!("{key}: found \"{name}\", expected the name of a link of the urdf"))
        })
    }

    fn joint(&self, robot: &Robot, key: &str, name: &Spanned<String>, kind: JointKind) -> Result<usize, RobotError> {
        let found = robot.joints.iter().position(|joint| joint.name == *name.get_ref());
        let of_kind = |&joint: &usize| robot.joints[joint].kind == kind;
        let kind_name = if kind == JointKind::Revolute { "revolute" } else { "prismatic" };
        found.filter(of_kind).ok_or_else(|| {
            let expected = format!("the name of a {kind_name} joint of the urdf");
            self.error(name, key, format!("\"{}\"", name.get_ref()), expected)
        })
    }

    fn arm(&self, robot: &Robot, entry: &ArmEntry, urdf_effort: &[f64]) -> Result<Arm, RobotError> {
        let joints = self.arm_joints(robot, entry)?;
        let effort_nm = match &entry.effort_nm {
            Some(overrides) => self.positive_list("effort_nm", overrides, joints.len())?,
            None => joints.iter().map(|&joint| urdf_effort[joint]).collect(),
        };
        if let Some(number) = effort_nm.iter().position(|effort| !(effort.is_finite() && *effort > 0.0)) {
            let found = format!(
                "an effort of {} for {} in the urdf",
                effort_nm[number],
                entry.joints.get_ref()[number].get_ref()
            );
            return Err(self.error(&entry.joints, "joints", found, "efforts above 0, or effort_nm beside the joints"));
        }
        Ok(Arm {
            name: entry.name.get_ref().clone(),
            effort_nm,
            stiffness_nm_rad: self.positive_list("stiffness_nm_rad", &entry.stiffness_nm_rad, joints.len())?,
            damping_nm_s_rad: self.positive_list("damping_nm_s_rad", &entry.damping_nm_s_rad, joints.len())?,
            gripper: self.gripper(robot, &entry.gripper)?,
            joints,
        })
    }

    /// The joints of an arm: exactly the moving joints between its base link and its gripper's frame.
    fn arm_joints(&self, robot: &Robot, entry: &ArmEntry) -> Result<Vec<usize>, RobotError> {
        let base = self.link(robot, "base_link", &entry.base_link)?;
        let mut link = self.link(robot, "frame_link", &entry.gripper.frame_link)?;
        let mut on_the_way = Vec::new();
        while link != base {
            let Some(joint) = robot.links[link].parent_joint else {
                let expected = format!("a link between the root and {}", entry.gripper.frame_link.get_ref());
                return Err(self.error(&entry.base_link, "base_link", entry.base_link.get_ref(), expected));
            };
            if robot.joints[joint].kind != JointKind::Fixed {
                on_the_way.push(joint);
            }
            link = robot.joints[joint].parent_link;
        }
        on_the_way.reverse();
        let named = entry.joints.get_ref().iter();
        let named: Vec<usize> =
            named.map(|name| self.joint(robot, "joints", name, JointKind::Revolute)).collect::<Result<_, _>>()?;
        if named != on_the_way || named.is_empty() {
            let names =
                |joints: &[usize]| joints.iter().map(|&j| robot.joints[j].name.as_str()).collect::<Vec<_>>().join(" ");
            let expected = format!("the moving joints from base_link to frame_link: {}", names(&on_the_way));
            return Err(self.error(&entry.joints, "joints", names(&named), expected));
        }
        Ok(named)
    }

    fn positive_list(&self, key: &str, list: &Spanned<Vec<f64>>, count: usize) -> Result<Vec<f64>, RobotError> {
        let numbers = list.get_ref();
        if numbers.len() != count {
            return Err(self.error(list, key, format!("{} numbers", numbers.len()), format!("{count}, one a joint")));
        }
        self.positive(key, list, numbers)?;
        Ok(numbers.clone())
    }

    fn positive<T>(&self, key: &str, at: &Spanned<T>, numbers: &[f64]) -> Result<(), RobotError> {
        match numbers.iter().find(|number| !(number.is_finite() && **number > 0.0)) {
            Some(number) => Err(self.error(at, key, number, "finite numbers above 0")),
            None => Ok(()),
        }
    }

    fn gripper(&self, robot: &Robot, entry: &GripperEntry) -> Result<Gripper, RobotError> {
        let frame_link = self.link(robot, "frame_link", &entry.frame_link)?;
        let palm_link = self.link(robot, "palm_link", &entry.palm_link)?;
        if self.carriers[palm_link] != self.carriers[frame_link] {
            let expected = format!("a link fixed to {}", entry.frame_link.get_ref());
            return Err(self.error(&entry.palm_link, "palm_link", entry.palm_link.get_ref(), expected));
        }
        self.positive("max_force_n", &entry.max_force_n, &[*entry.max_force_n.get_ref()])?;
        self.positive("pad_size_m", &entry.pad_size_m, &entry.pad_size_m.get_ref().0)?;
        if !entry.pad_centre_m.get_ref().0.iter().all(|v| v.is_finite()) {
            return Err(self.error(&entry.pad_centre_m, "pad_centre_m", "a number that is not finite", "m"));
        }
        let hand = Hand { frame_link, palm_link, entry, x_wl: robot.link_poses(&robot.positions(&[])) };
        let [first, second] = &entry.fingers.get_ref().0;
        let (first, first_side) = self.finger(robot, &hand, first)?;
        let (second, second_side) = self.finger(robot, &hand, second)?;
        if first_side == second_side {
            return Err(self.error(&entry.fingers, "fingers", "both on one side of y_G = 0", "one on either side"));
        }
        let fingers = if first_side > 0.0 { [first, second] } else { [second, first] };
        let gripper = Gripper {
            frame_link,
            palm_link,
            fingers,
            opening_m: entry.opening_m.get_ref().0,
            max_force_n: *entry.max_force_n.get_ref(),
            pad_stiffness_n_m: self.pad_stiffness(entry)?,
        };
        self.check_opening(&gripper, entry)?;
        Ok(gripper)
    }

    /// The stiffness of a pad, if the description has one.
    fn pad_stiffness(&self, entry: &GripperEntry) -> Result<Option<f64>, RobotError> {
        let Some(given) = &entry.pad_stiffness_n_m else { return Ok(None) };
        let stiffness_n_m = *given.get_ref();
        if PAD_STIFFNESS_N_M.contains(&stiffness_n_m) {
            return Ok(Some(stiffness_n_m));
        }
        Err(self.error(
            given,
            "pad_stiffness_n_m",
            stiffness_n_m,
            "10000 to 1000000000 N/m, or no such key for rigid pads",
        ))
    }

    /// Checks the opening against pads and joint limits.
    fn check_opening(&self, gripper: &Gripper, entry: &GripperEntry) -> Result<(), RobotError> {
        let closed: f64 = gripper.fingers.iter().map(|finger| finger.pad.offset_m).sum();
        let travel: f64 = gripper.fingers.iter().map(|finger| finger.max_travel_m).sum();
        let possible = [closed.max(0.0), closed + travel];
        let [narrow, wide] = gripper.opening_m;
        let within = narrow >= possible[0] - OPENING_TOLERANCE_M && wide <= possible[1] + OPENING_TOLERANCE_M;
        if narrow < wide && within {
            return Ok(());
        }
        let expected =
            format!("two gaps within {:.4} to {:.4}, which the finger joints allow", possible[0], possible[1]);
        Err(self.error(&entry.opening_m, "opening_m", format!("{narrow} to {wide}"), expected))
    }

    /// A finger, and the side of the plane y_G = 0 of its pad, 1 or -1.
    fn finger(&self, robot: &Robot, hand: &Hand, entry: &FingerEntry) -> Result<(Finger, f64), RobotError> {
        let joint_index = self.joint(robot, "joint", &entry.joint, JointKind::Prismatic)?;
        let joint = &robot.joints[joint_index];
        if joint.parent_link != hand.palm_link {
            let expected = format!("a joint that hangs on the palm_link {}", hand.entry.palm_link.get_ref());
            return Err(self.error(&entry.joint, "joint", &joint.name, expected));
        }
        let link = self.link(robot, "pad_link", &entry.pad_link)?;
        if self.carriers[link] != Some(joint_index) || robot.links[link].shapes.is_empty() {
            let expected = format!("a link with collision geometry that {} moves", joint.name);
            return Err(self.error(&entry.pad_link, "pad_link", entry.pad_link.get_ref(), expected));
        }
        let x_gl = hand.x_wl[hand.frame_link].inverse() * hand.x_wl[link];
        let axis_g = (hand.x_wl[hand.frame_link].inverse() * hand.x_wl[hand.palm_link] * joint.x_pj) * joint.axis_j;
        if axis_g.xz().norm() > AXIS_TOLERANCE {
            let found =
                format!("{} along ({:.4}, {:.4}, {:.4}) of the frame_link", joint.name, axis_g.x, axis_g.y, axis_g.z);
            return Err(self.error(&entry.joint, "joint", found, "an axis along its y"));
        }
        // `x_wl` has the finger at position 0 or the limit nearest to 0; its side is determined half open.
        let here = 0.0_f64.clamp(joint.lower, joint.upper);
        let along_y = axis_g.y.signum();
        let middle = (joint.lower + joint.upper) / 2.0 - here;
        let side = (mean_y(robot, link, &x_gl) + along_y * middle).signum();
        let opening_sign = side * along_y;
        let closed_m = if opening_sign > 0.0 { joint.lower } else { joint.upper };
        let offset_m = nearest_face(robot, link, &x_gl, side) + opening_sign * (closed_m - here);
        let pad = Pad {
            name: entry.name.clone(),
            link,
            size_m: hand.entry.pad_size_m.get_ref().0,
            centre_m: hand.entry.pad_centre_m.get_ref().0,
            offset_m,
        };
        let max_travel_m = joint.upper - joint.lower;
        Ok((Finger { joint: joint_index, closed_m, opening_sign, max_travel_m, pad }, side))
    }

    fn allowed_collisions(&self, robot: &Robot, description: &Description) -> Result<Vec<[usize; 2]>, RobotError> {
        let mut pairs = self.rigid_pairs(robot);
        for entry in &description.allowed_collisions {
            let [a, b] = &entry.get_ref().0;
            for [a, b] in expand(robot, [a, b]) {
                let a = self.link_named(robot, "allowed_collisions", &a, entry.span())?;
                let b = self.link_named(robot, "allowed_collisions", &b, entry.span())?;
                if a == b {
                    let found = &robot.links[a].name;
                    return Err(self.error(entry, "allowed_collisions", format!("{found} twice"), "two links"));
                }
                pairs.push([a.min(b), a.max(b)]);
            }
        }
        pairs.sort_unstable();
        pairs.dedup();
        Ok(pairs)
    }

    /// Pairs of links that do not move relative to each other.
    fn rigid_pairs(&self, robot: &Robot) -> Vec<[usize; 2]> {
        let solid = |link: &usize| !robot.links[*link].shapes.is_empty();
        let solid: Vec<usize> = (0..robot.links.len()).filter(solid).collect();
        let mut pairs = Vec::new();
        for (number, &a) in solid.iter().enumerate() {
            let others = solid[number + 1..].iter().filter(|&&b| self.carriers[a] == self.carriers[b]);
            pairs.extend(others.map(|&b| [a, b]));
        }
        pairs
    }

    fn body_points(&self, robot: &Robot, description: &Description) -> Result<Vec<BodyPoint>, RobotError> {
        let mut points = Vec::new();
        let entries = description.body_points.get_ref();
        if entries.is_empty() {
            let problem =
                "body_points: found none, expected at least one: the distance to the person is measured to them";
            return Err(self.source.error(description.body_points.span(), problem));
        }
        for entry in entries {
            let p_m = entry.p_m.get_ref().0;
            if !p_m.iter().all(|v| v.is_finite()) {
                return Err(self.error(&entry.p_m, "p_m", "a number that is not finite", "m"));
            }
            for [name] in expand(robot, [entry.link.get_ref()]) {
                let link = self.link_named(robot, "body_points", &name, entry.link.span())?;
                points.push(BodyPoint { link, p_l: Point3::from(p_m) });
            }
        }
        Ok(points)
    }
}

/// The shared input of both fingers of a gripper.
struct Hand<'a> {
    frame_link: usize,
    palm_link: usize,
    entry: &'a GripperEntry,
    /// Poses of all links with every joint at 0 or at the limit nearest to 0.
    x_wl: Vec<Pose>,
}

/// Names with placeholders once per arm, names without unchanged.
fn expand<const N: usize>(robot: &Robot, names: [&String; N]) -> Vec<[String; N]> {
    if !names.iter().any(|name| PLACEHOLDERS.iter().any(|placeholder| name.contains(placeholder))) {
        return vec![names.map(Clone::clone)];
    }
    let of_arm = |arm: &Arm| {
        let initial: String = arm.name.chars().take(1).collect();
        names.map(|name| name.replace(PLACEHOLDERS[0], &arm.name).replace(PLACEHOLDERS[1], &initial))
    };
    robot.arms.iter().map(of_arm).collect()
}

/// Mean y_G of the centres of a link's shapes, m.
fn mean_y(robot: &Robot, link: usize, x_gl: &Pose) -> f64 {
    let shapes = &robot.links[link].shapes;
    let sum: f64 = shapes.iter().map(|placed| (x_gl * placed.x_ls).translation.y).sum();
    sum / shapes.len() as f64
}

/// Distance of a link's innermost face from the plane y_G = 0, positive on the given side, m.
fn nearest_face(robot: &Robot, link: usize, x_gl: &Pose, side: f64) -> f64 {
    let inner = robot.links[link].shapes.iter().map(|placed| {
        let x_gs = x_gl * placed.x_ls;
        let y_s = x_gs.rotation.inverse() * Vector3::y();
        side * x_gs.translation.y - placed.shape.half_extent_m(&y_s)
    });
    inner.fold(f64::INFINITY, f64::min)
}
