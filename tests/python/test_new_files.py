"""Files that methods make: the old one or the new one, whole, and nothing beside it."""

import resource
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path

import pytest

import chaindrive as cd
from chaindrive.__main__ import _draw
from chaindrive.errors import WriteError

OLD = b"old"
HERE = str(Path(__file__).parent)

#: Every method that makes a file: the name, and what makes it of a run and a path.
MAKERS = {
    "page.html": lambda run, path: cd.replay(run, path, frames=4),
    "saved.html": lambda run, path: cd.replay(run, frames=4).save(path),
    "movie.gif": lambda run, path: cd.replay(run, path, frames=3),
    "movie.mp4": lambda run, path: cd.replay(run, path, frames=3),
    "run.csv": cd.save,
    "run.parquet": cd.save,
    "run.nc": cd.save,
    "drive.dxf": lambda run, path: cd.exchange.write_dxf(path, cd.load(run)),
    "drive.svg": lambda run, path: cd.exchange.write_svg(path, cd.load(run)),
    "report.html": lambda run, path: cd.report(run, path),
    "drive.fmu": lambda run, path: cd.fmu.export(
        cd.load(run), path, run=False, overwrite=True, library=__file__
    ),
}
every_maker = pytest.mark.parametrize("name", MAKERS)


@pytest.fixture(scope="module")
def run():
    return cd.simulate(cd.scenes.spinning_ring(), until=2e-3, every=1e-4, run_in=0, error=False)


def only(folder, *names):
    assert {it.name for it in folder.iterdir()} == set(names)


@contextmanager
def full_disk(room):
    """Files longer than this cannot be written; the system's signal about that is ignored."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (room, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


@every_maker
def test_what_cannot_be_replaced_is_refused(run, name, tmp_path):
    make, place = MAKERS[name], tmp_path / name
    victim = tmp_path / "victim"
    victim.write_bytes(OLD)
    place.symlink_to("victim")
    with pytest.raises(WriteError, match="symbolic link to victim") as raised:
        make(run, place)
    assert raised.value.path == str(place)
    assert victim.read_bytes() == OLD
    place.unlink()
    place.mkdir()
    with pytest.raises(WriteError, match="a folder here"):
        make(run, place)
    for folder in (victim, "/proc/1/none"):
        with pytest.raises(WriteError):
            make(run, f"{folder}/{name}")
    only(tmp_path, name, "victim")


@every_maker
def test_a_name_that_no_file_system_takes_is_refused(run, name, tmp_path):
    stem, _, ending = name.rpartition(".")
    with pytest.raises(WriteError, match="too long"):
        MAKERS[name](run, tmp_path / f"{300 * stem}.{ending}")
    only(tmp_path)


@every_maker
def test_missing_folders_are_made_and_old_files_replaced(run, name, tmp_path):
    place = tmp_path / "a" / "b" / name
    MAKERS[name](run, place)
    first = place.stat().st_size
    assert first > 100
    place.write_bytes(OLD)
    place.chmod(0o640)
    MAKERS[name](run, place)
    assert place.stat().st_size > 100
    assert place.stat().st_mode & 0o777 == 0o640
    only(place.parent, name)


@every_maker
def test_on_a_full_disk_the_old_file_stays(run, name, tmp_path):
    fill(run, name, tmp_path, lambda last: [last])


def fill(run, name, folder, blocks):
    make, place = MAKERS[name], folder / name
    make(run, place)
    whole = place.stat().st_size
    for block in sorted(blocks((whole - 1) // 4096)):
        place.write_bytes(OLD)
        with full_disk(4096 * block), pytest.raises(WriteError) as raised:
            make(run, place)
        assert raised.value.path == str(place)
        assert place.read_bytes() == OLD
        place.unlink()
        with full_disk(4096 * block), pytest.raises(WriteError):
            make(run, place)
        only(folder)


@every_maker
def test_writers_at_once_do_no_harm(run, name, tmp_path):
    # Pictures are drawn by one thread at a time.
    count = 1 if name == "report.html" or name.startswith("movie") else 3
    with ThreadPoolExecutor(count) as pool:
        list(pool.map(lambda _: MAKERS[name](run, tmp_path / name), range(count)))
    only(tmp_path, name)


def test_of_two_tables_neither_is_written_where_one_cannot_be(tmp_path):
    drive = cd.scenes.industrial_16b()
    run = cd.simulate(drive, until=1e-3, events=["teeth"], run_in=0, error=False, step=1e-6)
    (tmp_path / "run.events.csv").mkdir()
    with pytest.raises(WriteError):
        cd.save(run, tmp_path / "run.csv")
    only(tmp_path, "run.events.csv")


def test_a_report_is_refused_before_its_run(tmp_path, monkeypatch, capsys):
    (tmp_path / "there.html").write_bytes(OLD)
    (tmp_path / "folder.html").mkdir()
    (tmp_path / "file").write_bytes(OLD)
    monkeypatch.setattr("chaindrive.reporting.simulate", lambda *_, **__: pytest.fail("simulated"))
    for place, overwrite in (
        ("there.html", False),
        ("folder.html", True),
        ("file/report.html", True),
    ):
        path = str(tmp_path / place)
        line = ["chaindrive", "report", "marine_engine", "-o", path]
        assert _draw(line, "marine_engine", path, None, overwrite, False) == 3
        assert place in capsys.readouterr().err
    assert (tmp_path / "there.html").read_bytes() == OLD
    only(tmp_path, "there.html", "folder.html", "file")


@pytest.mark.parametrize("module", ["matplotlib", "imageio"])
def test_missing_extras_are_told_before_the_work(run, module, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, module, None)
    for part in ("pyplot", "v2"):
        monkeypatch.delitem(sys.modules, f"{module}.{part}", raising=False)
    monkeypatch.setattr("chaindrive.reporting.simulate", lambda *_, **__: pytest.fail("simulated"))
    makers = {
        "matplotlib": lambda: cd.report(cd.scenes.marine_engine(), tmp_path / "report.html"),
        "imageio": lambda: cd.replay(run, tmp_path / "movie.gif"),
    }
    with pytest.raises(ModuleNotFoundError, match=r"pip install 'chaindrive\["):
        makers[module]()
    only(tmp_path)


#: A process that is ended under way: it tells when it begins, and makes a file over and over.
UNDER_WAY = """
import signal
import sys
import chaindrive as cd
# A shell that starts tests in the background has it ignored.
signal.signal(signal.SIGINT, signal.default_int_handler)
sys.path.insert(0, {here!r})
from test_new_files import MAKERS
from chaindrive.signals import hear
hear()
run = cd.open_result({store!r})
print("begun", flush=True)
while True:
    MAKERS[{name!r}](run, {place!r})
"""


def end_under_way(run, name, folder, number, after):
    store, place = folder / "run.zarr", folder / "made" / name
    if not store.exists():
        cd.simulate(
            cd.scenes.spinning_ring(),
            until=2e-3,
            every=1e-4,
            run_in=0,
            error=False,
            output=store,
        )
    place.parent.mkdir()
    place.write_bytes(OLD)
    program = UNDER_WAY.format(here=HERE, store=str(store), name=name, place=str(place))
    with subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
    ) as process:
        process.stdout.readline()
        time.sleep(after)
        process.send_signal(number)
    found = place.read_bytes()
    assert found == OLD or len(found) > 100
    left = {it.name for it in place.parent.iterdir()} - {name}
    if number == signal.SIGKILL:
        assert all(it.startswith(".chaindrive-") for it in left)
    else:
        assert not left
    for it in place.parent.iterdir():
        it.unlink()
    place.parent.rmdir()


def test_ended_under_way_a_movie_leaves_nothing(run, tmp_path):
    end_under_way(run, "movie.mp4", tmp_path, signal.SIGTERM, 0.3)


@pytest.mark.slow
@every_maker
def test_whatever_the_moment_and_the_block(run, name, tmp_path):
    fill(run, name, tmp_path, lambda last: range(min(last, 400) + 1))
    for moment in range(20):
        number = [signal.SIGINT, signal.SIGTERM, signal.SIGKILL][moment % 3]
        end_under_way(run, name, tmp_path, number, 0.1 + 0.618034 * moment % 1.0)
