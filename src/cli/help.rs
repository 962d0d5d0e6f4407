//! Examples and tables that the help texts end with.

/// `benchdog --help`.
pub const EXIT_CODES: &str = "\
Exit codes:
  0    all expectations met
  1    some expectation not met, or no verdict was possible
  2    bad input or usage, or output that cannot be written
  3    no feasible plan where one was expected
  70   a bug in benchdog
  130  interrupted; what was done until then is reported

Start with: benchdog run scenarios/quickstart.toml";

/// `benchdog run --help`.
pub const RUN: &str = "\
Examples:
  benchdog run scenarios/quickstart.toml        one scenario, with its checks
  benchdog run scenarios                        every .toml file of a folder
  benchdog run 'grasps/**/*.toml' --jobs 4      a pattern, four at once
  benchdog run scenarios --filter cut --filter 'fails-*'
  benchdog run scenarios --record failed --fail-fast

Into --out go report.html, summary.csv, summary.json and junit.xml, and for each scenario a
folder of its name with plan.json, recording.rrd and, last of all, verdict.json: a run that was
killed leaves none of the four reports, and no verdict.json of what it did not finish.
Ctrl-C ends the run after the scenarios at work and reports; a second one ends it at once.";

/// `benchdog plan --help`.
pub const PLAN: &str = "\
Examples:
  benchdog plan scenarios/quickstart.toml -o plan.json
  benchdog plan scenarios/quickstart.toml --seed 7 | jq .comfort
  benchdog plan scenarios/quickstart.toml --planner muscular --budget fast
  benchdog plan scenarios/quickstart.toml --top 3 -o plans

Ctrl-C ends the search: the best plan so far is checked and written, and the exit code is 130.";

/// `benchdog front --help`.
pub const FRONT: &str = "\
Example:
  benchdog front scenarios/quickstart.toml --out front

Weights from all on the muscular to all on the peripersonal comfort, each over its own optimum;
what another plan beats in both is left out. front-1.json and so on are the plans.";

/// `benchdog circle --help`.
pub const CIRCLE: &str = "\
Example:
  benchdog circle scenarios/cut-rim.toml --out circle

circle.csv has the comfort of 16 points for the three ways; the plans are hold-1.json to
hold-16.json, sequence-1.json to sequence-16.json and separate-1.json to separate-16.json;
motion.csv is the sequence's path of the arms' joints and the board from point to point.";

/// `benchdog simulate --help`.
pub const SIMULATE: &str = "\
Examples:
  benchdog simulate plan.json
  benchdog simulate plan.json --scenario scenarios/cut-rim.toml --format json";

/// `benchdog margin --help`.
pub const MARGIN: &str = "\
Examples:
  benchdog margin plan.json
  benchdog margin plan.json --scenario scenarios/cut-rim.toml --format json";

/// `benchdog export --help`.
pub const EXPORT: &str = "\
Example:
  benchdog export plan.json --mjcf scene.xml";

/// `benchdog curve --help`.
pub const CURVE: &str = "\
Examples:
  benchdog curve
  benchdog curve scenarios/cut-rim.toml --out curve";

/// `benchdog reproduce --help`.
pub const REPRODUCE: &str = "\
Examples:
  benchdog reproduce                            the evidence in results/
  benchdog reproduce --quick                    a look at it
  benchdog reproduce --quick --filter cut-05 --record always

Into --out go report.md, table1.csv, plans.csv, physics.csv, best_case.csv, random.csv,
sensitivity.csv, the muscular curve and pictures/, the same for equal runs; timing.csv, which is
not; recordings/; and work/, from which a run that was stopped goes on. The exit code is 1 when
one of the 100 holds failed in simulation, 3 when a planner found none.";

/// `benchdog schema --help`.
pub const SCHEMA: &str = "\
Example:
  benchdog schema scenario > scenario.schema.json";

/// `benchdog inspect --help`.
#[cfg(feature = "recording")]
pub const INSPECT: &str = "\
Examples:
  benchdog inspect out/quickstart/recording.rrd
  benchdog inspect recording.rrd --format json | jq .peaks
  benchdog inspect recording.rrd --check --slip-mm 0.5 --deflection-mm 3
  benchdog inspect recording.rrd --scenario stricter.toml

With --check, a limit or --scenario the stored trace is judged again; the exit code is then 1
when the verdict is not the expected one. What the file says of the run stays as it was.";

/// `benchdog view --help`.
#[cfg(feature = "recording")]
pub const VIEW: &str = "\
Example:
  benchdog view out/quickstart/recording.rrd

The viewer is not part of benchdog. `pip install rerun-sdk==0.36.3` or
`cargo install rerun-cli@0.36.3 --locked` installs it.";

/// `benchdog doctor --help`.
pub const DOCTOR: &str = "\
Example:
  benchdog doctor

Exit code 0 when benchdog can work here. A viewer that is not found is told and is no fault.";

/// `benchdog completions --help`.
pub const COMPLETIONS: &str = "\
Examples:
  benchdog completions bash > ~/.local/share/bash-completion/completions/benchdog
  benchdog completions zsh > ~/.zfunc/_benchdog
  benchdog completions fish > ~/.config/fish/completions/benchdog.fish";
