"""Layouts: numbers of links, guides by share, places that close, and the scenes that say so."""

import json
import math
import re
import subprocess
import sys

import numpy as np
import pytest

import chaindrive as cd
from chaindrive import design
from chaindrive.design import Guide, Idler, Sprocket

PITCH = 8e-3
PLATE = 7.11e-3

TIMING = [
    Sprocket("crank", 18, (0.0, 0.0)),
    Guide("fixed", 2.2, 3e-3, (0.25, 0.75), height=PLATE, touches="plates"),
    Sprocket("exhaust", 36, (0.056, 0.297)),
    Sprocket("intake", 36, (-0.056, 0.297)),
    Guide("shoe", 0.45, 12e-3, (0.19, 0.81), height=PLATE, touches="plates"),
]


def test_a_timing_drive_is_laid_out_without_a_pocket_calculator():
    """Centre of the shoe and bow as an earlier layout by hand had them."""
    laid = design.close(TIMING, PITCH, 118, move="shoe")
    assert 12e-3 + laid.travel == pytest.approx(12.795304822057858e-3, abs=1e-12)
    assert abs(laid.misfit) < 1e-12
    faces = {face.name: face for face in laid.faces}
    np.testing.assert_allclose(
        faces["fixed"].centre, (2.1867088471534073, -0.43055664370824526), atol=1e-12
    )
    np.testing.assert_allclose(
        faces["shoe"].centre, (-0.4870151800010447, 0.02537279371044686), atol=1e-12
    )
    assert [stop.name for stop in laid.stops] == [stop.name for stop in TIMING]
    assert sum(span.links for span in laid.spans) + sum(s.seated - 1 for s in laid.stops) == 118
    turned = sum(math.copysign(s.wrap, 1 if s.side == "left" else -1) for s in laid.stops)
    assert turned == pytest.approx(2 * math.pi)
    for span in laid.spans:
        along = np.subtract(span.arrives, span.leaves)
        assert np.hypot(*along) == pytest.approx(span.length)
        assert math.remainder(math.atan2(along[1], along[0]) - span.direction, 2 * math.pi) == (
            pytest.approx(0, abs=1e-12)
        )
    # A worn chain is longer: the shoe goes on, and ever further.
    travels = [worn.travel for worn in laid.wear if worn.travel is not None]
    assert travels[0] == pytest.approx(laid.travel)
    assert len(travels) > 1
    assert all(np.diff(travels) > 0)


def test_numbers_of_links_and_distances_belong_to_each_other():
    stops = [Sprocket("driver", 19, (0, 0)), Sprocket("driven", 38, (0.4, 0))]
    laid = design.layout(stops, 12.7e-3, 92)
    counts = laid.counts
    assert counts.below < counts.pitches < counts.above == counts.below + 1
    assert {counts.even_below, counts.even_above} >= {92}
    assert laid.misfit == pytest.approx((counts.pitches - 92) * 12.7e-3)
    for fit in laid.fits:
        assert fit.offset_link == (fit.links % 2 == 1)
        moved = [stops[0], stops[1]._replace(centre=fit.centre)]
        again = design.layout(moved, 12.7e-3, fit.links)
        assert abs(again.misfit) < 1e-12
        assert again.counts.below == again.counts.above == fit.links
        smooth = cd.kinematics.centre_distance(19, 38, 12.7e-3, fit.links)
        assert fit.centre_distance == pytest.approx(smooth, abs=1e-4)


def test_an_idler_is_wrapped_as_asked():
    stops = [
        Sprocket("a", 30, (0, 0)),
        Sprocket("b", 30, (0.5, 0)),
        Idler("idler", 12, math.radians(30)),
    ]
    laid = design.layout(stops, PITCH)
    assert laid.stops[2].wrap == pytest.approx(math.radians(30), abs=1e-9)
    # The upper span runs back: the idler lies above and pushes down, half-way.
    assert laid.stops[2].centre[0] == pytest.approx(0.25)
    with pytest.raises(cd.ParameterError, match="wraps the idler by"):
        design.layout([*stops[:2], Idler("idler", 12, math.radians(170))], PITCH)


def test_mistakes_are_named():
    with pytest.raises(cd.ParameterError, match="`a` and `b` overlap"):
        design.layout([Sprocket("a", 18, (0, 0)), Sprocket("b", 18, (0.01, 0))], PITCH)
    with pytest.raises(cd.ParameterError, match="no stop has this name"):
        design.close(TIMING, PITCH, 118, move="rail")
    with pytest.raises(cd.ParameterError, match="do not close"):
        design.close(TIMING, PITCH, 90, move="shoe")
    with pytest.raises(cd.ParameterError, match='"left" or "right"'):
        design.layout([TIMING[0], TIMING[2]._replace(side="up")], PITCH)


def test_presets_are_laid_out_as_they_run():
    for name in ["timing_drive", "two_stage_timing", "marine_engine", "bicycle_crank"]:
        drive = getattr(cd.scenes, name)()
        layouts = design.of(drive)
        assert sum(laid.links for laid in layouts) == drive.links
        for laid in layouts:
            assert abs(laid.misfit) < 1e-6, name
    assert design.clashes(cd.scenes.marine_engine()) == ()


def test_a_chain_that_does_not_close_is_laid_out_all_the_same():
    drive = cd.scenes.industrial_16b().replace({"chain.links": 118})
    (laid,) = design.of(drive)
    assert laid.links == 118
    assert laid.misfit == pytest.approx(2 * 25.4e-3, rel=1e-6)
    (fit,) = [fit for fit in laid.fits if fit.links == 118]
    with pytest.raises(cd.AssemblyError, match=f"{fit.centre_distance * 1e3:.2f}"):
        drive.describe()


def test_the_command_prints_what_the_module_says():
    command = [sys.executable, "-m", "chaindrive", "design"]

    def told(*arguments):
        done = subprocess.run([*command, *arguments], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return done.stdout

    found = json.loads(told("timing_drive", "--json"))
    (laid,) = design.of(cd.scenes.timing_drive())
    assert [span["name"] for span in found["chains"][0]["spans"]] == [s.name for s in laid.spans]
    assert found["chains"][0]["counts"]["pitches"] == laid.counts.pitches
    text = told("--sprockets", "19,38", "--pitch", "12.7mm", "--centre-distance", "400mm")
    assert "92 links" in text
    assert "would close" in text
    text = told("--sprockets", "19,57", "--pitch", "25.4 mm", "--links", "120")
    assert "1029.929958" in text
    wrong = subprocess.run([*command, "--sprockets", "19"], capture_output=True, text=True)
    assert wrong.returncode == 2


SCENE = """
[chain]
type = "08B-1"

[[sprockets]]
name = "driver"
teeth = 19
centre = ["0 mm", "0 mm"]
motion = "held"

[[sprockets]]
name = "driven"
teeth = 38
centre = ["CENTRE mm", "0 mm"]
inertia = "1 kg m^2"

[[guides]]
name = "rail"
face = { kind = "on-span", from = "20 %", to = "80 %", radius = "2 m" BOW }

[route]
stops = ["driver", "rail", "driven"]
"""


def scene(centre, bow="", links=None):
    text = SCENE.replace("CENTRE", str(centre)).replace("BOW", bow)
    return text.replace('"08B-1"', f'"08B-1"\nlinks = {links}' if links else '"08B-1"')


def test_a_bow_left_open_closes_the_links_and_is_told():
    """The rail of a scene is that of the module, and the text in full makes the same drive."""
    drive = cd.Drive.from_toml(scene(401.2, links=92))
    (laid,) = design.of(drive)
    assert abs(laid.misfit) < 1e-12
    full = drive.resolved()
    assert "computed: 92 links close without stress" in full.text
    (again,) = design.of(full)
    assert again == laid
    stops = [
        Sprocket("driver", 19, (0, 0)),
        Guide("rail", 2.0, 3e-3, (0.2, 0.8), height=8.51e-3),
        Sprocket("driven", 38, (0.4012, 0)),
    ]
    closed = design.close(stops, 12.7e-3, 92, move="rail")
    np.testing.assert_allclose(laid.stops[1].centre, closed.stops[1].centre, atol=1e-12)
    # Without a number of links or a bow there is nothing that either could follow from.
    with pytest.raises(cd.SceneError, match=r"guides\[0\].face.bow: missing; give it"):
        cd.Drive.from_toml(scene(401))


def test_a_bow_that_closes_nothing_is_told_with_how_far_it_reaches():
    """The lengths of the route between which bows can choose, measured with bows of our own."""
    with pytest.raises(cd.SceneError, match="smaller radius") as refused:
        cd.Drive.from_toml(scene(401.2, links=94))
    least, most = map(float, re.findall(r"made ([\d.]+) to ([\d.]+) links", str(refused.value))[0])
    for bow in (1, 4, 8):
        drive = cd.Drive.from_toml(scene(401.2, bow=f', bow = "{bow} mm"', links=92))
        (laid,) = design.of(drive)
        assert least - 5e-4 <= laid.counts.smooth <= most + 5e-4 < 94


def test_the_number_of_links_follows_from_routes_over_guides():
    drive = cd.Drive.from_toml(scene(401, bow=', bow = "8 mm"'))
    (laid,) = design.of(drive)
    assert drive.links == laid.counts.even_above
    with pytest.raises(cd.SceneError, match=r"too few and \d+ too many; move `driven` to \("):
        cd.Drive.from_toml(scene(404, bow=', bow = "8 mm"'))


def test_straight_rails_keep_clear_by_as_much_as_is_said():
    """The face stands off the rollers of the taut strand, over the shares."""
    marine = cd.scenes.marine_engine()
    (laid,) = design.of(marine)
    (span,) = [span for span in laid.spans if span.name == "crank-camshaft"]
    face = {
        "kind": "on-span",
        "between": ["crank", "camshaft"],
        "from": 0.1,
        "to": 0.9,
        "bow": "-5 mm",
    }
    drive = marine.replace({"guides.crank-to-camshaft.face": face})
    rail = drive.profile("crank-to-camshaft")
    along = np.array([math.cos(span.direction), math.sin(span.direction)])
    roller = 53.98e-3 / 2
    for share in [0.1, 0.5, 0.9]:
        place = np.asarray(span.leaves) + share * span.length * along
        assert rail.distance(place) == pytest.approx(roller + 5e-3, abs=1e-9)
    with pytest.raises(cd.SceneError, match="between: no sprocket is named `cam`"):
        marine.replace({"guides.crank-to-camshaft.face": {**face, "between": ["crank", "cam"]}})


def test_chains_are_known_by_their_names():
    stops = [cd.design.Sprocket("driver", 19, (0, 0)), cd.design.Sprocket("driven", 57, (1, 0))]
    assert cd.design.layout(stops, chain="16B-1") == cd.design.layout(stops, 25.4e-3)
    assert cd.design.close(stops, links=118, chain="16b") == cd.design.close(stops, 25.4e-3, 118)
    # Rollers are half their diameter from the face that they touch.
    rail = cd.design.Guide("rail", radius=2.0, bow=5e-3)
    told = cd.design.layout([stops[0], rail, stops[1]], chain="16B-1")
    said = cd.design.layout([stops[0], rail._replace(height=15.88e-3), stops[1]], 25.4e-3)
    assert told.stops == said.stops
    for settings, path in [({"chain": "16C"}, "chain"), ({}, "pitch")]:
        with pytest.raises(cd.ParameterError) as caught:
            cd.design.layout(stops, **settings)
        assert caught.value.path == path
    with pytest.raises(cd.ParameterError, match="no chain of the catalogue is named `16C`"):
        cd.design.layout(stops, chain="16C")
    with pytest.raises(cd.ParameterError, match="give their number"):
        cd.design.close(stops, chain="16B-1")
