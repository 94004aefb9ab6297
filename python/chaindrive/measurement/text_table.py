"""Tables of text: CSV of any separator, decimal mark and encoding, with headings and units."""

from __future__ import annotations

import csv
import re
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from chaindrive.errors import MeasurementError
from chaindrive.measurement.raw import RawChannel, RawRecord, left_out, numbered, numbers
from chaindrive.measurement.units import named_unit, unit_of

__all__ = ["read"]

#: Lines in which the headings are looked for.
_LINES = 200
_SEPARATORS = ("\t", ";", ",", "|", " ")
_BLANK = {"", "nan", "na", "n/a", "null", "none", "inf", "-inf", "+inf", "-", "--", "---"}
#: Separators of thousands, beside the comma or point that is not the decimal mark.
_GAPS = " \u00a0\u2009\u202f'’"
#: Numbers whose thousands are separated, by their decimal mark.
_GROUPED = {
    decimal: re.compile(
        rf"[-+]?[1-9]\d{{0,2}}([{other}{_GAPS}])\d{{3}}(\1\d{{3}})*(\{decimal}\d*)?"
    )
    for decimal, other in ((".", ","), (",", "."))
}
#: The beginning of a date or a time of day.
_MOMENT = re.compile(r"\d{1,4}(?P<mark>[-./:])(\d{1,2}|[A-Za-z]{3})[-./:]\d{1,4}")
_TIMES_OF_DAY = ("%H:%M:%S", "%I:%M:%S %p")
_DATES = {
    ".": ("%d.%m.%Y", "%d.%m.%y", "%Y.%m.%d"),
    "-": ("%Y-%m-%d", "%d-%m-%Y", "%d-%b-%Y"),
    # The month comes first, unless there is no such month.
    "/": ("%m/%d/%Y", "%d/%m/%Y", "%Y/%m/%d", "%m/%d/%y", "%d/%m/%y"),
}
#: Forms of dates and times of day, by the first mark in them.
_MOMENTS = {":": _TIMES_OF_DAY} | {
    mark: (
        *(f"{date} {time}" for date in dates for time in _TIMES_OF_DAY),
        *(f"{date} {time}" for date in dates for time in ("%H:%M", "%I:%M %p")),
        *dates,
    )
    for mark, dates in _DATES.items()
}


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
    if decimal not in (None, *_GROUPED):
        raise MeasurementError(f"decimal = {decimal!r}, must be '.' or ','", "decimal")
    encoding, notes = _encoding(path, encoding)
    with path.open(encoding=encoding, newline="") as file:
        lines = [line.rstrip("\r\n") for line, _ in zip(file, range(_LINES), strict=False)]
    found = _form(lines, separator, decimal)
    if found is None:
        message = f"{path}: no line of numbers is among the first {len(lines)}"
        do = "leave out" if separator or decimal else "give"
        raise MeasurementError(
            message, path, f"a heading line, then a line a sample; or {do} separator and decimal"
        )
    separator, decimal, first = found
    headings, units = _headings(lines[:first], _split(lines[first], separator), separator)
    names = numbered([name or f"column {number}" for number, name in enumerate(headings, 1)])
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
    for number, (heading, name, unit) in enumerate(zip(headings, names, units, strict=True)):
        column = table[number]
        if column.isna().all():
            # Many programs end every line with a separator.
            if heading:
                notes.append(left_out(name, column))
            continue
        is_text = not pd.api.types.is_numeric_dtype(column)
        # `thousands` of pandas would make 55 of 5.5, and a number of 26.11.2024.
        cells = column.map(partial(_plain, decimal=decimal), "ignore") if is_text else column
        values, wrong = numbers(cells.to_numpy())
        if values is None:
            known = unit_of(unit or None)
            is_other = known.is_known and known.si != "s"
            moments, strange = (None, column) if is_other else _moments(column)
            if moments is None:
                notes.append(left_out(name, strange))
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
        # As pandas does it: a blank that does not break separates thousands.
        return re.split(r"[ \t]+", line.strip(" \t"))
    return [cell.strip() for cell in next(csv.reader([line], delimiter=separator))]


def _is_grouped(cell: str, decimal: str) -> bool:
    return _GROUPED[decimal].fullmatch(cell) is not None


def _plain(cell: str, decimal: str) -> str:
    """Return a number with a decimal point and without separators of thousands.

    Where the comma is the decimal mark, a point is none.
    """
    cell = cell.strip()
    if _is_grouped(cell, decimal):
        cell = re.sub(rf"[^-+\d{decimal}]", "", cell)
    return cell.replace(".", "x").replace(",", ".") if decimal == "," else cell


def _is_number(cell: str, decimal: str) -> bool:
    try:
        float(_plain(cell, decimal))
    except ValueError:
        return False
    return True


def _form(
    lines: list[str], separator: str | None, decimal: str | None
) -> tuple[str, str, int] | None:
    """Return separator, decimal mark and the first line of numbers of a table, or None.

    What makes most lines as wide as each other is the form; then what has headings; then what makes
    numbers of most cells, first without separators of thousands: `6,397` is 6.397 where it may be.
    Where commas separate cells, one within quotes separates thousands if it may.
    """
    best: tuple[tuple[float, ...], str, str, int] | None = None
    for mark in [separator] if separator else _SEPARATORS:
        for point in [decimal] if decimal else _GROUPED:
            widths, good, plain = [], 0.0, 0.0
            for line in lines:
                cells = _split(line, mark) if line.strip() and not line.startswith("#") else []
                count = sum(_is_number(it, point) for it in cells)
                fine = count and all(
                    _is_number(it, point) or it.casefold() in _BLANK or _MOMENT.match(it)
                    for it in cells
                )
                # Lines that break in the middle of a file are for pandas to refuse.
                widths.append(len(cells) if fine or count > len(cells) / 2 else 0)
                if widths[-1]:
                    # Separated by blanks, `1,5 2,5` has as many numbers by blanks as by commas.
                    good += count / len(cells)
                    grouped = sum(_is_grouped(it, point) for it in cells)
                    plain += (count - grouped) / len(cells) if mark != point else 0.0
            first = next((n for n, width in enumerate(widths) if width), None)
            if first is None:
                continue
            even = sum(width == widths[first] for width in widths[first:])
            headed = bool(_rows(lines[:first], _split(lines[first], mark), mark))
            score = (even * (1.0 if widths[first] == 1 else 2.0), headed, good, plain)
            if best is None or score > best[0]:
                best = (score, mark, point, first)
    return None if best is None else best[1:]


def _rows(above: list[str], cells: list[str], separator: str) -> list[list[str]]:
    """Return the cells of lines that are as wide as a line of numbers.

    Many programs end lines with separators: empty cells at the end may be more or fewer.
    """

    def stated(row: list[str]) -> int:
        return max((number for number, cell in enumerate(row, 1) if cell), default=0)

    width = len(cells)
    rows = [_split(line.lstrip("#").strip(" "), separator) for line in above if line.strip("# \t")]
    return [
        (row + [""] * width)[:width]
        for row in rows
        if len(row) >= stated(cells) and stated(row) <= width
    ]


def _headings(
    above: list[str], cells: list[str], separator: str
) -> tuple[list[str], list[str | None]]:
    """Return names and units of the columns of a table, from the lines above its numbers.

    A column without a heading has an empty name.
    """
    width = len(cells)
    fitting = _rows(above, cells, separator)
    bare: list[str | None] = [None] * width
    if not fitting:
        return [""] * width, bare
    units = bare
    if len(fitting) > 1 and _are_units(fitting[-1]):
        units = [cell.strip("[]() ") for cell in fitting.pop()]
    names = []
    for number, cell in enumerate(fitting[-1]):
        name, unit = named_unit(cell)
        names.append(name)
        units = [*units[:number], unit if unit is not None else units[number], *units[number + 1 :]]
    return names, units


def _are_units(cells: list[str]) -> bool:
    """Tell whether a line holds units: most are known, or stand in brackets."""
    stated = [it for it in cells if it]
    known = [
        it for it in stated if unit_of(it.strip("[]() ")).is_known or it[0] + it[-1] in ("[]", "()")
    ]
    return bool(stated) and 2 * len(known) > len(stated)


def _moments(column: pd.Series) -> tuple[NDArray[np.float64] | None, pd.Series]:
    """Return dates and times of day as seconds after the first, and the cells that are none.

    All are of one form, but for fractions of a second; None stands for a column where they are not.
    Pandas left alone takes `3/14` and `6,396` for dates.
    """
    texts = column.str.strip().str.replace(",", ".")
    strange = stated = texts.dropna()
    begin = _MOMENT.match(stated.iloc[0])
    for form in ("ISO8601", *_MOMENTS[begin["mark"]]) if begin else ():
        first = _parsed(stated[:1], form).iloc[0]
        if pd.isna(first):
            continue
        found = _parsed(texts, form)
        missed = stated[found[stated.index].isna()]
        if missed.empty:
            return np.asarray((found - first).dt.total_seconds(), dtype=np.float64), missed
        strange = min(strange, missed, key=len)
    return None, column[strange.index]


def _parsed(texts: pd.Series, form: str) -> pd.Series:
    """Return texts as moments of a form, with a fraction of a second or without."""
    whole, parts = (
        pd.to_datetime(texts, format=it, errors="coerce", utc=True).dt.as_unit("ns")
        for it in (form, form.replace("%S", "%S.%f"))
    )
    return whole.fillna(parts)
