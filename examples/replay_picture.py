"""Draw docs/replay.png: a replay of the timing drive, as Chromium shows it.

Takes playwright (dependency group ``site``) and a Chromium on the path. Run it as
``python examples/replay_picture.py [--out FILE]``.
"""

import argparse
import shutil
import sys
import tempfile
from pathlib import Path

import chaindrive as cd

CHANNELS = ["roller_x", "roller_y", "sprocket_angle", "tensioner_position"]
CHANNELS += ["link_tension", "contact_force", "span_tension"]
FRAME = 250


def main() -> None:
    parser = argparse.ArgumentParser(description="Draw the picture of a replay.")
    parser.add_argument("--out", type=Path, default=Path("docs/replay.png"))
    out = parser.parse_args().out
    names = ("chromium", "chromium-browser", "google-chrome")
    program = next(filter(None, map(shutil.which, names)), None)
    if program is None:
        sys.exit("Chromium is missing: install the package chromium (Debian)")
    from playwright.sync_api import sync_playwright

    drive = cd.scenes.timing_drive()
    run = cd.simulate(drive, run_in="0.1 s", until=0.05, every=1e-4, record=CHANNELS, error=False)
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        page = Path(folder) / "replay.html"
        cd.replay(run, page)
        browser = playwright.chromium.launch(executable_path=program, args=["--no-sandbox"])
        shown = browser.new_page(viewport={"width": 1100, "height": 700}, color_scheme="light")
        shown.goto(page.as_uri())
        shown.wait_for_function("window.replay && window.replay.firstFrame")
        shown.evaluate(f"window.replay.seek({FRAME})")
        shown.wait_for_timeout(300)
        shown.screenshot(path=out)
        browser.close()


if __name__ == "__main__":
    main()
