#!/usr/bin/env python3
"""What robustness costs: default and robust plans of the paper's 25 operations, and how likely they hold.

    tools/robust_study.py BENCHDOG [--runs N] [--probability P] [--jobs N] [--keep DIR]

Plans the 25 operations of the paper's evaluation with the default person, by default and with `--robust=P`, sweeps both plans
with N draws of the preset `workshop` other than those that the planner used, and prints the table of
docs/reproduction.md#robust-plans.
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

# The draws of planner and sweeps.
SWEEP = '[sweep]\npreset = "workshop"\nsampling = "sobol"\n'
# Seed of the sweeps; the planner's own small sweeps have seed 1.
SEED = "2"


def benchdog(binary: str, *arguments: str) -> subprocess.CompletedProcess:
    return subprocess.run([binary, *arguments], capture_output=True, text=True)


def planned(binary: str, scenario: Path, plan: Path, options: list[str]) -> dict | None:
    """The plan; none if there is no plan that holds often enough."""
    if plan.exists():
        return json.loads(plan.read_text())
    done = benchdog(binary, "plan", str(scenario), "-o", str(plan), *options)
    if done.returncode not in (0, 3):
        sys.exit(f"{scenario}: {done.stderr}")
    return json.loads(plan.read_text()) if done.returncode == 0 else None


def swept(binary: str, plan: Path, out: Path, runs: int, jobs: int) -> dict:
    """The summary of the sweep of a plan."""
    command = ["sweep", str(plan), "--runs", str(runs), "--seed", SEED, "--worst", "0", "--jobs", str(jobs)]
    done = benchdog(binary, *command, "--out", str(out))
    if done.returncode != 0:
        sys.exit(f"{plan}: {done.stderr}")
    return json.loads((out / "sweep.json").read_text())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("benchdog")
    parser.add_argument("--runs", type=int, default=200)
    parser.add_argument("--probability", type=float, default=0.99)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--keep", type=Path, help="folder for scenarios, plans and sweeps; else a temporary one")
    arguments = parser.parse_args()
    kinds = {"default": [], "robust": [f"--robust={arguments.probability}"]}
    print("| operation | plan | objective | load factor | holds with probability | interval at 95 % |")
    print("|---|---|---|---|---|---|")
    kept: dict[str, list[tuple[float, float]]] = {}
    audited = mistakes = 0
    with tempfile.TemporaryDirectory() as temporary:
        folder = arguments.keep or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        for name, operation in paper_operations().items():
            scenario = folder / f"{name}.toml"
            scenario.write_text(f'format = 1\nname = "{name}"\n\n{operation}\n[planner]\nseed = 1\n\n{SWEEP}')
            for kind, options in kinds.items():
                file = folder / f"{name}-{kind}.json"
                plan = planned(arguments.benchdog, scenario, file, options)
                if plan is None:
                    print(f"| {name} | {kind} | none | | | |", flush=True)
                    continue
                estimate = swept(arguments.benchdog, file, folder / f"{name}-{kind}", arguments.runs, arguments.jobs)["estimate"]
                audited, mistakes = audited + estimate["audited"], mistakes + estimate["mistakes"]
                objective = plan["comfort"]["objective"]
                kept.setdefault(f"{name.split('-')[0]} {kind}", []).append((objective, estimate["probability"]))
                factor = plan["stability"]["compliant_load_factor"]
                interval = f"{estimate['low']:.3f} to {estimate['high']:.3f}"
                print(f"| {name} | {kind} | {objective:.1f} | {factor:.2f} | {estimate['probability']:.3f} | {interval} |", flush=True)
    print(f"of {audited} runs that were simulated as a check, {mistakes} were mistakes of the screen", file=sys.stderr)
    for kind, values in kept.items():
        objectives, probabilities = zip(*values)
        print(f"{kind}: {len(values)} plans, mean objective {statistics.mean(objectives):.1f}, mean probability "
              f"{statistics.mean(probabilities):.3f}, least {min(probabilities):.3f}", file=sys.stderr)


if __name__ == "__main__":
    main()
