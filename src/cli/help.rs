//! The final part of each command's help: examples and notes.

/// `benchdog --help`.
pub const EXIT_CODES: &str = "\
Exit codes:
  0    all expectations met
  1    some expectation not met, or no verdict was possible
  2    bad input or usage, or output that cannot be written
  3    no feasible plan where one was expected
  70   a bug in benchdog
  130  interrupted; finished work is reported

NO_COLOR=1 turns colours off, CLICOLOR_FORCE=1 on.
BENCHDOG_LOG has a filter in place of -v, such as benchdog::planner=debug.

Start with: benchdog init my-boards";

/// `benchdog init --help`.
pub const INIT: &str = "\
Examples:
  benchdog init my-boards                     a folder with everything to begin with
  benchdog init my-cuts --example cut
  benchdog init --example your-plan           into the working directory

Writes a README, scenarios whose comments explain the keys, plans of them, a test for pytest and a
workflow for GitHub. The files need nothing outside the folder. A folder that has one of them is
refused before anything is written.";

/// `benchdog run --help`.
pub const RUN: &str = "\
Examples:
  benchdog run scenarios/quickstart.toml        one scenario, with its checks
  benchdog run scenarios                        every .toml file of a folder
  benchdog run 'grasps/**/*.toml' --jobs 4      a pattern, four threads
  benchdog run scenarios --filter cut --filter 'fails-*'
  benchdog run scenarios --record failed --fail-fast
  benchdog run scenarios --out 'out/{kind}/{name}-{seed}'    a folder for each scenario

Writes report.html, summary.csv, summary.json and junit.xml into --out, and for each scenario a
folder with plan.json, recording.rrd and, last, verdict.json. A killed run leaves none of the four
reports and no verdict.json of an unfinished scenario.
Ctrl-C abandons the scenarios in progress and reports the finished ones; a second Ctrl-C exits
immediately.";

/// `benchdog plan --help`.
pub const PLAN: &str = "\
Examples:
  benchdog plan scenarios/quickstart.toml -o plan.json
  benchdog plan scenarios/quickstart.toml --seed 7 | jq .comfort
  benchdog plan scenarios/quickstart.toml --planner muscular --budget fast
  benchdog plan scenarios/quickstart.toml --top 3 -o plans
  benchdog plan - < scenarios/quickstart.toml | benchdog simulate -

Ctrl-C ends the search: the best plan so far is checked and written. Before there is one, nothing is
written. The exit code is 130.";

/// `benchdog replan --help`.
pub const REPLAN: &str = "\
Examples:
  benchdog replan scenarios/quickstart.toml < requests.jsonl > answers.jsonl
  echo '{\"human\": {\"x_m\": 0.9, \"y_m\": -0.2, \"heading_deg\": 166}}' | benchdog replan scenarios/quickstart.toml

A request is a line of JSON; what it leaves out stays as it was:
  {\"id\": 7,                                    any value, which the answer repeats
   \"human\": {\"x_m\": 1.1, \"y_m\": -0.2, \"heading_deg\": 180},        or {\"place\": \"free\"}
   \"operation\": {\"kind\": \"drill\", \"point_m\": [0.1, 0.0], \"force_n\": 20},
   \"most_motion_deg\": 20,                     the most that a joint of the robot may move
   \"keep_grasps\": true,                       the grippers stay where they are on the board
   \"search\": false}                           no search from scratch, which may take seconds
An answer is a line of JSON with `result` (found, infeasible, error), `plan`, `motion` and `wall_ms`.
`benchdog schema replan-request` and `replan-answer` print the formats.

The exit code is 2 if a request was not valid, 3 if a task had no plan, 0 otherwise.";

/// `benchdog front --help`.
pub const FRONT: &str = "\
Example:
  benchdog front scenarios/quickstart.toml --out front

The objective's weights vary from muscular comfort alone to peripersonal comfort alone, each divided
by its optimum. Plans that another plan dominates are omitted. The plans are front-1.json, ...";

/// `benchdog task --help`.
pub const TASK: &str = "\
Examples:
  benchdog task scenarios/whole-circle.toml     plan, simulate and judge 16 pieces of a circle
  benchdog task scenarios/whole-circle.toml --plan-only
  benchdog task scenarios/whole-circle.toml --stream       each stage is written as soon as it is planned
  benchdog task scenarios/whole-circle.toml --compare      beside one hold, separate and random holds
  benchdog simulate out/whole-circle/plan.json  judge the staged plan again, or that of another planner

The folder of the task has plan.json, verdict.json, stages.csv, path.csv, report.html and recording.rrd.
With --compare it also has comparison.csv, a row for each strategy, and comparison-pieces.csv, a row for
each strategy and piece: the staged plan, one fixed hold for as many pieces as possible, the best hold
for each piece by itself, and random holds.
With --stream it also has stages.jsonl: the plan without stages in its first line, then a stage a line.";

/// `benchdog sweep --help`.
pub const SWEEP: &str = "\
Examples:
  benchdog sweep scenarios/quickstart.toml --runs 1000      as [sweep] of the scenario says, or as
                                                            the preset `workshop`
  benchdog sweep plan.json --until 0.02         until the interval is 0.02 wide
  benchdog sweep plan.json --shard 2/7 --out part-2      one part of seven, for another machine
  benchdog merge part-* --out sweep             the same files as one sweep of all runs

Writes runs.csv, runs.arrow, plan.json, report.html, junit.xml, recordings/ of the worst runs and, last, sweep.json
into --out. The same command goes on where an interrupted one ended, and with more --runs adds the missing ones.
The exit code is 1 if [expect] states a probability and the interval's lower end is below it.";

/// `benchdog merge --help`.
pub const MERGE: &str = "\
Example:
  benchdog merge part-1 part-2 part-3 --out sweep

Parts that do not belong together (another program, plan, scenario, seed or number of parts), that are missing or not
finished are refused with exit code 2, and nothing is written.";

/// `benchdog compare --help`.
pub const COMPARE: &str = "\
Examples:
  benchdog compare out-of-main out-of-branch --html compare.html
  benchdog compare out --write-baseline baseline.json        a small file for the repository
  benchdog compare baseline.json out --tolerance 0.05

A regression is a verdict that was the expected one and is not, a result that is gone, a margin that is
less by more than the tolerance, a probability or a quantile of a sweep that is worse by more than chance
and the tolerance. The exit code is 1 if there is one.";

/// `benchdog simulate --help`.
pub const SIMULATE: &str = "\
Examples:
  benchdog simulate plan.json
  benchdog simulate plan.json --scenario scenarios/cut-rim.toml --format json
  benchdog simulate a.json 'plans/*.json' more       files, patterns and folders, in parallel

Writes plan.json, recording.rrd and verdict.json into a folder named after the plan in --out. If
there is another plan in this folder, or if two plans have one name, nothing is simulated or
written.";

/// `benchdog margin --help`.
pub const MARGIN: &str = "\
Examples:
  benchdog margin plan.json
  benchdog margin plan.json --scenario scenarios/cut-rim.toml --format json";

/// `benchdog export --help`.
pub const EXPORT: &str = "\
Examples:
  benchdog export plan.json --mjcf scene.xml
  python3 tools/crosscheck.py plan.json     plays the export in MuJoCo and compares the verdicts";

/// `benchdog import --help`.
pub const IMPORT: &str = "\
Examples:
  benchdog import grasps.yaml --scenario panel.toml --arm left=grasp_0 -o plan.json
  benchdog import grasps.yaml --scenario panel.toml --arm left=grasp_0 --arm right=grasp_3 \\
      --board-pose '0.6 0.1 0.2 0 1.57 0' --gripper-frame '0 0 0.1 0 1.5708 0' -o plan.json
  benchdog import grasps.yaml --scenario panel.toml --all left -o plans
  benchdog simulate plan.json

A POSE is 'x y z roll pitch yaw' in m and rad, about fixed axes as in a URDF, or
'x y z qx qy qz qw'. Our frames: O is the board's centre, x along its width, z out of the worked
face. G is the frame of the robot's gripper: z out of the gripper, y along which the fingers open;
its origin is in the board's middle plane and y along the board's normal, to 1 mm and 0.1 degrees.
Robot, board, operation and grip force are the scenario's; the arms' angles follow by inverse
kinematics. The gripper's opening in the file is not used: the fingers close on the board.
The plan has no person. Without --board-pose the poses of the planner's search domain are tried in
the order of the scenario's seed; neither person nor load has a part in the choice. The exit code
is 3 if no pose is reached.
With --all every grasp of the file becomes a plan PLANS/GRASP.json, and a line says which are left
out and why; the exit code is 3 if all are. Matrices are four rows of 4 numbers or one of 16, their
names grasp_0, grasp_1 and so on, their frame the object's.";

/// `benchdog curve --help`.
pub const CURVE: &str = "\
Examples:
  benchdog curve
  benchdog curve scenarios/cut-rim.toml --out curve";

/// `benchdog reproduce --help`.
pub const REPRODUCE: &str = "\
Examples:
  benchdog reproduce                            write results/
  benchdog reproduce --quick                    a shorter version
  benchdog reproduce --quick --filter cut-05 --record always

Writes into --out: report.md, tables, the muscular curve and pictures/ of the evaluation for a
natural person; the same of the paper's formulas as printed into its folder printed/; timing.csv,
which alone differs between equal runs; recordings/; and work/, from which a stopped run
continues. The exit code is 1 if one of the 200 plans failed in simulation, 3 if a planner found
no plan.";

/// `benchdog explain --help`.
pub const EXPLAIN: &str = "\
Examples:
  benchdog explain                list all verdicts, checks and self-checks
  benchdog explain pivots         what a verdict means, and what helps
  benchdog explain chatter        what a check measures, with its limit

The text is that of docs/verdicts.md.";

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

With --check, a limit or --scenario, the stored trace is judged again and the exit code is 1 if the
verdict is not the expected one. The file is not changed.";

/// `benchdog view --help`.
#[cfg(feature = "recording")]
pub const VIEW: &str = "\
Example:
  benchdog view out/quickstart/recording.rrd

The viewer, 0.36.3 or newer, is not part of benchdog. `pip install 'rerun-sdk>=0.36.3'` or
`cargo install rerun-cli --locked` installs it.";

/// `benchdog cache --help`.
pub const CACHE: &str = "\
Examples:
  benchdog cache list
  benchdog cache clear
  BENCHDOG_CACHE=maps benchdog run scenarios/quickstart.toml     keep them in the folder maps

Maps are what many plans of a robot, a board and a kind of task share. They take seconds to make,
and the next command reads them. A plan on kept maps is the plan on new ones, bit for bit: a map
is read only if everything that it was made from is the same, and if it is as it was written. The
folder is that of BENCHDOG_CACHE, or benchdog in the user's folder for caches; if the variable is
empty, no maps are kept or read. It stays below 200 MB: what was not used for longest is removed
first.";

/// `benchdog doctor --help`.
pub const DOCTOR: &str = "\
Examples:
  benchdog doctor
  benchdog doctor my-robot.toml --record my-robot.rrd

The exit code is 0 if all checks pass. A missing viewer is reported but is not a failure.";

/// `benchdog robot new --help`.
pub const ROBOT_NEW: &str = "\
Examples:
  benchdog robot new ur5.urdf -o my-robot.toml --scenario my-drill.toml
  benchdog robot new pr2.urdf --srdf pr2.srdf --packages ~/ros/share -o my-robot.toml

Figures that no URDF has are assumed and marked in the description. docs/robot.md shows the way from a URDF to a verdict.";

/// `benchdog completions --help`.
pub const COMPLETIONS: &str = "\
Examples:
  benchdog completions bash > ~/.local/share/bash-completion/completions/benchdog
  benchdog completions zsh > ~/.zfunc/_benchdog
  benchdog completions fish > ~/.config/fish/completions/benchdog.fish";

/// `benchdog man --help`.
pub const MAN: &str = "\
Examples:
  benchdog man | man -l -
  benchdog man --out ~/.local/share/man/man1";
