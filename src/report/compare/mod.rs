//! A comparison of two results on the console and as a page.

use maud::html as markup;

use super::{columns::aligned, html::document};
use crate::compare::{CRITERIA, Change, ChangeKind, Comparison};

/// The head of the table of changes.
const HEAD: [&str; 6] = ["", "name", "what", "before", "after", "by"];

/// A kind of change in words, with its class in the style sheet.
fn words(kind: ChangeKind) -> (&'static str, &'static str) {
    match kind {
        ChangeKind::Regression => ("REGRESSION", "failed"),
        ChangeKind::Improvement => ("improvement", "ok"),
        ChangeKind::Moved => ("moved", "skipped"),
        ChangeKind::New => ("new", "skipped"),
    }
}

/// The number of changes by kind: `12 compared: 1 regression, 2 improvements, 0 moved, 1 new`.
#[must_use]
pub fn sentence(comparison: &Comparison) -> String {
    let number = |kind| comparison.count(kind);
    let plural = |count: usize, word: &str| format!("{count} {word}{}", if count == 1 { "" } else { "s" });
    format!(
        "{} compared: {}, {}, {} moved, {} new",
        comparison.compared,
        plural(number(ChangeKind::Regression), "regression"),
        plural(number(ChangeKind::Improvement), "improvement"),
        number(ChangeKind::Moved),
        number(ChangeKind::New)
    )
}

/// What another version of this name means for the comparison.
fn meaning(name: &str) -> &'static str {
    if name == CRITERIA { ": verdicts by other criteria are not comparable" } else { "" }
}

/// A table of the changes, the versions that differ, and the number of changes.
#[must_use]
pub fn text(comparison: &Comparison) -> String {
    let head = HEAD.map(str::to_owned).to_vec();
    let changes = comparison.changes.iter().map(|change| {
        let Change { kind, name, what, before, after, by } = change.clone();
        vec![words(kind).0.to_owned(), name, what, before, after, by]
    });
    let rows: Vec<Vec<String>> = std::iter::once(head).chain(changes).collect();
    // A head alone says nothing.
    let mut text = if rows.len() > 1 { aligned(&rows, HEAD.len()) } else { String::new() };
    for (name, before, after) in &comparison.versions {
        text.push_str(&format!("version of {name}: {before}, now {after}{}\n", meaning(name)));
    }
    text.push_str(&sentence(comparison));
    text.push('\n');
    text
}

/// The page.
#[must_use]
pub fn html(comparison: &Comparison, tolerance: f64) -> String {
    let title = format!("Benchdog: {}", sentence(comparison));
    let body = markup! {
        p.made { "Made by benchdog " (env!("CARGO_PKG_VERSION")) ". Tolerance " (tolerance) "." }
        @for (name, before, after) in &comparison.versions {
            p { "Version of " (name) ": " (before) ", now " (after) (meaning(name)) "." }
        }
        @if comparison.changes.is_empty() { p { "Nothing changed by more than the tolerance." } }
        @else {
            div.wide {
                table {
                    tr { @for head in HEAD { th { (head) } } }
                    @for change in &comparison.changes {
                        @let (word, class) = words(change.kind);
                        tr {
                            td class=(class) { (word) }
                            td.name { (change.name) }
                            @for cell in [&change.what, &change.before, &change.after, &change.by] { td { (cell) } }
                        }
                    }
                }
            }
        }
    };
    document(&title, "", &body)
}
