//! Colours of a terminal for messages and tables. They are added to finished text, word for word: without colours it is the same text.

use std::ops::Range;

use anstyle::{AnsiColor, Style};
use serde::{
    Deserialize as _,
    de::{IntoDeserializer as _, value::Error as ValueError},
};

use crate::model::verdict::VerdictKind;

const GOOD: Style = AnsiColor::Green.on_default();
const BAD: Style = AnsiColor::Red.on_default();
const UNSURE: Style = AnsiColor::Yellow.on_default();
const HINT: Style = AnsiColor::Cyan.on_default();

/// The beginnings of lines with a meaning of their own, as `output::message`, `report::Status` and `doctor` write them.
const STARTS: [(&str, Style); 9] = [
    ("error:", BAD.bold()),
    ("warning:", UNSURE.bold()),
    ("note:", HINT.bold()),
    ("note ", HINT),
    ("ok ", GOOD),
    ("FAIL ", BAD.bold()),
    ("ERROR ", BAD.bold()),
    ("WRONG ", BAD.bold()),
    ("skipped ", UNSURE),
];

/// The command that explains a verdict, below a table.
const EXPLAIN: &str = "benchdog explain ";

/// What follows a verdict in a sentence `NAME: VERDICT, expected ...`, `NAME: VERDICT; ...` or `NAME: VERDICT in stage ...`.
const AFTER_VERDICT: [&str; 3] = [", expected ", "; ", " in stage "];

/// The end of a row of checks that failed.
const FAILED: &str = "FAIL";

/// A text for people with colours: verdicts and results, checks that failed, beginnings of messages, hints.
pub fn painted(text: &str) -> String {
    let mut columns = Vec::new();
    text.split_inclusive('\n').map(|line| painted_line(line, &mut columns)).collect()
}

/// A line with colours. `columns` are those of the table that it is part of, as places in characters; a line with other columns ends it.
fn painted_line(line: &str, columns: &mut Vec<Range<usize>>) -> String {
    let (text, end) = line.strip_suffix('\n').map_or((line, ""), |text| (text, "\n"));
    let cells = cells(text);
    let is_head = cells.len() > 2 && cells.iter().any(|cell| is_column(&text[cell.clone()]));
    if is_head {
        *columns =
            cells.iter().filter(|cell| is_column(&text[(*cell).clone()])).map(|cell| places(text, cell)).collect();
        return line.to_owned();
    }
    if cells.len() < 2 {
        columns.clear();
    }
    let parts: Vec<(Range<usize>, Style)> = if text.starts_with(EXPLAIN) {
        vec![(0..text.len(), HINT)]
    } else if cells.len() > 2 && cells.last().is_some_and(|cell| &text[cell.clone()] == FAILED) {
        vec![(0..text.len(), BAD)]
    } else if let Some((start, style)) = STARTS.iter().find(|(start, _)| text.starts_with(start)) {
        vec![(0..start.trim_end().len(), *style)]
    } else if columns.is_empty() {
        of_sentence(text)
    } else {
        let is_below = |cell: &Range<usize>| columns.iter().any(|column| column.start == places(text, cell).start);
        let words = cells.into_iter().filter(is_below);
        words.filter_map(|cell| style_of(&text[cell.clone()]).map(|style| (cell, style))).collect()
    };
    let mut painted = String::with_capacity(text.len() + 16 * parts.len());
    let mut place = 0;
    for (part, style) in parts {
        painted.push_str(&text[place..part.start]);
        painted.push_str(&format!("{style}{}{style:#}", &text[part.clone()]));
        place = part.end;
    }
    painted + &text[place..] + end
}

/// The heads of columns with verdicts and results.
fn is_column(head: &str) -> bool {
    matches!(head, "verdict" | "result")
}

/// The verdict and the result of a sentence about one plan.
fn of_sentence(text: &str) -> Vec<(Range<usize>, Style)> {
    let Some(start) = text.find(": ").map(|place| place + 2) else { return Vec::new() };
    let rest = &text[start..];
    let Some(length) = AFTER_VERDICT.iter().filter_map(|after| rest.find(after)).min() else { return Vec::new() };
    let Some(verdict) = verdict_style(&rest[..length]) else { return Vec::new() };
    let mut parts = vec![(start..start + length, verdict)];
    if let Some((_, result)) = text.rsplit_once(": ")
        && let Some(style) = style_of(result)
        && result.len() < rest.len()
    {
        parts.push((text.len() - result.len()..text.len(), style));
    }
    parts
}

fn style_of(word: &str) -> Option<Style> {
    match word {
        "ok" => Some(GOOD),
        "FAIL" | "ERROR" => Some(BAD.bold()),
        "skipped" => Some(UNSURE),
        _ => verdict_style(word),
    }
}

fn verdict_style(word: &str) -> Option<Style> {
    let kind: Result<VerdictKind, ValueError> = VerdictKind::deserialize(word.into_deserializer());
    kind.ok().map(|kind| match kind {
        VerdictKind::Holds => GOOD,
        VerdictKind::NoVerdict => UNSURE,
        _ => BAD,
    })
}

/// The cells of a line of a table: two spaces or more are between them.
fn cells(text: &str) -> Vec<Range<usize>> {
    let mut cells = Vec::new();
    let mut start = 0;
    for part in text.split("  ") {
        let begin = start + part.len() - part.trim_start().len();
        let end = begin + part.trim().len();
        if begin < end {
            cells.push(begin..end);
        }
        start += part.len() + 2;
    }
    cells
}

/// A part of a line in characters: tables are aligned by them.
fn places(text: &str, part: &Range<usize>) -> Range<usize> {
    text[..part.start].chars().count()..text[..part.end].chars().count()
}

#[cfg(test)]
mod tests {
    use anstream::adapter::strip_str;

    use super::*;

    const TABLE: &str = "\
scenario    verdict  expected  result  slip mm
quickstart  holds    slips     FAIL       0.10
größe       slips    holds     FAIL       0.10
2 scenarios: 2 failed

quickstart: holds, expected slips: FAIL
check           unit     value     limit   margin
slip            mm       9.101     1.000   -8.101  FAIL
sag             mm       0.004    10.000    9.996
because       a hand slipped
benchdog explain slips says what this means and what helps
";

    #[test]
    fn without_its_colours_a_text_is_the_same() {
        for text in [TABLE, "", "\n\n", "error: a\nb\n", "a: b: c", "x  FAIL", "ok    cut: holds: every limit was kept"]
        {
            assert_eq!(strip_str(&painted(text)).to_string(), text);
        }
    }

    #[test]
    fn verdicts_results_and_failed_checks_have_colours() {
        let painted = painted(TABLE);
        let lines: Vec<&str> = painted.lines().collect();
        assert_eq!(lines[0], TABLE.lines().next().unwrap(), "the head has none");
        assert_eq!(
            lines[1],
            "quickstart  \u{1b}[32mholds\u{1b}[0m    slips     \u{1b}[1m\u{1b}[31mFAIL\u{1b}[0m       0.10"
        );
        assert!(lines[2].contains("\u{1b}[31mslips\u{1b}[0m"), "by characters, not by bytes: {}", lines[2]);
        assert_eq!(lines[5], "quickstart: \u{1b}[32mholds\u{1b}[0m, expected slips: \u{1b}[1m\u{1b}[31mFAIL\u{1b}[0m");
        assert!(lines[7].starts_with("\u{1b}[31mslip ") && lines[7].ends_with("FAIL\u{1b}[0m"), "{}", lines[7]);
        assert_eq!(lines[8], TABLE.lines().nth(8).unwrap(), "a check that passed has none");
        assert!(lines[10].starts_with("\u{1b}[36mbenchdog explain"));
    }

    #[test]
    fn messages_begin_with_a_colour() {
        assert!(painted("ok    cut: holds: every limit was kept").starts_with("\u{1b}[32mok\u{1b}[0m    cut"));
        assert_eq!(painted("error: x"), "\u{1b}[1m\u{1b}[31merror:\u{1b}[0m x");
        assert_eq!(painted("an error: x"), "an error: x");
        assert_eq!(painted("circle: no_verdict; 5 motions"), "circle: \u{1b}[33mno_verdict\u{1b}[0m; 5 motions");
    }
}
