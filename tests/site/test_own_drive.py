"""A drive of one's own, laid out in the lab by a hand that knows nothing of scenes."""

import pytest
from lab_page import choose, is_built, moves, preset, settles, until, write_cell

pytestmark = is_built


def test_a_drive_of_ones_own_moves(page):
    page.click("#own")
    until(page, "document.getElementById('own-state').textContent.includes('pitches')")
    page.click("#own-idler")
    until(page, "document.querySelectorAll('#own-wheels tr').length === 3")
    page.click("#own-guide")
    until(page, "document.querySelector('#own-fits .first:enabled') !== null")
    page.click("#own-fits .first")
    until(page, "document.getElementById('own-state').textContent.includes('closes with')")
    page.click("#own-run")
    until(page, "!document.getElementById('own-drive').open")
    settles(page)
    assert page.inner_text("#title") == "A drive of one's own"
    assert page.evaluate("lab.lab.film.bodies.filter((it) => it.kind === 'sprocket').length") == 3
    moves(page)


def laid(page):
    until(page, "document.querySelector('#own-fits .first:enabled') !== null")


def test_any_legal_plan_tells_which_links_close_it(page):
    """Of 17 and 38 teeth at 600 mm no number of links closes as it stands."""
    page.click("#own")
    laid(page)
    for teeth in (17, 21):
        write_cell(page, "teeth of driver", teeth)
        laid(page)
        assert "pitches" in page.inner_text("#own-state")
    write_cell(page, "x in mm of driven", 617.3)
    page.click("#own-run")
    until(page, "!document.getElementById('own-drive').open")
    moves(page)


def test_a_load_that_follows_the_teeth_is_shown(page):
    """Defect: the field kept the torque of before, and the scene had the other."""
    page.click("#own")
    laid(page)
    torque = page.get_by_label("torque in N m of driven")
    before = float(torque.input_value())
    write_cell(page, "teeth of driven", 76)
    assert float(torque.input_value()) == page.evaluate("lab.lab.own.plan.wheels[1].value")
    assert float(torque.input_value()) > before


@pytest.mark.parametrize(
    ("label", "value", "words"),
    [
        ("teeth of driver", "100000", "teeth of driver: a number from 6 to 300"),
        ("teeth of driver", "", "teeth of driver: a number from 6 to 300"),
        ("x in mm of driven", "100", "overlaps"),
    ],
)
def test_a_wrong_entry_of_a_plan_is_told(page, label, value, words):
    page.click("#own")
    laid(page)
    write_cell(page, label, value)
    until(page, f"document.getElementById('own-state').textContent.includes({words!r})")
    if words == "overlaps":
        assert "sprockets" in page.inner_text("#own-state")
        assert page.locator("#own-run").is_disabled()


def test_nothing_of_the_sheet_moves_under_the_mouse(page):
    def places():
        boxes = (page.locator(f"#{it}").bounding_box() for it in ("own-idler", "own-run"))
        return [(it["x"], it["y"]) for it in boxes]

    page.click("#own")
    laid(page)
    before = places()
    page.click("#own-idler")
    page.click("#own-sprocket")
    laid(page)
    assert places() == before
    write_cell(page, "x in mm of driven", 10)
    until(page, "document.getElementById('own-state').className === 'bad'")
    assert places() == before


def test_a_plan_comes_back_with_its_drive(page, opened):
    page.click("#own")
    laid(page)
    write_cell(page, "teeth of driver", 23)
    page.click("#own-idler")
    page.click("#own-guide")
    laid(page)
    page.click("#own-run")
    until(page, "!document.getElementById('own-drive').open")
    settles(page)
    choose(page, "speed driver", 240)
    page.click("#link")
    until(page, "location.hash.length > 20")
    other = opened(page.evaluate("location.hash"))
    other.click("#own")
    until(other, "document.getElementById('own-state').textContent.includes('closes with')")
    plans = [it.evaluate("lab.lab.own.plan.wheels.map((it) => it.teeth)") for it in (page, other)]
    assert plans[0] == plans[1] == [23, 38, 17]
    assert other.get_by_label("speed in rpm of driver").input_value() == "240"
    # A drive that no sheet holds leaves the sheet as it is.
    other.keyboard.press("Escape")
    preset(other, "timing_drive")
    other.click("#own")
    until(other, "document.getElementById('own-drive').open")
    assert other.evaluate("lab.lab.own.plan.wheels.length") == 3


def test_a_wheel_is_dragged(page):
    page.click("#own")
    until(page, "document.getElementById('own-state').textContent.includes('pitches')")
    box = page.locator("#own-picture").bounding_box()
    x, y = page.evaluate(
        "() => { const o = lab.lab.own, w = o.plan.wheels[1], s = o.window; "
        "return [0.5 * s.width + (w.x - s.x) * s.scale, 0.5 * s.height - (w.y - s.y) * s.scale]; }"
    )
    before = page.evaluate("lab.lab.own.plan.wheels[1].x")
    page.mouse.move(box["x"] + x, box["y"] + y)
    page.mouse.down()
    page.mouse.move(box["x"] + x - 40, box["y"] + y - 10, steps=4)
    page.mouse.up()
    assert page.evaluate("lab.lab.own.plan.wheels[1].x") < before - 0.01
