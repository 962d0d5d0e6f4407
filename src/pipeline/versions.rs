//! Versions of Benchdog and of the engines that verdicts depend on.

use std::{collections::BTreeMap, sync::LazyLock};

/// The engines and their versions. `Cargo.toml` requires exactly these, so that no build can have others; a test compares
/// them with `Cargo.toml` and `Cargo.lock`.
const ENGINES: [(&str, &str); 3] = [("clarabel", "0.11.1"), ("parry3d-f64", "0.31.1"), ("rapier3d-f64", "0.36.1")];

/// The version of rerun whose file format and viewer are used.
pub const RERUN: &str = "0.36.3";

/// The text of `--version`.
pub static LONG: LazyLock<String> = LazyLock::new(|| {
    let engines = ENGINES.iter().map(|(name, version)| format!("\n{name} {version}"));
    let rerun =
        if cfg!(feature = "recording") { format!("\nrerun {RERUN}") } else { "\nrerun: built without".to_owned() };
    format!("{}{}{rerun}", env!("CARGO_PKG_VERSION"), engines.collect::<String>())
});

/// The versions in verdicts, by name.
pub fn versions() -> BTreeMap<String, String> {
    let own = ("benchdog", env!("CARGO_PKG_VERSION"));
    std::iter::once(own).chain(ENGINES).map(|(name, version)| (name.into(), version.into())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_build_has_these_versions() {
        let manifest: toml::Table = toml::from_str(include_str!("../../Cargo.toml")).unwrap();
        let lock: toml::Table = toml::from_str(include_str!("../../Cargo.lock")).unwrap();
        let packages = lock["package"].as_array().unwrap();
        for (name, version) in ENGINES.into_iter().chain([("rerun", RERUN)]) {
            let dependency = &manifest["dependencies"][name];
            let required = dependency.get("version").unwrap_or(dependency).as_str();
            assert_eq!(required, Some(format!("={version}").as_str()), "{name} in Cargo.toml");
            let locked: Vec<_> = packages.iter().filter(|package| package["name"].as_str() == Some(name)).collect();
            let [locked] = locked[..] else { panic!("{} versions of {name} in Cargo.lock", locked.len()) };
            assert_eq!(locked["version"].as_str(), Some(version), "{name} in Cargo.lock");
        }
    }
}
