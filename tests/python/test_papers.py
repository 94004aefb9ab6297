"""The two papers: their scripts run from end to end, and their verdicts are those of statistics."""

import importlib
import math
import re
from pathlib import Path

import numpy as np
import pytest

import chaindrive as cd

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "examples" / "papers"


@pytest.fixture
def papers(monkeypatch):
    """Import a module of examples/papers."""
    monkeypatch.syspath_prepend(FOLDER)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    replicates = importlib.import_module("replicates")
    monkeypatch.setattr(replicates, "PHASES", (0.3, 0.7))
    return importlib.import_module


@pytest.mark.slow
@pytest.mark.parametrize(
    ("script", "stem", "short"),
    [
        ("marine", "marine-paper", ["--until", "0.02", "--run-in", "0"]),
        ("bicycle", "bicycle-paper", ["--until", "0.001", "--run-in", "0"]),
    ],
)
def test_scripts_run_and_fill_their_pages(papers, tmp_path, script, stem, short):
    page = (ROOT / "docs" / f"{stem}.md").read_text(encoding="utf-8")
    (tmp_path / f"{stem}.md").write_text(page, encoding="utf-8")
    module = papers(script)
    module.main([*short, "--results", str(tmp_path)])
    written = (tmp_path / f"{stem}.md").read_text(encoding="utf-8")
    # Every table of the page is new, and no prose between them is.
    tables = re.compile(r"(<!-- (?!end)[^>]+ -->\n).*?(<!-- end -->)", re.DOTALL)
    assert tables.sub(r"\1\2", written) == tables.sub(r"\1\2", page)
    assert len(tables.findall(written)) >= 10
    figures = re.findall(r"\]\((\S+\.png)\)", page)
    assert len(figures) >= 4
    for name in figures:
        assert (tmp_path / name).stat().st_size > 10_000
        assert (ROOT / "docs" / name).stat().st_size < 300_000


def test_verdicts_find_what_is_there_and_one_in_a_hundred_that_is_not(papers):
    """Student's t of five differences, against noise of which the truth is known."""
    replicates = papers("replicates")
    noise = np.random.default_rng(11)
    found = 0
    for _ in range(2000):
        base, other = 100.0 + noise.standard_normal((2, 5))
        by, scatter = replicates.difference(base, other)
        found += abs(by) > scatter
    # 20 expected, standard deviation 4.4.
    assert 6 <= found <= 34
    base = np.array([100.0, 101.0, 99.0, 100.5, 99.5])
    assert replicates.verdict(base, base + 10.0).startswith("**+10.00 ± 0")
    assert replicates.verdict(base, base[::-1]).startswith("≈")


def test_harmonics_are_those_of_a_known_wave(papers):
    times = np.linspace(0.0, 1.0, 400)
    wave = 3.0 + 2.0 * times + 0.5 * np.cos(2.0 * math.pi * 7.0 * times + 0.3)
    found = papers("replicates").harmonics(times, wave, 7.0, 2)
    assert found[0] == pytest.approx(0.5 * np.exp(0.3j), abs=1e-9)
    assert abs(found[1]) < 1e-9


def test_the_offset_of_a_span_is_its_sag(papers):
    """A chain at rest: gravity bends the middle of a span by m′ g⊥ ℓ²/(8 T), outward."""
    drive_of = papers("marine_drive")
    drive = drive_of.paper().replace(
        {"guides": [], "sprockets.crank.motion": {"kind": "constant", "speed": 0.0}}
    )
    run = drive_of.observe(drive, drive_of.Length(0.01, 0.0), every=1e-3)
    ends, normal = drive_of.tangent(drive, drive_of.TIGHT, run)
    length = np.hypot(*(ends[1] - ends[0]))
    tension = float(run["span_tension"].sel(span=drive_of.TIGHT)[0])
    across = -9.81 * normal[1] * drive_of.MASS / drive_of.PITCH
    sag = across * length**2 / (8.0 * tension)
    found = drive_of.offset(drive, drive_of.TIGHT, run)[0]
    assert found == pytest.approx(sag, rel=0.15)


def test_a_span_of_waves_is_parted_by_frequency(papers):
    """Root mean squares of two sines, one below half the mesh frequency and one above."""
    drive_of = papers("marine_drive")
    time = drive_of.EVERY * np.arange(5000)
    mesh = drive_of.TEETH * drive_of.SPEED / 60.0
    wave = 3e-3 * np.sin(2.0 * np.pi * 12.0 * time) + 1e-3 * np.sin(2.0 * np.pi * mesh * time)
    found = drive_of.by_frequency(wave)
    assert found["slow"] == pytest.approx(3e-3 / np.sqrt(2.0), rel=1e-3)
    assert found["fast"] == pytest.approx(1e-3 / np.sqrt(2.0), rel=1e-3)


def test_bars_of_all_shapes_are_equally_near(papers):
    """5 mm from the rollers of a straight span, of all four faces, at their nearest place."""
    bars = papers("marine_bars")
    drive = papers("marine_drive").paper()
    bar = bars.BARS[0]
    line = bars.Line(drive, bar)
    places = np.array([line.place(share, 0.0) for share in np.linspace(0.0, 1.0, 801)])
    for name, shape in bars.SHAPES.items():
        shaped = drive.replace({f"guides.{bar}.face": shape(line)})
        profile = shaped.profile(bar, settled=False)
        nearest = float(profile.distance(places).min())
        assert nearest == pytest.approx(bars.CLEAR, abs=0.1e-3), name


def test_a_driver_that_swings_loses_no_tooth(papers):
    """Reversals five times a second, an idler on which few teeth bear: the ledger closes."""
    far, length = papers("far_swings"), papers("marine_drive").Length(0.1, 0.1)
    found = far.measure_swing(far.swinging(far.WIDEST), length)
    assert found["one"] > 0.5
    assert found["none"] + found["one"] + found["two"] == pytest.approx(1.0)
    assert found["apart"] < 0.1
    assert found["residual"] < 1e-3


def test_a_life_is_the_integral_of_slowness(papers):
    """t = ∫ dε/(a − b ε) = ln[a/(a − b ε)]/b."""
    grown = np.linspace(0.0, 0.01, 401)
    rate = 2e-6 - 1e-4 * grown
    hours = papers("life").over_life(grown, rate)
    assert hours[-1] == pytest.approx(np.log(2e-6 / rate[-1]) / 1e-4, rel=1e-6)
    assert hours[0] == 0.0


def test_what_rigid_bodies_leave_out_is_computed_right():
    """The table of beams in docs/models.md: every figure by its formula."""
    text = (ROOT / "docs" / "models.md").read_text(encoding="utf-8")
    rows = text.partition("## Bodies that yield")[2].partition("## Which of these matter")[0]
    young, shear = 210e9, 80e9

    def round_bar(diameter):
        return math.pi * diameter**4 / 64.0

    # A bar between its bolts, and one that is held at its ends, in mm under 62 and 850 N.
    bar = young * 0.1 * 0.02**3 / 12.0
    sags = [
        1e3 * force * reach**3 / (48.0 * bar) for reach in (0.5, 1.58) for force in (62.0, 850.0)
    ]
    camshaft = 48.0 * young * round_bar(0.2)
    twist = 2.0 * shear * round_bar(0.2) / 6.0
    a, b, reach = 25e-3, 110e-3, 135e-3
    axle = 3.0 * young * round_bar(10e-3) * reach / (a * b) ** 2
    tooth = [
        5.3e3 * 0.01**3 / (3.0 * young * 0.05 * 0.035**3 / 12.0),
        64.0 * 0.002**3 / (3.0 * young * 3e-3 * 4.95e-3**3 / 12.0),
    ]
    plates = young * 27e-3 * 77.8e-3**3 / 12.0
    link = 850.0 * 88.9e-3**3 / (48.0 * plates)
    told = [
        f"{1e3 * sags[0]:.0f} µm under 62 N, {sags[1]:.2f} mm",
        f"{sags[2]:.1f} and {sags[3]:.0f} mm",
        f"{10 * round(camshaft / 1e7)} MN/m: {1e6 * 26e3 / camshaft:.0f} µm under 26 kN",
        f"{1e-6 * twist:.1f} MN m/rad",
        f"{1e-6 * axle:.1f} MN/m: {1e6 * 220.0 / axle:.0f} µm under 220 N",
        f"{1e6 * tooth[0]:.2f} µm under 5.3 kN; {1e6 * tooth[1]:.2f} µm under 64 N",
        f"{1e6 * link:.2f} µm under 850 N",
    ]
    assert [it for it in told if it not in rows] == []


def test_a_jockey_on_an_arm_a_bar_and_free_rollers_in_one_drive(papers):
    """106 links, 25 µm of play, rollers as bodies: the bar bears, the ledger closes."""
    spans = papers("bicycle_spans")
    length = papers("marine_drive").Length(6e-3, 0.0)
    found, run = spans.all_parts(spans.whole(), length)
    assert run.sizes["roller"] == run.sizes["joint"] == 106
    assert found["bar"] > 0.1
    assert 0.0 < found["arm"] < 0.01
    assert found["residual"] < 2.5e-4


def test_a_span_of_the_bicycle_is_a_string(papers):
    """The first frequency that the description of the drive tells of the upper span at rest."""
    spans = papers("bicycle_spans")
    drive = cd.scenes.bicycle()
    assert spans.first_frequency(drive, 175.9) == pytest.approx(26.47, rel=2e-3)


@pytest.mark.parametrize("alike", [((11.25, 11.25), (1, 21.5)), ((50, 50), (10, 90))])
def test_the_cylindrical_law_knows_the_sum_of_radii_only(papers, alike):
    law = papers("bicycle_law")
    depth = law.depths(1.0)
    one, other = (law.error(law.outside(*radii), depth) for radii in alike)
    assert one == pytest.approx(other, abs=1e-9)
    assert abs(one).max() > 0.05


def test_the_cylindrical_law_is_near_to_johnsons_where_the_page_says(papers):
    """12 % outside, and in clearances from 25 µm to 2 mm; a half at the ends of its range."""
    law = papers("bicycle_law")
    outside = [law.error(law.outside(a, a), law.depths(1.0)) for a in np.geomspace(2, 150, 25)]
    assert max(abs(it).max() for it in outside) < 0.125
    plays = np.geomspace(0.025, 2.0, 25)
    inside = [law.error(law.inside(10.0, it), law.depths(1e-3 * it)) for it in plays]
    assert max(abs(it).max() for it in inside) < 0.125
    ends = [law.error(law.inside(10.0, it), law.depths(1e-3 * it)).min() for it in (0.005, 10.0)]
    assert max(ends) < -0.4


def test_claims_stand_somewhere_and_name_tests_that_exist():
    """No claim without a place; every test, preset and case that is named exists."""
    text = (ROOT / "docs" / "paper-claims.md").read_text(encoding="utf-8")
    rows = [it.strip("|").split(" | ") for it in text.splitlines() if it.startswith("| ")]
    claims = [it for it in rows if it[0].strip() != "the paper says"]
    assert len(claims) > 60
    assert [it for it in claims if len(it) != 3 or not it[1].strip() or not it[2].strip()] == []
    assert sum("open" in it[1] for it in claims) == 1
    tests = "".join(it.read_text(encoding="utf-8") for it in (ROOT / "tests/python").glob("*.py"))
    named = re.findall(r"`(test_\w+)`", text)
    assert len(named) >= 5
    assert [it for it in named if f"def {it}(" not in tests] == []
    cases = {it.name for it in (ROOT / "tests" / "validation").iterdir()}
    assert [it for it in re.findall(r"\b[CEFIKLMSTVX]\d\d\b", text) if it not in cases] == []
    places = re.findall(r"`(crates/[\w/.]+)`", text)
    assert [it for it in places if not (ROOT / it).exists()] == []


def test_nine_sprockets_turn_on_one_chain():
    """The paper limits their number nowhere: equal sprockets turn alike, none jumps a tooth."""
    wheels = []
    for number in range(9):
        angle = math.tau * number / 9
        place = [0.3 * math.cos(angle), 0.3 * math.sin(angle)]
        wheels.append({"name": f"s{number}", "teeth": 16, "centre": place, "inertia": 1e-4})
    wheels[0] = {key: value for key, value in wheels[0].items() if key != "inertia"}
    wheels[0]["motion"] = {"kind": "constant", "speed": "600 rpm"}
    move = {"kind": "sprocket", "name": "s4", "direction": [-1, 0], "within": "30 mm"}
    drive = cd.Drive.from_dict(
        {
            "chain": {"type": "08B-1"},
            "sprockets": wheels,
            "route": {"pretension": "300 N", "adjust": move},
        }
    )
    run = cd.simulate(
        drive, until=0.02, run_in=0, every=1e-3, error=False, record=["sprocket_angle"]
    )
    turned = run["sprocket_angle"][-1] - run["sprocket_angle"][0]
    assert float(abs(turned - turned[0]).max()) < 0.1 * math.tau / 16
    assert float(turned[0]) == pytest.approx(20.0 * math.pi * 0.02)
    assert abs(run.attrs["energy_residual_largest"]) < 1e-3 * run.attrs["energy_moved"]
