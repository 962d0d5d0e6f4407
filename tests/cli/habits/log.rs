//! `-v`: what is done, on standard error.

use super::{plan, without_times};
use crate::process::{command, contents};

/// The output of `simulate` on a plan, and the files that it left.
fn simulated(options: &[&str], variable: Option<&str>) -> (String, String, crate::process::Files) {
    let place = tempfile::tempdir().unwrap();
    plan(place.path(), "cut-rim.json", "a.json", "one");
    let mut command = command(place.path(), &[&["simulate", "a.json", "--record", "never"], options].concat());
    command.env_remove("BENCHDOG_LOG").envs(variable.map(|filter| ("BENCHDOG_LOG", filter)));
    let output = command.output().unwrap();
    let [text, said] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    (without_times(&text), said, contents(place.path()))
}

#[test]
fn what_is_done_is_said_and_changes_nothing() {
    let (text, said, files) = simulated(&[], None);
    assert_eq!(said, "");
    let (text_of_v, said_of_v, files_of_v) = simulated(&["-v"], None);
    assert_eq!((&text_of_v, &files_of_v), (&text, &files));
    for line in [
        " INFO benchdog::input: read file=a.json bytes=",
        " INFO benchdog::sim: simulating plan=\"one\" steps=",
        " INFO benchdog::pipeline: judged plan=\"one\" verdict=\"holds\"",
        " INFO benchdog::report::file: wrote file=out/one/verdict.json bytes=",
    ] {
        assert!(said_of_v.contains(line), "{line}: {said_of_v}");
    }
    assert!(!said_of_v.contains("DEBUG"), "{said_of_v}");
    let (text_of_vv, said_of_vv, files_of_vv) = simulated(&["-vv"], None);
    assert_eq!((&text_of_vv, &files_of_vv), (&text, &files));
    for phase in ["settle", "ramp", "hold"] {
        assert!(said_of_vv.contains(&format!("phase=\"{phase}\"")), "{said_of_vv}");
    }
    assert!(said_of_vv.contains("DEBUG benchdog::robot::load: loaded a robot robot=\"baxter\""), "{said_of_vv}");
    assert_eq!(simulated(&["-v"], None).1, said_of_v, "no times");
}

#[test]
fn a_filter_is_taken_from_the_environment() {
    let (_, said, _) = simulated(&[], Some("benchdog::sim=debug"));
    assert!(said.contains("DEBUG benchdog::sim") && !said.contains("benchdog::input"), "{said}");
    let (_, said, _) = simulated(&["-v"], Some("benchdog::sim=debug"));
    assert!(said.contains("benchdog::input") && !said.contains("DEBUG"), "the option is nearer: {said}");
    let (_, said, _) = simulated(&[], Some("benchdog=loud"));
    assert!(said.starts_with("warning: BENCHDOG_LOG: "), "{said}");
    assert_eq!(said.lines().count(), 1, "{said}");
}
