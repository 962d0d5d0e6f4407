//! Plans that leave out what follows from the rest, and the forms of their values.

use std::path::Path;

use benchdog::{
    model::{
        frames::Pose,
        plan::{ArmHold, Plan},
    },
    robot::Chain,
    scenario::{self, read_plan},
};
use serde_json::{Value, json};

use crate::{
    bad_input::{PLAN, assert_refused},
    common::{baxter, root},
    process::{argument, benchdog, folder, json as json_file, stderr},
};

/// The plan of a cut without a person: board, operation and two arms.
fn full() -> Value {
    let mut plan: Value = serde_json::from_str(PLAN).unwrap();
    plan.as_object_mut()
        .unwrap()
        .retain(|key, _| ["format", "name", "robot", "operation", "object", "arms"].contains(&&**key));
    plan
}

/// The plan that a file with these values is read as.
fn read(plan: &Value) -> Result<Plan, String> {
    let folder = folder(&[("plan.json", &plan.to_string())]);
    let path = folder.path().join("plan.json");
    match read_plan(&path, Some(baxter())) {
        Ok((plan, _)) => Ok(plan),
        Err(error) => Err(error.to_string().replace(&format!("{}/", argument(folder.path())), "")),
    }
}

/// `full` with every arm changed.
fn with_arms(mut change: impl FnMut(&mut serde_json::Map<String, Value>)) -> Value {
    let mut plan = full();
    plan["arms"].as_array_mut().unwrap().iter_mut().for_each(|arm| change(arm.as_object_mut().unwrap()));
    plan
}

/// The joints of an arm with their angles, in the reverse order.
fn reversed(arm: &serde_json::Map<String, Value>) -> Vec<(String, Value)> {
    let joints = arm["joints"].as_array().unwrap().iter().map(|joint| joint.as_str().unwrap().to_owned());
    joints.zip(arm["q_rad"].as_array().unwrap().iter().cloned()).rev().collect()
}

fn chain(hold: &ArmHold) -> Chain {
    Chain::new(baxter(), baxter().arm_index(&hold.name).unwrap(), 0.0)
}

/// Largest difference of an entry of two poses as matrices.
fn apart(a: &Pose, b: &Pose) -> f64 {
    (a.to_homogeneous() - b.to_homogeneous()).abs().max()
}

#[test]
fn joints_in_any_order_give_the_same_plan() {
    let expected = read(&full()).unwrap();
    let listed = with_arms(|arm| {
        let reversed = reversed(arm);
        arm["joints"] = reversed.iter().map(|(joint, _)| joint.clone()).collect();
        arm["q_rad"] = reversed.into_iter().map(|(_, angle_rad)| angle_rad).collect();
    });
    let named = with_arms(|arm| {
        arm["q_rad"] = Value::Object(reversed(arm).into_iter().collect());
        arm.remove("joints");
    });
    assert_ne!(listed, full());
    // Bit by bit, so that the traces are equal.
    assert_eq!(read(&listed).unwrap(), expected);
    assert_eq!(read(&named).unwrap(), expected);
}

/// Outline, holes and centre of mass stay; a faulty outline is found before the inverse kinematics needs it.
#[test]
fn values_of_a_plan_for_a_plate_are_filled_in() {
    let mut plan = with_arms(|arm| {
        arm.remove("q_rad");
        arm.remove("joints");
    });
    let [x_m, y_m] = [0, 1].map(|axis: usize| plan["object"]["size_m"][axis].as_f64().unwrap() / 2.0);
    let outline_m = json!([[x_m, -y_m], [x_m, y_m], [-x_m, y_m], [-x_m, -y_m]]);
    let holes_m = json!([[[0.0, 0.0], [0.05, 0.0], [0.0, 0.05]]]);
    plan["object"]["plate"] = json!({"outline_m": outline_m, "holes_m": holes_m});
    plan["object"]["com_m"] = json!([0.01, 0.02, 0.0]);
    let found = read(&plan).unwrap();
    assert_eq!(found.object.com_m, Some([0.01, 0.02, 0.0]));
    assert_eq!(serde_json::to_value(&found.object.plate).unwrap(), plan["object"]["plate"]);
    for hold in &found.arms {
        let reached = chain(hold).gripper_pose(&hold.q_rad);
        // The residual of the inverse kinematics, 1e-9, as entries of matrices.
        assert!(apart(&reached, &(found.object.x_wo * hold.x_og)) < 1e-8);
    }
    plan["object"]["plate"]["outline_m"] = json!([[x_m, -y_m], [-x_m, -y_m], [-x_m, y_m], [x_m, y_m]]);
    let message = read(&plan).unwrap_err();
    assert!(message.starts_with("plan.json:1: object.plate.outline_m: found"), "{message}");
}

/// The trace of the plan with its joints in another order, through the binary, and of the plan that is written.
#[test]
fn the_trace_does_not_depend_on_the_form() {
    let named = with_arms(|arm| {
        arm["q_rad"] = Value::Object(reversed(arm).into_iter().collect());
        arm.remove("joints");
    });
    let poses_only = with_arms(|arm| {
        ["joints", "q_rad", "grip_force_n"].iter().for_each(|key| _ = arm.remove(*key));
    });
    let texts = [full(), named, poses_only].map(|plan| plan.to_string());
    let folder = folder(&[("full.json", &texts[0]), ("named.json", &texts[1]), ("poses.json", &texts[2])]);
    let verdict = |plan: &str, out: &str| {
        let output = benchdog(folder.path(), &["simulate", plan, "--record", "never", "--out", out]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        json_file(&folder.path().join(out).join("cut-rim/verdict.json"))
    };
    let full = verdict("full.json", "1");
    assert_eq!(full["notes"], Value::Null, "nothing is filled in");
    assert_eq!(verdict("named.json", "2"), full);
    let filled_in = verdict("poses.json", "3");
    assert_eq!(
        filled_in["notes"],
        json!([
            "the plan's file leaves out q_rad of left and right: filled in by inverse kinematics, of the answers without a \
             contact the nearest to the middle of the joint ranges",
            "the plan's file leaves out grip_force_n of left and right: the most that the gripper gives",
        ])
    );
    // What was simulated is what was written.
    let again = verdict("3/cut-rim/plan.json", "4");
    assert_eq!((&again["fingerprint"], &again["notes"]), (&filled_in["fingerprint"], &Value::Null));
    let written = json_file(&folder.path().join("3/cut-rim/plan.json"));
    assert_eq!(written["arms"][0]["grip_force_n"], json!(35.0));
    assert_eq!(written["arms"][0]["q_rad"].as_array().unwrap().len(), 7);
}

#[test]
fn grasps_follow_from_angles() {
    let mut expected = read(&full()).unwrap();
    // Exactly by forward kinematics, not within the residual of the planner's inverse kinematics.
    for hold in &mut expected.arms {
        hold.x_og = expected.object.x_wo.inverse() * chain(hold).gripper_pose(&hold.q_rad);
    }
    let plan = read(&with_arms(|arm| _ = arm.remove("x_og"))).unwrap();
    for (hold, expected) in plan.arms.iter().zip(&expected.arms) {
        assert!(apart(&hold.x_og, &expected.x_og) < 1e-12);
        assert_eq!(hold.q_rad, expected.q_rad);
    }
}

#[test]
fn the_boards_pose_follows_from_one_arm_and_the_other_arm_from_the_board() {
    let mut partial = full();
    partial["object"].as_object_mut().unwrap().remove("x_wo");
    partial["arms"][0].as_object_mut().unwrap().remove("q_rad");
    let (plan, expected) = (read(&partial).unwrap(), read(&full()).unwrap());
    // The planner's residual is 1e-9 for the arm, and so is that of the angles that are filled in.
    assert!(apart(&plan.object.x_wo, &expected.object.x_wo) < 1e-8);
    let hold = &plan.arms[0];
    assert!(apart(&chain(hold).gripper_pose(&hold.q_rad), &(plan.object.x_wo * hold.x_og)) < 1e-8);
    partial["arms"][1].as_object_mut().unwrap().remove("q_rad");
    assert_eq!(
        read(&partial).unwrap_err(),
        "plan.json:1: object.x_wo: found nothing, expected a pose, or an arm with both q_rad and x_og"
    );
}

#[test]
fn angles_reach_the_grasps_and_begin_at_the_seed() {
    let expected = read(&full()).unwrap();
    let seeded = with_arms(|arm| {
        let q_rad = arm.remove("q_rad").unwrap();
        arm.insert("seed_rad".into(), q_rad);
    });
    for (hold, expected) in read(&seeded).unwrap().arms.iter().zip(&expected.arms) {
        // The seed is an answer: nothing moves.
        assert!(hold.q_rad.iter().zip(&expected.q_rad).all(|(a, b)| (a - b).abs() < 1e-8));
    }
    let plan = read(&with_arms(|arm| _ = arm.remove("q_rad"))).unwrap();
    for hold in &plan.arms {
        assert!(apart(&chain(hold).gripper_pose(&hold.q_rad), &(plan.object.x_wo * hold.x_og)) < 1e-8);
    }
    assert_ne!(plan.arms[0].q_rad, expected.arms[0].q_rad);
    assert_eq!(plan, read(&with_arms(|arm| _ = arm.remove("q_rad"))).unwrap(), "the same file, the same plan");
}

#[test]
fn the_grip_force_is_the_scenarios_or_the_grippers() {
    let partial = with_arms(|arm| _ = arm.remove("grip_force_n"));
    assert_eq!(read(&partial).unwrap().arms[0].grip_force_n, 35.0);
    let folder = folder(&[("plan.json", &partial.to_string())]);
    let cut = root().join("scenarios/cut-rim.toml");
    let loaded = scenario::load_plan(&folder.path().join("plan.json"), Some(&cut)).unwrap();
    assert_eq!(loaded.plan.arms[0].grip_force_n, loaded.scenario.grip.force_n);
    assert_ne!(loaded.scenario.grip.force_n, 35.0);
    assert_eq!(
        loaded.filled_in,
        ["the plan's file leaves out grip_force_n of left and right: the scenario's grip.force_n"]
    );
}

#[test]
fn every_form_of_a_pose_gives_the_same_plan() {
    let expected = read(&full()).unwrap();
    let forms: [fn(&Pose) -> Value; 2] = [
        |pose| {
            let matrix = pose.to_homogeneous();
            let rows: Vec<Vec<f64>> = matrix.row_iter().map(|row| row.iter().copied().collect()).collect();
            json!({"matrix": rows})
        },
        |pose| {
            let (roll, pitch, yaw) = pose.rotation.euler_angles();
            let xyz_m: [f64; 3] = pose.translation.vector.into();
            json!({"xyz_m": xyz_m, "rpy_rad": [roll, pitch, yaw]})
        },
    ];
    for form in forms {
        let mut plan = full();
        plan["object"]["x_wo"] = form(&expected.object.x_wo);
        plan["operation"]["x_ot"] = form(&expected.operation.x_ot);
        for (arm, hold) in plan["arms"].as_array_mut().unwrap().iter_mut().zip(&expected.arms) {
            arm["x_og"] = form(&hold.x_og);
        }
        let plan = read(&plan).unwrap();
        // Some of these poses have a pitch near a quarter turn, where half of the digits are lost.
        assert!(apart(&plan.object.x_wo, &expected.object.x_wo) < 1e-7);
        assert!(apart(&plan.operation.x_ot, &expected.operation.x_ot) < 1e-7);
        assert!(plan.arms.iter().zip(&expected.arms).all(|(a, b)| apart(&a.x_og, &b.x_og) < 1e-7));
    }
}

/// A plan with this arm, which is on line 7.
fn plan_with(arm: &str) -> String {
    let plan = full();
    format!(
        "{{\"format\": 1,\n\"name\": \"bad\",\n\"robot\": \"baxter\",\n\"operation\": {},\n\"object\": {},\n\"arms\": [\n{arm}\n]}}\n",
        plan["operation"], plan["object"]
    )
}

#[track_caller]
fn assert_arm_refused(arm: &str, message: &str) {
    let folder = folder(&[("bad.json", &plan_with(arm))]);
    let output = benchdog(folder.path(), &["simulate", "bad.json", "--junit", "junit.xml"]);
    assert_refused(&output, message);
    assert!(!folder.path().join("junit.xml").exists());
}

#[test]
fn malformed_angles() {
    let joints = "left_s0, left_s1, left_e0, left_e1, left_w0, left_w1, left_w2";
    let named = r#""left_s0": 0, "left_s1": 0, "left_e0": 0, "left_e1": 0, "left_w0": 0, "left_w1": 0"#;
    for (arm, message) in [
        (
            format!(r#"{{"name": "left", "q_rad": {{{named}, "left_x": 0}}}}"#),
            format!(
                "bad.json:7: arms[0].q_rad.left_x: found \"left_x\", expected the joints of the left arm: {joints}; did you mean \"left_s0\"?"
            ),
        ),
        (
            format!(r#"{{"name": "left", "q_rad": {{{named}}}}}"#),
            format!(
                "bad.json:7: arms[0].q_rad: found no angle of left_w2, expected the joints of the left arm: {joints}"
            ),
        ),
        (
            format!(r#"{{"name": "left", "q_rad": {{{named}, "left_s0": 0}}}}"#),
            "bad.json:7: arms[0].q_rad: found the joint left_s0 again, expected every joint once".into(),
        ),
        (
            format!(r#"{{"name": "left", "q_rad": {{{named}, "left_w2": 7.5}}}}"#),
            "bad.json:7: arms[0].q_rad.left_w2: found 7.5, expected -3.059 to 3.059 rad, the limits of left_w2".into(),
        ),
        (
            r#"{"name": "left", "q_rad": [0, 0, 0, 0, 0, 0, 0]}"#.into(),
            "bad.json:7: arms[0].q_rad: found a list of angles without joints, expected the key `joints` with their order, or \
             an object of joints with their angles"
                .into(),
        ),
        (
            r#"{"name": "left", "q_rad": 0}"#.into(),
            "bad.json:7: arms[0].q_rad: invalid type: integer `0`, expected a list of angles in rad, or an object of joints \
             with their angles"
                .into(),
        ),
        (
            r#"{"name": "left"}"#.into(),
            "bad.json:7: arms[0]: found neither q_rad nor x_og, expected at least one of them".into(),
        ),
        (
            format!(r#"{{"name": "left", "q_rad": {{{named}, "left_w2": 0}}, "seed_rad": {{{named}, "left_w2": 0}}}}"#),
            "bad.json:7: arms[0].seed_rad: found angles, expected none: it belongs to an arm without q_rad".into(),
        ),
        (
            r#"{"name": "left", "q_rad": {"left_s0": NaN}}"#.into(),
            "bad.json:7: arms[0].q_rad.left_s0: expected value".into(),
        ),
    ] {
        assert_arm_refused(&arm, &message);
    }
}

#[test]
fn joints_that_are_listed_twice() {
    crate::bad_input::assert_plan_refused(
        "\"left_s1\"",
        "\"left_s0\"",
        "bad.json:53: arms[0].joints: found left_s0, left_s0, left_e0, left_e1, left_w0, left_w1, left_w2, expected the joints \
         of the left arm: left_s0, left_s1, left_e0, left_e1, left_w0, left_w1, left_w2",
    );
}

#[test]
fn malformed_or_unreachable_grasps() {
    let forms = "expected one of: translation_m with rotation_xyzw; matrix; xyz_m with rpy_rad";
    for (x_og, message) in [
        (
            r#"{"xyz_m": [0, 0, 0], "rotation_xyzw": [0, 0, 0, 1]}"#,
            format!("bad.json:7: arms[0].x_og: found a pose with the keys rotation_xyzw, xyz_m, {forms}"),
        ),
        (
            r#"{"matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 2, 0], [0, 0, 0, 1]]}"#,
            "bad.json:7: arms[0].x_og: found a matrix R with R' R off the unit matrix by 3.0e0, expected a rotation, within \
             1e-5"
                .into(),
        ),
        (
            r#"{"xyz_m": [3, 0, 0], "rpy_rad": [1.5707963267948966, 0, 0]}"#,
            "bad.json:7: arms[0].x_og: found a gripper 3.293 m from the shoulder of an arm that reaches at most 1.414 m, \
             expected a pose that the left arm reaches within its joint limits"
                .into(),
        ),
        (
            r#"{"xyz_m": [-0.2, -0.16, 0], "rpy_rad": [1.5707963267948966, 0, 0]}"#,
            "bad.json:7: arms[0].x_og: found a pose without an answer of the inverse kinematics, expected a pose that the left \
             arm reaches within its joint limits"
                .into(),
        ),
    ] {
        assert_arm_refused(&format!(r#"{{"name": "left", "x_og": {x_og}}}"#), &message);
    }
}

#[test]
fn other_formats_get_a_hint() {
    let folder = folder(&[("grasps.yaml", "format: isaac_grasp\ngrasps: {}\n"), ("a.toml", "format = 1\n")]);
    let refused = |plan: &str, message: &str| {
        assert_refused(&benchdog(folder.path(), &["simulate", plan]), message);
    };
    refused(
        "grasps.yaml",
        "grasps.yaml: found YAML, expected a plan in JSON; `benchdog import` makes a plan of grasps in YAML",
    );
    refused("a.toml", "a.toml: found TOML, expected a plan in JSON; a scenario is given to `benchdog run`");
    assert!(Path::new(&folder.path().join("a.toml")).exists());
}
