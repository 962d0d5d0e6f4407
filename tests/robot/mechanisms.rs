//! Robots with meshes, sliding joints, joints that follow others, linkage grippers and clamps, against closed forms.

use approx::assert_relative_eq;
use benchdog::{
    model::{GRAVITY_W, frames::Pose},
    robot::{ArmState, Chain, InverseKinematics, JointKind, Robot, RobotOptions, Shape, Solution},
};
use nalgebra::{DVector, UnitQuaternion, Vector3};
use proptest::prelude::*;

/// Length of a finger of the linkage, distance of its joint from the middle, and of the pad's face inside it, m.
const FINGER_M: f64 = 0.06;
const JOINT_M: f64 = 0.02;
const FACE_M: f64 = 0.015;

/// A rail, a lifting torso that follows it, two hinges, and a gripper whose fingers are parallelograms.
fn urdf() -> String {
    let inertial = "<inertial><origin xyz=\"0.02 0.01 0.05\"/><mass value=\"1.5\"/><inertia ixx=\"0.02\" ixy=\"0\" ixz=\"0\" \
                    iyy=\"0.03\" iyz=\"0\" izz=\"0.01\"/></inertial>";
    let link = |name: &str, shape: &str| format!("<link name=\"{name}\">{inertial}{shape}</link>");
    let shape = |origin: &str, size: &str| {
        format!("<collision><origin xyz=\"{origin}\"/><geometry><box size=\"{size}\"/></geometry></collision>")
    };
    let joint = |name: &str, kind: &str, [parent, child]: [&str; 2], xyz: &str, axis: &str, rest: &str| {
        format!(
            "<joint name=\"{name}\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"{child}\"/><origin xyz=\"{xyz}\"/>\
             <axis xyz=\"{axis}\"/>{rest}</joint>"
        )
    };
    let limit = |low: f64, high: f64| format!("<limit lower=\"{low}\" upper=\"{high}\" effort=\"80\" velocity=\"1\"/>");
    let mimic = |of: &str, times: f64| format!("{}<mimic joint=\"{of}\" multiplier=\"{times}\"/>", limit(-1.0, 1.0));
    let tip = format!("0 -{} 0.01", FACE_M - 0.005);
    let other_tip = format!("0 {} 0.01", FACE_M - 0.005);
    let finger = format!("0 0 {FINGER_M}");
    let elements = [
        link("base", ""),
        link("column", &shape("0 0 0.1", "0.1 0.1 0.2")),
        link("carriage", ""),
        link("upper", &shape("0 0 0.15", "0.05 0.05 0.3")),
        link("palm", ""),
        link("idler", ""),
        link("left_finger", ""),
        link("right_finger", ""),
        link("left_tip", &shape(&tip, "0.02 0.01 0.02")),
        link("right_tip", &shape(&other_tip, "0.02 0.01 0.02")),
        joint("lift", "prismatic", ["base", "column"], "0 0 0.1", "0 0 1", &limit(0.0, 0.4)),
        joint("cable", "prismatic", ["base", "idler"], "0.3 0 0", "0 0 1", &mimic("lift", 0.5)),
        joint("rail", "prismatic", ["column", "carriage"], "0 0 0.2", "0.6 0 0.8", &limit(-0.2, 0.5)),
        joint("shoulder", "revolute", ["carriage", "upper"], "0.1 0 0", "0 1 0", &limit(-2.0, 2.0)),
        joint("wrist", "continuous", ["upper", "palm"], "0 0 0.3", "0 0 1", &limit(0.0, 0.0)),
        joint("left", "revolute", ["palm", "left_finger"], "0 0.02 0.05", "-1 0 0", &limit(-0.2, 0.6)),
        joint("right", "revolute", ["palm", "right_finger"], "0 -0.02 0.05", "1 0 0", &mimic("left", 1.0)),
        joint("left_level", "revolute", ["left_finger", "left_tip"], &finger, "-1 0 0", &mimic("left", -1.0)),
        joint("right_level", "revolute", ["right_finger", "right_tip"], &finger, "1 0 0", &mimic("left", -1.0)),
    ];
    format!("<robot name=\"rail\">{}</robot>", elements.concat())
}

fn description(gripper: &str) -> String {
    format!(
        "format = 1\nurdf = \"rail.urdf\"\nfloor_z_m = 0.0\nbody_points = [{{ link = \"upper\", p_m = [0.0, 0.0, 0.1] }}]\n\
         [posture]\nlift = 0.3\n[base]\nxyz_m = [0.5, 0.0, 0.2]\nrpy_deg = [0.0, 0.0, 90.0]\n\
         [[arms]]\nname = \"arm\"\nbase_link = \"column\"\njoints = [\"rail\", \"shoulder\", \"wrist\"]\n\
         effort_nm = [80.0, 80.0, 80.0]\nstiffness_nm_rad = [4000.0, 900.0, 900.0]\ndamping_nm_s_rad = [100.0, 30.0, 30.0]\n\
         [arms.gripper]\nframe_link = \"palm\"\nmax_force_n = 40.0\npad_size_m = [0.02, 0.02]\n{gripper}"
    )
}

const LINKAGE: &str = "opening_m = [0.005, 0.06]\npad_centre_m = [0.0, 0.12]\nfingers = [\n\
    { name = \"left\", pad_link = \"left_tip\" }, { name = \"right\", pad_link = \"right_tip\" }]\n";

fn load(description: &str) -> Result<Robot, String> {
    load_with(description, &urdf(), &RobotOptions::default())
}

fn load_with(description: &str, urdf: &str, options: &RobotOptions) -> Result<Robot, String> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("robot.toml"), description).unwrap();
    std::fs::write(folder.path().join("rail.urdf"), urdf).unwrap();
    Robot::load_with("robot.toml", folder.path(), options).map_err(|error| error.to_string())
}

fn rail() -> Robot {
    load(&description(LINKAGE)).unwrap()
}

/// The angle of the parallelograms for a gap: `gap / 2 = joint + length sin(angle) - face`.
fn angle_rad(gap_m: f64) -> f64 {
    ((gap_m / 2.0 + FACE_M - JOINT_M) / FINGER_M).asin()
}

#[test]
fn base_posture_and_followers_place_the_links() {
    let robot = rail();
    let x_wl = robot.link_poses(&robot.positions(&[]));
    let origin = |name: &str| x_wl[robot.link_index(name).unwrap()].translation.vector;
    // The base is turned by a quarter about z, so x of the URDF is y of W.
    assert_relative_eq!(origin("base"), Vector3::new(0.5, 0.0, 0.2), epsilon = 1e-15);
    assert_relative_eq!(origin("column"), Vector3::new(0.5, 0.0, 0.2 + 0.1 + 0.3), epsilon = 1e-15);
    // Half of the lift's position.
    assert_relative_eq!(origin("idler"), Vector3::new(0.5, 0.3, 0.2 + 0.15), epsilon = 1e-15);
}

#[test]
fn a_scenarios_posture_comes_before_the_descriptions() {
    let posture = |joint: &str, position: f64| RobotOptions {
        posture: [(joint.to_owned(), position)].into(),
        ..RobotOptions::default()
    };
    let robot = load_with(&description(LINKAGE), &urdf(), &posture("lift", 0.1)).unwrap();
    let column = robot.link_poses(&robot.positions(&[]))[robot.link_index("column").unwrap()];
    assert_relative_eq!(column.translation.z, 0.2 + 0.1 + 0.1, epsilon = 1e-15);
    for (joint, position, expected) in [
        ("lift", 0.5, "posture: found 0.5 for lift, expected 0 to 0.4"),
        ("cable", 0.1, "robot.toml: posture of the scenario: found cable, expected a joint that follows no other"),
        (
            "hoist",
            0.1,
            "robot.toml: posture of the scenario: found \"hoist\", expected the name of a joint of the urdf that moves",
        ),
    ] {
        let error = load_with(&description(LINKAGE), &urdf(), &posture(joint, position)).unwrap_err();
        assert!(error.contains(expected), "{error}");
    }
}

fn q() -> impl Strategy<Value = Vec<f64>> {
    (-0.2..0.5, -2.0..2.0, -3.0..3.0).prop_map(|(rail, shoulder, wrist)| vec![rail, shoulder, wrist])
}

/// The central difference of a function of the joint positions.
fn difference(q: &[f64], joint: usize, of: impl Fn(&[f64]) -> DVector<f64>) -> DVector<f64> {
    let step = 1e-6;
    let at = |by: f64| {
        let mut moved = q.to_vec();
        moved[joint] += by;
        of(&moved)
    };
    (at(step) - at(-step)) / (2.0 * step)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    /// Jacobian, gravity and its derivative of an arm with a prismatic joint are those of differences, and inverse kinematics
    /// finds the way back.
    #[test]
    fn an_arm_with_a_prismatic_joint_is_consistent(q in q()) {
        let chain = Chain::new(&rail(), 0, 0.0);
        let (jacobian, gravity) = (chain.jacobian_w(&q), chain.gravity_stiffness_nm_rad(&q));
        let x_wg = chain.gripper_pose(&q);
        for joint in 0..3 {
            let pose = |q: &[f64]| {
                let at = chain.gripper_pose(q);
                let turn = (at.rotation * x_wg.rotation.inverse()).scaled_axis();
                DVector::from_iterator(6, at.translation.vector.iter().chain(turn.iter()).copied())
            };
            let energy = |q: &[f64]| {
                let (_, moment) = chain.mass_and_moment_w(q);
                DVector::from_element(1, -GRAVITY_W.dot(&moment))
            };
            // Differences of numbers of order 1 to 100 over a step of 1e-6.
            prop_assert!((difference(&q, joint, pose) - jacobian.column(joint)).amax() < 1e-8);
            prop_assert!((difference(&q, joint, energy)[0] - chain.gravity_torque_nm(&q)[joint]).abs() < 1e-6);
            let torque = difference(&q, joint, |q| chain.gravity_torque_nm(q));
            prop_assert!((torque - gravity.column(joint)).amax() < 1e-6);
        }
        let mass = chain.mass_matrix(&q);
        prop_assert!(mass.clone().cholesky().is_some() && (mass.clone() - mass.transpose()).amax() < 1e-12);
        let solver = InverseKinematics::for_chain(&chain);
        let near: Vec<f64> = q.iter().map(|position| position * 0.95).collect();
        let Solution::Found(found) = solver.local(&x_wg, &near) else { panic!("no way back from {near:?} to {q:?}") };
        let back = chain.gripper_pose(&found);
        prop_assert!((back.translation.vector - x_wg.translation.vector).norm() < 1e-8);
    }

    /// The opening map: pads at half the gap, turned by nothing, and forward by the cosine of the angle.
    #[test]
    fn a_linkage_holds_its_pads_at_the_gap(gap_m in 0.006..0.059, other_m in 0.006..0.059) {
        let robot = rail().at_gap(gap_m);
        let gripper = &robot.arms[0].gripper;
        let [left, right] = [0, 1].map(|finger: usize| gripper.fingers[finger].joint);
        assert_eq!([left, right].map(|joint| robot.joints[joint].kind), [JointKind::Prismatic; 2]);
        let pose = |robot: &Robot, gap_m: f64, name: &str| -> Pose {
            let gripper = &robot.arms[0].gripper;
            let finger_travel_m = [0, 1].map(|finger| gripper.travel_for_gap_m(finger, gap_m));
            let state = ArmState { arm: 0, q_rad: &[0.1, 0.5, 0.3], finger_travel_m };
            let x_wl = robot.link_poses(&robot.positions(&[state]));
            x_wl[gripper.frame_link].inverse() * x_wl[robot.link_index(name).unwrap()]
        };
        let angle = angle_rad(gap_m);
        let expected = Vector3::new(0.0, JOINT_M + FINGER_M * angle.sin(), 0.05 + FINGER_M * angle.cos());
        let found = pose(&robot, gap_m, "left_tip");
        // The bisection ends at rounding of the angle.
        prop_assert!((found.translation.vector - expected).norm() < 1e-13, "{}", found.translation.vector - expected);
        prop_assert!(found.rotation.angle() < 1e-12);
        let forward = FINGER_M * (angle.cos() - angle_rad(0.005).cos());
        prop_assert!((gripper.fingers[0].pad.centre_m[1] - (0.12 + forward)).abs() < 1e-13);
        // From here the pads slide along y to any other gap, where the linkage would have them but for how far forward.
        let slid = pose(&robot, other_m, "right_tip").translation.vector;
        let there = pose(&rail().at_gap(other_m), other_m, "right_tip").translation.vector;
        prop_assert!((slid.y - there.y).abs() < 1e-13 && (slid.z - found.translation.z).abs() < 1e-13);
    }
}

/// A command protects all files that it has read, also those of a robot whose linkage it holds at another gap.
#[test]
fn a_robot_at_another_gap_was_read_from_the_same_files() {
    let robot = rail();
    assert_eq!(robot.files.len(), 2, "{:?}", robot.files);
    assert_eq!(robot.at_gap(0.03).files, robot.files);
}

#[test]
fn a_gripper_that_is_no_parallel_jaw_is_refused() {
    let turning = urdf().replace("joint=\"left\" multiplier=\"-1\"", "joint=\"left\" multiplier=\"-0.5\"");
    let error = load_with(&description(LINKAGE), &turning, &RobotOptions::default()).unwrap_err();
    assert!(
        error.contains("fingers: found pads that turn by 11 degrees as the gripper opens, expected at most 2"),
        "{error}"
    );
    let alone = LINKAGE.replace("right_tip", "palm");
    let error = load(&description(&alone)).unwrap_err();
    assert!(error.contains("fingers: found palm, expected a link with collision geometry"), "{error}");
    let wide = LINKAGE.replace("0.06]", "0.09]");
    let error = load(&description(&wide)).unwrap_err();
    assert!(error.contains("opening_m: found 0.005 to 0.09, expected two gaps within"), "{error}");
}

#[test]
fn a_clamp_has_jaws_at_the_gap() {
    let clamp = "kind = \"clamp\"\nframe_xyz_m = [0.0, 0.0, 0.1]\nframe_rpy_deg = [0.0, 0.0, 90.0]\nopening_m = [0.0, 0.05]\n\
                 pad_centre_m = [0.01, 0.03]\n";
    let robot = load(&description(clamp)).unwrap();
    let gripper = &robot.arms[0].gripper;
    let gap_m = 0.03;
    let finger_travel_m = [0, 1].map(|finger| gripper.travel_for_gap_m(finger, gap_m));
    let state = ArmState { arm: 0, q_rad: &[0.0, 0.0, 0.0], finger_travel_m };
    let x_wl = robot.link_poses(&robot.positions(&[state]));
    let palm = x_wl[robot.link_index("palm").unwrap()];
    let x_wg = x_wl[gripper.frame_link];
    assert_relative_eq!((palm.inverse() * x_wg).translation.vector, Vector3::new(0.0, 0.0, 0.1), epsilon = 1e-15);
    // y of G is -x of the palm.
    assert_relative_eq!((palm.inverse() * x_wg) * Vector3::y(), -Vector3::x(), epsilon = 1e-15);
    for (finger, side) in gripper.fingers.iter().zip([1.0, -1.0]) {
        let jaw = &robot.links[finger.pad.link];
        let placed = &jaw.shapes[0];
        let centre_g = (x_wg.inverse() * x_wl[finger.pad.link] * placed.x_ls).translation.vector;
        let Shape::Box { half_m } = placed.shape else { panic!("{:?}", placed.shape) };
        assert_relative_eq!(centre_g, Vector3::new(0.01, side * (gap_m / 2.0 + half_m[1]), 0.03), epsilon = 1e-15);
        assert!(jaw.mass_kg > 0.0);
    }
}

/// Every frame of quarter turns is as the description has it, half turns among them.
#[test]
fn a_frame_of_quarter_turns_is_exact() {
    let quarters: [f64; 5] = [-180.0, -90.0, 0.0, 90.0, 180.0];
    for [roll, pitch, yaw] in
        quarters.iter().flat_map(|a| quarters.map(|b| [*a, b])).flat_map(|[a, b]| quarters.map(|c| [a, b, c]))
    {
        let clamp = format!(
            "kind = \"clamp\"\nframe_rpy_deg = [{roll:?}, {pitch:?}, {yaw:?}]\nopening_m = [0.0, 0.05]\npad_centre_m = [0.0, 0.0]\n"
        );
        let robot = load(&description(&clamp)).unwrap();
        let x_wl = robot.link_poses(&robot.positions(&[]));
        let palm = x_wl[robot.link_index("palm").unwrap()].rotation;
        let found = palm.inverse() * x_wl[robot.arms[0].gripper.frame_link].rotation;
        let expected = UnitQuaternion::from_euler_angles(roll.to_radians(), pitch.to_radians(), yaw.to_radians());
        // Rounding of quarter turns.
        assert!(found.angle_to(&expected) < 1e-14, "{roll} {pitch} {yaw}: {found}");
    }
}

#[test]
fn all_faults_come_at_once() {
    let bad = description(LINKAGE)
        .replace("effort_nm = [80.0, ", "effort_nm = [")
        .replace("max_force_n = 40.0", "max_force_n = -1.0")
        .replace("floor_z_m = 0.0", "floor_z_m = inf")
        .replace("link = \"upper\"", "link = \"uper\"");
    let error = load(&bad).unwrap_err();
    assert!(error.starts_with("4 faults"), "{error}");
    for expected in ["effort_nm: found 2 numbers", "max_force_n: found -1", "floor_z_m: found inf", "found \"uper\""] {
        assert!(error.contains(expected), "{error}");
    }
}

/// A binary STL file of a box whose header begins with `solid`, as some vendors' do.
fn stl_of_box(half_m: [f32; 3], offset_m: f32) -> Vec<u8> {
    let corner =
        |bits: usize| [0, 1, 2].map(|axis| half_m[axis] * if bits >> axis & 1 == 1 { 1.0 } else { -1.0 } + offset_m);
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let mut bytes = b"solid of a vendor".to_vec();
    bytes.resize(80, b' ');
    bytes.extend(12_u32.to_le_bytes());
    for [a, b, c, d] in quads {
        for triangle in [[a, b, c], [a, c, d]] {
            bytes.extend([0_u8; 12]);
            triangle.iter().for_each(|&bits| corner(bits).iter().for_each(|v| bytes.extend(v.to_le_bytes())));
            bytes.extend([0_u8; 2]);
        }
    }
    bytes
}

#[test]
fn a_mesh_is_as_good_as_the_box_that_it_shows() {
    let folder = tempfile::tempdir().unwrap();
    let meshes = folder.path().join("rail_description/meshes");
    std::fs::create_dir_all(&meshes).unwrap();
    std::fs::write(meshes.join("upper.stl"), stl_of_box([0.025, 0.025, 0.15], 0.0)).unwrap();
    let as_box = "<origin xyz=\"0 0 0.15\"/><geometry><box size=\"0.05 0.05 0.3\"/></geometry>";
    let as_mesh = "<origin xyz=\"0 0 0.15\"/><geometry><mesh filename=\"package://rail_description/meshes/upper.stl\"/></geometry>";
    assert!(urdf().contains(as_box));
    std::fs::write(folder.path().join("rail.urdf"), urdf().replace(as_box, as_mesh)).unwrap();
    std::fs::write(folder.path().join("robot.toml"), description(LINKAGE)).unwrap();
    for decompose in [false, true] {
        let text = description(LINKAGE).replacen('\n', if decompose { "\ndecompose = [\"upper\"]\n" } else { "\n" }, 1);
        std::fs::write(folder.path().join("robot.toml"), text).unwrap();
        let robot = Robot::load("robot.toml", folder.path()).unwrap();
        let upper = &robot.links[robot.link_index("upper").unwrap()];
        let support = |direction: Vector3<f64>| {
            let shapes = upper.shapes.iter().map(|placed| {
                let direction_s = placed.x_ls.rotation.inverse() * direction;
                direction.dot(&placed.x_ls.translation.vector) + placed.shape.support_m(&direction_s)
            });
            shapes.fold(f64::NEG_INFINITY, f64::max)
        };
        let expected = Shape::Box { half_m: [0.025, 0.025, 0.15] };
        for direction in [Vector3::x(), -Vector3::y(), Vector3::z(), Vector3::new(0.48, 0.6, 0.64)] {
            let of_box = direction.z * 0.15 + expected.support_m(&direction);
            // The file has single precision; a decomposition, voxels of 5 mm.
            let tolerance = if decompose { 5e-3 } else { 1e-8 };
            assert!((support(direction) - of_box).abs() < tolerance, "{direction}: {} {of_box}", support(direction));
        }
        assert_eq!(robot.files.len(), 3, "{:?}", robot.files);
    }
    std::fs::remove_file(meshes.join("upper.stl")).unwrap();
    let error = Robot::load("robot.toml", folder.path()).unwrap_err().to_string();
    assert!(error.contains("link upper: mesh: found package://rail_description/meshes/upper.stl, but"), "{error}");
}

#[test]
fn a_slightly_indefinite_inertia_is_mended_with_a_note() {
    let mended = urdf().replacen("ixx=\"0.02\"", "ixx=\"-0.001\"", 1);
    let robot = load_with(&description(LINKAGE), &mended, &RobotOptions::default()).unwrap();
    let inertia = robot.links[0].inertia_l;
    assert!((inertia - nalgebra::Matrix3::from_diagonal(&Vector3::new(0.0, 0.03, 0.01))).amax() < 1e-15, "{inertia}");
    assert_eq!(robot.notes, ["link base: its inertia has the eigenvalue -1.000e-3 kg m^2, which is set to 0"]);
    let wrong = urdf().replacen("ixx=\"0.02\"", "ixx=\"-0.01\"", 1);
    let error = load_with(&description(LINKAGE), &wrong, &RobotOptions::default()).unwrap_err();
    assert!(error.contains("link base: found an inertia with eigenvalue -0.01, expected none below 0"), "{error}");
}

#[test]
fn a_xacro_is_told_how_to_be_expanded() {
    let xacro = urdf().replace("<robot name", "<robot xmlns:xacro=\"http://www.ros.org/wiki/xacro\" name");
    let parts =
        xacro.replacen("<joint name=\"lift\"", "<xacro:macro name=\"lift\"/><!--", 1).replacen("</joint>", "-->", 1);
    let error = load_with(&description(LINKAGE), &parts, &RobotOptions::default()).unwrap_err();
    assert!(error.contains("found 2 links that no joint carries, base, column"), "{error}");
    assert!(error.contains("expand the xacro first: `xacro FILE.xacro -o robot.urdf`"), "{error}");
}

/// Vendors rename joints and forget those that follow them.
#[test]
fn a_joint_that_follows_none_of_the_file_moves_by_itself() {
    let lost = urdf().replace("joint=\"lift\" multiplier=\"0.5\"", "joint=\"hoist\" multiplier=\"0.5\"");
    let robot = load_with(&description(LINKAGE), &lost, &RobotOptions::default()).unwrap();
    let cable = robot.joints.iter().find(|joint| joint.name == "cable").unwrap();
    assert!(cable.mimic.is_none() && cable.rest == 0.0, "{cable:?}");
    let expected = "joint cable mimics hoist, which is no joint of the file; it is taken to move by itself";
    assert_eq!(robot.notes, [expected]);
    let endless = urdf().replace("multiplier=\"0.5\"", "multiplier=\"inf\"");
    let error = load_with(&description(LINKAGE), &endless, &RobotOptions::default()).unwrap_err();
    assert!(error.contains("joint cable: found a mimic with the multiplier inf"), "{error}");
}

/// The links between the axes of one joint often have no mass.
#[test]
fn a_link_between_joints_has_a_mass() {
    let text = urdf();
    let start = text.find("<link name=\"carriage\">").unwrap();
    let end = start + text[start..].find("</link>").unwrap();
    let light = format!("{}<link name=\"carriage\">{}", &text[..start], &text[end..]);
    let robot = load_with(&description(LINKAGE), &light, &RobotOptions::default()).unwrap();
    let carriage = &robot.links[robot.link_index("carriage").unwrap()];
    assert!(carriage.mass_kg > 0.0 && carriage.mass_kg < 0.01);
    assert!(carriage.inertia_l.symmetric_eigenvalues().min() > 0.0);
    assert!(
        matches!(&robot.notes[..], [note] if note.starts_with("link carriage: it has no mass")),
        "{:?}",
        robot.notes
    );
    assert_eq!(rail().notes, Vec::<String>::new());
}

/// A wrong number in the origin of a collision puts a link beside the robot.
#[test]
fn a_displaced_collision_is_noted() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("box.stl"), stl_of_box([0.05, 0.05, 0.05], 0.0)).unwrap();
    let mesh = |origin: &str| format!("<origin xyz=\"{origin}\"/><geometry><mesh filename=\"box.stl\"/></geometry>");
    let place = "<link name=\"idler\">";
    for (origin, is_noted) in [("0 0.1 0", false), ("0 1.57 0", true)] {
        let shapes = format!("{place}<visual>{}</visual><collision>{}</collision>", mesh("0 0 0"), mesh(origin));
        std::fs::write(folder.path().join("rail.urdf"), urdf().replace(place, &shapes)).unwrap();
        std::fs::write(folder.path().join("robot.toml"), description(LINKAGE)).unwrap();
        let robot = Robot::load("robot.toml", folder.path()).unwrap();
        let expected =
            "link idler: its collision mesh box.stl is 1.57 m from where the same mesh is drawn; look at its origin";
        assert_eq!(robot.notes.iter().any(|note| note == expected), is_noted, "{:?}", robot.notes);
    }
}

#[test]
fn joints_that_follow_in_a_circle_are_refused() {
    let circle = urdf().replace("joint=\"lift\" multiplier=\"0.5\"", "joint=\"cable\" multiplier=\"0.5\"");
    let error = load_with(&description(LINKAGE), &circle, &RobotOptions::default()).unwrap_err();
    assert!(error.contains("joint cable: found joints that mimic each other in a circle"), "{error}");
    let led = urdf().replace("joint=\"lift\" multiplier=\"0.5\"", "joint=\"rail\" multiplier=\"0.5\"");
    let error = load_with(&description(LINKAGE), &led, &RobotOptions::default()).unwrap_err();
    assert!(
        error.contains("joints: found cable, which mimics one of them, expected joints of an arm that move no other"),
        "{error}"
    );
}

/// A gripper in place of that of [`description`], which has figures of pads.
fn with_gripper(gripper: &str) -> String {
    let text = description("");
    let start = text.find("max_force_n").unwrap();
    format!("{}{gripper}", &text[..start])
}

const SUCTION: &str = "kind = \"suction\"\nframe_xyz_m = [0.0, 0.0, 0.1]\ncup_diameter_m = 0.06\ncup_height_m = 0.03\n\
    wrench_limits = { shape = \"box\", force_n = [40.0, 40.0, [-60.0, 200.0]], moment_nm = [2.0, 2.0, 1.0] }\n";

#[test]
fn a_suction_cup_ends_at_the_origin_of_its_frame() {
    let robot = load(&with_gripper(SUCTION)).unwrap();
    let gripper = &robot.arms[0].gripper;
    let cup = gripper.cup.unwrap();
    assert_eq!((gripper.fingers.len(), cup.radius_m, gripper.grasp_point_g()), (0, 0.03, Vector3::zeros()));
    let state = ArmState { arm: 0, q_rad: &[0.1, 0.5, 0.3], finger_travel_m: [0.0; 2] };
    let x_wl = robot.link_poses(&robot.positions(&[state]));
    let x_gl = x_wl[gripper.frame_link].inverse() * x_wl[cup.link];
    let placed = &robot.links[cup.link].shapes[0];
    let Shape::Cylinder { radius_m, half_length_m } = placed.shape else { panic!("{:?}", placed.shape) };
    assert_relative_eq!((x_gl * placed.x_ls).translation.vector, Vector3::new(0.0, 0.0, -0.015), epsilon = 1e-15);
    assert_relative_eq!((x_gl * placed.x_ls) * Vector3::z(), Vector3::z(), epsilon = 1e-15);
    assert_eq!((radius_m, half_length_m), (0.03, 0.015));
    assert!(robot.links[cup.link].mass_kg > 0.0);
}

#[test]
fn messages_about_suction_cups_name_key_found_and_expected() {
    let cases = [
        (SUCTION.replace("cup_diameter_m = 0.06\n", ""), "cup_diameter_m: found none, expected 0.002 to 0.5 m"),
        (SUCTION.replace("0.03\n", "0.0\n"), "cup_height_m: found 0, expected 0.002 to 0.5 m"),
        (
            format!("{SUCTION}opening_m = [0.0, 0.05]\n"),
            "opening_m: found a key of two jaws, expected no such key: a suction cup",
        ),
        (format!("{SUCTION}pad_size_m = [0.02, 0.02]\n"), "pad_size_m: found a key of two jaws, expected no such key"),
        (
            SUCTION.lines().filter(|line| !line.starts_with("wrench")).map(|line| format!("{line}\n")).collect(),
            "wrench_limits: found none, expected the measured limits of the suction cup",
        ),
        (format!("{SUCTION}friction = 0.5\n"), "friction: found 0.5, expected no such key beside wrench_limits"),
    ];
    for (gripper, expected) in cases {
        let error = load(&with_gripper(&gripper)).unwrap_err();
        assert!(error.contains(expected), "{error}, expected {expected}");
    }
    let of_jaws = [
        (
            "opening_m = [0.0, 0.05]\npad_centre_m = [0.0, 0.0]\nkind = \"clamp\"\ncup_height_m = 0.1\n",
            "cup_height_m: found 0.1, expected no such key",
        ),
        ("pad_centre_m = [0.0, 0.0]\nkind = \"clamp\"\n", "opening_m: found none, expected the gaps between the pads"),
    ];
    for (gripper, expected) in of_jaws {
        let error = load(&description(gripper)).unwrap_err();
        assert!(error.contains(expected), "{error}, expected {expected}");
    }
}

/// A clamp with measured limits has the jaws of a clamp.
#[test]
fn a_measured_clamp_has_jaws_at_the_gap() {
    let clamp = "kind = \"clamp\"\nframe_xyz_m = [0.0, 0.0, 0.1]\nopening_m = [0.0, 0.05]\npad_size_m = [0.02, 0.02]\n\
        pad_centre_m = [0.01, 0.03]\nwrench_limits = { shape = \"box\", force_n = [90.0, 90.0, 90.0], moment_nm = [5.0, 5.0, 5.0] }\n";
    let robot = load(&with_gripper(clamp)).unwrap();
    let gripper = &robot.arms[0].gripper;
    assert_eq!((gripper.fingers.len(), gripper.opening_m), (2, [0.0, 0.05]));
    assert_eq!(gripper.grasp_point_g(), Vector3::new(0.01, 0.0, 0.03));
    assert_eq!(gripper.holding.measured().unwrap().limits.high.force_n, Vector3::repeat(90.0));
}
