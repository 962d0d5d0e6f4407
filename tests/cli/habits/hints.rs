//! Files of another format: what to do with them.

use crate::{
    bad_input::{PLAN, SCENARIO, assert_refused},
    process::{benchdog, folder},
};

const XACRO: &str = "<robot xmlns:xacro=\"http://www.ros.org/wiki/xacro\" name=\"arm\"/>\n";
const URDF: &str = "<?xml version=\"1.0\"?>\n<robot name=\"arm\"/>\n";

#[test]
fn a_file_of_another_format_has_a_hint() {
    let yaml = "# a scenario\nformat: 1\nname: drill\noperation:\n  kind: drill\n";
    let robot = |file: &str| SCENARIO.replace("[grip]", &format!("[robot]\ndescription = \"{file}\"\n\n[grip]"));
    let folder = folder(&[
        ("s.yaml", yaml),
        ("s.toml", yaml),
        ("plan.json", PLAN),
        ("other.json", "{\"a\": 1}"),
        ("arm.urdf.xacro", XACRO),
        ("arm.urdf", URDF),
        ("a.rrd", "RRF2 and so on"),
        ("urdf.toml", &robot("arm.urdf")),
        ("xacro.toml", &robot("arm.urdf.xacro")),
        ("yaml.toml", &robot("arm.yaml")),
        ("scenario.toml", SCENARIO),
    ]);
    let in_toml = "found YAML, expected a scenario in TOML: `format: 1` is `format = 1`";
    let new = "--scenario scenario.toml` writes a robot and a scenario";
    let unknown = "expected a built-in robot (baxter, dual-panda, dual-ur5) or the path of a description file";
    let description =
        |file: &str, hint: &str| format!("13: robot.description: found robot \"{file}\", {unknown}; {hint}");
    let recording =
        "found a recording, expected text; `benchdog inspect` judges recordings, `benchdog view` shows them";
    for (arguments, message) in [
        (["run", "s.yaml"], format!("s.yaml: {in_toml}")),
        (["plan", "s.toml"], format!("s.toml: {in_toml}")),
        (
            ["run", "plan.json"],
            "plan.json: found a plan in JSON, expected a scenario in TOML; a plan is given to `benchdog simulate`"
                .into(),
        ),
        (["plan", "other.json"], "other.json: found JSON, expected a scenario in TOML".into()),
        (
            ["run", "arm.urdf"],
            format!(
                "arm.urdf: found a URDF, expected a scenario in TOML; `benchdog robot new arm.urdf -o robot.toml {new}"
            ),
        ),
        (
            ["run", "arm.urdf.xacro"],
            format!(
                "arm.urdf.xacro: found a xacro file, expected a scenario in TOML; `xacro FILE -o robot.urdf` makes a URDF of it, \
                 and then `benchdog robot new robot.urdf -o robot.toml {new}"
            ),
        ),
        (["simulate", "a.rrd"], format!("a.rrd: {recording}")),
        (["run", "a.rrd"], format!("a.rrd: {recording}")),
        (
            ["simulate", "scenario.toml"],
            "scenario.toml: found TOML, expected a plan in JSON; a scenario is given to `benchdog run`".into(),
        ),
        (
            ["run", "urdf.toml"],
            format!(
                "urdf.toml:{}",
                description("arm.urdf", "`benchdog robot new arm.urdf -o robot.toml` writes the description of a URDF")
            ),
        ),
        (
            ["run", "xacro.toml"],
            format!(
                "xacro.toml:{}",
                description(
                    "arm.urdf.xacro",
                    "`xacro FILE -o robot.urdf` makes a URDF, and `benchdog robot new robot.urdf -o robot.toml` its description"
                )
            ),
        ),
        (["run", "yaml.toml"], format!("yaml.toml:{}", description("arm.yaml", "descriptions are in TOML"))),
    ] {
        assert_refused(&benchdog(folder.path(), &arguments), &message);
    }
}
