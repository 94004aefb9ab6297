"""What tests build and what ships compute the same bits, and go on with each other's results."""

import itertools
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import chaindrive as cd

pytest.importorskip("zarr")
pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parents[2]
PROFILES = ("quick", "release")
METHODS = ("auto", "verlet", "rk4", "dormand-prince", "implicit-damping", "generalized-alpha")
# Those of older processors are slower and compute other bits; a processor without one refuses it.
SETS = ("sse2", "avx2", "avx512", "neon")


def command(program, *arguments, instruction_set=None):
    """Run the command of one profile: its exit code and what it said of errors."""
    chosen = {"CHAINDRIVE_INSTRUCTION_SET": instruction_set} if instruction_set else {}
    done = subprocess.run(
        [program, *arguments],
        env=os.environ | chosen,
        capture_output=True,
        text=True,
        check=False,
    )
    return done.returncode, done.stderr


def available(program):
    """Instruction sets of this processor that the command has kernels for."""
    told = subprocess.run(
        [program, "-V", "--verbose"], capture_output=True, text=True, check=True
    ).stdout
    line = next(line for line in told.splitlines() if line.startswith("processor has"))
    return [name for name in SETS if name in line]


def differing(first, second):
    """Names of the arrays of two results that differ in any bit."""
    one, other = (xr.open_zarr(store, chunks=None).load() for store in (first, second))
    assert list(one.variables) == list(other.variables)
    return [
        name
        for name in one.variables
        if one[name].dtype != other[name].dtype
        or np.asarray(one[name].values).tobytes() != np.asarray(other[name].values).tobytes()
    ]


@pytest.fixture(scope="module")
def programs():
    """Build the command in both profiles."""
    for profile in PROFILES:
        selected = ["-p", "chaindrive-cli", "-p", "chaindrive-python"]
        build = ["cargo", "build", "--quiet", "--profile", profile, *selected]
        subprocess.run(build, cwd=ROOT, check=True)
    target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    programs = [target / profile / "chaindrive" for profile in PROFILES]
    for program, profile in zip(programs, PROFILES, strict=True):
        told = subprocess.run([program, "-V", "--verbose"], capture_output=True, text=True)
        assert f"profile       {profile}\n" in told.stdout
    return programs


def test_presets_have_the_same_bits_by_every_method(programs, tmp_path):
    compared = 0
    sets = available(programs[0])
    for preset, method in itertools.product(cd.scenes.presets(), METHODS):
        # By itself a method is chosen on the widest registers alone.
        for instruction_set in sets[-1:] if method == "auto" else sets:
            case = f"{preset}-{method}-{instruction_set}"
            stores = [tmp_path / f"{case}-{profile}.zarr" for profile in PROFILES]
            run = ["run", preset, "--until", "1 ms", "--every", "10 us", "--run-in", "0"]
            run += ["--method", method, "--no-error", "--record", "all", "--overwrite", "-q"]
            done = [
                command(program, *run, "-o", store, instruction_set=instruction_set)
                for program, store in zip(programs, stores, strict=True)
            ]
            # A method that is not for this chain is refused, by both with the same words.
            assert done[0][0] == done[1][0], (case, done)
            if stores[0].exists():
                assert differing(*stores) == [], case
                compared += done[0][0] == 0
    assert compared >= 2 * len(cd.scenes.presets())


@pytest.mark.parametrize("first", [0, 1])
def test_a_store_of_one_profile_is_gone_on_with_by_the_other(programs, tmp_path, first):
    begins, goes_on = programs[first], programs[1 - first]
    for instruction_set in available(begins):
        store, straight = (tmp_path / f"{name}-{instruction_set}.zarr" for name in "ab")
        run = ["run", "marine_two_sprockets", "--every", "0.1 ms", "--run-in", "0", "--no-error"]
        run += ["--method", "verlet", "--checkpoint-every", "1 ms", "-q"]
        for program, until, output in ((begins, "4 ms", store), (goes_on, "8 ms", straight)):
            arguments = [*run, "--until", until, "-o", output]
            assert command(program, *arguments, instruction_set=instruction_set)[0] == 0
        resume = ["resume", store, "--until", "8 ms", "-q"]
        assert command(goes_on, *resume, instruction_set=instruction_set) == (0, "")
        assert differing(store, straight) == []
        assert xr.open_zarr(store).attrs["chaindrive_profile"] == PROFILES[1 - first]
