"""The page of a run against the arrays that it tells of, and the report made of it."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import chaindrive as cd
from chaindrive.front_page import front_page
from chaindrive.page import Page

# Preset, run-in and length [s]: guides, a tensioner and particles; rigid links.
RUNS = [("marine_engine", 0.05, 0.1), ("bicycle", 0.0, 0.02)]
IN_SI = {"N": 1.0, "kN": 1e3, "W": 1.0, "kW": 1e3, "N m": 1.0, "kN m": 1e3}
ORDER = [
    "verdict",
    "verdict on the chain",
    "record",
    "what the drive does",
    "span tensions",
    "maximum link tension",
    "shaft loads and guide forces",
    "impacts of rollers that seat",
    "tensioners",
    "speed irregularity and transmission error",
    "losses",
    "utilisation",
    "assumed inputs",
    "what next",
]


@pytest.fixture(scope="module", params=RUNS, ids=lambda it: it[0])
def run(request: pytest.FixtureRequest) -> xr.Dataset:
    preset, run_in, until = request.param
    drive = getattr(cd.scenes, preset)()
    return cd.simulate(drive, until=until, run_in=run_in, record="all", error=False)


def column(page: Page, title: str, heading: str) -> dict[str, float]:
    """Values in SI of a column, by the names of the rows."""
    section = next(it for it in page.sections if it["title"] == title)
    place = next(i for i, it in enumerate(section["columns"]) if it.startswith(heading))
    unit = re.search(r"\[(.*)\]", section["columns"][place] + section["columns"][0])
    scale = IN_SI.get(unit[1], 1.0) if unit else 1.0
    number = {"–": np.nan}
    return {row[0]: scale * float(number.get(row[place], row[place])) for row in section["rows"]}


def close(told: dict[str, float], known: xr.DataArray, within: float = 1e-3) -> None:
    # A column has the digits of its greatest value; samples of an idler say little of its power.
    least = max(1e-5, 0.5 * within) * float(abs(known).max())
    for name, value in told.items():
        assert value == pytest.approx(float(known.sel({known.dims[0]: name})), within, least)


def test_a_page_tells_what_the_arrays_hold(run: xr.Dataset) -> None:
    page = run.drive.summary()
    titles = [it["title"].split(":")[0] for it in page.sections]
    assert titles == [title for title in ORDER if title in titles]
    # Means are those of whole periods, or of all of a record that has none.
    period, end = run.attrs["slowest_forcing"], float(run["time"][-1])
    whole = run.sel(time=slice(0.0, end // period * period if period < end else end))
    does = "what the drive does"
    power = (whole["sprocket_torque"] * whole["sprocket_speed"]).mean("time")
    told = column(page, does, "power")
    close(told, abs(power), 0.02)
    # To four digits it is the work that the ledger has of the sprocket with the motion.
    supplied = run["energy_flows"].sel(flow="driver_supplied")
    if period > end:
        work = float(supplied[-1] - supplied[0])
        assert max(told.values()) == pytest.approx(abs(work) / end, rel=1e-3)
    close(column(page, does, "torque"), abs(whole["sprocket_torque"].mean("time")), 0.02)
    close(column(page, does, "speed"), whole["sprocket_speed"].mean("time") * 30 / np.pi, 2e-3)
    means = whole[["sprocket_force_x", "sprocket_force_y"]].mean("time")
    force = np.hypot(means["sprocket_force_x"], means["sprocket_force_y"])
    shafts = column(page, "shaft loads and guide forces", "mean")
    of_sprockets = {name: it for name, it in shafts.items() if not name.startswith("guide ")}
    close(of_sprockets, force, 0.02)
    # Extremes are those of steps: no sample lies beyond.
    greatest = column(page, "span tensions", "greatest")
    for span, value in greatest.items():
        sampled = float(run["span_tension"].sel(span=span).max("time"))
        assert 0.999 * sampled <= value < 1.1 * sampled
    lost = whole["energy_losses"].isel(time=-1) - whole["energy_losses"].isel(time=0)
    duration = float(whole["time"][-1] - whole["time"][0])
    told = column(page, "losses", "power")
    assert told.pop("all") == pytest.approx(float(lost.sum()) / duration, rel=0.02)
    close(told, lost / duration, 0.02)
    for heading, name in (("p99", "p99"), ("greatest", "max")):
        struck = column(page, "impacts of rollers that seat", heading)
        for sprocket, value in struck.items():
            # Fewer than 100 impacts tell no 99th percentile.
            known = run.attrs.get(f"impact_force_{name}_{sprocket}", np.nan)
            is_told = name == "max" or run.attrs[f"impact_count_{sprocket}"] >= 100
            assert np.isfinite(known) == is_told
            assert value == pytest.approx(known, rel=1e-3, nan_ok=True)
    text = str(page)
    tight = str(run["span_tension"].mean("time").idxmax().item())
    assert f"Tight side: {tight}" in text
    pull = float(run["link_tension"].max())
    assert 0.999 * pull <= run.attrs["link_tension_greatest"] < 1.1 * pull
    pull = run.attrs["link_tension_greatest"]
    found = re.search(r"Maximum link tension, of any link: ([\d.]+) (k?N) at", text)
    assert found, text
    assert float(found[1]) * IN_SI[found[2]] == pytest.approx(pull, rel=1e-3)


def test_a_page_has_no_powers_of_ten_and_shows_itself_in_notebooks(run: xr.Dataset) -> None:
    page = run.drive.summary()
    assert not re.search(r"\d[eE][-+]?\d", str(page)), str(page)
    assert str(page) == run.attrs["summary"] == repr(page)
    shown = page._repr_html_()
    assert shown.count("<table>") == sum(bool(it["rows"]) for it in page.sections)
    assert len(page.sections[0]["sentences"]) <= 3
    assert "stepping" in page.numerics


def test_a_page_tells_the_errors_by_the_step(run: xr.Dataset) -> None:
    """As the attributes have them; what is not estimated says how to estimate it."""
    assert "Run it without --no-error, to its end." in str(run.drive.summary())
    judged = cd.simulate(cd.scenes.industrial_16b(), until=0.05, run_in=0)
    text = str(judged.drive.summary())
    told = re.search(r"Half the step moves means by (.*), std by (.*), p1 by (.*) and p99 by", text)
    assert told, text
    assert not re.search(r"\d[eE][-+]?\d", text), text
    for found, name in zip(told.groups(), ("mean", "std", "p1"), strict=True):
        error = 100.0 * judged.attrs[f"error_span_tension_{name}"]
        if not found.startswith("below"):
            assert float(found.split()[0]) == pytest.approx(error, abs=5e-4)
    section = next(it for it in judged.drive.summary().sections if "impacts" in it["title"])
    places = [i for i, it in enumerate(section["columns"]) if it == "± step [%]"]
    assert len(places) == 2
    for row in section["rows"]:
        for place, name in zip(places, ("p50", "max"), strict=True):
            known = judged.attrs.get(f"error_impact_force_{name}_{row[0]}")
            if known is None:
                assert row[place] == "unknown"
            else:
                assert float(row[place]) == pytest.approx(100.0 * known, rel=0.05)


def test_a_run_that_has_no_page_says_so() -> None:
    with pytest.raises(ValueError, match="simulate it again"):
        xr.Dataset().drive.summary()


def test_the_verdict_is_seen_in_a_notebook(monkeypatch: pytest.MonkeyPatch) -> None:
    class Formatter:
        def for_type(self, kind: type, shown: object) -> None:
            self.shown = shown

    formatter = Formatter()

    class Shell:
        display_formatter = type("Display", (), {"formatters": {"text/html": formatter}})

    class IPython:
        get_ipython = staticmethod(Shell)

    monkeypatch.setitem(__import__("sys").modules, "IPython", IPython)
    run = cd.simulate(cd.scenes.spinning_ring(), until=2e-3, error=False)
    assert "Verdict: caution" in formatter.shown(run)
    assert "Verdict" not in formatter.shown(xr.Dataset())
    # Defect: a `JSONDecodeError` of a notebook that shows a store with a damaged page.
    damaged = run.assign_attrs(page="{")
    assert "Verdict" not in formatter.shown(damaged)
    with pytest.raises(ValueError, match="the page of this run is damaged"):
        damaged.drive.summary()


WORN = {"kind": "sprocket", "name": "driven", "direction": [1, 0], "within": "30 mm"}


@pytest.mark.parametrize(
    ("drive", "told"),
    [
        (cd.scenes.bicycle_derailleur, "torsion-spring, preload -0.8 N m."),
        (cd.scenes.two_stage_timing, "Pretension of primary 200 N. Pretension of secondary 200 N."),
        (
            lambda: cd.scenes.industrial_16b().replace(
                {"sprockets.driven.load": [{"kind": "resistance", "quadratic": 13}]}
            ),
            "load resistance, linear 0 N m s, quadratic 13 N m s².",
        ),
        # The taut chain, 1 % longer, puts the sprocket 10 mm beyond the centre of the scene.
        (lambda: cd.analysis.worn(cd.scenes.industrial_16b(), 0.01, take_up=WORN), "1040.2, 0.0"),
    ],
    ids=["moment", "chains", "resistance", "centre"],
)
def test_the_first_page_tells_what_was_simulated(drive: Callable[[], cd.Drive], told: str) -> None:
    """Defect: a preload in N, no pretension, no number, and the centre before it was moved."""
    run = cd.simulate(drive(), until=1e-4, run_in=0, method="auto", error=False)
    assert told in front_page(run, run.drive.summary())


def test_a_report_is_one_file_that_asks_for_nothing(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    drive = cd.scenes.industrial_16b()
    settings = {"until": 0.04, "run_in": "50 ms", "error": False}
    run = cd.simulate(drive, record="all", events=["teeth"], **settings)
    place = tmp_path / "report.html"
    text = cd.report(run, place)
    assert place.read_text(encoding="utf-8") == text
    assert len(text.encode()) < 2e6
    assert not re.search(r'(src|href)="(?!data:|#)', text.split("<iframe")[0])
    inputs = ("sprockets[1].inertia", "sprockets[1].load[0].torque", "assumed")
    for wanted in (*inputs, "Verdict: ", "Losses", "title = ", run.attrs["chaindrive_build"]):
        assert wanted in text, wanted
    front = text.partition('<section class="front">')[2].partition("</section>")[0]
    titles = re.findall(r"<h2>(.*?)</h2>", front)
    assert titles == ["Drive", "Load case", "Verdicts", "Six numbers", "Limits"]
    # It comes first, on a sheet of its own, with six numbers that attributes have as well.
    assert text.index('<section class="front">') < text.index("<figure>")
    assert ".front { break-after: page; }" in text
    numbers = front.partition("Six numbers")[2].partition("</table>")[0]
    cells = re.findall(r"<td[^>]*>(.*?)</td>", numbers)
    told = dict(zip(cells[::3], cells[1::3], strict=True))
    assert list(told) == [
        "efficiency",
        "maximum link tension",
        "static safety factor",
        "greatest shaft load",
        "bearing pressure",
        "speed irregularity",
    ]
    known = {
        "maximum link tension": run.attrs["link_tension_greatest"],
        "static safety factor": run.attrs["static_safety"],
        "bearing pressure": 1e-6 * run.attrs["bearing_pressure"],
        "efficiency": 100.0 * run.attrs["efficiency"],
    }
    for name, value in known.items():
        number = float(told[name].split()[0]) * (1e3 if "kN" in told[name] else 1.0)
        assert number == pytest.approx(value, rel=1e-3), name
    for wanted in (
        "16B-1, 120 links of 25.4 mm",
        "motion constant, speed 300 rpm",
        "On the chain: ",
    ):
        assert wanted in front, wanted
    # What was not recorded is said in its place.
    bare = cd.report(cd.simulate(drive, record=["span_tension"], **settings))
    assert "link_tension" in bare
    assert "<iframe" not in bare
