#!/usr/bin/env python3
"""Talk to `benchdog replan` from Python: a person walks past the robot, and the robot's hold follows.

    python3 examples/replan.py [BENCHDOG]

BENCHDOG is the program, by default target/release/benchdog or the one on the path. Only the standard library is used.
"""

from __future__ import annotations

import json
import math
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


class Replanner:
    """A `benchdog replan` process: one line of JSON for each request, and one for each answer."""

    def __init__(self, program: str, scenario: Path) -> None:
        command = [program, "replan", str(scenario)]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def ask(self, **request: object) -> dict:
        self.process.stdin.write(json.dumps(request) + "\n")
        self.process.stdin.flush()
        line = self.process.stdout.readline()
        if not line:
            raise RuntimeError(f"benchdog replan ended with exit code {self.process.wait()}")
        return json.loads(line)

    def close(self) -> int:
        self.process.stdin.close()
        return self.process.wait()


def heading_deg(x_wb: dict) -> float:
    """The direction of x_B from a pose with a unit quaternion, scalar last: the person stands upright."""
    x, y, z, w = x_wb["rotation_xyzw"]
    return math.degrees(math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)))


def main() -> int:
    built = ROOT / "target/release/benchdog"
    program = sys.argv[1] if len(sys.argv) > 1 else str(built) if built.exists() else shutil.which("benchdog")
    if program is None:
        print("error: found no benchdog, expected its path as the argument", file=sys.stderr)
        return 2
    replanner = Replanner(program, ROOT / "scenarios/quickstart.toml")
    first = replanner.ask(id="free")
    x_wb = first["plan"]["human"]["x_wb"]
    x_m, y_m, _ = x_wb["translation_m"]
    for step in range(6):
        place = {"x_m": x_m, "y_m": y_m + 0.02 * step, "heading_deg": heading_deg(x_wb)}
        answer = replanner.ask(id=step, human=place, most_motion_deg=30)
        if answer["result"] != "found":
            print(f"{2 * step:3} cm: {answer['result']}: {answer['reason']}")
            continue
        objective = answer["plan"]["comfort"]["objective"]
        motion = answer["motion"]
        print(
            f"{2 * step:3} cm: {answer['wall_ms']:6.1f} ms, objective {objective:.2f}, "
            f"joints move by at most {motion['largest_joint_deg']:.1f} degrees, the board by {motion['board_mm']:.0f} mm"
        )
    return replanner.close()


if __name__ == "__main__":
    sys.exit(main())
