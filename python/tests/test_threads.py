"""The GIL is free while a call computes, and Ctrl-C ends it."""

from __future__ import annotations

import _thread
import threading
import time
from typing import Any, Callable, Dict

import pytest

import benchdog
from conftest import QUICKSTART


def slow_plan() -> Dict[str, Any]:
    """A plan that takes seconds: no maps are kept."""
    return benchdog.plan(QUICKSTART, cache=False)


def slow_sweep(plan: Dict[str, Any]) -> Callable[[], object]:
    """A sweep that takes minutes."""
    return benchdog.Sweep(plan, runs=5000, all=True).run


def test_another_thread_goes_on_meanwhile() -> None:
    ended = threading.Event()
    gaps_s = []

    def tick() -> None:
        last = time.perf_counter()
        while not ended.wait(0.001):
            now = time.perf_counter()
            gaps_s.append(now - last)
            last = now

    ticking = threading.Thread(target=tick)
    ticking.start()
    start = time.perf_counter()
    slow_plan()
    duration_s = time.perf_counter() - start
    ended.set()
    ticking.join()
    # With the GIL held there would be one gap as long as the plan. A plan takes all cores, so a thread may wait for one.
    assert duration_s > 1.0
    assert len(gaps_s) > 20 * duration_s
    assert max(gaps_s) < 0.5 * duration_s


def test_two_threads_plan_at_once_and_alike() -> None:
    plans: Dict[int, Dict[str, Any]] = {}
    planner = benchdog.Planner(QUICKSTART)
    threads = [threading.Thread(target=lambda number=number: plans.update({number: planner.plan()})) for number in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(plans) == 4 and all(plan == plans[0] for plan in plans.values())


@pytest.fixture(scope="module")
def slow_plan_s() -> float:
    """How long a slow plan takes on this machine, s."""
    start = time.perf_counter()
    slow_plan()
    return time.perf_counter() - start


@pytest.mark.parametrize("which", ["plan", "sweep"])
def test_ctrl_c_raises_before_the_end(which: str, plan: Dict[str, Any], slow_plan_s: float) -> None:
    call = slow_plan if which == "plan" else slow_sweep(plan)
    interrupted_s = []

    def interrupt() -> None:
        interrupted_s.append(time.perf_counter())
        _thread.interrupt_main()

    timer = threading.Timer(0.5, interrupt)
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        call()
    waited_s = time.perf_counter() - interrupted_s[0]
    timer.join()
    # Alone on a machine it is a tenth of a second; the sweep would take minutes.
    assert waited_s < 0.5 * slow_plan_s
    # Nothing of it is left over.
    assert benchdog.plan(QUICKSTART)["name"] == "quickstart"
