//! What the cases are made of: files of the repository.

use std::{fs, path::Path};

use crate::driver::Files;

/// A file of the repository.
pub fn read(path: &str) -> Vec<u8> {
    fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// A text of the repository.
pub fn text(path: &str) -> String {
    String::from_utf8(read(path)).unwrap()
}

/// A case of these files: their names, and their paths in the repository.
pub fn files(files: &[(&str, &str)]) -> Files {
    files.iter().map(|(name, path)| ((*name).to_owned(), read(path))).collect()
}

/// A case of these texts by their names.
pub fn texts(texts: &[(&str, &str)]) -> Files {
    texts.iter().map(|(name, text)| ((*name).to_owned(), text.as_bytes().to_vec())).collect()
}

/// Paths of the files of a folder of the repository that have this extension.
pub fn paths(folder: &str, extension: &str) -> Vec<String> {
    let entries = fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut paths: Vec<_> =
        names.filter(|name| name.ends_with(extension)).map(|name| format!("{folder}/{name}")).collect();
    paths.sort();
    paths
}

/// A scenario with most sections.
pub const SCENARIO: &str = r#"format = 1
name = "all"

[object]
size_m = [0.50, 0.40, 0.030]
material = "foam"

[operation]
kind = "cut"
point_m = [0.10, 0.0]
force_n = 30.0
direction_o = [0.0, 1.0, 0.0]

[load]
kind = "path"
speed_m_s = 0.05
centre_m = [0.0, 0.0]
lateral_share = 0.1

[grip]
force_n = 30.0
friction = 0.6

[human]
place = "given"
x_m = 1.2
y_m = 0.0
heading_deg = 180.0
handedness = "left"
elbow_deg = [30.0, 100.0]

[tool]
length_m = 0.1

[comfort]
weight_muscular = 1.0
weight_peripersonal = 0.5

[limits]
slip_mm = 1.0
slip_deg = 2.0
deflection_mm = 10.0

[planner]
kind = "comfort"
seed = 3
evaluations = 10

[sweep]
runs = 100
friction = { kind = "normal", mean = 0.5, sd = 0.1, min = 0.1 }
force_factor = { kind = "discrete", values = [0.9, 1.1], weights = [1.0, 2.0] }

[expect]
verdict = "holds"
"#;

/// A scenario of one hold, without operation and load.
pub const HEAD: &str = "format = 1\nname = \"all\"\n\n[object]\nsize_m = [0.50, 0.40, 0.030]\nmaterial = \"foam\"\n\n";

/// An operation.
pub const DRILL: &str = "[operation]\nkind = \"drill\"\npoint_m = [0.0, 0.0]\nforce_n = 15.0\n\n";
