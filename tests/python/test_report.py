"""The page on speed and accuracy can be written, and tells what it measured, when and with what."""

import hashlib
import importlib.util
import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
REPORT, PEERS = ROOT / "benchmarks/report", ROOT / "benchmarks/peers"


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """The page of a quick run, with the folder that it is in."""
    if importlib.util.find_spec("numba") is None:
        pytest.skip("the yardstick is a numba program")
    folder = tmp_path_factory.mktemp("docs")
    command = [sys.executable, str(REPORT), "--quick", "--docs", str(folder)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return folder, (folder / "how-fast-how-accurate.md").read_text(encoding="utf-8")


@pytest.mark.slow
def test_every_part_and_target_is_on_the_page(page):
    folder, text = page
    parts = re.findall(r"^## (.*)$", text, flags=re.MULTILINE)
    assert len(parts) == 11
    head, _, _ = text.partition("## ")
    targets = [line for line in head.splitlines() if line.startswith("|")][2:]
    assert len(targets) >= 15
    assert all(line.count("|") == 5 for line in targets)
    verdicts = {line.split("|")[4].strip() for line in targets}
    assert verdicts <= {"met", "**missed**", "not measured now"}
    for figure in ("cost_of_length.svg", "work_precision.svg"):
        assert f"]({figure})" in text
        assert 5_000 < (folder / figure).stat().st_size < 300_000


@pytest.mark.slow
def test_the_page_names_its_origin(page):
    """Machine, commit, date, and the yardstick by hash, version and instruction set."""
    _, text = page
    assert re.search(r"commit \S+.*; \d{4}-\d\d-\d\d \d\d:\d\d UTC", text)
    kernel = hashlib.sha256((PEERS / "with_numba.py").read_bytes()).hexdigest()[:12]
    assert f"hash {kernel}, numba " in text
    registers = re.search(r"(\d+) × 512 bits, (\d+) × 256 bits, (\d+) × 128 bits", text)
    assert registers, "no machine code was looked at"
    assert sum(map(int, registers.groups())) > 0


@pytest.mark.slow
def test_what_was_not_measured_now_says_when_it_was(page):
    _, text = page
    _, _, body = text.partition("## Beside other programs")
    stored = json.loads((PEERS / "results.json").read_text(encoding="utf-8"))
    for program in ("numba", "scipy", "exudyn"):
        row = next(line for line in body.splitlines() if line.startswith(f"| {program} |"))
        if importlib.util.find_spec(program) is None:
            assert "not measured now" in row
            assert stored["machine"]["date"] in row
            found = f"{stored['ratios'][program]['ratio']:.3g}"
            assert found in row
    assert stored["machine"]["commit"] in body


@pytest.mark.slow
def test_every_set_of_registers_is_measured_or_told_to_be_missing(page):
    _, text = page
    for kind in ("avx512", "avx2", "sse2"):
        row = next(line for line in text.splitlines() if line.startswith(f"| {kind} |"))
        time = row.split("|")[2].strip()
        assert time == "not on this processor" or float(time) > 0.0


@pytest.fixture
def yardstick(monkeypatch):
    """The module, with the folder of the report on the path for as long as the test takes."""
    monkeypatch.syspath_prepend(str(REPORT))
    import yardstick

    yield yardstick
    del sys.modules["yardstick"]


def test_the_yardstick_is_frozen(yardstick):
    found = hashlib.sha256(yardstick.KERNEL.read_bytes()).hexdigest()
    assert found == yardstick.FROZEN_HASH


def test_another_program_is_no_yardstick(yardstick, monkeypatch, tmp_path):
    other = tmp_path / "with_numba.py"
    other.write_bytes(yardstick.KERNEL.read_bytes() + b"\n")
    monkeypatch.setattr(yardstick, "KERNEL", other)
    with pytest.raises(RuntimeError, match="restore the file"):
        yardstick.Yardstick()
