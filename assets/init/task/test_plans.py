"""Every plan under plans/ holds in simulation, from its first stage to its last. `pytest.ini` names the folder."""

import subprocess
import sys


def test_plan_holds(benchdog_plan, tmp_path):
    # A plan in stages is judged by the command.
    command = [sys.executable, "-m", "benchdog", "simulate", str(benchdog_plan), "--record", "failed", "--out", str(tmp_path)]
    judged = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    assert judged.returncode == 0, judged.stdout
