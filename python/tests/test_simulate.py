"""Verdicts and traces."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Dict

import numpy as np
import pytest

import benchdog
from conftest import SCENARIOS

PLANS = SCENARIOS / "plans"


def test_a_verdict_has_value_limit_and_margin_of_every_check(plan: Dict[str, Any]) -> None:
    verdict = benchdog.simulate(plan)
    assert verdict.holds and verdict.met and verdict.verdict == "holds"
    assert {check.name for check in verdict.checks} >= {"slip", "deflection", "torque_ratio", "clearance"}
    for check in verdict.checks:
        sign = -1.0 if check.name == "clearance" else 1.0
        assert check.margin == pytest.approx(sign * (check.limit - check.value), abs=1e-12)
        assert check.passed
    assert verdict.check("slip").unit == "mm"
    with pytest.raises(KeyError):
        verdict.check("colour")
    assert verdict.document["verdict"] == "holds"


def test_the_trace_has_the_documented_shapes(plan: Dict[str, Any]) -> None:
    trace = benchdog.simulate(plan).trace
    assert trace is not None
    n = len(trace.time_s)
    assert n > 1000 and len(trace.phase) == n
    assert np.all(np.diff(trace.time_s) > 0.0)
    shapes = {
        "load_factor": (n,),
        "tool_wrench_w": (n, 6),
        "p_wo_m": (n, 3),
        "rotation_wo_xyzw": (n, 4),
        "p_ot_m": (n, 3),
        "person_distance_m": (n,),
        "robot_clearance_m": (n,),
    }
    assert {name: getattr(trace, name).shape for name in shapes} == shapes
    assert list(trace.arms) == [arm["name"] for arm in plan["arms"]]
    for arm in trace.arms.values():
        j, p = len(arm.joints), len(arm.pads)
        assert (j, p) == (7, 2)
        shapes = {
            "q_rad": (n, j),
            "torque_demanded_nm": (n, j),
            "torque_applied_nm": (n, j),
            "effort_nm": (j,),
            "finger_m": (n, 2),
            "p_oc_m": (n, 3),
            "rotation_oc_xyzw": (n, 4),
            "pad_force_n": (n, p),
            "pad_wrench_w": (n, p, 6),
            "p_wp_m": (n, p, 3),
            "grip_wrench_g": (n, 6),
        }
        assert {name: getattr(arm, name).shape for name in shapes} == shapes
        assert all(getattr(arm, name).dtype == np.float64 for name in shapes)
        assert np.all(np.isnan(arm.grip_wrench_g))


def test_the_trace_obeys_mechanics(plan: Dict[str, Any]) -> None:
    verdict = benchdog.simulate(plan)
    trace = verdict.trace
    assert trace is not None
    # Unit quaternions.
    assert np.allclose(np.linalg.norm(trace.rotation_wo_xyzw, axis=1), 1.0)
    # The drill pushes with 15 N at the full load, on a board that a person stands before.
    held = np.array(trace.phase) == "hold"
    force_n = np.linalg.norm(trace.tool_wrench_w[held, :3], axis=1)
    assert np.allclose(force_n, 15.0, rtol=1e-6)
    # At the end of the hold pads, tool and weight balance: 0.05 N is the limit of the simulation's own check.
    last = np.flatnonzero(held)[-1]
    pads_w = sum(arm.pad_wrench_w[last, :, :3].sum(axis=0) for arm in trace.arms.values())
    weight_n = 9.81 * plan["object"]["mass_kg"]
    rest_n = pads_w + trace.tool_wrench_w[last, :3] - np.array([0.0, 0.0, weight_n])
    assert np.linalg.norm(rest_n) < 0.05
    # The measured series end in the check's value.
    measures = verdict.measures
    assert measures is not None
    slip_mm = max(hand.slip_mm[: measures.judged].max() for hand in measures.hands.values())
    assert slip_mm == pytest.approx(verdict.check("slip").value)


def test_little_friction_slips_and_says_when(plan: Dict[str, Any]) -> None:
    verdict = benchdog.simulate(plan, friction=0.05)
    assert not verdict.holds and not verdict.met
    assert verdict.first_failure is not None
    crossing = verdict.crossing(verdict.first_failure.check)
    assert crossing is not None and crossing.time_s == verdict.first_failure.time_s
    assert not verdict.check(verdict.first_failure.check).passed
    # It is the expected verdict if it is expected.
    assert benchdog.simulate(plan, friction=0.05, expect=verdict.verdict).met


def test_a_larger_force_is_a_larger_load(plan: Dict[str, Any]) -> None:
    usual, larger = (benchdog.simulate(plan, force_scale=scale) for scale in (1.0, 1.2))
    assert larger.check("deflection").value > 1.1 * usual.check("deflection").value


def test_a_plan_from_elsewhere_is_judged() -> None:
    verdict = benchdog.simulate(PLANS / "cut-rim-weak-grip.json")
    assert verdict.verdict == "slips" and verdict.trace is not None


def test_a_plan_whose_person_sees_nothing_is_not_simulated(tmp_path: Path) -> None:
    verdict = benchdog.simulate(PLANS / "looks-down.json", recording=tmp_path / "run.rrd")
    assert verdict.verdict == "infeasible" and verdict.reason
    assert verdict.trace is None and verdict.checks == []
    assert verdict.recording is None and not (tmp_path / "run.rrd").exists()


def test_a_recording_is_written_where_it_is_wanted(plan: Dict[str, Any], tmp_path: Path) -> None:
    path = tmp_path / "new" / "run.rrd"
    assert benchdog.simulate(plan, recording=path, record="failed").recording is None
    assert not path.exists()
    verdict = benchdog.simulate(plan, recording=path)
    assert verdict.recording == path
    assert path.read_bytes()[:4] == b"RRF2"


def test_an_input_is_not_overwritten(tmp_path: Path) -> None:
    path = tmp_path / "plan.json"
    path.write_bytes((PLANS / "cut-rim.json").read_bytes())
    with pytest.raises(benchdog.Error) as caught:
        benchdog.simulate(path, recording=path)
    assert caught.value.key == "recording"
    assert path.read_bytes() == (PLANS / "cut-rim.json").read_bytes()
