"""Plots of runs: drawn in one call, or refused with the channel to record; in one colour scheme."""

import functools
import re
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
import xarray as xr

mpl.use("Agg")
from matplotlib import pyplot as plt
from matplotlib.colors import to_hex

import chaindrive as cd
from chaindrive.plot import scheme

ROOT = Path(__file__).resolve().parents[2]

PLOTS = [
    "tension",
    "spectrum",
    "order_map",
    "order_slice",
    "campbell",
    "running_modes",
    "transmission_error",
    "speed_ripple",
    "span_motion",
    "span_envelope",
    "tension_around_loop",
    "tooth_load",
    "impacts",
    "impulse_spectrum",
    "losses",
    "joint_work",
    "elongation",
    "rainflow",
    "utilisation",
]
# Why a run of a preset is not drawn: the drive lacks it, or a few milliseconds do.
ABSENT = (
    r"this drive has no (spans|sprockets)",
    r"chain of particles|one closed chain|runs around no sprocket|runs over no sprocket but",
    r"simulate longer|turns [\d.]+ times in all|a window of|does not change|no sprocket turns",
    r"too few for \d+ blocks|stands or goes back",
    r"nothing is lost|nothing wears|nothing pulls",
    r"has no pin diameter|have no length|has no breaking load",
)
QUICK = ["pin_in_bush", "spinning_ring", "timing_drive", "two_stage_timing"]
PRESETS = [
    pytest.param(name, marks=[] if name in QUICK else pytest.mark.slow)
    for name in cd.scenes.__all__
    if name != "presets"
]


@functools.cache
def run_of(preset: str) -> xr.Dataset:
    drive = getattr(cd.scenes, preset)()
    until = min(drive.run_defaults["until"], 6e-3)
    return cd.simulate(
        drive,
        until=until,
        every=until / 40,
        run_in=0,
        record="all",
        events="teeth",
        error=False,
    )


@pytest.fixture(autouse=True)
def _no_figure_of_other_tests() -> None:
    plt.close("all")


def figures() -> int:
    number = len(plt.get_fignums())
    plt.close("all")
    return number


def refusal(name: str, run: xr.Dataset) -> str:
    """Draw a run, and return why it was not drawn: empty when it was. No empty figure stays."""
    try:
        ax = getattr(cd.plot, name)(run)
    except cd.ParameterError as error:
        assert figures() == 0, name
        return str(error)
    assert ax.get_ylabel() or ax.get_xlabel()
    assert figures() == 1, name
    return ""


@pytest.mark.parametrize("preset", PRESETS)
def test_runs_of_presets_are_drawn_unless_their_physics_is_absent(preset: str) -> None:
    run = run_of(preset)
    refused = {name: why for name in PLOTS if (why := refusal(name, run))}
    strange = {
        name: why
        for name, why in refused.items()
        if not any(re.search(reason, why) for reason in ABSENT)
    }
    assert not strange
    wanted = {"tension", "rainflow"}
    if run.sizes["span"]:
        wanted |= {"spectrum", "tension_around_loop", "transmission_error", "losses"}
    assert not wanted & refused.keys()
    assert len(cd.plot.overview(run).axes) == 6
    assert figures() == 1


def test_what_was_not_recorded_is_named() -> None:
    run = cd.simulate(cd.scenes.industrial_16b(), until=2e-3, every=1e-4, run_in=0, error=False)
    needs_speeds = {"order_map", "order_slice", "campbell"}
    refused = {name: why for name in PLOTS if (why := refusal(name, run))}
    named = {
        name
        for name, why in refused.items()
        if re.search(r"simulate\(…, (record=\[…, '|events=')", why)
    }
    assert named >= {"losses", "impacts", "tension_around_loop", "rainflow", "running_modes"}
    assert refused.keys() - named - needs_speeds <= {"tooth_load"}
    absent = r"roller_x not in the run: .*record=\[…, 'roller_x"
    with pytest.raises(cd.ParameterError, match=absent):
        cd.plot.frame(run.drop_vars("roller_x"), 0.0)
    # A panel says it in its place.
    sentences = [text.get_text() for ax in cd.plot.overview(run).axes for text in ax.texts]
    assert any("energy_losses not in the run" in it.replace("\n", " ") for it in sentences)
    assert figures() == 1


def test_what_is_neither_run_nor_analysis_is_refused() -> None:
    run = run_of("timing_drive")
    lost = run.drive.losses()
    with pytest.raises(cd.ParameterError, match=r"start = 0\.001 chooses within a run"):
        cd.plot.losses(lost, start=1e-3)
    with pytest.raises(cd.ParameterError, match=r"neither a run .* nor what .*impacts returns"):
        cd.plot.impacts(lost)
    for draw in (cd.plot.overview, lambda it: cd.plot.frame(it, 0.0)):
        with pytest.raises(cd.ParameterError, match="not a run of chaindrive"):
            draw(lost)
    assert figures() == 0
    # Given axes belong to whoever gave them.
    _, ax = plt.subplots()
    with pytest.raises(cd.ParameterError):
        cd.plot.impacts(lost, ax=ax)
    assert cd.plot.losses(run, ax=ax) is ax
    assert figures() == 1


def test_the_layout_of_a_run_is_that_of_its_drive() -> None:
    drive = cd.scenes.industrial_16b()
    run = cd.simulate(drive, until=1e-3, run_in=0, error=False)
    lines = [cd.plot.layout(it).lines for it in (drive, run)]
    for one, other in zip(*lines, strict=True):
        np.testing.assert_array_equal(one.get_xydata(), other.get_xydata())
    with pytest.raises(cd.ParameterError, match="work_precision"):
        cd.plot.work_precision(run)
    assert len(plt.get_fignums()) == 2


def test_a_run_of_a_few_samples_has_no_map() -> None:
    settings = {"until": 0.06, "run_in": 0, "method": "verlet", "error": False}
    run = cd.simulate(cd.scenes.marine_engine(), **settings)
    with pytest.raises(cd.ParameterError, match="simulate longer"):
        cd.plot.campbell(run)
    assert not plt.get_fignums()


def test_options_choose_within_a_run() -> None:
    run = run_of("timing_drive")
    cut = cd.plot.span_motion(run, str(run["span"][1].item()), places=[0.3, 0.6])
    assert len(cut.lines) == 2
    one = cd.plot.spectrum(run, "sprocket_speed", sprocket="intake", up_to=2e3)
    assert len(one.lines) == 1
    assert one.get_xlim()[1] <= 2e3
    span = str(run["span"][1].item())
    chosen = cd.plot.tension(run.sel(span=span))
    assert [line.get_label() for line in chosen.lines] == [span]
    both = run_of("two_stage_timing")
    first = cd.plot.rainflow(both).get_title()
    second = cd.plot.rainflow(
        both, chain=cd.scenes.two_stage_timing().to_dict()["chains"][1]["name"]
    )
    assert first != second.get_title()
    figures()


@pytest.mark.parametrize("preset", ["motorcycle", "two_stage_timing", "marine_engine"])
def test_names_lie_on_no_other_name_and_inside_the_axes(preset: str) -> None:
    ax = cd.plot.layout(getattr(cd.scenes, preset)())
    ax.figure.canvas.draw()
    boxes = [text.get_window_extent() for text in ax.texts]
    assert len(boxes) >= 2
    for number, box in enumerate(boxes):
        assert not box.count_overlaps(boxes[:number]), ax.texts[number].get_text()
        assert ax.figure.bbox.x0 <= box.x0 <= box.x1 <= ax.figure.bbox.x1
    figures()


def swept(values: np.ndarray, **coordinates: object) -> xr.Dataset:
    """A sweep, as far as it is drawn."""
    dims = tuple(coordinates)
    verdict = np.full(values.shape, "caution", dtype=object)
    verdict[np.unravel_index(values.argmin(), values.shape)] = "distrusted"
    spread = np.stack([values, values - 1.0], axis=-1)
    about = {"units": "N", "long_name": "largest span tension"}
    return xr.Dataset(
        {
            "span_tension_max": ((*dims, "span"), spread, about),
            "verdict": (dims, verdict),
        },
        coords={**coordinates, "span": ["tight", "slack"]},
    )


def test_a_response_marks_its_optimum_among_the_trusted() -> None:
    speed = ("speed", np.array([10.0, 20.0, 30.0, 40.0]), {"units": "rad/s"})
    line = swept(np.array([1.0, 700.0, 650.0, 900.0]), speed=speed)
    ax = cd.plot.response(line)
    assert ax.get_xlabel() == "speed [rpm]"
    told = [text.get_text() for text in ax.get_legend().get_texts()]
    assert told == ["least: 650 N at 286.5 rpm", "distrusted"]
    largest = cd.plot.response(line, optimum="largest", span="slack")
    assert "largest: 899 N at 382 rpm" in largest.get_legend().get_texts()[0].get_text()
    model = ("model", np.array(["particles", "links"]))
    plane = swept(
        np.array([[7.0, 6.0], [5.0, 4.0], [9.0, 8.0], [3.0, 2.0]]), speed=speed, model=model
    )
    ax = cd.plot.response(plane)
    assert "at 382 rpm, particles" in ax.get_legend().get_texts()[0].get_text()
    figures()
    with pytest.raises(cd.ParameterError, match="has no torque: it has span_tension_max"):
        cd.plot.response(line, "torque")
    with pytest.raises(cd.ParameterError, match="there is no span 'top'"):
        cd.plot.response(line, span="top")
    with pytest.raises(cd.ParameterError, match="optimum = 'min', must be 'least' or 'largest'"):
        cd.plot.response(line, optimum="min")
    with pytest.raises(cd.ParameterError, match="nothing to draw"):
        cd.plot.response(line.isel(speed=[0]))
    assert figures() == 0


# The colour scheme.

PAPERS = ("#ffffff", "#131416")
COLOURS = {scheme.INK, scheme.OUTLINE, scheme.GUIDE, scheme.CARRIER, scheme.MARK, *scheme.CURVES}


def luminance(colour: str) -> float:
    shares = np.array([int(colour[at : at + 2], 16) / 255 for at in (1, 3, 5)])
    linear = np.where(shares <= 0.04045, shares / 12.92, ((shares + 0.055) / 1.055) ** 2.4)
    return float(linear @ (0.2126, 0.7152, 0.0722))


def test_every_colour_is_seen_on_light_and_dark_paper() -> None:
    """WCAG 2.2, 1.4.11: at least 3 : 1."""
    for colour in COLOURS:
        for paper in PAPERS:
            low, high = sorted([luminance(colour), luminance(paper)])
            assert (high + 0.05) / (low + 0.05) >= 3.0, (colour, paper)


def test_one_scheme_everywhere() -> None:
    known = COLOURS | {scheme.STEEL}
    drawing = cd.scenes.timing_drive().svg()
    assert set(re.findall(r"#[0-9a-f]{6}\b", drawing)) <= known
    assert "fill:#fff" not in drawing
    page = cd.replay(run_of("timing_drive")).html
    style = page[page.index("<style>") : page.index("</style>")]
    for variable, colour in {
        "guide": scheme.GUIDE,
        "arm-line": scheme.CARRIER,
        "steel-line": scheme.OUTLINE,
        "plate-line": scheme.OUTLINE,
        "force": scheme.MARK,
        **{f"curve-{number}": colour for number, colour in enumerate(scheme.CURVES)},
    }.items():
        # Once: both themes have it.
        assert re.findall(rf"--{variable}: (#[0-9a-f]+);", style) == [colour], variable


def test_the_style_of_the_pages_is_that_of_plots() -> None:
    pages = mpl.rc_params_from_file(ROOT / "docs/matplotlibrc", use_default_template=False)
    ours = mpl.RcParams(scheme.STYLE)
    assert set(pages) == set(ours)
    for name, value in ours.items():
        if name == "axes.prop_cycle":
            assert [to_hex(it["color"]) for it in pages[name]] == list(scheme.CURVES)
        elif "color" in name and value not in ("none", "auto"):
            assert to_hex(pages[name]) == to_hex(value), name
        else:
            assert pages[name] == value, name
