//! `benchdog inspect` of damaged recordings: an error in one line and exit code 2, with little memory.

#![cfg(all(feature = "recording", target_os = "linux"))]

use std::{fs, path::Path, process::Command};

use crate::process::{benchdog, folder, slipping_scenario, stderr};

/// The header of a recording of the rerun version that is read.
const HEADER: &[u8] = b"RRF2\x00\x24\x03\x00\x01\x02\x00\x00";

/// Inspects a file with at most 2 GB of addresses, and returns the message.
#[track_caller]
fn refused(folder: &Path, bytes: &[u8], arguments: &str) -> String {
    fs::write(folder.join("a.rrd"), bytes).unwrap();
    let script = format!("ulimit -v 2000000; exec {} inspect a.rrd {arguments}", env!("CARGO_BIN_EXE_benchdog"));
    let output = Command::new("sh").current_dir(folder).args(["-c", &script]).output().unwrap();
    let text = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert!(text.starts_with("error: failed to read a.rrd: found ") && text.lines().count() == 1, "{text}");
    text
}

#[test]
fn lengths_and_counts_beyond_the_file_are_refused() {
    let folder = folder(&[]);
    let footer = |count: u32| [&[0; 20][..], b"RRF2FOOT", &count.to_le_bytes()].concat();
    let text = refused(folder.path(), &[HEADER, &footer(u32::MAX)].concat(), "");
    assert!(text.contains("a footer with 4294967295 indexes"), "{text}");
    for length in [1 << 62, 1 << 40, u64::MAX] {
        let message = [1_u64.to_le_bytes(), u64::to_le_bytes(length)].concat();
        let text = refused(folder.path(), &[HEADER, &message, &footer(1)].concat(), "");
        assert!(text.contains(&format!("a message of {length} bytes at byte 12")), "{text}");
    }
}

#[test]
fn a_trace_that_is_not_that_of_the_verdict_is_not_judged() {
    let folder = folder(&[]);
    let scenario = slipping_scenario(folder.path(), "slips", "slips");
    let output = benchdog(folder.path(), &["run", &scenario]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let whole = fs::read(folder.path().join("out/slips/recording.rrd")).unwrap();
    for share in [0.2, 0.4, 0.6, 0.8, 0.95] {
        let mut bytes = whole.clone();
        let place = (bytes.len() as f64 * share) as usize;
        bytes[place..place + 400].fill(0xa5);
        refused(folder.path(), &bytes, "--check");
    }
}
