//! What a sweep is: everything in `sweep.json` that does not follow from its runs.

use std::{collections::BTreeMap, fmt, str::FromStr};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{draw::Dimension, screen::Screen, table};
use crate::model::{
    scenario::Expectation,
    sweep::{Sampling, Variable},
};

/// What a sweep is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SweepInfo {
    /// The file format, 1.
    pub format: u32,
    /// The scenario's or plan's name.
    pub name: String,
    /// The verdict whose probability is estimated, the probability that is expected, and the confidence.
    pub expect: Expectation,
    /// The number of runs of all shards together.
    pub runs: u64,
    /// The width of the interval at which the sweep ends before all runs are done.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub until: Option<f64>,
    /// How the runs are drawn.
    pub sampling: Sampling,
    /// Seed of the draws.
    pub seed: u64,
    /// The part of the runs that was done.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shard: Option<Shard>,
    /// What the statics decide; absent if every run is simulated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub screen: Option<Screen>,
    /// The number of worst runs that are recorded.
    pub recorded: usize,
    /// The uncertain quantities.
    pub variables: Vec<Variable>,
    /// The numbers that are drawn for each run.
    pub dimensions: Vec<Dimension>,
    /// SHA-256 of program and inputs. Runs with equal ones, the same seed and the same index are equal.
    pub fingerprints: Fingerprints,
    /// Versions of Benchdog and of the engines.
    pub versions: BTreeMap<String, String>,
}

impl SweepInfo {
    /// The header of the table of its runs.
    #[must_use]
    pub fn header(&self) -> Vec<String> {
        table::header(self.dimensions.iter().map(|dimension| dimension.name.as_str()))
    }

    /// A text that sweeps have in common whose runs with equal indices are equal: everything but how many runs there are and what
    /// is made of them.
    #[must_use]
    pub fn key(&self) -> String {
        let Fingerprints { program, inputs } = &self.fingerprints;
        let own = (&self.sampling, self.seed, &self.screen, &self.variables, &self.dimensions);
        // A line: `Debug` escapes line ends.
        format!("{program} {inputs} {own:?}")
    }
}

/// What the results of a sweep's runs follow from, as SHA-256 in hexadecimal digits.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Fingerprints {
    /// The program: its sources, the versions of its crates, the target.
    pub program: String,
    /// The inputs: plan, scenario and robot.
    pub inputs: String,
}

/// A part of a sweep: the runs whose index is `number - 1` modulo `of`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Shard {
    /// Its number, from 1.
    pub number: u64,
    /// The number of shards.
    pub of: u64,
}

impl Shard {
    /// The indices of its runs, of a sweep of this many.
    pub fn indices(self, runs: u64) -> impl Iterator<Item = u64> {
        let step = usize::try_from(self.of).unwrap_or(usize::MAX);
        (self.number - 1..runs).step_by(step)
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/').and_then(|(number, of)| Some((number.parse().ok()?, of.parse().ok()?)));
        match parts {
            Some((number, of)) if (1..=of).contains(&number) => Ok(Self { number, of }),
            _ => Err("expected M/N with M from 1 to N, such as 2/7".into()),
        }
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_share_the_runs() {
        for (runs, of) in [(0, 1), (1, 3), (10, 3), (100, 7), (6, 6)] {
            let mut all: Vec<u64> = (1..=of).flat_map(|number| Shard { number, of }.indices(runs)).collect();
            all.sort_unstable();
            assert!(all.into_iter().eq(0..runs), "{runs} runs, {of} shards");
        }
    }

    #[test]
    fn a_shard_is_written_as_two_numbers() {
        assert_eq!("2/7".parse(), Ok(Shard { number: 2, of: 7 }));
        assert_eq!(Shard { number: 2, of: 7 }.to_string(), "2/7");
        for wrong in ["", "2", "0/7", "8/7", "2/0", "-1/7", "2/7/1", "a/b", "1.5/2"] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
    }
}
