"""Work-precision studies: orders of the methods, failures, the diagram."""

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


def test_steps_without_methods_are_refused():
    with pytest.raises(cd.ParameterError, match="belong to methods"):
        cd.work_precision(cd.scenes.spinning_ring(), steps=[1e-5])
    with pytest.raises(cd.ParameterError, match="repeats"):
        cd.work_precision(cd.scenes.spinning_ring(), repeats=0)
