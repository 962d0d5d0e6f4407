//! Citations, links and words of every text in the repository.
//!
//! - A citation of the method, `method.md` with an anchor, names a heading of that page.
//! - A relative Markdown link leads to a file that exists, and its anchor to a heading of that file.
//! - Words that the glossary has replaced do not come back. The patterns below are written in parts, so that a search
//!   for them does not find this file.

use std::{
    collections::HashMap,
    fs,
    path::{Path, PathBuf},
};

/// Folders and files that are read, relative to the repository.
const READ: [&str; 20] = [
    "src",
    "tests",
    "benches",
    "examples",
    "python",
    "tools",
    "schemas",
    "docs",
    "assets",
    "scenarios",
    ".ci",
    ".github",
    "README.md",
    "ARCHITECTURE.md",
    "CHANGELOG.md",
    "CITATION.cff",
    "CONTRIBUTING.md",
    "SECURITY.md",
    "Cargo.toml",
    "justfile",
];

/// This file, which has to name what it looks for.
const THIS_FILE: &str = "tests/citations.rs";

/// A text of the repository.
struct Page {
    /// Relative to the repository, with `/` between its parts.
    name: String,
    text: String,
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Every text file under [`READ`], in the order of names. Files that are not UTF-8 are pictures.
fn pages() -> Vec<Page> {
    let mut files = Vec::new();
    READ.iter().for_each(|name| collect(&root().join(name), &mut files));
    files.sort();
    let page = |file: PathBuf| {
        let text = fs::read_to_string(&file).ok()?;
        let parts: Vec<_> = file.strip_prefix(root()).ok()?.iter().map(|part| part.to_string_lossy()).collect();
        Some(Page { name: parts.join("/"), text })
    };
    files.into_iter().filter_map(page).collect()
}

/// The files at or under `path`; nothing where there is no such path.
fn collect(path: &Path, files: &mut Vec<PathBuf>) {
    if let Ok(entries) = fs::read_dir(path) {
        entries.flatten().for_each(|entry| collect(&entry.path(), files));
    } else if path.is_file() {
        files.push(path.to_owned());
    }
}

// ---- Headings and their anchors ----

/// The anchor that GitHub gives a heading: lower case, without punctuation, with `-` for a space.
fn slug(heading: &str) -> String {
    let kept = |c: char| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_');
    heading
        .trim()
        .chars()
        .filter(|&c| kept(c))
        .flat_map(char::to_lowercase)
        .map(|c| if c == ' ' { '-' } else { c })
        .collect()
}

/// A heading's text without links: `[text](target)` becomes `text`.
fn without_links(heading: &str) -> String {
    let mut plain = heading.to_owned();
    for link in links_of_line(heading) {
        plain = plain.replace(&format!("]({})", link), "]");
    }
    plain
}

/// The anchors of a Markdown text. Of equal headings the second has `-1` behind it, the third `-2`.
fn anchors(markdown: &str) -> Vec<String> {
    let mut seen: HashMap<String, usize> = HashMap::new();
    let heading = |line: &str| {
        let text = line.trim_start_matches('#');
        let depth = line.len() - text.len();
        ((1..=6).contains(&depth) && text.starts_with(' ')).then(|| slug(&without_links(text)))
    };
    let numbered = |slug: String| {
        let count = seen.entry(slug.clone()).or_default();
        *count += 1;
        if *count == 1 { slug } else { format!("{slug}-{}", *count - 1) }
    };
    prose(markdown).filter_map(|(_, line)| heading(&line)).map(numbered).collect()
}

/// The lines of a Markdown text outside code fences, with their numbers; inline code is blanked in links only, see
/// [`links_of_line`].
fn prose(markdown: &str) -> impl Iterator<Item = (usize, String)> + '_ {
    let mut fenced = false;
    markdown.lines().enumerate().filter_map(move |(index, line)| {
        let fence = line.trim_start().starts_with("```");
        fenced ^= fence;
        (!fence && !fenced).then(|| (index + 1, line.to_owned()))
    })
}

/// The targets of the links and pictures of a line, `[text](target)`, outside inline code.
fn links_of_line(line: &str) -> Vec<String> {
    let code_is_even = |end: usize| line[..end].matches('`').count().is_multiple_of(2);
    let opened = line.match_indices("](").filter(|(at, _)| code_is_even(*at));
    let target = |(at, _): (usize, &str)| {
        let inside = &line[at + 2..];
        Some(inside[..inside.find(')')?].split(' ').next()?.to_owned())
    };
    opened.filter_map(target).collect()
}

/// The file and the anchor of a link in a page; `None` for an address outside the repository.
fn linked<'t>(page: &str, target: &'t str) -> Option<(PathBuf, Option<&'t str>)> {
    if target.contains("://") || target.starts_with("mailto:") {
        return None;
    }
    let (file, anchor) = target.split_once('#').map_or((target, None), |(file, anchor)| (file, Some(anchor)));
    let page = root().join(page);
    let folder = page.parent().unwrap_or(root());
    Some((if file.is_empty() { page.clone() } else { folder.join(file) }, anchor))
}

/// What is wrong with a page's link.
fn broken(page: &str, target: &str) -> Option<String> {
    let (file, anchor) = linked(page, target)?;
    if !file.exists() {
        return Some(format!("{target}: there is no such file"));
    }
    let anchor = anchor.filter(|_| file.extension().is_some_and(|extension| extension == "md"))?;
    let found = anchors(&fs::read_to_string(&file).ok()?).iter().any(|heading| heading == anchor);
    (!found).then(|| format!("{target}: there is no such heading"))
}

#[test]
fn every_relative_link_leads_somewhere() {
    let mut wrong = Vec::new();
    for Page { name, text } in pages().into_iter().filter(|page| page.name.ends_with(".md")) {
        for (line, content) in prose(&text) {
            let targets = links_of_line(&content);
            wrong
                .extend(targets.iter().filter_map(|target| Some(format!("{name}:{line}: {}", broken(&name, target)?))));
        }
    }
    assert!(wrong.is_empty(), "broken links:\n{}", wrong.join("\n"));
}

#[test]
fn every_citation_of_the_method_names_a_heading() {
    let method = fs::read_to_string(root().join("docs/method.md")).expect("docs/method.md is there");
    let headings = anchors(&method);
    let cited = concat!("method", ".md#");
    let mut wrong = Vec::new();
    for Page { name, text } in pages().into_iter().filter(|page| page.name != THIS_FILE) {
        for (index, line) in text.lines().enumerate() {
            for (at, _) in line.match_indices(cited) {
                let is_slug = |c: &char| c.is_ascii_alphanumeric() || *c == '-';
                let anchor: String = line[at + cited.len()..].chars().take_while(is_slug).collect();
                if !headings.contains(&anchor) {
                    wrong.push(format!("{name}:{}: {cited}{anchor}", index + 1));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "citations without a heading in docs/method.md:\n{}", wrong.join("\n"));
}

#[test]
fn sections_of_the_method_are_numbered_without_gaps() {
    let method = fs::read_to_string(root().join("docs/method.md")).expect("docs/method.md is there");
    let (mut chapter, mut section) = (0, 0);
    for (line, heading) in prose(&method).filter(|(_, line)| line.starts_with("## ") || line.starts_with("### ")) {
        let number = heading.split(' ').nth(1).unwrap_or_default();
        let expected = if heading.starts_with("## ") {
            (chapter, section) = (chapter + 1, 0);
            format!("{chapter}.")
        } else {
            section += 1;
            format!("{chapter}.{section}")
        };
        assert_eq!(number, expected, "docs/method.md:{line}");
    }
    assert!(chapter > 0, "docs/method.md has no numbered headings");
}

// ---- Words ----

/// A phrase that no text may have.
struct Banned {
    phrase: String,
    /// Whether a letter may come before it, and after it.
    open: [bool; 2],
    any_case: bool,
}

impl Banned {
    fn new(parts: &[&str], open: [bool; 2], any_case: bool) -> Self {
        Self { phrase: parts.concat(), open, any_case }
    }

    /// Where the phrase begins in a text.
    fn places(&self, text: &str) -> Vec<usize> {
        let (text, phrase) = if self.any_case {
            (text.to_ascii_lowercase(), self.phrase.to_ascii_lowercase())
        } else {
            (text.to_owned(), self.phrase.clone())
        };
        let is_word = |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || c == '_');
        let stands = |at: &usize| {
            let (before, after) = (text[..*at].chars().next_back(), text[at + phrase.len()..].chars().next());
            (self.open[0] || !is_word(before)) && (self.open[1] || !is_word(after))
        };
        text.match_indices(&phrase).map(|(at, _)| at).filter(stands).collect()
    }
}

/// The words that the glossary has replaced; no page, name or message has them.
fn banned() -> Vec<Banned> {
    let (whole, start, part) = ([false, false], [false, true], [true, true]);
    vec![
        Banned::new(&["METHOD ", "section"], part, true),
        Banned::new(&["prac", "tis"], part, true),
        Banned::new(&["he", "at"], whole, true),
        Banned::new(&["he", "ats"], whole, true),
        Banned::new(&["on", "looker"], start, true),
        Banned::new(&["in ", "earnest"], start, true),
        Banned::new(&["a", "new"], whole, true),
        Banned::new(&["le", "st"], whole, true),
        Banned::new(&["at ", "hand"], whole, true),
        Banned::new(&["is ", "none"], [true, false], false),
    ]
}

/// A text with its line breaks and comment marks replaced by a space each, and where each line begins in it: a phrase
/// may run over the end of a line.
fn flattened(text: &str) -> (String, Vec<usize>) {
    let (mut flat, mut starts) = (String::with_capacity(text.len()), Vec::new());
    for line in text.lines() {
        starts.push(flat.len());
        flat.push_str(line.trim_start().trim_start_matches(['/', '!', '#', '*']).trim());
        flat.push(' ');
    }
    (flat, starts)
}

#[test]
fn no_text_has_a_word_that_the_glossary_has_replaced() {
    let banned = banned();
    let mut wrong = Vec::new();
    for Page { name, text } in pages().into_iter().filter(|page| page.name != THIS_FILE) {
        let (flat, starts) = flattened(&text);
        for banned in &banned {
            let line = |at: usize| starts.partition_point(|&start| start <= at);
            let places = banned.places(&flat).into_iter().map(line);
            wrong.extend(places.map(|line| format!("{name}:{line}: {}", banned.phrase)));
        }
    }
    assert!(wrong.is_empty(), "{} words to replace:\n{}", wrong.len(), wrong.join("\n"));
}

// ---- The rules themselves ----

#[test]
fn anchors_are_those_of_github() {
    assert_eq!(slug("3.3 The person's response"), "33-the-persons-response");
    assert_eq!(slug("6.10 Safety factor"), "610-safety-factor");
    assert_eq!(slug("`--jobs` and `--seed`"), "--jobs-and---seed");
    assert_eq!(slug("Grasp_library, screening"), "grasp_library-screening");
    let page = "# One\n## Two [links](a.md)\n```\n# code\n```\n## One\n####### seven\n#hash\n";
    assert_eq!(anchors(page), ["one", "two-links", "one-1"]);
}

#[test]
fn links_are_found_outside_code_and_their_targets_are_checked() {
    assert_eq!(links_of_line("see [a](b.md#c), ![p](d.png \"title\") and `[x](y)`"), ["b.md#c", "d.png"]);
    assert_eq!(linked("docs/ci.md", "https://rerun.io"), None);
    assert_eq!(broken("README.md", "LICENSE"), None);
    assert!(broken("docs/ci.md", "nowhere.md").is_some());
    assert!(broken("README.md", "docs/ci.md#no-such-heading").is_some());
}

#[test]
fn a_banned_phrase_is_found_as_a_whole_word_and_across_lines() {
    let find = |phrase: &[&str], open, text: &str| Banned::new(phrase, open, true).places(text).len();
    assert_eq!(find(&["le", "st"], [false, false], "at least; unless; bolest"), 0);
    assert_eq!(find(&["fo", "o"], [false, false], "foo, Foo_bar; foo"), 2);
    assert_eq!(find(&["fo", "o"], [false, true], "food and a foo"), 2);
    let (flat, starts) = flattened("/// one\n//! two\nthree");
    assert_eq!(flat, "one two three ");
    assert_eq!(starts, [0, 4, 8]);
}
