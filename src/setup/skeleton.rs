//! The arms of a robot: runs of moving joints without a branch.

use crate::robot::{JointKind, Robot};

/// The fewest joints of an arm. The fingers of a hand have fewer.
const LEAST_JOINTS: usize = 5;

/// The least length of an arm, from its first joint to its last, m. Fingers with as many joints are shorter.
const LEAST_LENGTH_M: f64 = 0.20;

/// Parts of names of what is no arm.
const NO_ARM: [&str; 12] =
    ["leg", "hip", "knee", "ankle", "foot", "wheel", "caster", "head", "neck", "torso", "waist", "propeller"];

/// A run of moving joints from a branch to a branch or an end.
#[derive(Clone, Debug)]
pub(super) struct Run {
    /// The joints, from the root outward.
    pub joints: Vec<usize>,
    /// The links that are fixed to the last joint's child.
    pub end_links: Vec<usize>,
    /// The moving joints that hang on these links.
    pub end_joints: Vec<usize>,
}

/// The links of a robot in groups that do not move in themselves.
struct Group {
    links: Vec<usize>,
    /// The joints that hang on it.
    joints: Vec<usize>,
}

/// The runs that are long enough for an arm and not named after something else, in the order of the URDF; at most four.
pub(super) fn arms(robot: &Robot) -> Vec<Run> {
    let group_of = group_of_links(robot);
    let mut runs = Vec::new();
    collect(robot, &group_of, 0, Vec::new(), &mut runs);
    runs.retain(|run| {
        run.joints.len() >= LEAST_JOINTS && length_m(robot, run) >= LEAST_LENGTH_M && !is_named_otherwise(robot, run)
    });
    let longest = runs.iter().map(|run| run.joints.len()).max().unwrap_or_default();
    // Runs of a spine or of a hand are shorter than the arms beside them.
    runs.retain(|run| run.joints.len() + 2 >= longest);
    runs.truncate(4);
    runs
}

/// The sum of the offsets between the joints of a run, m.
fn length_m(robot: &Robot, run: &Run) -> f64 {
    let x_wl = robot.link_poses(&robot.positions(&[]));
    let origin_w = |joint: &usize| x_wl[robot.joints[*joint].child_link].translation.vector;
    run.joints.windows(2).map(|pair| (origin_w(&pair[1]) - origin_w(&pair[0])).norm()).sum()
}

/// For each link the first link of its group.
fn group_of_links(robot: &Robot) -> Vec<usize> {
    let mut group_of: Vec<usize> = Vec::with_capacity(robot.links.len());
    for (index, link) in robot.links.iter().enumerate() {
        let fixed = link.parent_joint.filter(|&joint| robot.joints[joint].kind == JointKind::Fixed);
        group_of.push(fixed.map_or(index, |joint| group_of[robot.joints[joint].parent_link]));
    }
    group_of
}

fn group(robot: &Robot, group_of: &[usize], first: usize) -> Group {
    let links: Vec<usize> = (0..robot.links.len()).filter(|&link| group_of[link] == first).collect();
    let hangs = |joint: &usize| {
        let joint = &robot.joints[*joint];
        joint.kind != JointKind::Fixed && group_of[joint.parent_link] == first
    };
    Group { links, joints: (0..robot.joints.len()).filter(hangs).collect() }
}

/// Adds the run that ends at a group, and those behind it.
fn collect(robot: &Robot, group_of: &[usize], first: usize, run: Vec<usize>, runs: &mut Vec<Run>) {
    let Group { links, joints } = group(robot, group_of, first);
    let next = |joint: usize| group_of[robot.joints[joint].child_link];
    if let [only] = joints[..] {
        return collect(robot, group_of, next(only), [run, vec![only]].concat(), runs);
    }
    runs.push(Run { joints: run, end_links: links, end_joints: joints.clone() });
    for joint in joints {
        collect(robot, group_of, next(joint), vec![joint], runs);
    }
}

fn is_named_otherwise(robot: &Robot, run: &Run) -> bool {
    let names = run.joints.iter().map(|&joint| robot.joints[joint].name.to_lowercase());
    let others = names.filter(|name| NO_ARM.iter().any(|part| name.contains(part))).count();
    2 * others > run.joints.len()
}

/// A name for each arm: its side if the names of its joints tell one, else a number.
pub(super) fn names(robot: &Robot, runs: &[Run]) -> Vec<String> {
    let side = |run: &Run| {
        let count = |words: [&str; 4]| {
            let names = run.joints.iter().map(|&joint| format!("_{}_", robot.joints[joint].name.to_lowercase()));
            names.filter(|name| words.iter().any(|word| name.contains(word))).count()
        };
        let (left, right) = (count(["left", "_l_", "_la_", "_lh_"]), count(["right", "_r_", "_ra_", "_rh_"]));
        let all = run.joints.len();
        if 2 * left > all {
            Some("left")
        } else if 2 * right > all {
            Some("right")
        } else {
            None
        }
    };
    let sides: Vec<_> = runs.iter().map(side).collect();
    let is_unique = |name: &str| sides.iter().filter(|side| **side == Some(name)).count() == 1;
    let name = |(number, side): (usize, &Option<&str>)| match side {
        Some(side) if is_unique(side) => (*side).to_owned(),
        _ if runs.len() == 1 => "arm".to_owned(),
        _ => format!("arm{}", number + 1),
    };
    sides.iter().enumerate().map(name).collect()
}
