"""The valve drive in two stages as two units: errors of the cut, and an unstable exchange."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

import chaindrive as cd

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def example():
    place = ROOT / "examples" / "coupled_units.py"
    spec = importlib.util.spec_from_file_location("coupled_units", place)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def stages(example):
    return example.stages()


@pytest.fixture(scope="module")
def pair(example, stages, tmp_path_factory):
    return example.units(tmp_path_factory.mktemp("stages"), *stages[1:])


def test_the_error_of_a_cut_falls_with_the_step_by_its_order(example, stages, pair):
    """Held inputs: the first order. Extrapolated: the second, where the step resolves the chain."""
    settings = {"until": 2e-3, "every": 40e-6, "run_in": 0, "method": "verlet", "error": False}
    run = cd.simulate(stages[0], record="sprocket_speed", **settings)
    exact = run["sprocket_speed"].sel(sprocket="camshaft").values[1:]

    def off(way, step):
        courses, waits = example.WAYS[way]
        _, motion, _ = example.coupled(pair, step, 2e-3, courses, [example.FIRST], waits=waits)
        stride = round(40e-6 / step)
        return np.sqrt(np.mean((motion[stride - 1 :: stride, 0] - exact) ** 2))

    held = off("both at once, held", 10e-6), off("both at once, held", 2.5e-6)
    assert np.log(held[0] / held[1]) / np.log(4) == pytest.approx(1.0, abs=0.2)
    linear = off("both at once, linear", 2.5e-6), off("both at once, linear", 1e-6)
    assert np.log(linear[0] / linear[1]) / np.log(2.5) > 1.8
    # Whoever waits has the angle when it is due.
    assert off("one after the other, held", 10e-6) < 0.01 * held[0]


def test_an_unstable_exchange_makes_energy_and_says_so(example, pair):
    held = example.WAYS["both at once, held"][0]
    times, _, energy = example.coupled(pair, 320e-6, 0.02, held, [example.FIRST])
    # The intermediate shaft has ½ J ω² = 8 J; an exchange that resolves the chain misses less.
    assert energy[-1] < -1000.0
    assert np.all(np.diff(np.abs(energy[-5:])) > 0)
    assert times[-1] < 0.02
    _, _, fine = example.coupled(pair, 10e-6, 0.02, held, [example.FIRST])
    assert np.abs(fine).max() < 1.0


@pytest.mark.slow
def test_a_cut_drive_keeps_the_means_of_the_whole(example, stages, pair):
    """Within 0.1 % at 10 µs, where one stage waits for the other."""
    names, reference = example.means(stages[0], 0.04, 0.24)
    courses, waits = example.WAYS["one after the other, torque linear"]
    times, values, _ = example.coupled(pair, 10e-6, 0.24, courses, names, waits=waits)
    np.testing.assert_allclose(values[times >= 0.04].mean(axis=0), reference, rtol=1e-3)
