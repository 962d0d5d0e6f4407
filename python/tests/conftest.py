"""What the tests share: the scenarios of the repository, and a plan that holds."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Dict

import pytest

import benchdog as package

pytest_plugins = ["pytester"]

SCENARIOS = Path(__file__).resolve().parents[2] / "scenarios"

QUICKSTART = """\
format = 1
name = "quickstart"

[operation]
kind = "drill"
point_m = [0.0, 0.0]
force_n = 15.0
"""


@pytest.fixture(scope="session")
def plan() -> Dict[str, Any]:
    """The plan of the quickstart."""
    return package.plan(SCENARIOS / "quickstart.toml")
