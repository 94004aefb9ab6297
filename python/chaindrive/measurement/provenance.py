"""Where each number of a fitted drive is from: a comment behind it, in its scene."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping

import numpy as np

from chaindrive.drive import Drive

__all__ = ["fitted_drive"]


def fitted_drive(drive: Drive, values: Mapping[str, float], notes: Mapping[str, str]) -> Drive:
    """Return a drive with fitted values, each with a comment that says where it is from.

    Parameters
    ----------
    drive
        The drive that was fitted. A scene in JSON knows no comments, and is written out as TOML.
    values
        Fitted values by path [SI].
    notes
        Their comments.
    """
    if drive.text.lstrip("\ufeff \t\r\n").startswith("{"):
        drive = drive.resolved()
    best = drive.replace(values)
    lines = best.text.split("\n")
    told: dict[int, list[str]] = {}
    for path, value in values.items():
        # The line that another value of this path changes is where it stands.
        other = best.replace({path: float(np.nextafter(value, np.inf))}).text.split("\n")
        for at, (line, moved) in enumerate(zip(lines, other, strict=False)):
            if line != moved:
                told.setdefault(at, []).append(notes[path])
                break
    for at, words in told.items():
        lines[at] = f"{_bare(lines[at])} # {'; '.join(words)}"
    return Drive.from_toml("\n".join(lines), best.name)


def _bare(line: str) -> str:
    """Return a line without its comment, which spoke of another value."""
    for at, letter in enumerate(line):
        if letter != "#":
            continue
        try:
            tomllib.loads(line[:at])
        except tomllib.TOMLDecodeError:
            continue
        return line[:at].rstrip()
    return line.rstrip()
