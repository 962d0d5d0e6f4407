"""Plans, simulations and the planner."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, Callable, Dict, Optional, Union

from . import _native
from ._verdict import Verdict, verdict_of

Source = Union[str, "os.PathLike[str]", Dict[str, Any]]
"""A path, a text or a dict."""

PlanProgress = Callable[[str, int, int], object]
"""Called with what is done, how much of it is done and all of it, which is 0 if that is not known."""


def plan(
    scenario: Source,
    *,
    seed: Optional[int] = None,
    kind: Optional[str] = None,
    budget: Optional[str] = None,
    evaluations: Optional[int] = None,
    cache: bool = True,
    progress: Optional[PlanProgress] = None,
) -> Dict[str, Any]:
    """The best plan of a scenario, as a dict with the keys of a plan file.

    scenario: the path of a scenario file; a `str` of several lines with a scenario file's TOML; or a dict with its tables and keys.
    Errors name the file (`<text>`, `<dict>`), the line and the key. Paths in a text or a dict are relative to the working directory.
    seed, kind, budget, evaluations: in place of the scenario's `planner.seed`, `kind` (`comfort`, `muscular`, `peripersonal`,
    `random`), `budget` (`fast`, `default`, `exhaustive`) and `evaluations`.
    cache: False if no kept maps are read or written; the folder is that of the command.
    progress: called now and then from the calling thread.

    Units in the plan: m, rad, N, kg, s, as its keys say; poses `x_wo`, `x_og`, `x_wb` are `{"translation_m": [x, y, z],
    "rotation_xyzw": [x, y, z, w]}`. The same inputs and seed give the same plan. `json.dump(plan, file)` writes a plan file.

    Raises `Error` for an input that is not valid, `Infeasible` if there is no plan.
    """
    return _native.plan(scenario, _search(seed, kind, budget, evaluations), cache, progress)


def simulate(
    plan: Source,
    *,
    scenario: Optional[Source] = None,
    friction: Optional[float] = None,
    force_scale: Optional[float] = None,
    expect: Optional[str] = None,
    recording: Optional[Union[str, "os.PathLike[str]"]] = None,
    record: str = "always",
) -> Verdict:
    """Simulates a plan of one hold and judges it.

    plan: a dict as `plan` gives it; the path of a plan file; or a `str` with its JSON. It may come from another planner and leave out
    what follows from the rest.
    scenario: the scenario to judge it by, as in `plan`; by default the one in the plan.
    friction: the Coulomb coefficient of pads and board in the simulation, in place of `grip.friction`; positive, at most 2.
    force_scale: the tool's force in the simulation as a multiple of the planned one, in place of `uncertainty.force_scale`; 0 to 100.
    expect: the verdict that is expected, in place of the scenario's.
    recording: where the recording for the viewer is written. `record`: `always`, or `failed` if only when the verdict is not the
    expected one.

    Raises `Error` for an input that is not valid. A plan whose bodies meet is not simulated; its verdict is `collides` or `touches`.
    """
    options: _native.SimulateOptions = {
        "friction": friction,
        "force_scale": force_scale,
        "expect": expect,
        "recording": recording,
        "record": record,
    }
    return verdict_of(_native.simulate(plan, scenario, options))


@dataclass(frozen=True)
class Motion:
    """How far arms and board are from where the plan before has them."""

    largest_joint_deg: float
    """The largest difference of a joint, degrees (mm for a prismatic joint)."""
    length_deg: float
    """The root of the sum of the squared differences of all joints, degrees."""
    board_mm: float
    """Distance of the board's centres, mm."""
    board_deg: float
    """Rotation of the board, degrees."""
    regrasps: bool
    """True if a gripper grasps the board elsewhere or otherwise."""


@dataclass(frozen=True)
class Replanned:
    """A plan for a task that has changed."""

    plan: Dict[str, Any]
    """The plan, as `plan()` gives it."""
    motion: Optional[Motion]
    """The way from the plan before; `None` for the first one."""
    searched: bool
    """True if no known hold served and the task was planned from scratch."""


class Planner:
    """A planner for a scenario's robot that keeps what many plans share, and replans.

    The arguments are those of `plan`. A call from another thread waits until the one before has ended.
    """

    def __init__(
        self,
        scenario: Source,
        *,
        seed: Optional[int] = None,
        kind: Optional[str] = None,
        budget: Optional[str] = None,
        evaluations: Optional[int] = None,
        cache: bool = True,
    ) -> None:
        self._native = _native.Planner(scenario, _search(seed, kind, budget, evaluations), cache)

    def plan(
        self,
        scenario: Optional[Source] = None,
        *,
        seed: Optional[int] = None,
        kind: Optional[str] = None,
        budget: Optional[str] = None,
        evaluations: Optional[int] = None,
        progress: Optional[PlanProgress] = None,
    ) -> Dict[str, Any]:
        """As the function `plan`, for another scenario with the same robot, or by default for the planner's, with what was changed by
        `replan`."""
        return self._native.plan(scenario, _search(seed, kind, budget, evaluations), progress)

    def prepare(self, progress: Optional[PlanProgress] = None) -> None:
        """Reads or makes the maps that the first `replan` needs: some seconds if none are kept."""
        self._native.prepare(progress)

    def resume(self, plan: Source) -> bool:
        """Makes a plan the one that the next `replan` starts from, such as that which the robot holds now. False, and nothing is
        changed, if the plan breaks a limit of the scenario."""
        return self._native.resume(plan)

    def replan(
        self,
        *,
        human: Optional[Dict[str, Any]] = None,
        operation: Optional[Dict[str, Any]] = None,
        most_motion_deg: Optional[float] = None,
        keep_grasps: Optional[bool] = None,
        search: Optional[bool] = None,
    ) -> Replanned:
        """A plan for what has changed since the call before, in milliseconds; what is left out stays. The keys are those of a request
        of `benchdog replan`.

        human: where the person stands now, in W: `x_m`, `y_m`, m, and `heading_deg`, degrees from x_W towards y_W; `place_tolerance_m`
        and `heading_tolerance_deg`; or `{"place": "free"}`.
        operation: the operation, of the scenario's kind: `kind`, `point_m` in O, `force_n`, and so on.
        most_motion_deg: the most that each joint may move from the last plan, degrees; of this call alone.
        keep_grasps: True if the grippers stay where they are on the board; of this call alone.
        search: False if a task that no known hold serves is not planned from scratch; of this call alone.

        Raises `Infeasible` if there is no plan; the next call then starts from the plan before.
        """
        request: Dict[str, Any] = {
            "human": human,
            "operation": operation,
            "most_motion_deg": most_motion_deg,
            "keep_grasps": keep_grasps,
            "search": search,
        }
        answer = self._native.replan(request)
        motion = answer["motion"]
        return Replanned(
            plan=answer["plan"],
            motion=None if motion is None else Motion(**motion),
            searched=answer["searched"],
        )


def _search(
    seed: Optional[int], kind: Optional[str], budget: Optional[str], evaluations: Optional[int]
) -> _native.SearchOptions:
    return {"seed": seed, "kind": kind, "budget": budget, "evaluations": evaluations}
