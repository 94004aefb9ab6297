"""The commands `calibrate`, `predict`, `next-measurement`: the first prints what they read."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from chaindrive.assumptions.outputs import OUTPUTS
from chaindrive.errors import MeasurementError, tell
from chaindrive.measurement.arguments import (
    drive_of,
    is_seen,
    number_of,
    pairs_of,
    place_of_output,
    ranges_of,
    record_of,
    rig_of,
    rows_of,
    runs_of,
)
from chaindrive.measurement.calibration import calibrate
from chaindrive.measurement.predicting import predict
from chaindrive.measurement.proposing import next_measurement
from chaindrive.measurement.telling import texts
from chaindrive.reporting import report

__all__ = ["calibrated", "foretold", "proposed"]

_COLUMNS = ("start", "estimate", "error", "lower", "upper", "freedom", "low", "high")
_FEATURES = ("measured", "simulated", "feature_error", "residual")
_ATTRIBUTES = ("verdict", "reasons", "level")
_TOLD = (*_ATTRIBUTES, "chi2", "dof", "p_value", "validation", "validation_p_value")
_RUNS = ("method", "step", "run_in")


def calibrated(options: Mapping[str, Any]) -> tuple[str, dict[str, Any]]:
    """Fit, and return the page and the answer."""
    places = {
        text: place_of_output(text, (".html", ".htm", ".toml"), options["overwrite"])
        for text in options["output"]
    }
    data = record_of(options)
    free = ranges_of("free", options["free"])
    priors = {path: _prior(path, text) for path, text in _priors(options).items()}
    starts = {} if options["starts"] is None else {"starts": options["starts"]}
    fit = calibrate(drive_of(options), data, free, priors=priors, **starts, **runs_of(options))
    for text, place in places.items():
        if Path(text).suffix != ".toml":
            place.write(report(fit).encode())
        elif "scene" in fit.attrs:
            place.write(str(fit.attrs["scene"]).encode())
        else:
            tell(f"{text} is not written: no drive comes of a fit that is refused")
    return str(fit.attrs["summary"]), _answer(fit, data)


def _priors(options: Mapping[str, Any]) -> dict[str, str]:
    return pairs_of("prior", options["prior"], "chain.stiffness=20 MN/m±1 MN/m")


def _prior(path: str, text: str) -> tuple[Any, Any]:
    mean, sign, deviation = text.partition("±")
    if not sign:
        message = f"--prior {path}={text}: this is no mean and standard deviation"
        raise MeasurementError(message, "prior", 'such as --prior "chain.stiffness=20 MN/m±1 MN/m"')
    return number_of(mean), number_of(deviation)


def _answer(fit: xr.Dataset, data: xr.Dataset) -> dict[str, Any]:
    about = fit.attrs
    valleys = range(fit.sizes.get("valley", 0))
    kept = []
    if "kept_feature" in fit.dims:
        own = {f"kept_{it}": it for it in ("feature", "measured", "simulated", "residual")}
        part = fit[[it for it in own if it in fit.data_vars] + ["kept_error"]]
        # Of the same names as what was fitted.
        part = part.drop_dims([it for it in part.dims if it != "kept_feature"])
        kept = rows_of(part.rename(own | {"kept_error": "feature_error"}), "feature", _FEATURES)
    return {
        **{name: about.get(name) for name in _TOLD},
        **{name: about[name] for name in (*_RUNS, "computed")},
        **{name: data.attrs[name] for name in ("measured_from", "findings", "findings_note")},
        "parameters": rows_of(fit, "parameter", _COLUMNS),
        "covariance": fit["covariance"].to_numpy().tolist(),
        "features": rows_of(fit, "feature", ("measured", "simulated", "feature_error", "residual")),
        "kept": kept,
        "optima": [
            {"chi2": float(fit["optimum_chi2"][n]), "values": fit["optimum"][n].to_numpy().tolist()}
            for n in valleys
        ],
        "scene": about.get("scene"),
        "scene_name": about.get("scene_name"),
    }


def foretold(options: Mapping[str, Any]) -> tuple[str, dict[str, Any]]:
    """Foretell outputs of a fit that was printed as JSON."""
    fit = _fit_of(options["fit"])
    changes = pairs_of("at", options["at"], "sprockets.crank.motion.speed=600 rpm")
    at = {path: number_of(text) for path, text in changes.items()}
    more = {} if options["reach"] is None else {"reach": options["reach"]}
    found = predict(fit, options["of"] or OUTPUTS, at=at, **more, **runs_of(options))
    columns = (
        *("unit", "value", "half_width", "lower", "upper", "parameter_error", "run_error"),
        *("numerical", "bending", "freedom", "verdict", "reason"),
    )
    sensitivity = found["sensitivity"].to_numpy().tolist()
    names = found["parameter"].to_numpy().tolist()
    rows = [
        row | {"sensitivity": dict(zip(names, own, strict=True))}
        for row, own in zip(rows_of(found, "output", columns), sensitivity, strict=True)
    ]
    about = {name: found.attrs[name] for name in ("reach", "level", *_RUNS, "until")}
    return str(found.attrs["summary"]), about | {"outputs": rows}


def proposed(options: Mapping[str, Any]) -> tuple[str, dict[str, Any]]:
    """Tell which measurement would settle most."""
    candidates = {it: it for it in options["candidate"]} | rig_of(options).get("channels", {})
    points: dict[str, dict[str, Any]] = {}
    example = "slow:sprockets.driver.motion.speed=150 rpm"
    for given in options["excitation"]:
        name, sign, change = given.partition(":")
        if not (name.strip() and sign):
            message = f"--excitation {given}: this is no name and what belongs to it"
            raise MeasurementError(message, "excitation", f'such as --excitation "{example}"')
        values = pairs_of("excitation", [change], example)
        points.setdefault(name.strip(), {}).update(
            {path: number_of(text) for path, text in values.items()}
        )
    lengths = {name: options[name] for name in ("rate", "record", "until")}
    found = next_measurement(
        drive_of(options),
        ranges_of("free", options["free"]),
        candidates,
        settle=options["settle"],
        known=None if options["known"] is None else _fit_of(options["known"]),
        excitations=points or None,
        progress=is_seen(),
        **{name: number_of(it) for name, it in lengths.items() if it is not None},
    )
    targets = found["target"].to_numpy().tolist()
    rows = [
        {
            "candidate": one["candidate"].item(),
            "excitation": one["excitation"].item(),
            "shrinking": float(one["shrinking"]),
            "length": float(one["length"]),
            "after": dict(zip(targets, one["after"].to_numpy().tolist(), strict=True)),
        }
        for one in (
            found.isel(excitation=at[0], candidate=at[1])
            for at in np.ndindex(found["shrinking"].shape)
        )
    ]
    about = ("best_candidate", "best_excitation", "best_length", "record")
    return str(found.attrs["summary"]), {name: found.attrs[name] for name in about} | {
        "targets": rows_of(found, "target", ("before",)),
        "candidates": sorted(rows, key=lambda it: it["shrinking"]),
    }


def _fit_of(file: str) -> xr.Dataset:
    """Return a fit, as far as a prediction takes it, of what `calibrate` printed as JSON."""
    try:
        told = json.loads(Path(file).read_text(encoding="utf-8"))
        rows = told["parameters"]
        columns = {name: [_or_nan(row[name]) for row in rows] for name in ("estimate", "freedom")}
        # Infinitely many degrees of freedom are no number of JSON.
        columns["freedom"] = [math.inf if math.isnan(it) else it for it in columns["freedom"]]
        covariance = [[_or_nan(it) for it in row] for row in told["covariance"]]
        about = {name: told[name] for name in _ATTRIBUTES}
        optional = {name: told[name] for name in ("scene", "scene_name", "validation")}
        return xr.Dataset(
            {
                **{name: ("parameter", it) for name, it in columns.items()},
                "covariance": (("parameter", "parameter_2"), np.array(covariance, dtype=float)),
            },
            coords={"parameter": texts(row["parameter"] for row in rows)},
            attrs=about | {name: it for name, it in optional.items() if it is not None},
        )
    except (ValueError, KeyError, TypeError) as error:
        message = f"{file} is no fit: {error!r}"
        raise MeasurementError(
            message, file, "what `chaindrive calibrate … --json` prints"
        ) from error


def _or_nan(value: float | None) -> float:
    return math.nan if value is None else float(value)
