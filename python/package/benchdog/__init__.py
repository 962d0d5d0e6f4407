"""Plans how a two-armed robot holds a board that a person drills or cuts, and verifies the plan in simulation.

`plan` plans a scenario, `simulate` gives the verdict on a plan, `Planner` keeps its maps and replans, `Sweep` says how likely a plan
holds. Frames: W is the world, O the board, G a gripper, T the tool; `x_wo` is the pose of O in W, `p_wo_m` its position in metres.
A name ends in its unit, and in the frame of its axes.

Every call releases the GIL while it computes, and Ctrl-C raises `KeyboardInterrupt`.
"""

from ._api import Motion, Planner, Replanned, plan, simulate
from ._errors import Error, Infeasible
from ._native import __version__
from ._sweep import Sweep, SweepResult
from ._verdict import ArmTrace, Check, Event, Failure, HandMeasures, Measures, Trace, Verdict

__all__ = [
    "ArmTrace",
    "Check",
    "Error",
    "Event",
    "Failure",
    "HandMeasures",
    "Infeasible",
    "Measures",
    "Motion",
    "Planner",
    "Replanned",
    "Sweep",
    "SweepResult",
    "Trace",
    "Verdict",
    "__version__",
    "plan",
    "simulate",
]
