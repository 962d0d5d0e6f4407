//! `benchdog view`: a recording in rerun's viewer, which is a program of its own.

use std::{io::ErrorKind, path::Path, process::Command};

use super::{
    args::ViewArgs,
    exit::{CliError, Exit},
    output,
    versions::RERUN,
};
use crate::record;

/// The viewer's program.
const VIEWER: &str = "rerun";

/// Starts the viewer and waits until it is closed. A file that is no recording of ours is told before.
pub fn view(args: &ViewArgs) -> Result<Exit, CliError> {
    record::read_summary(&args.recording)?;
    let Some(version) = viewer_version()? else {
        return Err(CliError::Machine(format!(
            "found no {VIEWER} on the path, expected the viewer of version {RERUN}: {}, then: {VIEWER} {}",
            how_to_install(),
            args.recording.display()
        )));
    };
    if !is_matching(&version) {
        let how = how_to_install();
        output::message(&format!("warning: found {version}, expected {RERUN}: should it not open the file, {how}"));
    }
    open(&args.recording)
}

/// What the viewer calls itself, such as `rerun-cli 0.36.3`; none when it is not installed.
///
/// # Errors
/// When it is installed and cannot be started.
pub fn viewer_version() -> Result<Option<String>, CliError> {
    match Command::new(VIEWER).arg("--version").output() {
        Ok(output) => {
            let text = String::from_utf8_lossy(&output.stdout);
            let words: Vec<&str> = text.split_whitespace().take(2).collect();
            Ok(Some(if words.is_empty() { format!("{VIEWER} of no version") } else { words.join(" ") }))
        }
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(CliError::Machine(format!("failed to start {VIEWER}: {error}"))),
    }
}

/// True when the viewer is of the version that the recordings are made for.
pub fn is_matching(version: &str) -> bool {
    version.split_whitespace().any(|word| word == RERUN)
}

/// How to get the matching viewer.
pub fn how_to_install() -> String {
    format!("`pip install rerun-sdk=={RERUN}` or `cargo install rerun-cli@{RERUN} --locked` installs it")
}

fn open(recording: &Path) -> Result<Exit, CliError> {
    let status = Command::new(VIEWER).arg(recording).status();
    let status = status.map_err(|error| CliError::Machine(format!("failed to start {VIEWER}: {error}")))?;
    if status.success() {
        Ok(Exit::Met)
    } else {
        Err(CliError::Machine(format!("failed to show {}: {VIEWER} ended with {status}", recording.display())))
    }
}
