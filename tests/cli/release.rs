//! What a release consists of beside the binary: manual pages, and one version in every file that states it.

use std::{collections::BTreeSet, fs};

use serde_json::Value;

use crate::{
    common::root,
    process::{benchdog, folder},
};

const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The commands below one, as its help lists them.
fn commands(of: &[&str]) -> Vec<String> {
    let folder = folder(&[]);
    let help = String::from_utf8(benchdog(folder.path(), &[of, &["--help"]].concat()).stdout).unwrap();
    let list = help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    let names = list.filter_map(|line| line.strip_prefix("  ")?.split(' ').next().map(str::to_owned));
    names.filter(|name| !["", "help"].contains(&name.as_str())).collect()
}

#[test]
fn every_command_has_a_manual_page_with_its_examples() {
    let folder = folder(&[]);
    let output = benchdog(folder.path(), &["man", "--out", "man1"]);
    assert_eq!(output.status.code(), Some(0));
    let files = fs::read_dir(folder.path().join("man1")).unwrap();
    let pages: BTreeSet<_> = files.map(|file| file.unwrap().file_name().to_string_lossy().into_owned()).collect();

    let mut expected = BTreeSet::from(["benchdog.1".to_owned()]);
    for command in commands(&[]) {
        expected.insert(format!("benchdog-{command}.1"));
        expected.extend(commands(&[&command]).iter().map(|sub| format!("benchdog-{command}-{sub}.1")));
    }
    assert!(expected.contains("benchdog-robot-new.1") && expected.len() > 25, "{expected:?}");
    assert_eq!(pages, expected);

    let page = fs::read_to_string(folder.path().join("man1/benchdog-run.1")).unwrap();
    let title = format!(".TH \"benchdog-run\" \"1\" \"\" \"benchdog {VERSION}\" \"Benchdog manual\"\n");
    assert!(page.contains(&title), "the foot has the version: {page}");
    assert!(page.contains("\nbenchdog\\-run \\- Plan, simulate, judge, record and report scenarios\n"), "{page}");
    // A line of the help that begins with spaces keeps them, and its quotes are no request.
    assert!(page.contains(".nf\n") && page.contains("\n  benchdog run scenarios "), "{page}");
}

#[test]
fn the_main_page_is_printed_without_a_folder() {
    let folder = folder(&[]);
    let printed = benchdog(folder.path(), &["man"]).stdout;
    benchdog(folder.path(), &["man", "--out", "man1"]);
    assert_eq!(printed, fs::read(folder.path().join("man1/benchdog.1")).unwrap());
}

#[test]
fn the_changelog_and_the_citation_have_the_version() {
    let changelog = fs::read_to_string(root().join("CHANGELOG.md")).unwrap();
    let mut sections = changelog.lines().filter(|line| line.starts_with("## "));
    assert_eq!(sections.next(), Some("## [Unreleased]"));
    let section = sections.next().unwrap();
    let date = section.strip_prefix(&format!("## [{VERSION}] - ")).unwrap_or_else(|| panic!("{section}"));
    assert!(changelog.contains(&format!("\n[{VERSION}]: https://")), "a link for the version at the bottom");

    let text = fs::read_to_string(root().join("CITATION.cff")).unwrap();
    let citation: Value = serde_saphyr::from_str(&text).unwrap();
    assert_eq!((citation["version"].as_str(), citation["date-released"].as_str()), (Some(VERSION), Some(date)));
}
