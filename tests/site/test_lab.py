"""The lab in a real browser, from a disk: drives move, and nothing that one does ends it."""

import json

import numpy as np
import pytest
from lab_page import (
    PAGE,
    PATIENCE,
    WIDE,
    choose,
    is_built,
    message,
    moves,
    preset,
    settles,
    until,
    write,
    write_cell,
)

import chaindrive as cd

pytestmark = is_built

# [s]
FIRST_PICTURE = 2.0


def test_it_opens_at_once_and_plays(visit):
    """Of several tries the shortest counts: other work of the machine only adds to it."""
    firsts = []
    for _ in range(5):
        page = visit(PAGE, offline=True, viewport=WIDE)
        until(page, "Boolean(window.lab)")
        firsts.append(1e-3 * page.evaluate("lab.openedAt"))
        moves(page)
        assert page.errors == []
        assert message(page) == ""
        page.close()
        if firsts[-1] <= FIRST_PICTURE:
            break
    print(f"opens after {min(firsts):.2f} s")
    assert min(firsts) <= FIRST_PICTURE


def test_it_pauses_steps_and_resets(page):
    until(page, "lab.time > 5e-3")
    page.keyboard.press("Space")
    until(page, "!lab.playing && !lab.lab.asked")
    stopped = page.evaluate("lab.time")
    page.wait_for_timeout(200)
    assert page.evaluate("lab.time") == stopped
    page.keyboard.press(".")
    until(page, f"lab.time > {stopped!r}")
    page.keyboard.press("r")
    settles(page)
    until(page, "lab.playing")
    assert page.evaluate("lab.time") < stopped


def test_two_speeds_are_told(page):
    until(page, "document.getElementById('computes').textContent.includes('real time')")
    assert page.inner_text("#plays").startswith("plays at ")
    page.select_option("#speed", "1")
    # No browser computes this drive in real time: it says so.
    until(page, "document.getElementById('plays').className === 'caution'")


@pytest.mark.parametrize("name", list(cd.scenes.presets()))
def test_presets_move(page, inked, name):
    preset(page, name)
    moves(page)
    assert message(page) == ""
    assert inked(page) > 1500


@pytest.mark.parametrize("name", ["industrial_16b", "bicycle_derailleur"])
def test_every_slider_goes_to_both_ends(page, name):
    preset(page, name)
    keys = page.evaluate("[...lab.lab.sliders.inputs.keys()]")
    assert len(keys) >= 10
    for key in keys:
        ends = f"(({{ slider }}) => [slider.max, slider.min])(lab.lab.sliders.inputs.get({key!r}))"
        greatest, least = map(float, page.evaluate(ends))
        # Defect: a preload that is negative turned the ends around.
        assert least < greatest
        for end in (greatest, least):
            choose(page, key, end)
            assert page.evaluate("lab.playing"), f"{key} at {end}: {message(page)}"
            moves(page)
        page.keyboard.press("Control+z")
        page.keyboard.press("Control+z")
        settles(page)
        changed = page.evaluate("lab.lab.sliders.changes.map((it) => it.key)")
        assert changed == [], f"{key} is not taken back"


def test_a_speed_is_followed(page):
    preset(page, "industrial_16b")
    choose(page, "speed driver", 450)
    until(page, "Math.abs(lab.value('speed', 'driver') - 450) < 1e-6")


def test_a_value_that_is_refused_leaves_what_acts(page):
    """Defect: the field showed the number of the scene, and could not be written in."""
    preset(page, "marine_engine")
    field = page.get_by_label("stiffness of tightener in N/m")
    write_cell(page, "stiffness of tightener in N/m", 1.5e6)
    write_cell(page, "stiffness of tightener in N/m", -7)
    until(page, "document.getElementById('message-text').textContent.startsWith('stiffness')")
    assert field.input_value() == "1500000"
    assert field.is_enabled()


def test_a_centre_goes_where_it_is_sent(page):
    preset(page, "industrial_16b")
    where = "lab.lab.film.arrays.body_x.at(0, 1)"
    before = page.evaluate(where)
    page.select_option("#speed", "1")
    choose(page, "centre driven x", 1)
    until(page, f"Math.abs({where} - {before!r} - 1e-3) < 1e-8")


def test_a_span_is_pulled_at(page):
    """The force points to the hand, is limited, does work that the ledger has, and ends."""
    preset(page, "industrial_16b")
    until(page, "lab.time > 0.01")
    roller = page.evaluate(
        """() => {
        const { view, film } = lab.lab;
        const away = (i) => Math.hypot(view.roller(i)[0] - 0.5, view.roller(i)[1] + 0.18);
        return [...Array(film.rollers).keys()].sort((a, b) => away(a) - away(b))[0];
    }"""
    )
    place = "(roller) => lab.lab.view.toScreen(...lab.lab.view.roller(roller))"
    box = page.locator("#picture").bounding_box()
    x, y = page.evaluate(place, roller)
    page.mouse.move(box["x"] + x, box["y"] + y)
    page.mouse.down()
    page.mouse.move(box["x"] + x, box["y"] + y + 120, steps=4)
    until(page, "Math.hypot(...lab.lab.pull.force) > 0")
    pulled = page.evaluate("lab.lab.pull.roller")
    assert pulled >= 0
    force = page.evaluate("lab.lab.pull.force")
    assert force[1] < 0
    assert np.hypot(*force) <= page.evaluate("lab.lab.pull.most") * (1 + 1e-9)
    moves(page)
    page.mouse.up()
    assert page.evaluate("lab.lab.pull.roller") == -1
    until(page, "lab.lab.ended.length === 0")
    moves(page)
    assert message(page) == ""
    # It was no click: nothing is followed, and the picture has not moved.
    assert page.evaluate("[lab.lab.view.followed, lab.lab.view.window.whole]") == [-1, True]
    page.click("[data-tab=energy]")
    until(page, "document.getElementById('share').textContent.includes('closes to')")
    assert page.get_attribute("#share", "class") == ""


def test_teeth_that_open_the_loop_close_it_with_other_links(page):
    preset(page, "industrial_16b")
    until(page, "lab.lab.history.length > 20")
    choose(page, "sprockets[0].teeth", 21)
    assert "closes the loop" in message(page)
    assert page.evaluate("lab.lab.facts.sprockets[0].teeth") == 21
    # The curves before stay in grey.
    assert page.evaluate("lab.lab.scrolls.kept.length") > 10
    moves(page)


def test_sliders_show_what_acts_after_a_start_that_comes_to_nothing(page):
    """Defect: refused or stopped, it left them at values of later or of nowhere."""
    preset(page, "industrial_16b")
    until(page, "lab.lab.safe?.bytes")
    page.click("#play")
    until(page, "!lab.lab.asked")
    shown = "['speed driver', 'route.pretension'].map((it) => lab.lab.sliders.inputs.get(it).value)"
    before = page.evaluate(shown)
    kept = page.evaluate("quantity(lab.lab.safe.time, 's', 4)")
    choose(page, "speed driver", 250)
    page.click("#step")
    write_cell(page, "pretension in N", 1e12)
    settles(page)
    assert f"goes on from t = {kept}" in message(page)
    assert page.evaluate(shown) == before
    # A worker that never answers is stopped.
    page.evaluate("lab.lab.core.worker.postMessage = () => {}")
    write_cell(page, "pretension in N", 2000)
    page.click("#stop")
    settles(page)
    assert message(page).startswith("Stopped.")
    assert page.evaluate(shown) == before
    assert page.evaluate("lab.lab.changes.size") == 0
    moves(page)


def test_what_comes_after_a_is_kept_beside_b(page):
    page.click("#keep")
    until(page, "lab.lab.kept !== null")
    kept = page.evaluate("lab.lab.kept.time")
    page.click("#play")
    until(page, f"lab.time > {kept!r} + 1e-3")
    page.click("#back-to")
    until(page, f"Math.abs(lab.time - {kept!r}) < 1e-9")
    after = "lab.lab.scrolls.kept"
    assert page.evaluate(f"{after}.end") > kept + 0.9e-3
    # The same inputs give the same motion: B comes over A bit by bit.
    page.click("#play")
    until(page, f"lab.time > {kept!r} + 1e-3")
    apart = page.evaluate(
        """() => {
        const { scrolls: { kept }, history } = lab.lab;
        const at = history.before(kept.times[20] - 1e-9);
        return [history.times[at] - kept.times[20], history.series[0][at] - kept.series[0][20]];
    }"""
    )
    assert max(map(abs, apart)) < 1e-9


def test_the_ledger_closes_and_the_horizon_is_told(page):
    page.click("[data-tab=energy]")
    until(page, "document.getElementById('share').textContent.includes('closes to')")
    assert page.get_attribute("#share", "class") == ""
    until(page, "document.getElementById('horizon').textContent.includes('can be believed for')")
    assert page.inner_text("#horizon-sentence") != ""
    # Defect: it stood beside the next drive.
    preset(page, "spinning_ring")
    assert page.inner_text("#horizon-sentence") + page.inner_text("#horizon-of") == ""


def test_a_spectrum_has_mesh_orders(page):
    page.click("[data-tab=spectrum]")
    until(page, "document.getElementById('spectrum-note').textContent.includes('mesh orders')")


def test_amplitudes_of_a_sine_are_its_own(page):
    """a sin(2π f t) on a line of the spectrum: a there, a/2 beside it by the window, else zero."""
    found, step = page.evaluate(
        """() => {
        const sine = (_, i) => 5 + 3 * Math.sin((2 * Math.PI * 40 * i) / 1024);
        const wave = Float64Array.from({ length: 1024 }, sine);
        const { found, step } = amplitudes(wave, 1e-3);
        return [[...found], step];
    }"""
    )
    assert step == pytest.approx(1 / 1.024)
    assert found[40] == pytest.approx(3.0, rel=1e-9)
    assert found[39] == pytest.approx(1.5, rel=1e-9)
    assert max(it for i, it in enumerate(found) if abs(i - 40) > 1) < 1e-9


def test_mistakes_stand_where_they_are(page):
    page.keyboard.press("e")
    text = page.input_value("#editor-text")
    lines = text.splitlines()
    wrong = next(i for i, line in enumerate(lines) if line.startswith("pitch"))
    lines[wrong] = 'pitch = "8 litres"'
    write(page, "\n".join(lines))
    assert f"line {wrong + 1}" in page.inner_text("#editor-problems")
    assert "^" in page.inner_text("#editor-problems pre")
    assert page.locator("#editor-marks div").count() == 1
    page.click("#editor-problems button")
    begin = page.evaluate("document.getElementById('editor-text').selectionStart")
    assert text[:begin].count("\n") == wrong
    # A text that is wrong does not disturb the drive.
    page.click("#editor-run")
    page.keyboard.press("Escape")
    settles(page)
    moves(page)
    page.keyboard.press("e")
    write(page, text.replace("[run]", "[run] # the same"))
    assert page.inner_text("#editor-state") == "No mistakes."
    page.click("#editor-run")
    until(page, "!document.getElementById('editor').open")
    moves(page)


@pytest.mark.parametrize(
    "text", ["x" * 1_000_000, "".join(map(chr, range(32))) * 100, "[" * 20_000, "\u2028\udbff"]
)
def test_monstrous_texts_do_no_harm(page, text):
    page.keyboard.press("e")
    write(page, text)
    assert "mistake" in page.inner_text("#editor-state")
    page.click("#editor-run")
    page.keyboard.press("Escape")
    settles(page)
    moves(page)


def test_names_are_text(page):
    # Points and brackets are not allowed in names.
    name = '<script>harm = 1</script><img src=x onerror="harm = 1">'
    text = cd.scenes.industrial_16b().text.replace('"driver"', f"'{name}'")
    page.keyboard.press("e")
    write(page, text.replace("Industrial", "<b>Industrial</b>"))
    page.click("#editor-run")
    until(page, "!document.getElementById('editor').open")
    moves(page)
    assert "<b>Industrial</b>" in page.inner_text("#title")
    for tab in ("spectrum", "energy", "curves"):
        page.click(f"[data-tab={tab}]")
    choose(page, "sprockets[0].teeth", 20)
    page.click("#link")
    until(page, "document.getElementById('message-text').textContent.includes('holds the scene')")
    assert page.evaluate("typeof harm") == "undefined"
    assert page.locator("main script, main img, header img").count() == 0


def test_a_link_holds_the_scene(page, opened):
    preset(page, "marine_two_sprockets")
    choose(page, "route.pretension", 9000)
    page.click("#link")
    until(page, "location.hash.length > 20")
    told = page.evaluate("[location.hash, lab.lab.scene.text]")
    assert len(told[0]) < 32768
    other = opened(told[0])
    assert other.evaluate("lab.lab.scene.text") == told[1]
    assert other.evaluate("lab.lab.facts.chains[0].route.pretension") == 9000
    moves(other)
    # Defect: back from another link the address held this drive, and the page still the other.
    text = "lab.lab.scene.text"
    page.evaluate("(link) => { location.hash = link; }", cd.lab_link(cd.scenes.spinning_ring(), ""))
    until(page, f"lab.ready && {text} === {json.dumps(cd.scenes.spinning_ring().text)}")
    page.go_back()
    until(page, f"lab.ready && {text} === {json.dumps(told[1])}")


def test_a_link_takes_what_sliders_have_set_while_it_moves(page, opened):
    """Speed and load become those of the scene; a centre that was moved does not."""
    preset(page, "industrial_16b")
    before = page.evaluate("lab.lab.scene.text")
    choose(page, "speed driver", 450)
    choose(page, "load driven", 1000)
    choose(page, "centre driven x", 1)
    page.click("#link")
    until(page, "location.hash.length > 20")
    assert "without driven moved in x" in message(page)
    # The drive that moves is as it was opened.
    assert page.evaluate("lab.lab.scene.text") == before
    other = opened(page.evaluate("location.hash"))
    until(other, "lab.ready")
    drive = cd.Drive.from_toml(other.evaluate("lab.lab.scene.text")).resolved().to_dict()
    driver, driven = drive["sprockets"]
    was = cd.scenes.industrial_16b().resolved().to_dict()["sprockets"]
    sense = np.sign(was[0]["motion"]["speed"])
    assert driver["motion"]["speed"] == pytest.approx(sense * 450 * np.pi / 30)
    sense = np.sign(was[1]["load"][0]["torque"])
    assert driven["load"][0]["torque"] == pytest.approx(sense * 1000)


def test_a_link_of_python_opens_its_drive(opened):
    drive = cd.scenes.industrial_16b().replace({"route.pretension": 2222.0})
    page = opened(cd.lab_link(drive, ""))
    until(page, "lab.ready")
    assert page.evaluate("lab.lab.scene.text") == drive.text
    moves(page)


def test_a_damaged_link_is_told(opened):
    page = opened("#scene=AAAA")
    until(page, "lab.ready")
    assert "cannot be read" in message(page)
    moves(page)


def test_a_scene_may_stand_in_the_page(visit, tmp_path):
    text = cd.scenes.industrial_16b().text
    place = '<script id="scene" type="application/json">null</script>'
    page = PAGE.read_text(encoding="utf-8")
    assert page.count(place) == 1
    scene = json.dumps({"name": "mine", "text": text}).replace("<", "\\u003c")
    path = tmp_path / "lab.html"
    path.write_text(page.replace(place, place.replace("null", scene)), encoding="utf-8")
    page = visit(path, offline=True)
    until(page, "Boolean(window.lab)")
    assert page.inner_text("#title").startswith("Industrial drive")
    page.close()


def test_the_last_while_is_saved_as_a_replay(page, visit, tmp_path):
    preset(page, "industrial_16b")
    until(page, "lab.pictures > 30")
    page.click("#play")
    until(page, "!lab.playing && !lab.lab.asked")
    with page.expect_download(timeout=1000 * PATIENCE) as saved:
        page.click("#replay")
    path = tmp_path / "replay.html"
    saved.value.save_as(path)
    replay = visit(path)
    replay.wait_for_function("window.replay && window.replay.firstFrame")
    last = replay.evaluate("replay.frames") - 1
    assert last >= 20
    assert replay.evaluate(f"replay.time({last})") == pytest.approx(
        page.evaluate("lab.time"), rel=1e-2
    )
    shown = replay.evaluate(f"replay.value('roller_x', {last}, 5)")
    there = page.evaluate("lab.lab.film.arrays.roller_x.at(0, 5)")
    assert shown == pytest.approx(there, abs=1e-4)
    assert replay.errors == []
    replay.close()


def test_a_worker_that_ends_is_replaced(page):
    """After a panic a worker is of no more use: another goes on from the last snapshot."""
    until(page, "lab.lab.safe?.bytes")
    kept = page.evaluate("lab.lab.safe.time")
    page.evaluate("lab.lab.core.fail(new CoreError({ message: 'on purpose', ended: true }))")
    settles(page)
    assert "on purpose" in message(page)
    assert "goes on from" in message(page)
    until(page, f"lab.time > {kept!r}")
    page.evaluate("lab.lab.stop()")
    settles(page)
    assert message(page).startswith("Stopped.")
    moves(page)


def test_a_chain_that_would_break_is_told(page):
    preset(page, "industrial_16b")
    write_cell(page, "pretension in N", 200_000)
    until(page, "document.getElementById('message-text').textContent.includes('breaks at')")


@pytest.mark.parametrize("width", [360, 800, 1440])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_it_fits_every_width(opened, width, scheme):
    page = opened(viewport={"width": width, "height": 760}, color_scheme=scheme)
    assert page.evaluate("document.documentElement.dataset.theme") == scheme
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    assert page.locator("#picture").bounding_box()["height"] > 180
    assert page.locator("footer").bounding_box()["y"] < 760
    for dialog in ("edit", "own", "keys"):
        page.click(f"#{dialog}")
        box = page.locator("dialog[open]").bounding_box()
        assert box["x"] >= 0
        assert box["x"] + box["width"] <= width
        page.keyboard.press("Escape")


def test_a_report_is_made_in_the_background(page):
    preset(page, "spinning_ring")
    page.click("#judge")
    until(page, "!document.getElementById('report-save').disabled")
    assert "verdict" in page.inner_text("#report-text")
    page.keyboard.press("Escape")
    moves(page)


@pytest.mark.slow
def test_memory_stays(page):
    """A minute of play, between the 10th and the last second of it."""
    page.select_option("#speed", "50")
    session = page.context.new_cdp_session(page)
    session.send("HeapProfiler.enable")
    sizes = []
    for wait in (10, 50):
        page.wait_for_timeout(1000 * wait)
        session.send("HeapProfiler.collectGarbage")
        page_used = session.send("Runtime.getHeapUsage")["usedSize"]
        sizes.append((page_used, page.evaluate("lab.lab.memory()")))
    (page_before, module_before), (page_after, module_after) = sizes
    print(f"page {page_before} and {page_after} B, module {module_before} and {module_after} B")
    assert page_after <= 1.05 * page_before
    assert module_after <= 1.05 * module_before
