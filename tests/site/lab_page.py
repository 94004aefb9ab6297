"""The lab as a test sees it: what is waited for, what a hand does."""

import time
from pathlib import Path

import pytest

PAGE = Path(__file__).parents[2] / "target" / "lab" / "lab.html"

is_built = pytest.mark.skipif(not PAGE.is_file(), reason=f"{PAGE} is not built: make lab")

# [s]
PATIENCE = 60.0

WIDE = {"width": 1280, "height": 800}


def until(page, condition):
    """Waits for a condition; the page's own policy forbids the browser's way to do so."""
    end = time.monotonic() + PATIENCE
    while not page.evaluate(condition):
        assert time.monotonic() < end, f"{condition}; {message(page)}; {page.errors}"
        page.wait_for_timeout(50)


def message(page):
    return page.evaluate("document.getElementById('message-text').textContent")


def moves(page):
    before = page.evaluate("lab.time")
    until(page, f"lab.time > {before!r}")


def settles(page):
    """Waits until nothing is read, assembled or gone back to."""
    until(page, "!lab.lab.isBusy")


def preset(page, name):
    page.select_option("#preset", name)
    until(page, f"lab.lab.base?.name.startsWith({name!r}) && lab.ready")


def choose(page, key, value):
    """Moves a slider as a hand does."""
    page.evaluate(
        """([key, value]) => {
        const { slider } = lab.lab.sliders.inputs.get(key);
        slider.value = value;
        slider.dispatchEvent(new Event('input'));
        slider.dispatchEvent(new Event('change'));
    }""",
        [key, value],
    )
    settles(page)


def write(page, text):
    """Puts a text into the editor, and waits until it is checked."""
    page.evaluate(
        """(text) => {
        document.getElementById('editor-state').textContent = '';
        const area = document.getElementById('editor-text');
        area.value = text;
        area.dispatchEvent(new Event('input'));
    }""",
        text,
    )
    until(page, "document.getElementById('editor-state').textContent !== ''")


def write_cell(page, label, value):
    cell = page.get_by_label(label, exact=True)
    cell.fill(str(value))
    cell.press("Tab")
