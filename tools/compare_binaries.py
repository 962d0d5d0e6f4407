#!/usr/bin/env python3
"""Compare what two benchdog binaries compute, bit for bit.

    tools/compare_binaries.py OLD NEW [--only PATTERN] [--keep DIR] [--reuse-old DIR] [--reuse-new DIR]
                              [--scenarios DIR] [--ignore KEY] [--jobs N] [--results A B]

A refactoring must not change a number. This script runs both binaries on the same input and compares their files:

run      one `run --record never` with the 25 operations of the paper's evaluation for each of the four planners
         (seed 1), a few variants of the search's settings, and every file of `scenarios/`; each plan.json and
         verdict.json is compared, and which of them exist
curve    `curve`: muscular_curve.csv
top      `plan --top 3` on the quickstart
front    `front` on the quickstart: front.csv and its plans
task     `task --plan-only --compare` on the whole circle: plan.json, path.csv and the tables of the comparison
export   `export --mjcf` and
margin   `margin --format json` of the plan under scenarios/plans
results  with `--results A B` only: the CSV files of two folders that `reproduce` wrote

Numbers are compared as they are written, digit for digit; strings exactly. Two kinds of JSON keys are left out wherever
they stand: `versions`, and times (`wall_ms`, `map_ms`); of CSV files the columns of the same names. Of a `reason`, which
is a sentence, only the numbers in it are compared, in any order. `--ignore KEY` leaves out another one.

`--only PATTERN` takes one of the names above, or a pattern of scenario names such as 'cut-0*' (may be given several
times). `--keep DIR` keeps the scenario files, the outputs (DIR/old, DIR/new) and the console output of every command.
`--reuse-old DIR` takes scenario files and the old binary's outputs from a folder that an earlier run kept; what is
missing there is run. `--reuse-new DIR` does the same for the new binary's outputs: to compare again with another
`--ignore`.

The exit code is 0 if nothing differs, 1 if anything does, 2 if a command could not be run.
"""

from __future__ import annotations

import argparse
import csv
import fnmatch
import json
import math
import re
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parent.parent
PLANNERS = ["comfort", "peripersonal", "muscular", "random"]
IGNORED = {"versions", "wall_ms", "map_ms"}
# Keys of sentences.
WORDING = {"reason"}
# Exit codes of a run that reached its end: expectations met, not met, no plan.
ENDED = {0, 1, 3}
COMMANDS = ["run", "curve", "top", "front", "task", "export", "margin"]

# Settings that the scenarios of the evaluation leave at their defaults.
VARIANTS = {
    "variant-fast-drill": ("drill-5", '[planner]\nseed = 1\nbudget = "fast"\n'),
    "variant-fast-cut": ("cut-04", '[planner]\nseed = 1\nbudget = "fast"\n'),
    "variant-evaluations": ("cut-02", "[planner]\nseed = 1\nevaluations = 3000\n"),
    "variant-paper-stability": ("cut-07", '[planner]\nseed = 1\nstability = "paper"\n'),
    "variant-seed": ("drill-2", "[planner]\nseed = 7\n"),
    "variant-normalised": ("drill-5", "[planner]\nseed = 1\n\n[comfort]\nperipersonal_share = 0.5\n"),
    "variant-mean": ("drill-5", '[planner]\nseed = 1\n\n[comfort]\nperson = "average"\n'),
    "variant-left-hand": ("cut-03", '[planner]\nseed = 1\n\n[human]\nhand = "left"\nsex = "female"\nlean_deg = 5.0\n'),
}


# --- Scenarios -------------------------------------------------------------------------------------------------------


def paper_operations() -> dict[str, str]:
    """The tables `[operation]` of `src/scenario/paper.rs`, by name."""
    operations = {}
    for k in range(1, 17):
        angle = math.tau * (k - 1) / 16
        sin, cos = math.sin(angle), math.cos(angle)
        operations[f"cut-{k:02}"] = (
            f'[operation]\nkind = "cut"\npoint_m = [{0.12 * cos!r}, {0.12 * sin!r}]\n'
            f"direction_o = [{-sin!r}, {cos!r}, 0.0]\nforce_n = 30.0\n"
        )
    for k in range(1, 10):
        x, y = (0.10 * (step - 1.0) for step in ((k - 1) % 3, (k - 1) // 3))
        operations[f"drill-{k}"] = (
            f'[operation]\nkind = "drill"\npoint_m = [{x!r}, {y!r}]\nforce_n = 15.0\n'
        )
    return operations


def scenario_texts() -> dict[str, str]:
    """Every scenario that the script writes itself, by name."""
    operations = paper_operations()
    bodies = {
        f"{name}-{planner}": f'{operation}\n[planner]\nkind = "{planner}"\nseed = 1\n'
        for name, operation in operations.items()
        for planner in PLANNERS
    }
    bodies |= {name: f"{operations[of]}\n{extra}" for name, (of, extra) in VARIANTS.items()}
    return {name: f'format = 1\nname = "{name}"\n\n{body}' for name, body in bodies.items()}


def wanted(name: str, patterns: list[str]) -> bool:
    """Whether `--only` lets a scenario through."""
    return not patterns or any(fnmatch.fnmatch(name, pattern) for pattern in patterns)


# --- Running ---------------------------------------------------------------------------------------------------------


@dataclass
class Job:
    """One command line, and the folder or file that it writes."""

    name: str
    arguments: list[str]
    output: str
    """Relative to the folder of the binary's outputs; `{out}` in the arguments stands for it."""
    scenarios: list[str] = field(default_factory=list)
    """The scenario files of a `run`, which end its command line; each writes a folder of its own."""
    stdout_is_output: bool = False


def jobs(folder: Path, given: Path, only: list[str], threads: int | None) -> list[Job]:
    """The commands to compare. Writes the scenario files into `folder`; those of `given` are copied unless they are there."""
    scenarios = folder / "given"
    if not scenarios.exists():
        shutil.copytree(given, scenarios)
    patterns = [pattern for pattern in only if pattern not in COMMANDS]
    commands = [name for name in only if name in COMMANDS] or ([] if patterns else COMMANDS)
    chosen = []
    if "run" in commands or patterns:
        files = []
        for name, text in scenario_texts().items():
            if wanted(name, patterns):
                path = folder / "written" / f"{name}.toml"
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text)
                files.append(str(path))
        files += [str(path) for path in sorted(scenarios.glob("*.toml")) if wanted(path.stem, patterns)]
        if not files:
            sys.exit(f"--only {', '.join(patterns)}: no scenario has such a name")
        limit = ["--jobs", str(threads)] if threads else []
        chosen.append(Job("run", ["run", "--record", "never", *limit, "--out", "{out}"], "run", files))
    names = ["quickstart.toml", "cut-rim.toml", "whole-circle.toml"]
    quickstart, rim, circle = (str(scenarios / name) for name in names)
    plan = str(scenarios / "plans" / "cut-rim.json")
    others = [
        Job("curve", ["curve", "--out", "{out}"], "curve"),
        Job("top", ["plan", "--top", "3", "-o", "{out}", quickstart], "top"),
        Job("front", ["front", "--out", "{out}", quickstart], "front"),
        Job("task", ["task", "--plan-only", "--compare", "--out", "{out}", circle], "task"),
        Job("export", ["export", "--mjcf", "{out}", plan, "--scenario", rim], "export.xml"),
        Job("margin", ["margin", "--format", "json", plan, "--scenario", rim], "margin.json", stdout_is_output=True),
    ]
    return chosen + [job for job in others if job.name in commands]


def ran(job: Job, out: Path) -> bool:
    """Whether the outputs of a job are in a folder."""
    done = out / f"{job.name}.done"
    return done.exists() and set(job.scenarios) <= set(done.read_text().splitlines())


def run(binary: Path, job: Job, out: Path) -> None:
    """Runs a job."""
    target = out / job.output
    command = [str(binary), *(argument.replace("{out}", str(target)) for argument in job.arguments), *job.scenarios]
    out.mkdir(parents=True, exist_ok=True)
    start = time.monotonic()
    result = subprocess.run(command, cwd=REPOSITORY, capture_output=True, text=True, check=False)
    (out / f"{job.name}.log").write_text(f"exit code {result.returncode}\n{result.stdout}\n{result.stderr}")
    if result.returncode not in ENDED:
        print(result.stderr[-2000:], file=sys.stderr)
        print(f"{job.name}: {binary} ended with exit code {result.returncode}", file=sys.stderr)
        sys.exit(2)
    if job.stdout_is_output:
        target.write_text(result.stdout)
    (out / f"{job.name}.done").write_text("\n".join(job.scenarios))
    print(f"{job.name}: {binary.name} took {time.monotonic() - start:.0f} s", flush=True)


# --- Comparing -------------------------------------------------------------------------------------------------------


class Number(str):
    """A number as it is written."""


@dataclass
class Comparison:
    """What was compared, and what differs."""

    ignored: set[str]
    files: int = 0
    numbers: int = 0
    strings: int = 0
    differences: list[tuple[str, str, str]] = field(default_factory=list)
    largest: tuple[float, str] = (0.0, "")

    def differ(self, where: str, old: object, new: object) -> None:
        """Notes a difference, and how large it is if both are numbers."""
        self.differences.append((where, str(old), str(new)))
        if isinstance(old, Number) and isinstance(new, Number):
            a, b = float(old), float(new)
            scale = max(abs(a), abs(b))
            relative = abs(a - b) / scale if scale > 0 else 0.0
            if relative >= self.largest[0]:
                self.largest = (relative, where)

    def value(self, where: str, old: object, new: object) -> None:
        """Compares two JSON values."""
        if isinstance(old, dict) and isinstance(new, dict):
            for key in [*old, *(key for key in new if key not in old)]:
                if key in self.ignored:
                    continue
                if key not in old or key not in new:
                    self.differ(f"{where}.{key}", old.get(key, "(missing)"), new.get(key, "(missing)"))
                elif key in WORDING:
                    self.value(f"{where}.{key} (numbers)", numbers(old[key]), numbers(new[key]))
                else:
                    self.value(f"{where}.{key}", old[key], new[key])
        elif isinstance(old, list) and isinstance(new, list):
            if len(old) != len(new):
                self.differ(f"{where} (length)", Number(len(old)), Number(len(new)))
            for index, (a, b) in enumerate(zip(old, new)):
                self.value(f"{where}[{index}]", a, b)
        else:
            self.numbers += isinstance(old, Number)
            self.strings += isinstance(old, str) and not isinstance(old, Number)
            if type(old) is not type(new) or old != new:
                self.differ(where, old, new)

    def json(self, name: str, old: Path, new: Path) -> None:
        """Compares two JSON files."""
        read = lambda path: json.loads(  # noqa: E731
            path.read_text(), parse_float=Number, parse_int=Number, parse_constant=Number
        )
        self.value(name, read(old), read(new))

    def csv(self, name: str, old: Path, new: Path) -> None:
        """Compares two CSV files cell by cell; the first row names the columns."""
        rows = [list(csv.reader(path.read_text().splitlines())) for path in (old, new)]
        if len(rows[0]) != len(rows[1]):
            self.differ(f"{name} (rows)", Number(len(rows[0])), Number(len(rows[1])))
        header = rows[0][0] if rows[0] else []
        for line, (a, b) in enumerate(zip(*rows), 1):
            if len(a) != len(b):
                self.differ(f"{name}:{line} (columns)", Number(len(a)), Number(len(b)))
            for column, (x, y) in enumerate(zip(a, b)):
                heading = header[column] if column < len(header) else str(column)
                if heading not in self.ignored:
                    self.value(f"{name}:{line}.{heading}", cell(x), cell(y))

    def text(self, name: str, old: Path, new: Path) -> None:
        """Compares two other files word by word, numbers as numbers."""
        words = [path.read_text().replace('"', " ").split() for path in (old, new)]
        if len(words[0]) != len(words[1]):
            self.differ(f"{name} (words)", Number(len(words[0])), Number(len(words[1])))
        for index, (a, b) in enumerate(zip(*words)):
            self.value(f"{name} (word {index + 1})", cell(a), cell(b))

    def folders(self, prefix: str, old: Path, new: Path) -> None:
        """Compares the files of two folders that hold results."""
        compare = {".json": self.json, ".csv": self.csv, ".xml": self.text}
        # Of a `reproduce`; it has times alone.
        skipped = {"timing.csv"}
        names = sorted(
            {
                str(path.relative_to(root))
                for root in (old, new)
                for path in root.rglob("*")
                if path.suffix in compare and path.name not in skipped
            }
        )
        for name in names:
            a, b = old / name, new / name
            if not (a.exists() and b.exists()):
                self.differ(prefix + name, *("(exists)" if path.exists() else "(missing)" for path in (a, b)))
                continue
            self.files += 1
            compare[a.suffix](prefix + name, a, b)

    def summary(self) -> str:
        """What is printed in the end."""
        lines = []
        for where, old, new in self.differences[:20]:
            lines += [f"differs: {where}", f"    old {old}", f"    new {new}"]
        if len(self.differences) > 20:
            lines.append(f"... and {len(self.differences) - 20} more")
        if self.largest[1]:
            lines.append(f"largest relative difference of a number: {self.largest[0]:.3g} at {self.largest[1]}")
        lines.append(
            f"{self.files} files, {self.numbers} numbers, {self.strings} strings compared: "
            f"{len(self.differences)} differences"
        )
        return "\n".join(lines)


def numbers(sentence: str | None) -> list[Number]:
    """The numbers in a sentence, sorted as texts."""
    found = re.findall(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e-?\d+)?(?!\w)", sentence or "")
    return sorted(Number(text) for text in found)


def cell(text: str) -> str:
    """A cell of a table: a `Number` if it is one."""
    try:
        float(text)
    except ValueError:
        return text
    return Number(text)


# --- Main ------------------------------------------------------------------------------------------------------------


def arguments() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter, usage=argparse.SUPPRESS
    )
    parser.add_argument("old", type=Path, help="the binary that is right")
    parser.add_argument("new", type=Path, help="the binary that is compared with it")
    parser.add_argument("--only", action="append", default=[], metavar="PATTERN")
    parser.add_argument("--keep", type=Path, metavar="DIR")
    parser.add_argument("--reuse-old", type=Path, metavar="DIR")
    parser.add_argument("--reuse-new", type=Path, metavar="DIR")
    parser.add_argument("--scenarios", type=Path, default=REPOSITORY / "scenarios", metavar="DIR")
    parser.add_argument("--ignore", action="append", default=[], metavar="KEY")
    parser.add_argument("--jobs", type=int, metavar="N", help="scenarios at once; all cores unless given")
    parser.add_argument("--results", nargs=2, type=Path, metavar=("A", "B"))
    return parser.parse_args()


def main() -> int:
    """Runs what is to be run, compares and reports."""
    args = arguments()
    comparison = Comparison(IGNORED | set(args.ignore))
    with tempfile.TemporaryDirectory() as temporary:
        keep = (args.keep or Path(temporary)).resolve()
        # Both binaries read the same scenario files: a file may name another one.
        base = args.reuse_old.resolve() if args.reuse_old else keep
        old, new = base / "old", (args.reuse_new.resolve() if args.reuse_new else keep) / "new"
        for job in jobs(base, args.scenarios.resolve(), args.only, args.jobs):
            for reuse, binary, out in [(args.reuse_old, args.old, old), (args.reuse_new, args.new, new)]:
                if reuse and ran(job, out):
                    print(f"{job.name}: the outputs in {out} are used again")
                else:
                    run(binary.resolve(), job, out)
            for name in [f"{job.output}/{Path(file).stem}" for file in job.scenarios] or [job.output]:
                compare_output(comparison, name, old / name, new / name)
    if args.results:
        comparison.folders("", *args.results)
    print(comparison.summary())
    return 1 if comparison.differences else 0


def compare_output(comparison: Comparison, name: str, old: Path, new: Path) -> None:
    """Compares what two jobs wrote: a folder or a file."""
    if old.is_dir():
        comparison.folders(f"{name}/", old, new)
        return
    comparison.files += 1
    (comparison.json if old.suffix == ".json" else comparison.text)(name, old, new)


if __name__ == "__main__":
    sys.exit(main())
