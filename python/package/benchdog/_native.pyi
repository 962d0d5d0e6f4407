"""The extension module. The package around it has the classes and functions to use."""

import os
from typing import Any, Callable, Dict, List, Optional, TypedDict

__version__: str

class SearchOptions(TypedDict):
    seed: Optional[int]
    kind: Optional[str]
    budget: Optional[str]
    evaluations: Optional[int]

class SimulateOptions(TypedDict):
    friction: Optional[float]
    force_scale: Optional[float]
    expect: Optional[str]
    recording: Optional[os.PathLike[str] | str]
    record: str

class SweepOptions(TypedDict):
    runs: Optional[int]
    seed: Optional[int]
    until: Optional[float]
    all: bool
    audit: Optional[float]

def command(arguments: List[str]) -> int: ...
def plan(
    scenario: Any, options: SearchOptions, cache: bool, progress: Optional[Callable[[str, int, int], object]]
) -> Dict[str, Any]: ...
def simulate(plan: Any, scenario: Any, options: SimulateOptions) -> Dict[str, Any]: ...

class Planner:
    def __new__(cls, scenario: Any, options: SearchOptions, cache: bool) -> Planner: ...
    def plan(
        self, scenario: Any, options: SearchOptions, progress: Optional[Callable[[str, int, int], object]]
    ) -> Dict[str, Any]: ...
    def prepare(self, progress: Optional[Callable[[str, int, int], object]]) -> None: ...
    def resume(self, plan: Any) -> bool: ...
    def replan(self, request: Dict[str, Any]) -> Dict[str, Any]: ...

class Sweep:
    runs: int
    def __new__(cls, plan: Any, scenario: Any, options: SweepOptions) -> Sweep: ...
    def run(self, progress: Optional[Callable[[int, int], object]]) -> Dict[str, Any]: ...
