//! Maps in a folder, one file each.
//!
//! A file is written beside its place and renamed, so it is complete or absent, also if the process is killed or another one writes
//! the same map. Whatever is wrong with a file when it is read, the map counts as absent and is written again. If the folder cannot
//! be written, the maps are made every time, and the host is told once.

use std::{
    cmp::Reverse,
    fs,
    path::{Path, PathBuf},
    sync::atomic::{AtomicBool, Ordering},
    time::{Duration, SystemTime},
};

use super::{
    key::{PROGRAM, key},
    record::Record,
};
use crate::{
    input,
    planner::{MapLabel, MapSource, MapStore},
    report::file,
};

/// The most bytes of all maps of a folder. The maps of a robot, a board and a kind of task have some kB, with a grasp library a MB.
pub const MOST_BYTES: u64 = 200 << 20;

/// The age at which a temporary file is one of a killed process.
const OLD: Duration = Duration::from_secs(3_600);

/// How the names of maps end.
const EXTENSION: &str = "map";

/// What a folder asks of the program that it is used by.
#[derive(Clone, Copy)]
pub struct Host {
    /// The time: files state when they were last read.
    pub now: fn() -> SystemTime,
    /// Tells the user that maps cannot be kept, and why.
    pub tell: fn(&str),
}

/// A folder of maps.
pub struct Folder {
    path: PathBuf,
    most_bytes: u64,
    host: Host,
    has_told: AtomicBool,
}

/// A map in a folder.
#[derive(Clone, Debug)]
pub struct KeptMap {
    /// The map in words; `None` if the file is damaged, or of a version with another format.
    pub label: Option<MapLabel>,
    /// True if this program reads it.
    pub is_current: bool,
    /// Size of its file.
    pub bytes: u64,
    /// Time since it was last read or written.
    pub unused: Duration,
}

/// What was removed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cleared {
    /// Number of files.
    pub files: usize,
    /// Their size.
    pub bytes: u64,
}

/// A file of a folder.
struct Entry {
    path: PathBuf,
    bytes: u64,
    used: SystemTime,
    is_temporary: bool,
}

impl Folder {
    /// The maps in a folder, which need not exist yet. `most_bytes` limits the size of all together: see [`MOST_BYTES`].
    #[must_use]
    pub fn new(path: &Path, most_bytes: u64, host: Host) -> Self {
        Self { path: path.to_owned(), most_bytes, host, has_told: AtomicBool::new(false) }
    }

    /// The path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// All maps, the last used first.
    pub fn maps(&self) -> Vec<KeptMap> {
        let mut entries = self.entries();
        entries.retain(|entry| !entry.is_temporary);
        entries.sort_by(|a, b| b.used.cmp(&a.used).then_with(|| a.path.cmp(&b.path)));
        let map = |entry: &Entry| {
            let record = input::kept(&entry.path, self.most_bytes).ok().and_then(|bytes| Record::from_bytes(&bytes));
            KeptMap {
                is_current: record.as_ref().is_some_and(|record| record.program == PROGRAM),
                label: record.map(|record| record.label),
                bytes: entry.bytes,
                unused: self.age(entry),
            }
        };
        entries.iter().map(map).collect()
    }

    /// Removes all maps, and what killed processes have left. Files that are not of this kind stay.
    ///
    /// # Errors
    /// The first file that cannot be removed.
    pub fn clear(&self) -> Result<Cleared, file::WriteError> {
        let mut cleared = Cleared::default();
        for Entry { path, bytes, .. } in self.entries() {
            file::remove(&path)?;
            cleared.files += 1;
            cleared.bytes += bytes;
        }
        Ok(cleared)
    }

    fn path_of(&self, source: &MapSource<'_>) -> PathBuf {
        self.path.join(format!("{}.{EXTENSION}", base16ct::lower::encode_string(&key(PROGRAM, source))))
    }

    fn age(&self, entry: &Entry) -> Duration {
        // A clock that was set back makes no file old.
        (self.host.now)().duration_since(entry.used).unwrap_or_default()
    }

    /// The files of maps, finished or not.
    fn entries(&self) -> Vec<Entry> {
        let entry = |found: fs::DirEntry| {
            let (path, metadata) = (found.path(), found.metadata().ok()?);
            let is_temporary = file::is_temporary(&path);
            let entry = Entry { bytes: metadata.len(), used: metadata.modified().ok()?, is_temporary, path };
            (metadata.is_file() && (is_temporary || is_map(&entry.path))).then_some(entry)
        };
        fs::read_dir(&self.path).into_iter().flatten().flatten().filter_map(entry).collect()
    }

    /// Removes what killed processes have left, and the maps that were not used for longest while all are larger than the limit. What
    /// cannot be removed stays.
    fn tidy(&self) {
        let mut entries = self.entries();
        entries.sort_by_key(|entry| Reverse(entry.used));
        let mut total = 0;
        for entry in &entries {
            total += entry.bytes;
            if if entry.is_temporary { self.age(entry) > OLD } else { total > self.most_bytes } {
                let _ = fs::remove_file(&entry.path);
            }
        }
    }
}

/// True if a path is named as a map is: its key, and the extension.
fn is_map(path: &Path) -> bool {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let is_key = stem.len() == 64 && stem.bytes().all(|byte| byte.is_ascii_hexdigit());
    is_key && path.extension().is_some_and(|extension| extension == EXTENSION)
}

impl MapStore for Folder {
    fn read(&self, source: &MapSource<'_>) -> Option<Vec<u8>> {
        let path = self.path_of(source);
        let map = Record::from_bytes(&input::kept(&path, self.most_bytes).ok()?)?.map(&key(PROGRAM, source))?;
        // The time of the last use; that of a file that must not be changed stays.
        if let Ok(file) = fs::File::options().append(true).open(&path) {
            let _ = file.set_modified((self.host.now)());
        }
        Some(map)
    }

    fn write(&self, source: &MapSource<'_>, bytes: &[u8]) {
        let record = Record::new(key(PROGRAM, source), PROGRAM, source.label(), bytes);
        let Some(record) = record.and_then(|record| record.to_bytes()) else { return };
        match file::write_whole(&self.path_of(source), &record) {
            Ok(()) => self.tidy(),
            Err(error) if !self.has_told.swap(true, Ordering::SeqCst) => {
                (self.host.tell)(&format!("maps are not kept for the next command: {error}"));
            }
            Err(_) => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        model::board::BoardShape,
        planner::MapKind,
        robot::{BUILTIN, Robot},
    };

    /// Some minutes after the times that the test sets.
    fn now() -> SystemTime {
        SystemTime::UNIX_EPOCH + Duration::from_secs(1_000_000)
    }

    const HOST: Host = Host { now, tell: |trouble| panic!("{trouble}") };

    /// Bytes that do not become fewer.
    fn bytes(seed: u64) -> Vec<u8> {
        let next =
            |state: &u64| Some(state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407));
        std::iter::successors(Some(seed), next).skip(1).take(1_000).map(|state| (state >> 56) as u8).collect()
    }

    #[test]
    fn what_was_not_used_for_longest_is_removed_first() {
        let (robot, board) = (Robot::load(BUILTIN[0], Path::new("")).unwrap(), BoardShape::cuboid([0.5, 0.4, 0.03]));
        let source =
            |clearance_m| MapSource { kind: MapKind::Grasps, robot: &robot, board: &board, clearance_m, task: None };
        let temporary = tempfile::tempdir().unwrap();
        // Two records of a thousand bytes and their labels, not three.
        let folder = Folder::new(&temporary.path().join("maps"), 2_800, HOST);
        let used = |number: f64, seconds_ago: u64| {
            let file = fs::File::options().append(true).open(folder.path_of(&source(number))).unwrap();
            file.set_modified(now() - Duration::from_secs(seconds_ago)).unwrap();
        };
        let has = |number: f64| folder.path_of(&source(number)).exists();
        folder.write(&source(0.0), &bytes(0));
        used(0.0, 300);
        folder.write(&source(1.0), &bytes(1));
        used(1.0, 200);
        assert!(has(0.0) && has(1.0));
        // Reading is a use.
        assert_eq!(folder.read(&source(0.0)), Some(bytes(0)));
        folder.write(&source(2.0), &bytes(2));
        assert!(has(0.0) && !has(1.0) && has(2.0));
        assert_eq!(folder.read(&source(1.0)), None);
        assert_eq!(folder.read(&source(2.0)), Some(bytes(2)));
        let maps = folder.maps();
        assert!(maps.len() == 2 && maps.iter().all(|map| map.is_current && map.bytes > 1_000), "{maps:?}");
        let bytes = maps.iter().map(|map| map.bytes).sum();
        assert_eq!(folder.clear().unwrap(), Cleared { files: 2, bytes });
        assert_eq!(folder.clear().unwrap(), Cleared::default());
    }

    /// Anything but a file may have the name of a map, and a map larger than all may be is not read.
    #[test]
    fn what_is_not_a_file_of_a_size_that_is_kept_is_absent() {
        let (robot, board) = (Robot::load(BUILTIN[0], Path::new("")).unwrap(), BoardShape::cuboid([0.5, 0.4, 0.03]));
        let source = MapSource { kind: MapKind::Grasps, robot: &robot, board: &board, clearance_m: 0.0, task: None };
        let temporary = tempfile::tempdir().unwrap();
        let large = Folder::new(temporary.path(), 10_000, HOST);
        large.write(&source, &bytes(0));
        assert_eq!(large.read(&source), Some(bytes(0)));
        assert_eq!(Folder::new(temporary.path(), 1_000, HOST).read(&source), None);
        fs::remove_file(large.path_of(&source)).unwrap();
        fs::create_dir(large.path_of(&source)).unwrap();
        assert_eq!(large.read(&source), None);
        assert!(large.maps().is_empty());
        // Listed without being read.
        fs::remove_dir(large.path_of(&source)).unwrap();
        fs::File::create(large.path_of(&source)).unwrap().set_len(1 << 40).unwrap();
        let maps = large.maps();
        assert!(maps.len() == 1 && maps[0].label.is_none() && maps[0].bytes == 1 << 40, "{maps:?}");
    }
}
