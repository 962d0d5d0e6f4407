"""Verdicts: what was checked, and the simulation behind it."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Dict, List, Optional

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Check:
    """A measured value and its limit."""

    name: str
    """What was measured, such as `slip` or `torque_ratio`."""
    value: float
    """The worst value."""
    limit: float
    """The limit: the largest permitted value; of `clearance` the least one."""
    margin: float
    """What is left of the limit; negative if it is exceeded."""
    unit: str
    """The unit of value, limit and margin: `mm`, `deg`, `mm/s`, `ms`, `N`, `J`, or `1` for a ratio."""
    passed: bool
    """True if the margin is not negative."""


@dataclass(frozen=True)
class Failure:
    """The first time that a limit was exceeded."""

    check: str
    """The name of the check."""
    time_s: float
    """Time since the start of the simulation, s."""
    load_factor: float
    """The multiple of the operation's wrench that was applied then."""


@dataclass(frozen=True)
class Event:
    """A phase of the simulation that begins, or the first crossing of a limit."""

    time_s: float
    """Time since the start of the simulation, s."""
    text: str
    """What happened."""
    check: Optional[str]
    """The check whose limit was crossed; `None` for anything else."""


@dataclass(frozen=True, eq=False, repr=False)
class ArmTrace:
    """One arm in a trace: n samples, j joints, f fingers, p pads."""

    joints: List[str]
    """Names of the j joints, in the order of the columns."""
    pads: List[str]
    """Names of the p pads; none of a measured gripper."""
    q_rad: Floats
    """Joint angles, rad (m for a prismatic joint): (n, j)."""
    torque_demanded_nm: Floats
    """Joint torques that the position control asks for, N m: (n, j)."""
    torque_applied_nm: Floats
    """Joint torques within the limits, N m: (n, j)."""
    effort_nm: Floats
    """Torque limit of each joint, N m: (j,)."""
    finger_m: Floats
    """Travel of each finger from its closed position, m: (n, f)."""
    p_oc_m: Floats
    """Position of the hand in O, the centre between its pads, m: (n, 3)."""
    rotation_oc_xyzw: Floats
    """Rotation of the hand, axes of G, in O as a unit quaternion, scalar last: (n, 4)."""
    pad_force_n: Floats
    """Force of each pad on the board along the pad's normal, N: (n, p)."""
    pad_wrench_w: Floats
    """Wrench of each pad on the board about the pad's centre, axes of W: force, N, then moment, N m: (n, p, 6)."""
    p_wp_m: Floats
    """Position of each pad's centre in W, m: (n, p, 3)."""
    grip_wrench_g: Floats
    """Wrench of a measured gripper on the board about the grasp point, axes of G: force, N, then moment, N m: (n, 6). NaN once it has
    let go, and for pads."""


@dataclass(frozen=True, eq=False, repr=False)
class Trace:
    """The state after each of n steps; forces are those of the step that ends there. All arrays are of 64-bit floats."""

    time_s: Floats
    """Time since the start of the simulation, s: (n,)."""
    phase: List[str]
    """The phase of each sample: `grip`, `settle`, `ramp`, `hold` or `release`."""
    load_factor: Floats
    """The applied multiple of the operation's wrench: (n,)."""
    tool_wrench_w: Floats
    """The tool's wrench on the board about the tool point, axes of W: force, N, then moment, N m: (n, 6)."""
    p_wo_m: Floats
    """Position of the board's centre in W, m: (n, 3)."""
    rotation_wo_xyzw: Floats
    """Rotation of the board in W as a unit quaternion, scalar last: (n, 4)."""
    p_ot_m: Floats
    """Position of the tool point in O, m: (n, 3)."""
    person_distance_m: Floats
    """Least distance of robot and board from the person, m, negative for an overlap: (n,). NaN without a person."""
    robot_clearance_m: Floats
    """Least distance of the robot from itself and from the board, m, negative for an overlap: (n,). NaN if nothing can meet."""
    arms: Dict[str, ArmTrace]
    """The arms by name, in the plan's order."""
    broke_down: Optional[str]
    """When and why the simulation broke down; the samples end before. `None` if it completed."""


@dataclass(frozen=True, eq=False, repr=False)
class HandMeasures:
    """The motion of a hand on the board since the hand-over: m samples."""

    slip_mm: Floats
    """Translation in O of the point between the pads, mm: (m,)."""
    slip_deg: Floats
    """Rotation on the board, degrees: (m,)."""
    grip_ratio: Floats
    """Ratio of a measured gripper's wrench to its limits: (m,); empty for a hand with pads."""


@dataclass(frozen=True, eq=False, repr=False)
class Measures:
    """The series that the checks are made from: m samples, from the hand-over of the board on."""

    time_s: Floats
    """Time since the start of the simulation, s: (m,)."""
    judged: int
    """The first so many samples are judged; those after them show the release."""
    load_factor: Floats
    """The applied multiple of the operation's wrench: (m,)."""
    sag_mm: Floats
    """Displacement in W of the tool point under the board's weight, mm: (m,)."""
    deflection_mm: Floats
    """Displacement in W of the tool point under the load, mm: (m,)."""
    clearance_mm: Floats
    """Distance of the robot from itself and from the board, mm: (m,); empty if it was not measured."""
    hands: Dict[str, HandMeasures]
    """The hands by arm."""
    torque_ratio: Dict[str, Floats]
    """Of each joint by name the absolute demanded torque over its limit: (m,)."""


@dataclass(frozen=True, eq=False, repr=False)
class Verdict:
    """The verdict on a plan, with every value that decided it."""

    name: str
    """The plan's name."""
    verdict: str
    """`holds`, or what happened first: `slips`, `pivots`, `opens`, `detaches`, `drops`, `saturates`, `deflects`, `sags`, `creeps`,
    `touches`, `collides`; `infeasible` or `no_verdict` where nothing can be said."""
    expected: str
    """The verdict that was expected."""
    met: bool
    """True if the verdict is the expected one."""
    checks: List[Check]
    """One entry a limit; none if nothing was simulated."""
    self_checks: List[Check]
    """Checks of the simulation itself."""
    first_failure: Optional[Failure]
    """The first limit that was exceeded."""
    reason: Optional[str]
    """Why nothing was simulated, or why there is no verdict."""
    notes: List[str]
    """What was filled in, and assumptions that the plan strains."""
    peak_torque_ratio: Dict[str, float]
    """Largest demanded torque over limit, by joint."""
    fingerprint: str
    """SHA-256 of the trace: equal ones mean simulations that are equal bit by bit. Empty if nothing was simulated."""
    events: List[Event]
    """Phases and first crossings of limits, in the order of time."""
    trace: Optional[Trace]
    """The simulation; `None` if nothing was simulated."""
    measures: Optional[Measures]
    """The series behind the checks; `None` if nothing was simulated."""
    recording: Optional[Path]
    """The recording that was written."""
    document: Dict[str, Any] = field(default_factory=dict)
    """The verdict as `verdict.json` has it."""

    @property
    def holds(self) -> bool:
        """True if the verdict is `holds`."""
        return self.verdict == "holds"

    def check(self, name: str) -> Check:
        """The check of this name. `KeyError` if it was not made."""
        for check in self.checks:
            if check.name == name:
                return check
        raise KeyError(name)

    def crossing(self, name: str) -> Optional[Event]:
        """The first crossing of the limit of a check; `None` if it was kept."""
        return next((event for event in self.events if event.check == name), None)

    def __repr__(self) -> str:
        return f"<Verdict {self.name!r}: {self.verdict}, expected {self.expected}>"


def verdict_of(fields: Dict[str, Any]) -> Verdict:
    """A verdict of what the extension module gives."""
    document = fields["verdict"]
    failure = document["first_failure"]
    recording = fields["recording"]
    return Verdict(
        name=document["name"],
        verdict=document["verdict"],
        expected=document["expected"],
        met=document["met"],
        checks=[Check(**check) for check in document["checks"]],
        self_checks=[Check(**check) for check in document.get("self_checks", [])],
        first_failure=None if failure is None else Failure(**failure),
        reason=document.get("reason"),
        notes=document.get("notes", []),
        peak_torque_ratio=document["peak_torque_ratio"],
        fingerprint=document["fingerprint"],
        events=[Event(**event) for event in fields["events"]],
        trace=_trace_of(fields["trace"]),
        measures=_measures_of(fields["measures"]),
        recording=None if recording is None else Path(recording),
        document=document,
    )


def _trace_of(fields: Optional[Dict[str, Any]]) -> Optional[Trace]:
    if fields is None:
        return None
    arms = {name: ArmTrace(**arm) for name, arm in fields["arms"].items()}
    return Trace(**{**fields, "arms": arms})


def _measures_of(fields: Optional[Dict[str, Any]]) -> Optional[Measures]:
    if fields is None:
        return None
    hands = {name: HandMeasures(**hand) for name, hand in fields["hands"].items()}
    return Measures(**{**fields, "hands": hands})
