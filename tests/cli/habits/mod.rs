//! What users of a command line expect: colours, suggestions, all faults at once, logging, `-`, several files, templates, hints.

mod colors;
mod faults;
mod hints;
mod log;
mod several_plans;
mod streams;
mod templates;

use std::{
    fs,
    io::Write as _,
    path::Path,
    process::{Output, Stdio},
};

use crate::{common::root, process::command};

/// Runs the binary with a text on its standard input.
fn with_input(folder: &Path, arguments: &[&str], input: &[u8]) -> Output {
    let mut command = command(folder, arguments);
    let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    // A command that refuses its arguments closes the pipe.
    let _ = child.stdin.take().unwrap().write_all(input);
    child.wait_with_output().unwrap()
}

/// Copies a plan of the repository into a folder, with another name.
fn plan(folder: &Path, from: &str, file: &str, name: &str) {
    let text = fs::read_to_string(root().join("scenarios/plans").join(from)).unwrap();
    let own = format!("\"name\": \"{}\"", from.trim_end_matches(".json"));
    assert!(text.contains(&own), "{from} has another name");
    let path = folder.join(file);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, text.replacen(&own, &format!("\"name\": \"{name}\""), 1)).unwrap();
}

/// A report without the durations of its table.
fn without_times(text: &str) -> String {
    let is_time = |word: &str| word.contains('.') && word.parse::<f64>().is_ok();
    let line = |line: &str| match line.rsplit_once(' ') {
        Some((before, time)) if is_time(time) && line.contains(" holds ") || line.contains(" slips ") => {
            before.trim_end().to_owned()
        }
        _ => line.to_owned(),
    };
    text.lines().map(line).collect::<Vec<_>>().join("\n")
}
