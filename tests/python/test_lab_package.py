"""The package for browsers and Node against the core that Python has: equal to rounding."""

import json
import os
import random
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import chaindrive as cd

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "target" / "lab" / "package"
NODE = shutil.which("node")

pytestmark = [
    pytest.mark.skipif(NODE is None, reason="Node is missing"),
    pytest.mark.skipif(not PACKAGE.exists(), reason="`make lab` builds the package"),
]

#: Steps, unless a preset comes to 5 ms before that.
STEPS, LONGEST = 1000, 5e-3

PRESETS = [name for name in cd.scenes.__all__ if name != "presets"]

#: What the core does natively, on the registers that the environment asks for.
NATIVE = """
import json, sys
import chaindrive as cd
answers = []
for text, steps in json.load(sys.stdin):
    moving = cd.Simulation(cd.Drive.from_toml(text), run_in=0)
    names = ["roller_x", "roller_y", "energy_kinetic", "energy_supplied", "energy_residual"]
    read = lambda: [float(x) for name in names for x in moving[name].values.ravel()]
    start = read()
    moving.advance(steps)
    answers.append([start, read(), moving.time])
json.dump(answers, sys.stdout)
"""


def in_node(*requests: tuple[str, dict[str, Any]]) -> list[Any]:
    """What the package answers to requests."""
    program = ROOT / "tests" / "lab" / "package.mjs"
    done = subprocess.run(
        [NODE, program, (PACKAGE / "node.js").as_uri()],
        input=json.dumps(requests),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def natively(asked: list[tuple[str, int]], registers: str | None) -> list[Any]:
    """Start, end and time there of scenes after some steps, in a process of its own."""
    environment = dict(os.environ)
    environment.pop("CHAINDRIVE_INSTRUCTION_SET", None)
    if registers:
        environment["CHAINDRIVE_INSTRUCTION_SET"] = registers
    done = subprocess.run(
        [sys.executable, "-c", NATIVE],
        input=json.dumps(asked),
        capture_output=True,
        text=True,
        check=True,
        env=environment,
    )
    return json.loads(done.stdout)


def given(name: str) -> tuple[str, int, float]:
    """Text of a preset with method and step written down, steps to take, and its pitch."""
    drive = getattr(cd.scenes, name)()
    cost = drive.describe()["cost"]
    method, step = cost["method"].lower().replace(" ", "-"), float(cost["step"])
    full = drive.resolved().to_dict()
    chain = full["chain"] if "chain" in full else full["chains"][0]
    written = drive.replace({"run.method": method, "run.step": step})
    return written.text, min(STEPS, int(LONGEST / step)), float(chain["pitch"])


@pytest.mark.costs("every preset is assembled three times, once of them in Node")
def test_every_preset_moves_as_it_does_natively() -> None:
    """SSE2 has two lanes and no product and sum in one, as the module; wider sets differ more."""
    names = PRESETS
    scenes = [given(name) for name in names]
    asked = [(text, steps) for text, steps, _ in scenes]
    found = in_node(*[("motion", {"text": text, "steps": steps}) for text, steps in asked])
    for registers, apart in (("sse2", 1e-11), (None, 1e-9)):
        for name, (_, _, pitch), own, (start, end, time) in zip(
            names, scenes, found, natively(asked, registers), strict=True
        ):
            energies = 3
            for one, other, limit in (
                (own["start"]["values"], start, 1e-10 * pitch),
                (own["end"]["values"], end, apart),
            ):
                off = np.abs(np.subtract(one, other))
                assert off[:-energies].max(initial=0.0) <= limit, (name, registers)
            assert own["end"]["time"] == pytest.approx(time, rel=1e-12), name
            # Both ledgers close alike: what is unaccounted for, over what moves and was supplied,
            # or as far as rounding of what weight and springs store goes.
            kinetic, supplied, residual = own["end"]["values"][-energies:]
            scale = max(kinetic, abs(supplied))
            assert abs(residual - end[-1]) <= 1e-6 * scale + 1e-12, (name, registers)


def spoilt(count: int) -> list[str]:
    """Texts of presets with a mistake each, drawn by lot."""
    lot = random.Random(58)
    texts = [getattr(cd.scenes, name)().text for name in PRESETS]
    changes = [
        lambda line: re.sub(r"\d+", "-7", line, count=1),
        lambda line: line.replace("=", "= 'many'", 1),
        lambda line: line.replace("mm", "rpm").replace(" N", " kg"),
        lambda line: "x" + line,
        lambda line: line + "\n" + line,
        lambda _: "",
        lambda line: line.replace('"', "", 1),
        lambda line: line + " \u00e9\u0007",
    ]
    found: list[str] = []
    while len(found) < count:
        lines = lot.choice(texts).splitlines()
        at = lot.randrange(len(lines))
        lines[at] = lot.choice(changes)(lines[at])
        text = "\n".join(lines)
        try:
            cd.Drive.from_toml(text)
        except cd.SceneError:
            found.append(text)
    return found


def test_wrong_scenes_are_refused_in_the_same_words() -> None:
    texts = spoilt(200)
    for text, answer in zip(
        texts, in_node(*[("problems", {"text": it}) for it in texts]), strict=True
    ):
        with pytest.raises(cd.SceneError) as native:
            cd.Drive.from_toml(text)
        assert answer["message"] == str(native.value)
        own = [(it.path, it.message, it.hint, it.line) for it in native.value.problems]
        keys = ("path", "message", "hint", "line")
        assert [tuple(it[key] for key in keys) for it in answer["problems"]] == own


def test_a_drive_at_rest_is_told_alike() -> None:
    drive = cd.scenes.timing_drive()
    (told,) = in_node(("told", {"text": drive.text}))
    full = cd.Drive.from_dict(told["resolved"])
    # One number of a resolved scene is searched for: where the shoe closes the links.
    assert {it.path for it in cd.diff(full, drive.resolved())} <= {"guides.shoe.face.bow"}
    native = str(drive.describe()).partition("\nrun\n")
    assert told["description"].partition("\nrun\n")[0] == native[0]
    assert told["layout"][0]["counts"]["even_above"] == 118
    assert told["svg"].startswith("<svg")


def test_a_snapshot_goes_on_to_the_last_bit() -> None:
    text = cd.scenes.marine_two_sprockets().text
    ((whole, rest),) = in_node(("snapshot", {"text": text, "steps": 200}))
    assert whole == rest


def test_a_run_is_judged() -> None:
    drive = cd.scenes.spinning_ring()
    (run,) = in_node(("run", {"text": drive.text, "until": 0.01}))
    native = cd.simulate(drive, until=0.01)
    assert run["attributes"]["verdict"] == native.attrs["verdict"]
    assert run["attributes"]["samples"] == native.sizes["time"]
    assert run["summary"].splitlines()[0] == native.attrs["summary"].splitlines()[0]
    assert run["seen"] == sorted(run["seen"])


def test_presets_chains_and_channels_are_those_of_the_program() -> None:
    (known,) = in_node(("known", {}))
    assert {it["name"] for it in known["presets"]} == set(PRESETS)
    assert {it["name"] for it in known["chains"]} == set(cd.catalogue()["chain"].values)
    assert {it["name"] for it in known["channels"]} == set(cd.channels())
    # As `cd.design` computes it, and a closed form confirms.
    assert known["centres"]["fits"][0]["centre_distance"] == pytest.approx(1.029929958, abs=1e-9)
