"""What people read of a comparison or a check: text, and the sections of a page."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from chaindrive import _core
from chaindrive.measurement.correspondence import other_speeds
from chaindrive.plot.units import in_trade

if TYPE_CHECKING:
    from chaindrive.measurement.comparison import Compared

__all__ = ["as_text", "number", "texts", "told_calibration", "told_comparison"]

_WORDS = {
    "mean": "mean",
    "std": "standard deviation",
    "p1": "1st percentile",
    "p99": "99th percentile",
}


def told_comparison(
    run: xr.Dataset, data: xr.Dataset, found: list[Compared], shaft: str | None, level: float
) -> tuple[str, str]:
    """Return the text of a comparison, and its page as JSON, in the form of the page of a run."""
    sections = [_verdicts(run, data, found, level), *map(_of_quantity, found)]
    return as_text(sections), json.dumps({"sections": sections})


def _verdicts(
    run: xr.Dataset, data: xr.Dataset, found: list[Compared], level: float
) -> dict[str, Any]:
    rows = [[it.name, str(it.quantity), it.verdict, _worst(it)] for it in found]
    title = run.attrs.get("title") or run.attrs.get("scene_name", "run")
    words = [f"{title} against {data.attrs['measured_from']}, at {100 * level:g} %."]
    if data.attrs["findings_note"]:
        words.append(f"The record: {data.attrs['findings_note']}.")
    if str(run.attrs.get("verdict")) == "distrusted":
        words.append("The run contradicts itself: its verdict is distrusted.")
    words += [f"{it}." for it in other_speeds(run, data)]
    words += [note + "." for it in found for note in it.notes]
    return {
        "title": "against the measurement",
        "columns": ["channel", "quantity", "verdict", "most"],
        "rows": rows,
        "sentences": words,
    }


def _worst(it: Compared) -> str:
    """Return the largest miss in words, or why nobody can tell, or the narrowest agreement."""
    if it.lines:
        good = [line for line in it.lines if math.isfinite(line.found)]
        return f"{len(good)} of {len(it.lines)} lines of the mesh found"
    misses = [
        (abs(other - one) / max(band.half_width, 1e-300), name, other - one, band.half_width)
        for name, one, other, band, judgement in _judged(it)
        if judgement.verdict == "misses"
    ]
    if misses:
        _, name, difference, width = max(misses)
        factor, unit = in_trade(it.unit, [difference, width])
        return (
            f"misses by {factor * difference:+.3g} {unit} in the {name}, "
            f"where errors reach {factor * width:.3g} {unit}"
        )
    agreed = [name for name, *_, judgement in _judged(it) if judgement.verdict == "agrees"]
    if agreed:
        return f"agrees in {', '.join(agreed)}"
    return next((judgement.reason for *_, judgement in _judged(it)), "")


def _judged(it: Compared) -> Iterable[tuple[str, float, float, Any, Any]]:
    for name, one, other, band, judgement in it.rows:
        yield _WORDS[name], one, other, band, judgement
    for order, title, first, second, band, judgement in it.orders:
        yield f"order {order:g} ({title})", abs(first), abs(second), band, judgement


def _of_quantity(it: Compared) -> dict[str, Any]:
    if it.lines:
        rows = [
            [
                f"{line.multiple} × mesh",
                number(line.found),
                number(line.expected),
                "–"
                if not math.isfinite(line.found)
                else f"{100 * (line.found / line.expected - 1):+.3f}",
            ]
            for line in it.lines
        ]
        return {
            "title": f"{it.name}: {it.quantity}",
            "columns": ["line", "measured [Hz]", "run [Hz]", "apart [%]"],
            "rows": rows,
            "sentences": [
                "Amplitudes and forces: cannot tell, as the way to the sensor is not simulated."
            ],
        }
    numbers = [value for _, one, other, *_ in it.rows for value in (one, other)]
    factor, unit = in_trade(it.unit, numbers)
    rows = [
        [
            name,
            number(factor * one),
            number(factor * other),
            number(factor * (other - one)),
            number(factor * band.half_width),
            number(factor * band.numerical),
            number(factor * band.simulated),
            number(factor * band.measured),
            number(factor * band.sensor),
            judgement.verdict + (f": {judgement.reason}" if judgement.reason else ""),
        ]
        for name, one, other, band, judgement in _judged(it)
    ]
    sentences = []
    if it.overlay is not None:
        sentences.append(
            f"Laid over each other, the two correlate by {it.overlay.correlation:.3f}."
        )
    return {
        "title": f"{it.name}: {it.quantity} [{unit}]",
        "columns": [
            "statistic",
            "measured",
            "run",
            "difference",
            "± band",
            "numerical",
            "u run",
            "u measured",
            "u sensor",
            "verdict",
        ],
        "rows": rows,
        "sentences": sentences,
    }


def told_calibration(found: xr.Dataset, records: Sequence[xr.Dataset]) -> tuple[str, str]:
    """Return the text of a calibration, and its page as JSON."""
    of = found.attrs
    sources = ", ".join(dict.fromkeys(str(it.attrs["measured_from"]) for it in records))
    names = ("start", "estimate", "lower", "upper", "error", "freedom", "low", "high")
    rows = [
        [str(path), *(number(float(found[name].sel(parameter=path))) for name in names)]
        for path in found["parameter"].to_numpy()
    ]
    words = [f"{it}." for it in of["reasons"]]
    if "chi2" in of:
        words.append(
            f"χ² is {of['chi2']:.3g} of {of['dof']} degrees of freedom"
            + (f", chance {of['p_value']:.2g}." if of["dof"] > 0 else ": nothing is tested.")
        )
        words.append(f"{found.sizes['valley']} optima, of which {of['alike']} explain it alike.")
    if "validation" in of:
        words.append(
            f"The part that was kept {of['validation']}, chance {of['validation_p_value']:.2g}."
        )
    words.append(
        f"All runs: {of['method']}, step {1e6 * of['step']:.3g} µs, "
        f"run in for {of['run_in']:.3g} s; {of['computed']} computed."
    )
    sections: list[dict[str, Any]] = [
        {
            "title": f"{of['verdict']}: fit to {sources}",
            "columns": [
                *("parameter", "start", "estimate"),
                *(f"{100 * of['level']:g} % from", "to", "error", "ν", "bound", "bound"),
            ],
            "rows": rows,
            "sentences": words,
        },
        _left("what is left", found, "feature", ("measured", "simulated", "feature_error")),
    ]
    if "kept_feature" in found.dims:
        names_kept = ("kept_measured", "kept_simulated", "kept_error")
        sections.append(_left("the part that was kept", found, "kept_feature", names_kept))
    return as_text(sections), json.dumps({"sections": sections})


def _left(title: str, found: xr.Dataset, dim: str, names: tuple[str, str, str]) -> dict[str, Any]:
    measured, simulated, error = (found[name].to_numpy() for name in names)
    rows = [
        [str(label), *map(number, (one, other, band, (other - one) / band))]
        for label, one, other, band in zip(
            found[dim].to_numpy(), measured, simulated, error, strict=True
        )
    ]
    return {
        "title": title,
        "columns": ["feature [SI]", "measured", "fitted", "error", "difference / error"],
        "rows": rows,
        "sentences": [],
    }


def number(value: float) -> str:
    """Return a figure of a table, a dash for none."""
    return f"{value:.4g}" if math.isfinite(value) else "–"


def texts(given: Iterable[Any]) -> Any:
    """Return texts as an array, which a coordinate or a variable takes."""
    return np.asarray([str(it) for it in given], dtype=np.str_)


def as_text(sections: list[dict[str, Any]]) -> str:
    """Return sections as text: tables with columns as wide as their contents."""
    lines: list[str] = []
    for section in sections:
        lines += ["", section["title"]] if lines else [section["title"]]
        table = [section["columns"], *section["rows"]] if section["rows"] else []
        widths = (
            [max(len(row[at]) for row in table) for at in range(len(table[0]))] if table else []
        )
        for row in table:
            cells = [
                cell.ljust(width) if at == 0 or not _is_figure(table, at) else cell.rjust(width)
                for at, (cell, width) in enumerate(zip(row, widths, strict=True))
            ]
            lines.append("  " + "  ".join(cells).rstrip())
        lines += [f"  {sentence}" for sentence in section["sentences"]]
    return _core.plain("\n".join(lines))


def _is_figure(table: list[list[str]], at: int) -> bool:
    return any(row[at][:1] in "+-–0123456789" and row[at] for row in table[1:])
