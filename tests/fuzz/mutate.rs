//! Damages files: bytes of any, tokens and lines of text.

use std::ops::Range;

use rand::{RngExt as _, seq::IndexedRandom as _};
use rand_pcg::Pcg64;

use crate::driver::Files;

/// Numbers at the ends of what a type holds, and what is no number.
const NUMBERS: [&str; 34] = [
    "0",
    "-0",
    "-0.0",
    "1",
    "-1",
    "2",
    "1e308",
    "-1e308",
    "1e309",
    "1e-308",
    "5e-324",
    "1e-9",
    "1e9",
    "1e18",
    "1e300",
    "nan",
    "-nan",
    "inf",
    "-inf",
    "NaN",
    "Infinity",
    "255",
    "256",
    "65536",
    "4294967295",
    "4294967296",
    "9007199254740993",
    "9223372036854775807",
    "-9223372036854775808",
    "18446744073709551615",
    "18446744073709551616",
    "99999999999999999999999999999999",
    "0x7fffffffffffffff",
    "1_000_000_000",
];

/// Values that text may have in place of others.
const VALUES: [&str; 30] = [
    "",
    "\"\"",
    "null",
    "true",
    "false",
    "[]",
    "{}",
    "[[]]",
    "[{}]",
    "\"\\u0000\"",
    "\"\\u001b[2J\"",
    "\"\\ud800\"",
    "\"../../../etc/passwd\"",
    "\"/dev/null\"",
    "\".\"",
    "\"..\"",
    "\"CON\"",
    "\"a/b\\\\c\"",
    "\"\u{202e}\u{feff}\u{fffe}\"",
    "\"<b>&amp;]]>\"",
    "'''",
    "\"\"\"",
    "1979-05-27T07:32:00Z",
    "&a",
    "&lt;",
    "!!binary",
    "<<: *a",
    "<!-- -->",
    "<a/>",
    "\u{0}\u{1}\u{7f}\u{85}",
];

/// Opens and closes what may be nested.
const NESTED: [(&str, &str); 7] =
    [("[", "]"), ("{\"a\":", "}"), ("{a=", "}"), ("<a>", "</a>"), ("(", ")"), ("[[", "]]"), ("- ", "")];

/// How deep, and how long.
const COUNTS: [usize; 5] = [2, 17, 130, 3_000, 100_000];

/// The longest file that a mutation makes, bytes.
const LONGEST: usize = 2_000_000;

/// Mutates files with parts of others.
pub struct Mutator {
    /// Words, numbers and strings of all files.
    tokens: Vec<String>,
    /// Lines of all files.
    lines: Vec<String>,
}

impl Mutator {
    /// With the parts of these cases.
    pub fn of(cases: &[&Files]) -> Self {
        let (mut tokens, mut lines) = (Vec::new(), Vec::new());
        let files = cases.iter().flat_map(|files| files.iter());
        for text in files.filter_map(|(_, bytes)| str::from_utf8(bytes).ok()) {
            tokens.extend(ranges_of_tokens(text).into_iter().map(|range| text[range].to_owned()));
            lines.extend(text.lines().filter(|line| line.len() < 2_000).map(str::to_owned));
        }
        for parts in [&mut tokens, &mut lines] {
            parts.sort();
            parts.dedup();
        }
        Self { tokens, lines }
    }

    /// Mutates a file once.
    pub fn mutate(&self, bytes: &mut Vec<u8>, rng: &mut Pcg64) {
        match str::from_utf8(bytes) {
            Ok(text) if !text.is_empty() && !rng.random_bool(0.15) => {
                *bytes = self.mutated_text(text, rng).into_bytes();
            }
            _ => mutate_bytes(bytes, rng),
        }
        bytes.truncate(LONGEST);
    }

    fn mutated_text(&self, text: &str, rng: &mut Pcg64) -> String {
        let tokens = ranges_of_tokens(text);
        let is_number = |range: &&Range<usize>| text[(*range).clone()].parse::<f64>().is_ok();
        let numbers: Vec<_> = tokens.iter().filter(is_number).cloned().collect();
        let kind = rng.random_range(0..10);
        let Some(token) = (if kind < 4 { &numbers } else { &tokens }).choose(rng).cloned() else {
            return self.mutated_lines(text, rng);
        };
        let found = &text[token.clone()];
        let new = match kind {
            0..4 => number(found, rng),
            4 => VALUES.choose(rng).unwrap().to_string(),
            5 => self.tokens.choose(rng).unwrap().clone(),
            6 => match rng.random_range(0..4) {
                0 => String::new(),
                1 => format!("{found}{found}"),
                2 => format!("\"{}\"", odd_character(rng).to_string().repeat(*COUNTS.choose(rng).unwrap())),
                _ => format!("{found}{}", odd_character(rng)),
            },
            7 => {
                let ((open, close), count) = (NESTED.choose(rng).unwrap(), *COUNTS.choose(rng).unwrap());
                format!("{}{found}{}", open.repeat(count), close.repeat(if rng.random_bool(0.8) { count } else { 0 }))
            }
            8 => return swapped(text, token, tokens.choose(rng).unwrap().clone()),
            _ => return self.mutated_lines(text, rng),
        };
        replaced(text, token, &new)
    }

    /// Lines that are left out, repeated, moved or those of other files.
    fn mutated_lines(&self, text: &str, rng: &mut Pcg64) -> String {
        let mut lines: Vec<&str> = text.lines().collect();
        if lines.is_empty() {
            return text.to_owned();
        }
        let (place, other) = (rng.random_range(0..lines.len()), rng.random_range(0..lines.len()));
        match rng.random_range(0..6) {
            0 => drop(lines.remove(place)),
            1 => lines.insert(other, lines[place]),
            2 => lines.swap(place, other),
            3 => lines.truncate(place),
            4 => {
                let count = (*COUNTS.choose(rng).unwrap()).min(LONGEST / (lines[place].len() + 1));
                lines.splice(place..place, std::iter::repeat_n(lines[place], count));
            }
            _ => lines.insert(place, self.lines.choose(rng).unwrap()),
        }
        lines.join("\n") + "\n"
    }
}

/// A number in place of another: an extreme one, or nearly the same.
fn number(found: &str, rng: &mut Pcg64) -> String {
    let value: f64 = found.parse().unwrap_or(1.0);
    match rng.random_range(0..8) {
        0 => format!("-{found}"),
        1 => format!("{:?}", value * 10_f64.powi(rng.random_range(-12..=12))),
        2 => format!("{:?}", value * rng.random_range(0.5..1.5)),
        3 => format!("{}", value.round() as i64 + rng.random_range(-2..=2)),
        _ => NUMBERS.choose(rng).unwrap().to_string(),
    }
}

fn odd_character(rng: &mut Pcg64) -> char {
    *[
        '\u{0}',
        '\u{1}',
        '\u{1b}',
        '"',
        '\\',
        '\'',
        '<',
        '&',
        ',',
        ';',
        '\r',
        'é',
        '\u{202e}',
        '\u{ffff}',
        '\u{1f600}',
        'x',
        '9',
        ' ',
    ]
    .choose(rng)
    .unwrap()
}

/// The words, numbers and quoted strings of a text.
fn ranges_of_tokens(text: &str) -> Vec<Range<usize>> {
    let bytes = text.as_bytes();
    let is_word = |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'.' | b'-' | b'+') || byte >= 0x80;
    let (mut ranges, mut start) = (Vec::new(), 0);
    while start < bytes.len() {
        let rest = &bytes[start..];
        let length = match rest[0] {
            b'"' => rest[1..].iter().position(|&byte| byte == b'"' || byte == b'\n').map_or(1, |place| place + 2),
            byte if is_word(byte) => rest.iter().position(|&byte| !is_word(byte)).unwrap_or(rest.len()),
            _ => 0,
        };
        if length > 0 {
            ranges.push(start..start + length);
        }
        start += length.max(1);
    }
    ranges
}

fn replaced(text: &str, range: Range<usize>, new: &str) -> String {
    format!("{}{new}{}", &text[..range.start], &text[range.end..])
}

/// Two tokens that change places.
fn swapped(text: &str, a: Range<usize>, b: Range<usize>) -> String {
    let (first, second) = if a.start <= b.start { (a, b) } else { (b, a) };
    if first == second {
        return text.to_owned();
    }
    let between = &text[first.end..second.start];
    format!("{}{}{between}{}{}", &text[..first.start], &text[second.clone()], &text[first], &text[second.end..])
}

/// Damages bytes in one of several ways.
pub fn mutate_bytes(bytes: &mut Vec<u8>, rng: &mut Pcg64) {
    if bytes.is_empty() {
        bytes.push(rng.random());
        return;
    }
    let place = rng.random_range(0..bytes.len());
    let length = rng.random_range(1..=bytes.len().min(64));
    let range = place..(place + length).min(bytes.len());
    match rng.random_range(0..7) {
        0 => bytes.truncate(place),
        1 => bytes[place] ^= 1 << rng.random_range(0..8),
        2 => bytes[range].fill_with(|| rng.random()),
        3 => drop(bytes.drain(range)),
        4 => {
            let copy = bytes[range].to_vec();
            bytes.splice(place..place, copy);
        }
        5 => bytes.insert(place, rng.random()),
        _ => {
            // A length of 4 or 8 bytes, at a place where lengths are.
            let lengths = [u64::MAX, 1 << 62, 1 << 40, u64::from(u32::MAX), 1 << 31, 0, rng.random()];
            let place = place / 4 * 4;
            let width = if rng.random_bool(0.5) { 4 } else { 8 };
            let number = lengths.choose(rng).unwrap().to_le_bytes();
            bytes[place..].iter_mut().zip(&number[..width]).for_each(|(byte, of_number)| *byte = *of_number);
        }
    }
}
