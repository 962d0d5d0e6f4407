"""The pytest plugin, run by pytest."""

from __future__ import annotations

import json
import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any, Dict

import pytest

TEST = """
def test_holds(benchdog, benchdog_plan):
    assert benchdog.assert_holds(benchdog_plan).holds

def test_holds_when_oily(benchdog, benchdog_plan):
    benchdog.assert_holds(benchdog_plan, friction=0.05)
"""


@pytest.fixture
def folder(pytester: pytest.Pytester, plan: Dict[str, Any]) -> Path:
    """A folder with a test, and a folder of plans: a file, and one as `benchdog run` writes it."""
    pytester.makepyfile(TEST)
    plans = pytester.mkdir("plans")
    (plans / "shelf.json").write_text(json.dumps(plan))
    (plans / "table").mkdir()
    (plans / "table" / "plan.json").write_text(json.dumps(plan))
    (plans / "table" / "verdict.json").write_text("{}")
    return pytester.path


def test_a_test_runs_for_each_plan_and_fails_with_check_time_and_recording(
    pytester: pytest.Pytester, folder: Path
) -> None:
    result = pytester.runpytest_subprocess("--benchdog-plans", "plans", "-v", "--junitxml", "junit.xml")
    result.assert_outcomes(passed=2, failed=2)
    result.stdout.fnmatch_lines(["*test_holds?shelf? PASSED*", "*test_holds?table? PASSED*", "*oily?shelf? FAILED*"])
    message = "\n".join(result.outlines)
    failure = re.search(
        r"quickstart: (\w+), expected holds\n"
        r"  (\w+) ([\d.]+)[ a-z/]*, at most ([\d.]+)[ a-z/]* is allowed; first crossed at ([\d.]+) s: .* at load factor [\d.]+\n"
        r"(?:  \w+ .*\n)*"
        r"  recording: (.*\.rrd)",
        message,
    )
    assert failure is not None, message
    value, limit, time_s = (float(failure[group]) for group in (3, 4, 5))
    assert value > limit > 0.0 and time_s > 0.0
    recording = Path(failure[6])
    assert recording.read_bytes()[:4] == b"RRF2"
    # In the folder of the test, and of the failing ones alone.
    assert recording.parent.name.startswith("test_holds_when_oily")
    assert len(list(recording.parent.parent.rglob("*.rrd"))) == 2
    cases = ElementTree.parse(folder / "junit.xml").getroot().iter("testcase")
    failures = {case.get("name"): case.find("failure") for case in cases}
    assert set(failures) == {f"test_holds{oily}[{name}]" for oily in ("", "_when_oily") for name in ("shelf", "table")}
    of_shelf = failures["test_holds_when_oily[shelf]"]
    assert of_shelf is not None and "first crossed at" in (of_shelf.text or "")
    assert failures["test_holds[shelf]"] is None


def test_two_plans_of_one_name_are_refused(pytester: pytest.Pytester, folder: Path, plan: Dict[str, Any]) -> None:
    (folder / "plans" / "table.json").write_text(json.dumps(plan))
    result = pytester.runpytest_subprocess("--benchdog-plans", "plans")
    result.assert_outcomes(errors=1)
    result.stdout.fnmatch_lines(["*table*plan.json: found the plan table twice, expected one; the other is *table.json"])
    assert "Traceback" not in result.stdout.str() and "pytest_plugin.py" not in result.stdout.str()


def test_recordings_go_into_the_folder_that_is_asked_for(pytester: pytest.Pytester, folder: Path) -> None:
    arguments = ["--benchdog-plans", "plans", "--benchdog-out", "recordings", "-k", "oily and shelf"]
    pytester.runpytest_subprocess(*arguments).assert_outcomes(failed=1, deselected=3)
    (recording,) = (folder / "recordings").iterdir()
    assert recording.suffix == ".rrd" and "oily" in recording.name


def test_the_folder_may_stand_in_the_ini_file(pytester: pytest.Pytester, folder: Path) -> None:
    pytester.makeini("[pytest]\nbenchdog_plans = plans\n")
    pytester.runpytest_subprocess("-k", "not oily").assert_outcomes(passed=2, deselected=2)


def test_without_a_folder_the_test_is_skipped_and_says_why(pytester: pytest.Pytester, folder: Path) -> None:
    result = pytester.runpytest_subprocess("-rs")
    result.assert_outcomes(skipped=2)
    result.stdout.fnmatch_lines(["*no folder of plans: --benchdog-plans FOLDER*"])


def test_a_folder_without_plans_is_an_error(pytester: pytest.Pytester, folder: Path) -> None:
    pytester.mkdir("empty")
    result = pytester.runpytest_subprocess("--benchdog-plans", "empty")
    assert result.ret != 0
    assert "found no plan" in "\n".join(result.outlines + result.errlines)


def test_a_plan_that_is_wrong_is_an_error_with_its_key(pytester: pytest.Pytester) -> None:
    pytester.makepyfile("def test_it(benchdog):\n    benchdog.assert_holds({'format': 1})\n")
    result = pytester.runpytest_subprocess()
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["*benchdog._errors.Error: <dict>: *"])
