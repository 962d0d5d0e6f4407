//! `benchdog explain`: what a verdict or a check means, as `docs/verdicts.md` says. The page is part of the program, so the two
//! cannot differ.

use clap::{Args, builder::PossibleValuesParser};

use super::{
    exit::{CliError, Exit},
    help, output,
};
use crate::report::columns;

/// The page.
const PAGE: &str = include_str!("../../docs/verdicts.md");

/// `benchdog explain`.
#[derive(Clone, Debug, Args)]
#[command(after_help = help::EXPLAIN)]
pub struct ExplainArgs {
    /// A verdict, a check or a self-check, as verdict.json and the tables name it; by default a list of all
    #[arg(value_parser = PossibleValuesParser::new(names()))]
    pub name: Option<String>,
}

/// Prints the section of a name, or a list of all names.
pub fn explain(args: &ExplainArgs) -> Result<Exit, CliError> {
    let text = match &args.name {
        Some(name) => section_text(name),
        None => list(),
    };
    output::print(&text)?;
    Ok(Exit::Met)
}

/// A part of the page with a heading of the second level.
struct Chapter {
    /// Its heading.
    title: &'static str,
    /// Its headings of the third level.
    sections: Vec<Section>,
}

/// What the page says of one verdict, check or self-check.
struct Section {
    /// The heading: the name in files and tables.
    name: &'static str,
    /// What is below the heading, without its picture.
    body: String,
}

impl Section {
    /// The first paragraph, in a line.
    fn summary(&self) -> String {
        let lines = self.body.lines().take_while(|line| !line.trim().is_empty());
        lines.map(str::trim).collect::<Vec<_>>().join(" ")
    }
}

/// The chapters of the page that have sections.
fn chapters() -> Vec<Chapter> {
    let chapter = |text: &'static str| {
        let mut parts = text.split("\n### ");
        let title = parts.next().and_then(|start| start.lines().next()).unwrap_or_default();
        Chapter { title: title.trim(), sections: parts.map(section).collect() }
    };
    PAGE.split("\n## ").skip(1).map(chapter).filter(|chapter| !chapter.sections.is_empty()).collect()
}

fn section(text: &'static str) -> Section {
    let (name, body) = text.split_once('\n').unwrap_or((text, ""));
    let paragraphs = body.trim().split("\n\n").filter(|paragraph| !paragraph.starts_with("!["));
    Section { name: name.trim(), body: paragraphs.collect::<Vec<_>>().join("\n\n") }
}

/// Every name that has a section, in the order of the page.
fn names() -> Vec<&'static str> {
    chapters().iter().flat_map(|chapter| &chapter.sections).map(|section| section.name).collect()
}

/// The section of a name; empty if no section has it, which the parser of the arguments excludes.
fn section_text(name: &str) -> String {
    let sections = chapters().into_iter().flat_map(|chapter| chapter.sections);
    sections
        .filter(|section| section.name == name)
        .map(|Section { name, body }| format!("{name}\n\n{body}\n"))
        .collect()
}

/// Every name with its first sentence.
fn list() -> String {
    let row = |section: &Section| vec![format!("  {}", section.name), section.summary()];
    let of_chapter = |chapter: &Chapter| {
        let rows: Vec<_> = chapter.sections.iter().map(row).collect();
        format!("{}\n{}", chapter.title, columns::aligned(&rows, 2))
    };
    chapters().iter().map(of_chapter).collect::<Vec<_>>().join("\n")
}
