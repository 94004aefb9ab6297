"""Replays: what the page holds is what was recorded, and what cannot be shown is refused."""

import base64
import html
import json
import re
import subprocess
import sys
import zlib

import numpy as np
import pytest

import chaindrive as cd

CHANNELS = ["roller_x", "roller_y", "sprocket_angle", "tensioner_position", "span_tension"]
CHANNELS += ["link_tension", "contact_force", "energy_kinetic"]


@pytest.fixture(scope="module")
def run():
    return cd.simulate(
        cd.scenes.timing_drive(),
        until=3e-3,
        run_in=0,
        every=1e-5,
        step=3e-7,
        record=CHANNELS,
        events=["teeth"],
        error=False,
    )


@pytest.fixture(scope="module")
def page(run):
    return cd.replay(run).html


def block(page, name):
    return re.search(rf'<script id="{name}" type="[a-z/]+">(.*?)</script>', page, re.DOTALL)[1]


def decoded(page):
    """All arrays of a page by name, (rows, columns), with their quanta; as the page does it."""
    index = json.loads(block(page, "index"))
    packed = base64.b64decode(block(page, "data"))
    arrays = {}
    for it in index["streams"]:
        raw = zlib.decompress(packed[it["at"] : it["at"] + it["length"]], wbits=-15)
        planes = np.frombuffer(raw, np.uint8).reshape(it["planes"], -1).astype(np.int64)
        zigzag = sum(plane << (8 * number) for number, plane in enumerate(planes))
        whole = ((zigzag >> 1) ^ -(zigzag & 1)).reshape(it["columns"], it["rows"])
        for _ in range(it["order"][0]):
            whole = np.cumsum(whole, axis=1)
        for _ in range(it["order"][1]):
            whole = np.cumsum(whole, axis=0)
        arrays[it["name"]] = it["origin"] + it["quantum"] * whole.T, it["quantum"]
    return index, arrays


def test_values_are_those_recorded_within_half_a_quantum(run, page):
    index, arrays = decoded(page)
    assert index["quanta"]["distance"] <= 1e-4
    for name in ("roller_x", "roller_y", "link_tension", "contact_force"):
        values, quantum = arrays[name]
        recorded = run[name].to_numpy()
        assert np.abs(values - recorded).max() <= 0.5 * quantum * (1 + 1e-9), name
        if name.startswith("roller"):
            assert quantum <= 1e-4
        else:
            assert quantum <= 0.0025 * np.abs(recorded).max() * (1 + 1e-9)
    for curve in index["curves"]:
        values, quantum = arrays[curve["stream"]]
        recorded = run["span_tension"].sel(span=curve["label"]).to_numpy()
        assert np.abs(values[:, 0] - recorded).max() <= 0.5 * quantum * (1 + 1e-9)
        assert quantum <= 0.0025 * run["span_tension"].to_numpy().max()
    times, quantum = arrays["time"]
    assert np.abs(times[:, 0] - run["time"].to_numpy()).max() <= 0.5 * quantum


def test_bodies_stand_where_the_pose_has_them(run, page):
    """Sprockets turn by what was recorded, and the shoe goes with the arm."""
    index, arrays = decoded(page)
    names = [(body["kind"], body["name"]) for body in index["bodies"]]
    figure = cd.scenes.timing_drive()._inner.figure(True, 0.0)
    given = {name: run[name].to_numpy() for name in ("sprocket_angle", "tensioner_position")}
    placements = figure.placements(run["time"].to_numpy(), given)
    assert [(body["kind"], body["name"]) for body in figure.bodies(1e-4)] == names
    for axis, name in enumerate(("body_x", "body_y", "body_angle")):
        values, quantum = arrays[name]
        assert np.abs(values - placements[:, :, axis]).max() <= 0.5 * quantum * (1 + 1e-9)
    turned = arrays["body_angle"][0][:, names.index(("sprocket", "crank"))]
    recorded = run["sprocket_angle"].sel(sprocket="crank").to_numpy()
    assert np.allclose(turned - turned[0], recorded - recorded[0], atol=2e-3)


def test_arrows_point_out_of_the_teeth(run, page):
    """Teeth press rollers outwards, at pressure angles of no more than 60 degrees."""
    index, arrays = decoded(page)
    force, direction = arrays["contact_force"][0], arrays["contact_direction"][0]
    x, y = arrays["roller_x"][0], arrays["roller_y"][0]
    sprockets = [i for i, body in enumerate(index["bodies"]) if body["kind"] == "sprocket"]
    centres = np.stack([arrays["body_x"][0][:, sprockets], arrays["body_y"][0][:, sprockets]])
    away = np.stack([x, y])[:, :, :, None] - centres[:, :, None, :]
    nearest = np.abs(np.hypot(*away)).argmin(axis=2)
    radial = np.take_along_axis(np.arctan2(away[1], away[0]), nearest[:, :, None], 2)[:, :, 0]
    pressing = force > 0.02 * force.max()
    assert pressing.any()
    assert np.cos(direction - radial)[pressing].min() > 0.5


def test_contacts_are_those_logged(run, page):
    _, arrays = decoded(page)
    starts, quantum = arrays["event_start"]
    recorded = np.sort(run["event_start"].to_numpy())
    assert len(recorded) > 20
    assert np.abs(starts[:, 0] - recorded).max() <= 0.5 * quantum
    order = np.argsort(run["event_start"].to_numpy(), kind="stable")
    rollers = run["event_roller"].to_numpy()[order]
    # Contacts that begin at one instant may change places.
    assert sorted(arrays["event_roller"][0][:, 0]) == sorted(rollers)


def test_page_stands_alone(page):
    without_data = page.replace(block(page, "data"), "").replace(block(page, "index"), "")
    for outside in ("http", "//cdn", " src=", "@import", "url("):
        assert outside not in without_data, outside


def test_size_of_a_page_stays_within_its_budget(run):
    """122 rollers and 5001 frames with tension and contact force: 1.4 MB with linked plots."""
    run = cd.simulate(
        cd.scenes.marine_engine(),
        until=0.5,
        run_in=0,
        every=1e-4,
        method="verlet",
        record=CHANNELS,
        error=False,
    )
    plain = cd.replay(run, plot=[])
    assert len(run["roller"]) == 122
    assert json.loads(block(plain.html, "index"))["streams"][0]["rows"] == 5001
    assert len(plain.html) <= 1.2e6
    assert len(cd.replay(run, plot=["span_tension", "energy_kinetic"]).html) <= 1.4e6


def test_every_nth_sample_is_taken_and_the_page_says_so(run):
    index, arrays = decoded(cd.replay(run, frames=100).html)
    stride = index["about"]["stride"]
    assert stride == -(-run.sizes["time"] // 100)
    assert index["about"]["samples"] == run.sizes["time"]
    times = run["time"].to_numpy()[::stride]
    assert len(times) <= 100
    assert np.abs(arrays["time"][0][:, 0] - times).max() < 1e-6


def test_channels_are_plotted_by_name(run):
    index = json.loads(block(cd.replay(run, plot=["energy_kinetic"]).html, "index"))
    assert [(it["channel"], it["unit"], it["label"]) for it in index["curves"]] == [
        ("energy_kinetic", "J", "")
    ]
    with pytest.raises(
        KeyError, match=r"`oil_pressure` was not recorded.*there are .*span_tension"
    ):
        cd.replay(run, plot=["oil_pressure"])


def test_run_without_motion_names_the_channels_to_record(run):
    with pytest.raises(KeyError, match=r"roller_y, tensioner_position.*not recorded.*--record"):
        cd.replay(run.drop_vars(["roller_y", "tensioner_position"]))
    with pytest.raises(ValueError, match=r"must end in \.html, \.mp4 or \.gif"):
        cd.replay(run, "drive.pdf")
    with pytest.raises(ValueError, match="frames = 0"):
        cd.replay(run, frames=0)
    with pytest.raises(ValueError, match="a movie has no plots"):
        cd.replay(run, "nowhere/drive.mp4", plot=["span_tension"])
    with pytest.raises(ValueError, match="no samples"):
        cd.replay(run.isel(time=slice(0, 0)))


def test_texts_of_a_run_do_not_break_the_page(run):
    awkward = run.assign_attrs(
        title="</script><b>{{data}} & co", summary="<!-- </script> {{index}}"
    )
    index, arrays = decoded(cd.replay(awkward).html)
    assert index["about"]["title"] == awkward.attrs["title"]
    assert index["about"]["summary"] == awkward.attrs["summary"]
    assert "roller_x" in arrays
    assert "</script><b>" not in cd.replay(awkward).html


def test_notebook_shows_the_page_in_a_frame(run, page):
    shown = cd.replay(run)._repr_html_()
    assert shown.startswith("<iframe srcdoc=")
    inner = shown.split('srcdoc="')[1].split('"')[0]
    assert html.unescape(inner) == page
    assert len(shown) < 1.1 * len(page)


def test_accessor_and_file_are_the_same_page(run, page, tmp_path):
    run.drive.replay(tmp_path / "drive.html")
    assert (tmp_path / "drive.html").read_text(encoding="utf-8") == page


def command(*arguments, folder):
    ran = subprocess.run(
        [sys.executable, "-m", "chaindrive", "replay", *arguments],
        cwd=folder,
        capture_output=True,
        text=True,
    )
    return ran.returncode, ran.stderr


def test_command_makes_the_same_page_of_a_store(tmp_path):
    """From the arrays in memory and from those on disk."""
    run = cd.simulate(
        cd.scenes.timing_drive(),
        until=1e-3,
        run_in=0,
        every=2e-5,
        step=3e-7,
        record=CHANNELS,
        events=["teeth", "guides"],
        error=False,
        output=str(tmp_path / "run.zarr"),
    )
    code, told = command("run.zarr", "--plot", "span_tension,energy_kinetic", folder=tmp_path)
    assert (code, "51 frames, every sample" in told) == (0, True), told
    page = (tmp_path / "run.html").read_text(encoding="utf-8")
    assert page == cd.replay(run, plot=["span_tension", "energy_kinetic"]).html

    code, told = command("run.zarr", folder=tmp_path)
    assert code == 3
    assert "--overwrite" in told
    code, told = command("run.zarr", "--overwrite", "--frames", "20", folder=tmp_path)
    assert code == 0
    assert "17 frames, one in 3 of 51 samples" in told
    code, told = command("run.zarr", "-o", "run.txt", folder=tmp_path)
    assert code == 2
    assert "must end in .html" in told
    code, told = command("gone.zarr", folder=tmp_path)
    assert code == 2
    assert "nothing of this name" in told


def test_movies_and_reports_are_asked_for_as_all_else_is(tmp_path):
    def asked(*arguments):
        return cd._core._drawn(["chaindrive", *arguments])

    assert asked("replay", "a.zarr", "--mp4") == ("a.zarr", "a.mp4", None, False, False)
    assert asked("replay", "-qo", "b.gif", "a.zarr", "--frames=9") == (
        "a.zarr",
        "b.gif",
        9,
        False,
        True,
    )
    assert asked("report", "scenes/a.toml") == ("scenes/a.toml", "a.html", None, False, False)
    # Pages, help, and what is wrong belong to the command.
    for others in ("replay a.zarr", "replay --mp4 -h", "replay a --mp4 --gif", "run ring"):
        assert asked(*others.split()) is None
    code, told = command("a.zarr", "-o", "a.mp4", "--plot", "span_tension", folder=tmp_path)
    assert code == 2
    assert "a movie has no plots" in told
    code, told = command("gone.zarr", "--gif", folder=tmp_path)
    assert code == 2
    assert "gone.zarr" in told


def test_result_that_ended_early_is_replayed_and_says_how(tmp_path):
    path = tmp_path / "run.zarr"
    cd.simulate(cd.scenes.spinning_ring(), until=2e-3, error=False, output=str(path))
    group = json.loads((path / "zarr.json").read_text())
    for said, status in (("running", "killed"), ("interrupted", "interrupted")):
        group["attributes"]["status"] = said
        (path / "zarr.json").write_text(json.dumps(group))
        code, told = command("run.zarr", "--overwrite", folder=tmp_path)
        assert code == 0, told
        page = (tmp_path / "run.html").read_text(encoding="utf-8")
        assert json.loads(block(page, "index"))["about"]["status"] == status


def test_movies_tell_how_far_they_are(run, tmp_path):
    pytest.importorskip("imageio.v3")
    from chaindrive.movies import movie

    shares = []
    movie(run, tmp_path / "drive.gif", frames=3, size=(160, 90), progress=shares.append)
    assert shares == pytest.approx([1 / 3, 2 / 3, 1.0])


def test_what_moves_is_drawn_over_what_stands_as_if_all_were_drawn_anew(run):
    pytest.importorskip("matplotlib")
    from chaindrive.movies import _Stage

    stage = _Stage(run, np.array([0, 3, 7]), (640, 360))
    for number in (2, 0, 1):
        shown = stage.picture(number).copy()
        for artist in stage.moving:
            artist.set_animated(False)
        stage.canvas.draw()
        assert np.array_equal(shown, stage.canvas.buffer_rgba())


def test_movies_are_made_of_the_same_frames(run, tmp_path):
    imageio = pytest.importorskip("imageio.v3")
    pytest.importorskip("imageio_ffmpeg")
    for name in ("drive.mp4", "drive.gif"):
        path = cd.replay(run, tmp_path / name, frames=5)
        pictures = imageio.imread(path)
        assert pictures.shape[0] == 5
        assert pictures.shape[1:3] == (720, 1280)
        # The drive moves from picture to picture.
        assert (np.abs(pictures[0].astype(int) - pictures[-1]) > 60).sum() > 200
