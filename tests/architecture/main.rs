//! The layout of `src`, held to the two tables of ARCHITECTURE.md: which module may use which, and which crate is used
//! where. No files use each other in a circle.
//!
//! The arrows are read from the text: `use` items and all other paths, followed through re-exports to the file that
//! defines the item. Code for tests does not count.

mod graph;
mod lexer;
mod source;

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};

use graph::{Arrow, Crate, circles};
use source::Source;

/// A row of a table: a name, and the names beside it.
type Table = BTreeMap<String, BTreeSet<String>>;

/// Stands in a table for every module.
const ANY: &str = "any";

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(name: &str) -> String {
    fs::read_to_string(root().join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The table of ARCHITECTURE.md with these two columns: the names in backquotes of each row.
fn table(header: [&str; 2]) -> Table {
    let page = read("ARCHITECTURE.md");
    let cells = |line: &str| -> Vec<String> {
        line.trim().trim_matches('|').split('|').map(str::trim).map(str::to_owned).collect()
    };
    let rows: Vec<_> = page.lines().skip_while(|line| !cells(line).starts_with(&header.map(str::to_owned))).collect();
    assert!(!rows.is_empty(), "ARCHITECTURE.md has no table with the columns {header:?}");
    let names = |cell: &str| cell.split('`').skip(1).step_by(2).map(str::to_owned).collect::<Vec<_>>();
    let row = |line: &&str| {
        let cells = cells(line);
        names(&cells[0]).into_iter().map(|name| (name, names(&cells[1]).into_iter().collect())).collect::<Vec<_>>()
    };
    rows.iter().skip(2).take_while(|line| line.starts_with('|')).flat_map(row).collect()
}

/// Names of the crates that the library and the program depend on, as code writes them.
fn dependencies() -> BTreeSet<String> {
    let manifest: toml::Table = read("Cargo.toml").parse().expect("Cargo.toml is TOML");
    let dependencies = manifest["dependencies"].as_table().expect("a table of dependencies");
    dependencies.keys().map(|name| name.replace('-', "_")).collect()
}

fn source_files(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("src can be read").flatten() {
        let path = entry.path();
        if path.is_dir() {
            source_files(&path, files);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
}

fn this_crate() -> Crate {
    let src = root().join("src");
    let mut files = Vec::new();
    source_files(&src, &mut files);
    files.sort();
    let source = |file: &PathBuf| {
        let parts: Vec<_> = file.strip_prefix(&src).unwrap().iter().map(|part| part.to_string_lossy()).collect();
        Source::read(&parts.join("/"), &fs::read_to_string(file).unwrap())
    };
    Crate::new(files.iter().map(source).collect(), dependencies())
}

/// The module at the top of the tree that a file belongs to: its folder, or its own name.
fn top(file: &str) -> &str {
    file.split('/').next().unwrap_or(file).trim_end_matches(".rs")
}

/// The arrow that leads from one file to another, in words.
fn told(arrows: &BTreeSet<Arrow>, from: &str, to: &str) -> String {
    let by = arrows.iter().find(|arrow| arrow.from == from && arrow.to == to).map_or("", |arrow| &arrow.by);
    format!("{from} -> {to} ({by})")
}

#[test]
fn arrows_between_modules_are_those_of_the_table() {
    let (may_use, modules) = (table(["module", "may use"]), this_crate());
    let found: BTreeSet<_> = modules.files().map(|file| top(file).to_owned()).collect();
    let listed: BTreeSet<_> = may_use.keys().cloned().collect();
    let mut wrong: Vec<_> =
        found.symmetric_difference(&listed).map(|name| format!("{name}: not both in src and in the table")).collect();
    let (arrows, _) = modules.arrows();
    for Arrow { from, to, by } in &arrows {
        let (user, used) = (top(from), top(to));
        if user != used && !may_use.get(user).is_some_and(|allowed| allowed.contains(used)) {
            wrong.push(format!("{user} may not use {used}: {from} -> {to} ({by})"));
        }
    }
    assert!(wrong.is_empty(), "{} broken rules of ARCHITECTURE.md:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn the_table_of_modules_has_no_circle() {
    let may_use = table(["module", "may use"]);
    let arrow = |from: &String, to: &String| Arrow { from: from.clone(), to: to.clone(), by: String::new() };
    let arrows = may_use.iter().flat_map(|(from, to)| to.iter().map(move |to| arrow(from, to))).collect();
    assert_eq!(circles(&arrows), BTreeSet::new());
}

#[test]
fn no_files_use_each_other_in_a_circle() {
    let (arrows, _) = this_crate().arrows();
    let chain = |circle: &Vec<String>| {
        let ends = circle.iter().zip(circle.iter().cycle().skip(1));
        ends.map(|(from, to)| told(&arrows, from, to)).collect::<Vec<_>>().join(", ")
    };
    let circles: Vec<_> = circles(&arrows).iter().map(chain).collect();
    assert!(circles.is_empty(), "{} circles of files:\n{}", circles.len(), circles.join("\n"));
}

#[test]
fn other_crates_are_used_where_the_table_says() {
    let (used_by, modules) = (table(["crate", "used by"]), this_crate());
    let named: Table = used_by.into_iter().map(|(name, users)| (name.replace('-', "_"), users)).collect();
    let listed: BTreeSet<_> = named.keys().cloned().collect();
    let mut wrong: Vec<_> = dependencies()
        .symmetric_difference(&listed)
        .map(|name| format!("{name}: not both in Cargo.toml and in the table"))
        .collect();
    let (_, dependences) = modules.arrows();
    for found in &dependences {
        let allowed = |users: &BTreeSet<String>| users.contains(ANY) || users.contains(top(&found.file));
        if named.get(&found.name).is_some_and(|users| !allowed(users)) {
            wrong.push(format!("{} may not use {}: {}", top(&found.file), found.name, found.file));
        }
    }
    for (name, users) in &named {
        let unused =
            |user: &&String| *user != ANY && !dependences.iter().any(|d| d.name == *name && top(&d.file) == **user);
        wrong.extend(
            users.iter().filter(unused).map(|user| format!("{name}: the table names {user}, which does not use it")),
        );
    }
    assert!(wrong.is_empty(), "{} broken rules of ARCHITECTURE.md:\n{}", wrong.len(), wrong.join("\n"));
}
