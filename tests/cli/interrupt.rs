//! Ctrl-C in every command that takes long: it ends with exit code 130, says what it was doing, and leaves no half file.

// The state of a process is read from `/proc`.
#![cfg(target_os = "linux")]

use std::{
    fs,
    path::Path,
    process::{Child, Command, ExitStatus, Stdio},
    thread::sleep,
    time::{Duration, Instant},
};

use crate::{
    common::root,
    process::{argument, command, contents, folder, json},
};

/// A process that has not ended by then hangs; a busy machine is far faster.
const MOST: Duration = Duration::from_secs(120);

/// Between two looks at a process.
const LOOK: Duration = Duration::from_millis(5);

/// The second signal, SIGINT, in the mask of the signals that a process catches.
const INTERRUPT: u64 = 1 << 1;

/// A command that runs, and the file of its standard error.
struct Running {
    child: Child,
    errors: std::path::PathBuf,
}

impl Running {
    /// Starts a command and waits until it listens for Ctrl-C.
    fn start(folder: &Path, arguments: &[&str]) -> Self {
        let errors = folder.join("standard-error.txt");
        let mut command = command(folder, arguments);
        let command = command.stdout(Stdio::null()).stderr(fs::File::create(&errors).unwrap());
        let mut running = Self { child: command.spawn().unwrap(), errors };
        running.wait_until(|running| running.listens());
        running
    }

    fn wait_until(&mut self, is_so: impl Fn(&Self) -> bool) {
        let start = Instant::now();
        while !is_so(self) {
            assert_eq!(self.child.try_wait().unwrap(), None, "ended early: {}", self.messages());
            assert!(start.elapsed() < MOST, "{}", self.messages());
            sleep(LOOK);
        }
    }

    fn listens(&self) -> bool {
        let status = fs::read_to_string(format!("/proc/{}/status", self.child.id())).unwrap_or_default();
        let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:")).unwrap_or("0");
        u64::from_str_radix(caught.trim(), 16).unwrap() & INTERRUPT != 0
    }

    fn messages(&self) -> String {
        fs::read_to_string(&self.errors).unwrap()
    }

    fn signal(&self) {
        let signalled = Command::new("kill").args(["-INT", &self.child.id().to_string()]).status().unwrap();
        assert!(signalled.success());
    }

    /// Presses Ctrl-C; the exit code and the messages.
    fn interrupt(mut self) -> (Option<i32>, String) {
        self.signal();
        let status = self.end();
        (status.code(), self.messages())
    }

    fn end(&mut self) -> ExitStatus {
        let start = Instant::now();
        loop {
            if let Some(status) = self.child.try_wait().unwrap() {
                return status;
            }
            if start.elapsed() > MOST {
                self.child.kill().unwrap();
                panic!("it does not end after Ctrl-C: {}", self.messages());
            }
            sleep(LOOK);
        }
    }
}

/// Interrupts a command as soon as it listens and `wait` has passed; it has not found anything by then and writes nothing into
/// `out`.
#[track_caller]
fn writes_nothing(folder: &Path, arguments: &[&str], wait: Duration) {
    let running = Running::start(folder, arguments);
    sleep(wait);
    let (code, messages) = running.interrupt();
    assert_eq!(code, Some(130), "{arguments:?}: {messages}");
    let last = messages.lines().last().unwrap_or_default();
    assert!(last.starts_with("interrupted after ") && last.contains(" s, while "), "{arguments:?}: {messages}");
    assert!(last.ends_with(": nothing was found yet and nothing is written"), "{arguments:?}: {messages}");
    assert!(!messages.contains("feasible"), "{arguments:?}: {messages}");
    let out = folder.join("out");
    assert!(!out.exists() || contents(&out).is_empty(), "{arguments:?}: {:?}", contents(&out).keys());
}

fn scenario(name: &str) -> String {
    argument(&root().join(format!("scenarios/{name}.toml"))).to_owned()
}

/// At the beginning, and at places in the maps, which take seconds where none are kept.
#[test]
fn a_plan_that_has_not_begun_to_search_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    for wait_ms in [0, 150, 900] {
        let arguments = ["plan", &scenario("quickstart"), "--no-cache", "-o", "out/plan.json"];
        writes_nothing(folder.path(), &arguments, Duration::from_millis(wait_ms));
    }
    let arguments = ["plan", &scenario("quickstart"), "--no-cache", "-o", "out", "--top", "3"];
    writes_nothing(folder.path(), &arguments, Duration::from_millis(50));
}

#[test]
fn fronts_and_tasks_that_have_not_begun_to_search_write_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let wait = Duration::from_millis(50);
    writes_nothing(folder.path(), &["front", &scenario("quickstart"), "--no-cache", "--out", "out"], wait);
    writes_nothing(folder.path(), &["task", &scenario("whole-circle"), "--no-cache", "--out", "out"], wait);
}

#[test]
fn commands_that_write_at_their_end_write_nothing() {
    let place = folder(&[("baxter.urdf", include_str!("../../assets/baxter.urdf"))]);
    let plan = root().join("scenarios/plans/cut-rim.json");
    let at_once = Duration::ZERO;
    writes_nothing(place.path(), &["margin", argument(&plan)], at_once);
    writes_nothing(place.path(), &["simulate", argument(&plan), "--out", "out"], at_once);
    writes_nothing(place.path(), &["curve", "--out", "out"], at_once);
    writes_nothing(place.path(), &["robot", "new", "baxter.urdf", "-o", "out/robot.toml"], at_once);
}

/// One that finds no pose of the board tries them all, for seconds.
#[test]
fn an_import_that_looks_for_a_pose_of_the_board_writes_nothing() {
    let grasps = include_str!("../data/import/board.isaac_grasp.yaml");
    let place = folder(&[("isaac.yaml", grasps)]);
    let arguments = ["import", "isaac.yaml", "--scenario", &scenario("cut-rim"), "-o", "out/plan.json"];
    // Both hands at the same place.
    let both = ["--arm", "left=grasp_0", "--arm", "right=grasp_0"];
    writes_nothing(place.path(), &[&arguments[..], &both].concat(), Duration::ZERO);
}

/// A scenario in progress is abandoned and reported like one that has not begun.
#[test]
fn a_run_reports_the_scenario_in_progress_as_interrupted() {
    let folder = tempfile::tempdir().unwrap();
    let mut running = Running::start(folder.path(), &["run", &scenario("quickstart"), "--no-cache", "--out", "out"]);
    // The scenarios are read, the maps are begun.
    running.wait_until(|_| folder.path().join("out").exists());
    sleep(Duration::from_millis(300));
    let (code, messages) = running.interrupt();
    assert_eq!(code, Some(130), "{messages}");
    assert_eq!(messages, "interrupted: the finished scenarios are reported; press Ctrl-C again to exit immediately\n");
    let out = folder.path().join("out");
    let summary = json(&out.join("summary.json"));
    assert_eq!((&summary["interrupted"], &summary["skipped"]), (&true.into(), &1.into()));
    assert_eq!(summary["outcomes"][0]["explanation"], "not finished before the interruption");
    let reports = ["junit.xml", "report.html", "summary.csv", "summary.json"];
    assert!(contents(&out).keys().eq(reports.map(Path::new)), "{:?}", contents(&out).keys());
}

#[test]
fn a_reproduction_keeps_what_was_finished() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["reproduce", "--no-cache", "--quick", "--filter", "cut-05", "--out", "out"];
    let mut running = Running::start(folder.path(), &arguments);
    running.wait_until(|_| folder.path().join("out").exists());
    sleep(Duration::from_millis(300));
    let (code, messages) = running.interrupt();
    assert_eq!(code, Some(130), "{messages}");
    let left = ": finished results are kept in out/work, and the same command continues from them\n";
    assert!(messages.starts_with("interrupted after ") && messages.ends_with(left), "{messages}");
    let left = contents(&folder.path().join("out"));
    assert!(left.keys().all(|path| path.starts_with("work") && path.extension().is_some_and(|of| of == "json")));
}
