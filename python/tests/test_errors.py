"""Errors of inputs: file, line, key, what was found and what was expected."""

from __future__ import annotations

import json
import pickle
from pathlib import Path
from typing import Any, Callable, Dict, Optional

import pytest

import benchdog
from conftest import QUICKSTART, SCENARIOS


def scenario(change: Callable[[Dict[str, Any]], object]) -> Dict[str, Any]:
    """The quickstart as a dict, changed."""
    changed: Dict[str, Any] = {
        "format": 1,
        "name": "quickstart",
        "operation": {"kind": "drill", "point_m": [0.0, 0.0], "force_n": 15.0},
    }
    change(changed)
    return changed


TEXTS = {
    "a negative force": ("force_n = 15.0", "force_n = -1.0", 7, "operation.force_n", "-1", "a positive number (N)"),
    "another format": ("format = 1", "format = 9", 1, "format", "9", "1, the only format"),
    "a name with a slash": ('"quickstart"', '"a/b"', 2, "name", '"a/b"', "letters, digits"),
    "a hole beside the board": ("[0.0, 0.0]", "[9.0, 0.0]", 6, "operation.point_m", "9", "board"),
    "an unknown key": ("force_n = 15.0", "force_n = 15.0\nforce = 1", 8, "operation.force", None, None),
    "a wrong type": ("force_n = 15.0", 'force_n = "much"', 7, "operation.force_n", None, None),
    "no TOML": ("[operation]", "[operation", 4, None, None, None),
}


@pytest.mark.parametrize("name", TEXTS)
def test_an_error_of_a_text_names_line_and_key(name: str, tmp_path: Path) -> None:
    before, after, line, key, found, expected = TEXTS[name]
    text = QUICKSTART.replace(before, after)
    assert text != QUICKSTART
    path = tmp_path / "bad.toml"
    path.write_text(text)
    for given, file in ((text, "<text>"), (path, str(path))):
        with pytest.raises(benchdog.Error) as caught:
            benchdog.plan(given)
        error = caught.value
        assert (error.file, error.line, error.key) == (file, line, key)
        assert str(error) == f"{file}:{line}: " + (f"{key}: " if key else "") + error.message
        for value, part in ((error.found, found), (error.expected, expected)):
            assert value is None if part is None else value is not None and part in value


def check(
    call: Callable[[], object], *, file: Optional[str], line: Optional[int], key: Optional[str], found: Optional[str]
) -> benchdog.Error:
    """The error of a call with these attributes."""
    with pytest.raises(benchdog.Error) as caught:
        call()
    error = caught.value
    assert isinstance(error, ValueError)
    assert (error.file, error.line, error.key, error.found) == (file, line, key, found)
    return error


def test_an_error_of_a_dict_names_the_key() -> None:
    bad = scenario(lambda changed: changed["operation"].update(force_n=-1.0))
    check(lambda: benchdog.plan(bad), file="<dict>", line=None, key="operation.force_n", found="-1")
    strange = scenario(lambda changed: changed.update(grip={"friction": object()}))
    error = check(lambda: benchdog.plan(strange), file="<dict>", line=None, key="grip.friction", found=None)
    assert "object" in error.message


def test_a_file_that_is_not_there_is_an_error(tmp_path: Path) -> None:
    path = tmp_path / "none.toml"
    error = check(lambda: benchdog.plan(path), file=str(path), line=None, key=None, found=None)
    assert "failed to read the file" in error.message
    check(lambda: benchdog.simulate(path), file=str(path), line=None, key=None, found=None)


def test_arguments_are_checked(plan: Dict[str, Any]) -> None:
    check(lambda: benchdog.plan(QUICKSTART, budget="large"), file=None, line=None, key="budget", found='"large"')
    check(lambda: benchdog.plan(QUICKSTART, kind="best"), file=None, line=None, key="kind", found='"best"')
    check(lambda: benchdog.plan(QUICKSTART, evaluations=0), file="<text>", line=None, key="planner.evaluations", found="0")
    check(lambda: benchdog.simulate(plan, friction=-1), file="<dict>", line=None, key="grip.friction", found="-1")
    check(lambda: benchdog.simulate(plan, record="never"), file=None, line=None, key="record", found='"never"')
    check(lambda: benchdog.Sweep(plan, runs=0), file=None, line=None, key="runs", found="0")
    check(lambda: benchdog.Sweep(plan, audit=2.0), file=None, line=None, key="audit", found="2")


def test_an_error_of_a_plan_names_line_and_key(plan: Dict[str, Any], tmp_path: Path) -> None:
    bad = json.loads(json.dumps(plan))
    bad["arms"][0]["q_rad"][3] += 0.5
    path = tmp_path / "bad.json"
    path.write_text(json.dumps(bad, indent=1))
    with pytest.raises(benchdog.Error) as caught:
        benchdog.simulate(path)
    error = caught.value
    assert error.file == str(path) and error.key is not None and error.key.startswith("arms[0]")
    assert error.line is not None and 1 < error.line <= len(path.read_text().splitlines())
    check(lambda: benchdog.simulate(bad), file="<dict>", line=None, key=error.key, found=error.found)


def test_a_request_names_its_key_and_changes_nothing() -> None:
    planner = benchdog.Planner(QUICKSTART)
    first = planner.replan()
    far = {"kind": "drill", "point_m": [9.0, 0.0], "force_n": 15.0}
    with pytest.raises(benchdog.Error) as caught:
        planner.replan(operation=far)
    assert caught.value.key == "operation.point_m" and caught.value.line is None
    check(lambda: planner.replan(human={"x_m": 1.0}), file="<dict>", line=None, key="human.y_m", found="nothing")
    # The force stays, the hole stays; only the drill may be turned about its axis.
    after, before = (answer.plan["operation"] for answer in (planner.replan(), first))
    assert after["wrench_o"] == before["wrench_o"]
    assert after["x_ot"]["translation_m"] == before["x_ot"]["translation_m"]


def test_a_task_is_refused_by_name() -> None:
    with pytest.raises(benchdog.Error) as caught:
        benchdog.plan(SCENARIOS / "whole-circle.toml")
    assert "benchdog task" in str(caught.value)


def test_an_error_can_be_pickled() -> None:
    with pytest.raises(benchdog.Error) as caught:
        benchdog.plan(QUICKSTART.replace("15.0", "-1.0"))
    copy = pickle.loads(pickle.dumps(caught.value))
    assert (str(copy), copy.line, copy.key) == (str(caught.value), 7, "operation.force_n")
