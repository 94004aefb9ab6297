"""Extras: asked for by name where they are missing, and progress bars, which are one."""

import os
import subprocess
import sys
import tomllib
from pathlib import Path
from types import ModuleType

import pytest

from chaindrive.extras import _BRINGS, extra

ROOT = Path(__file__).resolve().parents[2]


def test_every_extra_is_one_that_the_wheel_has() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"]
    for package, name in _BRINGS.items():
        named = [needed.partition(">")[0].replace("-", "_") for needed in extras[name]]
        assert package in named


# Package, extra, and what needs it.
NEEDS = [
    ("matplotlib", "plot", "cd.plot.layout(ring)"),
    ("matplotlib", "plot", "cd.plot.rainflow(cd.simulate(ring, until=1e-3))"),
    ("zarr", "zarr", "cd.simulate(ring, output='ring.zarr')"),
    ("zarr", "zarr", "cd.open_result('ring.zarr')"),
    ("tqdm", "progress", "cd.simulate(ring, progress=True)"),
    ("ezdxf", "dxf", "cd.exchange.write_dxf('ring.dxf', ring)"),
    ("h5netcdf", "netcdf", "cd.save(cd.simulate(ring, until=1e-3), 'ring.nc')"),
    ("scipy", "analysis", "cd.simulate(ring, until=1e-3).drive.spectrum('link_tension')"),
]
WITHOUT = """
import sys
packages, codes = eval(sys.argv[1])
sys.modules.update(dict.fromkeys(packages))
import chaindrive as cd
ring = cd.scenes.spinning_ring()
for code in codes:
    try:
        exec(code)
    except ModuleNotFoundError as error:
        print(error)
    else:
        print("nothing is missing")
"""


@pytest.fixture(scope="module")
def told() -> dict[str, str]:
    """What a process says that has none of the packages, by what it was to do."""
    codes = [code for *_, code in NEEDS]
    words = repr(([package for package, *_ in NEEDS], codes))
    command = [sys.executable, "-c", WITHOUT, words]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return dict(zip(codes, done.stdout.splitlines(), strict=True))


@pytest.mark.parametrize(("package", "name", "code"), NEEDS)
def test_a_missing_extra_is_asked_for_by_name(
    told: dict[str, str], package: str, name: str, code: str
) -> None:
    assert f"take the package {package}: pip install 'chaindrive[{name}]'" in told[code]


def test_a_broken_package_gives_its_own_reason(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "tqdm_broken.py").write_text("import no_such_package\n", encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(ModuleNotFoundError, match="No module named 'no_such_package'"):
        extra("tqdm_broken", "bars")


RUN = (
    "import chaindrive as cd\n"
    "drive = cd.scenes.marine_two_sprockets()\n"
    "cd.simulate(drive, run_in=0.5, until=0.3, every=1e-2, method='verlet', error=False,"
    " progress=True)\n"
    "cd.sweep(drive, {'chain.mass': ['8 kg', '9 kg']}, until=1e-3, every=1e-3, run_in=0,"
    " progress=True)\n"
)


def test_a_pipe_shows_no_bar(capfd: pytest.CaptureFixture[str]) -> None:
    exec(RUN, {})
    assert capfd.readouterr() == ("", "")


class Output:
    """One output of a notebook."""

    def __init__(self) -> None:
        self.texts: list[str] = []

    def update(self, data: dict[str, str], raw: bool) -> None:
        self.texts.append(data["text/plain"])


def test_a_notebook_has_one_output_a_bar_whose_text_is_replaced(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """Without ipywidgets, and without a line in the standard error for every state."""
    shown = []

    def display(data: dict[str, str], raw: bool, display_id: bool) -> Output:
        shown.append(Output())
        shown[-1].update(data, raw)
        return shown[-1]

    monkeypatch.setitem(sys.modules, "ipykernel", ModuleType("ipykernel"))
    monkeypatch.setitem(sys.modules, "IPython", ModuleType("IPython"))
    notebook = ModuleType("IPython.display")
    notebook.display = display  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "IPython.display", notebook)
    exec(RUN, {})
    assert capfd.readouterr() == ("", "")
    run, sweep = (it.texts[-1] for it in shown)
    assert run.startswith("run: 100 %")
    assert sweep.startswith("sweep: 100 %")
    assert sweep.endswith("left")


@pytest.mark.skipif(os.name == "nt", reason="terminals of Windows cannot be looked at")
def test_a_terminal_shows_run_in_run_and_sweep_with_the_time_left() -> None:
    import pty
    import termios

    ours, theirs = pty.openpty()
    termios.tcsetwinsize(theirs, (24, 80))
    with subprocess.Popen([sys.executable, "-c", RUN], stderr=theirs) as process:
        os.close(theirs)
        shown = b""
        while True:
            try:
                read = os.read(ours, 4096)
            except OSError:  # Linux says so when the other end is closed.
                break
            if not read:
                break
            shown += read
    os.close(ours)
    assert process.returncode == 0
    lines = [line.strip() for line in shown.decode().replace("\r", "\n").splitlines()]
    phases = [line.partition(":")[0] for line in lines if line]
    assert list(dict.fromkeys(phases)) == ["run", "run-in", "sweep"]
    # The run begins the bar anew, and every bar ends full.
    last = {line.partition(":")[0]: line for line in lines if line}
    assert "100 %" in last["run"]
    assert "100 %" in last["sweep"]
    assert last["run"].endswith("00:00 left")
