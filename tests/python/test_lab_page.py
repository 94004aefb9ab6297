"""The lab by Python and by the command: a page that is built beforehand, opened on a drive."""

import json
import subprocess
import sys
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
