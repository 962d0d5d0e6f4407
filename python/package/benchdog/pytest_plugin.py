"""A pytest plugin: tests that plans hold.

The fixture `benchdog` has `assert_holds`; a test with the parameter `benchdog_plan` is run for each plan of `--benchdog-plans FOLDER`.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any, Dict, List, Optional

import pytest

from ._api import Source, simulate
from ._verdict import Check, Verdict




class BenchdogTester:
    """What the fixture `benchdog` gives."""

    def __init__(self, folder: Path, stem: str) -> None:
        self.folder = folder
        """The folder of recordings."""
        self._stem = stem
        self._count = 0

    def assert_holds(
        self,
        plan: Source,
        *,
        friction: Optional[float] = None,
        force_scale: Optional[float] = None,
        scenario: Optional[Source] = None,
    ) -> Verdict:
        """Simulates a plan as `benchdog.simulate` does, and fails the test unless it holds.

        The message has the checks that failed with value, limit and the time at which the limit was first crossed, and the path of the
        recording. Of a plan that holds no recording is written.
        """
        __tracebackhide__ = True
        self._count += 1
        number = "" if self._count == 1 else f"-{self._count}"
        verdict = simulate(
            plan,
            scenario=scenario,
            friction=friction,
            force_scale=force_scale,
            expect="holds",
            recording=self.folder / f"{self._stem}{number}.rrd",
            record="failed",
        )
        if not verdict.holds:
            pytest.fail(failure_text(verdict), pytrace=False)
        return verdict


def failure_text(verdict: Verdict) -> str:
    """Why a plan does not hold: a line for each check that failed, the first one first."""
    lines = [f"{verdict.name}: {verdict.verdict}, expected holds"]
    if verdict.reason is not None:
        lines.append(f"  {verdict.reason}")
    failed = [check for check in verdict.checks if not check.passed]
    crossings = {check.name: verdict.crossing(check.name) for check in failed}

    def time_s(check: Check) -> float:
        crossing = crossings[check.name]
        return float("inf") if crossing is None else crossing.time_s

    for check in sorted(failed, key=time_s):
        unit = "" if check.unit == "1" else f" {check.unit}"
        sign = "at least" if check.name == "clearance" else "at most"
        line = f"  {check.name} {check.value:.3f}{unit}, {sign} {check.limit:.3f}{unit} is allowed"
        crossing = crossings[check.name]
        if crossing is not None:
            line += f"; first crossed at {crossing.time_s:.3f} s: {crossing.text}"
        lines.append(line)
    if verdict.recording is not None:
        lines.append(f"  recording: {verdict.recording}")
    return "\n".join(lines)


def plan_files(folder: Path) -> Dict[str, Path]:
    """The plans of a folder by name: its JSON files, and `plan.json` of its folders, as `benchdog run` writes them."""
    named: Dict[str, Path] = {}
    files = [(path.stem, path) for path in sorted(folder.glob("*.json"))]
    files += [(path.parent.name, path) for path in sorted(folder.glob("*/plan.json"))]
    for name, path in files:
        if name in named:
            raise pytest.Collector.CollectError(f"{path}: found the plan {name} twice, expected one; the other is {named[name]}")
        named[name] = path
    return named


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("benchdog", "plans of robots that hold boards")
    group.addoption("--benchdog-plans", metavar="FOLDER", help="run tests with the parameter benchdog_plan for each plan of this folder")
    group.addoption("--benchdog-out", metavar="FOLDER", help="write recordings of failures here, by default into tmp_path")
    parser.addini("benchdog_plans", "folder of plans, relative to the ini file, if --benchdog-plans is not given", default=None)


def _folder_of_plans(config: pytest.Config) -> Optional[Path]:
    given: Optional[str] = config.getoption("--benchdog-plans")
    if given is not None:
        return config.invocation_params.dir / given
    ini: Any = config.getini("benchdog_plans")
    return config.rootpath / ini if ini else None


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    if "benchdog_plan" not in metafunc.fixturenames:
        return
    folder = _folder_of_plans(metafunc.config)
    if folder is None:
        reason = "no folder of plans: --benchdog-plans FOLDER, or benchdog_plans in the ini file"
        parameters: List[Any] = [pytest.param(None, id="no-plans", marks=pytest.mark.skip(reason=reason))]
    else:
        plans = plan_files(folder)
        if not plans:
            raise pytest.Collector.CollectError(f"{folder}: found no plan, expected *.json or */plan.json")
        parameters = [pytest.param(path, id=name) for name, path in plans.items()]
    metafunc.parametrize("benchdog_plan", parameters)


@pytest.fixture
def benchdog(request: pytest.FixtureRequest) -> BenchdogTester:
    """Asserts that plans hold; recordings of failures go into `tmp_path`, or the folder of `--benchdog-out`."""
    given: Optional[str] = request.config.getoption("--benchdog-out")
    out: Path = request.getfixturevalue("tmp_path") if given is None else request.config.invocation_params.dir / given
    return BenchdogTester(out, re.sub(r"[^A-Za-z0-9_.-]+", "-", request.node.nodeid).strip("-"))
