//! Combines a description with its URDF and checks every entry against the tree.

mod arms;
mod gripper;
mod holding;
mod lists;
mod solid;
mod suction;

use std::{collections::BTreeMap, fmt, ops::Range, sync::Arc};

use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion};
use toml::Spanned;

use super::{
    description::{Description, Exactly},
    faults::{Collector, Source},
    tree::{JointKind, Robot, RobotOptions, SearchBox},
    urdf::Tree,
};
use crate::model::frames::Pose;

/// Combines a description with its URDF. `None` if there are faults. The options come before the description.
pub(super) fn assemble(
    name: &str,
    source: &Source<'_>,
    description: &Description,
    options: &RobotOptions,
    tree: Tree,
    faults: &mut Collector,
) -> Option<Robot> {
    let effort = tree.effort.clone();
    let robot = bare_robot(name, tree, *description.floor_z_m.get_ref(), options);
    let mut assembler = Assembler { source, robot, effort, carriers: Vec::new(), faults };
    assembler.place(description);
    assembler.pose(description, &options.posture);
    assembler.arms(description);
    assembler.allowed_collisions(description);
    assembler.body_points(description);
    let mut robot = assembler.robot;
    if !faults.is_empty() {
        return None;
    }
    weigh_links_between_joints(&mut robot);
    if robot.arms.iter().any(|arm| arm.gripper.linkage.is_some()) {
        robot.with_linkages = Some(Arc::new(robot.clone()));
        let jaws = robot.arms.iter().filter(|arm| arm.gripper.cup.is_none());
        let widest_m = jaws.map(|arm| arm.gripper.opening_m[1]).fold(0.0, f64::max);
        robot = robot.at_gap(widest_m / 2.0);
    }
    Some(robot)
}

/// Mass, kg, and radius, m, of the ball that stands for a link without mass between two joints of an arm: less than any part
/// of an arm, and enough for the engine.
const BETWEEN_JOINTS_KG: f64 = 1e-3;
const BETWEEN_JOINTS_M: f64 = 0.01;

/// Gives a mass to links that joints of arms and grippers move and that have none, with what is fixed to them: URDFs describe a
/// joint with several axes by such links.
fn weigh_links_between_joints(robot: &mut Robot) {
    let carriers = robot.active_carriers();
    let active = robot.active_joints();
    for joint in (0..robot.joints.len()).filter(|&joint| active[joint]) {
        let carried = robot.links.iter().zip(&carriers).filter(|(_, carrier)| **carrier == Some(joint));
        let carried: Vec<_> = carried.map(|(link, _)| link).collect();
        if carried.iter().any(|link| link.mass_kg > 0.0) {
            continue;
        }
        if let Some(part) = carried.iter().find(|link| !link.shapes.is_empty()) {
            let name = &part.name;
            robot
                .notes
                .push(format!("link {name}: it has no mass, nor has what is fixed to it; a simulation needs its mass"));
            continue;
        }
        let link = &mut robot.links[robot.joints[joint].child_link];
        link.mass_kg = BETWEEN_JOINTS_KG;
        link.inertia_l = Matrix3::identity() * (0.4 * BETWEEN_JOINTS_KG * BETWEEN_JOINTS_M * BETWEEN_JOINTS_M);
        robot.notes.push(format!(
            "link {}: it has no mass, nor has what is fixed to it; {BETWEEN_JOINTS_KG} kg is taken since a joint moves it",
            link.name
        ));
    }
}

/// A robot without arms.
pub(super) fn bare_robot(name: &str, tree: Tree, floor_z_m: f64, options: &RobotOptions) -> Robot {
    let Tree { links, joints, effort: _, notes, files } = tree;
    Robot {
        description: name.into(),
        links,
        x_wr: Pose::identity(),
        joints,
        arms: Vec::new(),
        allowed_collisions: Vec::new(),
        body_points: Vec::new(),
        floor_z_m,
        search_box: None,
        with_linkages: None,
        options: options.clone(),
        notes,
        files,
    }
}

/// The robot as far as it is assembled, and the faults that were found.
struct Assembler<'a> {
    source: &'a Source<'a>,
    robot: Robot,
    /// The effort limit of each joint in the URDF.
    effort: Vec<f64>,
    /// See [`Robot::carriers`].
    carriers: Vec<Option<usize>>,
    faults: &'a mut Collector,
}

impl Assembler<'_> {
    fn fault(&mut self, at: Range<usize>, key: &str, found: impl fmt::Display, expected: impl fmt::Display) {
        self.problem(at, format!("{key}: found {found}, expected {expected}"));
    }

    fn problem(&mut self, at: Range<usize>, problem: String) {
        self.faults.add(self.source.fault(at, problem));
    }

    /// A check that adds a fault if it is not met.
    fn check(
        &mut self,
        met: bool,
        at: Range<usize>,
        key: &str,
        found: impl fmt::Display,
        expected: &str,
    ) -> Option<()> {
        if !met {
            self.fault(at, key, found, expected);
        }
        met.then_some(())
    }

    fn link(&mut self, key: &str, name: &Spanned<String>) -> Option<usize> {
        self.link_named(key, name.get_ref(), name.span())
    }

    fn link_named(&mut self, key: &str, name: &str, span: Range<usize>) -> Option<usize> {
        let found = self.robot.link_index(name);
        if found.is_none() {
            self.fault(span, key, format!("\"{name}\""), "the name of a link of the urdf");
        }
        found
    }

    fn finite<const N: usize>(
        &mut self,
        key: &str,
        numbers: &Spanned<Exactly<f64, N>>,
        unit: &str,
    ) -> Option<[f64; N]> {
        let values = numbers.get_ref().0;
        let finite = values.iter().all(|value| value.is_finite());
        self.check(finite, numbers.span(), key, "a number that is not finite", unit)?;
        Some(values)
    }

    /// A pose from optional keys, the identity without them.
    fn pose_of(
        &mut self,
        [xyz_key, rpy_key]: [&str; 2],
        xyz_m: Option<&Spanned<Exactly<f64, 3>>>,
        rpy_deg: Option<&Spanned<Exactly<f64, 3>>>,
    ) -> Option<Pose> {
        let xyz_m = xyz_m.map_or(Some([0.0; 3]), |given| self.finite(xyz_key, given, "m"))?;
        let rpy_deg = rpy_deg.map_or(Some([0.0; 3]), |given| self.finite(rpy_key, given, "degrees"))?;
        let [roll, pitch, yaw] = rpy_deg.map(f64::to_radians);
        let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
        Some(Isometry3::from_parts(Translation3::from(xyz_m), rotation))
    }

    /// Floor, base and search box.
    fn place(&mut self, description: &Description) {
        let (floor, floor_z_m) = (&description.floor_z_m, self.robot.floor_z_m);
        self.check(floor_z_m.is_finite(), floor.span(), "floor_z_m", floor_z_m, "a finite height in m");
        if let Some(base) = &description.base {
            let keys = ["base.xyz_m", "base.rpy_deg"];
            let x_wr = self.pose_of(keys, base.xyz_m.as_ref(), base.rpy_deg.as_ref());
            self.robot.x_wr = x_wr.unwrap_or_else(Pose::identity);
        }
        if let Some(entry) = &description.search_box {
            let mut range = |key: &str, given: &Spanned<Exactly<f64, 2>>| {
                let [low, high] = given.get_ref().0;
                let met = low.is_finite() && high.is_finite() && low < high;
                self.check(met, given.span(), key, format!("{low} to {high}"), "two finite numbers, the lower first")?;
                Some([low, high])
            };
            let ranges = [
                range("search_box.x_m", &entry.x_m),
                range("search_box.y_m", &entry.y_m),
                range("search_box.z_m", &entry.z_m),
            ];
            if let [Some(x_m), Some(y_m), Some(z_m)] = ranges {
                self.robot.search_box = Some(SearchBox { x_m, y_m, z_m });
            }
        }
    }

    /// The positions of idle joints.
    fn pose(&mut self, description: &Description, posture: &BTreeMap<String, f64>) {
        for (name, position) in &description.posture {
            let given = posture.get(name.get_ref()).unwrap_or(position.get_ref());
            let problem = self.pose_joint(name.get_ref(), *given);
            if let Some(problem) = problem {
                self.problem(name.span(), format!("posture: {problem}"));
            }
        }
        for (name, position) in posture {
            if description.posture.keys().all(|known| known.get_ref() != name)
                && let Some(problem) = self.pose_joint(name, *position)
            {
                // It is in another file, whose key the caller names.
                self.faults.add_to(self.source.file, format!("posture of the scenario: {problem}"));
            }
        }
    }

    /// Sets the rest position of a joint; what was found and expected if it cannot have it.
    fn pose_joint(&mut self, name: &str, position: f64) -> Option<String> {
        let joint = self.robot.joints.iter().position(|joint| joint.name == name);
        let moves = |joint: &usize| self.robot.joints[*joint].kind != JointKind::Fixed;
        let Some(index) = joint.filter(moves) else {
            return Some(format!("found \"{name}\", expected the name of a joint of the urdf that moves"));
        };
        let joint = &mut self.robot.joints[index];
        if joint.mimic.is_some() {
            return Some(format!("found {name}, expected a joint that follows no other"));
        }
        let [lower, upper] = [joint.lower, joint.upper];
        if !(lower..=upper).contains(&position) {
            return Some(format!("found {position} for {name}, expected {lower} to {upper}"));
        }
        joint.rest = position;
        None
    }
}
