"""Reports in a real browser: whole at every width, readable in the dark, and on paper."""

import re

import pytest
from pypdf import PdfReader

import chaindrive as cd

#: Sections in their order; those of the page of a run stand between the first two.
ORDER = [
    "Six numbers",
    "Verdict",
    "Diagrams",
    "Inputs and their sources",
    "Numerics",
    "Replay",
    "Scene",
    "Build",
]
WIDTHS = [400, 900, 1600]
LARGEST = 2_000_000


@pytest.fixture(scope="session", params=["industrial_16b", "timing_drive"])
def report(request, tmp_path_factory):
    drive = getattr(cd.scenes, request.param)()
    run = cd.simulate(drive, until=0.2, record="all", events=["teeth"], error=False)
    path = tmp_path_factory.mktemp("report") / f"{request.param}.html"
    cd.report(run, path)
    assert path.stat().st_size < LARGEST
    return path


@pytest.mark.parametrize("width", WIDTHS)
def test_a_report_is_whole_at_every_width(visit, report, width):
    page = visit(report, viewport={"width": width, "height": 900})
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    pictures = page.evaluate("[...document.images].map((it) => [it.complete, it.naturalWidth])")
    assert len(pictures) >= 5
    assert all(complete and wide > 0 for complete, wide in pictures)
    heads = page.evaluate("[...document.querySelectorAll('h2')].map((it) => it.textContent)")
    heads = [re.sub(r":.*", "", it) for it in heads]
    assert [it for it in heads if it in ORDER] == ORDER
    replay = page.frame_locator("iframe")
    replay.locator("canvas").first.wait_for(timeout=20_000)
    assert page.errors == []
    page.close()


def contrast(page, selector):
    """Contrast of a text with the page behind it, by WCAG."""
    return page.evaluate(
        """(selector) => {
        const light = (text) => {
            const context = document.createElement("canvas").getContext("2d");
            context.fillStyle = text;
            context.fillRect(0, 0, 1, 1);
            const { data } = context.getImageData(0, 0, 1, 1);
            const of = (it) => (it <= 0.04045 ? it / 12.92 : ((it + 0.055) / 1.055) ** 2.4);
            const linear = [...data].map((it) => of(it / 255));
            return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
        };
        const text = light(getComputedStyle(document.querySelector(selector)).color);
        const paper = light(getComputedStyle(document.body).backgroundColor);
        const [low, high] = [text, paper].sort((a, b) => a - b);
        return (high + 0.05) / (low + 0.05);
    }""",
        selector,
    )


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_a_report_is_read_by_day_and_by_night(visit, report, scheme):
    page = visit(report, color_scheme=scheme)
    paper = page.evaluate("getComputedStyle(document.body).backgroundColor")
    channels = [int(it) for it in re.findall(r"\d+", paper)][:3]
    assert (sum(channels) > 3 * 128) == (scheme == "light")
    for selector in ("h1", "td", "pre", "figcaption"):
        assert contrast(page, selector) > 7, selector
    page.close()


def test_a_report_prints(visit, report, tmp_path):
    page = visit(report)
    paper = tmp_path / "report.pdf"
    page.pdf(path=paper, format="A4", prefer_css_page_size=True)
    page.close()
    pages = PdfReader(paper).pages
    sheets = [sheet.extract_text() for sheet in pages]
    assert 5 <= len(sheets) <= 30
    # What is signed fits one sheet, and the rest begins on the next one.
    assert "Verdicts" in sheets[0]
    assert "signature" in sheets[0]
    assert "Verdict:" not in sheets[0]
    assert "Verdict:" in sheets[1]
    # A sheet with a few words and no picture is a page break at the wrong place.
    full = [
        len(sheet.split()) > 15 or len(page.images) > 0
        for sheet, page in zip(sheets, pages, strict=True)
    ]
    assert all(full[:-1])
    assert any("Assumed:" in sheet for sheet in sheets)
