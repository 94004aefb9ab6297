"""Parameters fitted to records that are made of runs, so that what is true is known."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import chaindrive as cd

CHANNELS = ["span_tension", "sprocket_torque", "sprocket_angle"]
LOAD = "sprockets.driven.load[0].torque"
GAIN = "sensors.torque.gain"
#: What the record is made with: 2 % too much on the flange, and less load than the drive states.
TRUTH = {LOAD: -1400.0, GAIN: 1.02}
FREE = {LOAD: (-1600.0, -1300.0), GAIN: (0.9, 1.1)}


def drive() -> cd.Drive:
    return cd.scenes.industrial_16b().replace({"run.run_in": "50 ms"})


@pytest.fixture(scope="module")
def data() -> xr.Dataset:
    """Another step, phase, run-in and sampling than the fit has, and noise."""
    true = drive().replace({"route.phase": 0.37, LOAD: TRUTH[LOAD]})
    settings = {"until": 0.2, "every": 4e-4, "step": 6e-6, "method": "verlet"}
    run = cd.simulate(true, record=CHANNELS, error=False, run_in=0.06, **settings)
    run = run.isel(time=slice(0, -1))
    noise = np.random.default_rng(57).standard_normal((2, run.sizes["time"]))
    table = pd.DataFrame(
        {
            "time [s]": run["time"],
            "strand [N]": run["span_tension"][:, 1] + 5.0 * noise[0],
            "torque [Nm]": TRUTH[GAIN] * run["sprocket_torque"][:, 0] + 0.5 * noise[1],
        }
    )
    channels = {"strand": "span_tension[driven-driver]", "torque": "sprocket_torque[driver]"}
    return cd.measured(table, channels=channels, turns={"driver": "300 rpm"})


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("fit")


@pytest.fixture(scope="module")
def fit(data: xr.Dataset, store: Path) -> xr.Dataset:
    return cd.calibrate(drive(), data, FREE, store=store, starts=3)


@pytest.mark.costs("a fit is some twenty runs")
def test_known_parameters_are_recovered(fit: xr.Dataset) -> None:
    assert fit.attrs["verdict"] == "calibrated", fit.attrs["summary"]
    for path, value in TRUTH.items():
        row = fit.sel(parameter=path)
        assert float(row["lower"]) < value < float(row["upper"])
    assert float(fit.sel(parameter=LOAD)["error"]) < 10.0
    assert float(fit.sel(parameter=GAIN)["error"]) < 0.01
    # The drive's own values are outside of the intervals.
    assert float(fit.sel(parameter=LOAD)["lower"]) > -1433.0
    assert float(fit.sel(parameter=GAIN)["lower"]) > 1.0
    assert fit.attrs["validation"] == "holds"
    assert (abs(fit["residual"]) < 3.0).all()


@pytest.mark.costs("a fit is some twenty runs")
def test_the_best_drive_says_where_its_numbers_are_from(fit: xr.Dataset) -> None:
    best = cd.load(fit)
    assert {it.path for it in cd.diff(drive(), best)} == {LOAD}
    (line,) = [it for it in best.text.splitlines() if "fitted" in it]
    assert "# fitted: ± " in line
    assert "at 95 %, to DataFrame" in line
    assert (
        float(fit.sel(parameter=LOAD)["estimate"])
        == best.to_dict()["sprockets"][1]["load"][0]["torque"]
    )


@pytest.mark.costs("a fit is some twenty runs")
def test_a_resumed_fit_computes_nothing_twice(
    fit: xr.Dataset, data: xr.Dataset, store: Path
) -> None:
    """Killed when half of its runs were there: the same bits, and those that lack are computed."""
    files = sorted(store.iterdir(), key=lambda it: it.stat().st_mtime_ns)
    assert len(files) == fit.attrs["computed"] > 10
    late = files[-4:]
    for file in late:
        file.unlink()
    again = cd.calibrate(drive(), data, FREE, store=store, starts=3, jobs=1)
    assert again.attrs["computed"] == len(late)
    xr.testing.assert_identical(again.drop_attrs(deep=False), fit.drop_attrs(deep=False))
    assert again.attrs["scene"] == fit.attrs["scene"]


@pytest.mark.parametrize(
    ("free", "words"),
    [
        # What the mean is shifted by, and by how much in the middle of the record, are the same.
        (
            {"sensors.torque.bias": (-50.0, 50.0), "sensors.torque.drift": (-500.0, 500.0)},
            "not identifiable: nothing seen changes with sensors.torque.bias",
        ),
        ({"sensors.torque.delay": (0.0, 1e-6)}, "sensors.torque.delay moves nothing"),
        ({GAIN: (0.7, 0.9)}, "sensors.torque.gain ends at its upper bound, 0.9"),
        # The load is wrong, which a gain of the flange does not explain in the strand.
        ({GAIN: (0.5, 1.5)}, r"physics are missing: .* most is left in strand mean"),
    ],
    ids=["pair", "silent", "bound", "physics"],
)
def test_a_fit_is_refused_with_a_reason(
    free: dict[str, tuple[float, float]], words: str, data: xr.Dataset, store: Path
) -> None:
    with pytest.warns(cd.MeasurementWarning, match=words):
        found = cd.calibrate(drive(), data, free, store=store, starts=3)
    assert found.attrs["verdict"] == "refused"
    with pytest.raises(cd.SceneError, match="carries no scene"):
        cd.load(found)


def test_what_is_not_an_argument_is_told(data: xr.Dataset) -> None:
    for arguments, words in (
        ({"loss": "least"}, "must be one of linear"),
        ({"validation": 1.0}, r"must be in \[0, 0.9\)"),
        ({"starts": 0}, "at least 1"),
        ({"priors": {"chain.mass": (1.0, 0.1)}}, "it is not free"),
    ):
        with pytest.raises(cd.MeasurementError, match=words):
            cd.calibrate(drive(), data, FREE, until=0.01, **arguments)
