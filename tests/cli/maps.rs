//! Maps between commands: whatever happens to the folder that keeps them, a plan is never another one, and no command fails.

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Child, Command, Output, Stdio},
    sync::Arc,
    time::{Duration, SystemTime},
};

use benchdog::{
    cache::BuiltinWriter,
    model::scenario::{PlannerKind, Scenario},
    planner::Planner,
    reproduce::{
        paper::Evaluation,
        schedule::{Schedule, Scope},
    },
    robot::BUILTIN,
    scenario,
};
use tempfile::TempDir;

use crate::{
    common::root,
    process::{command, stderr},
};

/// A scenario whose plan needs the grasp library alone, which takes about a second, and no map that comes with the program.
const PLAN: [&str; 4] = ["plan", "scenarios/quickstart.toml", "--budget", "fast"];

fn planned_in(maps: &Path) -> Command {
    let mut command = command(root(), &PLAN);
    command.env("BENCHDOG_CACHE", maps);
    command
}

/// A plan without its durations.
#[track_caller]
fn plan(output: &Output) -> String {
    assert!(output.status.success(), "{}", stderr(output));
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    text.lines().filter(|line| !line.contains("_ms\"")).collect::<Vec<_>>().join("\n")
}

#[track_caller]
fn plan_in(maps: &Path) -> String {
    plan(&planned_in(maps).output().unwrap())
}

/// The plan on maps that are neither read nor kept.
fn fresh() -> String {
    let folder = tempfile::tempdir().unwrap();
    let output = planned_in(folder.path()).arg("--no-cache").output().unwrap();
    assert!(names(folder.path()).is_empty());
    plan(&output)
}

fn names(folder: &Path) -> Vec<String> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// The only map in a folder.
#[track_caller]
fn only_map(folder: &Path) -> PathBuf {
    let names = names(folder);
    assert!(names.len() == 1 && names[0].ends_with(".map"), "{names:?}");
    folder.join(&names[0])
}

/// The lines that `benchdog cache` prints.
#[track_caller]
fn cache(maps: &Path, what: &str) -> Vec<String> {
    let output = command(root(), &["cache", what]).env("BENCHDOG_CACHE", maps).output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    String::from_utf8(output.stdout).unwrap().lines().map(str::to_owned).collect()
}

/// A folder that does not exist yet, in a temporary one.
fn new_folder() -> (TempDir, PathBuf) {
    let parent = tempfile::tempdir().unwrap();
    let maps = parent.path().join("new/maps");
    (parent, maps)
}

#[test]
fn maps_are_kept_read_listed_and_removed() {
    let (_parent, maps) = new_folder();
    let first = plan_in(&maps);
    assert_eq!(first, fresh());
    let map = only_map(&maps);
    let (kept, written) = (fs::read(&map).unwrap(), fs::metadata(&map).unwrap().modified().unwrap());
    // Used long ago: a use is noted, and nothing is written again.
    fs::File::options().append(true).open(&map).unwrap().set_modified(written - Duration::from_secs(90)).unwrap();
    assert!(cache(&maps, "list")[1].contains("1 min"));
    assert_eq!(plan_in(&maps), first);
    assert!(fs::metadata(only_map(&maps)).unwrap().modified().unwrap() >= written);
    assert_eq!(fs::read(&map).unwrap(), kept);
    let listed = cache(&maps, "list");
    assert!(listed.len() == 3 && listed[1].starts_with("grasps  baxter  500 x 400 x 30 mm"), "{listed:?}");
    assert!(listed[1].ends_with(" used") && listed[2].contains("maps: 1 maps, "), "{listed:?}");
    // Files of others stay.
    fs::write(maps.join("notes.txt"), "mine").unwrap();
    fs::write(maps.join("abc.map"), "mine").unwrap();
    assert!(cache(&maps, "clear")[0].starts_with("removed 1 files, "));
    assert_eq!(names(&maps), ["abc.map", "notes.txt"]);
}

/// Whatever stands where a map was: it is not read, and the map is written again.
#[test]
fn a_damaged_map_is_made_and_written_again() {
    let (_parent, maps) = new_folder();
    let first = plan_in(&maps);
    let map = only_map(&maps);
    let kept = fs::read(&map).unwrap();
    let flipped = |at: usize| {
        let mut bytes = kept.clone();
        bytes[at] ^= 1;
        bytes
    };
    let damaged = [
        ("no byte", Vec::new()),
        ("the first half", kept[..kept.len() / 2].to_vec()),
        ("without the last byte", kept[..kept.len() - 1].to_vec()),
        ("a bit in the middle", flipped(kept.len() / 2)),
        ("another kind of file", flipped(0)),
        ("another format", flipped(40)),
        ("a text", b"not a map\n".repeat(10_000)),
    ];
    for (what, bytes) in damaged {
        fs::write(&map, bytes).unwrap();
        assert!(cache(&maps, "list")[1].ends_with("damaged, or of another version"), "{what}");
        assert_eq!(plan_in(&maps), first, "{what}");
        assert!(fs::read(only_map(&maps)).unwrap() == kept, "{what}");
    }
    // The whole file of another map: it is another key's.
    let other = maps.join(format!("{}.map", "0".repeat(64)));
    fs::rename(&map, &other).unwrap();
    assert_eq!(plan_in(&maps), first);
    let swapped = fs::read(&map).unwrap();
    assert!(swapped == kept);
    // A folder of this name cannot be replaced: the plan is the same, and a note says why nothing is kept.
    fs::remove_file(&map).unwrap();
    fs::create_dir(&map).unwrap();
    let output = planned_in(&maps).output().unwrap();
    assert_eq!(plan(&output), first);
    assert_eq!(stderr(&output).matches("note: maps are not kept").count(), 1, "{}", stderr(&output));
}

/// A process that is killed while it writes leaves a whole map or none, and what it leaves beside is removed when it is old.
#[test]
fn a_killed_process_leaves_no_half_map() {
    let first = fresh();
    let (_parent, maps) = new_folder();
    for attempt in 0..6 {
        let mut child = planned_in(&maps).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        // From the moment that a file appears, a little later each time; then it is written, or being written.
        while names(&maps).is_empty() && child.try_wait().unwrap().is_none() {
            std::thread::sleep(Duration::from_micros(100));
        }
        std::thread::sleep(Duration::from_micros(400 * attempt));
        killed(child);
        let finished = names(&maps).into_iter().filter(|name| name.ends_with(".map")).count();
        let listed = cache(&maps, "list");
        assert_eq!(listed.iter().filter(|line| line.ends_with(" used")).count(), finished, "{listed:?}");
        assert!(!listed.iter().any(|line| line.contains("damaged")), "{listed:?}");
        cache(&maps, "clear");
        assert!(names(&maps).is_empty());
    }
    // What a killed process left stays while it may be in use, and is removed when it is old.
    let [young, old] = [".benchdog-young.part", ".benchdog-old.part"].map(|name| maps.join(name));
    fs::write(&young, "half").unwrap();
    fs::write(&old, "half").unwrap();
    let hours_ago = SystemTime::now() - Duration::from_secs(7_200);
    fs::File::options().append(true).open(&old).unwrap().set_modified(hours_ago).unwrap();
    assert_eq!(plan_in(&maps), first);
    assert!(young.exists() && !old.exists());
    assert_eq!(plan_in(&maps), first);
}

fn killed(mut child: Child) {
    // It may have ended by itself.
    let _ = child.kill();
    child.wait().unwrap();
}

#[test]
fn two_processes_at_once_make_the_same_map() {
    let (_parent, maps) = new_folder();
    let both = [(); 2].map(|()| planned_in(&maps).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap());
    let plans = both.map(|child| plan(&child.wait_with_output().unwrap()));
    assert_eq!(plans[0], plans[1]);
    assert_eq!(plans[0], fresh());
    only_map(&maps);
    assert!(cache(&maps, "list")[1].ends_with(" used"));
}

/// A file of at most 512 bytes: as on a full disk, writing fails in the middle of a map.
#[test]
#[cfg(unix)]
fn a_full_disk_costs_only_time() {
    let (_parent, maps) = new_folder();
    let output = Command::new("sh")
        .current_dir(root())
        .env("BENCHDOG_CACHE", &maps)
        .args(["-c", "trap '' XFSZ; ulimit -f 1; exec \"$@\"", "sh", env!("CARGO_BIN_EXE_benchdog")])
        .args(PLAN)
        .output()
        .unwrap();
    assert_eq!(plan(&output), fresh());
    assert_eq!(stderr(&output).matches("note: maps are not kept for the next command: failed to write").count(), 1);
    assert!(names(&maps).is_empty(), "{:?}", names(&maps));
}

/// A path that no folder can have, as a folder that may not be written.
#[test]
fn a_folder_that_cannot_be_written_costs_only_time() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "mine").unwrap();
    let output = planned_in(&file.join("maps")).output().unwrap();
    assert_eq!(plan(&output), fresh());
    assert_eq!(stderr(&output).matches("note: maps are not kept for the next command: ").count(), 1);
    assert_eq!(fs::read(&file).unwrap(), b"mine");
    // A folder that may only be read gives what it has.
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        let maps = folder.path().join("maps");
        let first = plan_in(&maps);
        let may = |folder: u32, file: u32| {
            fs::set_permissions(only_map(&maps), fs::Permissions::from_mode(file)).unwrap();
            fs::set_permissions(&maps, fs::Permissions::from_mode(folder)).unwrap();
        };
        may(0o555, 0o444);
        let output = planned_in(&maps).output().unwrap();
        assert_eq!((plan(&output), stderr(&output).contains("note: ")), (first, false));
        may(0o755, 0o644);
    }
}

/// An empty name of the folder: nothing is kept, and neither is the user's own folder used.
#[test]
fn an_empty_name_of_the_folder_keeps_nothing() {
    let home = tempfile::tempdir().unwrap();
    let mut command = planned_in(Path::new(""));
    let output = command.env("HOME", home.path()).env("XDG_CACHE_HOME", home.path()).output().unwrap();
    assert_eq!(plan(&output), fresh());
    assert!(names(home.path()).is_empty());
    let mut command = planned_in(Path::new(""));
    command.env("HOME", home.path()).env_remove("XDG_CACHE_HOME").env_remove("BENCHDOG_CACHE");
    let output = command.output().unwrap();
    assert_eq!(plan(&output), fresh());
    #[cfg(target_os = "linux")]
    only_map(&home.path().join(".cache/benchdog"));
}

/// What `benchdog reproduce` plans with warm starts.
fn scenarios_of_the_paper() -> Vec<Scenario> {
    let jobs = Evaluation::ALL.into_iter().flat_map(|evaluation| {
        let operations: Vec<_> = evaluation.operations().iter().map(|operation| operation.load().unwrap()).collect();
        Schedule::new(&operations, &Scope::quick(evaluation)).jobs
    });
    jobs.map(|job| job.scenario).filter(|scenario| scenario.planner.kind != PlannerKind::Random).collect()
}

/// The maps that come with the program are those that it makes. `BENCHDOG_WRITE_MAPS=1 cargo test --release --test cli
/// maps_of_the_program` writes them again after a change of the planner that is meant.
#[test]
fn the_maps_of_the_program_are_those_that_it_makes() {
    if cfg!(not(all(target_os = "linux", target_arch = "x86_64"))) {
        // They are of this target, and others do not read them.
        return;
    }
    let writer = Arc::new(BuiltinWriter::default());
    for robot in BUILTIN {
        let loaded = ["quickstart", "cut-rim"].map(|name| {
            let path = root().join(format!("scenarios/{name}.toml"));
            let text = fs::read_to_string(&path).unwrap();
            let text = text.replace("\n[operation]", &format!("\n[robot]\ndescription = \"{robot}\"\n\n[operation]"));
            scenario::load_text(&path, &text).unwrap()
        });
        let planner = Planner::with_store(&loaded[0].robot, writer.clone());
        let of_paper = if *robot == "baxter" { scenarios_of_the_paper() } else { Vec::new() };
        for scenario in loaded.iter().map(|loaded| &loaded.scenario).chain(&of_paper) {
            planner.prepare(scenario).unwrap();
        }
    }
    let path = root().join("assets/maps/builtin.maps");
    let made = writer.file();
    if std::env::var_os("BENCHDOG_WRITE_MAPS").is_some() {
        fs::write(&path, &made).unwrap();
        return;
    }
    assert!(
        made == BuiltinWriter::present(),
        "{} is not what this program makes; after a change that is meant write it again: \
         BENCHDOG_WRITE_MAPS=1 cargo test --release --test cli maps_of_the_program",
        path.display()
    );
}

/// The first plan of the quickstart on an empty folder reads a map of the program, and keeps none.
#[test]
fn a_map_of_the_program_serves_the_first_command() {
    let (_parent, maps) = new_folder();
    let arguments = ["plan", "scenarios/quickstart.toml"];
    let output = command(root(), &arguments).env("BENCHDOG_CACHE", &maps).output().unwrap();
    let first = plan(&output);
    assert!(names(&maps).is_empty(), "{:?}", names(&maps));
    let fresh = command(root(), &arguments).arg("--no-cache").output().unwrap();
    assert_eq!(first, plan(&fresh));
}
