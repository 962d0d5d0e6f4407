#!/usr/bin/env python3
"""Check verdicts of Benchdog in another physics engine.

    tools/crosscheck.py SCENARIO_OR_PLAN [...] [--benchdog FILE] [--failing-load] [--tolerance SHARE] [--json]

Each argument is a scenario (.toml), a plan (.json) or a folder: of scenarios, or of plans such as the output folder
of `benchdog run`. Benchdog plans what has no plan, simulates it and gives its verdict, confirmed at shorter time steps
where it is near to a limit. Then `benchdog export --mjcf` writes the scene, MuJoCo plays it here, and the motion is
judged by the same limits and in the same order (docs/method.md, section 8). Everything that is played and judged is in
the exported file; section 7.7 describes it. Both results are printed side by side.

`--failing-load` also searches the multiple of the load at which the hold fails: in MuJoCo here, by bisection to 0.1
%, and with `benchdog margin`.

Not compared are plans that Benchdog does not simulate (nothing found, bodies that touch, a person who would not stand
so), and holds that it judges by what is not in the exported file: `touches`, by the person, and `collides`, by the
robot's clearance.

The engines agree if they give the same verdict and, where both hold, deflections that differ by less than the tolerance:
a share of the deflection and a share of what the pads' sliding contributes to it. Coulomb's law does not determine how
points that share a face divide friction between them once some of them slide, so there two correct engines differ more.

The exit code is 0 if the engines agree, 1 if not, and 2 for invalid input.

Needs Python 3.9 and the packages `mujoco` (measured with 3.3.7) and `numpy`.
"""

from __future__ import annotations

import argparse
import itertools
import json
import re
import subprocess
import sys
import tempfile
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Dict, List, Optional, Tuple

import mujoco
import numpy as np

REPOSITORY = Path(__file__).resolve().parent.parent

# The verdict that each check gives if its limit is the first that is crossed. Of checks that are crossed at the same
# sample the first in this order counts.
VERDICTS = {
    "drop": "drops",
    "contact_lost": "drops",
    "pad_open": "opens",
    "slip": "slips",
    "slip_rotation": "pivots",
    "torque_ratio": "saturates",
    "sag": "sags",
    "deflection": "deflects",
    "creep": "creeps",
}
# Verdicts by distances that are not in the exported file: the person's, and the robot's from itself and the board.
BY_DISTANCE = {"touches", "collides"}
# Limits that no scenario states (docs/method.md, section 8.6).
LIMITS = {"drop": 50.0, "pad_open": 30.0, "contact_lost": 0.0}
# A pad is open below this share of the grip force.
OPEN_SHARE = 0.05
# A board that no pad has touched for so long is lost, and the rest is not played, s.
LOST_AFTER_S = 0.1
# The search for the failing load, as that of Benchdog: range, first stride and final width relative to the load.
LEAST_FACTOR, LARGEST_FACTOR, STRIDE, WIDTH = 1 / 64, 100.0, 1.1, 1e-3
# Stands for the failing load of a hold that the largest factor does not end.
NEVER_FAILS = LARGEST_FACTOR + 1
# How far deflections may differ beyond that, as a share of what the pads' sliding contributes. Among the plans of three
# planners for the paper's 25 operations it is at most 0.22.
SLIDING_SHARE = 0.25
# Deflections that differ by less agree, mm.
LEAST_DIFFERENCE_MM = 0.02
# Exit codes of a Benchdog that reached its end: expectations met, not met, no plan.
ENDED = {0, 1, 3}


class InputError(Exception):
    """Input that cannot be used. The message names the file, what was found and what was expected."""


# --- The exported file ------------------------------------------------------------------------------------------------


class Scene:
    """An exported scene: the model, and what the file says about load, phases, names and limits."""

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            self.model = mujoco.MjModel.from_xml_path(str(path))
        except ValueError as error:
            raise InputError(f"{path}: MuJoCo cannot read it: {error}") from error
        model = self.model
        self.sample_s = float(self.numbers("tool_timestep_s")[0])
        self.steps_per_sample = round(self.sample_s / model.opt.timestep)
        self.wrenches_o = self.table("tool_wrench_o").reshape(-1, 6)
        self.points_o = self.table("tool_point_o").reshape(-1, 3)
        self.turns_with_board = self.text("tool_frame") == "board"
        self.grip, settle, ramp, hold, _ = (int(count) for count in self.numbers("phase_samples"))
        # The last sample of settling, that of the hold, and the number of the hold's samples.
        self.settled, self.end, self.hold = self.grip + settle, self.grip + settle + ramp + hold, hold
        self.hand_over = int(self.numbers("hand_over_samples")[0])
        self.board_control = self.table("board_control")
        # The force below which a pad is open, two pads a hand, N.
        self.least_n = OPEN_SHARE * np.repeat(self.numbers("grip_force_n"), 2)
        self.hands = self.text("hands").split("; ")
        self.pads = self.text("pads").split("; ")
        joints = [name for names in self.text("joints").split("; ") for name in names.split()]
        self.board = model.body("board").id
        self.sites = [model.site(f"{hand} hand").id for hand in self.hands]
        self.servos = np.array([model.actuator(name).id for name in joints], dtype=int)
        self.q_index = np.array([model.joint(name).qposadr[0] for name in joints], dtype=int)
        self.v_index = np.array([model.joint(name).dofadr[0] for name in joints], dtype=int)
        self.motors = [model.actuator(f"tool_{axis}").id for axis in ("fx", "fy", "fz", "mx", "my", "mz")]
        self.fingers = np.setdiff1d(np.arange(self.model.nu), [*self.servos, *self.motors])
        # The pad of each geom; geoms that are no part of a pad count as one more.
        self.pad_of_geom = np.full(model.ngeom, len(self.pads))
        for index, pad in enumerate(self.pads):
            for part in ("core", "ball", "face"):
                self.pad_of_geom[model.geom(f"{pad} {part}").id] = index
        self.limits = dict(LIMITS)
        fields = {"slip": "slip_mm", "slip_rotation": "slip_deg", "sag": "sag_mm", "deflection": "deflection_mm"}
        fields.update(creep="creep_mm_s", torque_ratio="torque_ratio")
        self.limits.update({check: float(self.numbers(f"limit_{name}")[0]) for check, name in fields.items()})

    def numbers(self, name: str) -> np.ndarray:
        """A numeric field."""
        if not self.has_numbers(name):
            raise InputError(f"{self.path}: found no numeric field {name}, expected an export of Benchdog")
        return np.array(self.model.numeric(name).data)

    def has_numbers(self, name: str) -> bool:
        """Whether there is a numeric field of this name."""
        return mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_NUMERIC, name) >= 0

    def table(self, name: str) -> np.ndarray:
        """A table in several numbered fields."""
        count = next(number for number in itertools.count() if not self.has_numbers(f"{name} {number}"))
        return np.concatenate([self.numbers(f"{name} {number}") for number in range(max(count, 1))])

    def text(self, name: str) -> str:
        """A text field."""
        index = mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_TEXT, name)
        if index < 0:
            raise InputError(f"{self.path}: found no text field {name}, expected an export of Benchdog")
        start = self.model.text_adr[index]
        return self.model.text_data[start : start + self.model.text_size[index] - 1].decode()


# --- Playing ----------------------------------------------------------------------------------------------------------


@dataclass
class Motion:
    """What is observed after each sample; the first is the initial state."""

    board_p: List[np.ndarray] = field(default_factory=list)
    board_r: List[np.ndarray] = field(default_factory=list)
    # One row a hand: position in O, m, and rotation, of the point between the pads.
    hands_p: List[np.ndarray] = field(default_factory=list)
    hands_r: List[np.ndarray] = field(default_factory=list)
    # Demanded torque divided by its limit, of each joint.
    torque_ratio: List[np.ndarray] = field(default_factory=list)
    # Normal force of each pad, N, in the last step.
    pads_n: List[np.ndarray] = field(default_factory=list)
    broke_down: bool = False


def play(scene: Scene, factor: float = 1.0) -> Motion:
    """Plays grip, settling, ramp and hold under a multiple of the load."""
    model, data, motion = scene.model, mujoco.MjData(scene.model), Motion()
    mujoco.mj_resetDataKeyframe(model, data, model.key("planned").id)
    mujoco.mj_forward(model, data)
    planned_r = data.xmat[scene.board].reshape(3, 3).copy()
    weight_n = -model.opt.gravity * model.body_mass[scene.board]
    held = data.ctrl.copy()
    observe(scene, data, motion)
    untouched_s = 0.0
    for sample in range(1, scene.end + 1):
        board_r = data.xmat[scene.board].reshape(3, 3)
        force, moment = np.split(factor * scene.wrenches_o[sample], 2)
        if not scene.turns_with_board:
            force, moment = board_r.T @ planned_r @ force, board_r.T @ planned_r @ moment
        moment = moment + np.cross(scene.points_o[sample] - scene.points_o[0], force)
        # The grippers close while the board is supported, then the arms take over its weight.
        supported = 1 - share(sample - scene.grip, scene.hand_over)
        data.ctrl = held - supported * scene.board_control
        data.ctrl[scene.fingers] *= share(sample, scene.grip)
        data.ctrl[scene.motors] = np.concatenate([force, moment])
        data.xfrc_applied[scene.board, :3] = supported * weight_n
        mujoco.mj_step(model, data, scene.steps_per_sample)
        if np.any(data.warning.number):
            motion.broke_down = True
            break
        observe(scene, data, motion)
        untouched_s = 0.0 if np.any(motion.pads_n[-1] > 0) else untouched_s + scene.sample_s
        if untouched_s > LOST_AFTER_S:
            break
    return motion


def share(sample: int, samples: int) -> float:
    """The share of `samples` that are over after a sample: 0 before the first one."""
    return min(max(sample, 0) / samples, 1.0) if samples else 1.0


def observe(scene: Scene, data: mujoco.MjData, motion: Motion) -> None:
    """Appends the state to a motion."""
    model = scene.model
    # A step leaves positions of bodies and sites as they were before it.
    mujoco.mj_kinematics(model, data)
    board_p, board_r = data.xpos[scene.board].copy(), data.xmat[scene.board].reshape(3, 3).copy()
    motion.board_p.append(board_p)
    motion.board_r.append(board_r)
    motion.hands_p.append(np.array([board_r.T @ (data.site_xpos[site] - board_p) for site in scene.sites]))
    motion.hands_r.append(np.array([board_r.T @ data.site_xmat[site].reshape(3, 3) for site in scene.sites]))
    servos = scene.servos
    demanded_nm = (
        model.actuator_gainprm[servos, 0] * data.ctrl[servos]
        + model.actuator_biasprm[servos, 1] * data.qpos[scene.q_index]
        + model.actuator_biasprm[servos, 2] * data.qvel[scene.v_index]
    )
    motion.torque_ratio.append(np.abs(demanded_nm) / model.actuator_forcerange[servos, 1])
    touching = data.contact.efc_address >= 0
    pads = scene.pad_of_geom[data.contact.geom[touching]].min(axis=1)
    # The first force of a contact with an elliptic cone is the normal one.
    normal_n = data.efc_force[data.contact.efc_address[touching]]
    motion.pads_n.append(np.bincount(pads, weights=normal_n, minlength=len(scene.pads) + 1)[: len(scene.pads)])


# --- Judging ----------------------------------------------------------------------------------------------------------


@dataclass
class Result:
    """The verdict of an engine."""

    verdict: str
    first_check: Optional[str]
    # The largest value of each check.
    values: Dict[str, float]
    # How far the tool point moves in the frames of the hands after settling, mm, of the hand with the most of it.
    sliding_mm: float = 0.0
    # The multiple of the load at which the hold fails, if it was searched: 101 if it holds the largest that is tried.
    fails_at: Optional[float] = None


def judge(scene: Scene, motion: Motion) -> Result:
    """Judges a motion: the check whose limit is crossed first gives the verdict."""
    series = measure(scene, motion)
    crossings = []
    for order, check in enumerate(check for check in VERDICTS if check in series):
        crossed = np.flatnonzero(~(series[check] <= scene.limits[check]))
        crossings += [(int(crossed[0]), order, check)] if crossed.size else []
    values = {check: float(np.max(of)) for check, of in series.items()}
    first = min(crossings)[2] if crossings else None
    unfailed = "no_verdict" if motion.broke_down else "holds"
    return Result(VERDICTS[first] if first else unfailed, first, values, sliding_mm(scene, motion))


def sliding_mm(scene: Scene, motion: Motion) -> float:
    """The movement of the tool point in the frame of a hand: the largest of both hands after settling."""
    hands_p, hands_r = np.array(motion.hands_p[scene.settled :]), np.array(motion.hands_r[scene.settled :])
    if not len(hands_p):
        return 0.0
    points_o = scene.points_o[scene.settled : scene.settled + len(hands_p), None]
    now = np.einsum("thji,thj->thi", hands_r, points_o - hands_p)
    settled = np.einsum("hji,thj->thi", hands_r[0], points_o - hands_p[0])
    return float(1e3 * np.linalg.norm(now - settled, axis=2).max())


def measure(scene: Scene, motion: Motion) -> Dict[str, np.ndarray]:
    """One value a sample for each check, from the hand-over to the end or the loss of the board."""
    start = min(scene.grip, len(motion.board_p) - 1)
    hands_p, hands_r = np.array(motion.hands_p[start:]), np.array(motion.hands_r[start:])
    touched = np.array([np.any(force_n > 0) for force_n in motion.pads_n[start:]])
    slip_mm = 1e3 * np.linalg.norm(hands_p - hands_p[0], axis=2).max(axis=1)
    # What follows the loss of the board tells nothing about the hold.
    lost = np.flatnonzero(~touched | (slip_mm > LIMITS["drop"]))
    count = int(lost[0]) + 1 if lost.size else len(touched)
    settled = min(scene.settled - start, count - 1)
    judged = slice(start, start + count)
    board_p, board_r = np.array(motion.board_p[judged]), np.array(motion.board_r[judged])
    points = scene.points_o[judged]
    # Rotations that differ by an angle have a difference of the Frobenius norm `sqrt(8) sin(angle / 2)`.
    half_sine = np.linalg.norm(hands_r - hands_r[0], axis=(2, 3)).max(axis=1) / np.sqrt(8)
    slip_deg = np.degrees(2 * np.arcsin(np.minimum(half_sine, 1)))

    def moved_mm(since: int) -> np.ndarray:
        now = board_p + np.einsum("tij,tj->ti", board_r, points)
        return 1e3 * np.linalg.norm(now - board_p[since] - points @ board_r[since].T, axis=1)

    is_settling = np.arange(count) <= settled
    pads_n = np.array(motion.pads_n[judged])
    series = {
        "slip": slip_mm[:count],
        "slip_rotation": slip_deg[:count],
        "sag": np.where(is_settling, moved_mm(0), 0.0),
        "deflection": np.where(is_settling, 0.0, moved_mm(settled)),
        "torque_ratio": np.array(motion.torque_ratio[judged]).max(axis=1),
        "pad_open": np.max([open_ms(scene, of_pad) for of_pad in (pads_n < scene.least_n).T], axis=0),
        "contact_lost": open_ms(scene, ~touched[:count]),
        "drop": slip_mm[:count],
    }
    if not lost.size and not motion.broke_down and (rate_mm_s := creep_mm_s(scene, hands_p)) is not None:
        series["creep"] = np.where(np.arange(count) == count - 1, rate_mm_s, 0.0)
    return series


def open_ms(scene: Scene, condition: np.ndarray) -> np.ndarray:
    """For how long a condition has been true at each sample, ms."""
    lasted, result = 0, np.zeros(len(condition))
    for index, is_true in enumerate(condition):
        lasted = lasted + 1 if is_true else 0
        result[index] = round(lasted * scene.sample_s * 1e6) / 1e3
    return result


def creep_mm_s(scene: Scene, hands_p: np.ndarray) -> Optional[float]:
    """The slope of the hands' positions in the second half of a whole hold; None if the load changes in it."""
    half = (scene.hold - 1) // 2
    load = np.hstack([scene.wrenches_o, scene.points_o])[scene.end - half : scene.end + 1]
    if half < 1 or np.any(load != load[0]):
        return None
    time_s = scene.sample_s * (np.arange(half + 1) - half / 2)
    moved_m = hands_p[-half - 1 :] - hands_p[-half - 1]
    return float(1e3 * np.linalg.norm(np.einsum("t,thi->hi", time_s, moved_m) / (time_s @ time_s), axis=1).max())


def failing_load(scene: Scene, guess: float) -> float:
    """The smallest multiple of the load that was found to fail, at most 0.1 % above one that holds."""
    holds_at, fails_at, stride = 0.0, NEVER_FAILS, STRIDE
    factor = min(max(guess, LEAST_FACTOR), LARGEST_FACTOR)
    while True:
        if judge(scene, play(scene, factor)).verdict == "holds":
            holds_at = factor
        else:
            fails_at = factor
        if fails_at == NEVER_FAILS:
            if holds_at >= LARGEST_FACTOR:
                return fails_at
            factor = min(holds_at * stride, LARGEST_FACTOR)
        elif holds_at == 0 and fails_at > LEAST_FACTOR:
            factor = max(fails_at / stride, LEAST_FACTOR)
        elif holds_at == 0 or fails_at - holds_at <= WIDTH * fails_at:
            return fails_at
        else:
            factor = (holds_at + fails_at) / 2
        stride *= stride


# --- Benchdog ---------------------------------------------------------------------------------------------------------


def benchdog(binary: Path, *arguments: object) -> str:
    """Runs Benchdog; returns what it prints."""
    command = [str(binary), *map(str, arguments)]
    try:
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    except OSError as error:
        raise InputError(f"{binary}: {error.strerror}, expected the program of `cargo build --release`") from error
    if done.returncode not in ENDED:
        raise InputError(done.stderr.strip() or f"{' '.join(command)}: exit code {done.returncode}")
    return done.stdout


def inputs(paths: List[Path]) -> List[Path]:
    """The scenarios and plans of files and folders."""
    found: List[Path] = []
    for path in paths:
        if path.is_dir():
            inside = [sorted(path.glob(pattern)) for pattern in ("*.toml", "*/plan.json", "*.json")]
            if not any(inside):
                raise InputError(f"{path}: found no scenario and no plan in this folder")
            found += next(filter(None, inside))
        elif path.suffix in (".toml", ".json") and path.is_file():
            found.append(path)
        else:
            raise InputError(f"{path}: found no such file, expected a scenario (.toml), a plan (.json) or a folder")
    return found


def verdicts(binary: Path, files: List[Path], out: Path) -> Dict[Path, Path]:
    """Plans, simulates and judges; returns the folder with the plan and the verdict of each file."""
    folders: Dict[Path, Path] = {}
    scenarios = [file for file in files if file.suffix == ".toml"]
    if scenarios:
        benchdog(binary, "run", "--record", "never", "--out", out / "run", *scenarios)
    for number, file in enumerate(files):
        if file.suffix == ".toml":
            # Benchdog has read the file, so it has this key.
            name = re.search(r'^name\s*=\s*["\'](.*)["\']', file.read_text(encoding="utf-8"), re.MULTILINE)
            folders[file] = out / "run" / (name.group(1) if name else file.stem)
        else:
            benchdog(binary, "simulate", file, "--record", "never", "--out", out / str(number))
            folders[file] = next((out / str(number)).glob("*/verdict.json")).parent
    return folders


@dataclass
class Comparison:
    """The results of both engines for a scenario or plan."""

    name: str
    benchdog: Result
    mujoco: Optional[Result]
    agrees: bool
    # Why MuJoCo's result is missing, or not compared.
    note: str = ""


def compare(file: Path, folder: Path, options: argparse.Namespace) -> Comparison:
    """Plays a plan in MuJoCo and compares the results."""
    verdict = json.loads((folder / "verdict.json").read_text(encoding="utf-8"))
    values = {check["name"]: check["value"] for check in verdict["checks"]}
    first = (verdict.get("first_failure") or {}).get("check")
    ours = Result(verdict["verdict"], first, values)
    if not values:
        return Comparison(verdict["name"], ours, None, True, f"not simulated: {verdict.get('reason') or ours.verdict}")
    plan = folder / "plan.json" if file.suffix == ".toml" else file
    scenario = ["--scenario", file] if file.suffix == ".toml" else []
    scene_file = folder / "scene.xml"
    benchdog(options.benchdog, "export", plan, *scenario, "--mjcf", scene_file)
    scene = Scene(scene_file)
    theirs = judge(scene, play(scene))
    if options.failing_load:
        margin = json.loads(benchdog(options.benchdog, "margin", plan, *scenario, "--format", "json"))
        ours.fails_at = NEVER_FAILS if margin["fails_at"] is None else margin["fails_at"]
        theirs.fails_at = failing_load(scene, ours.fails_at)
    if ours.verdict in BY_DISTANCE:
        return Comparison(verdict["name"], ours, theirs, True, f"not compared: {first} is not judged in MuJoCo")
    agrees = ours.verdict == theirs.verdict
    if agrees and ours.verdict == "holds":
        off_mm = abs(theirs.values["deflection"] - values["deflection"])
        tolerance_mm = options.tolerance * values["deflection"] + SLIDING_SHARE * theirs.sliding_mm
        agrees = off_mm <= max(tolerance_mm, LEAST_DIFFERENCE_MM)
    return Comparison(verdict["name"], ours, theirs, agrees)


# --- Output -----------------------------------------------------------------------------------------------------------

COLUMNS: List[Tuple[str, str, int]] = [
    ("deflection", "deflection mm", 3),
    ("slip", "slip mm", 3),
    ("slip_rotation", "rotation deg", 3),
    ("torque_ratio", "torque", 3),
]


def table(comparisons: List[Comparison], failing: bool) -> str:
    """Two lines for each comparison."""
    rows = [["name", "engine", "verdict", "first failed", *(title for _, title, _ in COLUMNS)]]
    rows[0] += ["fails at"] if failing else []
    for one in comparisons:
        engines = [("Benchdog", one.benchdog), ("MuJoCo", one.mujoco)]
        for engine, result in engines[: 1 if one.mujoco is None else 2]:
            row = [one.name if engine == "Benchdog" else "", engine, result.verdict, result.first_check or "-"]
            row += [f"{result.values[key]:.{digits}f}" if key in result.values else "-" for key, _, digits in COLUMNS]
            row += [("-" if result.fails_at is None else f"{result.fails_at:.3f}")] if failing else []
            is_last = engine == "MuJoCo" or one.mujoco is None
            row.append((one.note or ("agrees" if one.agrees else "DIFFERS")) if is_last else "")
            rows.append(row)
    rows[0].append("")
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip() for row in rows]
    compared = [one for one in comparisons if not one.note]
    agreed = sum(one.agrees for one in compared)
    return "\n".join([*lines, f"{agreed} of {len(compared)} agree, {len(comparisons) - len(compared)} not compared"])


def arguments() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter,
                                     usage=argparse.SUPPRESS)
    parser.add_argument("files", nargs="+", type=Path, metavar="SCENARIO_OR_PLAN")
    parser.add_argument("--benchdog", type=Path, default=REPOSITORY / "target" / "release" / "benchdog", metavar="FILE")
    parser.add_argument("--failing-load", action="store_true", help="also search the load at which the hold fails")
    parser.add_argument("--tolerance", type=float, default=0.03, metavar="SHARE",
                        help="largest relative difference of the deflections, 0.03 by default")
    parser.add_argument("--json", action="store_true", help="print JSON instead of a table")
    return parser.parse_args()


def main() -> int:
    """Compares; returns the exit code."""
    options = arguments()
    try:
        files = inputs(options.files)
        with tempfile.TemporaryDirectory(prefix="crosscheck-") as folder:
            folders = verdicts(options.benchdog, files, Path(folder))
            comparisons = [compare(file, folders[file], options) for file in files]
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    if options.json:
        print(json.dumps([asdict(one) for one in comparisons], indent=2))
    else:
        print(table(comparisons, options.failing_load))
    return 0 if all(one.agrees for one in comparisons) else 1


if __name__ == "__main__":
    sys.exit(main())
