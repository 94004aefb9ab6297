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


# Sends Ctrl-C at the n-th import after the first line of the command.
INTERRUPTED_AT = """
import signal, sys
left = int(sys.argv.pop(1))
sys.argv[0] = "bin/chaindrive"
def count(event, arguments):
    global left
    if event == "import" and "chaindrive.__main__" in sys.modules:
        left -= 1
        if left == 0:
            signal.raise_signal(signal.SIGINT)
sys.addaudithook(count)
from chaindrive.__main__ import main
sys.exit(main())
"""


# The first two are the imports above which the command begins to hear.
@pytest.mark.parametrize("number", range(3, 9))
def test_interrupted_while_it_is_imported_the_command_says_so(number: int) -> None:
    command = [sys.executable, "-c", INTERRUPTED_AT, str(number), "run", "marine_engine", "-q"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (130, "interrupted\n")


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
