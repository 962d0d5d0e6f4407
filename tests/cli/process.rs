//! Runs of the binary, and the files that they read and write.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    process::{Command, Output},
    sync::LazyLock,
};

use serde_json::Value;
use tempfile::TempDir;

use crate::common::root;

/// Files by their path relative to a folder.
pub type Files = BTreeMap<PathBuf, Vec<u8>>;

/// The binary with its working directory and arguments.
pub fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_benchdog"));
    // Never the user's folder of maps. The maps in this one are those of earlier tests of the same program.
    let maps = Path::new(env!("CARGO_TARGET_TMPDIR")).join("maps");
    command.current_dir(folder).args(arguments).env("BENCHDOG_CACHE", maps);
    command
}

/// Runs the binary in a folder.
pub fn benchdog(folder: &Path, arguments: &[&str]) -> Output {
    command(folder, arguments).output().unwrap()
}

/// Standard error as text.
pub fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A JSON document; panics with the message of the command if it is invalid.
pub fn printed_json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {}", stderr(output)))
}

/// A JSON file.
pub fn json(path: &Path) -> Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

/// A path as an argument.
pub fn argument(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// A temporary folder with these files.
pub fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    folder
}

/// Writes a scenario of this name and expectation whose plan slips, and the plan; returns the scenario's path. It runs
/// within a second, because nothing is planned.
pub fn slipping_scenario(folder: &Path, name: &str, expected: &str) -> String {
    let from = root().join("scenarios");
    let plan = "plans/cut-rim-weak-grip.json";
    fs::create_dir_all(folder.join("plans")).unwrap();
    fs::copy(from.join(plan), folder.join(plan)).unwrap();
    let text = fs::read_to_string(from.join("fails-weak-grip.toml")).unwrap();
    let text = text.replace("fails-weak-grip", name).replace("\"slips\"", &format!("\"{expected}\""));
    let path = folder.join(format!("{name}.toml"));
    fs::write(&path, text).unwrap();
    argument(&path).to_owned()
}

/// All files below a folder.
pub fn contents(folder: &Path) -> Files {
    fn add(folder: &Path, root: &Path, files: &mut Files) {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                add(&path, root, files);
            } else {
                files.insert(path.strip_prefix(root).unwrap().to_owned(), fs::read(&path).unwrap());
            }
        }
    }
    let mut files = Files::new();
    add(folder, folder, &mut files);
    files
}

/// The output of a run of the quickstart and of the cut of the rim, with this number of threads.
pub fn run_both(jobs: &str) -> Files {
    let out = tempfile::tempdir().unwrap();
    let scenarios = ["scenarios/quickstart.toml", "scenarios/cut-rim.toml"];
    let output =
        command(root(), &["run", "--no-cache", "--jobs", jobs, "--out", argument(out.path())]).args(scenarios).output();
    let output = output.unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    contents(out.path())
}

/// The output of [`run_both`] with two threads, made once for all tests.
pub fn both() -> &'static Files {
    static BOTH: LazyLock<Files> = LazyLock::new(|| run_both("2"));
    &BOTH
}

/// A text of [`both`].
pub fn text_of_both(file: &str) -> &'static str {
    std::str::from_utf8(&both()[Path::new(file)]).unwrap()
}
