#!/usr/bin/env python3
"""Plans of the three metrics of muscular comfort, judged by each other's metric.

    tools/metric_study.py BENCHDOG [--jobs N] [--keep DIR]

Runs the 25 operations of the paper's evaluation with the default person, who stands naturally, for each metric
(`comfort.muscular`) and for the planners that maximise muscular comfort alone (`muscular`) and both comforts (`comfort`),
150 plans, and prints the table of docs/reproduction.md#three-metrics: means over the plans of a task, the median of
the printed metric.
"""

from __future__ import annotations

import argparse
import json
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

from compare_binaries import paper_operations

METRICS = ["paper", "intrinsic", "muscles"]
PLANNERS = ["muscular", "comfort"]
# Exit codes of a run that reached its end.
ENDED = {0, 1, 3}


def write_scenarios(folder: Path, metric: str, planner: str) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for name, operation in paper_operations().items():
        settings = f'[planner]\nkind = "{planner}"\nseed = 1\n\n[comfort]\nmuscular = "{metric}"\n'
        (folder / f"{name}.toml").write_text(f'format = 1\nname = "{name}"\n\n{operation}\n{settings}')


def planned(benchdog: str, folder: Path, metric: str, planner: str, jobs: int) -> list[tuple[dict, dict]]:
    """Plans with their verdicts."""
    scenarios, out = folder / f"scenarios-{metric}-{planner}", folder / f"out-{metric}-{planner}"
    write_scenarios(scenarios, metric, planner)
    command = [benchdog, "run", "--record", "never", "--jobs", str(jobs), "--out", str(out), str(scenarios)]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode not in ENDED:
        sys.exit(f"{' '.join(command)}\n{done.stderr}")
    read = lambda path: json.loads(path.read_text())
    return [(read(path), read(path.parent / "verdict.json")) for path in sorted(out.glob("*/plan.json"))]


def row(task: str, metric: str, planner: str, runs: list[tuple[dict, dict]]) -> str:
    runs = [(plan, verdict) for plan, verdict in runs if plan["name"].startswith(task)]
    plans = [plan for plan, _ in runs]
    mean = lambda pick: statistics.mean(pick(plan) for plan in plans)
    holds = sum(verdict["verdict"] == "holds" for _, verdict in runs)
    cells = [
        task, planner, metric, f"{holds} of {len(runs)}",
        f"{mean(lambda plan: plan['muscles']['effort']):.4f}",
        f"{mean(lambda plan: plan['muscles']['largest_activation']):.2f}",
        f"{mean(lambda plan: plan['comfort']['muscular_intrinsic']):.1f}",
        f"{statistics.median(plan['comfort']['muscular'] for plan in plans):.1f}",
        f"{mean(lambda plan: plan['comfort']['peripersonal_m']):.2f}",
    ]
    return "| " + " | ".join(cells) + " |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("benchdog")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--keep", type=Path, help="folder for scenarios and plans; else a temporary one")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = arguments.keep or Path(temporary)
        found = {
            (metric, planner): planned(arguments.benchdog, folder, metric, planner, arguments.jobs)
            for planner in PLANNERS for metric in METRICS
        }
    print("| task | planner | by the metric | holds | effort | largest activation | intrinsic | printed | peripersonal, m |")
    print("|---|---|---|---|---|---|---|---|---|")
    for task in ("drill", "cut"):
        for (metric, planner), runs in found.items():
            print(row(task, metric, planner, runs))
    for planner in PLANNERS:
        times = [plan["planner"]["wall_ms"] for plan, _ in found["muscles", planner]]
        print(f"\n{planner} by muscles: median {statistics.median(times):.0f} ms a plan", file=sys.stderr)
    by_name = lambda metric: {plan["name"]: plan["muscles"]["effort"] for plan, _ in found[metric, "muscular"]}
    muscles, intrinsic = by_name("muscles"), by_name("intrinsic")
    worse = [name for name, effort in muscles.items() if effort > intrinsic[name]]
    print(f"effort above that of the intrinsic metric's planner: {worse or 'nowhere'}", file=sys.stderr)


if __name__ == "__main__":
    main()
