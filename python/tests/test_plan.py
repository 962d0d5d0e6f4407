"""Plans of scenarios."""

from __future__ import annotations

import json
import math
import time
from pathlib import Path
from typing import Any, Dict, List, Tuple

import pytest

import benchdog
from conftest import QUICKSTART, SCENARIOS


def test_a_path_a_text_and_a_dict_give_the_same_plan(plan: Dict[str, Any]) -> None:
    operation = {"kind": "drill", "point_m": [0.0, 0.0], "force_n": 15}
    as_dict = {"format": 1, "name": "quickstart", "operation": operation, "robot": None}
    assert benchdog.plan(str(SCENARIOS / "quickstart.toml")) == plan
    assert benchdog.plan(QUICKSTART) == plan
    assert benchdog.plan(as_dict) == plan


def test_a_plan_can_be_written_and_read(plan: Dict[str, Any], tmp_path: Path) -> None:
    path = tmp_path / "plan.json"
    path.write_text(json.dumps(plan))
    verdicts = [benchdog.simulate(form) for form in (plan, path, str(path), path.read_text())]
    assert {verdict.fingerprint for verdict in verdicts} == {verdicts[0].fingerprint}
    assert len(verdicts[0].fingerprint) == 64


def test_options_are_those_of_the_scenario() -> None:
    by_argument = benchdog.plan(QUICKSTART, seed=7, kind="muscular", budget="fast")
    by_file = benchdog.plan(QUICKSTART + '[planner]\nseed = 7\nkind = "muscular"\nbudget = "fast"\n')
    assert by_argument == by_file
    assert by_argument["planner"]["seed"] == 7


def test_progress_tells_what_is_done() -> None:
    parts: List[Tuple[str, int, int]] = []
    # Without kept maps there is enough to do.
    benchdog.plan(QUICKSTART, cache=False, progress=lambda *part: parts.append(part))
    assert any(doing.startswith("making the warm starts") for doing, _, _ in parts)
    assert all(0 <= done <= max(total, done) for _, done, total in parts)


def test_an_exception_of_progress_ends_the_search() -> None:
    def refuse(doing: str, done: int, total: int) -> None:
        raise RuntimeError(doing)

    with pytest.raises(RuntimeError):
        benchdog.plan(QUICKSTART, cache=False, progress=refuse)


def test_a_scenario_without_a_plan_is_infeasible_and_says_why() -> None:
    with pytest.raises(benchdog.Infeasible) as caught:
        benchdog.plan(SCENARIOS / "fails-out-of-reach.toml")
    assert "no grasp of this board was found" in caught.value.reason
    assert str(caught.value) == caught.value.reason
    assert not isinstance(caught.value, benchdog.Error)


def test_a_planner_plans_other_scenarios_of_its_robot(plan: Dict[str, Any]) -> None:
    planner = benchdog.Planner(QUICKSTART)
    assert planner.plan() == plan
    further = planner.plan(QUICKSTART.replace("[0.0, 0.0]", "[0.04, 0.0]"))
    assert further["operation"] != plan["operation"]
    with pytest.raises(benchdog.Error) as caught:
        planner.plan(SCENARIOS / "dual-ur5.toml")
    assert caught.value.key == "robot"


def moving_person(plan: Dict[str, Any], step: int) -> Dict[str, float]:
    """The person of a plan, a millimetre to the side at each step."""
    x_wb = plan["human"]["x_wb"]
    x_m, y_m, _ = x_wb["translation_m"]
    _, _, z, w = x_wb["rotation_xyzw"]
    return {"x_m": x_m, "y_m": y_m + 0.001 * step, "heading_deg": math.degrees(2.0 * math.atan2(z, w))}


def test_a_hundred_replans_follow_a_moving_person() -> None:
    planner = benchdog.Planner(QUICKSTART)
    planner.prepare()
    first = planner.replan()
    assert first.motion is None and not first.searched
    start = time.perf_counter()
    answers = [planner.replan(human=moving_person(first.plan, step)) for step in range(100)]
    # A figure for `pytest -s`: how long it takes depends on what else the machine does.
    print(f"100 replans: {time.perf_counter() - start:.2f} s")
    for step, answer in enumerate(answers):
        wanted = moving_person(first.plan, step)
        x_m, y_m, _ = answer.plan["human"]["x_wb"]["translation_m"]
        # Within the tolerance of the place.
        assert max(abs(x_m - wanted["x_m"]), abs(y_m - wanted["y_m"])) <= 0.05
        assert answer.motion is not None and not answer.searched


def test_grasps_can_be_kept_and_motions_limited() -> None:
    planner = benchdog.Planner(QUICKSTART)
    first = planner.replan()
    operation = {"kind": "drill", "point_m": [0.02, 0.0], "force_n": 15.0}
    kept = planner.replan(operation=operation, keep_grasps=True, most_motion_deg=20.0)
    assert kept.motion is not None
    assert not kept.motion.regrasps
    assert kept.motion.largest_joint_deg <= 20.0 + 1e-9
    assert kept.plan["operation"] != first.plan["operation"]


def test_a_planner_resumes_a_plan_that_keeps_its_limits(plan: Dict[str, Any]) -> None:
    planner = benchdog.Planner(QUICKSTART)
    assert planner.resume(plan)
    assert planner.replan().motion is not None
    strict = benchdog.Planner(QUICKSTART + "[limits]\nload_factor = 40.0\n")
    assert not strict.resume(plan)
