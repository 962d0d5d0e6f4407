//! What a user may have meant by a mistyped name: the most similar one of those that are known.

use std::{
    io,
    path::{Path, PathBuf},
};

/// The least Jaro-Winkler similarity of a suggestion: two letters that are swapped or one that is missing give more, other words less.
const LEAST_SIMILARITY: f64 = 0.8;

/// The most entries of a folder that are compared with the name of a file.
const MOST_ENTRIES: usize = 10_000;

/// The most similar of some names, if one is similar; of equally similar ones the first.
#[must_use]
pub fn nearest<'a>(found: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    most_similar(known.into_iter().filter(|name| *name != found).map(|name| (similarity(found, name), name)))
}

fn similarity(a: &str, b: &str) -> f64 {
    strsim::jaro_winkler(&a.to_lowercase(), &b.to_lowercase())
}

fn most_similar<'a>(names: impl Iterator<Item = (f64, &'a str)>) -> Option<&'a str> {
    let mut best: Option<(f64, &str)> = None;
    for (similarity, name) in names {
        if similarity >= LEAST_SIMILARITY && best.is_none_or(|(most, _)| similarity > most) {
            best = Some((similarity, name));
        }
    }
    best.map(|(_, name)| name)
}

/// The similarity of the names of two files. An extension that both have says nothing.
fn similarity_of_files(a: &str, b: &str) -> f64 {
    match (a.rsplit_once('.'), b.rsplit_once('.')) {
        (Some((a, of_a)), Some((b, of_b))) if of_a == of_b => similarity(a, b),
        _ => similarity(a, b),
    }
}

/// The end of a message about an unknown name: `; did you mean "friction"?`, or nothing.
#[must_use]
pub fn did_you_mean<'a>(found: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    suggestion(nearest(found, known))
}

fn suggestion(name: Option<&str>) -> String {
    name.map(|name| format!("; did you mean \"{name}\"?")).unwrap_or_default()
}

/// As [`did_you_mean`], for a message of a reader of files about an unknown key or variant, which lists those that are known:
/// ``unknown field `a`, expected one of `b`, `c` ``. Nothing for any other message.
#[must_use]
pub fn meant_by(message: &str) -> String {
    suggestion(meant(message))
}

/// The name that a message of [`meant_by`] suggests.
#[must_use]
pub fn meant(message: &str) -> Option<&str> {
    let start = ["unknown field `", "unknown variant `"].iter().find_map(|start| message.find(start))?;
    let mut names = message[start..].split('`').skip(1).step_by(2);
    nearest(names.next()?, names)
}

/// As [`did_you_mean`], for a value that was found and the values that were expected, in words. Only names in quotation marks are
/// values: `"saw"`, and `"drill", "knife"`, `one of foam, balsa` or `an arm of the robot: left, right`.
#[must_use]
pub fn meant_by_value(found: &str, expected: &str) -> String {
    let Some(found) = found.strip_prefix('"').and_then(|found| found.strip_suffix('"')) else { return String::new() };
    if expected.contains('"') {
        return did_you_mean(found, expected.split('"').skip(1).step_by(2));
    }
    let list = expected.strip_prefix("one of ").or_else(|| expected.rsplit_once(": ").map(|(_, list)| list));
    did_you_mean(found, list.into_iter().flat_map(|list| list.split(", ")))
}

/// An error of opening a file, with the name of a similar one beside it if there is no such file.
pub(super) fn of_opening(path: &Path, error: io::Error) -> io::Error {
    if error.kind() != io::ErrorKind::NotFound {
        return error;
    }
    match similar_file(path) {
        Some(similar) => {
            io::Error::new(io::ErrorKind::NotFound, format!("{error}; did you mean \"{}\"?", similar.display()))
        }
        None => error,
    }
}

/// A file that is similar to one that does not exist: its name is mistyped, or that of a folder above.
fn similar_file(path: &Path) -> Option<PathBuf> {
    similar_path(path, |path| !path.is_dir())
}

/// A path that exists, is similar to one that does not, and is of a kind.
fn similar_path(path: &Path, is_of_kind: fn(&Path) -> bool) -> Option<PathBuf> {
    let name = path.file_name()?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    if !here.exists() {
        let meant = similar_path(folder, Path::is_dir)?.join(name);
        return meant.exists().then_some(meant);
    }
    let entries = here.read_dir().ok()?.take(MOST_ENTRIES).flatten();
    let entries = entries.filter(|entry| is_of_kind(&entry.path()));
    let mut names: Vec<String> = entries.filter_map(|entry| entry.file_name().into_string().ok()).collect();
    names.sort();
    let known = names.iter().map(String::as_str).filter(|known| !known.starts_with('.'));
    let found = name.to_str()?;
    most_similar(known.map(|known| (similarity_of_files(found, known), known))).map(|name| folder.join(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_similar_name_is_suggested_and_another_is_not() {
        assert_eq!(nearest("frictoin", ["force_n", "friction"]), Some("friction"));
        assert_eq!(nearest("Baxter", ["dual-panda", "baxter"]), Some("baxter"));
        assert_eq!(nearest("cheese", ["acrylic", "balsa", "foam"]), None);
        assert_eq!(nearest("foam", ["foam"]), None, "the name itself is no suggestion");
        assert_eq!(nearest("", ["foam"]), None);
    }

    #[test]
    fn messages_of_readers_have_the_known_names() {
        let unknown = "unknown field `frictoin`, expected `force_n` or `friction`";
        assert_eq!(meant_by(unknown), "; did you mean \"friction\"?");
        assert_eq!(meant_by("unknown variant `dril`, expected one of `drill`, `cut`"), "; did you mean \"drill\"?");
        assert_eq!(meant_by("missing field `name`"), "");
        assert_eq!(meant_by("unknown field `friction`"), "");
    }

    #[test]
    fn values_are_compared_with_the_list_of_those_expected() {
        assert_eq!(meant_by_value("\"fome\"", "one of balsa, foam"), "; did you mean \"foam\"?");
        assert_eq!(meant_by_value("\"knif\"", "\"drill\", \"knife\""), "; did you mean \"knife\"?");
        assert_eq!(meant_by_value("\"letf\"", "an arm of the robot: left, right"), "; did you mean \"left\"?");
        assert_eq!(meant_by_value("0.3", "one of 0.31, 0.32"), "");
        assert_eq!(meant_by_value("\"a/b\"", "letters, digits, `-`, `_` and `.`"), "");
    }

    #[test]
    fn a_missing_file_is_compared_with_those_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("scenarios")).unwrap();
        std::fs::write(folder.path().join("scenarios/quickstart.toml"), "").unwrap();
        let similar = |path: &str| similar_file(&folder.path().join(path)).map(|path| path.display().to_string());
        let found = Some(folder.path().join("scenarios/quickstart.toml").display().to_string());
        assert_eq!(similar("scenarios/quikstart.toml"), found);
        assert_eq!(similar("scenaros/quickstart.toml"), found);
        assert_eq!(similar("scenaros/other.toml"), None);
        assert_eq!(similar("scenarioss"), None, "a folder is no file");
        assert_eq!(similar("plan.json"), None);
        assert_eq!(similar("scenarios/a.toml"), None, "the extension alone is no similarity");
    }
}
