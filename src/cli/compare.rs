//! `benchdog compare`: what changed between two results, and baseline files (`docs/method.md#106-comparison`).

use std::{
    fs,
    path::{Path, PathBuf},
};

use serde_json::Value;

use super::{
    exit::{CliError, Exit},
    format::Format,
    inputs, output,
    sweep::folder::SUMMARY,
    sweep_args::CompareArgs,
};
use crate::{
    compare::{Baseline, ChangeKind, compare as compared},
    input::{self, MOST_DOCUMENT, shown},
    model::{FORMAT, verdict::Verdict},
    report,
    sweep::summary::SweepSummary,
};

/// The file of a run with its verdict.
const VERDICT: &str = "verdict.json";

/// Compares two results, or writes the baseline of one.
pub fn compare(args: &CompareArgs) -> Result<Exit, CliError> {
    if !(0.0..=1.0).contains(&args.tolerance) {
        return Err(CliError::Usage(format!("--tolerance: found {}, expected a number from 0 to 1", args.tolerance)));
    }
    let mut read = Vec::new();
    let first = results(&args.before, &mut read)?;
    let second = args.after.as_deref().map(|path| results(path, &mut read)).transpose()?;
    inputs::protect(&read, args.write_baseline.iter().chain(&args.html).cloned())?;
    if second.as_ref().is_some_and(|second| have_no_kind_in_common(&first, second)) {
        let found = "found scenarios on one side and sweeps on the other, expected results of one kind";
        return Err(CliError::Usage(found.into()));
    }
    if let Some(path) = &args.write_baseline {
        report::file::write_whole(path, report::json::pretty(second.as_ref().unwrap_or(&first)).as_bytes())?;
    }
    let Some(second) = second else { return Ok(Exit::Met) };
    let comparison = compared(&first, &second, args.tolerance);
    if let Some(path) = &args.html {
        report::file::write_whole(path, report::compare::html(&comparison, args.tolerance).as_bytes())?;
    }
    match args.format {
        Format::Human => output::report(&report::compare::text(&comparison))?,
        Format::Json => output::print(&report::json::pretty(&comparison))?,
    }
    Ok(if comparison.count(ChangeKind::Regression) > 0 { Exit::NotMet } else { Exit::Met })
}

/// True for scenarios alone on one side and sweeps alone on the other.
fn have_no_kind_in_common(first: &Baseline, second: &Baseline) -> bool {
    let [first, second] = [first, second].map(|of| (of.scenarios.is_empty(), of.sweeps.is_empty()));
    matches!((first, second), ((true, _), (_, true)) | ((_, true), (true, _)))
}

/// The results at a path: a baseline, a verdict, a sweep, or a folder of verdicts and sweeps.
fn results(path: &Path, read: &mut Vec<PathBuf>) -> Result<Baseline, CliError> {
    let mut found = Baseline::empty();
    if path.is_dir() {
        for file in files_of(path)? {
            add(&mut found, &file, read)?;
        }
    } else {
        add(&mut found, path, read)?;
    }
    if found.is_empty() {
        let expected = "a folder of `benchdog run` or `benchdog sweep`, a verdict.json, a sweep.json or a baseline";
        return Err(CliError::Usage(format!("{}: found no results, expected {expected}", path.display())));
    }
    Ok(found)
}

/// The verdicts and sweeps of a folder and of the folders in it, by name.
fn files_of(folder: &Path) -> Result<Vec<PathBuf>, CliError> {
    let unreadable = |error: std::io::Error| CliError::Usage(format!("{}: failed to read: {error}", folder.display()));
    let mut folders = vec![folder.to_owned()];
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        if path.is_dir() {
            folders.push(path);
        }
    }
    folders.sort();
    let files = folders.iter().flat_map(|folder| [VERDICT, SUMMARY].map(|name| folder.join(name)));
    Ok(files.filter(|file| file.is_file()).collect())
}

/// Refuses a second result of one name: they would be mistaken for each other.
fn once(is_new: bool, path: &Path, name: &str) -> Result<(), CliError> {
    if is_new {
        return Ok(());
    }
    Err(CliError::Usage(format!("{}: name: found \"{}\", which another result has too", path.display(), shown(name))))
}

/// Adds the results of a file.
fn add(results: &mut Baseline, path: &Path, read: &mut Vec<PathBuf>) -> Result<(), CliError> {
    let shown = path.display();
    let text = input::text(path, MOST_DOCUMENT)
        .map_err(|error| CliError::Usage(format!("{shown}: failed to read: {error}")))?;
    read.push(path.to_owned());
    let wrong = |error: serde_json::Error| CliError::Usage(format!("{shown}:{}: {error}", error.line()));
    let value: Value = serde_json::from_str(&text).map_err(wrong)?;
    let kind = ["estimate", "scenarios", "verdict"].into_iter().find(|key| value.get(key).is_some());
    match kind {
        Some("estimate") => {
            let summary: SweepSummary = serde_json::from_str(&text).map_err(wrong)?;
            once(results.add_sweep(&summary), path, &summary.info.name)?;
        }
        Some("verdict") => {
            let verdict: Verdict = serde_json::from_str(&text).map_err(wrong)?;
            once(results.add_verdict(&verdict), path, &verdict.name)?;
        }
        Some(_) => {
            let baseline: Baseline = serde_json::from_str(&text).map_err(wrong)?;
            if baseline.format != FORMAT {
                return Err(CliError::Usage(format!("{shown}: format: found {}, expected {FORMAT}", baseline.format)));
            }
            results.versions.extend(baseline.versions);
            results.scenarios.extend(baseline.scenarios);
            results.sweeps.extend(baseline.sweeps);
        }
        None => {
            let expected = "a verdict (verdict.json), a sweep (sweep.json) or a baseline";
            return Err(CliError::Usage(format!("{shown}: found another JSON file, expected {expected}")));
        }
    }
    Ok(())
}
