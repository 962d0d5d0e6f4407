//! Robots with very many links or shapes, and deep URDFs.

use std::{
    fs,
    time::{Duration, Instant},
};

use tempfile::TempDir;

use crate::process::{benchdog, folder, stderr};

const ROBOT: &str = include_str!("../../assets/baxter.toml");
const URDF: &str = include_str!("../../assets/baxter.urdf");
const SHAPE: &str = "<collision><geometry><box size=\"0.002 0.002 0.002\"/></geometry></collision>";

/// A folder with a built-in robot that has more elements in its URDF.
fn robot_with(elements: &str) -> TempDir {
    folder(&[("robot.toml", ROBOT), ("baxter.urdf", &URDF.replacen("</robot>", &format!("{elements}</robot>"), 1))])
}

/// Links with this inside, each fixed to the link that `parent` names.
fn links(count: usize, inside: &str, parent: impl Fn(usize) -> String) -> String {
    let link = |number: usize| {
        let parent = parent(number);
        format!(
            "<link name=\"extra{number}\">{inside}</link>\n<joint name=\"of{number}\" type=\"fixed\"><parent link=\"{parent}\"/>\
             <child link=\"extra{number}\"/><origin xyz=\"{} {} -0.4\"/></joint>\n",
            number as f64 * 1e-4,
            number as f64 * -5e-5
        )
    };
    (0..count).map(link).collect()
}

fn chain(number: usize) -> String {
    if number == 0 { "base".to_owned() } else { format!("extra{}", number - 1) }
}

#[test]
fn a_chain_longer_than_the_stack_is_refused_and_a_long_one_is_read() {
    let folder = robot_with(&links(15_000, "", chain));
    let output = benchdog(folder.path(), &["robot", "new", "baxter.urdf", "-o", "new.toml"]);
    assert_eq!(output.status.code(), Some(2));
    let expected = "error: baxter.urdf: found 15056 links, expected at most 4000\n";
    assert_eq!(stderr(&output), expected);
    let folder = robot_with(&links(3900, "", chain));
    let output = benchdog(folder.path(), &["doctor", "robot.toml"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(String::from_utf8_lossy(&output.stdout).contains("3956 links"));
}

#[test]
fn elements_nested_deeper_than_the_stack_are_refused() {
    let folder = robot_with(&"<a>".repeat(200_000));
    let output = benchdog(folder.path(), &["robot", "new", "baxter.urdf", "-o", "new.toml"]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    let line = URDF.lines().count();
    let expected = format!("error: baxter.urdf: found elements nested 65 deep in line {line}, expected at most 64\n");
    assert_eq!(stderr(&output), expected);
}

/// It took minutes: all pairs of boxes that are fixed to each other were compared with all pairs that are not.
#[test]
fn a_robot_with_thousands_of_boxes_is_read_in_seconds() {
    let folder = robot_with(&links(2000, SHAPE, |_| "base".to_owned()));
    let start = Instant::now();
    let output = benchdog(folder.path(), &["doctor", "robot.toml"]);
    let elapsed = start.elapsed();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(elapsed < Duration::from_secs(20), "{elapsed:?}");
    let many = robot_with(&format!("<link name=\"many\">{}</link>", SHAPE.repeat(10_001)));
    let output = benchdog(many.path(), &["doctor", "robot.toml"]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.starts_with("WRONG  baxter.urdf: found 10") && text.contains("collision shapes"), "{text}");
    assert_eq!(output.status.code(), Some(2));
    assert!(fs::exists(many.path().join("baxter.urdf")).unwrap());
}
