"""Drawings: what is measured in them is what the simulation has.

Gaps are measured in the text of the SVG files, between circles and paths of straight lines and
arcs, by formulas of their own. The simulation says which rollers press on teeth, how deep the
deepest is, and through `Drive.profile` how far the others are from teeth and guides that stood
elsewhere when the run began.
"""

import base64
import re
import subprocess
import sys

import numpy as np
import pytest
from drives import random_drive

import chaindrive as cd

# Coordinates have four digits after the point of a millimetre; both ends of a distance round [m].
DIGITS = 2e-7

_TOKEN = re.compile(r"[MLAZ]|-?[0-9.]+(?:e-?[0-9]+)?")


def part(svg, kind, name):
    """Return the attributes of the element with this id, in which blanks have their number."""
    name = name.replace(" ", "_20")
    found = re.search(rf'<(\w+) id="{re.escape(kind)}-{re.escape(name)}" ([^>]*)/>', svg)
    assert found, f"{kind}-{name}"
    return dict(re.findall(r'([\w-]+)="([^"]*)"', found[2]))


def rollers(svg, chain=""):
    """Return centres (n, 2) and radius of the rollers of a chain [m]."""
    circles = re.findall(
        rf'<circle id="roller-{chain}(\d+)" class="roller" cx="([^"]+)" cy="([^"]+)" r="([^"]+)"/>',
        svg,
    )
    numbers = np.array(circles, dtype=float)
    assert (numbers[:, 0] == np.arange(len(numbers))).all()
    return 1e-3 * numbers[:, 1:3], 1e-3 * numbers[0, 3]


def pieces(path):
    """Return lines and arcs of path data [m]: start, end, radius or None, counter-clockwise."""
    tokens = _TOKEN.findall(path)
    found, here, first = [], None, None
    at = 0

    def numbers(count):
        nonlocal at
        values = [float(token) for token in tokens[at : at + count]]
        at += count
        return values

    while at < len(tokens):
        command = tokens[at]
        at += 1
        if command == "M":
            here = first = 1e-3 * np.array(numbers(2))
        elif command == "L":
            end = 1e-3 * np.array(numbers(2))
            found.append((here, end, None, True))
            here = end
        elif command == "A":
            radius, _, _, large, turn, x, y = numbers(7)
            assert large == 0
            end = 1e-3 * np.array([x, y])
            found.append((here, end, 1e-3 * radius, turn == 1))
            here = end
        else:
            found.append((here, first, None, True))
            here = first
    return found


def distances(path, places):
    """Return the distances of places (n, 2) from the curve of path data [m]."""
    nearest = np.full(len(places), np.inf)
    for start, end, radius, left in pieces(path):
        chord = end - start
        length = np.hypot(*chord)
        if length == 0:
            continue
        if radius is None:
            along = np.clip((places - start) @ chord / length**2, 0, 1)
            away = places - (start + along[:, None] * chord)
            nearest = np.minimum(nearest, np.hypot(*away.T))
            continue
        # Of the two centres the one that lies left of the chord, for a short arc to the left.
        radius = max(radius, length / 2)
        side = np.array([-chord[1], chord[0]]) / length * (1 if left else -1)
        centre = (start + end) / 2 + side * np.sqrt(radius**2 - length**2 / 4)
        away = places - centre
        middle = (start + end) / 2 - centre
        if np.hypot(*middle) < 1e-9 * radius:
            middle = -side
        middle = middle / np.hypot(*middle)
        half = np.arcsin(min(length / (2 * radius), 1.0))
        angle = np.arccos(np.clip(away @ middle / np.hypot(*away.T), -1, 1))
        within = angle <= half
        to_ends = np.minimum(np.hypot(*(places - start).T), np.hypot(*(places - end).T))
        to_arc = np.abs(np.hypot(*away.T) - radius)
        nearest = np.minimum(nearest, np.where(within, to_arc, to_ends))
    return nearest


def turned(places, angle, about):
    rotation = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return (places - about) @ rotation.T + about


class Carrier:
    """How a tensioner moves points, from the resolved scene alone."""

    def __init__(self, drive, run, name):
        tensioners = drive.resolved().to_dict()["tensioners"]
        self.carrier = next(it for it in tensioners if it["name"] == name)["carrier"]
        self.position = run["tensioner_position"].sel(tensioner=name)

    def back(self, places, index):
        """Return places (n, 2) of a sample as a carrier sees them that stands as at the start."""
        moved = float(self.position[index] - self.position[0])
        if self.carrier["kind"] == "arm":
            return turned(places, -moved, np.array([metres(it) for it in self.carrier["pivot"]]))
        direction = np.array([float(it) for it in self.carrier["direction"]])
        return places - moved * direction / np.hypot(*direction)


def metres(value):
    if isinstance(value, (int, float)):
        return float(value)
    number, _, unit = value.partition(" ")
    return float(number) * {"m": 1.0, "mm": 1e-3, "": 1.0}[unit]


def check(drive, *, samples=20, until=None):
    """Compare a drive's drawings with its simulation at some instants of a short run."""
    wanted = ["contact_force", "contact_depth", "roller_x", "roller_y", "guide_force_x"]
    wanted += ["guide_force_y", "sprocket_angle", "sprocket_x", "sprocket_y", "tensioner_position"]
    until = until or min(drive.run_defaults["until"], 5e-3)
    every = until / (samples - 1)
    run = cd.simulate(
        drive, until=until, every=every, run_in=0, record=wanted, events="teeth", error=False
    )
    assert run.sizes["time"] >= samples
    # Forces between two steps are those of both: a roller may bear one when it has parted within
    # the step, or is yet to touch in it.
    fastest = run["event_onset_speed"].values.max(initial=0.0) if "event" in run.sizes else 0.0
    within_a_step = fastest * run.attrs["step"]
    scene = drive.resolved().to_dict()
    chains = drive.chains or {"": drive.links}
    names = [f"{name}-" if name else "" for name in chains]
    profiles = {name: drive.profile(name) for name in [*drive.sprockets, *drive.guides]}
    shoes = {guide["name"]: guide for guide in scene.get("guides", [])}
    worst = {"depth": 0.0, "pressing": 0.0, "open": 0.0}
    counted = 0
    for index in range(samples):
        svg = cd.plot.svg(run, float(run["time"][index]), drive=drive)
        now = run.isel(time=index)
        first = 0
        deepest = dict.fromkeys(drive.sprockets, 0.0)
        for chain, name in zip(figure_chains(drive), names, strict=True):
            centres, radius = rollers(svg, name)
            force = now["contact_force"].values[first : first + len(centres)]
            first += len(centres)
            touched = np.zeros(len(centres), dtype=bool)
            for sprocket in (drive.sprockets[it] for it in chain["sprockets"]):
                gaps = distances(part(svg, "sprocket", sprocket)["d"], centres) - radius
                deepest[sprocket] = max(deepest[sprocket], -gaps.min())
                touched |= gaps < 0
                # Gaps of the same rollers to the teeth as they stood at the start.
                there = [
                    np.array(
                        [run[f"sprocket_{axis}"].sel(sprocket=sprocket)[at] for axis in "xy"],
                        dtype=float,
                    )
                    for at in (0, index)
                ]
                angle = run["sprocket_angle"].sel(sprocket=sprocket)
                angle = float(angle[index] - angle[0])
                seen = turned(centres - there[1] + there[0], -angle, there[0])
                expected = profiles[sprocket].distance(seen) - radius
                near = gaps < chain["pitch"]
                worst["open"] = max(worst["open"], np.abs(gaps - expected)[near].max(initial=0.0))
                counted += int(near.sum())
            # A roller presses only where it overlaps in the step. One that parts faster than its
            # damper lets it overlaps and does not press, by no more than the simulation says.
            gaps = np.min(
                [
                    distances(part(svg, "sprocket", drive.sprockets[it])["d"], centres)
                    for it in chain["sprockets"]
                ]
                or [np.full(len(centres), 1.0)],
                axis=0,
            )
            gaps = gaps - radius
            parting = -gaps[force == 0].min(initial=0.0) - now["contact_depth"].values.max(
                initial=0.0
            )
            apart = gaps[force > 0].max(initial=0.0) - within_a_step
            worst["pressing"] = max(worst["pressing"], apart, parting)
            for guide in (drive.guides[it] for it in chain["guides"]):
                face = part(svg, "guide", guide)["d"]
                support = shoes[guide].get("support", {"kind": "fixed"})
                seen = centres
                if isinstance(support, dict) and support["kind"] == "tensioner":
                    seen = Carrier(drive, run, support["name"]).back(centres, index)
                elif isinstance(support, dict) and support["kind"] != "fixed":
                    continue
                drawn = distances(face, centres)
                expected = np.abs(profiles[guide].distance(seen))
                near = drawn < 3 * chain["pitch"]
                worst["open"] = max(worst["open"], np.abs(drawn - expected)[near].max(initial=0.0))
                counted += int(near.sum())
        for sprocket, depth in deepest.items():
            said = float(now["contact_depth"].sel(sprocket=sprocket))
            worst["depth"] = max(worst["depth"], abs(max(depth, 0.0) - max(said, 0.0)))
    return worst, counted


def figure_chains(drive):
    return drive._inner.figure(False, 0.0).chains


# Every preset stands in one of the two lists.
QUICK = ["industrial_16b", "spinning_ring", "timing_drive", "two_stage_timing"]
SLOW = [
    "bicycle",
    "bicycle_crank",
    "bicycle_derailleur",
    "bicycle_slack",
    "chain_pendulum",
    "hanging_chain",
    "marine_engine",
    "marine_engine_bare",
    "marine_engine_oil",
    "marine_two_sprockets",
    "motorcycle",
    "pendulum_in_bush",
    "pin_in_bush",
]
LOTS = range(20)


def test_every_preset_is_drawn_and_measured():
    assert sorted([*QUICK, *SLOW]) == sorted(cd.scenes.presets())


@pytest.mark.parametrize(
    "name", [*QUICK, *(pytest.param(name, marks=pytest.mark.slow) for name in SLOW)]
)
def test_gaps_in_drawings_of_presets_are_those_of_the_simulation(name):
    drive = getattr(cd.scenes, name)()
    worst, counted = check(drive, samples=6 if name in QUICK else 20)
    print(f"{name}: {worst} of {counted}")
    assert max(worst.values()) < DIGITS, worst
    assert counted > 20 or not drive.sprockets


@pytest.mark.parametrize(
    "seed", [*LOTS[:6], *(pytest.param(seed, marks=pytest.mark.slow) for seed in LOTS[6:])]
)
def test_gaps_in_drawings_of_drives_by_lot_are_those_of_the_simulation(seed):
    samples = 6 if seed in LOTS[:6] else 20
    worst, counted = check(random_drive(seed), samples=samples)
    print(f"lot {seed}: {worst} of {counted}")
    assert max(worst.values()) < DIGITS, worst
    assert counted > 10 * samples


def along(path, count):
    """Return places (pieces × count, 2) along the arcs and lines of path data [m]."""
    found = []
    for start, end, radius, left in pieces(path):
        chord = end - start
        length = np.hypot(*chord)
        share = np.linspace(0, 1, count)[:, None]
        if radius is None:
            found.append(start + share * chord)
            continue
        side = np.array([-chord[1], chord[0]]) / length * (1 if left else -1)
        centre = (start + end) / 2 + side * np.sqrt(radius**2 - length**2 / 4)
        sweep = 2 * np.arcsin(length / (2 * radius)) * (1 if left else -1)
        first = np.arctan2(*(start - centre)[::-1])
        angle = first + share[:, 0] * sweep
        found.append(centre + radius * np.stack([np.cos(angle), np.sin(angle)], axis=1))
    return np.concatenate(found)


def test_plates_lie_on_the_guides_that_carry_them():
    """A guide that is pressed touches the edge of a plate, one that is not keeps away from all."""
    drive = cd.scenes.timing_drive()
    wanted = ["roller_x", "roller_y", "sprocket_angle", "tensioner_position"]
    wanted += ["guide_force_x", "guide_force_y"]
    run = cd.simulate(drive, until=4e-3, every=2e-3, run_in=0, record=wanted, error=False)
    pressed = 0
    for now in (run.isel(time=index) for index in range(run.sizes["time"])):
        svg = cd.plot.svg(run, float(now["time"]))
        plates = re.findall(r'<path id="plate-\d+" class="plate" d="([^"]+)"/>', svg)
        for guide in drive.guides:
            face = along(part(svg, "guide", guide)["d"], 800)
            nearest = min(distances(plate, face).min() for plate in plates)
            force = np.hypot(*(float(now[f"guide_force_{it}"].sel(guide=guide)) for it in "xy"))
            pressed += force > 0
            # 40 N on plastic of 5 MN/m are 8 micrometres.
            assert (nearest < 2e-5) == (force > 0), (guide, nearest, force)
    assert pressed > 4


def test_a_chain_that_does_not_close_is_drawn_with_its_gap():
    """Two links less than what closes leave a gap of two pitches, on the straight last span."""
    drive = cd.scenes.industrial_16b().replace({"chain.links": 118})
    with pytest.raises(cd.AssemblyError):
        drive.describe()
    svg = drive.svg()
    centres, _ = rollers(svg)
    # A strand has one roller more than links.
    assert len(centres) == 119
    assert len(re.findall('class="plate"', svg)) == 118
    steps = np.hypot(*np.diff(centres, axis=0).T)
    np.testing.assert_allclose(steps, 25.4e-3, atol=2e-5)
    gap = part(svg, "gap", "0")
    ends = 1e-3 * np.array([[float(gap[f"{axis}{end}"]) for axis in "xy"] for end in (1, 2)])
    np.testing.assert_allclose(ends, centres[[-1, 0]], atol=1e-9)
    assert np.hypot(*(ends[1] - ends[0])) == pytest.approx(50.8e-3, abs=2e-4)
    assert "50.8 mm are missing" in svg
    assert "118" in re.search(r'class="told"[^>]*>([^<]*118[^<]*)<', svg)[1]


def test_clashes_are_marked_where_they_are():
    """A bar across the taut span, through the line of the rollers."""
    drive = cd.scenes.industrial_16b()
    places = drive._inner.figure(False, 0.0).start()["rollers"][0]
    # The middle of the span that comes back to the driver, from right to left; across it upwards.
    x, y = places[(places[:, 0] > 0.4) & (places[:, 0] < 0.6) & (places[:, 1] > 0)].mean(axis=0)
    bar = {"kind": "bar", "start": [x + 0.1, y + 0.04], "end": [x - 0.1, y - 0.07]}
    bar |= {"end_radius": 0.05, "end_angle": "20 deg"}
    values = drive.to_dict()
    values["guides"] = [{"name": "bar", "face": bar}]
    clashing = cd.Drive.from_dict(values)
    figure = clashing._inner.figure(False, 0.0)
    svg = clashing.svg(settled=False)
    assert figure.clashes
    assert "guide `bar`" in figure.problem
    for number, (at_x, at_y, depth, told) in enumerate(figure.clashes):
        assert "guide `bar`" in told
        mark = part(svg, "clash", str(number))
        assert 1e-3 * float(mark["cx"]) == pytest.approx(at_x, abs=1e-6)
        assert 1e-3 * float(mark["cy"]) == pytest.approx(at_y, abs=1e-6)
        assert np.hypot(at_x - x, at_y - y) < 0.15
        assert f">{1e3 * depth:.1f} mm</text>" in svg


def test_the_command_draws_scenes_and_results(tmp_path):
    def told(*arguments):
        command = [sys.executable, "-m", "chaindrive", *arguments]
        return subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, check=False)

    drive = cd.scenes.timing_drive()
    done = told("draw", "timing_drive", "-o", "timing.svg")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "timing.svg").read_text() == drive.svg()
    assert "--overwrite" in told("draw", "timing_drive", "-o", "timing.svg").stderr
    run = cd.simulate(
        drive, until=1e-3, every=1e-4, run_in=0, output=tmp_path / "run.zarr", error=False
    )
    done = told("draw", "run.zarr", "--at", "0.52 ms")
    assert done.returncode == 0, done.stderr
    expected = cd.plot.svg(run, 5e-4)
    # But for the title.
    assert done.stdout.splitlines()[2:] == expected.splitlines()[2:]


def test_a_frame_says_which_channel_is_missing():
    drive = cd.scenes.timing_drive()
    run = cd.simulate(
        drive, until=1e-4, every=1e-4, run_in=0, record=["roller_x", "roller_y"], error=False
    )
    with pytest.raises(
        cd.ParameterError, match=r"sprocket_angle.*'sprocket_angle', 'tensioner_position'"
    ):
        cd.plot.svg(run, 0.0)


def test_notebooks_show_drives():
    drive = cd.scenes.two_stage_timing()
    (data,) = re.findall(r'src="data:image/svg\+xml;base64,([^"]+)"', drive._repr_html_())
    assert base64.b64decode(data).decode() == drive._repr_svg_()
    assert 'id="roller-primary-0"' in drive._repr_svg_()


def rotation(svg, name):
    """Sense of the arrow of a sprocket about its centre: +1 counter-clockwise, 0 without one."""
    found = re.search(rf'<path id="rotation-{name}" class="rotation" d="([^"]+)"/>', svg)
    if found is None:
        return 0
    numbers = [[float(it) for it in re.findall(r"-?[\d.]+", part)] for part in found[1].split("M")]
    arc, (*_, tip_x, tip_y, _, _) = numbers[1], numbers[2]
    start, end = np.array(arc[:2]), np.array(arc[-2:])
    # The head stands at the end of the arc.
    assert (tip_x, tip_y) == tuple(end)
    line = re.search(rf'id="sprocket-{name}-spoke" x1="([^"]+)" y1="([^"]+)"', svg)
    centre = np.array([float(line[1]), float(line[2])])
    a, b = start - centre, end - centre
    assert np.hypot(*a) == pytest.approx(np.hypot(*b), abs=2e-4)
    return int(np.sign(a[0] * b[1] - a[1] * b[0]))


def test_arrows_show_which_way_sprockets_turn():
    """By the mean speed: the reversed speed reverses them, and what stands still has none."""
    pyplot = pytest.importorskip("matplotlib.pyplot")
    names = ("driver", "driven")
    for sense in (1, -1):
        drive = cd.scenes.industrial_16b().replace({"sprockets.driver.motion.speed": 30.0 * sense})
        assert [rotation(drive.svg(), name) for name in names] == [sense, sense]
        # As it is laid, before anything passes speeds on.
        assert [rotation(drive.svg(settled=False), name) for name in names] == [sense, 0]
        ax = cd.plot.layout(drive)
        arrows = [line.get_xydata() for line in ax.lines if line.get_label() == "_rotation"]
        # An arc and a head for each; below the centre the arc goes to the right.
        assert [np.sign(it[-1, 0] - it[0, 0]) for it in arrows[::2]] == [sense, sense]
        assert len(arrows) == 4
        pyplot.close(ax.figure)
    still = cd.scenes.industrial_16b().replace({"sprockets.driver.motion": {"kind": "held"}})
    assert [rotation(still.svg(), name) for name in names] == [0, 0]
