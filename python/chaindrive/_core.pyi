"""The compiled core of the package; use `chaindrive` instead."""

from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from typing import Any, Final, TypeAlias, final

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "Drive",
    "Friction",
    "Law",
    "Sweep",
    "__version__",
    "_cli",
    "catalogue",
    "centre_distance_for",
    "channels",
    "links_for",
    "methods",
    "polygon_action",
    "presets",
    "schema",
    "simulate",
    "work_precision",
]

_Floats: TypeAlias = NDArray[np.float64]

__version__: Final[str]

@final
class Drive:
    @staticmethod
    def read(path: str | PathLike[str]) -> Drive: ...
    @staticmethod
    def from_text(text: str, name: str) -> Drive: ...
    @staticmethod
    def from_toml(text: str, name: str) -> Drive: ...
    @staticmethod
    def preset(name: str) -> Drive: ...
    def replace(self, changes: Sequence[tuple[str, str]]) -> Drive: ...
    @property
    def text(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def title(self) -> str: ...
    @property
    def links(self) -> int: ...
    @property
    def sprockets(self) -> list[str]: ...
    @property
    def guides(self) -> list[str]: ...
    @property
    def tensioners(self) -> list[str]: ...
    def run_defaults(self) -> dict[str, Any]: ...
    def law(self, body: str) -> Law: ...
    def describe(self) -> tuple[str, str]: ...
    def statics(self) -> list[tuple[str, _Floats, list[int]]]: ...
    def modes(self) -> dict[str, _Floats]: ...
    def drawing(self, settled: bool) -> dict[str, Any]: ...

@final
class Friction:
    @staticmethod
    def from_json(text: str) -> Friction: ...
    def to_json(self) -> str: ...
    def act(self, normal: _Floats, slip: _Floats) -> list[_Floats]: ...
    def rub(self, normal: _Floats, slip: _Floats, state: _Floats, dt: _Floats) -> list[_Floats]: ...

@final
class Law:
    @staticmethod
    def from_json(text: str) -> Law: ...
    @staticmethod
    def between(
        kind: str,
        arrangement: str,
        measures: Sequence[float],
        length: float,
        modulus: float,
        dissipation: str,
        onset_floor: float,
    ) -> Law: ...
    def to_json(self) -> str: ...
    def hysteresis(self) -> tuple[float, float] | None: ...
    def respond(
        self, penetration: _Floats, rate: _Floats, onset_rate: _Floats
    ) -> list[_Floats]: ...
    def energy(self, penetration: _Floats) -> _Floats: ...

_Outcome: TypeAlias = tuple[
    str | None, str, _Floats, list[tuple[str, list[str]]], list[tuple[str, _Floats]]
]

@final
class Sweep:
    def __new__(
        cls,
        text: str,
        name: str,
        vary: Sequence[tuple[str, Sequence[str]]],
        record: Sequence[str],
        given: Sequence[tuple[str, str]] = ...,
    ) -> Sweep: ...
    def __len__(self) -> int: ...
    def run(
        self, jobs: int | None, progress: Callable[[float], object] | None
    ) -> dict[str, Any]: ...
    def part(self, first: int, end: int) -> list[_Outcome]: ...
    def stack(self, outcomes: Sequence[_Outcome | None]) -> dict[str, Any]: ...

def simulate(
    drive: Drive,
    channels: Sequence[str],
    *,
    until: float,
    every: float,
    method: str,
    step: float | None,
    tolerance: float,
    onset_depth: float | None,
    accuracy: float | None,
    events: Sequence[str],
    output: str | PathLike[str] | None,
    overwrite: bool,
    error: bool,
    progress: Callable[[float], object] | None,
) -> Mapping[str, Any]: ...
def work_precision(
    drive: Drive,
    variants: Sequence[tuple[str, float | None, float | None, float | None]],
    *,
    until: float | None,
    repeats: int,
    replicates: int,
) -> Mapping[str, Any]: ...
def catalogue() -> dict[str, Any]: ...
def presets() -> list[tuple[str, str]]: ...
def schema() -> str: ...
def channels() -> list[tuple[str, str, str | None, str, bool]]: ...
def methods() -> list[str]: ...
def polygon_action(
    teeth: Sequence[int], pitch: float, centre_distance: float, driver_angle: _Floats
) -> tuple[dict[str, _Floats], dict[str, float]]: ...
def links_for(teeth: Sequence[int], pitch: float, centre_distance: float) -> float: ...
def centre_distance_for(teeth: Sequence[int], pitch: float, links: float) -> float: ...
def _cli(arguments: Sequence[str]) -> int: ...
