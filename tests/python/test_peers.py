"""The programs beside which chaindrive is measured still run, and agree with it."""

import importlib.util
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

FOLDER = Path(__file__).resolve().parents[2] / "benchmarks" / "peers"


@pytest.fixture
def peers(monkeypatch):
    """Put the folder of the benchmark on the path, and take it off with what was imported."""
    monkeypatch.syspath_prepend(str(FOLDER))
    before = set(sys.modules)
    yield
    for name in set(sys.modules) - before:
        file = getattr(sys.modules[name], "__file__", None) or ""
        if Path(file).parent == FOLDER:
            del sys.modules[name]


def test_drive_json_is_current(peers):
    """The numbers that the other programs read are those of the preset of today."""
    import drive_data
    import measure

    def same(ours, theirs):
        assert type(ours) is type(theirs)
        if isinstance(ours, dict):
            assert ours.keys() == theirs.keys()
            for key in ours:
                same(ours[key], theirs[key])
        elif isinstance(ours, list) and ours and not isinstance(ours[0], dict):
            np.testing.assert_allclose(ours, theirs, rtol=1e-6, atol=1e-6)
        elif isinstance(ours, list):
            for pair in zip(ours, theirs, strict=True):
                same(*pair)
        elif isinstance(ours, float):
            assert ours == pytest.approx(theirs, rel=1e-9, abs=1e-9)
        else:
            assert ours == theirs

    same(drive_data.numbers(), measure.load())


@pytest.mark.slow
def test_chaindrive_moves_as_the_numba_program(peers):
    """Same model, same method, other code: the tensions agree to rounding, as far as chaos lets.

    The method is RK4: chaindrive's Verlet takes the damping of teeth at the end of its step, and
    the other program does not.
    """
    pytest.importorskip("numba")
    import measure
    import with_chaindrive
    import with_numba

    drive = measure.load()
    ours = with_chaindrive.run("rk4", 5e-6, 0.01)
    theirs = with_numba.run(drive, "rk4", 5e-6, 0.01)
    mean = float(ours.tension.mean())
    assert np.abs(ours.tension - theirs.tension)[:-1].max() < 1e-7 * mean
    # Not because nothing happens: the transient moves the tension by tens of per cent.
    assert ours.tension.std() > 0.1 * mean


def test_readme_shows_the_results_on_file(peers):
    import compare

    results = json.loads(compare.RESULTS.read_text(encoding="utf-8"))
    page = (FOLDER / "README.md").read_text(encoding="utf-8")
    assert compare.account(results) in page
    assert page.splitlines()[2] == compare.dated(results["machine"])


def test_comparison_runs():
    """Every script, once."""
    if importlib.util.find_spec("numba") is None or importlib.util.find_spec("exudyn") is None:
        pytest.skip("needs benchmarks/peers/requirements.txt")
    command = [sys.executable, str(FOLDER / "compare.py"), "--quick"]
    run = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
    assert run.returncode == 0, run.stderr
    for program in ["chaindrive", "numba", "scipy", "exudyn"]:
        assert f"| {program} |" in run.stdout
    assert "times the CPU time of chaindrive" in run.stdout
