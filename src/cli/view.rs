//! `benchdog view`: opens a recording in rerun's viewer, a separate program.

use std::{io::ErrorKind, path::Path, process::Command};

use super::{
    args::ViewArgs,
    exit::{CliError, Exit},
    output,
};
use crate::{pipeline::versions::RERUN, record};

/// The viewer's program.
const VIEWER: &str = "rerun";

/// Starts the viewer and waits until it is closed. The recording is checked first.
pub fn view(args: &ViewArgs) -> Result<Exit, CliError> {
    record::read_summary(&args.recording)?;
    let Some(version) = viewer_version()? else {
        return Err(CliError::Machine(format!(
            "found no {VIEWER} on the path, expected the viewer of version {RERUN} or newer: {}, then: {VIEWER} {}",
            how_to_install(),
            args.recording.display()
        )));
    };
    if !is_new_enough(&version) {
        let how = how_to_install();
        output::message(&format!(
            "warning: found {version}, expected {RERUN} or newer: if it does not open the file, {how}"
        ));
    }
    open(&args.recording)
}

/// Name and version of the viewer, such as `rerun-cli 0.36.3`; `None` if it is not installed.
///
/// # Errors
/// If it is installed and cannot be started.
pub fn viewer_version() -> Result<Option<String>, CliError> {
    match Command::new(VIEWER).arg("--version").output() {
        Ok(output) => {
            let text = String::from_utf8_lossy(&output.stdout);
            let words: Vec<&str> = text.split_whitespace().take(2).collect();
            Ok(Some(if words.is_empty() { format!("{VIEWER} of unknown version") } else { words.join(" ") }))
        }
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(CliError::Machine(format!("failed to start {VIEWER}: {error}"))),
    }
}

/// True if the viewer has the version of the recordings or a later one: viewers open recordings of earlier versions.
pub fn is_new_enough(version: &str) -> bool {
    let numbers = |word: &str| -> Option<Vec<u64>> {
        // A pre-release, such as 0.37.0-rc.1, counts as its version.
        word.split(['-', '+']).next()?.split('.').map(|part| part.parse().ok()).collect()
    };
    let found = version.split_whitespace().find_map(|word| numbers(word).filter(|numbers| numbers.len() == 3));
    found >= numbers(RERUN) && found.is_some()
}

/// How to install the viewer.
pub fn how_to_install() -> String {
    format!("install it with `pip install 'rerun-sdk>={RERUN}'` or `cargo install rerun-cli --locked`")
}

fn open(recording: &Path) -> Result<Exit, CliError> {
    let status = Command::new(VIEWER).arg(recording).status();
    let status = status.map_err(|error| CliError::Machine(format!("failed to start {VIEWER}: {error}")))?;
    if status.success() {
        Ok(Exit::Met)
    } else {
        Err(CliError::Machine(format!("failed to show {}: {VIEWER} exited with {status}", recording.display())))
    }
}

#[cfg(test)]
mod tests {
    use super::is_new_enough;

    #[test]
    fn viewers_of_the_version_of_recordings_and_newer_ones_are_accepted() {
        for version in ["rerun-cli 0.36.3", "rerun-cli 0.36.10", "rerun-cli 0.37.0-rc.1", "rerun-cli 1.0.0"] {
            assert!(is_new_enough(version), "{version}");
        }
        for version in ["rerun-cli 0.36.2", "rerun-cli 0.9.12", "rerun of unknown version", "rerun-cli 36"] {
            assert!(!is_new_enough(version), "{version}");
        }
    }
}
