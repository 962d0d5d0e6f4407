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
            "found no {VIEWER} on the path, expected the viewer of version {RERUN}: {}, then: {VIEWER} {}",
            how_to_install(),
            args.recording.display()
        )));
    };
    if !is_matching(&version) {
        let how = how_to_install();
        output::message(&format!("warning: found {version}, expected {RERUN}: if it does not open the file, {how}"));
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

/// True if the viewer has the version of the recordings.
pub fn is_matching(version: &str) -> bool {
    version.split_whitespace().any(|word| word == RERUN)
}

/// How to install the matching viewer.
pub fn how_to_install() -> String {
    format!("install it with `pip install rerun-sdk=={RERUN}` or `cargo install rerun-cli@{RERUN} --locked`")
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
