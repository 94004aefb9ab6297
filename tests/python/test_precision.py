"""Work-precision studies: orders of the methods, failures, the diagram."""

import subprocess
import sys

import matplotlib

matplotlib.use("Agg")

import numpy as np
import pytest

import chaindrive as cd


@pytest.fixture(scope="module")
def table():
    return cd.work_precision(
        cd.scenes.spinning_ring(),
        methods=["verlet", "rk4", "implicit-damping"],
        steps=[8e-5, 4e-5],
        until=5e-3,
        repeats=1,
        replicates=1,
    )


def test_verlet_is_of_second_and_runge_kutta_of_fourth_order(table):
    error = table["error_span_tension"].values
    assert error[0] / error[1] == pytest.approx(4.0, rel=0.1)
    assert error[2] / error[3] == pytest.approx(16.0, rel=0.2)


def test_the_columns_explain_themselves(table):
    assert list(table["method"].values[:3]) == ["verlet", "verlet", "rk4"]
    assert np.all(table["evaluations"].values[2:4] > table["evaluations"].values[:2])
    assert table["wall"].attrs["units"] == "s"
    assert np.all(table["wall"].values[:4] > 0.0)
    assert table.attrs["agreement_tension"] < 1e-3 * table["error_span_tension"].values[0]
    assert "dormand-prince" in table.attrs["check"]
    assert "reference" in table.attrs["summary"]


def test_a_method_that_does_not_suit_keeps_its_row(table):
    assert "choose verlet" in str(table["remark"].values[4])
    assert np.isnan(table["wall"].values[4])


def test_the_diagram_has_a_line_a_method(table):
    axes = cd.plot.work_precision(table)
    labels = [text.get_text() for text in axes.get_legend().get_texts()]
    assert labels[:2] == ["verlet", "rk4"]
    assert axes.get_xscale() == axes.get_yscale() == "log"


@pytest.mark.costs("two interpreters load what draws")
def test_the_command_draws_the_diagram_of_its_table(tmp_path):
    short = ["--until", "5 ms", "--methods", "verlet,rk4", "--repeats", "1", "-o", "bench"]
    whole = [sys.executable, "-m", "chaindrive", "bench", "spinning_ring", *short]
    done = subprocess.run(whole, capture_output=True, text=True, cwd=tmp_path, check=False)
    assert done.returncode == 0, done.stderr
    drawn = (tmp_path / "bench.svg").read_text("utf-8")
    for words in ("verlet", "rk4", "wall time [s]", "reference and check apart"):
        assert f"<!-- {words} -->" in drawn
    (tmp_path / "bench.csv").unlink()
    done = subprocess.run(whole, capture_output=True, text=True, cwd=tmp_path, check=False)
    assert (done.returncode, done.stdout) == (3, "")
    assert "bench.svg: there is already a file here" in done.stderr


def test_a_run_in_is_carried_out_before():
    drive = cd.scenes.marine_two_sprockets()
    settings = {"methods": "verlet", "steps": [1e-5], "until": 4e-3, "repeats": 1, "replicates": 1}
    at_once = cd.work_precision(drive, **settings).attrs
    after = cd.work_precision(drive.replace({"run.run_in": 0.02}), **settings).attrs
    run = cd.simulate(
        drive, run_in=0.02, until=4e-3, every=1e-5, record="span_tension", method="verlet"
    )
    mean = float(run["span_tension"].mean())
    assert "run_in" not in at_once
    assert after["run_in"] == 0.02
    assert "was run in for" in after["summary"]
    assert after["mean_tension"] == pytest.approx(mean, rel=1e-3)
    assert at_once["mean_tension"] != pytest.approx(mean, rel=1e-2)


def test_steps_without_methods_are_refused():
    with pytest.raises(cd.ParameterError, match="belong to methods"):
        cd.work_precision(cd.scenes.spinning_ring(), steps=[1e-5])
    with pytest.raises(cd.ParameterError, match="repeats"):
        cd.work_precision(cd.scenes.spinning_ring(), repeats=0)


@pytest.mark.parametrize(
    ("settings", "error", "words"),
    [
        ({"methods": "verlet", "steps": [1e-6, 0.0]}, cd.ParameterError, "step = 0, must be posit"),
        ({"methods": "verlet", "steps": [np.nan]}, cd.ParameterError, "step = NaN"),
        ({"methods": "verlet", "steps": [1e-300]}, cd.ParameterError, "step = 1e-300, must be at"),
        ({"methods": "verlet", "steps": ["1 kg"]}, cd.SceneError, "run.step"),
        ({"methods": "verlet", "onset_depth": -1.0}, cd.ParameterError, "onset_depth = -1"),
        ({"methods": "dormand-prince", "tolerances": [0.0]}, cd.ParameterError, "tolerance = 0"),
        ({"methods": "dormand-prince", "steps": [1e-6]}, cd.ParameterError, "none among"),
        ({"methods": "verlet", "tolerances": [1e-6]}, cd.ParameterError, "not among"),
        ({"until": "1 kg"}, cd.SceneError, "run.until"),
        ({"until": -1.0}, cd.ParameterError, "until = -1"),
        ({"repeats": -1}, cd.ParameterError, "repeats = -1, must be at least 1"),
        ({"replicates": 0}, cd.ParameterError, "replicates = 0"),
    ],
)
def test_what_is_out_of_range_is_refused_at_once(settings, error, words):
    with pytest.raises(error, match=words):
        cd.work_precision(cd.scenes.spinning_ring(), **settings)


def test_settings_are_texts_with_units_too():
    ring = cd.scenes.spinning_ring()
    texts = {"until": "2 ms", "every": "1 ms", "step": "10 us", "onset_depth": "1 um"}
    numbers = {"until": 2e-3, "every": 1e-3, "step": 1e-5, "onset_depth": 1e-6}
    one, other = (
        cd.simulate(ring, **settings, record="link_tension") for settings in (texts, numbers)
    )
    np.testing.assert_array_equal(one["link_tension"], other["link_tension"])
    assert one.attrs["step"] == 1e-5
    chosen = cd.simulate(ring, until="2 ms", every="1 ms", accuracy="0.1 %")
    assert chosen.attrs["accuracy"] == 1e-3
    with pytest.raises(cd.SceneError, match=r"run\.accuracy"):
        cd.simulate(ring, accuracy="1 mm")


@pytest.mark.parametrize("drive", ["marine_engine", None])
def test_what_is_not_a_drive_is_told_what_is(drive):
    calls = [cd.simulate, cd.work_precision, lambda drive: cd.sweep(drive, {"chain.links": [20]})]
    for call in calls:
        with pytest.raises(TypeError, match=r"chaindrive\.load"):
            call(drive)
