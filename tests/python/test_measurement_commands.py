"""Verbs of the command that this package does; their answers are of the form of their schema."""

import json
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import jsonschema
import matplotlib as mpl
import numpy as np
import pandas as pd
import pytest

mpl.use("Agg")

import chaindrive as cd
from chaindrive import _core
from chaindrive.measurement.command import command

SCHEMAS = Path(__file__).resolve().parents[2] / "crates" / "cli" / "schemas"
LOAD = "sprockets.driven.load[0].torque"


def closed(schema: Any) -> Any:
    """The schema, refusing keys that it does not name."""
    if isinstance(schema, dict):
        schema = {key: closed(value) for key, value in schema.items()}
        if "properties" in schema:
            schema.setdefault("additionalProperties", False)
        return schema
    return [closed(it) for it in schema] if isinstance(schema, list) else schema


def done(*arguments: str) -> int:
    """Do what a command line asks, in this process."""
    asked = _core._of_measurement(["chaindrive", *arguments])
    assert asked is not None, "the command line is wrong"
    return command(asked[0], json.loads(asked[1]))


def answer(capsys: pytest.CaptureFixture[str], *arguments: str) -> Any:
    assert done(*arguments, "--json") == 0, capsys.readouterr().err
    document = json.loads(capsys.readouterr().out)
    text = (SCHEMAS / f"{arguments[0]}.schema.json").read_text(encoding="utf-8")
    jsonschema.validate(document, closed(json.loads(text)))
    return document


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A scene, a record of it that is a run with noise, and what its channels are."""
    folder = tmp_path_factory.mktemp("rig")
    # At twice its speed a record of as many turns takes half the time.
    settings = {"run.run_in": "10 ms", "run.until": "25 ms"}
    fast = {"sprockets.driver.motion.speed": "600 rpm"}
    drive = cd.scenes.industrial_16b().replace(settings | fast)
    (folder / "drive.toml").write_text(drive.text, encoding="utf-8")
    true = drive.replace({LOAD: -1400.0, "route.phase": 0.37})
    exact = {"until": 0.05, "every": 2e-4, "step": 6e-6, "method": "verlet", "error": False}
    run = cd.simulate(true, record=["span_tension"], **exact).isel(time=slice(0, -1))
    noise = np.random.default_rng(5).standard_normal(run.sizes["time"])
    strand = run["span_tension"][:, 1] + 5.0 * noise
    table = pd.DataFrame({"time [s]": run["time"], "strand [N]": strand})
    table.to_csv(folder / "rig.csv", index=False)
    (folder / "rig.toml").write_text(
        '[turns]\ndriver = "600 rpm"\n[channels]\nstrand = "span_tension[driven-driver]"\n',
        encoding="utf-8",
    )
    return folder


@pytest.fixture
def place(folder: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(folder)
    return folder


RIG = ["drive.toml", "rig.csv", "--rig", "rig.toml"]
FREE = ["--free", f"{LOAD}=-1600 N m..-1300 N m"]


def test_a_measurement_is_checked_and_compared(
    place: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    checked = answer(capsys, "check-data", *RIG, *FREE)
    assert checked["identified"]
    assert checked["channels"][0]["quantity"] == "span_tension[driven-driver]"
    compared = answer(capsys, "compare", *RIG)
    assert compared["quantities"][0]["statistics"][0]["statistic"] == "mean"


@pytest.mark.costs("a fit is some twenty runs")
def test_a_fit_is_printed_and_foretells_from_its_print(
    place: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    fit = answer(
        capsys,
        *("calibrate", *RIG, *FREE, "--starts", "1", "--store", "runs"),
        *("--prior", f"{LOAD}=-1400 N m±50 N m", "-o", "fit.html", "-o", "best.toml"),
    )
    assert fit["verdict"] == "calibrated"
    (load,) = fit["parameters"]
    assert load["lower"] < -1400.0 < load["upper"]
    assert cd.load(place / "best.toml").text == fit["scene"]
    assert "Parameters between their bounds" in (place / "fit.html").read_text(encoding="utf-8")
    # Nothing is computed twice, and nothing is written over.
    again = ["calibrate", *RIG, *FREE, "--starts", "1", "--store", "runs"]
    again += ["--prior", f"{LOAD}=-1400 N m±50 N m"]
    assert answer(capsys, *again)["computed"] == 0
    assert done(*again, "-o", "fit.html") == 3
    capsys.readouterr()

    (place / "fit.json").write_text(json.dumps(fit), encoding="utf-8")
    of = ["--of", "span_tension_mean[driven-driver]", "--until", "0.025"]
    at = ["--at", "sprockets.driver.motion.speed=400 rpm"]
    (row,) = answer(capsys, "predict", "fit.json", *of, *at)["outputs"]
    assert row["lower"] < row["value"] < row["upper"]
    assert list(row["sensitivity"]) == [LOAD]
    far = ["--at", "sprockets.driver.motion.speed=4000 rpm"]
    assert done("predict", "fit.json", *of, *far) == 2
    assert "out of reach" in capsys.readouterr().err
    assert done("predict", "rig.toml") == 2
    assert "is no fit" in capsys.readouterr().err


def test_assumptions_are_drawn_and_ranked(place: Path, capsys: pytest.CaptureFixture[str]) -> None:
    few = ["--until", "1 ms", "--of", "contact_force_p99", "--of", "loss_share"]
    load = f"{LOAD}=-1500 N m..-1300 N m"
    ranked = answer(
        capsys, "tornado", "drive.toml", "--range", load, *few, "-o", "rank.svg", "--jobs", "1"
    )
    assert [it["output"] for it in ranked["outputs"]] == ["contact_force_p99", "loss_share"]
    assert ranked["outputs"][0]["assumptions"][0]["assumption"] == LOAD
    assert (place / "rank.svg").read_text(encoding="utf-8").startswith("<?xml")
    spread = answer(
        capsys,
        *("uncertainty", "drive.toml", "--draw", load, "--samples", "8", "--seed", "2"),
        *("--draw", "route.pretension=normal(1.5 kN, 50 N)", *few, "-o", "spread.png"),
    )
    assert spread["variants"] == 8 * 5
    names = [it["parameter"] for it in spread["outputs"][0]["parameters"]]
    assert names == [LOAD, "route.pretension", "route.phase"]
    assert (place / "spread.png").read_bytes().startswith(b"\x89PNG")


def test_what_to_measure_next_is_told(place: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The channels of a rig file beside a quantity, at two operating points of one name each."""
    # Three pitches at 300 rpm: less tells nothing.
    lengths = ["--until", "36 ms", "--record", "1 s", "--rate", "2 kHz"]
    slow = ["--excitation", "slow:sprockets.driver.motion.speed=300 rpm"]
    told = answer(
        capsys,
        *("next-measurement", "drive.toml", *FREE, "--rig", "rig.toml", *lengths, *slow),
        *("--candidate", "sprocket_torque[driver]", "--settle", LOAD),
    )
    (target,) = told["targets"]
    assert target["target"] == LOAD
    assert {(it["candidate"], it["excitation"]) for it in told["candidates"]} == {
        ("strand", "slow"),
        ("sprocket_torque[driver]", "slow"),
    }
    best = told["candidates"][0]
    assert best["candidate"] == told["best_candidate"]
    assert best["after"][LOAD] < 0.2 * target["before"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["next-measurement", "drive.toml", *FREE], "no candidate is given"),
        (
            ["next-measurement", "drive.toml", *FREE, "--excitation", "chain.mass=3 kg"],
            "no name and what belongs to it",
        ),
        (["tornado", "drive.toml", "--range", "chain.mass=3 kg"], "no path and two bounds"),
        (["tornado", "drive.toml", "--range", "3 kg..4 kg"], "no path and what belongs to it"),
        (["tornado", "drive.toml", "--range", "chain.mass=2..3", "-o", "x.txt"], "must end in"),
        (["tornado", "drive.toml", "--range", "chain.mass=2..3 kg"], "give 2 its unit too"),
        (["compare", "drive.toml", "rig.csv"], "no channel corresponds"),
        (["compare", "drive.toml", "rig.csv", "--rig", "no.toml"], "no.toml: No such file"),
        (["uncertainty", "drive.toml", "--draw", "chain.mass=gauss(1, 2)"], "no distribution"),
        (["calibrate", *RIG, *FREE, "--prior", f"{LOAD}=3"], "no mean and standard deviation"),
        (["predict", "none.json"], "none.json"),
    ],
)
def test_a_wrong_argument_is_told(
    arguments: list[str], words: str, place: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert done(*arguments) == 2
    assert words in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_what_ctrl_c_stops_is_kept_where_there_is_a_store(place: Path) -> None:
    import signal

    verb = ["uncertainty", "drive.toml", "--draw", f"{LOAD}=-1500..-1300", "--samples", "1024"]
    more = ["--until", "1 ms", "--store", "parts"]
    whole = [sys.executable, "-m", "chaindrive", *verb, *more]
    with subprocess.Popen(whole, stderr=subprocess.PIPE, text=True) as process:
        while not list(place.glob("parts/*.npz")) and process.poll() is None:
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        assert process.stderr is not None
        told = process.stderr.read()
    assert process.returncode == 130
    assert "parts holds what was computed: the same command goes on" in told
    assert list(place.glob("parts/*.npz"))
