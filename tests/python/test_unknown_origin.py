"""Files of unknown origin: they carry out nothing, lead nowhere else, and end."""

import csv
import json
import os
import pickle
import random
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from mutants import damaged

import chaindrive as cd
from chaindrive.errors import ChaindriveError
from chaindrive.page import _with_verdict

COMMAND = [sys.executable, "-m", "chaindrive"]
RUN = {"until": 4e-3, "every": 1e-4, "error": False}


def ring(place: Path, **settings: object) -> Path:
    """A small result."""
    cd.simulate(cd.scenes.spinning_ring(), output=place, **{**RUN, **settings})
    return place


@pytest.fixture
def store(tmp_path: Path) -> Path:
    return ring(tmp_path / "ring.zarr")


class Evil:
    """Says so when it is unpickled."""

    def __init__(self, flag: Path) -> None:
        self.flag = flag

    def __reduce__(self) -> tuple[object, ...]:
        return Path.touch, (self.flag,)


def test_a_result_carries_out_no_code(tmp_path: Path) -> None:
    """A store of Zarr 2 may be packed by `pickle`, and readers unpack `time` at once."""
    root, flag = tmp_path / "evil.zarr", tmp_path / "flag"
    attributes = {"format": "chaindrive", "status": "complete", "samples": 3}
    array = {
        "zarr_format": 2, "shape": [3], "chunks": [3], "dtype": "|O", "order": "C",
        "compressor": {"id": "pickle"}, "fill_value": "", "filters": [{"id": "vlen-utf8"}],
    }  # fmt: skip
    (root / "time").mkdir(parents=True)
    for name, text in {
        ".zgroup": {"zarr_format": 2},
        ".zattrs": attributes,
        "time/.zarray": array,
        "time/.zattrs": {"_ARRAY_DIMENSIONS": ["time"]},
    }.items():
        (root / name).write_text(json.dumps(text))
    (root / "time" / "0").write_bytes(pickle.dumps(Evil(flag)))
    with pytest.raises(ValueError, match="no"):
        cd.open_result(root)
    # With a document of format 3 beside it as well.
    group = {"zarr_format": 3, "node_type": "group", "attributes": attributes}
    (root / "zarr.json").write_text(json.dumps(group))
    with pytest.raises(ValueError, match=r"damaged|no"):
        cd.open_result(root).load()
    assert not flag.exists()


def edited(store: Path, change: Callable[[dict], None]) -> None:
    group = json.loads((store / "zarr.json").read_text())
    change(group["consolidated_metadata"]["metadata"])
    (store / "zarr.json").write_text(json.dumps(group))


def is_refused(store: Path, why: str) -> None:
    with pytest.raises(ValueError, match=why):
        cd.open_result(store)
    command = subprocess.run(
        [*COMMAND, "replay", store, "-o", store.parent / "replay.html"],
        capture_output=True, text=True, timeout=20, check=False,
    )  # fmt: skip
    assert command.returncode == 2, command
    assert not (store.parent / "replay.html").exists()


def test_links_devices_and_pipes_are_refused(store: Path) -> None:
    chunk = store / "time" / "c" / "0"
    chunk.unlink()
    chunk.symlink_to("/dev/zero")
    is_refused(store, "`time/c/0` is a link, a device or a pipe")
    chunk.unlink()
    os.mkfifo(chunk)
    is_refused(store, "`time/c/0` is a link, a device or a pipe")
    (store / "zarr.json").unlink()
    (store / "zarr.json").symlink_to("/dev/zero")
    is_refused(store, "not a result")


def test_what_is_declared_is_there(store: Path) -> None:
    def longer(arrays: dict) -> None:
        arrays["time"]["shape"] = [10**15]

    edited(store, longer)
    is_refused(store, "`time` holds less than it declares")


def test_no_chunk_is_larger_than_it_should_be(store: Path) -> None:
    def larger(arrays: dict) -> None:
        arrays["time"]["chunk_grid"]["configuration"]["chunk_shape"] = [10**12]

    kept = (store / "zarr.json").read_text()
    edited(store, larger)
    is_refused(store, "a chunk holds more than 256 MiB")
    (store / "zarr.json").write_text(kept)
    chunk = store / "time" / "c" / "0"
    packed = chunk.read_bytes()
    # Two bytes of the header are the size of what is packed, less 256 (RFC 8878).
    assert packed[4] >> 6 == 1
    chunk.write_bytes(packed[:5] + b"\xff\xff" + packed[7:])
    is_refused(store, "a chunk holds more than it should")
    chunk.write_bytes(os.urandom(1 << 20))
    is_refused(store, "a chunk holds more than it should")


def test_unknown_codecs_and_types_are_refused(store: Path) -> None:
    def packed(arrays: dict) -> None:
        arrays["time"]["codecs"].append({"name": "numcodecs.pickle"})

    kept = (store / "zarr.json").read_text()
    edited(store, packed)
    is_refused(store, "packed by a codec")
    (store / "zarr.json").write_text(kept)
    edited(store, lambda arrays: arrays["time"].update(data_type="object"))
    is_refused(store, "type is none")


def chaindrive(*arguments: object) -> subprocess.CompletedProcess[str]:
    command = [*COMMAND, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)


@pytest.mark.parametrize("verb", ["run", "resume"])
def test_a_lock_leads_nowhere_else(tmp_path: Path, store: Path, verb: str) -> None:
    victim, beside = tmp_path / "victim.txt", tmp_path / ".ring.zarr.writing"
    victim.write_text("precious")
    beside.mkdir()
    (beside / "lock").symlink_to(victim)
    arguments = {
        "run": ["run", "spinning_ring", "--until", "2ms", "--no-error", "--overwrite", "-o", store],
        "resume": ["resume", store, "--until", "8ms"],
    }[verb]
    refused = chaindrive(*arguments, "-q")
    assert refused.returncode == 3
    assert "--take-over" in refused.stderr
    assert victim.read_text() == "precious"
    taken = chaindrive(*arguments, "-q", "--take-over")
    # That run was not asked to keep checkpoints.
    assert taken.returncode == (0 if verb == "run" else 2), taken
    assert victim.read_text() == "precious"
    assert not beside.exists()


@pytest.mark.skipif(
    not hasattr(os, "geteuid") or os.geteuid() != 0, reason="others' files need root"
)
def test_the_folder_of_another_user_is_not_ours(tmp_path: Path) -> None:
    beside = tmp_path / ".new.zarr.writing"
    beside.mkdir()
    os.chown(beside, 12345, 12345)
    with pytest.raises(cd.WriteError, match="another user"):
        ring(tmp_path / "new.zarr")
    cd.take_over(tmp_path / "new.zarr")
    ring(tmp_path / "new.zarr")


def test_texts_command_no_terminal(tmp_path: Path) -> None:
    scene = tmp_path / "evil.json"
    evil = "\x1b]0;evil\x07"
    scene.write_text(json.dumps({"title": evil, evil: 1, "chain": "16B-1"}))
    told = chaindrive("check", scene)
    assert told.returncode == 2
    assert "\x1b" not in told.stderr
    assert "control characters" in told.stderr
    with pytest.raises(cd.SceneError) as refused:
        cd.load(scene)
    assert "\x1b" not in str(refused.value)
    # A name of a file, which nothing refuses.
    told = chaindrive("check", tmp_path / f"{evil}.toml")
    assert "\x1b" not in told.stderr
    assert "no such file" in told.stderr


def test_a_recording_that_no_disk_holds_is_not_begun(tmp_path: Path) -> None:
    with pytest.raises(cd.WriteError, match="of disk"):
        ring(tmp_path / "large.zarr", until=1e3, every=1e-6, record="all")
    assert not list(tmp_path.iterdir())


def test_drawings_that_are_damaged_are_said_to_be(tmp_path: Path) -> None:
    place = tmp_path / "drawing.dxf"
    with pytest.raises(cd.ParameterError, match="no outlines"):
        cd.exchange.write_dxf(cd.scenes.hanging_chain(), "x.dxf")  # type: ignore[arg-type]
    with pytest.raises(cd.ParameterError, match="empty"):
        cd.exchange.face(cd.exchange.Curve(np.zeros((0, 2)), np.zeros(0), False))
    cd.exchange.write_dxf(place, cd.scenes.industrial_16b().profile("driver"))
    damage(place, random.Random(1), 40, cd.exchange.read_dxf)


def damage(place: Path, lot: random.Random, times: int, opened: Callable[[Path], object]) -> None:
    """Damages a file or folder, and opens it: in time, and with documented exceptions."""
    whole = place.with_name("whole")
    (shutil.copytree if place.is_dir() else shutil.copy)(place, whole)
    for _ in range(times):
        if place.is_dir():
            shutil.rmtree(place)
            shutil.copytree(whole, place)
        else:
            shutil.copy(whole, place)
        files = (
            [place] if place.is_file() else sorted(it for it in place.rglob("*") if it.is_file())
        )
        file = lot.choice(files)
        held = bytearray(file.read_bytes())
        file.write_bytes(damaged(held, lot))
        begun = time.monotonic()
        with suppress(ChaindriveError, ValueError, FileNotFoundError):
            opened(place)
        assert time.monotonic() - begun < 5.0, held[:200]
    # Nothing was written outside.
    assert sorted(it.name for it in place.parent.iterdir()) == sorted([place.name, "whole"])


def test_results_that_are_damaged_are_said_to_be(tmp_path: Path) -> None:
    damage(ring(tmp_path / "ring.zarr"), random.Random(2), 60, shown)


def shown(place: Path) -> None:
    """Open a result and read all that a replay takes of it."""
    cd.replay(cd.open_result(place))


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
def test_thousands_of_damaged_files(tmp_path: Path) -> None:
    """5 000 stores, 2 000 drawings, 2 000 results with a checkpoint, 500 scenes."""
    (tmp_path / "a").mkdir()
    damage(ring(tmp_path / "a" / "ring.zarr"), random.Random(3), 5000, shown)
    (tmp_path / "b").mkdir()
    drawing = tmp_path / "b" / "drawing.dxf"
    cd.exchange.write_dxf(drawing, cd.scenes.industrial_16b().profile("driver"))
    damage(drawing, random.Random(4), 2000, cd.exchange.read_dxf)
    (tmp_path / "c").mkdir()
    kept = ring(tmp_path / "c" / "ring.zarr", checkpoint_every=1e-3)
    damage(kept, random.Random(5), 2000, lambda place: cd.resume(place, until=4.2e-3))
    lot = random.Random(6)
    controls = [chr(it) for it in range(32) if chr(it) not in "\n\t"] + ["\x7f", "\u202e"]
    for _ in range(500):
        scene = cd.scenes.spinning_ring().to_dict()
        text = "".join(lot.choice([*controls, "a"]) for _ in range(9)) + lot.choice(controls)
        scene[lot.choice(["title", text])] = text
        with pytest.raises(cd.SceneError) as refused:
            cd.Drive.from_dict(scene)
        assert not any(it in str(refused.value) for it in controls)


def test_a_tiny_restitution_is_refused() -> None:
    """A contact that returns nothing is stiffer than any step: runs did not come back from it."""
    with pytest.raises(cd.SceneError, match="at least 1e-6"):
        cd.scenes.industrial_16b().replace({"contact.teeth.restitution": 8e-13})


# Names that command a terminal, part lines, hide, turn the order of reading, or are formulas, tags,
# paths or formats to somebody.
NASTY = [
    "\x00a",
    "\x07a",
    "\x08a",
    "\x0ba",
    "\x0ca",
    "\ra",
    "\x1b[2J",
    "\x1b]0;a\x07",
    "\x7fa",
    "\x85a",
    "\x9b2Ja",
    "a\nverdict: trusted",
    "a\tb",
    "a\u2028b",
    "a\u2029b",
    "a\u200bb",
    "a\u200db",
    "a\u200eb",
    "a\u202eb",
    "a\u2060b",
    "a\u2066b",
    "a\u061cb",
    "a\ufeffb",
    "a\u00adb",
    "a\ufff9b",
    "a\U000e0041b",
    "\U000e0001",
    "=1+1",
    "+1",
    "-1+2",
    "@sum",
    "=cmd|' /C calc'!A0",
    "<script>alert(1)</script>",
    "</script><b>",
    "<!--",
    "]]>",
    "&lt;b&gt;",
    '" onload="x',
    "%s%n",
    "{0}{{title}}",
    "a,b;c",
    "'; drop",
    "`id`",
    "$(id)",
    "../../etc",
    "\u05e9\u05dc\u05d5\u05dd",
    "Kette µ",
]
STRANGE = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\xad\u061c\u180e\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff\ufff9-\ufffb\U000e0000-\U000e0fff]"
)


def named(name: str, title: str) -> cd.Drive:
    scene = cd.scenes.industrial_16b().to_dict()
    scene["title"] = title
    scene["sprockets"][1]["name"] = name
    if "route" in scene:
        scene["route"].pop("stops", None)
    return cd.Drive.from_dict(scene)


def outputs(drive: cd.Drive, folder: Path) -> dict[str, str]:
    """Everything that shows names, by where."""
    store, scene = folder / "a.zarr", folder / "a.toml"
    run = cd.simulate(
        drive, until=2e-4, every=1e-4, run_in=0, error=False, output=store, events=["teeth"]
    )
    page = run.drive.summary()
    scene.write_text(drive.text, encoding="utf-8")
    times = ["--until", "0.2ms", "--every", "0.1ms", "--run-in", "0", "--no-error"]
    told = chaindrive("run", scene, *times, "--json")
    table = chaindrive("run", scene, *times, "-o", "-")
    svg = folder / "a.svg"
    files = cd.save(run, folder / "a.csv")
    chaindrive("draw", scene, "-o", svg)
    shown = {
        "page": str(page),
        "notebook": page._repr_html_(),
        "replay": cd.replay(run).html,
        "description": str(drive.describe()),
        "JSON": told.stdout,
        "terminal": told.stderr + table.stderr,
        "CSV": table.stdout.replace("\r", ""),
        "SVG": svg.read_text(encoding="utf-8"),
    }
    return shown | {file.name: file.read_text(encoding="utf-8").replace("\r", "") for file in files}


@pytest.mark.slow
def test_names_speak_for_nobody_else(tmp_path: Path) -> None:
    assert len(NASTY) >= 40
    taken = 0
    for number, name in enumerate(NASTY):
        for scene in [(name, "plain"), ("plain", name)]:
            try:
                drive = named(*scene)
            except cd.SceneError:
                continue
            assert not STRANGE.search(name), ascii(name)
            taken += 1
            folder = tmp_path / f"{number}-{scene[0] == name}"
            folder.mkdir()
            for where, text in outputs(drive, folder).items():
                assert not STRANGE.search(text), (where, ascii(name))
                if where in ("notebook", "replay", "SVG") and "<" in name:
                    assert name not in text, (where, name)
                if where.lower().endswith("csv"):
                    cells = [it for row in csv.reader(text.splitlines()) for it in row]
                    formulas = [it for it in cells if it[:1] in ("=", "+", "@")]
                    # A number that is a name is shown as a number.
                    assert set(formulas) <= {"+1"}, (where, name)
    assert taken > 15


def test_names_with_lines_and_unseen_characters_are_refused() -> None:
    for name in NASTY:
        if STRANGE.search(name) or {"\n", "\t"} & set(name):
            with pytest.raises(cd.SceneError) as refused:
                named(name, "")
            told = str(refused.value)
            assert not STRANGE.search(told), ascii(name)
            assert all(line.startswith("scene: ") for line in told.splitlines()), ascii(name)


def test_what_a_foreign_result_says_commands_no_terminal(store: Path) -> None:
    group = json.loads((store / "zarr.json").read_text())
    evil = "\x1b]0;a\x07\u202e\nverdict: trusted"
    group["attributes"] |= {"status": "failed", "failure": evil, "title": evil, "summary": evil}
    (store / "zarr.json").write_text(json.dumps(group))
    with pytest.warns(cd.ResultWarning) as warned:
        run = cd.open_result(store)
    (told,) = [str(it.message) for it in warned]
    assert not STRANGE.search(told)
    assert "\n" not in told
    assert not STRANGE.search(run.attrs["failure"] + run.attrs["title"])
    group["attributes"] |= {"status": "complete", "page": "{"}
    (store / "zarr.json").write_text(json.dumps(group))
    run = cd.open_result(store)
    with pytest.raises(ValueError, match="damaged"):
        run.drive.summary()
    assert "<" in _with_verdict(run)


def test_labels_of_a_foreign_result_command_no_terminal(tmp_path: Path) -> None:
    """Names of sprockets, units of arrays, whole texts: whoever wrote them."""
    evil = "crank\x1b]0;a\x07\u202e\nverdict: trusted"
    place = tmp_path / "foreign.zarr"
    drive = cd.scenes.marine_two_sprockets()
    record = ["roller_x", "roller_y", "sprocket_angle", "span_tension"]
    cd.simulate(drive, **RUN | {"record": record, "run_in": 0}, output=place)
    zarr = pytest.importorskip("zarr")
    stored = zarr.open_group(place, mode="r+")
    labels = ["sprocket", "span"]
    for name in labels:
        stored[name][0] = evil
    group = json.loads((place / "zarr.json").read_text())
    group["attributes"] |= {"title": evil, "reasons": "{" + evil}
    arrays = group["consolidated_metadata"]["metadata"]
    arrays["span_tension"]["attributes"] |= {"units": evil, "long_name": evil}
    (place / "zarr.json").write_text(json.dumps(group))
    run = cd.open_result(place)
    for name in labels:
        assert run[name].to_numpy()[0] == "crank\\u{1b}]0;a\\u{7}\\u{202e}\\nverdict: trusted"
    texts = [run.attrs["title"], run.attrs["reasons"], *run["span_tension"].attrs.values()]
    assert not any(STRANGE.search(str(it)) for it in texts)
    cd.save(run, tmp_path / "foreign.csv")
    page = cd.replay(run, frames=3)._repr_html_()
    command = [sys.executable, "-m", "chaindrive", "replay", str(place), "-o", "told.html"]
    told = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    shown = [page, told.stdout, told.stderr, (tmp_path / "foreign.csv").read_text()]
    for text in shown:
        assert not any(line.startswith("verdict: trusted") for line in text.splitlines())
    for text in [*shown, *(it.read_text() for it in tmp_path.glob("*.html"))]:
        assert not STRANGE.search(text)
