"""Profiles out into drawings and back, and results in files of other programs."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import chaindrive as cd
from chaindrive.exchange import Curve, biarcs, face, outlines, read_dxf, tooth, write_dxf, write_svg

ezdxf = pytest.importorskip("ezdxf")

# Drawings are in millimetres with sixteen digits.
EXACT = 1e-9


def off(profile: cd.Profile, points: np.ndarray) -> float:
    return float(np.abs(profile.distance(points)).max())


def half_turns(radius: float) -> Curve:
    ends = np.array([[-radius, 0.0], [radius, 0.0]])
    return Curve(ends, np.ones(2), True)


@pytest.mark.parametrize("name", ["industrial_16b", "timing_drive", "marine_engine"])
def test_a_drive_goes_out_into_a_drawing_and_comes_back(name: str, tmp_path: Path) -> None:
    drive = getattr(cd.scenes, name)()
    file = tmp_path / "drive.dxf"
    write_dxf(file, drive, settled=False)
    assert ezdxf.readfile(file).audit().errors == []
    teeth = {it["name"]: it["teeth"] for it in drive.resolved().to_dict()["sprockets"]}
    changes = {}
    for sprocket in drive.sprockets:
        (outline,) = read_dxf(file, layers=f"sprocket {sprocket}")
        assert outline.closed
        changes[f"sprockets.{sprocket}.tooth"] = tooth(outline, teeth[sprocket])
    for guide in drive.guides:
        (curve,) = read_dxf(file, layers=f"guide {guide}")
        changes[f"guides.{guide}.face"] = face(curve, material="left")
    again = drive.replace(changes)
    for body in [*drive.sprockets, *drive.guides]:
        before, after = (it.profile(body, settled=False) for it in (drive, again))
        assert off(before, after.outline(1e-5)) < EXACT
        assert off(after, before.outline(1e-5)) < EXACT


def test_a_profile_read_back_moves_as_the_standard_one(tmp_path: Path) -> None:
    drive = cd.scenes.industrial_16b()
    write_dxf(tmp_path / "driver.dxf", drive.profile("driver"))
    (outline,) = read_dxf(tmp_path / "driver.dxf")
    again = drive.replace({"sprockets.driver.tooth": tooth(outline, 19)})
    settings = {"until": 5e-3, "every": 1e-3, "run_in": 0, "method": "verlet", "error": False}
    first, second = (cd.simulate(it, record="span_tension", **settings) for it in (drive, again))
    np.testing.assert_allclose(second["span_tension"], first["span_tension"], rtol=1e-5)


def test_lengths_and_areas_are_those_of_circles() -> None:
    circle = half_turns(0.2)
    assert circle.length == pytest.approx(0.4 * np.pi, rel=1e-14)
    assert circle.area == pytest.approx(0.04 * np.pi, rel=1e-14)
    assert circle.reversed().area == pytest.approx(-0.04 * np.pi, rel=1e-14)
    # A half disc: its centre of area is 4 R / (3 π) from the chord.
    half = Curve(circle.points, np.array([0.0, 1.0]), True)
    np.testing.assert_allclose(half.centroid, [0.0, 0.8 / (3.0 * np.pi)], atol=1e-15)
    moved = circle.moved([1.0, 2.0], turned=0.3, scaled=2.0)
    np.testing.assert_allclose(moved.centres, [[1.0, 2.0]] * 2, atol=1e-15)
    np.testing.assert_allclose(moved.centroid, [1.0, 2.0], atol=1e-15)
    np.testing.assert_allclose(
        moved.distance([[1.0, 2.0], [1.0, 3.0], [1.0, 2.5]]), [0.4, 0.6, 0.1]
    )
    assert np.hypot(*circle.outline(1e-6).T) == pytest.approx(0.2)


def test_splines_become_arcs_within_the_tolerance(tmp_path: Path) -> None:
    """An ellipse has a closed form to be held against; a spline of four points another."""
    drawing = ezdxf.new(units=ezdxf.units.MM)
    space = drawing.modelspace()
    space.add_ellipse((10.0, 5.0), (40.0, 0.0), 0.4, dxfattribs={"layer": "ellipse"})
    space.add_open_spline([(0, 0), (30, 40), (60, -40), (90, 0)], dxfattribs={"layer": "spline"})
    drawing.saveas(tmp_path / "smooth.dxf")
    pieces = []
    for tolerance in (1e-4, 1e-6, 1e-8):
        (curve,) = read_dxf(tmp_path / "smooth.dxf", layers="ellipse", tolerance=tolerance)
        assert curve.closed
        parameters = np.linspace(0.0, 2.0 * np.pi, 1001)
        x, y = 0.01 + 0.04 * np.cos(parameters), 0.005 + 0.016 * np.sin(parameters)
        assert curve.distance(np.column_stack([x, y])).max() < 1.1 * tolerance
        # They run into each other, and around once.
        begins, ends = curve.directions()
        turns = np.roll(begins, -1) - ends
        np.testing.assert_allclose(np.cos(turns), 1.0, atol=1e-12)
        assert curve.sweeps.sum() == pytest.approx(2.0 * np.pi)
        pieces.append(len(curve.bulges))
    # Pairs of arcs are exact to the third power of their length.
    assert pieces[2] < 6 * pieces[1] < 36 * pieces[0]
    (spline,) = read_dxf(tmp_path / "smooth.dxf", layers="spline")
    u = np.linspace(0.0, 1.0, 501)
    x, y = 0.09 * u, 0.12 * u * (1 - u) ** 2 - 0.12 * u**2 * (1 - u)
    assert spline.distance(np.column_stack([x, y])).max() < 1.1e-6


def test_a_cusp_is_refused() -> None:
    def along(t: float) -> tuple[np.ndarray, np.ndarray]:
        return np.array([t**2, t**3]), np.array([2.0 * t, 3.0 * t**2])

    assert biarcs(along, [0.1, 1.0], 1e-6).closed is False
    with pytest.raises(cd.ParameterError, match=r"cusp near \(0, 0\)"):
        biarcs(lambda t: (along(t)[0], np.zeros(2)), [0.0, 1.0], 1e-6)


def test_what_touches_is_joined_whatever_way_it_was_drawn(tmp_path: Path) -> None:
    """A slot of two lines and two arcs, one of which was drawn the other way, in inches."""
    drawing = ezdxf.new(units=ezdxf.units.IN)
    space = drawing.modelspace()
    space.add_line((0, -1), (3, -1))
    space.add_line((0, 1), (3, 1))
    space.add_arc((3, 0), 1, -90, 90)
    space.add_arc((0, 0), 1, 90, 270)
    space.add_circle((0, 0), 0.5)
    space.add_text("a slot")
    drawing.saveas(tmp_path / "slot.dxf")
    hole, slot = sorted(read_dxf(tmp_path / "slot.dxf"), key=lambda curve: curve.length)
    inch = 0.0254
    assert slot.closed
    assert slot.length == pytest.approx((6 + 2 * np.pi) * inch)
    assert abs(slot.area) == pytest.approx((6 + np.pi) * inch**2)
    assert hole.length == pytest.approx(np.pi * inch)


def test_blocks_and_mirrored_arcs_stand_where_they_are_drawn(tmp_path: Path) -> None:
    drawing = ezdxf.new(units=ezdxf.units.MM)
    block = drawing.blocks.new("face")
    block.add_lwpolyline([(0, 0, 0.5), (10, 0, 0)], format="xyb")
    drawing.modelspace().add_blockref("face", (100, 0), dxfattribs={"rotation": 90})
    mirrored = {"extrusion": (0, 0, -1), "layer": "mirrored"}
    drawing.modelspace().add_arc((-50, 0), 10, 0, 90, dxfattribs=mirrored)
    drawing.saveas(tmp_path / "block.dxf")
    (curve,) = read_dxf(tmp_path / "block.dxf", layers="0")
    np.testing.assert_allclose(curve.points, [[0.1, 0.0], [0.1, 0.01]], atol=1e-15)
    np.testing.assert_allclose(curve.bulges, [0.5])
    # Turned about y, x = −50 lies at 50, and the quarter from +x goes to −x.
    (arc,) = read_dxf(tmp_path / "block.dxf", layers="mirrored")
    np.testing.assert_allclose(arc.centres[0], [0.05, 0.0], atol=1e-15)
    ends = {tuple(np.round(place, 12)) for place in arc.points[[0, -1]]}
    assert ends == {(0.04, 0.0), (0.05, 0.01)}


def test_drawings_are_refused_with_a_reason(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        read_dxf(tmp_path / "none.dxf")
    (tmp_path / "text.dxf").write_text("no drawing", encoding="utf-8")
    with pytest.raises(cd.ParameterError, match=r"text\.dxf"):
        read_dxf(tmp_path / "text.dxf")
    drawing = ezdxf.new(units=0)
    drawing.modelspace().add_text("nothing")
    drawing.saveas(tmp_path / "empty.dxf")
    with pytest.raises(cd.ParameterError, match="which unit") as refusal:
        read_dxf(tmp_path / "empty.dxf")
    assert refusal.value.hint == "give it: unit='mm'"
    with pytest.raises(cd.ParameterError, match="no curve is in the drawing, which has TEXT"):
        read_dxf(tmp_path / "empty.dxf", unit="mm")
    with pytest.raises(cd.ParameterError, match="must be one of mm, cm, m, in, ft"):
        read_dxf(tmp_path / "empty.dxf", unit="parsec")
    write_dxf(tmp_path / "circle.dxf", half_turns(0.01)._replace(layer="bore"))
    with pytest.raises(cd.ParameterError, match="no curve is on layer hub") as refusal:
        read_dxf(tmp_path / "circle.dxf", layers="hub")
    assert refusal.value.hint == "there are bore"


def test_outlines_that_are_no_sprockets_are_refused() -> None:
    drive = cd.scenes.industrial_16b()
    (outline,) = outlines(drive.profile("driver"))
    with pytest.raises(cd.ParameterError, match="gaps of 18 teeth differ by"):
        tooth(outline, 18)
    dented = outline._replace(
        points=outline.points * np.where(np.arange(77) == 40, 1.01, 1)[:, None]
    )
    with pytest.raises(cd.ParameterError, match="gaps of 19 teeth differ by"):
        tooth(dented, 19)
    with pytest.raises(cd.ParameterError, match="crosses the middle of a tooth 0 times"):
        tooth(outline, 19, centre=[10.0, 0.0])
    with pytest.raises(cd.ParameterError, match="is open"):
        tooth(outline._replace(closed=False, bulges=outline.bulges[:-1]), 19)
    with pytest.raises(cd.ParameterError, match="the curve is closed"):
        face(outline)


def test_pointed_teeth_are_cut_at_their_points() -> None:
    """Twelve seats of a quarter turn, and flanks that meet in a point."""
    angles = np.arange(36) * 2.0 * np.pi / 36
    radii = np.tile([0.05, 0.05, 0.06], 12)
    points = np.column_stack([radii * np.cos(angles), radii * np.sin(angles)])
    bulges = np.tile([-np.tan(np.pi / 8), 0.0, 0.0], 12)
    for turned in (0.0, 0.1, np.pi / 2):
        wheel = Curve(points, bulges, True).moved([0.3, 0.2], turned=turned)
        entry = tooth(wheel, 12)
        assert [piece["kind"] for piece in entry["pieces"]] == ["line", "arc", "line"]
        np.testing.assert_allclose(np.hypot(*entry["from"]), 0.06)
        # The tooth on the right is half a gap from the y axis.
        np.testing.assert_allclose(entry["from"][0], 0.06 * np.sin(np.pi / 12))


def test_the_face_is_cut_out_of_the_outline_of_a_shoe() -> None:
    """A shoe of two arcs about one centre and two straights; the outer arc is the face."""
    angles = np.array([0.2, 1.2])
    rim = np.column_stack([np.cos(angles), np.sin(angles)])
    bulge = np.tan(0.25)
    shoe = Curve(
        np.concatenate([0.5 * rim, 0.45 * rim[::-1]]), np.array([bulge, 0, -bulge, 0]), True
    )
    whole = shoe.stretch([0.6, 0.1], 0.5 * rim[1])
    np.testing.assert_allclose(whole.points, 0.5 * rim, atol=1e-15)
    np.testing.assert_allclose(whole.bulges, [bulge])
    middle = 0.5 * np.array([np.cos(0.7), np.sin(0.7)])
    half = shoe.stretch(middle, 0.5 * rim[1])
    assert half.length == pytest.approx(0.25)
    # On from there, around the back, to where it began.
    rest = shoe.stretch(0.5 * rim[1], middle)
    assert rest.length == pytest.approx(shoe.length - 0.25)
    around = shoe.stretch(middle, 0.5 * np.array([np.cos(0.6), np.sin(0.6)]))
    assert around.length == pytest.approx(shoe.length - 0.05)
    with pytest.raises(cd.ParameterError, match="lies before its start"):
        whole.stretch(middle, 0.5 * rim[0])
    # The tangents at the ends of a radian meet at R / cos ½.
    taken = face(whole, material="left")
    np.testing.assert_allclose(taken["radii"], [0.5])
    np.testing.assert_allclose(np.hypot(*taken["points"][1]), 0.5 / np.cos(0.5))


def test_an_svg_is_to_scale_and_its_arcs_are_arcs(tmp_path: Path) -> None:
    drive = cd.scenes.industrial_16b()
    profile = drive.profile("driver")
    write_svg(tmp_path / "driver.svg", profile)
    text = (tmp_path / "driver.svg").read_text(encoding="utf-8")
    (path,) = re.findall(r'<path d="(.*)"/>', text)
    steps = re.findall(r"([MLA])([^MLAZ]*)", path)
    numbers = [[float(it) for it in arguments.split()] for _, arguments in steps]
    ends = 1e-3 * np.array([row[-2:] for row in numbers])
    assert off(profile, ends) < 1e-11
    assert [kind for kind, _ in steps].count("A") >= 4 * 19
    # Middles of arcs, by the conversion of the SVG specification (F.6.5).
    for before, row, (kind, _) in zip(ends[:-1], numbers[1:], steps[1:], strict=True):
        if kind == "A":
            radius, _, _, large, sweep, *end = row
            radius, end = 1e-3 * radius, 1e-3 * np.array(end)
            chord = end - before
            height = np.sqrt(max(radius**2 - chord @ chord / 4, 0.0))
            left = np.array([-chord[1], chord[0]]) / np.hypot(*chord)
            side = 1.0 if large != sweep else -1.0
            centre = 0.5 * (before + end) + side * height * left
            out = 0.5 * (before + end) - centre
            middle = centre + radius * (-1.0 if large else 1.0) * out / np.hypot(*out)
            assert off(profile, middle) < 1e-9
    width = float(re.search(r'width="([\d.]+)mm"', text)[1])
    assert width == pytest.approx(1e3 * 1.04 * np.ptp(ends[:, 0]), rel=0.01)


@pytest.fixture(scope="module")
def run() -> xr.Dataset:
    drive = cd.scenes.marine_engine()
    settings = {"until": 5e-3, "every": 1e-3, "run_in": 0, "method": "verlet", "error": False}
    return cd.simulate(
        drive, record=["span_tension", "energy_residual"], events="teeth", **settings
    )


def test_netcdf_keeps_everything(run: xr.Dataset, tmp_path: Path) -> None:
    pytest.importorskip("h5py")
    pytest.importorskip("h5netcdf")
    assert cd.save(run, tmp_path / "run.nc") == [tmp_path / "run.nc"]
    with xr.open_dataset(tmp_path / "run.nc", engine="h5netcdf") as back:
        assert back.equals(run)
        assert set(back.attrs) == set(run.attrs)
        for name, value in run.attrs.items():
            np.testing.assert_array_equal(back.attrs[name], value, err_msg=name)
        for name in run.variables:
            assert back[name].attrs == run[name].attrs
        assert cd.diff(cd.scenes.marine_engine().replace({"run": {}}), back)
        assert cd.Drive.from_toml(back.attrs["scene"]).links == 122


def test_a_sweep_goes_into_netcdf(tmp_path: Path) -> None:
    pytest.importorskip("h5py")
    pytest.importorskip("h5netcdf")
    ring = cd.scenes.spinning_ring()
    swept = cd.sweep(ring, {"chain.mass": ["8 g", "9 g"]}, until=2e-3, every=1e-3)
    cd.save(swept, tmp_path / "sweep.nc")
    with xr.open_dataset(tmp_path / "sweep.nc", engine="h5netcdf") as back:
        assert back.equals(swept)
    with pytest.raises(cd.ParameterError, match="no samples over time, or more than one run"):
        cd.save(swept, tmp_path / "sweep.csv")


def test_tables_have_names_and_units(run: xr.Dataset, tmp_path: Path) -> None:
    pandas = pytest.importorskip("pandas")
    table, events = cd.save(run, tmp_path / "run.csv")
    assert events.name == "run.events.csv"
    read = pandas.read_csv(table)
    spans = [f"span_tension[{name}] [N]" for name in run["span"].to_numpy()]
    assert list(read.columns) == ["time [s]", *spans, "energy_residual [J]"]
    np.testing.assert_array_equal(read[spans], run["span_tension"])
    read = pandas.read_csv(events)
    assert len(read) == run.sizes["event"]
    assert {"event_kind", "event_start [s]", "event_peak_force [N]"} <= set(read.columns)


@pytest.mark.parametrize("change", ["transposed", "several runs", "a channel of several runs"])
def test_what_is_no_table_is_refused(run: xr.Dataset, change: str, tmp_path: Path) -> None:
    """Defect: only the time was written, or channels were missing without a word."""
    several = run.expand_dims(mass=[1.0, 2.0])
    other = {
        "transposed": run.transpose(..., "time"),
        "several runs": several,
        "a channel of several runs": several[["energy_residual"]],
    }[change]
    with pytest.raises(cd.ParameterError, match="is no table") as caught:
        cd.save(other, tmp_path / "run.csv")
    assert "select one run" in caught.value.hint
    assert not list(tmp_path.iterdir())


def test_parquet_knows_units_and_where_it_is_from(run: xr.Dataset, tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    table, events = cd.save(run, tmp_path / "run.parquet")
    read = parquet.read_table(table)
    field = read.schema.field(1)
    assert field.name.startswith("span_tension[")
    assert field.metadata[b"units"] == b"N"
    assert field.metadata[b"span"].decode() == run["span"].values[0]
    np.testing.assert_array_equal(read.column(1), run["span_tension"][:, 0])
    attributes = json.loads(read.schema.metadata[b"chaindrive"])
    assert attributes["scene"] == run.attrs["scene"]
    assert set(attributes) == set(run.attrs)
    assert parquet.read_table(events).num_rows == run.sizes["event"]


def test_other_files_are_refused(run: xr.Dataset, tmp_path: Path) -> None:
    with pytest.raises(cd.ParameterError, match=r"must end in \.nc, \.csv or \.parquet"):
        cd.save(run, tmp_path / "run.xlsx")


@pytest.mark.parametrize(
    ("end", "bulge"), [(1.0, np.nan), (1.0, np.inf), (1.0, 1e300), (np.nan, 0.1), (np.inf, 0.1)]
)
def test_curves_of_no_finite_size_are_refused(end, bulge):
    curve = cd.exchange.Curve(np.array([[0.0, 0.0], [end, 0.0]]), np.array([bulge]), closed=False)
    with pytest.raises(cd.ParameterError, match="not finite"):
        cd.exchange.face(curve)
    closed = curve._replace(bulges=np.append(curve.bulges, 1.0), closed=True)
    with pytest.raises(cd.ParameterError, match="not finite"):
        cd.exchange.tooth(closed, 19)
