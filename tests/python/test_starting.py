"""What a program imports before it has asked for anything, and which names it finds."""

import importlib
import json
import pkgutil
import subprocess
import sys
from types import ModuleType

import pytest

import chaindrive as cd

SLOW = {"xarray", "matplotlib", "pandas", "scipy", "dask", "zarr", "tqdm", "ezdxf"}
MODULES = [name for name in cd.__all__ if isinstance(getattr(cd, name), ModuleType)]


def imported(code: str) -> set[str]:
    """Return the packages and modules of chaindrive that a fresh process imports for some code."""
    tell = "import sys, json; print(json.dumps(list(sys.modules)))"
    command = [sys.executable, "-c", f"{code}\n{tell}"]
    done = subprocess.run(command, capture_output=True, check=True, text=True)
    found = json.loads(done.stdout.splitlines()[-1])
    return {name for name in found if "." not in name or name.startswith("chaindrive.")}


def test_the_package_imports_nothing() -> None:
    found = imported("import chaindrive")
    assert {name for name in found if name.startswith("chaindrive")} == {"chaindrive"}
    assert not found & (SLOW | {"numpy", "typing"})


def test_drives_are_made_and_read_without_xarray() -> None:
    code = "import chaindrive as cd; cd.scenes.spinning_ring().replace({'chain.links': 24})"
    assert not imported(code) & SLOW


def test_a_run_imports_no_plots() -> None:
    code = "import chaindrive as cd; cd.simulate(cd.scenes.spinning_ring(), until=1e-3)"
    found = imported(code)
    assert "xarray" in found
    assert "matplotlib" not in found


def test_a_run_does_not_wait_for_dask() -> None:
    pytest.importorskip("dask")
    code = (
        "import chaindrive as cd\n"
        "cd.simulate(cd.scenes.industrial_16b(), until=1e-3, record='all', events=['teeth'])"
    )
    assert not imported(code) & {"dask", "scipy"}


@pytest.mark.parametrize("argument", ["-V", "--help"])
def test_the_command_imports_the_core_only(argument: str) -> None:
    code = (
        "import sys; from chaindrive.__main__ import main\n"
        f"sys.argv[1:] = [{argument!r}]\nassert main() == 0"
    )
    ours = {name for name in imported(code) if name.startswith("chaindrive")}
    assert ours == {"chaindrive", "chaindrive.__main__", "chaindrive._core", "chaindrive.signals"}
    assert not imported(code) & (SLOW | {"numpy"})


# Sends Ctrl-C before the n-th line that Python runs after the command has begun to hear it, and
# tells how many lines there were.
INTERRUPTED_AT = """
import signal, sys
number = int(sys.argv.pop(1))
sys.argv[0] = "bin/chaindrive"
count = 0
def line(frame, event, _):
    global count
    if count or signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        count += event == "line"
        if event == "line" and count == number:
            signal.raise_signal(signal.SIGINT)
    return line
sys.settrace(line)
from chaindrive.__main__ import main
code = main()
print("lines:", count)
sys.exit(code)
"""


def interrupted_at(number: int) -> tuple[int, str, str]:
    command = [sys.executable, "-c", INTERRUPTED_AT, str(number), "-V"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return done.returncode, done.stderr, done.stdout


@pytest.fixture(scope="module")
def lines() -> int:
    return int(interrupted_at(0)[2].rpartition(" ")[2])


def ends_without_a_traceback(number: int) -> int:
    """Return the exit code."""
    code, errors, _ = interrupted_at(number)
    assert (code, errors) in {(130, "interrupted\n"), (0, "")}, number
    return code


# The last lines are those with which Python ends, when the version is printed.
def test_whenever_it_is_interrupted_the_command_says_so(lines: int) -> None:
    moments = [1, 10, lines // 2]
    assert [ends_without_a_traceback(number) for number in moments] == [130] * len(moments)
    assert ends_without_a_traceback(lines) == 0
    assert ends_without_a_traceback(lines + 20) == 0


@pytest.mark.slow
def test_interrupted_at_any_of_a_thousand_lines_the_command_says_so(lines: int) -> None:
    for number in range(1, lines + 100, max(lines // 1000, 1)):
        ends_without_a_traceback(number)


def test_every_name_is_defined_where_the_stub_says() -> None:
    for name, module in cd._HOME.items():
        where = importlib.import_module(f"{module}.{name}" if name in MODULES else module)
        assert getattr(cd, name) is (where if name in MODULES else getattr(where, name))


def test_no_name_hides_a_module() -> None:
    modules = {module.name for module in pkgutil.iter_modules(cd.__path__)}
    assert modules & set(cd.__all__) == set(MODULES)


def test_names_stay_what_they_are_whatever_is_imported() -> None:
    code = (
        "import chaindrive, importlib, pkgutil\n"
        "for module in pkgutil.iter_modules(chaindrive.__path__):\n"
        "    importlib.import_module('chaindrive.' + module.name)\n"
        "assert callable(chaindrive.law) and callable(chaindrive.friction)\n"
        "assert callable(chaindrive.catalogue) and callable(chaindrive.channels)"
    )
    imported(code)


def test_completion_shows_what_there_is() -> None:
    assert dir(cd) == sorted(cd.__all__)
    for name in MODULES:
        module = importlib.import_module(f"chaindrive.{name}")
        assert dir(module) == sorted(module.__all__), name


def test_a_name_that_is_not_there_is_refused() -> None:
    with pytest.raises(AttributeError, match="'chaindrive' has no attribute 'simulat'") as refusal:
        _ = cd.simulat
    assert (refusal.value.name, refusal.value.obj) == ("simulat", cd)
