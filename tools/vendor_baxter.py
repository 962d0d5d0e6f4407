#!/usr/bin/env python3
"""Compares Baxter as its vendor publishes it with the built-in one.

    tools/vendor_baxter.py FOLDER

FOLDER/baxter.toml is the description that `benchdog robot new` wrote of the vendor's URDF. With the pads, efforts and
stiffness of assets/baxter.toml filled in, its grippers must be where the built-in ones are for the same angles, to 1e-9, and
its failing load must be the same within 2 %. `benchdog` must be on the path.
"""

import json
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
FILLED_IN = ["stiffness_nm_rad", "damping_nm_s_rad", "pad_size_m", "pad_centre_m", "max_force_n"]
POSE_TOLERANCE = 1e-9
MARGIN_TOLERANCE = 0.02


def benchdog(*arguments: str, folder: Path) -> str:
    done = subprocess.run(["benchdog", *arguments], cwd=folder, capture_output=True, text=True)
    if done.returncode not in (0, 1):
        sys.exit(f"benchdog {' '.join(arguments)}: {done.stderr}")
    return done.stdout


def with_figures_of(built_in: str, vendor: str) -> str:
    value = lambda key: re.search(rf"^{key} = (.*)$", built_in, flags=re.MULTILINE).group(1)
    for key in FILLED_IN:
        vendor = re.sub(rf"^{key} = .*$", f"{key} = {value(key)}", vendor, flags=re.MULTILINE)
    vendor = re.sub(r"^(grip_force_n|friction) = .*\n", "", vendor, flags=re.MULTILINE)
    return re.sub(r"^(stiffness_nm_rad)", f"effort_nm = {value('effort_nm')}\n\\1", vendor, flags=re.MULTILINE)


def distance(a: dict, b: dict) -> float:
    """The largest difference of a number of two poses; a quaternion and its negative are one rotation."""
    moved = max(abs(x - y) for x, y in zip(a["translation_m"], b["translation_m"]))
    turned = min(
        max(abs(x - sign * y) for x, y in zip(a["rotation_xyzw"], b["rotation_xyzw"])) for sign in (1, -1)
    )
    return max(moved, turned)


def main() -> None:
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder = Path(sys.argv[1]).resolve()
    description = folder / "baxter-filled-in.toml"
    built_in = (ROOT / "assets" / "baxter.toml").read_text()
    description.write_text(with_figures_of(built_in, (folder / "baxter.toml").read_text()))
    benchdog("plan", str(ROOT / "scenarios" / "quickstart.toml"), "-o", "built-in.json", folder=folder)
    plan = json.loads((folder / "built-in.json").read_text())
    margins = []
    for robot in ["baxter", str(description)]:
        own = json.loads(json.dumps(plan))
        own["robot"] = own["scenario"]["robot"]["description"] = robot
        for key in ["clearance", "stability", "planner", "comfort"]:
            own.pop(key, None)
        # The grippers' poses are left out, so that they are filled in from the angles.
        for arm in own["arms"]:
            del arm["x_og"]
        name = f"same-plan-{len(margins)}"
        own["name"] = name
        (folder / f"{name}.json").write_text(json.dumps(own))
        benchdog("simulate", f"{name}.json", "--record", "never", "--out", "same-plan", folder=folder)
        filled_in = json.loads((folder / "same-plan" / name / "plan.json").read_text())
        for arm, wanted in zip(filled_in["arms"], plan["arms"]):
            off = distance(arm["x_og"], wanted["x_og"])
            print(f"{robot}: {arm['name']} gripper within {off:.1e}")
            if off > POSE_TOLERANCE:
                sys.exit(f"expected at most {POSE_TOLERANCE}")
        text = benchdog("margin", f"{name}.json", folder=folder)
        margins.append(float(re.search(r"^simulated +([0-9.]+)", text, flags=re.MULTILINE).group(1)))
        print(f"{robot}: holds up to {margins[-1]} times the load")
    if abs(margins[1] / margins[0] - 1) > MARGIN_TOLERANCE:
        sys.exit(f"expected failing loads within {MARGIN_TOLERANCE:.0%}")


if __name__ == "__main__":
    main()
