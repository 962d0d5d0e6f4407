//! Two fingerprints of this program. `BENCHDOG_MAPS` is of what the planner's maps depend on: a kept map is read only by a program
//! with the same one. `BENCHDOG_PROGRAM` is of everything: parts of a sweep belong together only if they have the same one.

use std::{
    env, fs,
    path::{Path, PathBuf},
};

use sha2::{Digest, Sha256};

/// What maps depend on, relative to the package. A module that these use is one of them (ARCHITECTURE.md).
const SOURCES: [&str; 10] = [
    "src/model",
    "src/robot",
    "src/human",
    "src/collision",
    "src/comfort",
    "src/check",
    "src/complete",
    "src/statics",
    "src/planner",
    "assets/human",
];

/// What the compiler is told, and the version.
const SETTINGS: [&str; 4] = ["TARGET", "CARGO_CFG_TARGET_FEATURE", "OPT_LEVEL", "CARGO_PKG_VERSION"];

/// What results depend on, relative to the package.
const EVERYTHING: [&str; 2] = ["src", "assets"];

fn main() {
    println!("cargo::rustc-env=BENCHDOG_MAPS={}", fingerprint(&SOURCES));
    println!("cargo::rustc-env=BENCHDOG_PROGRAM={}", fingerprint(&EVERYTHING));
    println!("cargo::rustc-env=BENCHDOG_TARGET={}", env::var("TARGET").unwrap_or_default());
}

/// The SHA-256 of sources, versions of crates and settings, in hexadecimal digits.
fn fingerprint(sources: &[&str]) -> String {
    let mut hash = Sha256::new();
    let mut add = |bytes: &[u8]| {
        hash.update((bytes.len() as u64).to_le_bytes());
        hash.update(bytes);
    };
    let read = |path: &Path| fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    for source in sources {
        println!("cargo::rerun-if-changed={source}");
        for file in files(Path::new(source)) {
            add(file.to_string_lossy().replace('\\', "/").as_bytes());
            add(&read(&file));
        }
    }
    if let Some(lock) = lock() {
        println!("cargo::rerun-if-changed={}", lock.display());
        add(&read(&lock));
    }
    println!("cargo::rerun-if-changed=build.rs");
    for setting in SETTINGS {
        add(env::var(setting).unwrap_or_default().as_bytes());
    }
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The versions of all crates: the Cargo.lock of the workspace that is built, which is above the folder of the build, or else that of
/// this package.
fn lock() -> Option<PathBuf> {
    let out = PathBuf::from(env::var_os("OUT_DIR")?);
    let locks = out.ancestors().map(|folder| folder.join("Cargo.lock"));
    locks.chain(["Cargo.lock".into()]).find(|lock| lock.is_file())
}

/// A file, or all files of a folder in the order of their names.
fn files(path: &Path) -> Vec<PathBuf> {
    if !path.is_dir() {
        return vec![path.to_owned()];
    }
    let entries = fs::read_dir(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let mut paths: Vec<_> = entries.flatten().map(|entry| entry.path()).collect();
    paths.sort();
    paths.iter().flat_map(|path| files(path)).collect()
}
