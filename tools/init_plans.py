#!/usr/bin/env python3
"""Writes the plans that `benchdog init` has, from its scenarios and tasks: tools/init_plans.py target/release/benchdog"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

EXAMPLES = Path(__file__).resolve().parent.parent / "assets" / "init"

# What a grasp planner gives, and its scenario in another example whose plan has such grasps.
GRASPS_OF = {"panel": "drill", "panel-left": "drill-left", "panel-right": "drill-right"}
FORCE_N = 10.0


def rounded(pose):
    """A pose with the digits that another planner would write."""
    return {key: [round(value, 6) + 0.0 for value in values] for key, values in pose.items()}


def grasps_alone(plan, name):
    """The pose of the board and the grasps of a plan, for the thrust FORCE_N."""
    wrench_o = [0.0, 0.0, -FORCE_N, 0.0, 0.0, 0.0]
    return {
        "format": 1,
        "name": name,
        "robot": plan["robot"],
        "operation": {**plan["operation"], "wrench_o": wrench_o, "x_ot": rounded(plan["operation"]["x_ot"])},
        "object": {**plan["object"], "x_wo": rounded(plan["object"]["x_wo"])},
        "arms": [{"name": arm["name"], "x_og": rounded(arm["x_og"])} for arm in plan["arms"]],
    }


def main():
    benchdog = sys.argv[1]

    def run(*arguments):
        subprocess.run([benchdog, *map(str, arguments)], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    for scenario in sorted(EXAMPLES.glob("*/scenarios/*.toml")):
        if scenario.stem not in GRASPS_OF:
            run("plan", scenario, "-o", scenario.parent.parent / "plans" / f"{scenario.stem}.json")
    for task in sorted(EXAMPLES.glob("*/tasks/*.toml")):
        with tempfile.TemporaryDirectory() as folder:
            run("task", task, "--plan-only", "--out", folder)
            plan = Path(folder, task.stem, "plan.json").read_bytes()
            (task.parent.parent / "plans" / f"{task.stem}.json").write_bytes(plan)
    for name, source in GRASPS_OF.items():
        plan = json.loads((EXAMPLES / "drill" / "plans" / f"{source}.json").read_text())
        text = json.dumps(grasps_alone(plan, name), indent=2) + "\n"
        (EXAMPLES / "your-plan" / "plans" / f"{name}.json").write_text(text)


main()
