"""Sweeps: how likely a plan holds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Callable, Dict, Optional

from . import _native
from ._api import Source


@dataclass(frozen=True, eq=False, repr=False)
class SweepResult:
    """What came of a sweep."""

    probability: float
    """The estimated probability of the expected verdict."""
    low: float
    """The lower end of its interval."""
    high: float
    """The upper end of its interval."""
    confidence: float
    """The confidence of the interval."""
    met: Optional[bool]
    """Whether the expected probability is shown; `None` if the scenario expects none."""
    runs: Dict[str, Any]
    """The columns of `runs.csv` by name, r entries each: `run`, `verdict`, `decided` (`simulated`, `audited`, `predicted`) and
    `first_check` as lists; `predicted_load_factor`, `predicted_deflection_mm`, `slip_mm`, `slip_deg`, `deflection_mm`,
    `torque_ratio`, `failed_at` and the drawn values, such as `friction`, as arrays of shape (r,), NaN where a run has none."""
    summary: Dict[str, Any]
    """The contents of `sweep.json`: failure modes, quantiles, importance of each quantity, the worst runs."""

    def __repr__(self) -> str:
        return f"<SweepResult {self.probability:.4f} ({self.low:.4f} to {self.high:.4f}), {len(self.runs['run'])} runs>"


class Sweep:
    """Many runs of a plan under the deviations of its scenario's `[sweep]`, by default those of the preset `workshop`.

    plan, scenario: as in `simulate`.
    runs, seed: in place of the scenario's.
    until: the width of the interval at which the sweep ends before all runs are done.
    all: True if also runs are simulated that the statics would decide.
    audit: the share of these that is simulated as a check; 0.1 by default.

    The runs use all cores. They and their results are those of `benchdog sweep` with the same arguments.
    """

    def __init__(
        self,
        plan: Source,
        *,
        scenario: Optional[Source] = None,
        runs: Optional[int] = None,
        seed: Optional[int] = None,
        until: Optional[float] = None,
        all: bool = False,
        audit: Optional[float] = None,
    ) -> None:
        options: _native.SweepOptions = {"runs": runs, "seed": seed, "until": until, "all": all, "audit": audit}
        self._native = _native.Sweep(plan, scenario, options)

    @property
    def runs(self) -> int:
        """The number of runs."""
        return self._native.runs

    def run(self, progress: Optional[Callable[[int, int], object]] = None) -> SweepResult:
        """Does the runs. `progress` is called now and then, from the calling thread, with the number of finished runs and that of all.

        Runs that were finished before an interruption stay: another call goes on from them.
        """
        fields = self._native.run(progress)
        summary = fields["summary"]
        estimate = summary["estimate"]
        return SweepResult(
            probability=estimate["probability"],
            low=estimate["low"],
            high=estimate["high"],
            confidence=estimate["confidence"],
            met=summary.get("met"),
            runs=fields["runs"],
            summary=summary,
        )
