//! One source file: the paths that it names, and what its modules import.

use std::collections::{BTreeMap, BTreeSet};

use super::lexer::{Token, tokens, without_tests};

/// A module's place in the crate: the names on the way down from the root.
pub type Module = Vec<String>;

/// A name that a module brings in with `use`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Import {
    /// The path as it is written.
    pub path: Vec<String>,
    /// Whether other modules may take the name from here.
    pub is_public: bool,
}

/// A path of an expression, a type or a pattern, and the module that it stands in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mention {
    pub module: Module,
    pub path: Vec<String>,
}

/// A file.
#[derive(Clone, Debug, Default)]
pub struct Source {
    /// Path under `src`.
    pub file: String,
    /// The file's own module.
    pub module: Module,
    /// The modules that are written out inside the file.
    pub inline: BTreeSet<Module>,
    /// `mod name;` for tests only: files that do not count.
    pub test_modules: Vec<String>,
    /// For the file's own module and each inline one, the names that it imports.
    pub imports: BTreeMap<Module, BTreeMap<String, Import>>,
    /// Modules of which everything is imported, `use path::*`.
    pub globs: Vec<(Module, Import)>,
    /// All other paths of at least two names.
    pub mentions: Vec<Mention>,
    /// Every name outside `use` and `mod` that is no field's: what of its imports the file uses itself.
    pub names: BTreeSet<String>,
}

/// The module of a file: `a/b.rs` and `a/b/mod.rs` are `a::b`.
fn module_of(file: &str) -> Module {
    let path = file.trim_end_matches(".rs");
    let path = path.strip_suffix("/mod").unwrap_or(path);
    if matches!(path, "lib" | "main") { Vec::new() } else { path.split('/').map(str::to_owned).collect() }
}

impl Source {
    /// Reads a file's text; `file` is its path under `src`, with `/` between its parts.
    pub fn read(file: &str, text: &str) -> Self {
        let (tokens, test_modules) = without_tests(&tokens(text));
        let mut source = Self { file: file.to_owned(), module: module_of(file), test_modules, ..Self::default() };
        source.walk(&tokens);
        source
    }

    fn walk(&mut self, tokens: &[Token]) {
        // The inline modules that are open, each with the depth of its braces.
        let mut open: Vec<(usize, String)> = Vec::new();
        let (mut depth, mut at) = (0, 0);
        while at < tokens.len() {
            let module: Module = self.module.iter().chain(open.iter().map(|(_, name)| name)).cloned().collect();
            match &tokens[at..] {
                [Token::Word(word), Token::Word(name), Token::Mark('{'), ..] if word == "mod" => {
                    depth += 1;
                    open.push((depth, name.clone()));
                    self.inline.insert([&module[..], std::slice::from_ref(name)].concat());
                    at += 3;
                }
                [Token::Mark('{'), ..] => (depth, at) = (depth + 1, at + 1),
                [Token::Mark('}'), ..] => {
                    open.retain(|(opened, _)| *opened != depth);
                    (depth, at) = (depth - 1, at + 1);
                }
                [Token::Word(word), next, ..] if word == "use" && *next != Token::Mark('<') => {
                    let end = tokens[at..].iter().position(|token| *token == Token::Mark(';')).unwrap_or(0);
                    self.import(&module, &tokens[at + 1..at + end], is_public(&tokens[..at]));
                    at += end.max(1);
                }
                [Token::Word(word), Token::Word(_), Token::Mark(';'), ..] if word == "mod" => at += 2,
                [Token::Word(word), ..] => {
                    let after_dot = at > 0 && tokens[at - 1] == Token::Mark('.');
                    let path = path_at(&tokens[at..]);
                    let is_field = tokens.get(at + 1) == Some(&Token::Mark(':'));
                    if !after_dot && !is_field {
                        self.names.insert(word.clone());
                    }
                    at += 2 * path.len() - 1;
                    if path.len() > 1 && !after_dot {
                        self.mentions.push(Mention { module, path });
                    }
                }
                // `::name` and `<T as Trait>::name` begin with no name of ours.
                [Token::Separator, Token::Word(_), ..] => at += 1 + 2 * path_at(&tokens[at + 1..]).len() - 1,
                _ => at += 1,
            }
        }
    }

    fn import(&mut self, module: &Module, tree: &[Token], is_public: bool) {
        for (path, alias) in leaves(tree, &[]) {
            let import = Import { path, is_public };
            match alias.as_str() {
                "*" => self.globs.push((module.clone(), import)),
                _ => _ = self.imports.entry(module.clone()).or_default().insert(alias, import),
            }
        }
    }
}

/// Whether the item that begins after these tokens is `pub`, or `pub` to some module.
fn is_public(before: &[Token]) -> bool {
    match before {
        [.., Token::Word(word)] => word == "pub",
        [.., Token::Mark(')')] => {
            let opened = before.iter().rposition(|token| *token == Token::Mark('('));
            opened.and_then(|at| at.checked_sub(1)).is_some_and(|at| before[at].is_word("pub"))
        }
        _ => false,
    }
}

/// `a::b::c` at the start of some tokens, the first of which is a word.
fn path_at(tokens: &[Token]) -> Vec<String> {
    let mut path = Vec::new();
    let mut rest = tokens;
    while let [Token::Word(word), after @ ..] = rest {
        path.push(word.clone());
        match after {
            [Token::Separator, next @ ..] => rest = next,
            _ => break,
        }
    }
    path
}

/// The paths of a `use` tree with the names that they get.
fn leaves(tree: &[Token], prefix: &[String]) -> Vec<(Vec<String>, String)> {
    let own = path_at(tree);
    let path = [prefix, &own].concat();
    // `a::b` has a separator between its names; one more leads to a group or a star.
    let rest = &tree[(2 * own.len()).saturating_sub(1).min(tree.len())..];
    let rest = if rest.first() == Some(&Token::Separator) { &rest[1..] } else { rest };
    match rest {
        [Token::Mark('{'), group @ .., Token::Mark('}')] => {
            split_at_commas(group).into_iter().flat_map(|part| leaves(part, &path)).collect()
        }
        [Token::Mark('*'), ..] => vec![(path, "*".to_owned())],
        [Token::Word(word), Token::Word(alias)] if word == "as" => vec![(path, alias.clone())],
        _ => leaf(path).into_iter().collect(),
    }
}

/// A path and its last name; `a::self` is `a`.
fn leaf(mut path: Vec<String>) -> Option<(Vec<String>, String)> {
    if path.len() > 1 && path.last().is_some_and(|last| last == "self") {
        path.pop();
    }
    let name = path.last()?.clone();
    Some((path, name))
}

fn split_at_commas(tokens: &[Token]) -> Vec<&[Token]> {
    let (mut parts, mut depth, mut start) = (Vec::new(), 0, 0);
    for (at, token) in tokens.iter().enumerate() {
        match token {
            Token::Mark('{') => depth += 1,
            Token::Mark('}') => depth -= 1,
            Token::Mark(',') if depth == 0 => {
                parts.push(&tokens[start..at]);
                start = at + 1;
            }
            _ => {}
        }
    }
    parts.push(&tokens[start..]);
    parts.into_iter().filter(|part| !part.is_empty()).collect()
}

#[cfg(test)]
mod rules {
    use super::*;

    fn path(text: &str) -> Vec<String> {
        text.split("::").map(str::to_owned).collect()
    }

    #[test]
    fn a_use_tree_has_its_leaves() {
        let source =
            Source::read("a/b.rs", "pub(super) use super::{self as up, c::{D, e::{self, F}}, g::*}; use h as i;");
        let imports = &source.imports[&path("a::b")];
        let found: Vec<_> = imports.iter().map(|(name, import)| (name.as_str(), import.path.join("::"))).collect();
        let expected =
            [("D", "super::c::D"), ("F", "super::c::e::F"), ("e", "super::c::e"), ("i", "h"), ("up", "super")];
        // `self as up` keeps its `self`: one module either way.
        let found: Vec<_> = found.iter().map(|(name, path)| (*name, path.trim_end_matches("::self"))).collect();
        assert_eq!(found, expected);
        assert!(imports["D"].is_public && !imports["i"].is_public);
        assert_eq!(source.globs, [(path("a::b"), Import { path: path("super::g"), is_public: true })]);
    }

    #[test]
    fn paths_in_code_are_found_with_the_module_that_they_stand_in() {
        let text = "fn f() { x.y::<T>(); crate::a::B::new(g::h) } pub mod m { fn k() -> super::L { ::n::o() } } fn p(q: r::S) {}";
        let source = Source::read("z.rs", text);
        let found: Vec<_> = source.mentions.iter().map(|m| (m.module.join("::"), m.path.join("::"))).collect();
        let expected = [("z", "crate::a::B::new"), ("z", "g::h"), ("z::m", "super::L"), ("z", "r::S")];
        assert_eq!(found, expected.map(|(module, path)| (module.to_owned(), path.to_owned())));
        assert_eq!(source.inline, BTreeSet::from([path("z::m")]));
        assert!(source.names.contains("p") && !source.names.contains("q") && !source.names.contains("y"));
    }
}
