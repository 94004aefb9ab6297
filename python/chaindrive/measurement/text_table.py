"""Tables of text: CSV of any separator, decimal mark and encoding, with headings and units."""

from __future__ import annotations

import csv
import re
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from chaindrive.errors import MeasurementError
from chaindrive.measurement.raw import RawChannel, RawRecord, numbered, numbers
from chaindrive.measurement.units import named_unit, unit_of

__all__ = ["read"]

#: Lines in which the headings are looked for.
_LINES = 200
_SEPARATORS = ("\t", ";", ",", "|", " ")
_BLANK = {"", "nan", "na", "n/a", "null", "none", "inf", "-inf", "+inf", "-", "--", "---"}


def read(
    path: Path,
    encoding: str | None = None,
    decimal: str | None = None,
    separator: str | None = None,
) -> RawRecord:
    """Read a table of text by pandas, once its form is known.

    The form is told by the lines themselves: headings are the last line of texts before the first
    line of numbers, and a line of units may stand between.
    """
    encoding, notes = _encoding(path, encoding)
    with path.open(encoding=encoding, newline="") as file:
        lines = [line.rstrip("\r\n") for line, _ in zip(file, range(_LINES), strict=False)]
    found = _form(lines, separator, decimal)
    if found is None:
        message = f"{path}: no line of numbers is among the first {len(lines)}"
        raise MeasurementError(
            message, path, "a heading line, then a line a sample; or give separator and decimal"
        )
    separator, decimal, first = found
    names, units = _headings(lines[:first], _split(lines[first], separator), separator)
    try:
        table = pd.read_csv(
            path,
            sep=r"\s+" if separator == " " else separator,
            decimal=decimal,
            encoding=encoding,
            header=None,
            names=range(len(names)),
            index_col=False,
            skiprows=first,
            skip_blank_lines=True,
            comment="#",
            skipinitialspace=True,
            na_values=["---", "--", "-"],
            low_memory=False,
            on_bad_lines="error",
        )
    except pd.errors.ParserError as error:
        reason = str(error).removeprefix("Error tokenizing data. C error: ").strip()
        raise MeasurementError(f"{path}: {reason}", path, "every line has as many cells") from error
    channels = []
    for number, (name, unit) in enumerate(zip(names, units, strict=True)):
        column = table[number]
        if column.isna().all():
            notes.append(("text", name, "holds nothing, and is left out"))
            continue
        values, wrong = numbers(column.to_numpy())
        if values is None:
            moments = _moments(column)
            if moments is None:
                notes.append(("text", name, "holds texts, and is left out"))
                continue
            channels.append(RawChannel(name, "s", moments))
            continue
        if wrong:
            notes.append(("not-a-number", name, f"{wrong} cells are no numbers"))
        channels.append(RawChannel(name, unit, values))
    return RawRecord(channels, notes)


def _encoding(path: Path, given: str | None) -> tuple[str, list[tuple[str, str, str]]]:
    """Return the encoding of a file: as given, as its first bytes say, UTF-8, or Windows'."""
    with path.open("rb") as file:
        start = file.read(1 << 20)
    if given is not None:
        try:
            start.decode(given, errors="strict" if len(start) < 1 << 20 else "ignore")
        except LookupError:
            message = f"encoding = {given!r} is none that Python knows"
            raise MeasurementError(message, "encoding", "such as utf-8, utf-16, cp1252") from None
        return given, []
    for mark, name in (
        (b"\xef\xbb\xbf", "utf-8-sig"),
        (b"\xff\xfe", "utf-16"),
        (b"\xfe\xff", "utf-16"),
    ):
        if start.startswith(mark):
            return name, []
    if b"\x00" in start:
        message = f"{path}: this is no text: it holds zero bytes"
        raise MeasurementError(message, path, "give its encoding, such as utf-16-le")
    try:
        start[: start.rfind(b"\n") + 1 or None].decode("utf-8")
    except UnicodeDecodeError:
        note = "the file is not UTF-8, and was read as cp1252; give encoding if that is wrong"
        return "cp1252", [("encoding", "", note)]
    return "utf-8", []


def _split(line: str, separator: str) -> list[str]:
    if separator == " ":
        return line.split()
    # Many programs end every line with a separator.
    return [
        cell.strip() for cell in next(csv.reader([line.rstrip(separator)], delimiter=separator))
    ]


def _is_number(cell: str, decimal: str) -> bool:
    if decimal == ",":
        cell = cell.replace(".", "x").replace(",", ".")
    try:
        float(cell)
    except ValueError:
        return False
    return True


_MOMENT = re.compile(r"^\d{1,4}[-./:]\d{1,2}[-./:]\d{1,4}")


def _form(
    lines: list[str], separator: str | None, decimal: str | None
) -> tuple[str, str, int] | None:
    """Return separator, decimal mark and the first line of numbers of a table, or None.

    What makes most numbers of the most lines is the form; a comma is a decimal mark only where
    something else separates.
    """
    best: tuple[float, str, str, int] | None = None
    for mark in [separator] if separator else _SEPARATORS:
        for point in [decimal] if decimal else [".", ","]:
            if mark == point:
                continue
            widths, counts = [], []
            for line in lines:
                cells = _split(line, mark) if line.strip() and not line.startswith("#") else []
                good = sum(_is_number(it, point) for it in cells)
                fine = good and all(
                    _is_number(it, point) or it.casefold() in _BLANK or _MOMENT.match(it)
                    for it in cells
                )
                # Lines that break in the middle of a file are for pandas to refuse.
                widths.append(len(cells) if fine or good > len(cells) / 2 else 0)
                counts.append(good if widths[-1] else 0)
            first = next((n for n, width in enumerate(widths) if width), None)
            if first is None:
                continue
            even = sum(width == widths[first] for width in widths[first:])
            # Separated by blanks, `1,5 2,5` has as many cells by blanks as by commas.
            score = even * (1.0 if widths[first] == 1 else 2.0) + 1e-3 * sum(counts) / len(lines)
            if best is None or score > best[0] * (1 + 1e-9):
                best = (score, mark, point, first)
    return None if best is None else best[1:]


def _headings(
    above: list[str], cells: list[str], separator: str
) -> tuple[list[str], list[str | None]]:
    """Return names and units of the columns of a table, from the lines above its numbers."""
    width = len(cells)
    rows = [_split(line.lstrip("#").strip(), separator) for line in above if line.strip("# \t")]
    fitting = [row for row in rows if len(row) == width]
    bare: list[str | None] = [None] * width
    if not fitting:
        return [f"column {number + 1}" for number in range(width)], bare
    units = bare
    if len(fitting) > 1 and _are_units(fitting[-1]):
        units = [cell.strip("[]() ") for cell in fitting.pop()]
    names = []
    for number, cell in enumerate(fitting[-1]):
        name, unit = named_unit(cell)
        names.append(name or f"column {number + 1}")
        units = [*units[:number], unit if unit is not None else units[number], *units[number + 1 :]]
    return numbered(names), units


def _are_units(cells: list[str]) -> bool:
    """Tell whether a line holds units: most are known, or stand in brackets."""
    stated = [it for it in cells if it]
    known = [
        it for it in stated if unit_of(it.strip("[]() ")).is_known or it[0] + it[-1] in ("[]", "()")
    ]
    return bool(stated) and 2 * len(known) > len(stated)


def _moments(column: pd.Series) -> NDArray[np.float64] | None:
    """Return dates and times of day as seconds after the first, or None where they are none."""
    found = pd.to_datetime(column, errors="coerce", format="mixed")
    if found.isna().mean() > 0.5:
        return None
    seconds = (found - found.dropna().iloc[0]).dt.total_seconds()
    return np.asarray(seconds, dtype=np.float64)
