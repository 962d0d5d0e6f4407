//! `benchdog import`: plans of the grasps of other planners, judged.

use std::path::Path;

use benchdog::scenario::read_plan;

use crate::{
    bad_input::{PLAN, assert_refused},
    common::{baxter, root},
    process::{benchdog, contents, folder, json, stderr},
};

/// Grasps of `cut-rim.json`, as Isaac Sim and ROS write them.
const ISAAC: &str = include_str!("../data/import/board.isaac_grasp.yaml");
const MOVEIT: &str = include_str!("../data/import/board.moveit_grasp.yaml");
const CUT: &str = include_str!("../../scenarios/cut-rim.toml");

/// The gripper frame of the ROS file: x out of the gripper, its origin 0.1 m behind ours.
const ROS_GRIPPER: &str = "0.1 0 0 0 1.5707963267948966 0";

fn files() -> tempfile::TempDir {
    folder(&[("isaac.yaml", ISAAC), ("moveit.yaml", MOVEIT), ("cut.toml", CUT)])
}

/// The pose of the board in `cut-rim.json`.
fn board_pose() -> String {
    let x_wo = read_plan(&root().join("scenarios/plans/cut-rim.json"), Some(baxter())).unwrap().0.object.x_wo;
    let numbers = x_wo.translation.vector.iter().chain(x_wo.rotation.coords.iter());
    numbers.map(ToString::to_string).collect::<Vec<_>>().join(" ")
}

/// Imports grasps into `plan.json` and returns what is printed.
fn import(folder: &Path, arguments: &[&str]) -> String {
    let common = ["--scenario", "cut.toml", "-o", "plan.json"];
    let output = benchdog(folder, &[&["import"], arguments, &common].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    String::from_utf8(output.stdout).unwrap()
}

/// Simulates `plan.json` and returns the verdict.
fn judged(folder: &Path) -> String {
    let output = benchdog(folder, &["simulate", "plan.json", "--record", "never"]);
    assert!(output.status.success(), "{}", stderr(&output));
    json(&folder.join("out/cut-rim/verdict.json"))["verdict"].as_str().unwrap().to_owned()
}

/// The imported plan has the grasps, the board and the grip of the original, to the six digits of the files.
fn assert_is_cut_rim(folder: &Path) {
    let imported = read_plan(&folder.join("plan.json"), Some(baxter())).unwrap().0;
    let original: benchdog::model::plan::Plan = serde_json::from_str(PLAN).unwrap();
    assert_eq!((imported.object, imported.operation.wrench_o), (original.object, original.operation.wrench_o));
    for (imported, original) in imported.arms.iter().zip(&original.arms) {
        assert_eq!((&imported.name, imported.grip_force_n), (&original.name, original.grip_force_n));
        let off = imported.x_og.inverse() * original.x_og;
        // Rounding of three numbers by half a digit each, and of a quaternion, 0.1 m away.
        assert!(off.translation.vector.norm() < 2e-6 && off.rotation.angle() < 4e-6, "{off:?}");
    }
}

#[test]
fn grasps_of_isaac_are_judged() {
    let folder = files();
    let pose = board_pose();
    let two = ["isaac.yaml", "--arm", "left=grasp_0", "--arm", "right=grasp_2"];
    let printed = import(folder.path(), &[&two[..], &["--board-pose", &pose]].concat());
    assert_eq!(
        printed,
        "left: grasp_0, a pose in the frame board, confidence 0.97\n\
         right: grasp_2, a pose in the frame board, confidence 0.93\n\
         the board's pose: --board-pose\n"
    );
    assert_is_cut_rim(folder.path());
    assert_eq!(judged(folder.path()), "holds");
}

#[test]
fn grasps_of_moveit_are_judged() {
    let folder = files();
    let pose = board_pose();
    let two = ["moveit.yaml", "--arm", "left=left_edge", "--arm", "right=right_edge", "--gripper-frame", ROS_GRIPPER];
    import(folder.path(), &[&two[..], &["--board-pose", &pose]].concat());
    assert_is_cut_rim(folder.path());
    assert_eq!(judged(folder.path()), "holds");
}

#[test]
fn a_pose_of_the_board_is_found() {
    let folder = files();
    for (arms, verdict) in [
        (&["--arm", "left=grasp_0", "--arm", "right=grasp_2"][..], "holds"),
        // The cut's 30 N act 0.2 m from the one pair of pads, which two times 30 N at a friction of 0.6 over 20 mm cannot resist.
        (&["--arm", "right=grasp_2"], "pivots"),
    ] {
        let printed = import(folder.path(), &[&["isaac.yaml"], arms].concat());
        assert!(printed.contains("the first of the search domain that the arms reach"), "{printed}");
        let first = contents(folder.path());
        import(folder.path(), &[&["isaac.yaml"], arms].concat());
        assert!(contents(folder.path()) == first, "the same files, the same plan");
        let output = benchdog(folder.path(), &["simulate", "plan.json", "--record", "never"]);
        assert!([Some(0), Some(1)].contains(&output.status.code()), "{}", stderr(&output));
        assert_eq!(json(&folder.path().join("out/cut-rim/verdict.json"))["verdict"], verdict);
        std::fs::remove_dir_all(folder.path().join("out")).unwrap();
    }
}

/// A plan of each grasp, as if each were imported alone.
#[test]
fn all_grasps_of_a_file() {
    let folder = files();
    let all = |arguments: &[&str]| {
        let common = ["import", "isaac.yaml", "--scenario", "cut.toml", "-o", "plans", "--all"];
        let output = benchdog(folder.path(), &[&common, arguments].concat());
        (output.status.code(), String::from_utf8(output.stdout).unwrap())
    };
    let (code, printed) = all(&["left", "--arm", "right=grasp_2"]);
    assert_eq!(code, Some(0), "{printed}");
    let lines: Vec<&str> = printed.lines().collect();
    assert!(lines[0].starts_with("wrote plans/grasp_0.json: right: grasp_2"), "{printed}");
    assert!(lines[1].starts_with("left out grasp_1: isaac.yaml:18: grasps.grasp_1: found fingers"), "{printed}");
    assert_eq!(lines.len(), 2);
    let plan = |path: &str| read_plan(&folder.path().join(path), Some(baxter())).unwrap().0;
    import(folder.path(), &["isaac.yaml", "--arm", "right=grasp_2", "--arm", "left=grasp_0"]);
    let (mut one, alone) = (plan("plans/grasp_0.json"), plan("plan.json"));
    assert_eq!(one.name, "cut-rim-grasp_0");
    one.name.clone_from(&alone.name);
    assert_eq!(one, alone);
    // None is left if every grasp is left out.
    std::fs::remove_dir_all(folder.path().join("plans")).unwrap();
    let (code, printed) = all(&["left", "--arm", "right=grasp_2", "--board-pose", "5 0 0 0 0 0"]);
    assert_eq!((code, printed.matches("left out").count()), (Some(3), 2), "{printed}");
    let (code, _) = all(&["middle"]);
    assert_eq!(code, Some(2));
}

/// Plans of names that are one file name are refused before one is written.
#[test]
fn all_grasps_have_files_of_their_own() {
    let folder = files();
    std::fs::write(folder.path().join("isaac.yaml"), ISAAC.replace("grasp_0", "a b").replace("grasp_1", "a/b"))
        .unwrap();
    let before = contents(folder.path());
    let arguments = ["import", "isaac.yaml", "--scenario", "cut.toml", "-o", "plans", "--all", "left"];
    assert_refused(
        &benchdog(folder.path(), &arguments),
        "isaac.yaml:18: grasps.a/b: found a name whose plan is a-b.json, as that of a b, expected names that differ in letters, digits, `-`, `_` or `.`",
    );
    assert!(contents(folder.path()) == before);
}

/// The same grasp as a pose in the world: of the file's board frame at the board's pose.
#[test]
fn poses_in_the_world() {
    let folder = files();
    let arms = ["--arm", "left=grasp_0", "--arm", "right=grasp_2"];
    let in_place = "0 0 0 0 0 0";
    let unmoved = import(folder.path(), &[&["isaac.yaml", "--board-pose", &board_pose()], &arms[..]].concat());
    let expected = read_plan(&folder.path().join("plan.json"), Some(baxter())).unwrap().0;
    assert!(unmoved.contains("board"));
    // In W instead, with the poses of the grasps there.
    let mut text = String::from("format: isaac_grasp\nobject_frame_link: base\ngrasps:\n");
    for (name, hold) in ["grasp_0", "grasp_2"].iter().zip(&expected.arms) {
        let x_wg = expected.object.x_wo * hold.x_og;
        let [x, y, z]: [f64; 3] = x_wg.translation.vector.into();
        let [qx, qy, qz, qw]: [f64; 4] = x_wg.rotation.coords.into();
        text += &format!(
            "  {name}:\n    position: [{x}, {y}, {z}]\n    orientation: {{w: {qw}, xyz: [{qx}, {qy}, {qz}]}}\n"
        );
    }
    std::fs::write(folder.path().join("world.yaml"), text).unwrap();
    import(
        folder.path(),
        &[
            &["world.yaml", "--world-frame", "base", "--board-pose", &board_pose(), "--object-frame", in_place],
            &arms[..],
        ]
        .concat(),
    );
    let of_world = read_plan(&folder.path().join("plan.json"), Some(baxter())).unwrap().0;
    for (a, b) in of_world.arms.iter().zip(&expected.arms) {
        let off = a.x_og.inverse() * b.x_og;
        // Rounding of two products of poses of about 1 m.
        assert!(off.translation.vector.norm() < 1e-12 && off.rotation.angle() < 1e-7);
    }
}

/// The board is that of the scenario: with its outline, its holes and its centre of mass.
#[test]
fn grasps_of_a_plate() {
    let folder = files();
    let plate = "[object]\nthickness_m = 0.030\nholes = [{ centre_m = [0.0, 0.0], radius_m = 0.05 }]\n\
                 com_m = [0.01, 0.0, 0.0]\n\
                 outline_m = [[0.25, -0.2], [0.25, 0.2], [-0.2, 0.2], [-0.25, 0.1], [-0.25, -0.2]]\n";
    std::fs::write(folder.path().join("cut.toml"), format!("{CUT}\n{plate}")).unwrap();
    let arms = ["isaac.yaml", "--arm", "left=grasp_0", "--arm", "right=grasp_2"];
    for pose in [None, Some(board_pose())] {
        let of_pose: Vec<&str> = pose.iter().flat_map(|pose| ["--board-pose", pose]).collect();
        import(folder.path(), &[&arms[..], &of_pose].concat());
        let object = read_plan(&folder.path().join("plan.json"), Some(baxter())).unwrap().0.object;
        let read = object.plate.unwrap();
        assert_eq!((read.sides().len(), read.holes_m().len(), object.com_m), (5, 1, Some([0.01, 0.0, 0.0])));
    }
}

#[test]
fn what_cannot_be_imported() {
    let folder = files();
    let before = contents(folder.path());
    let refused = |arguments: &[&str], message: &str| {
        let common = ["import", "--scenario", "cut.toml", "-o", "plan.json"];
        assert_refused(&benchdog(folder.path(), &[&common, arguments].concat()), message);
        assert!(contents(folder.path()) == before);
    };
    refused(
        &["isaac.yaml", "--arm", "left=grasp_9"],
        "--arm left=grasp_9: found another grasp, expected a grasp of isaac.yaml: grasp_0, grasp_1, grasp_2",
    );
    refused(
        &["isaac.yaml", "--arm", "middle=grasp_0"],
        "--arm middle=grasp_0: found another arm, expected an arm of the robot: left, right",
    );
    refused(
        &["isaac.yaml", "--arm", "left=grasp_0", "--arm", "left=grasp_2"],
        "--arm left=grasp_2: found the arm again, expected every arm once",
    );
    refused(
        &["isaac.yaml", "--arm", "left=grasp_1"],
        "isaac.yaml:18: grasps.grasp_1: found fingers 100.00 mm and 90.00 degrees off the board's middle plane, expected \
         fingers that close across the thickness, within 1 mm and 0.1 degrees; see --gripper-frame and --object-frame",
    );
    refused(
        &["isaac.yaml", "--arm", "left=grasp_0", "--board-pose", "5 0 0 0 0 0"],
        "isaac.yaml:10: grasps.grasp_0: found a gripper 4.730 m from the shoulder of an arm that reaches at most 1.414 m, \
         expected a pose that the left arm reaches within its joint limits",
    );
    refused(
        &["moveit.yaml", "--arm", "left=left_edge", "--gripper-frame", "0 0 0 0 0 0.1"],
        "moveit.yaml:1: left_edge.grasp_pose: found fingers 0.00 mm and 5.73 degrees off the board's middle plane, expected \
         fingers that close across the thickness, within 1 mm and 0.1 degrees; see --gripper-frame and --object-frame",
    );
    refused(
        &["cut.toml", "--arm", "left=grasp_0"],
        "cut.toml: found no keys, expected `format: isaac_grasp` with `grasps`, messages of moveit_msgs/Grasp with \
         `grasp_pose`, or 4x4 matrices",
    );
}

#[test]
fn a_file_that_limits_the_force_below_the_scenarios() {
    let folder =
        folder(&[("a.yaml", &MOVEIT.replace("max_contact_force: 35.0", "max_contact_force: 5.0")), ("cut.toml", CUT)]);
    let arguments =
        ["import", "a.yaml", "--scenario", "cut.toml", "--arm", "left=left_edge", "--gripper-frame", ROS_GRIPPER];
    assert_refused(
        &benchdog(folder.path(), &arguments),
        "a.yaml:1: left_edge.grasp_pose: found a largest force of 5 N, expected at least 30 N, the scenario's grip.force_n",
    );
}

#[test]
fn import_does_not_overwrite_its_inputs() {
    for file in ["isaac.yaml", "cut.toml"] {
        let folder = files();
        let before = contents(folder.path());
        let output = benchdog(
            folder.path(),
            &["import", "isaac.yaml", "--scenario", "cut.toml", "--arm", "left=grasp_0", "-o", file],
        );
        assert_refused(&output, &format!("failed to write {file}: it is an input file of this command"));
        assert!(contents(folder.path()) == before);
    }
}

/// Where two arms cannot reach: both grasps at one place.
#[test]
fn grasps_that_no_pose_of_the_board_allows() {
    let folder = files();
    let arguments = [
        "import",
        "isaac.yaml",
        "--scenario",
        "cut.toml",
        "--arm",
        "left=grasp_0",
        "--arm",
        "right=grasp_0",
        "-o",
        "p.json",
    ];
    let output = benchdog(folder.path(), &arguments);
    assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));
    assert_eq!(
        stderr(&output),
        "cut-rim: no feasible plan: none of 10000 poses of the board lets the arms reach these grasps without a contact\n"
    );
    assert!(!folder.path().join("p.json").exists());
}
