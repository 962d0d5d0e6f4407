//! Names of files that runs write, which names of scenarios and plans must leave alone.

/// The files of the report on all runs, in the folder that has a folder for each scenario.
pub const REPORTS: [&str; 4] = ["report.html", "summary.csv", "summary.json", "junit.xml"];

/// The most bytes of the name of a scenario or a plan: file systems have names of up to 255 bytes, and some files have the
/// name with an ending.
pub const MOST_BYTES: usize = 200;

/// The most bytes of the name of any file.
pub const MOST_OF_FILE_SYSTEM: usize = 255;
