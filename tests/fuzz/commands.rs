//! Commands with damaged files: they end with an exit code of their own, and what they leave is whole.

use std::{
    fs::{self, File},
    path::{Path, PathBuf},
    process::{Command, Stdio},
    sync::LazyLock,
};

use benchdog::sweep::summary::SweepSummary;

use crate::{
    driver::{Files, Target, check},
    parts::{self, files},
    targets::general,
};

/// Exit codes of a command that works, see README.md.
const CODES: [i32; 4] = [0, 1, 2, 3];

/// The most addresses of a command, KiB: its data and its threads' stacks take a fraction.
const MOST_KIB: u32 = 8_000_000;

/// A simulation that takes a fraction of a second.
const PLAN: &str = "scenarios/plans/cut-rim-weak-grip.json";

/// The results of a sweep of some runs, and of the simulation of a plan.
struct Results {
    /// Holds the files.
    _folder: tempfile::TempDir,
    out: PathBuf,
}

static RESULTS: LazyLock<Results> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("plan.json"), parts::read(PLAN)).unwrap();
    for arguments in ["simulate plan.json --out out", "sweep plan.json --runs 2 --worst 0 --out out/sweep"] {
        command(folder.path(), arguments).unwrap_or_else(|problem| panic!("{arguments}: {problem}"));
    }
    Results { out: folder.path().join("out"), _folder: folder }
});

/// A file of the results.
fn result(path: &str) -> Vec<u8> {
    fs::read(RESULTS.out.join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// The recording of a simulated plan.
#[cfg(feature = "recording")]
pub fn recording() -> Vec<u8> {
    result("cut-rim-weak-grip/recording.rrd")
}

/// Runs a command in a folder, and returns its exit code.
///
/// # Errors
/// If it panics, is killed, or ends with a code that says that the program is wrong.
fn command(folder: &Path, arguments: &str) -> Result<i32, String> {
    let maps = Path::new(env!("CARGO_TARGET_TMPDIR")).join("maps");
    let (stdout, stderr) = (folder.join("stdout"), folder.join("stderr"));
    let program = env!("CARGO_BIN_EXE_benchdog");
    let mut command = if cfg!(target_os = "linux") {
        let mut shell = Command::new("sh");
        shell.args(["-c", &format!("ulimit -v {MOST_KIB}; exec {program} {arguments}")]);
        shell
    } else {
        let mut direct = Command::new(program);
        direct.args(arguments.split(' '));
        direct
    };
    command.current_dir(folder).env("BENCHDOG_CACHE", maps).stdin(Stdio::null());
    command.stdout(File::create(&stdout).unwrap()).stderr(File::create(&stderr).unwrap());
    let status = command.status().unwrap();
    let message = String::from_utf8_lossy(&fs::read(&stderr).unwrap()).into_owned();
    let code = status.code().ok_or_else(|| format!("{arguments}: {status}: {message}"))?;
    let is_told = code != 2 || message.lines().any(|line| line.contains("error:"));
    if !CODES.contains(&code) || message.contains("panicked at") || !is_told {
        return Err(format!("{arguments}: exit code {code}: {message}"));
    }
    Ok(code)
}

/// Checks that every file below a folder that is not one of the case is whole.
fn all_are_whole(folder: &Path) -> Result<(), String> {
    for entry in fs::read_dir(folder).map_err(|error| error.to_string())? {
        let path = entry.unwrap().path();
        if path.is_dir() {
            all_are_whole(&path)?;
        } else {
            is_whole(&path, &fs::read(&path).unwrap()).map_err(|problem| format!("{}: {problem}", path.display()))?;
        }
    }
    Ok(())
}

fn is_whole(path: &Path, bytes: &[u8]) -> Result<(), String> {
    let text = || str::from_utf8(bytes).map_err(|error| error.to_string());
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("json") => serde_json::from_slice::<serde_json::Value>(bytes).map(drop).map_err(|error| error.to_string()),
        Some("xml" | "svg") => is_xml(text()?),
        Some("html") if text()?.trim_end().ends_with("</html>") => has_no_control_characters(text()?),
        Some("csv") if text()?.ends_with('\n') => {
            let wrong = csv::Reader::from_reader(bytes).records().find_map(Result::err);
            wrong.map_or(Ok(()), |error| Err(error.to_string()))
        }
        #[cfg(feature = "recording")]
        Some("rrd") => benchdog::record::read_summary(path).map(drop).map_err(|error| error.to_string()),
        Some("arrow") if bytes.ends_with(b"ARROW1") => Ok(()),
        Some("part") => Ok(()),
        _ => Err("half a file, or a file that should not be there".to_owned()),
    }
}

fn is_xml(text: &str) -> Result<(), String> {
    has_no_control_characters(text)?;
    roxmltree::Document::parse(text).map(drop).map_err(|error| error.to_string())
}

/// XML 1.0 has no control characters but tab, line feed and carriage return, and neither has a page that can be XML.
fn has_no_control_characters(text: &str) -> Result<(), String> {
    let is_illegal =
        |c: &char| c.is_control() && !matches!(c, '\t' | '\n' | '\r') || matches!(c, '\u{fffe}' | '\u{ffff}');
    text.chars().find(is_illegal).map_or(Ok(()), |c| Err(format!("the character {c:?}")))
}

/// Runs a command on the file of this name; what it writes goes to `out`.
fn run(folder: &Path, name: &str) -> Result<(), String> {
    let place = |file: &str, to: &str| {
        fs::create_dir_all(folder.join(to).parent().unwrap()).unwrap();
        fs::copy(folder.join(file), folder.join(to)).unwrap();
    };
    let code = match name {
        "plan.json" => command(folder, "simulate plan.json --out out --junit out/all.xml")?,
        "scenario.toml" => command(folder, "run scenario.toml --out out --junit out/all.xml")?,
        "verdict.json" => command(folder, "compare verdict.json verdict.json")?,
        "sweep.json" => {
            ["sweep.json", "runs.csv", "plan.json"].iter().for_each(|file| place(file, &format!("part/{file}")));
            command(folder, "merge part --out out")?
        }
        "runs.part" | "runs.csv" => {
            let files = ["plan.json", "runs.part", "runs.csv", "sweep.json"];
            files.iter().filter(|file| folder.join(file).exists()).for_each(|file| place(file, &format!("out/{file}")));
            command(folder, "sweep plan.json --runs 1 --worst 0 --out out")?
        }
        "grasps.yaml" => command(
            folder,
            "import grasps.yaml --scenario scenario.toml --arm left=grasp_0 --arm right=grasp_1 -o out/plan.json",
        )?,
        "a.map" => command(folder, "cache list")?,
        other => return Err(format!("no command for {other}")),
    };
    let out = folder.join("out");
    let is_resumed = name.starts_with("runs.");
    if out.exists() && !(is_resumed && code == 2) { all_are_whole(&out) } else { Ok(()) }
}

fn valid() -> Vec<Files> {
    let named = |name: &str, path: &str| (name.to_owned(), result(path));
    let plan = || ("plan.json".to_owned(), parts::read(PLAN));
    let scenario = parts::text("scenarios/fails-weak-grip.toml").replace("plans/cut-rim-weak-grip.json", "plan.json");
    // What an interrupted sweep leaves: its key, then its runs.
    let journal = || {
        let summary: SweepSummary = serde_json::from_slice(&result("sweep/sweep.json")).unwrap();
        [format!("{}\n", summary.info.key()).as_bytes(), &result("sweep/runs.csv")].concat()
    };
    vec![
        vec![plan()],
        vec![plan()],
        vec![("scenario.toml".to_owned(), scenario.into_bytes()), plan()],
        vec![named("verdict.json", "cut-rim-weak-grip/verdict.json")],
        vec![named("sweep.json", "sweep/sweep.json"), named("runs.csv", "sweep/runs.csv"), plan()],
        vec![named("runs.csv", "sweep/runs.csv"), named("sweep.json", "sweep/sweep.json"), plan()],
        vec![("runs.part".to_owned(), journal()), plan()],
        files(&[
            ("grasps.yaml", "tests/data/import/board.isaac_grasp.yaml"),
            ("scenario.toml", "scenarios/cut-rim.toml"),
        ]),
    ]
}

#[test]
fn commands_with_any_files_end_as_they_should() {
    check(&Target { name: "command", valid: valid(), cases: 60, mutate: general, run });
}
