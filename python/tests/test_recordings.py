"""Recordings and MCAP files as people's own tools read them."""

from __future__ import annotations

import re
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest

from conftest import SCENARIOS

SCRIPT = Path(sysconfig.get_path("scripts")) / "benchdog"

GUIDE = SCENARIOS.parent / "docs" / "recordings.md"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a hold that slips, with its recording and its MCAP file."""
    out = tmp_path_factory.mktemp("run")
    scenario = str(SCENARIOS / "fails-slippery-pads.toml")
    done = subprocess.run([str(SCRIPT), "run", scenario, "--mcap", "--out", str(out)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return out / "fails-slippery-pads"


def example(word: str) -> str:
    """The example of the guide that has this word."""
    blocks = re.findall(r"```python\n(.*?)```", GUIDE.read_text(encoding="utf-8"), re.DOTALL)
    (found,) = [block for block in blocks if word in block]
    return str(found)


def run(code: str, folder: Path) -> "list[str]":
    """What an example prints in the folder of a run."""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=folder, timeout=300)
    assert done.returncode == 0, done.stderr
    return done.stdout.split()


def test_the_example_of_the_guide_reads_the_trace_of_a_recording(folder: Path) -> None:
    pytest.importorskip("rerun")
    code = example("rr.server")
    assert len(code.splitlines()) <= 10
    last_s, force_n = map(float, run(code, folder)[-2:])
    # The hold ends when the board has slipped out of the hands; the knife pushes with 30 N at most.
    assert 1.0 < last_s < 3.0
    assert 10.0 < force_n <= 30.0 + 1e-6


def test_the_example_of_the_guide_reads_an_mcap_file(folder: Path) -> None:
    pytest.importorskip("mcap_ros2")
    words = run(example("mcap_ros2"), folder)
    time_s, slip_mm = map(float, words[-2:])
    # The first crossing of the limit of 1 mm.
    assert 0.5 < time_s < 2.0
    assert 1.0 < slip_mm < 1.5


def test_every_message_of_an_mcap_file_is_decoded(folder: Path) -> None:
    reader = pytest.importorskip("mcap.reader")
    decoder = pytest.importorskip("mcap_ros2.decoder")
    kinds = {}
    with open(folder / "trace.mcap", "rb") as file:
        messages = reader.make_reader(file, decoder_factories=[decoder.DecoderFactory()]).iter_decoded_messages()
        for schema, channel, message, decoded in messages:
            kinds[channel.topic] = schema.name
            stamp = getattr(getattr(decoded, "header", None), "stamp", None)
            if stamp is not None:
                assert stamp.sec * 10**9 + stamp.nanosec == message.log_time
            if channel.topic == "/joint_states":
                assert len(decoded.name) == len(decoded.position) == len(decoded.effort) == 14
            if channel.topic == "/board/pose":
                q = decoded.pose.orientation
                assert q.x**2 + q.y**2 + q.z**2 + q.w**2 == pytest.approx(1.0, abs=1e-9)
            if channel.topic == "/tf":
                assert {"board", "left_gripper_base"} & {transform.child_frame_id for transform in decoded.transforms}
    assert kinds["/hands/left/wrench"] == "geometry_msgs/msg/WrenchStamped"
    assert kinds["/rosout"] == "rcl_interfaces/msg/Log"
