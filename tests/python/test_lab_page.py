"""The lab by Python and by the command: a page that is built beforehand, opened on a drive."""

import base64
import json
import random
import re
import subprocess
import sys
import zlib
from pathlib import Path

import pytest

import chaindrive as cd
from chaindrive import lab_page

#: What stands for a scene in the page of a build.
NONE = '<script id="scene" type="application/json">null</script>'


@pytest.fixture
def built(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A page of a build, without its module."""
    page = tmp_path / "built.html"
    page.write_text(f"<!DOCTYPE html>{NONE}<p>", encoding="utf-8")
    monkeypatch.setattr(lab_page, "PAGE", page)
    return page


def scene_in(page: str) -> dict[str, str]:
    """The scene on which a page opens."""
    begin, end = NONE.split("null")
    return json.loads(page.partition(begin)[2].partition(end)[0])


def command(*arguments: object) -> subprocess.CompletedProcess[str]:
    line = [sys.executable, "-m", "chaindrive", "lab", *map(str, arguments)]
    return subprocess.run(line, capture_output=True, text=True, check=False)


def test_a_page_opens_on_its_drive(built: Path, tmp_path: Path) -> None:
    drive = cd.scenes.spinning_ring().replace({"title": "</script><!-- <b>"})
    page = cd.lab(drive, tmp_path / "ring.html")
    assert scene_in(page.html) == {"name": drive.name, "text": drive.text}
    assert "</script><!--" not in page.html
    assert (tmp_path / "ring.html").read_text(encoding="utf-8") == page.html
    assert 'title="lab"' in page._repr_html_()
    with pytest.raises(ValueError, match=r"must end in \.html"):
        cd.lab(drive, tmp_path / "ring.pdf")


def test_a_link_holds_a_drive() -> None:
    drive = cd.scenes.spinning_ring().replace({"title": "Ring & <Rad> über alles"})
    page, _, packed = cd.lab_link(drive, "https://example.org/lab.html").partition("#scene=")
    assert page == "https://example.org/lab.html"
    # As a fragment is written, and within it nothing that an attribute would end at.
    assert re.fullmatch(r"[\w-]+", packed)
    raw = base64.urlsafe_b64decode(packed + "=" * (-len(packed) % 4))
    assert json.loads(zlib.decompress(raw, wbits=-15)) == {"name": drive.name, "text": drive.text}


def test_a_scene_that_no_link_holds_is_told() -> None:
    noise = base64.b64encode(random.Random(1).randbytes(30_000)).decode()
    drive = cd.Drive.from_toml(f"{cd.scenes.spinning_ring().text}\n# {noise}\n")
    with pytest.raises(cd.ChaindriveError, match=r"takes \d+ kB in a link, and 32 kB are the most"):
        cd.lab_link(drive)


def test_a_build_without_a_lab_says_how_to_get_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(lab_page, "PAGE", tmp_path / "absent.html")
    with pytest.raises(cd.ChaindriveError, match="make lab"):
        cd.lab(cd.scenes.spinning_ring(), tmp_path / "ring.html")
    assert not (tmp_path / "ring.html").exists()
    lost = command("spinning_ring", "--page", tmp_path / "absent.html", "-o", tmp_path / "a.html")
    assert lost.returncode == 2
    assert "absent.html" in lost.stderr


def test_the_command_makes_the_page(built: Path, tmp_path: Path) -> None:
    output = tmp_path / "ring.html"
    made = command("spinning_ring", "--page", built, "-o", output)
    assert made.returncode == 0, made.stderr
    assert scene_in(output.read_text(encoding="utf-8"))["name"] == "spinning_ring"
    # A page that has a scene already, a result of the same name, a scene that is no drive.
    again = command("spinning_ring", "--page", output, "-o", tmp_path / "b.html")
    assert again.returncode == 2
    assert "is not the page that `make lab` builds" in again.stderr
    assert command("spinning_ring", "--page", built, "-o", output).returncode == 3
    wrong = tmp_path / "wrong.toml"
    wrong.write_text("[chain]\npitch = '12 rpm'", encoding="utf-8")
    told = command(wrong, "--page", built, "-o", tmp_path / "c.html")
    assert told.returncode == 2
    assert "chain.pitch" in told.stderr
    assert not (tmp_path / "c.html").exists()
