"""Damaged scenes, drawings, stores, snapshots and tables end in time and in words of ours."""

import re
import subprocess
import sys
import time
from pathlib import Path

import pytest
from mutants import KINDS, PATIENCE, tried_all

import chaindrive as cd

PROGRAM = Path(__file__).with_name("mutants.py")


def test_mutants_end_in_words_of_ours(tmp_path: Path) -> None:
    found = tried_all(20261127, 60, tmp_path)
    assert not found.complaints, "\n".join(found.complaints)
    assert set(found.taken) | set(found.refused) == set(KINDS)
    assert found.taken.total() > 5
    assert found.refused.total() > 20


@pytest.mark.parametrize(
    ("preset", "path", "value", "message"),
    [
        # So soft that what its dashpot pushes dies out in 10¹² s; a run-in takes three of them.
        ("timing_drive", "tensioners[0].push.stiffness", 1e-9, None),
        # Equilibria every 6 µrad, which Newton's method steps over.
        ("chain_pendulum", "sprockets[0].drive[0].order", 1e6, "static equilibrium not found"),
    ],
)
def test_what_was_found_by_lot_ends_in_time(
    preset: str, path: str, value: float, message: str | None
) -> None:
    drive = getattr(cd.scenes, preset)().replace({path: value})
    begun = time.process_time()
    if message is None:
        drive.describe()
    else:
        with pytest.raises(cd.ChaindriveError, match=message):
            drive.describe()
    assert time.process_time() - begun < PATIENCE


@pytest.mark.slow
def test_twenty_thousand_mutants_end_in_time_and_memory(tmp_path: Path) -> None:
    """None is deaf to a signal, which ends the process with a traceback; none takes 1 GB."""
    command = [sys.executable, str(PROGRAM), "--seed", "1", "--count", "20000"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    memory = [float(it) for it in re.findall(r"memory ([0-9.]+) GB", done.stdout)]
    assert len(memory) == 40
    assert max(memory) < 1.0
