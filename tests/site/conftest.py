"""A real browser, without a network."""

import shutil

import pytest
from lab_page import PAGE, WIDE, until
from playwright.sync_api import sync_playwright


@pytest.fixture(scope="session")
def browser():
    names = ("chromium", "chromium-browser", "google-chrome")
    program = next(filter(None, map(shutil.which, names)), None)
    assert program, "Chromium is missing: install the Debian package chromium"
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=program, args=["--no-sandbox"])
        yield chromium
        chromium.close()


@pytest.fixture(scope="session")
def visit(browser):
    """Open a file in a page that writes down its errors, and whatever it asks of a network."""

    def visited(path, **how):
        page = browser.new_page(**how)
        page.errors = []
        page.on("pageerror", lambda error: page.errors.append(str(error)))
        page.on("request", lambda request: page.errors.extend(outside(request.url)))
        page.goto(path.as_uri())
        return page

    return visited


def outside(url):
    """What is to be said of an address: nothing of those within the page."""
    return [] if url.startswith(("file:", "data:", "blob:", "about:")) else [f"asks for {url}"]


@pytest.fixture(scope="session")
def inked():
    """Count the pixels of the picture of a page that are not of paper."""
    program = (
        "() => { const c = document.getElementById('picture'); "
        "const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data; "
        "let n = 0; for (let i = 0; i < d.length; i += 4) n += d[i] + d[i+1] + d[i+2] < 690; "
        "return n; }"
    )
    return lambda page: page.evaluate(program)


@pytest.fixture
def opened(visit):
    """Opens the lab, with a part of an address; every error in it fails the test."""
    pages = []

    def open_it(fragment="", **how):
        page = visit(PAGE, offline=True, **{"viewport": WIDE, **how})
        if fragment:
            page.goto(f"{PAGE.as_uri()}{fragment}")
            page.reload()
        until(page, "Boolean(window.lab)")
        pages.append(page)
        return page

    yield open_it
    for page in pages:
        assert page.errors == []
        page.close()


@pytest.fixture
def page(opened):
    return opened()
