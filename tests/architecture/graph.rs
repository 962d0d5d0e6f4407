//! The arrows between files: each path is followed to the file that defines its item.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use super::source::{Import, Module, Source};

/// Re-exports that are followed before a path counts as a circle of its own.
const MAX_REEXPORTS: usize = 16;

/// The whole crate.
pub struct Crate {
    sources: Vec<Source>,
    /// The file, by number, of every module: files and the modules inside them.
    modules: BTreeMap<Module, usize>,
    /// Names by which other crates are used.
    externals: BTreeSet<String>,
}

/// What a path leads to.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Target {
    /// A module by itself.
    Module(Module),
    /// An item, in the file of this number.
    Item(usize),
    /// An item of another crate.
    External(String),
}

/// Where a path stands: the module, and whether as a `use`, whose first name may not be another import of the same name.
#[derive(Clone, Copy)]
struct Scope<'a> {
    module: &'a Module,
    own_name: Option<&'a str>,
}

/// A file uses another one.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Arrow {
    pub from: String,
    pub to: String,
    /// The path that leads there, as it is written.
    pub by: String,
}

/// A file uses another crate.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Dependence {
    pub file: String,
    pub name: String,
}

impl Crate {
    /// The crate of these files, without those that only tests have. `externals` are the names of other crates.
    pub fn new(sources: Vec<Source>, externals: BTreeSet<String>) -> Self {
        let joined = |module: &Module, name: &String| [&module[..], std::slice::from_ref(name)].concat();
        let tests: BTreeSet<Module> =
            sources.iter().flat_map(|s| s.test_modules.iter().map(|name| joined(&s.module, name))).collect();
        let is_test = |source: &Source| tests.iter().any(|test| source.module.starts_with(test));
        let sources: Vec<_> = sources.into_iter().filter(|source| !is_test(source)).collect();
        let mut modules = BTreeMap::new();
        for (number, source) in sources.iter().enumerate() {
            // The program and the library share the root, which is the library's.
            modules.entry(source.module.clone()).or_insert(number);
            modules.extend(source.inline.iter().map(|inline| (inline.clone(), number)));
        }
        Self { sources, modules, externals }
    }

    /// The files' names.
    pub fn files(&self) -> impl Iterator<Item = &str> {
        self.sources.iter().map(|source| source.file.as_str())
    }

    /// Every arrow between two files, and every use of another crate.
    ///
    /// A module that is imported counts where a path goes through it. A name that a module takes from its own children to
    /// hand it on counts when the file uses it, too.
    pub fn arrows(&self) -> (BTreeSet<Arrow>, BTreeSet<Dependence>) {
        let (mut arrows, mut dependences) = (BTreeSet::new(), BTreeSet::new());
        for (number, source) in self.sources.iter().enumerate() {
            let mut add = |target: Option<Target>, path: &[String]| match target {
                Some(Target::Item(to)) if to != number => {
                    let (from, to) = (source.file.clone(), self.sources[to].file.clone());
                    arrows.insert(Arrow { from, to, by: path.join("::") });
                }
                Some(Target::External(name)) => _ = dependences.insert(Dependence { file: source.file.clone(), name }),
                _ => {}
            };
            for (module, imports) in &source.imports {
                for (name, import) in imports {
                    let target = self.resolve(&import.path, Scope { module, own_name: Some(name) }, 0);
                    let handed_on = import.is_public && self.is_below(&target, module) && !source.names.contains(name);
                    add(target.filter(|_| !handed_on), &import.path);
                }
            }
            for (module, import) in &source.globs {
                let target = self.resolve(&import.path, Scope { module, own_name: None }, 0);
                let handed_on = import.is_public && self.is_below(&target, module);
                let target = match target.filter(|_| !handed_on) {
                    Some(Target::Module(module)) => Some(Target::Item(self.modules[&module])),
                    other => other,
                };
                add(target, &import.path);
            }
            for mention in &source.mentions {
                let scope = Scope { module: &mention.module, own_name: None };
                add(self.resolve(&mention.path, scope, 0), &mention.path);
            }
        }
        (arrows, dependences)
    }

    /// Whether a target is in a file below a module.
    fn is_below(&self, target: &Option<Target>, module: &Module) -> bool {
        let is_below = |other: &Module| other.len() > module.len() && other.starts_with(module);
        match target {
            Some(Target::Item(file)) => is_below(&self.sources[*file].module),
            Some(Target::Module(other)) => is_below(other),
            _ => false,
        }
    }

    /// What a path that stands in a module leads to; `None` for items of the standard library and local names.
    fn resolve(&self, path: &[String], scope: Scope<'_>, depth: usize) -> Option<Target> {
        if depth > MAX_REEXPORTS {
            return None;
        }
        let (first, rest) = path.split_first()?;
        let module = scope.module;
        match first.as_str() {
            "crate" | "benchdog" => self.descend(Vec::new(), rest, depth),
            "self" => self.descend(module.clone(), rest, depth),
            "super" => {
                let supers = path.iter().take_while(|name| *name == "super").count();
                let up = module[..module.len().checked_sub(supers)?].to_vec();
                self.descend(up, &path[supers..], depth)
            }
            name => {
                let child = [&module[..], std::slice::from_ref(first)].concat();
                if self.modules.contains_key(&child) {
                    return self.descend(child, rest, depth);
                }
                if let Some(import) = self.import(module, name).filter(|_| scope.own_name != Some(name)) {
                    let path = [&import.path[..], rest].concat();
                    return self.resolve(&path, Scope { module, own_name: Some(name) }, depth + 1);
                }
                self.externals.contains(name).then(|| Target::External(name.to_owned()))
            }
        }
    }

    /// Follows a path down from a module, through re-exports.
    fn descend(&self, mut module: Module, path: &[String], depth: usize) -> Option<Target> {
        for (number, name) in path.iter().enumerate() {
            let child = [&module[..], std::slice::from_ref(name)].concat();
            if self.modules.contains_key(&child) {
                module = child;
                continue;
            }
            if let Some(import) = self.import(&module, name) {
                let path = [&import.path[..], &path[number + 1..]].concat();
                return self.resolve(&path, Scope { module: &module, own_name: Some(name) }, depth + 1);
            }
            return self.modules.get(&module).map(|file| Target::Item(*file));
        }
        self.modules.contains_key(&module).then_some(Target::Module(module))
    }

    fn import(&self, module: &Module, name: &str) -> Option<&Import> {
        let source = &self.sources[*self.modules.get(module)?];
        source.imports.get(module)?.get(name)
    }
}

/// The shortest circle through each file that is part of one, each told once, from its first file by name.
pub fn circles(arrows: &BTreeSet<Arrow>) -> BTreeSet<Vec<String>> {
    let mut next: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    arrows.iter().for_each(|arrow| _ = next.entry(&arrow.from).or_default().insert(&arrow.to));
    next.keys().filter_map(|file| shortest_circle(file, &next)).collect()
}

fn shortest_circle(file: &str, next: &BTreeMap<&str, BTreeSet<&str>>) -> Option<Vec<String>> {
    let mut before: BTreeMap<&str, &str> = BTreeMap::new();
    let mut queue = VecDeque::from([file]);
    while let Some(here) = queue.pop_front() {
        for &there in next.get(here).into_iter().flatten() {
            if there == file {
                let mut circle = vec![here.to_owned()];
                let mut at = here;
                while let Some(&back) = before.get(at) {
                    circle.push(back.to_owned());
                    at = back;
                }
                circle.reverse();
                let first = (0..circle.len()).min_by_key(|&at| &circle[at])?;
                circle.rotate_left(first);
                return Some(circle);
            }
            if there != file && !before.contains_key(there) {
                before.insert(there, here);
                queue.push_back(there);
            }
        }
    }
    None
}

#[cfg(test)]
mod rules {
    use super::*;

    fn of(files: &[(&str, &str)]) -> Crate {
        let sources = files.iter().map(|(file, text)| Source::read(file, text)).collect();
        Crate::new(sources, BTreeSet::from(["serde".to_owned()]))
    }

    fn arrows_of(files: &[(&str, &str)]) -> Vec<(String, String)> {
        of(files).arrows().0.into_iter().map(|arrow| (arrow.from, arrow.to)).collect()
    }

    fn pair(from: &str, to: &str) -> (String, String) {
        (from.to_owned(), to.to_owned())
    }

    #[test]
    fn a_name_that_a_folder_hands_on_leads_to_the_file_that_defines_it() {
        let folder = ("a/mod.rs", "mod b; mod c; pub use b::B; pub struct Own;");
        let found = arrows_of(&[folder, ("a/b.rs", "pub struct B;"), ("a/c.rs", "use super::B;")]);
        assert_eq!(found, [pair("a/c.rs", "a/b.rs")]);
        let found = arrows_of(&[folder, ("a/b.rs", "pub struct B;"), ("a/c.rs", "fn f(own: super::Own) {}")]);
        assert_eq!(found, [pair("a/c.rs", "a/mod.rs")]);
    }

    #[test]
    fn what_a_folder_uses_of_its_files_counts_and_what_it_hands_on_does_not() {
        let file = ("a/b.rs", "pub struct B;");
        assert!(arrows_of(&[("a/mod.rs", "mod b; pub use b::B;"), file]).is_empty());
        for text in ["mod b; use b::B;", "mod b; pub use b::B; fn f(b: B) {}", "mod b; fn f() { b::g() }"] {
            assert_eq!(arrows_of(&[("a/mod.rs", text), file]), [pair("a/mod.rs", "a/b.rs")], "{text}");
        }
    }

    #[test]
    fn an_imported_module_counts_where_a_path_goes_through_it() {
        let folder = ("a/mod.rs", "mod b; mod c; mod d;");
        let handed = ("a/b.rs", "pub use super::d::D;");
        let defined = ("a/d.rs", "pub struct D;");
        let found = arrows_of(&[folder, handed, defined, ("a/c.rs", "use super::b; fn f(d: b::D) {}")]);
        assert_eq!(found, [pair("a/b.rs", "a/d.rs"), pair("a/c.rs", "a/d.rs")]);
        assert!(arrows_of(&[folder, ("a/b.rs", ""), defined, ("a/c.rs", "use super::b;")]).is_empty());
    }

    #[test]
    fn modules_inside_files_and_files_of_tests_are_told_apart() {
        let files = [
            ("lib.rs", "pub mod a;"),
            ("a/mod.rs", "mod b; #[cfg(test)] mod tests; pub mod inner { pub struct I; pub use super::b::B; }"),
            ("a/b.rs", "pub struct B; fn f(i: crate::a::inner::I) {}"),
            ("a/tests.rs", "use super::b::B;"),
        ];
        let found = arrows_of(&files);
        assert_eq!(found, [pair("a/b.rs", "a/mod.rs"), pair("a/mod.rs", "a/b.rs")]);
    }

    #[test]
    fn other_crates_are_found_by_their_names() {
        let files = [("a.rs", "use serde::Serialize; mod serde {}"), ("b.rs", "#[derive(serde::Serialize)] struct S;")];
        let found: Vec<_> = of(&files).arrows().1.into_iter().map(|found| found.file).collect();
        // The first is a module of that name.
        assert_eq!(found, ["b.rs"]);
    }

    #[test]
    fn circles_are_chains_of_files() {
        let arrow = |from: &str, to: &str| Arrow { from: from.into(), to: to.into(), by: String::new() };
        let arrows =
            BTreeSet::from([arrow("c", "a"), arrow("a", "b"), arrow("b", "c"), arrow("d", "a"), arrow("b", "e")]);
        assert_eq!(circles(&arrows), BTreeSet::from([vec!["a".to_owned(), "b".to_owned(), "c".to_owned()]]));
    }
}
