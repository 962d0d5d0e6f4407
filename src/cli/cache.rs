//! Where this machine keeps maps between commands, and `benchdog cache`.

use std::{
    env,
    ffi::OsString,
    path::{Path, PathBuf},
    sync::Arc,
    time::{Duration, SystemTime},
};

use clap::{Args, Subcommand};

use super::{
    exit::{CliError, Exit},
    output,
};
use crate::{
    cache::{Builtin, Cleared, Folder, Host, KeptMap, MOST_BYTES, Stores},
    planner::{MapStore, Planner},
    report,
    robot::Robot,
};

/// A command about the maps that are kept.
#[derive(Clone, Copy, Debug, Subcommand)]
pub enum CacheCommand {
    /// List the maps: what each is made for, its size, and when it was last used
    List,
    /// Remove all maps
    Clear,
}

/// Whether maps are kept between commands.
#[derive(Clone, Copy, Debug, Default, Args)]
#[command(next_help_heading = "Maps")]
pub struct CacheArgs {
    /// Make all maps again: read none that an earlier command kept or that come with the program, and keep none
    #[arg(long)]
    pub no_cache: bool,
}

/// The variable that names the folder. Empty: no maps are kept or read.
pub const VARIABLE: &str = "BENCHDOG_CACHE";

/// The store of a command's maps: those in the program, then those in the user's folder. `None` without any.
pub fn store(args: CacheArgs) -> Option<Arc<dyn MapStore>> {
    let is_wanted = !args.no_cache && env::var_os(VARIABLE).is_none_or(|folder| !folder.is_empty());
    is_wanted.then(|| {
        let folder = folder().map(|folder| Arc::new(folder) as Arc<dyn MapStore>);
        Arc::new(Stores(std::iter::once(Arc::new(Builtin) as _).chain(folder).collect())) as _
    })
}

/// A planner with a command's store.
pub fn planner(robot: &Robot, args: CacheArgs) -> Planner {
    match store(args) {
        Some(store) => Planner::with_store(robot, store),
        None => Planner::new(robot),
    }
}

/// The user's folder of maps; `None` if the environment does not tell where it is, or keeps maps out.
pub fn folder() -> Option<Folder> {
    let tell = |trouble: &str| output::message(&format!("note: {trouble}"));
    let path = folder_of(|name| env::var_os(name))?;
    Some(Folder::new(&path, MOST_BYTES, Host { now: SystemTime::now, tell }))
}

/// The folder by the variables of the environment: the one that is named, or `benchdog` in the platform's folder for caches.
fn folder_of(variable: impl Fn(&str) -> Option<OsString>) -> Option<PathBuf> {
    if let Some(named) = variable(VARIABLE) {
        return (!named.is_empty()).then(|| named.into());
    }
    // A relative path would be another folder for every working directory.
    let absolute = |name: &str| variable(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let caches = if cfg!(windows) {
        absolute("LOCALAPPDATA")
    } else if cfg!(target_os = "macos") {
        absolute("HOME").map(|home| home.join("Library/Caches"))
    } else {
        absolute("XDG_CACHE_HOME").or_else(|| absolute("HOME").map(|home| home.join(".cache")))
    };
    caches.map(|caches| caches.join("benchdog"))
}

/// Lists or removes the maps in the user's folder.
pub fn cache(command: &CacheCommand) -> Result<Exit, CliError> {
    let folder = folder().ok_or_else(|| {
        CliError::Usage(format!("found no folder for maps, expected its path in {VARIABLE}, or a home folder"))
    })?;
    match command {
        CacheCommand::List => output::print(&listed(folder.path(), &folder.maps()))?,
        CacheCommand::Clear => {
            let Cleared { files, bytes } = folder.clear()?;
            output::print(&format!("removed {files} files, {}, from {}\n", size(bytes), folder.path().display()))?;
        }
    }
    Ok(Exit::Met)
}

fn listed(folder: &Path, maps: &[KeptMap]) -> String {
    let row = |map: &KeptMap| {
        let label = map.label.clone().unwrap_or_default();
        let state = match (map.is_current, map.label.is_some()) {
            (true, _) => "used",
            (false, true) => "of another build",
            (false, false) => "damaged, or of another version",
        };
        [label.map, label.robot, label.board, label.task, size(map.bytes), age(map.unused), state.to_owned()]
    };
    let rows: Vec<_> = maps.iter().map(row).collect();
    let total = maps.iter().map(|map| map.bytes).sum();
    let table = if rows.is_empty() { String::new() } else { report::maps::table(&rows) };
    format!("{table}{}: {} maps, {}\n", folder.display(), maps.len(), size(total))
}

/// A size as `14.2 kB`.
fn size(bytes: u64) -> String {
    match bytes {
        0..1_000 => format!("{bytes} bytes"),
        1_000..1_000_000 => format!("{:.1} kB", bytes as f64 / 1e3),
        _ => format!("{:.1} MB", bytes as f64 / 1e6),
    }
}

/// A time as `5 min`.
fn age(time: Duration) -> String {
    match time.as_secs() {
        seconds @ 0..60 => format!("{seconds} s"),
        seconds @ 60..3_600 => format!("{} min", seconds / 60),
        seconds @ 3_600..86_400 => format!("{} h", seconds / 3_600),
        seconds => format!("{} days", seconds / 86_400),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder_with(variables: &[(&str, &str)]) -> Option<PathBuf> {
        folder_of(|name| variables.iter().find(|(own, _)| *own == name).map(|(_, value)| value.into()))
    }

    #[test]
    fn the_named_folder_comes_before_that_of_the_platform() {
        assert_eq!(folder_with(&[(VARIABLE, "maps"), ("HOME", "/home/someone")]), Some("maps".into()));
        // Empty: none at all.
        assert_eq!(folder_with(&[(VARIABLE, ""), ("HOME", "/home/someone")]), None);
        assert_eq!(folder_with(&[]), None);
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn a_folder_for_caches_that_is_not_absolute_does_not_count() {
        let home = ("HOME", "/home/someone");
        assert_eq!(folder_with(&[("XDG_CACHE_HOME", "/caches"), home]), Some("/caches/benchdog".into()));
        assert_eq!(folder_with(&[("XDG_CACHE_HOME", "caches"), home]), Some("/home/someone/.cache/benchdog".into()));
        assert_eq!(folder_with(&[("HOME", "someone")]), None);
    }

    #[test]
    fn sizes_and_ages_have_units_that_a_person_reads() {
        assert_eq!([0, 999, 14_240, 200 << 20].map(size), ["0 bytes", "999 bytes", "14.2 kB", "209.7 MB"]);
        let ages = [0, 59, 60, 7_199, 86_400 * 3].map(|seconds| age(Duration::from_secs(seconds)));
        assert_eq!(ages, ["0 s", "59 s", "1 min", "1 h", "3 days"]);
    }
}
