//! Figures of `results/` in README and docs: a figure is followed by a comment that says what it is, and both must agree.
//!
//! `1.73<!-- = table1 task:cutting planner:comfort muscular_normalised -->` is the mean of the column `muscular_normalised` over
//! the rows of `results/table1.csv` that pass the filters; `*` at the end of a filter stands for any text. `count`, `min` and
//! `max` before the file take the place of the mean, `/` divides by a second one, and `100 *` makes a percentage.
//!
//! `BENCHDOG_WRITE_FIGURES=1 cargo test --release --test cli figures` writes the right ones into the pages, with as many decimals as
//! the old ones have.

use std::{collections::BTreeMap, fs};

use crate::common::root;

type Row = BTreeMap<String, String>;

/// One quantity of a table, such as `max physics planner:comfort slip_mm`.
fn quantity(text: &str) -> f64 {
    let mut words: Vec<_> = text.split_whitespace().collect();
    let over = if ["count", "mean", "min", "max"].contains(&words[0]) { words.remove(0) } else { "mean" };
    let file = words.remove(0);
    let column = if over == "count" { None } else { words.pop() };
    let path = root().join("results").join(format!("{file}.csv"));
    let csv = fs::read_to_string(&path).unwrap_or_else(|_| panic!("{text}: there is no {}", path.display()));
    let rows: Vec<Row> = csv::Reader::from_reader(csv.as_bytes()).deserialize().map(Result::unwrap).collect();
    let passes = |row: &Row| words.iter().all(|filter| filter_passes(row, filter));
    let rows: Vec<_> = rows.iter().filter(|row| passes(row)).collect();
    let Some(column) = column else { return rows.len() as f64 };
    let values: Vec<f64> = rows.iter().map(|row| row[column].parse().unwrap()).collect();
    assert!(!values.is_empty(), "{text}: no row passes");
    match over {
        "min" => values.into_iter().reduce(f64::min).unwrap(),
        "max" => values.into_iter().reduce(f64::max).unwrap(),
        _ => values.iter().sum::<f64>() / values.len() as f64,
    }
}

fn filter_passes(row: &Row, filter: &str) -> bool {
    let (column, wanted) = filter.split_once(':').unwrap_or_else(|| panic!("{filter}: expected column:value"));
    let value = row[column].replace(' ', "-");
    wanted.strip_suffix('*').map_or(value == wanted, |start| value.starts_with(start))
}

/// The value of an expression.
fn value(expression: &str) -> f64 {
    let (factor, rest) = match expression.trim().strip_prefix("100 *") {
        Some(rest) => (100.0, rest),
        None => (1.0, expression),
    };
    let (above, below) = rest.split_once(" / ").map_or((rest, None), |(above, below)| (above, Some(below)));
    factor * quantity(above) / below.map_or(1.0, quantity)
}

/// A figure of a page.
struct Figure {
    /// Where its comment begins in the page.
    at: usize,
    written: String,
    expression: String,
}

impl Figure {
    /// The value with as many decimals as are written.
    fn right(&self) -> String {
        let digits = self.written.split_once('.').map_or(0, |(_, decimals)| decimals.len());
        format!("{:.digits$}", value(&self.expression))
    }
}

/// The figures of a page with their expressions.
fn figures(page: &str) -> Vec<Figure> {
    let figure = |at: usize| {
        let is_part = |c: &char| c.is_ascii_digit() || ".-".contains(*c);
        let reversed: String = page[..at].chars().rev().take_while(is_part).collect();
        let written: String = reversed.chars().rev().collect();
        let expression = page[at + "<!-- = ".len()..].split("-->").next().unwrap_or_default();
        let expression = expression.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(!written.is_empty(), "{expression}: no figure before the comment");
        Figure { at, written, expression }
    };
    page.match_indices("<!-- = ").map(|(at, _)| figure(at)).collect()
}

/// The page with the right figures.
fn corrected(page: &str) -> String {
    let mut corrected = page.to_owned();
    // From the end, so that the places of those before do not move.
    for figure in figures(page).iter().rev() {
        corrected.replace_range(figure.at - figure.written.len()..figure.at, &figure.right());
    }
    corrected
}

#[test]
fn figures_of_the_results_in_readme_and_docs_are_right() {
    let pages = [("README.md", 3), ("docs/reproduction.md", 60), ("docs/tasks.md", 2)];
    for (name, least) in pages {
        let path = root().join(name);
        let page = fs::read_to_string(&path).unwrap();
        if std::env::var_os("BENCHDOG_WRITE_FIGURES").is_some() {
            fs::write(&path, corrected(&page)).unwrap();
            continue;
        }
        let figures = figures(&page);
        assert!(figures.len() >= least, "{name}: {} figures, at least {least} are expected", figures.len());
        let wrong = figures.iter().filter(|figure| figure.right() != figure.written);
        let wrong =
            wrong.map(|figure| format!("{}, expected {}: {}", figure.written, figure.right(), figure.expression));
        let wrong: Vec<_> = wrong.collect();
        assert!(wrong.is_empty(), "{name}:\n{}", wrong.join("\n"));
    }
}

#[test]
fn a_figure_is_found_before_its_comment_and_computed_from_the_table() {
    let page = "**99<!-- = count physics planner:comfort --> of 100, 0.00<!-- = table1\n task:cutting planner:random muscular_normalised -->";
    let found = figures(page);
    assert_eq!(found.len(), 2);
    assert_eq!((found[0].written.as_str(), found[0].right().as_str()), ("99", "25"));
    assert_eq!(found[1].expression, "table1 task:cutting planner:random muscular_normalised");
    assert_eq!(corrected(page), page.replace("99", "25").replace("0.00", "1.00"));
    assert_eq!(value("100 * count physics planner:comfort / count physics"), 25.0);
    let of = |over: &str| value(&format!("{over} plans planner:comfort operation:cut* objective"));
    assert!(of("min") < of("mean") && of("mean") < of("max"));
}
