"""Damaged scenes, drawings, stores, snapshots and tables end in time and in words of ours."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
from mutants import KINDS, tried_all

PROGRAM = Path(__file__).with_name("mutants.py")


def test_mutants_end_in_words_of_ours(tmp_path: Path) -> None:
    found = tried_all(20261127, 60, tmp_path)
    assert not found.complaints, "\n".join(found.complaints)
    assert set(found.taken) | set(found.refused) == set(KINDS)
    assert found.taken.total() > 5
    assert found.refused.total() > 20


@pytest.mark.slow
def test_twenty_thousand_mutants_end_in_time_and_memory(tmp_path: Path) -> None:
    """None is deaf to a signal, which ends the process with a traceback; none takes 1 GB."""
    command = [sys.executable, str(PROGRAM), "--seed", "1", "--count", "20000"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    memory = [float(it) for it in re.findall(r"memory ([0-9.]+) GB", done.stdout)]
    assert len(memory) == 40
    assert max(memory) < 1.0
