//! `benchdog merge`: joins the parts of a sweep into the files that one sweep of all runs would have written.

use std::{
    io::{self, ErrorKind},
    path::Path,
};

use super::{
    exit::{CliError, Exit},
    inputs,
    progress::Progress,
    sweep::folder::{PLAN, RUNS, SUMMARY, SweepFolder},
    sweep_args::MergeArgs,
};
use crate::{
    input::{self, MOST_DOCUMENT, MOST_RECORDING},
    report,
    sweep::{
        info::{Shard, SweepInfo},
        record::RunRecord,
        summary::SweepSummary,
        table,
    },
};

/// One part of a sweep.
struct Part<'a> {
    folder: &'a Path,
    info: SweepInfo,
    shard: Shard,
    plan: Vec<u8>,
    records: Vec<RunRecord>,
}

/// Joins parts. All are read and compared before anything is written.
pub fn merge(args: &MergeArgs) -> Result<Exit, CliError> {
    let progress = Progress::begin("reading the parts", "")?;
    let parts = args.parts.iter().map(|folder| Part::read(folder)).collect::<Result<Vec<_>, _>>()?;
    let mut parts = in_order(parts)?;
    let folder = SweepFolder::new(&args.out);
    let read: Vec<_> = args.parts.iter().flat_map(|part| SweepFolder::new(part).files()).collect();
    inputs::protect(&read, folder.files())?;
    report::file::check_folder(&args.out)?;
    folder.begin()?;
    let info = SweepInfo { shard: None, ..parts[0].info.clone() };
    let mut records: Vec<RunRecord> = parts.iter_mut().flat_map(|part| std::mem::take(&mut part.records)).collect();
    records.sort_unstable_by_key(|record| record.index);
    // Each part has recorded the worst of its own runs, so it has those that are among the worst of all.
    let recording = |index: u64| {
        let Some(part) = parts.iter().find(|part| index % part.shard.of == part.shard.number - 1) else {
            return Ok(None);
        };
        let path = SweepFolder::new(part.folder).recording(index);
        match input::kept(&path, MOST_RECORDING) {
            // A program without recordings made the part.
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            read => read.map(Some).map_err(|error| unreadable(&path, &error, "")),
        }
    };
    folder.write(&info, &records, &parts[0].plan, &recording, args.format, &progress)
}

impl<'a> Part<'a> {
    fn read(folder: &'a Path) -> Result<Self, CliError> {
        let files = SweepFolder::new(folder);
        let read = |name: &str| {
            let path = files.file(name);
            let why = if name == SUMMARY { "; a part without it is not finished" } else { "" };
            let most_bytes = if name == RUNS { MOST_RECORDING } else { MOST_DOCUMENT };
            input::bytes(&path, most_bytes).map_err(|error| unreadable(&path, &error, why))
        };
        let wrong = |name: &str, problem: String| CliError::Usage(format!("{}:{problem}", files.file(name).display()));
        let summary: SweepSummary = serde_json::from_slice(&read(SUMMARY)?)
            .map_err(|error| wrong(SUMMARY, format!("{}: {error}", error.line())))?;
        let info = summary.info;
        let Some(shard) = info.shard else {
            return Err(wrong(SUMMARY, " shard: found none, expected a part (benchdog sweep --shard M/N)".into()));
        };
        let header = info.header();
        let text = String::from_utf8_lossy(&read(RUNS)?).into_owned();
        let records = table::read(&text, &header, false).map_err(|error| wrong(RUNS, error.to_string()))?;
        let complete = records.iter().map(|record| record.index).eq(shard.indices(info.runs));
        if !complete {
            let problem = format!(" found {} runs, expected all runs of part {shard} of {}", records.len(), info.runs);
            return Err(wrong(RUNS, problem));
        }
        Ok(Self { folder, info, shard, plan: read(PLAN)?, records })
    }

    /// The first thing in which a part is not of the same sweep as another.
    fn differs_from(&self, other: &Self) -> Option<String> {
        let (a, b) = (&other.info, &self.info);
        let short = |text: &str| text.chars().take(12).collect::<String>();
        let pairs = [
            ("program", short(&a.fingerprints.program), short(&b.fingerprints.program)),
            ("inputs", short(&a.fingerprints.inputs), short(&b.fingerprints.inputs)),
            ("runs", a.runs.to_string(), b.runs.to_string()),
            ("seed", a.seed.to_string(), b.seed.to_string()),
            ("parts", other.shard.of.to_string(), self.shard.of.to_string()),
            ("worst", a.recorded.to_string(), b.recorded.to_string()),
        ];
        let known = pairs.into_iter().find(|(_, a, b)| a != b);
        let rest = || {
            (SweepInfo { shard: None, ..a.clone() } != SweepInfo { shard: None, ..b.clone() }).then_some((
                "settings",
                "those of the first part".to_owned(),
                "other variables, sampling, screen or expectation".to_owned(),
            ))
        };
        let plans = || (self.plan != other.plan).then_some((PLAN, "the same plan".into(), "another one".into()));
        let (what, expected, found) = known.or_else(rest).or_else(plans)?;
        Some(format!("{what}: found {found}, expected {expected} as in {}", other.folder.display()))
    }
}

/// A file that cannot be read, and what that means.
fn unreadable(path: &Path, error: &io::Error, why: &str) -> CliError {
    CliError::Usage(format!("{}: failed to read: {error}{why}", path.display()))
}

/// The parts by their number.
///
/// # Errors
/// If they are not all parts of one sweep, each once.
fn in_order(mut parts: Vec<Part<'_>>) -> Result<Vec<Part<'_>>, CliError> {
    for part in &parts[1..] {
        if let Some(difference) = part.differs_from(&parts[0]) {
            let file = SweepFolder::new(part.folder).file(SUMMARY);
            return Err(CliError::Usage(format!("{}: {difference}", file.display())));
        }
    }
    parts.sort_by_key(|part| part.shard.number);
    for pair in parts.windows(2) {
        if pair[0].shard == pair[1].shard {
            let [first, second] = [&pair[0], &pair[1]].map(|part| part.folder.display().to_string());
            return Err(CliError::Usage(format!("{second}: found part {}, which {first} is too", pair[1].shard)));
        }
    }
    let of = parts[0].shard.of;
    let missing: Vec<String> = (1..=of)
        .filter(|number| parts.iter().all(|part| part.shard.number != *number))
        .map(|n| n.to_string())
        .collect();
    if missing.is_empty() {
        return Ok(parts);
    }
    Err(CliError::Usage(format!("found {} of {of} parts, expected also {}", parts.len(), missing.join(", "))))
}
