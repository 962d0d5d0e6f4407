"""The console script."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import sysconfig
import time
from pathlib import Path
from typing import Any, Dict, List

import benchdog
from conftest import QUICKSTART, SCENARIOS

SCRIPT = Path(sysconfig.get_path("scripts")) / "benchdog"


def run(arguments: List[str]) -> "subprocess.CompletedProcess[str]":
    return subprocess.run([str(SCRIPT), *arguments], capture_output=True, text=True, timeout=120)


def test_the_version_is_that_of_the_package() -> None:
    done = run(["--version"])
    assert done.returncode == 0
    assert done.stdout.splitlines()[0] == f"benchdog {benchdog.__version__}"
    # No newline is behind it when a usage error ends the process.
    assert run(["plan", "--nonsense"]).returncode == 2


def test_a_bad_input_ends_with_exit_code_2(tmp_path: Path) -> None:
    path = tmp_path / "bad.toml"
    path.write_text(QUICKSTART.replace("15.0", "-1.0"))
    done = run(["plan", str(path)])
    assert done.returncode == 2
    assert done.stderr == f"error: {path}:7: operation.force_n: found -1, expected a positive number (N)\n"


def test_a_plan_of_the_command_is_that_of_the_function(plan: Dict[str, Any], tmp_path: Path) -> None:
    path = tmp_path / "plan.json"
    assert run(["plan", str(SCENARIOS / "quickstart.toml"), "-o", str(path)]).returncode == 0
    written = json.loads(path.read_text())
    for duration in ("wall_ms", "map_ms"):
        assert written["planner"].pop(duration) >= 0.0
    assert written == plan


def test_it_runs_as_a_module_too() -> None:
    done = subprocess.run([sys.executable, "-m", "benchdog", "--version"], capture_output=True, text=True)
    assert done.returncode == 0 and done.stdout.startswith("benchdog ")


def test_ctrl_c_ends_it_with_exit_code_130() -> None:
    arguments = [str(SCRIPT), "plan", "--no-cache", str(SCENARIOS / "quickstart.toml")]
    process = subprocess.Popen(arguments, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    time.sleep(1.0)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=10)
    assert process.returncode == 130
    assert "interrupted after" in errors
