//! The text of a description, with comments that say what was found and what a person must measure.

use std::fmt::Write as _;

use super::{
    draft::{ASSUMED_FORCE_N, ASSUMED_FRICTION, ASSUMED_GRIP_N, ArmDraft},
    hand::Fingers,
    pairs::{AllowedPair, Reason},
};
use crate::{
    model::frames::Pose,
    robot::{BodyPoint, Robot, SearchBox},
};

/// What the description says beside the arms.
#[derive(Default)]
pub(super) struct Rest {
    /// Turn of the root about z, degrees.
    pub yaw_deg: f64,
    /// Height of the floor, m, and true if a bench under the robot is assumed.
    pub floor_z_m: (f64, bool),
    pub search_box: Option<SearchBox>,
    /// Links whose meshes are decomposed into convex parts.
    pub decompose: Vec<usize>,
    pub allowed: Vec<AllowedPair>,
    pub body_points: Vec<BodyPoint>,
}

/// The files that the description names, as it names them.
pub(super) struct Names<'a> {
    pub urdf: &'a str,
    pub packages: &'a [String],
}

/// The text of a description.
pub(super) fn description(robot: &Robot, names: &Names<'_>, arms: &[ArmDraft], rest: &Rest) -> String {
    let mut text = String::from(
        "# Written by `benchdog robot new`. SI units. Lines with ASSUMED need a figure of your robot: measure it, or take it\n\
         # from a data sheet, and delete the word. docs/robot.md explains every key.\n\n",
    );
    let _ = writeln!(text, "format = 1\nurdf = {}", quoted(names.urdf));
    if !names.packages.is_empty() {
        let _ =
            writeln!(text, "# Folders that contain the packages of the meshes.\npackages = {}", list(names.packages));
    }
    let (floor_z_m, on_bench) = rest.floor_z_m;
    let why = if on_bench { "ASSUMED: the robot stands on a bench of 0.8 m" } else { "under the robot's lowest shape" };
    let _ = writeln!(text, "floor_z_m = {floor_z_m:?} # {why}");
    if !rest.decompose.is_empty() {
        let links: Vec<String> = rest.decompose.iter().map(|&link| robot.links[link].name.clone()).collect();
        let _ = writeln!(
            text,
            "# Links whose meshes are divided into convex parts: the hull of the whole mesh is in the way of others.\n\
             decompose = {}",
            list(&links)
        );
    }
    allowed_collisions(&mut text, robot, &rest.allowed);
    body_points(&mut text, robot, &rest.body_points);
    if rest.yaw_deg != 0.0 {
        let _ = write!(
            text,
            "\n# ASSUMED: the arms reach forward along another axis of the root link than x, so the robot is turned.\n\
             [base]\nrpy_deg = [0.0, 0.0, {:?}]\n",
            rest.yaw_deg
        );
    }
    posture(&mut text, robot, arms);
    if let Some(SearchBox { x_m, y_m, z_m }) = rest.search_box {
        let _ = write!(
            text,
            "\n# Where the planner looks for the board's centre: in front of the robot (+x), at a person's working height, where\n\
             # all grippers come near. From samples of the reach.\n[search_box]\nx_m = {x_m:?}\ny_m = {y_m:?}\nz_m = {z_m:?}\n"
        );
    }
    for arm in arms {
        write_arm(&mut text, robot, arm);
    }
    text
}

/// A text in TOML.
fn quoted(text: &str) -> String {
    toml::Value::from(text).to_string()
}

fn list(texts: &[String]) -> String {
    format!("[{}]", texts.iter().map(|text| quoted(text)).collect::<Vec<_>>().join(", "))
}

fn allowed_collisions(text: &mut String, robot: &Robot, pairs: &[AllowedPair]) {
    text.push_str("\n# Links whose shapes may overlap.\nallowed_collisions = [\n");
    for reason in [Reason::Adjacent, Reason::Always, Reason::Often, Reason::Middle, Reason::Srdf] {
        let of_reason: Vec<_> = pairs.iter().filter(|pair| pair.reason == reason).collect();
        if !of_reason.is_empty() {
            let _ = writeln!(text, "    # {}", reason.describe());
        }
        for pair in of_reason {
            let [a, b] = pair.links.map(|link| quoted(&robot.links[link].name));
            let _ = writeln!(text, "    [{a}, {b}],");
        }
    }
    text.push_str("]\n");
}

fn body_points(text: &mut String, robot: &Robot, points: &[BodyPoint]) {
    text.push_str("\n# Points on the surface, from which the distance to the person is measured.\nbody_points = [\n");
    for point in points {
        let [x, y, z] = [point.p_l.x, point.p_l.y, point.p_l.z];
        let link = quoted(&robot.links[point.link].name);
        let _ = writeln!(text, "    {{ link = {link}, p_m = [{x:?}, {y:?}, {z:?}] }},");
    }
    text.push_str("]\n");
}

/// The joints between the root and the arms, which the user may want elsewhere.
fn posture(text: &mut String, robot: &Robot, arms: &[ArmDraft]) {
    let mut before = Vec::new();
    for arm in arms {
        let first = arm.run.joints[0];
        let mut link = robot.joints[first].parent_link;
        while let Some(joint) = robot.links[link].parent_joint {
            let of = &robot.joints[joint];
            if of.lower < of.upper && of.mimic.is_none() && !before.contains(&joint) {
                before.push(joint);
            }
            link = of.parent_link;
        }
    }
    if before.is_empty() {
        return;
    }
    text.push_str("\n# Joints that carry arms and do not hold the board: they stay here (rad or m).\n[posture]\n");
    before.sort_unstable();
    for joint in before {
        let of = &robot.joints[joint];
        let _ = writeln!(text, "{} = {:?} # from {:?} to {:?}", quoted(&of.name), of.rest, of.lower, of.upper);
    }
}

fn write_arm(text: &mut String, robot: &Robot, arm: &ArmDraft) {
    let names = arm.run.joints.iter().map(|&joint| robot.joints[joint].name.clone()).collect::<Vec<_>>();
    let base = &robot.links[robot.joints[arm.run.joints[0]].parent_link].name;
    let _ = writeln!(text, "\n[[arms]]\nname = {}\nbase_link = {}", quoted(&arm.name), quoted(base));
    let _ = writeln!(text, "joints = {}", list(&names));
    if arm.effort_is_assumed {
        let _ = writeln!(text, "effort_nm = {:?} # ASSUMED: the urdf has no effort for some of them", arm.effort_nm);
    }
    let _ = writeln!(
        text,
        "# Stiffness and damping of the joints' position control, as the load feels it.\n\
         stiffness_nm_rad = {:?} # ASSUMED: 17 times the effort\n\
         damping_nm_s_rad = {:?} # ASSUMED: 0.036 s times the stiffness",
        arm.stiffness_nm_rad, arm.damping_nm_s_rad
    );
    gripper(text, robot, arm);
}

fn gripper(text: &mut String, robot: &Robot, arm: &ArmDraft) {
    let hand = &arm.hand;
    let name = |link: usize| quoted(&robot.links[link].name);
    text.push_str("\n[arms.gripper]\n");
    if let Some(remark) = &hand.remark {
        let _ = writeln!(text, "# ASSUMED: a clamp in front of the arm, since {remark}.\nkind = \"clamp\"");
    }
    let _ = writeln!(text, "frame_link = {}", name(hand.frame_link));
    if let Some(x_lg) = &hand.x_lg {
        let [xyz, rpy] = frame_keys(x_lg);
        let _ = writeln!(
            text,
            "# The frame G: z out of the hand, opening along y.\nframe_xyz_m = {xyz:?}\nframe_rpy_deg = {rpy:?}"
        );
    }
    let _ = writeln!(text, "palm_link = {}", name(hand.palm_link));
    let pads = if hand.remark.is_some() { "ASSUMED" } else { "guessed from the shapes: measure the face that touches" };
    let _ = write!(
        text,
        "opening_m = {:?}\nmax_force_n = {ASSUMED_FORCE_N:?} # ASSUMED: the force of each finger\n\
         grip_force_n = {ASSUMED_GRIP_N:?} # ASSUMED: with which a scenario closes it by default\n\
         friction = {ASSUMED_FRICTION:?} # ASSUMED: rubber on a board\n\
         pad_size_m = {:?} # {pads}\npad_centre_m = {:?} # along x and z of G\n",
        hand.opening_m, hand.pad_size_m, hand.pad_centre_m
    );
    let fingers: [(String, String); 2] = match &hand.fingers {
        Fingers::Prismatic(fingers) => fingers.map(|(joint, link)| {
            (format!(", joint = {}", quoted(&robot.joints[joint].name)), format!("pad_link = {}", name(link)))
        }),
        Fingers::Linkage(pads) => pads.each_ref().map(|links| {
            let names: Vec<String> = links[1..].iter().map(|&link| robot.links[link].name.clone()).collect();
            let beside = if names.is_empty() { String::new() } else { format!(", beside = {}", list(&names)) };
            (String::new(), format!("pad_link = {}{beside}", name(links[0])))
        }),
        Fingers::Clamp => return,
    };
    text.push_str("fingers = [\n");
    for (number, (joint, links)) in fingers.into_iter().enumerate() {
        let _ = writeln!(text, "    {{ name = \"finger{}\"{joint}, {links} }},", number + 1);
    }
    text.push_str("]\n");
}

/// A pitch this near to a quarter turn is one, rad: quarter turns with six digits.
const SINGULAR_RAD: f64 = 1e-5;

/// Position, m, and roll, pitch and yaw, degrees, of a frame, without the noise of rounding.
fn frame_keys(x_lg: &Pose) -> [[f64; 3]; 2] {
    let clean = |value: f64, step: f64| ((value / step).round() * step * 1e9).round() / 1e9;
    let (roll, pitch, yaw) = x_lg.rotation.euler_angles();
    let xyz: [f64; 3] = x_lg.translation.vector.into();
    // With the pitch at a quarter turn roll and yaw are about one axis.
    let turn = std::f64::consts::FRAC_PI_2;
    let is_singular = (pitch.abs() - turn).abs() < SINGULAR_RAD;
    let (roll, yaw) = if is_singular { (roll - pitch.signum() * yaw, 0.0) } else { (roll, yaw) };
    // Quarter turns with six digits are quarter turns.
    let degrees = [roll, pitch, yaw].map(|angle| {
        let degrees = angle.to_degrees();
        let quarter = (degrees / 90.0).round() * 90.0;
        if (degrees - quarter).abs() < 1e-3 { quarter } else { clean(degrees, 1e-7) }
    });
    [xyz.map(|v| clean(v, 1e-7)), degrees].map(|values| values.map(|v| v + 0.0))
}
