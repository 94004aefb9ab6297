"""The page on speed and accuracy can be written."""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def test_the_report_writes_itself(tmp_path):
    command = [sys.executable, "benchmarks/report.py", "--quick", "--docs", str(tmp_path)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    page = (tmp_path / "how-fast-how-accurate.md").read_text(encoding="utf-8")
    head, _, body = page.partition("## The inner loop")
    targets = [line for line in head.splitlines() if line.startswith("|")]
    assert len(targets) >= 8
    assert all(line.count("|") == 5 for line in targets)
    for part in ("## Length", "## Memory", "## Work and precision", "## Sweeps", "## Beside other"):
        assert part in body
    assert "same to the last bit" in body
    for figure in ("cost_of_length.png", "work_precision.png"):
        assert (tmp_path / figure).stat().st_size > 5000
