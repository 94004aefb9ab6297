"""Scenes from Python: in full, compared, and refused when they are beyond all bounds."""

import os
import subprocess
import sys

import pytest

import chaindrive as cd


def test_a_drive_in_full_is_the_same_drive() -> None:
    drive = cd.scenes.industrial_16b()
    full = drive.resolved()
    assert full.text.startswith('format = "0.3"\ndefaults = "0.3"\n')
    assert "poisson = 0.3 # assumed: steel on steel" in full.text
    assert cd.diff(drive, full) == []
    settings = {"until": 5e-4, "run_in": 0, "every": 1e-4, "error": False, "method": "verlet"}
    first, second = (cd.simulate(of, **settings) for of in (drive, full))
    assert first["span_tension"].identical(second["span_tension"])
    assert cd.diff(first, second) == []


def test_differences_are_named() -> None:
    ring = cd.scenes.spinning_ring()
    (difference,) = cd.diff(ring, ring.replace({"chain.links": 24}))
    assert difference == ("chain.links", "20", "24")
    run = cd.simulate(ring, until=1e-3, every=1e-4, error=False)
    assert [it.path for it in cd.diff(ring, run) if not it.path.startswith("run.")] == []
    with pytest.raises(cd.SceneError, match="carries no scene"):
        cd.diff(ring, run.drop_attrs())


@pytest.mark.parametrize("levels", [100, 15_000])
def test_deep_paths_are_refused(levels: int) -> None:
    ring = cd.scenes.spinning_ring()
    deep = "chain." + "a." * levels + "x"
    with pytest.raises(cd.SceneError, match="nested deeper"):
        ring.replace({deep: 1})
    with pytest.raises(cd.SceneError, match="nested deeper"):
        ring.replace({"sprockets" + "[0]" * levels: 1})
    with pytest.raises(cd.SceneError, match="nested deeper"):
        cd.Drive.from_toml(f"{deep} = 1")
    with pytest.raises(cd.ChaindriveError):
        cd.sweep(ring, {deep: [1, 2]}, until=1e-3)


def test_laws_have_the_names_of_scenes_and_take_underscores() -> None:
    parameters = {"static_coefficient": 0.15, "coefficient": 0.1, "slip_speed": 1e-3}
    for kind in ("brown-mcphee", "brown_mcphee"):
        assert cd.friction(kind, **parameters).parameters["kind"] == "brown-mcphee"
    power = {"stiffness": 1e9, "exponent": 1.5, "restitution": 0.7}
    for name in ("hunt-crossley", "hunt_crossley"):
        law = cd.law("power", **power, dissipation=name)
        assert law.parameters["dissipation"]["kind"] == "hunt-crossley"


@pytest.mark.skipif(os.name == "nt", reason="arguments are bytes on POSIX only")
def test_arguments_that_are_no_text_are_refused_without_a_traceback() -> None:
    command = [sys.executable.encode(), b"-m", b"chaindrive", b"check", b"\xff\xfe.toml"]
    done = subprocess.run(command, capture_output=True, check=False)
    assert done.returncode == 2
    assert b"Traceback" not in done.stderr
    assert b"invalid UTF-8" in done.stderr


def test_standard_input_is_bounded() -> None:
    command = [sys.executable, "-m", "chaindrive", "check", "-"]
    done = subprocess.run(command, input=b"#" * (17 << 20), capture_output=True, check=False)
    assert done.returncode == 2
    assert b"larger than 16 MiB" in done.stderr


def test_statics_are_read_without_a_run(monkeypatch: pytest.MonkeyPatch) -> None:
    def describe(_: cd.Drive) -> None:
        raise AssertionError("a description takes hundreds of steps")

    monkeypatch.setattr(cd.Drive, "describe", describe)
    statics = cd.scenes.marine_engine().statics()
    assert statics["span_tension"].sizes["span"] == 4


def test_a_recording_beyond_all_memory_is_refused() -> None:
    drive = cd.scenes.industrial_16b()
    with pytest.raises(cd.ParameterError, match=r"GB, more than the memory holds"):
        cd.simulate(drive, until=900.0, every=1e-6, method="verlet", record="all")


def test_a_run_in_memory_gives_its_drive_back():
    drive = cd.scenes.spinning_ring().replace({"chain.links": 24})
    run = cd.simulate(drive, until=1e-3, record="span_tension")
    again = cd.load(run)
    assert again.links == 24
    assert again.name == drive.name
    assert not [it for it in cd.diff(drive, again) if not it.path.startswith("run.")]
