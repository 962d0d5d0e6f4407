//! Bare poses as 4x4 homogeneous matrices: nested lists in JSON, or rows of numbers in text.

use std::path::Path;

use serde_saphyr::Spanned;

use super::{
    super::{InputError, InputErrorKind},
    grasp::ForeignGrasp,
    yaml,
};
use crate::model::frames::{MatrixRecord, Pose};

/// The frame of the poses: a bare matrix names none.
const FRAME: &str = "object";

/// A matrix and the line of its first number, from 1.
type Matrix = (usize, [[f64; 4]; 4]);

/// True if the first thing of a text that is no comment is a number, within brackets or not.
pub fn is_matrices(text: &str) -> bool {
    let is_content = |line: &&str| !line.trim().is_empty() && !line.trim_start().starts_with('#');
    let mut words = text
        .lines()
        .filter(is_content)
        .flat_map(|line| line.split(['[', ' ', '\t', ',']))
        .filter(|word| !word.is_empty());
    words.next().is_some_and(|word| word.trim_end_matches(']').parse::<f64>().is_ok())
}

/// The grasps of a text: one 4x4 matrix or a list of them in JSON; or rows of numbers between spaces or commas, four of 4 numbers
/// or one of 16 for each matrix. They are named `grasp_0`, `grasp_1` and so on.
pub fn grasps(path: &Path, text: &str) -> Result<Vec<ForeignGrasp>, InputError> {
    let matrices = if text.trim_start().starts_with('[') { of_lists(path, text)? } else { of_rows(path, text)? };
    let grasp = |(number, (line, matrix)): (usize, Matrix)| {
        let name = format!("grasp_{number}");
        let x_fh = Pose::try_from(MatrixRecord { matrix });
        Ok(ForeignGrasp {
            x_fh: x_fh.map_err(|problem| at(path, line, &name, InputErrorKind::Syntax(problem)))?,
            line,
            key: name.clone(),
            name,
            frame: FRAME.into(),
            confidence: None,
            max_force_n: None,
        })
    };
    matrices.into_iter().enumerate().map(grasp).collect()
}

fn at(path: &Path, line: usize, key: &str, kind: InputErrorKind) -> InputError {
    InputError { file: path.to_owned(), line: Some(line), key: Some(key.into()), kind }
}

/// The matrices of nested lists.
fn of_lists(path: &Path, text: &str) -> Result<Vec<Matrix>, InputError> {
    let depth = text.chars().filter(|c| !c.is_whitespace()).take_while(|c| *c == '[').count();
    let matrices: Vec<Spanned<[[f64; 4]; 4]>> = if depth > 2 {
        yaml::documents::<Vec<_>>(path, text)?.into_iter().flatten().collect()
    } else {
        yaml::documents(path, text)?
    };
    Ok(matrices.into_iter().map(|matrix| (yaml::line(&matrix), matrix.value)).collect())
}

/// The matrices of rows of numbers. Lines that begin with `#` are comments.
fn of_rows(path: &Path, text: &str) -> Result<Vec<Matrix>, InputError> {
    let mut numbers: Vec<(usize, f64)> = Vec::new();
    let mut wanted = None;
    for (number, row) in text.lines().enumerate() {
        let line = number + 1;
        if row.trim_start().starts_with('#') {
            continue;
        }
        let words: Vec<&str> = row.split([',', ';', ' ', '\t']).filter(|word| !word.is_empty()).collect();
        let wrong = |found: String, expected: &str| {
            at(path, line, "matrix", InputErrorKind::Value { found, expected: expected.into() })
        };
        let count = *wanted.get_or_insert(if words.len() == 16 { 16 } else { 4 });
        if !words.is_empty() && words.len() != count {
            return Err(wrong(format!("{} numbers", words.len()), "rows of 4 numbers, four a matrix, or of 16"));
        }
        for word in words {
            let value = word.parse::<f64>().map_err(|_| wrong(format!("\"{word}\""), "a number"))?;
            numbers.push((line, value));
        }
    }
    let matrices = numbers.chunks(16).map(|chunk| {
        let line = chunk[0].0;
        let row = |row: usize| -> Option<[f64; 4]> {
            let of_row: Vec<f64> = chunk.get(4 * row..4 * row + 4)?.iter().map(|(_, value)| *value).collect();
            of_row.try_into().ok()
        };
        let found = format!("a matrix with {} of 16 numbers", chunk.len());
        let short =
            || at(path, line, "matrix", InputErrorKind::Value { found, expected: "four rows of 4 numbers".into() });
        let rows = [row(0), row(1), row(2), row(3)];
        match rows {
            [Some(a), Some(b), Some(c), Some(d)] => Ok((line, [a, b, c, d])),
            _ => Err(short()),
        }
    });
    matrices.collect()
}
