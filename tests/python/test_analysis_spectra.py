"""Spectra, orders, running modes, transmission error and spans against closed forms."""

import functools

import numpy as np
import pytest
import xarray as xr

import chaindrive as cd
from chaindrive import analysis
from chaindrive.analysis.ramps import with_run_up
from chaindrive.analysis.signal import turning
from chaindrive.plot.panels import orders as orders_panel
from chaindrive.plot.source import tightest_span

TAU = 2.0 * np.pi


@pytest.fixture(scope="module")
def two_sprockets() -> xr.Dataset:
    """Run a drive of two sprockets up in two seconds."""
    drive = cd.scenes.marine_two_sprockets()
    record = ["span_tension", "link_tension", "roller_x", "roller_y", "sprocket_speed"]
    return cd.run_up(
        drive,
        "60 rpm",
        "100 rpm",
        until=2.0,
        every="1 ms",
        record=record,
        error=False,
        method="verlet",
    )


def signal(values: np.ndarray, time: np.ndarray, angle: np.ndarray | None = None) -> xr.Dataset:
    """Make a run of one channel, and of the angle of a wheel."""
    variables = {"span_tension": (("time", "span"), values[:, None], {"units": "N"})}
    if angle is not None:
        variables["sprocket_angle"] = (("time", "sprocket"), angle[:, None], {"units": "rad"})
    return xr.Dataset(variables, coords={"time": time, "span": ["tight"], "sprocket": ["crank"]})


def test_a_line_between_two_lines_keeps_its_place_and_height() -> None:
    time = np.arange(4000) * 1e-3
    run = signal(5.0 + 3.0 * np.sin(TAU * 101.137 * time + 0.4), time)
    spread = analysis.spectrum(run, "span_tension", span="tight")
    assert float(spread.max()) < 0.99 * 3.0
    found = analysis.peaks(spread, count=1)
    assert float(found["frequency"][0]) == pytest.approx(101.137, abs=1e-3)
    assert float(found["amplitude"][0]) == pytest.approx(3.0, rel=2e-3)
    assert spread.attrs["units"] == "N"


def test_the_density_holds_the_variance() -> None:
    time = np.arange(20000) * 1e-3
    noise = np.random.default_rng(3).normal(scale=2.0, size=time.size)
    spread = analysis.spectrum(
        signal(noise, time), "span_tension", kind="density", segments=40, span="tight"
    )
    variance = float(spread.integrate("frequency"))
    assert variance == pytest.approx(4.0, rel=0.03)
    assert spread.attrs["units"] == "(N)²/Hz"


def test_an_order_stands_still_while_the_speed_doubles() -> None:
    time = np.arange(20000) * 5e-4
    angle = -(20.0 * time + 1.0 * time**2)
    run = signal(2.0 * np.sin(18 * angle) + np.sin(TAU * 30.0 * time), time, angle)
    orders = analysis.order_map(run, "span_tension", "crank", turns=6, span="tight")
    assert np.ptp(orders["speed"].to_numpy()) > 14.0
    tops = orders.sel(order=slice(17, 19))
    assert float(abs(tops.idxmax("order") - 18.0).max()) < 0.1
    np.testing.assert_allclose(tops.max("order"), 2.0, rtol=0.05)
    whole = analysis.order_spectrum(run, "span_tension", "crank", span="tight")
    mesh = analysis.peaks(whole, count=1)
    assert float(mesh["order"][0]) == pytest.approx(18.0, rel=1e-3)
    cut = analysis.order_slice(orders, 18)
    np.testing.assert_allclose(cut["frequency"], 18 * cut["speed"] / TAU)


def test_a_run_up_keeps_the_orders_of_the_crank() -> None:
    drive = cd.scenes.marine_engine()
    settings = {"until": 0.2, "every": 1e-3, "error": False, "method": "verlet"}
    run = cd.run_up(drive, "100 rpm", "127 rpm", record="span_tension", **settings)
    time = run["time"].to_numpy()
    s = time / 0.2
    start, change = 100 * TAU / 60, 27 * TAU / 60
    smooth = start * time + change * 0.2 * (s**3 - 0.5 * s**4)
    # The motion of the scene: orders 4 and 7, clockwise.
    expected = -smooth + 0.2e-3 * np.sin(-4 * smooth) + 0.28e-3 * np.sin(-7 * smooth)
    found = run["sprocket_angle"].sel(sprocket="crank")
    np.testing.assert_allclose(found, expected, atol=2e-7)
    np.testing.assert_allclose(run["speed"], start + change * s * s * (3 - 2 * s))
    assert run.attrs["run_up"] == "crank"
    # Before the ramp the crank turns at its first speed, with its orders.
    settings["until"] = 0.01
    run = cd.run_up(drive, "100 rpm", "127 rpm", run_in=0.03, record="span_tension", **settings)
    turned = run["sprocket_angle"].sel(sprocket="crank").isel(time=0)
    smooth = start * 0.03
    began = smooth + 0.2e-3 * np.sin(4 * smooth) + 0.28e-3 * np.sin(7 * smooth)
    assert float(turned) == pytest.approx(-began, abs=2e-7)


def test_a_run_up_says_what_it_cannot_do() -> None:
    with pytest.raises(cd.ParameterError, match="nothing has none"):
        cd.run_up(cd.scenes.spinning_ring(), 1.0, 2.0, until=1.0)
    with pytest.raises(cd.ParameterError, match="the drive keeps its direction"):
        cd.run_up(cd.scenes.marine_two_sprockets(), "-10 rpm", "20 rpm", until=1.0)


@pytest.mark.parametrize(
    ("motion", "sense"),
    [
        # Defect: all of these ran up counter-clockwise.
        ({"kind": "ramp", "from": -3.0, "to": 0.0, "duration": 1.0}, -1.0),
        ({"kind": "table", "times": [0.0, 1.0, 2.0], "values": [0.0, -5.0, -12.0]}, -1.0),
        ({"kind": "speed-table", "times": [0.0, 1.0, 2.0], "speeds": [0.0, -5.0, 0.0]}, -1.0),
        ({"kind": "constant", "speed": 0.0}, None),
    ],
)
def test_a_run_up_turns_as_the_drive_does(motion: dict[str, object], sense: float | None) -> None:
    drive = cd.scenes.marine_two_sprockets().replace({"sprockets.crank.motion": motion})
    if sense is None:
        with pytest.raises(cd.ParameterError, match="turns neither way"):
            with_run_up(drive, 1.0, 2.0, until=1.0)
        return
    changed, *_ = with_run_up(drive, 1.0, 2.0, until=1.0)
    ramp = changed.to_dict()["sprockets"][0]["motion"]
    assert (ramp["from"], ramp["to"]) == (sense, 2.0 * sense)


def test_a_run_up_with_orders_has_the_run_in_of_its_scene() -> None:
    """Defect: its table began at the ramp, and the run-in of the scene before it."""
    drive = cd.scenes.marine_engine()
    given, *_ = with_run_up(drive, 9.0, 10.0, until=0.01, run_in=0.03)
    own, *_ = with_run_up(drive.replace({"run.run_in": "30 ms"}), 9.0, 10.0, until=0.01)
    motions = [it.to_dict()["sprockets"][0]["motion"] for it in (given, own)]
    assert motions[0] == motions[1]
    with pytest.raises(cd.ParameterError, match=r"run_in = '2 turns': .* in seconds"):
        with_run_up(drive.replace({"run.run_in": "2 turns"}), 9.0, 10.0, until=0.01)


@pytest.mark.parametrize("speed", [0.0, 15.0])
def test_running_modes_are_those_of_moving_strings(speed: float) -> None:
    """Theory: f = n (c² − v²) / (2 L c) between the tangent points, see R. Skutsch, 1897."""
    drive = cd.scenes.marine_two_sprockets()
    modes = analysis.running_modes(drive, speeds=speed, up_to=25.0)
    chain = drive.describe()["chain"]
    rho, v = chain["mass_per_length"], float(modes["chain_speed"][0])
    assert v == pytest.approx(60 * 0.0889 * speed / TAU)
    # Equal tangents: L² = D² − (r₁ − r₂)²
    radii = [0.0889 / (2 * np.sin(np.pi / z)) for z in (60, 40)]
    length = np.sqrt(2.7412651200728666**2 - (radii[0] - radii[1]) ** 2)
    tensions = drive.statics()["span_tension"].isel(stage=-1)
    # Fixed centres: the chain takes up 6 % of the centrifugal tension by its own stretch.
    held = 0.0626 * rho * v * v
    for span in ("crank-camshaft", "camshaft-crank"):
        tension = float(tensions.sel(span=span)) + held
        mine = modes["frequency"][0][modes["share"][0].sel(part=span) > 0.8]
        for waves in (1, 2, 3):
            string = analysis.moving_string(tension, rho, length, v, waves)
            assert float(mine[waves - 1]) == pytest.approx(string, rel=0.01), (span, waves)
    assert float(np.abs(modes["growth"]).max()) < 1e-6


def test_orders_meet_modes_at_critical_speeds() -> None:
    modes = analysis.running_modes(
        cd.scenes.marine_two_sprockets(), speeds=[0.5, 1.0, 1.5, 2.0], up_to=15.0
    )
    found = analysis.critical_speeds(modes, 60)
    np.testing.assert_allclose(found["frequency"], 60 * found["speed"] / TAU)
    # The first three modes of both spans, as the order rises from 5 to 19 Hz through them.
    at_rest = cd.scenes.marine_two_sprockets().natural_frequencies()
    inside = at_rest[(at_rest > 5.0) & (at_rest < 14.0)]
    assert found.sizes["crossing"] == inside.size
    np.testing.assert_allclose(found["frequency"], inside, rtol=0.03)


def test_a_moving_string_stands_still_at_its_wave_speed() -> None:
    assert analysis.moving_string(400.0, 1.0, 2.0, 0.0) == pytest.approx(5.0)
    assert analysis.moving_string(400.0, 1.0, 2.0, 20.0) == 0.0
    assert analysis.moving_string(400.0, 1.0, 2.0, 10.0, 2) == pytest.approx(7.5)


def test_shares_of_a_mode_add_up(two_sprockets: xr.Dataset) -> None:
    modes = two_sprockets.drive.running_modes(speeds=[7.0, 9.0], up_to=20.0)
    share = modes["share"].sum("part", skipna=False)
    np.testing.assert_allclose(share.where(share.notnull(), 1.0), 1.0, atol=1e-9)
    assert int(share.isnull().sum()) <= 1
    # What grows with the tension that was recorded does so in the strings too.
    spans = two_sprockets.drive.span_frequencies(speed=9.0)
    for span in ("crank-camshaft", "camshaft-crank"):
        mine = modes["frequency"].sel(speed=9.0)[modes["share"].sel(speed=9.0, part=span) > 0.8]
        string = float(spans["frequency"].sel(span=span, half_waves=2))
        assert float(mine[1]) == pytest.approx(string, rel=0.02)


def test_mesh_order_of_a_drive_that_runs_up(two_sprockets: xr.Dataset) -> None:
    assert analysis.mesh_orders(two_sprockets) == {"crank": 60.0, "camshaft": 40.0}
    motion = two_sprockets.drive.span_motion("crank-camshaft", places=0.37)
    spread = two_sprockets.drive.order_spectrum(motion, "crank")
    mesh = analysis.peaks(spread.sel(order=slice(40, 80)), count=1)
    assert float(mesh["order"][0]) == pytest.approx(60.0, rel=5e-3)


def test_transmission_error_of_a_polygon_is_the_kinematic_one(two_sprockets: xr.Dataset) -> None:
    """The exact kinematics of two wheels put in place of what was computed."""
    distance = 2.7412651200728666
    tooth = TAU / 60
    count = two_sprockets.sizes["time"]
    driver = np.linspace(0.0, 20 * tooth, count)
    passed, phase = np.divmod(driver, tooth)
    action = cd.kinematics.polygon_action(60, 40, 0.0889, distance, driver_angle=phase)
    driven = action["driven_angle"].to_numpy() + passed * TAU / 40
    run = two_sprockets.copy()
    run["sprocket_angle"] = (("time", "sprocket"), np.column_stack([driver, driven]))
    found = analysis.transmission_error(run, "crank", "camshaft")
    assert found.attrs["error_range"] == pytest.approx(found.attrs["kinematic_range"], rel=0.01)
    assert float(abs(found["error"].mean())) < 1e-12


def test_ripple_of_an_even_and_of_a_swinging_wheel(two_sprockets: xr.Dataset) -> None:
    run = two_sprockets.copy()
    time = run["time"].to_numpy()
    speed = np.column_stack([np.full(time.size, -10.0), -15.0 - 0.3 * np.sin(TAU * 10 * time)])
    run["sprocket_speed"] = (("time", "sprocket"), speed)
    found = run.drive.speed_ripple()
    np.testing.assert_allclose(found["irregularity"], [0.0, 0.6 / 15.0], rtol=1e-3)
    np.testing.assert_allclose(found["rms_ripple"], [0.0, 0.3 / np.sqrt(2) / 15], rtol=1e-3)


def test_motion_at_a_fixed_point_is_that_of_the_line(two_sprockets: xr.Dataset) -> None:
    """Rollers that run along a line which swings: the point does not see which roller it is."""
    run = two_sprockets.isel(time=slice(0, 400)).copy(deep=True)
    time = run["time"].to_numpy()
    line = analysis.span_lines(run).sel(span="crank-camshaft")
    start = np.array([float(line["start_x"]), float(line["start_y"])])
    d = np.array([float(line["end_x"]), float(line["end_y"])]) - start
    length = float(np.hypot(*d))
    assert length == pytest.approx(float(line["length"]))
    d, n = d / length, np.array([-d[1], d[0]]) / length
    along = np.arange(112)[None, :] * 0.0889 - 0.5 + np.mod(0.8 * time, 0.0889)[:, None]
    swing = 2e-3 * np.sin(np.pi * along / length) * np.cos(TAU * 5 * time)[:, None]
    swing[(along < 0) | (along > length)] = 0.0
    run["roller_x"][:] = start[0] + along * d[0] + swing * n[0]
    run["roller_y"][:] = start[1] + along * d[1] + swing * n[1]
    motion = run.drive.span_motion("crank-camshaft", places=[0.25, 0.5])
    expected = 2e-3 * np.outer(np.sin(np.pi * np.array([0.25, 0.5])), np.cos(TAU * 5 * time))
    np.testing.assert_allclose(motion, expected, atol=3e-6)
    envelope = run.drive.span_envelope("crank-camshaft", places=9)
    assert float(envelope["greatest"].max()) == pytest.approx(2e-3, rel=0.01)
    np.testing.assert_allclose(envelope["least"], -envelope["greatest"], atol=1e-5)


def test_every_plot_names_its_axes(two_sprockets: xr.Dataset) -> None:
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    run = two_sprockets.drive
    orders = run.order_map("span_tension", "crank", turns=0.5, span="crank-camshaft")
    diagram = run.campbell(
        "span_tension", "crank", span="crank-camshaft", window_time=0.4, modes=False
    )
    drawn = [
        cd.plot.spectrum(run.spectrum("span_tension")),
        cd.plot.order_map(orders, up_to=150),
        cd.plot.order_slice(analysis.order_slice(orders, 60)),
        cd.plot.campbell(diagram),
        cd.plot.transmission_error(run.transmission_error("crank", "camshaft")),
        cd.plot.speed_ripple(run.speed_ripple()),
        cd.plot.span_motion(run.span_motion("camshaft-crank", places=[0.25, 0.5])),
        cd.plot.span_envelope(run.span_envelope("camshaft-crank")),
        cd.plot.running_modes(run.running_modes(speeds=[7.0, 9.0], up_to=20.0)),
    ]
    steady = diagram.isel(time=[0, 1]).assign_coords(speed=("time", [3.0, 3.0]))
    with pytest.raises(cd.ParameterError, match="the speed does not change"):
        cd.plot.campbell(steady)
    for axes in drawn:
        figure = axes.figure
        figure.canvas.draw()
        frame = figure.bbox
        for text in (axes.xaxis.label, axes.yaxis.label, axes.title):
            if not text.get_text():
                continue
            box = text.get_window_extent()
            assert box.x0 >= frame.x0 - 1, text
            assert box.y0 >= frame.y0 - 1, text
            assert box.x1 <= frame.x1 + 1, text
            assert box.y1 <= frame.y1 + 1, text
        assert "[" in axes.get_ylabel()
        pyplot.close(figure)


def test_what_is_missing_is_named(two_sprockets: xr.Dataset) -> None:
    with pytest.raises(cd.ParameterError, match="contact_force not in the run"):
        two_sprockets.drive.spectrum("contact_force")
    with pytest.raises(cd.ParameterError, match="there is no span 'top'"):
        two_sprockets.drive.spectrum("span_tension", span="top")
    with pytest.raises(cd.ParameterError, match="kind = 'psd', must be 'amplitude' or 'density'"):
        two_sprockets.drive.spectrum("span_tension", kind="psd")
    with pytest.raises(cd.ParameterError, match="there is no span 'top'"):
        two_sprockets.drive.span_motion("top")
    with pytest.raises(cd.ParameterError, match="span left"):
        two_sprockets.drive.order_map("span_tension", "crank", turns=0.5)
    with pytest.raises(cd.ParameterError, match="one closed chain of particles"):
        analysis.running_modes(cd.scenes.bicycle(), speeds=1.0)
    with pytest.raises(cd.ParameterError, match="does not turn at 90"):
        two_sprockets.drive.span_frequencies(speed=90.0)


# Every analysis of a signal, and of the motion of a span.
SIGNALS = {
    "spectrum": lambda run, **more: analysis.spectrum(run, "span_tension", **more),
    "order_spectrum": lambda run, **more: analysis.order_spectrum(
        run, "span_tension", "crank", span="crank-camshaft", **more
    ),
    "order_map": lambda run: analysis.order_map(
        run, "span_tension", "crank", turns=0.5, span="crank-camshaft"
    ),
    "campbell": lambda run: analysis.campbell(
        run, "span_tension", "crank", window_time=0.4, modes=False, span="crank-camshaft"
    ),
    "transmission_error": lambda run, **more: analysis.transmission_error(
        run, "crank", "camshaft", **more
    ),
    "speed_ripple": analysis.speed_ripple,
    "span_motion": lambda run, **more: analysis.span_motion(run, "crank-camshaft", **more),
    "span_envelope": lambda run, **more: analysis.span_envelope(run, "crank-camshaft", **more),
}


@pytest.mark.parametrize("name", ["order_spectrum", "order_map", "campbell"])
def test_a_span_that_is_not_held_is_told(two_sprockets: xr.Dataset, name: str) -> None:
    """Defect: `ValueError` of SciPy, or windows of NaN, and a report that could not be made."""
    run = two_sprockets.copy(deep=True)
    run["span_tension"][7, :] = np.nan
    with pytest.raises(cd.ParameterError, match="span_tension is not a number at"):
        SIGNALS[name](run)


def test_the_tightest_span_is_one_that_is_held(two_sprockets: xr.Dataset) -> None:
    from matplotlib import pyplot

    run = two_sprockets.copy(deep=True)
    for row, other in enumerate(reversed(run["span"].to_numpy())):
        run["span_tension"][:] = two_sprockets["span_tension"]
        run["span_tension"][:, row] = np.nan
        assert tightest_span(run)["span"] == other
        assert tightest_span(run.sel(span=other))["span"] == other
    # A panel says why it is not drawn.
    run["span_tension"][7, :] = np.nan
    figure, ax = pyplot.subplots()
    with pytest.raises(cd.ParameterError, match="not a number at 1 of 2001"):
        orders_panel(run, ax=ax)
    pyplot.close(figure)


@pytest.mark.parametrize("name", [it for it in SIGNALS if it not in ("order_map", "campbell")])
@pytest.mark.parametrize("after", [9.0, "1 ms"])
def test_a_time_after_the_run_is_refused(
    two_sprockets: xr.Dataset, name: str, after: object
) -> None:
    """Defect: errors of NumPy, or an empty array."""
    with pytest.raises(cd.ParameterError, match=r"after = (9\.0 leaves less|'1 ms', must be)"):
        SIGNALS[name](two_sprockets, after=after)


def test_a_signal_over_a_part_of_a_run_meets_its_own_angles(two_sprockets: xr.Dataset) -> None:
    tension = two_sprockets["span_tension"].sel(span="crank-camshaft")
    part, own = (it.isel(time=slice(500, 1500)) for it in (two_sprockets, tension))
    for orders in (analysis.order_spectrum, functools.partial(analysis.order_map, turns=0.5)):
        expected = orders(part, own, "crank")
        xr.testing.assert_equal(orders(two_sprockets, own, "crank"), expected)
    with pytest.raises(cd.ParameterError, match="at times at which the run has none"):
        analysis.order_map(two_sprockets, tension.interp(time=[0.0105, 0.02]), "crank")
    with pytest.raises(cd.ParameterError, match="1 samples are too few"):
        turning(two_sprockets.isel(time=[0]), "crank")


def test_orders_above_a_campbell_diagram_are_left_out(two_sprockets: xr.Dataset) -> None:
    """Defect: `ValueError`, argmax of an empty sequence. The mesh is at 60 Hz and above."""
    from matplotlib import pyplot

    ax = cd.plot.campbell(two_sprockets, up_to=40.0, modes=False, window_time=0.4)
    assert [text.get_text() for text in ax.texts] == ["1, turn of crank"]
    pyplot.close(ax.figure)


def test_orders_are_named(two_sprockets: xr.Dataset) -> None:
    """Mesh, loop of 112 links, turns, and what acts in turns: by the teeth, on either shaft."""
    names = analysis.order_names(two_sprockets, "crank")
    known = {60.0: "mesh, 60 teeth of crank", 120.0: "2 × mesh", 1.5: "turn of camshaft"}
    assert known.items() <= names.items()
    assert names[60 / 112] == "chain loop"
    assert analysis.order_names(two_sprockets, "camshaft")[40.0] == "mesh, 40 teeth of camshaft"
    run = cd.simulate(cd.scenes.timing_drive(), until=1e-3, run_in=0, error=False)
    told = analysis.order_names(run, "crank")[2.0]
    assert told == "motion of crank, order 2; torque on exhaust, order 4; torque on intake, order 4"
    assert "torque on exhaust, order 4" in analysis.order_names(run, "exhaust")[4.0]


def test_lines_of_an_order_spectrum_have_their_names(two_sprockets: xr.Dataset) -> None:
    from matplotlib import pyplot

    tension = two_sprockets["span_tension"].sel(span="crank-camshaft")
    spread = analysis.order_spectrum(two_sprockets, tension, "crank")
    ax = cd.plot.spectrum(spread, up_to=130.0)
    written = {text.xy[0]: text.get_text() for text in ax.texts}
    assert "60 mesh, 60 teeth of crank" in written[60.0]
    assert "2 × mesh" in written[120.0]
    pyplot.close(ax.figure)
    # Lines beyond the axis have none.
    ax = cd.plot.spectrum(spread, up_to=70.0)
    assert not any("2 × mesh" in text.get_text() for text in ax.texts)
    pyplot.close(ax.figure)
    cut = analysis.order_slice(analysis.order_map(two_sprockets, tension, "crank", turns=0.5), 60)
    ax = cd.plot.order_slice(cut)
    assert ax.lines[0].get_label() == "order 60, mesh, 60 teeth of crank"
    pyplot.close(ax.figure)
