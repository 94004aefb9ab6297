"""Replays in a real browser: they play, scrub, zoom, and show what was recorded."""

import numpy as np
import pytest

import chaindrive as cd

CHANNELS = ["roller_x", "roller_y", "sprocket_angle", "sprocket_x", "sprocket_y"]
CHANNELS += ["tensioner_position", "link_tension", "contact_force", "span_tension"]

# [s]
FIRST_FRAME = 1.0
# [ms]
SCRIPT_OF_A_FRAME = 4.0


@pytest.fixture(scope="session")
def run():
    return cd.simulate(
        cd.scenes.marine_engine(),
        until=0.5,
        every=1e-4,
        record=CHANNELS,
        events=["teeth"],
        error=False,
    )


@pytest.fixture(scope="session")
def file(run, tmp_path_factory):
    path = tmp_path_factory.mktemp("replay") / "drive.html"
    cd.replay(run, path)
    return path


def opened(visit, path, **how):
    """A page that shows a replay; every error in it fails the test that closes it."""
    page = visit(path, **how)
    page.wait_for_function("window.replay && window.replay.firstFrame", timeout=20_000)
    return page


@pytest.fixture
def page(visit, file):
    page = opened(visit, file, viewport={"width": 1280, "height": 800})
    yield page
    assert page.errors == []
    page.close()


def test_values_read_back_are_those_recorded(page, run):
    frames = list(range(0, run.sizes["time"], 250))
    for name in ("roller_x", "roller_y", "link_tension", "contact_force"):
        recorded = run[name].to_numpy()[frames]
        entries = recorded.shape[1]
        shown = page.evaluate(
            "([name, frames, entries]) => frames.map((frame) => "
            "Array.from({ length: entries }, (_, i) => replay.value(name, frame, i)))",
            [name, frames, entries],
        )
        quantum = page.evaluate("(name) => replay.quantum(name)", name)
        largest = 1e-4 if name.startswith("roller") else 0.0025 * np.abs(run[name]).max().item()
        assert quantum <= largest * (1 + 1e-9)
        assert np.abs(np.array(shown) - recorded).max() <= 0.5 * quantum * (1 + 1e-9), name
    for span in run["span"].to_numpy():
        shown = page.evaluate(
            "([span, frames]) => frames.map((frame) => replay.value('span_tension', frame, span))",
            [str(span), frames],
        )
        quantum = page.evaluate("(span) => replay.quantum('span_tension', span)", str(span))
        recorded = run["span_tension"].sel(span=span).to_numpy()[frames]
        assert np.abs(np.array(shown) - recorded).max() <= 0.5 * quantum * (1 + 1e-9)


def test_it_plays_and_pauses(page):
    assert page.evaluate("replay.frame") == 0
    page.keyboard.press("Space")
    page.wait_for_function("replay.frame > 5")
    assert page.evaluate("replay.playing")
    page.click("#play")
    stopped = page.evaluate("replay.frame")
    page.wait_for_timeout(200)
    assert page.evaluate("replay.frame") == stopped


def test_space_presses_the_button_that_has_the_focus(page):
    """After a click it plays again. Defect: it played whatever the focus was on."""
    theme = "document.documentElement.dataset.theme"
    before = page.evaluate(theme)
    page.focus("#theme")
    page.keyboard.press("Space")
    assert page.evaluate(theme) != before
    page.click("#theme")
    page.keyboard.press("Space")
    assert page.evaluate(theme) == before
    assert page.evaluate("replay.playing")


def test_it_scrubs_by_slider_keys_and_plot(page):
    page.evaluate(
        "() => { const it = document.getElementById('scrub'); it.value = 2500; "
        "it.dispatchEvent(new Event('input')); }"
    )
    assert page.evaluate("replay.frame") == 2500
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Shift+ArrowRight")
    assert page.evaluate("replay.frame") == 2601
    page.wait_for_function("document.getElementById('clock').textContent.includes('0.2601')")
    box = page.locator("#plots canvas").first.bounding_box()
    page.mouse.click(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    assert 2000 < page.evaluate("replay.frame") < 3000


def test_it_zooms_about_the_pointer_and_shows_all_again(page):
    whole = page.evaluate("replay.scale")
    box = page.locator("#picture").bounding_box()
    page.mouse.move(box["x"] + 0.3 * box["width"], box["y"] + 0.4 * box["height"])
    page.mouse.wheel(0, -600)
    page.wait_for_function(f"replay.scale > 1.5 * {whole}")
    page.keyboard.press("0")
    assert page.evaluate("replay.scale") == pytest.approx(whole)
    page.click("#closer")
    assert page.evaluate("replay.scale") == pytest.approx(1.4 * whole)


def test_next_contact_is_the_next_one_logged(page, run):
    starts = np.sort(run["event_start"].to_numpy())
    times = run["time"].to_numpy()
    page.evaluate("replay.seek(1000)")
    page.keyboard.press("n")
    later = np.searchsorted(times, starts)
    expected = later[later > 1000].min()
    assert page.evaluate("replay.frame") == expected
    assert "touches" in page.inner_text("#followed")


def test_a_contact_comes_into_a_closer_view(page):
    for _ in range(8):
        page.click("#closer")
    for _ in range(4):
        page.keyboard.press("n")
        # What is told changes with the next picture.
        page.evaluate(
            "new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"
        )
        text = page.inner_text("#followed")
        roller = int(text.split("Roller ")[1].split()[0])
        x, y = page.evaluate("(roller) => replay.seen(roller)", roller)
        assert 0 < x < 1, text
        assert 0 < y < 1, text


def test_followed_roller_is_told(page, run):
    page.evaluate("replay.seek(1234)")
    page.select_option("#follow", "17")
    page.wait_for_function("document.getElementById('followed').textContent.includes('Roller 17')")
    x = run["roller_x"].isel(time=1234, roller=17).item() * 1e3
    told = float(page.inner_text("#followed").split("x")[1].split("mm")[0].replace("−", "-"))
    assert told == pytest.approx(x, abs=0.1)


def test_theme_follows_the_system_and_the_switch(visit, file):
    page = opened(visit, file, color_scheme="dark")
    theme = "document.documentElement.dataset.theme"
    assert page.evaluate(theme) == "dark"
    page.keyboard.press("d")
    assert page.evaluate(theme) == "light"
    page.close()


def test_keys_are_told(page):
    page.keyboard.press("?")
    assert page.is_visible("#help")
    assert "next contact" in page.inner_text("#help")


def test_narrow_window_has_no_overflow(visit, file):
    page = opened(visit, file, viewport={"width": 360, "height": 740})
    assert page.evaluate("document.documentElement.scrollWidth") <= 360
    legend = page.locator("#legend").bounding_box()
    picture = page.locator("#picture").bounding_box()
    assert legend["y"] + legend["height"] <= picture["y"] + 6
    page.close()


def test_first_frame_and_script_time_keep_their_limits(visit, file):
    """Of several tries the shortest counts: other work of the machine only adds to it."""
    firsts = []
    for _ in range(5):
        page = opened(visit, file, viewport={"width": 1280, "height": 800})
        firsts.append(1e-3 * page.evaluate("replay.firstFrame"))
        if firsts[-1] <= FIRST_FRAME:
            break
        page.close()
    first = min(firsts)
    assert first <= FIRST_FRAME
    page.evaluate("replay.play()")
    page.wait_for_function("replay.timings.length > 60", timeout=60_000)
    median = float(np.median(page.evaluate("replay.timings")))
    print(f"first frame after {first:.2f} s, {median:.2f} ms of script a frame")
    assert median <= SCRIPT_OF_A_FRAME
    page.close()


@pytest.mark.parametrize("name", list(cd.scenes.presets()))
def test_presets_are_drawn(visit, inked, name, tmp_path):
    drive = getattr(cd.scenes, name)()
    run = cd.simulate(drive, until=2e-3, every=1e-4, record=CHANNELS, error=False)
    path = tmp_path / f"{name}.html"
    cd.replay(run, path)
    page = opened(visit, path, viewport={"width": 1000, "height": 640})
    assert inked(page) > 1500
    assert page.errors == []
    page.screenshot(path=tmp_path / f"{name}.png")
    page.close()


def test_replay_in_a_notebook_survives_conversion(browser, run, tmp_path):
    """What a notebook keeps of a replay is shown by the converted page, without a kernel."""
    import nbformat
    from nbconvert import HTMLExporter

    shown = cd.replay(run, frames=200)._repr_html_()
    output = nbformat.v4.new_output("execute_result", {"text/html": shown}, execution_count=1)
    cell = nbformat.v4.new_code_cell("cd.replay(run)", outputs=[output], execution_count=1)
    text, _ = HTMLExporter().from_notebook_node(nbformat.v4.new_notebook(cells=[cell]))
    path = tmp_path / "notebook.html"
    path.write_text(text, encoding="utf-8")
    page = browser.new_page()
    page.goto(path.as_uri(), wait_until="domcontentloaded")
    frame = page.wait_for_selector("iframe[title=replay]").content_frame()
    frame.wait_for_function("window.replay && window.replay.firstFrame")
    frame.evaluate("replay.seek(100)")
    assert frame.evaluate("replay.frame") == 100
    page.close()
