//! Colours.

use super::{plan, without_times};
use crate::{
    bad_input::SCENARIO,
    process::{benchdog, command, folder},
};

const ESCAPE: &str = "\u{1b}[";

/// A text without its colours.
fn plain(text: &str) -> String {
    let mut parts = text.split(ESCAPE);
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |plain, part| plain + part.split_once('m').unwrap().1)
}

/// Standard output and standard error of a command.
fn seen(folder: &std::path::Path, arguments: &[&str], variables: &[(&str, &str)]) -> [String; 2] {
    let mut command = command(folder, arguments);
    for name in ["NO_COLOR", "CLICOLOR", "CLICOLOR_FORCE"] {
        command.env_remove(name);
    }
    let output = command.envs(variables.iter().copied()).output().unwrap();
    [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap())
}

#[test]
fn a_report_has_colours_if_they_are_wanted_and_is_else_the_same() {
    let place = tempfile::tempdir().unwrap();
    plan(place.path(), "cut-rim.json", "a.json", "good");
    plan(place.path(), "cut-rim-weak-grip.json", "b.json", "weak");
    let simulate = ["simulate", "a.json", "b.json", "--record", "never", "--jobs", "1"];
    let with = |options: &[&str], variables: &[(&str, &str)]| {
        seen(place.path(), &[&simulate[..], options].concat(), variables)
    };
    let [text, lines] = with(&[], &[]);
    assert!(!text.contains(ESCAPE) && !lines.contains(ESCAPE), "no terminal");
    let [painted, painted_lines] = with(&["--color", "always"], &[]);
    assert_eq!(without_times(&plain(&painted)), without_times(&text));
    assert!(painted.contains("\u{1b}[32mholds\u{1b}[0m") && painted.contains("\u{1b}[31mslips\u{1b}[0m"), "{painted}");
    assert!(painted.contains("\u{1b}[36mbenchdog explain slips"), "{painted}");
    assert!(painted_lines.contains("\u{1b}[1m\u{1b}[31mFAIL\u{1b}[0m "), "{painted_lines}");
    let forced = with(&[], &[("CLICOLOR_FORCE", "1")]);
    assert_eq!(without_times(&forced[0]), without_times(&painted));
    for (options, variables) in [
        (&["--color=never"][..], &[("CLICOLOR_FORCE", "1")][..]),
        (&[], &[("CLICOLOR_FORCE", "1"), ("NO_COLOR", "1")]),
        (&["--color", "auto"], &[]),
    ] {
        assert_eq!(without_times(&with(options, variables)[0]), without_times(&text), "{options:?} {variables:?}");
    }
}

#[test]
fn a_failed_check_is_a_row_in_red() {
    let place = tempfile::tempdir().unwrap();
    plan(place.path(), "cut-rim-weak-grip.json", "b.json", "weak");
    let [painted, _] = seen(place.path(), &["simulate", "b.json", "--record", "never", "--color", "always"], &[]);
    let rows: Vec<_> = painted.lines().filter(|line| line.ends_with("FAIL\u{1b}[0m")).collect();
    assert!(rows.iter().any(|row| row.starts_with("\u{1b}[31mslip ")), "{painted}");
    assert!(painted.contains("weak: \u{1b}[31mslips\u{1b}[0m, expected holds: "), "{painted}");
}

#[test]
fn what_programs_read_has_no_colours() {
    let place = tempfile::tempdir().unwrap();
    plan(place.path(), "cut-rim-weak-grip.json", "b.json", "weak");
    let arguments =
        ["simulate", "b.json", "--record", "never", "--format", "json", "--junit", "j.xml", "--color", "always"];
    let [text, _] = seen(place.path(), &arguments, &[]);
    assert!(text.starts_with('[') && !text.contains(ESCAPE), "{text}");
    for (path, bytes) in crate::process::contents(place.path()) {
        assert!(!String::from_utf8_lossy(&bytes).contains(ESCAPE), "{}", path.display());
    }
}

#[test]
fn errors_of_files_and_of_arguments_follow_the_same_choice() {
    let place = folder(&[("bad.toml", &SCENARIO.replace("0.6", "6.0"))]);
    let [_, said] = seen(place.path(), &["--color", "always", "run", "bad.toml"], &[]);
    assert!(said.starts_with("\u{1b}[1m\u{1b}[31merror:\u{1b}[0m bad.toml:14: grip.friction: "), "{said}");
    let [_, said] = seen(place.path(), &["run", "bad.toml", "--no-such", "--color=always"], &[]);
    assert!(said.contains(ESCAPE), "{said}");
    let [help, _] = seen(place.path(), &["run", "--help", "--color", "always"], &[]);
    assert!(help.contains(ESCAPE));
    let [help, said] = seen(place.path(), &["run", "--help", "--color", "never"], &[("CLICOLOR_FORCE", "1")]);
    assert!(!help.contains(ESCAPE) && said.is_empty());
    let output = benchdog(place.path(), &["run", "bad.toml", "--color", "blue"]);
    assert_eq!(output.status.code(), Some(2));
}
