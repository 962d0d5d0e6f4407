"""Sweeps."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any, Dict, List, Tuple

import numpy as np
import pytest

import benchdog

RUNS = 40


def test_a_sweep_tells_its_progress_and_is_that_of_the_command(plan: Dict[str, Any], tmp_path: Path) -> None:
    calls: List[Tuple[int, int]] = []
    sweep = benchdog.Sweep(plan, runs=RUNS, seed=3)
    result = sweep.run(lambda done, of: calls.append((done, of)))
    done = [done for done, _ in calls]
    assert done == sorted(set(done)) and calls[-1] == (RUNS, RUNS) and len(calls) > 2
    assert 0.0 <= result.low <= result.probability <= result.high <= 1.0
    assert result.met is None and result.confidence == 0.95
    runs = result.runs
    assert runs["run"] == list(range(RUNS))
    assert all(len(column) == RUNS for column in runs.values())
    assert runs["friction_factor"].dtype == np.float64 and np.std(runs["friction_factor"]) > 0.0
    simulated = np.array([decided != "predicted" for decided in runs["decided"]])
    assert np.all(np.isnan(runs["slip_mm"]) != simulated)

    path, out = tmp_path / "plan.json", tmp_path / "out"
    path.write_text(json.dumps(plan))
    command = [sys.executable, "-m", "benchdog", "sweep", str(path), "--runs", str(RUNS), "--seed", "3", "--out", str(out)]
    subprocess.run(command, check=True, capture_output=True)
    assert result.summary == json.loads((out / "sweep.json").read_text())


def test_an_interrupted_sweep_goes_on(plan: Dict[str, Any]) -> None:
    sweep = benchdog.Sweep(plan, runs=RUNS, all=True)

    def interrupt(done: int, of: int) -> None:
        # After the first block of 20 runs.
        if done > 20:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        sweep.run(interrupt)
    calls: List[int] = []
    result = sweep.run(lambda done, of: calls.append(done))
    assert calls[-1] == RUNS and result.runs["run"] == list(range(RUNS))
    whole = benchdog.Sweep(plan, runs=RUNS, all=True).run()
    assert whole.summary == result.summary


def test_a_sweep_ends_once_its_interval_is_narrow_enough(plan: Dict[str, Any]) -> None:
    result = benchdog.Sweep(plan, runs=1000, until=0.5).run()
    # It is looked at after every 100 runs.
    assert len(result.runs["run"]) == 100
    assert result.high - result.low <= 0.5
