"""The command that comes with the package, and the example scripts."""

import os
import runpy
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest
import xarray as xr

ROOT = Path(__file__).resolve().parents[2]
COMMAND = Path(sysconfig.get_path("scripts")) / "chaindrive"


# Examples that draw the pictures of pages: a run-up of a minute, every diagram there is.
LONG = ["gallery", "run_up", "sweep_marine"]
# A picture of a browser, taken where one is at hand.
WITH_A_BROWSER = ["replay_picture"]
# What units of this one do is tested by test_coupling.py.
TESTED = ["coupled_units"]
SHORT = [
    pytest.param(script, marks=pytest.mark.slow if script.stem in TESTED else [], id=script.stem)
    for script in sorted((ROOT / "examples").glob("*.py"))
    if script.stem not in [*LONG, *WITH_A_BROWSER]
]


def run(*arguments, timeout=300, **settings):
    return subprocess.run(
        [str(argument) for argument in arguments],
        capture_output=True,
        text=True,
        timeout=timeout,
        check=False,
        **settings,
    )


@pytest.mark.parametrize("command", [[COMMAND], [sys.executable, "-m", "chaindrive"]])
def test_help_and_version(command):
    told = run(*command, "--version")
    assert told.returncode == 0
    assert told.stdout.startswith("chaindrive ")
    assert "run" in run(*command, "--help").stdout


def test_shells_are_told_of_the_command(tmp_path):
    told = run(COMMAND, "completion", "bash")
    assert told.returncode == 0
    assert "_chaindrive()" in told.stdout
    assert "span_tension" in told.stdout
    assert run(COMMAND, "man", tmp_path / "man1").returncode == 0
    assert ".TH chaindrive" in (tmp_path / "man1" / "chaindrive.1").read_text(encoding="utf-8")


def test_check_and_its_exit_codes():
    assert run(COMMAND, "check", "spinning_ring").returncode == 0
    wrong = run(COMMAND, "check", "spining_ring")
    assert wrong.returncode != 0
    assert "spinning_ring" in wrong.stderr


def test_run_writes_a_store(tmp_path):
    pytest.importorskip("zarr")
    store = tmp_path / "ring.zarr"
    done = run(COMMAND, "run", "spinning_ring", "--until", "2 ms", "--output", store)
    assert done.returncode == 0, done.stderr
    assert xr.open_zarr(store, chunks=None).sizes["time"] > 1


@pytest.mark.slow
@pytest.mark.parametrize("name", LONG)
def test_long_examples_run(name, tmp_path):
    environment = os.environ | {"MPLBACKEND": "Agg"}
    script = ROOT / "examples" / f"{name}.py"
    done = run(sys.executable, script, "--results", tmp_path, env=environment, timeout=1800)
    assert done.returncode == 0, done.stderr
    assert list(tmp_path.glob("*.png"))


@pytest.mark.parametrize("script", SHORT)
def test_examples_run(script, tmp_path, monkeypatch):
    """In this process: what a script imports is imported once."""
    plt = pytest.importorskip("matplotlib.pyplot")
    text = script.read_text(encoding="utf-8")
    short = {"--until": "0.01", "--rounds": "1"}
    options = [
        word for option, value in short.items() if option in text for word in (option, value)
    ]
    monkeypatch.setattr(sys, "argv", [str(script), *options, "--results", str(tmp_path)])
    monkeypatch.chdir(tmp_path)
    plt.switch_backend("Agg")
    runpy.run_path(str(script), run_name="__main__")
    plt.close("all")
    assert (tmp_path / f"{script.stem}.png").stat().st_size > 10_000
