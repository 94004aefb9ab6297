"""The licences that ship are those of the libraries that are compiled."""

import re
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

import chaindrive as cd

ROOT = Path(__file__).parent.parent.parent
sys.path.insert(0, str(ROOT / "tests"))

from licences import FILE, named, packages  # noqa: E402


@pytest.mark.skipif(shutil.which("cargo") is None, reason="cargo knows what is compiled")
def test_every_library_has_its_licence():
    """Of another version or another library: `make licences`."""
    told = subprocess.run(["rustc", "-vV"], check=True, capture_output=True, text=True).stdout
    (host,) = re.findall(r"^host: (.*)$", told, re.MULTILINE)
    compiled = packages("--offline", "--filter-platform", host)
    assert len(compiled) > 100
    listed = set(named())
    missing = {f"{it['name']} {it['version']}" for it in compiled} - listed
    assert not missing, "make licences"
    locked = tomllib.loads((ROOT / "Cargo.lock").read_text())["package"]
    unknown = listed - {f"{it['name']} {it['version']}" for it in locked}
    assert not unknown, "make licences"


def test_a_unit_carries_the_licences(tmp_path):
    unit = cd.scenes.spinning_ring().fmu(tmp_path / "ring.fmu", run=False, library=__file__)
    with zipfile.ZipFile(unit) as archive:
        held = archive.read("documentation/licenses/third-party.txt")
    assert held == FILE.read_bytes()
