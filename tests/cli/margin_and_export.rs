//! The commands `margin` and `export`.

use std::fs;

use benchdog::{model::GRAVITY_W, robot::Robot, scenario::read_plan};
use quick_xml::{Reader, events::Event};
use serde_json::Value;

use crate::{
    common::root,
    process::{argument, benchdog, stderr},
};

/// Runs benchdog in the repository; returns all that it prints, and the exit code.
fn printed(arguments: &[&str]) -> (String, Option<i32>) {
    let output = benchdog(root(), arguments);
    (String::from_utf8_lossy(&output.stdout).into_owned() + &stderr(&output), output.status.code())
}

#[test]
fn a_margin_agrees_with_the_predictions() {
    let (text, code) = printed(&["margin", "tests/data/holds/cut-04.json", "--format", "json"]);
    assert_eq!(code, Some(0), "{text}");
    let margin: Value = serde_json::from_str(&text).unwrap();
    let number = |value: &Value| value.as_f64().unwrap();
    let (holds, fails) = (number(&margin["load_factor"]), number(&margin["fails_at"]));
    assert!(fails > holds && fails - holds <= 1e-3 * fails);
    assert_eq!(margin["ended_by"], "pivots");
    // The failed check exceeds its limit at the failing load.
    assert_eq!(margin["check"]["name"], "slip_rotation");
    assert!(number(&margin["check"]["value"]) > number(&margin["check"]["limit"]));
    let predicted = &margin["predicted"];
    // The load factor is an upper bound; the compliant one is accurate to 10 %.
    assert!(holds < number(&predicted["best_case"]));
    assert!((number(&predicted["compliant"]) / holds - 1.0).abs() < 0.1);
}

#[test]
fn a_margin_below_one_is_exit_code_1() {
    let (text, code) = printed(&["margin", "scenarios/plans/long-lever.json"]);
    assert_eq!(code, Some(1), "{text}");
    assert!(text.contains("FAIL") && text.contains("then deflects (deflection "), "{text}");
}

/// A person who does not see the work is no margin of the load.
#[test]
fn a_plan_whose_person_does_not_see_the_work_has_no_margin() {
    let plan = "scenarios/plans/looks-down.json";
    let (text, code) = printed(&["margin", plan]);
    assert_eq!(code, Some(1), "{text}");
    assert!(text.contains("not_visible: human.posture.view_deg: found 91"), "{text}");
    assert!(text.contains("not_visible: human.posture.face_elevation_deg: found -51.964"), "{text}");
    let (text, code) = printed(&["margin", plan, "--scenario", "scenarios/fails-not-visible.toml"]);
    assert_eq!(code, Some(0), "{text}");
}

#[test]
fn a_margin_says_what_larger_limits_and_uncertainty_change() {
    let folder = tempfile::tempdir().unwrap();
    let plan = "tests/data/holds/cut-04.json";
    let scenario = folder.path().join("slippery.toml");
    // The plan's operation, with slippery pads.
    let text = r#"
        format = 1
        name = "slippery"
        operation = { kind = "cut", point_m = [0.04592201188381078, 0.1108655439013544], direction_o = [-27.716385975338603, 11.480502970952696, 0.0], force_n = 30.0 }
        uncertainty = { friction_scale = 0.8 }
    "#;
    fs::write(&scenario, text).unwrap();
    let (text, _) = printed(&["margin", plan, "--scenario", argument(&scenario), "--format", "json"]);
    let margin: Value = serde_json::from_str(&text).unwrap();
    let predicted = &margin["predicted"];
    let number = |value: &Value| value.as_f64().unwrap();
    let (best, bound) = (number(&predicted["best_case"]), number(&predicted["best_case_bound"]));
    // The certificate bounds the best case, and tightly.
    assert!(bound >= best - 1e-5 * best && bound <= best + 1e-4 * best, "{best} {bound}");
    let robust = &predicted["robust"];
    assert_eq!(number(&robust["friction_scale"]), 0.8);
    assert!(number(&robust["load_factor"]) < best && number(&robust["load_factor"]) > 0.0, "{robust}");
    let gains: Vec<f64> =
        predicted["gains"].as_array().unwrap().iter().map(|gain| number(&gain["load_factor"])).collect();
    assert!(!gains.is_empty() && gains.is_sorted_by(|one, other| one >= other), "{gains:?}");
}

/// All start tags of a document with their attributes; panics if it is not well formed.
fn elements(text: &str) -> Vec<(String, Vec<(String, String)>)> {
    let mut reader = Reader::from_str(text);
    let mut found = Vec::new();
    loop {
        match reader.read_event().unwrap() {
            Event::Eof => return found,
            Event::Start(tag) | Event::Empty(tag) => {
                let name = String::from_utf8(tag.name().as_ref().to_vec()).unwrap();
                let attributes = tag.attributes().map(|attribute| {
                    let attribute = attribute.unwrap();
                    let key = String::from_utf8(attribute.key.as_ref().to_vec()).unwrap();
                    (key, String::from_utf8(attribute.value.to_vec()).unwrap())
                });
                found.push((name, attributes.collect()));
            }
            _ => {}
        }
    }
}

fn numbers(text: &str) -> Vec<f64> {
    text.split(' ').map(|number| number.parse().unwrap()).collect()
}

#[test]
fn an_exported_scene_has_the_masses_joints_gains_and_load_of_the_plan() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("scene.xml");
    let (text, code) = printed(&["export", "scenarios/plans/cut-rim.json", "--mjcf", argument(&file)]);
    assert_eq!(code, Some(0), "{text}");
    let found = elements(&fs::read_to_string(&file).unwrap());
    let of = |name: &str| found.iter().filter(|element| element.0 == name).map(|e| &e.1).collect::<Vec<_>>();
    let get = |attributes: &[(String, String)], key: &str| {
        attributes.iter().find(|(name, _)| name == key).map(|(_, value)| value.clone()).unwrap()
    };
    let (plan, robot) = read_plan(&root().join("scenarios/plans/cut-rim.json"), None).unwrap();

    let mass_kg: f64 = of("inertial").iter().map(|inertial| get(inertial, "mass").parse::<f64>().unwrap()).sum();
    let expected_kg = moving_mass_kg(&robot) + plan.object.mass_kg;
    assert!((mass_kg - expected_kg).abs() < 1e-12 * expected_kg, "{mass_kg} {expected_kg}");
    assert_eq!(numbers(&get(of("option")[0], "gravity")), GRAVITY_W.as_slice());

    let servos = of("general");
    assert_eq!(servos.len(), 14);
    let arm = &robot.arms[robot.arm_index("left").unwrap()];
    let left: Vec<f64> = servos.iter().take(7).map(|servo| get(servo, "gainprm").parse().unwrap()).collect();
    assert_eq!(left, arm.stiffness_nm_rad);
    // Two fingers a hand, and force and moment of the tool along three axes.
    assert_eq!(of("motor").len(), 4 + 6);

    // The full load in the middle of the hold: 0.5 s settle, 1 s ramp, 0.5 s hold at 2 ms.
    let load = of("numeric").into_iter().filter(|numeric| get(numeric, "name").starts_with("tool_wrench_o "));
    let rows: Vec<f64> = load.flat_map(|numeric| numbers(&get(numeric, "data"))).collect();
    let wrench: [f64; 6] = plan.operation.wrench_o.into();
    assert_eq!(rows[6 * 1000..6 * 1001], wrench);
    assert_eq!(rows[6 * 250..6 * 251], [0.0; 6]);
    // Nine joints per arm and the board's seven numbers; the plan's angles come first.
    let positions = numbers(&get(of("key")[0], "qpos"));
    assert_eq!(positions.len(), 25);
    assert_eq!(positions[..7], plan.arms[0].q_rad[..]);
}

/// Mass of all links that arm and finger joints move, kg.
fn moving_mass_kg(robot: &Robot) -> f64 {
    let moves = |joint: usize| {
        robot
            .arms
            .iter()
            .any(|arm| arm.joints.contains(&joint) || arm.gripper.fingers.iter().any(|finger| finger.joint == joint))
    };
    let is_moved = |mut link: usize| {
        while let Some(joint) = robot.links[link].parent_joint {
            if moves(joint) {
                return true;
            }
            link = robot.joints[joint].parent_link;
        }
        false
    };
    (0..robot.links.len()).filter(|&link| is_moved(link)).map(|link| robot.links[link].mass_kg).sum()
}
