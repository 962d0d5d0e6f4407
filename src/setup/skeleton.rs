//! The arms of a robot: runs of moving joints without a branch.

use crate::robot::{JointKind, Robot};

/// The fewest joints of an arm. The fingers of a hand have fewer.
const LEAST_JOINTS: usize = 5;

/// The least length of an arm, from its first joint to its last, m. Fingers with as many joints are shorter.
const LEAST_LENGTH_M: f64 = 0.20;

/// Parts of names of what is no arm.
const NO_ARM: [&str; 12] =
    ["leg", "hip", "knee", "ankle", "foot", "wheel", "caster", "head", "neck", "torso", "waist", "propeller"];

/// Parts of names of joints that move a finger.
const FINGER: [&str; 5] = ["gripper", "finger", "jaw", "claw", "thumb"];

/// The range of a joint that closes a finger begins at 0, up to this share of its longer side; that of a wrist is on both sides.
const ONE_SIDED: f64 = 0.2;

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
    let mut runs = all_runs(robot, &group_of);
    runs = runs.into_iter().map(|run| without_finger(robot, &group_of, run)).collect();
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
    let root = 0;
    let first = |carrier: Option<usize>| carrier.map_or(root, |joint| robot.joints[joint].child_link);
    robot.carriers().into_iter().map(first).collect()
}

fn group(robot: &Robot, group_of: &[usize], first: usize) -> Group {
    let links: Vec<usize> = (0..robot.links.len()).filter(|&link| group_of[link] == first).collect();
    let hangs = |joint: &usize| {
        let joint = &robot.joints[*joint];
        joint.kind != JointKind::Fixed && group_of[joint.parent_link] == first
    };
    Group { links, joints: (0..robot.joints.len()).filter(hangs).collect() }
}

/// All runs, each before those behind it. A list of the joints at which runs begin takes the place of recursion, since a tree may
/// be deeper than the stack.
fn all_runs(robot: &Robot, group_of: &[usize]) -> Vec<Run> {
    let next = |joint: usize| group_of[robot.joints[joint].child_link];
    let mut runs = Vec::new();
    let mut beginnings: Vec<(usize, Vec<usize>)> = vec![(0, Vec::new())];
    while let Some((mut first, mut run)) = beginnings.pop() {
        let end = loop {
            let end = group(robot, group_of, first);
            let [only] = end.joints[..] else { break end };
            run.push(only);
            first = next(only);
        };
        beginnings.extend(end.joints.iter().rev().map(|&joint| (next(joint), vec![joint])));
        runs.push(Run { joints: run, end_links: end.links, end_joints: end.joints });
    }
    runs
}

/// The run without its last joint if that moves the only finger of a gripper.
fn without_finger(robot: &Robot, group_of: &[usize], mut run: Run) -> Run {
    let closes = |joint: &usize| {
        let joint = &robot.joints[*joint];
        let name = joint.name.to_lowercase();
        let [shorter, longer] = [joint.lower.abs().min(joint.upper.abs()), joint.lower.abs().max(joint.upper.abs())];
        FINGER.iter().any(|part| name.contains(part)) && shorter <= ONE_SIDED * longer
    };
    if run.joints.len() > 1 && run.joints.last().is_some_and(closes) {
        run.joints.pop();
        let before = run.joints.last().map_or(0, |&joint| group_of[robot.joints[joint].child_link]);
        let Group { links, joints } = group(robot, group_of, before);
        (run.end_links, run.end_joints) = (links, joints);
    }
    run
}

fn is_named_otherwise(robot: &Robot, run: &Run) -> bool {
    let names = run.joints.iter().map(|&joint| robot.joints[joint].name.to_lowercase());
    let others = names.filter(|name| NO_ARM.iter().any(|part| name.contains(part))).count();
    2 * others > run.joints.len()
}

/// True if a joint's name begins with the letter of a side, and the robot has a joint of the same name with that of the other.
fn has_mirror(robot: &Robot, name: &str, [own, other]: [char; 2]) -> bool {
    let mirrored = |own: char, other: char| name.strip_prefix(own).map(|rest| format!("{other}{rest}"));
    let names = [mirrored(own, other), mirrored(own.to_ascii_uppercase(), other.to_ascii_uppercase())];
    names.into_iter().flatten().any(|name| robot.joints.iter().any(|joint| joint.name == name))
}

/// A name for each arm: its side if the names of its joints tell one, else a number.
pub(super) fn names(robot: &Robot, runs: &[Run]) -> Vec<String> {
    let side = |run: &Run| {
        let count = |words: [&str; 4], [own, other]: [char; 2]| {
            let has_word = |name: &str| {
                let name = format!("_{}_", name.to_lowercase());
                words.iter().any(|word| name.contains(word))
            };
            let names = run.joints.iter().map(|&joint| robot.joints[joint].name.as_str());
            names.filter(|name| has_word(name) || has_mirror(robot, name, [own, other])).count()
        };
        let left = count(["left", "_l_", "_la_", "_lh_"], ['l', 'r']);
        let right = count(["right", "_r_", "_ra_", "_rh_"], ['r', 'l']);
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
