"""The documentation as a site: what leads from its pages to the lab."""

import re
from pathlib import Path

import pytest

SITE = Path(__file__).parents[2] / "target" / "site"
LINK = re.compile(r'href="([./]*live-lab\.html#scene=[\w-]+)"')

pytestmark = pytest.mark.skipif(
    not (SITE / "live-lab.html").is_file(), reason=f"{SITE} has no lab: make lab pages"
)


def test_the_first_page_opens_a_timing_drive(visit):
    page = visit(SITE / "index.html", offline=True)
    page.click("a[href^='live-lab.html#scene=']")
    page.locator("#title", has_text="Timing chain").wait_for()
    assert not page.errors


def test_every_tutorial_has_its_drive_in_the_lab():
    tutorials = set((SITE / "tutorials").glob("*.html")) - {SITE / "tutorials" / "index.html"}
    assert len(tutorials) == 8
    links = {it.stem: LINK.findall(it.read_text(encoding="utf-8")) for it in tutorials}
    assert all(len(found) == 1 for found in links.values()), links
    assert len({*map(tuple, links.values())}) == len(tutorials)


def test_the_page_about_the_lab_stands_beside_it():
    assert "<h2>Speed" in (SITE / "lab.html").read_text(encoding="utf-8")
