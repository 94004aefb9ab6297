"""The scenes that come with the program, one function each.

>>> from chaindrive import scenes
>>> "marine_engine" in scenes.presets()
True
"""

from __future__ import annotations

from chaindrive import _core
from chaindrive.drive import Drive

_PRESETS = dict(_core.presets())

__all__ = ["presets", *_PRESETS]  # pyright: ignore[reportUnsupportedDunderAll]


def presets() -> dict[str, str]:
    """Return name and one-line description of every scene."""
    return dict(_PRESETS)


def __getattr__(name: str) -> _Preset:
    if name in _PRESETS:
        return _Preset(name, _PRESETS[name])
    raise AttributeError(f"there is no scene `{name}`; there are {', '.join(_PRESETS)}")


def __dir__() -> list[str]:
    return sorted([*globals(), *_PRESETS])


class _Preset:
    """Makes one of the drives."""

    def __init__(self, name: str, description: str) -> None:
        self.__name__ = name
        self.__doc__ = f"{description}.\n\nReturns\n-------\nDrive\n"

    def __call__(self) -> Drive:
        return Drive._of(_core.Drive.preset(self.__name__))

    def __repr__(self) -> str:
        return f"<function chaindrive.scenes.{self.__name__}>"
