"""What the tutorial on published measurements foretells, and the table that it reads."""

import csv
from typing import Any

import numpy as np
import published
import pytest

import chaindrive as cd


@pytest.fixture(scope="module")
def told() -> dict[str, Any]:
    """Names of the tutorial, without the run that it shows."""
    return published.page()


def table() -> list[dict[str, str]]:
    with published.LOSSES.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_numbers_are_foretold_with_their_intervals(told: dict[str, Any]) -> None:
    """What is common cancels: intervals are at most a tenth where both spans are tense."""
    expected = {
        ("M17", "both"): (1.876, 0.047),
        ("M17", "one"): (1.561, 0.248),
        ("M18 new", "both"): (6.781, 0.055),
        ("M18 rise", "both"): (-0.934, 0.044),
    }
    assert told["foretold"].keys() == expected.keys()
    for name, (found, width) in told["foretold"].items():
        number, half = expected[name]
        assert found == pytest.approx(number, abs=0.005), name
        assert width == pytest.approx(half, abs=0.003), name
        if name[1] == "both":
            assert width <= 0.1 * abs(found), name


def test_one_product_is_fitted_and_does_not_tell_the_hypotheses_apart(told: dict[str, Any]) -> None:
    for spans, number in (("both", 0.229), ("one", 0.315)):
        found, width = told["foretell"](1e3 * told["product"], spans)
        assert found == pytest.approx(number, abs=0.002)
        assert 1e3 * told["low"] < found - width < found + width < 1e3 * told["high"]
    # Only the product counts: over draws of its three factors the loss is a straight line.
    loss = told["column"]("M01", "both")
    assert np.corrcoef(told["product"], loss)[0, 1] > 0.999


def test_trends_of_a_racer_agree(told: dict[str, Any]) -> None:
    assert told["sprockets"].all()
    assert told["rings"].all()


def test_the_table_is_of_the_inputs_that_are_stated() -> None:
    given = published.inputs()
    common, _ = published.drawn(given, len(published.cases(cd.load(published.SCENE))))
    for row in table():
        draw = int(row["draw"])
        for path, values in common.items():
            cell = row[path.rsplit(".", 1)[-1]]
            assert not cell or float(cell) == pytest.approx(values[draw], abs=1e-4 * values[draw])


@pytest.mark.slow
def test_the_table_is_what_the_program_computes() -> None:
    for now, kept in zip(published.runs(), table(), strict=True):
        name = f"{kept['case']}, {kept['spans']}, draw {kept['draw']}, {kept['step']}"
        assert now.keys() == kept.keys()
        assert float(now["loss"]) == pytest.approx(float(kept["loss"]), rel=5e-3), name
