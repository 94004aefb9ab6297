"""Messages: one tree of exceptions, each with the place and a hint where they are known."""

import pickle
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest

import chaindrive as cd


def test_one_tree():
    for name in cd.errors.__all__:
        kind = getattr(cd.errors, name)
        if issubclass(kind, Warning):
            assert issubclass(kind, UserWarning)
        elif name != "Problem":
            assert issubclass(kind, cd.ChaindriveError)
    assert issubclass(cd.SceneError, ValueError)
    assert issubclass(cd.ParameterError, ValueError)
    assert issubclass(cd.AssemblyError, cd.SimulationError)
    assert issubclass(cd.IntegrationError, cd.SimulationError)
    assert issubclass(cd.WriteError, OSError)


def test_a_scene_reports_everything_with_its_line():
    with pytest.raises(cd.SceneError) as caught:
        cd.Drive.from_toml("[chain]\npitch = '12 rpm'\nlinkz = 3\n", name="bad.toml")
    error = caught.value
    assert error.source == "bad.toml"
    assert len(error.problems) >= 2
    paths = {problem.path: problem for problem in error.problems}
    assert paths["chain.pitch"].line == 2
    assert "links" in paths["chain.linkz"].hint
    assert str(error).startswith("bad.toml:")
    assert error.path == error.problems[0].path


def test_errors_travel():
    with pytest.raises(cd.SceneError) as caught:
        cd.Drive.from_dict({})
    copy = pickle.loads(pickle.dumps(caught.value))
    assert copy.problems == caught.value.problems
    assert str(copy) == str(caught.value)


@pytest.mark.parametrize("elsewhere", [False, True])
def test_a_panic_is_an_error_that_says_what_to_report(elsewhere: bool, capfd, monkeypatch) -> None:
    monkeypatch.delenv("RUST_BACKTRACE", raising=False)
    with pytest.raises(cd.ProgramError, match="please report this") as caught:
        cd._core._panic(elsewhere)
    told = str(caught.value)
    assert "crates/python/src/lib.rs:" in told
    assert cd.__build__ in told
    assert told.endswith("as asked for")
    assert issubclass(cd.ProgramError, cd.ChaindriveError)
    # It can be caught again while another one is told of.
    try:
        raise KeyError
    except KeyError:
        with pytest.raises(cd.ProgramError) as again:
            cd._core._panic(elsewhere)
    assert isinstance(again.value.__context__, KeyError)
    assert capfd.readouterr() == ("", "")


def test_a_panic_of_the_command_has_an_exit_code_of_its_own(monkeypatch) -> None:
    monkeypatch.delenv("RUST_BACKTRACE", raising=False)
    program = """
from chaindrive import __main__, _core
_core._drawn = lambda arguments: _core._panic(False)
raise SystemExit(__main__.main())
"""
    command = [sys.executable, "-c", program]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 70
    assert "please report this" in done.stderr
    assert done.stderr.count("\n") == 1


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(cd.SceneError, match="no such file"):
        cd.load(tmp_path / "nothing.toml")


def test_a_path_that_leads_nowhere():
    with pytest.raises(cd.SceneError) as caught:
        cd.scenes.marine_engine().replace({"sprockets.crnk.teeth": 23})
    assert "crank" in caught.value.hint


def test_a_preset_that_is_not_there():
    with pytest.raises(AttributeError, match="marine_engine"):
        _ = cd.scenes.submarine


@pytest.mark.parametrize("value", [np.nan, [1.0, np.inf], object(), {1, 2}])
def test_a_value_that_has_no_place_in_a_scene(value):
    with pytest.raises(cd.SceneError) as caught:
        cd.scenes.marine_engine().replace({"chain.mass": value})
    assert caught.value.path.startswith("chain.mass")


@pytest.mark.parametrize(
    ("settings", "path"),
    [
        ({"until": -1.0}, "until"),
        ({"every": 0.0}, "every"),
        ({"every": np.nan}, "every"),
        ({"step": -1e-6}, "step"),
        ({"tolerance": 0.0}, "tolerance"),
        ({"onset_depth": 0.0}, "onset_depth"),
        ({"method": "euler"}, "method"),
        ({"record": ["span_tensions"]}, "record"),
    ],
)
def test_settings_out_of_range(settings, path):
    with pytest.raises(cd.ParameterError) as caught:
        cd.simulate(cd.scenes.spinning_ring(), **settings)
    assert caught.value.path == path
    assert caught.value.hint


def test_an_unknown_channel_suggests_one():
    with pytest.raises(cd.ParameterError) as caught:
        cd.simulate(cd.scenes.spinning_ring(), record="link_tensio")
    assert "link_tension" in caught.value.hint


def test_an_unstable_step_names_the_limit():
    with pytest.raises(cd.IntegrationError) as caught:
        cd.simulate(cd.scenes.spinning_ring(), method="verlet", step=1e-2)
    assert caught.value.path == "step"
    assert "at most" in caught.value.hint


def test_a_chain_that_does_not_close():
    with pytest.raises(cd.ChaindriveError, match="links"):
        cd.simulate(cd.scenes.industrial_16b().replace({"chain.links": 60}), until=1e-3)


@pytest.mark.parametrize("method", ["implicit-damping", "generalized-alpha"])
def test_an_implicit_method_for_the_particle_chain(method):
    with pytest.raises(cd.ParameterError, match="verlet, rk4, dormand-prince"):
        cd.simulate(cd.scenes.spinning_ring(), until=1e-3, every=1e-3, method=method)


@pytest.mark.parametrize("until", ["1", "1e-3", " 0.5 "])
def test_a_text_without_a_unit_is_no_time(until):
    with pytest.raises(cd.SceneError, match="has no unit") as caught:
        cd.simulate(cd.scenes.spinning_ring(), until=until)
    assert caught.value.path == "run.until"
    assert "the bare number" in caught.value.hint


def test_what_was_replaced_stands_in_no_line():
    drive = cd.scenes.industrial_16b()
    with pytest.raises(cd.SceneError) as caught:
        drive.replace({"sprockets.driver.tooth": 5})
    (problem,) = caught.value.problems
    assert problem.line is None
    assert "`teeth`" in problem.hint
    with pytest.raises(cd.SceneError) as caught:
        cd.simulate(drive, until="1 x")
    assert caught.value.problems[0].line is None


def test_a_warning_points_at_the_line_that_called_us() -> None:
    face = {"kind": "bar", "start": [0.2, 0.86], "end": [-0.2, 0.86], "end_radius": 0.02}
    rail = {"name": "rail", "touches": "plates", "face": face}
    drive = cd.scenes.marine_two_sprockets().replace({"guides": [rail], "run.run_in": 0})
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always", cd.ClashWarning)
        cd.simulate(drive, until=1e-3, error=False)
        cd.analysis.run_up(drive, 8.0, 9.0, until=1e-3, error=False)
    lines = Path(__file__).read_text(encoding="utf-8").splitlines()
    pointed = [(it.filename, lines[it.lineno - 1].strip().partition("(")[0]) for it in told]
    assert pointed == [(__file__, "cd.simulate"), (__file__, "cd.analysis.run_up")]
    with warnings.catch_warnings():
        warnings.filterwarnings("error", category=cd.ClashWarning)
        with pytest.raises(cd.ClashWarning):
            cd.simulate(drive, until=1e-3, error=False)


def test_nothing_is_printed_or_logged() -> None:
    code = (
        "import logging, chaindrive as cd\n"
        # Short: of what takes above a second the log is told.
        "cd.simulate(cd.scenes.spinning_ring(), until=1e-3, run_in=0, error=False)\n"
        "assert not logging.root.handlers\n"
        "assert 'chaindrive' not in logging.root.manager.loggerDict"
    )
    command = [sys.executable, "-W", "error", "-c", code]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_what_no_scene_holds_is_named_by_its_path() -> None:
    scene = cd.scenes.industrial_16b().to_dict()
    scene["chain"]["pitch"] = float("nan")
    scene["sprockets"][1]["inertia"] = np.float64("inf")
    scene["title"] = b"bytes"
    with pytest.raises(cd.SceneError) as caught:
        cd.Drive.from_dict(scene, name="mine")
    found = {problem.path: problem.message for problem in caught.value.problems}
    assert found == {
        "chain.pitch": "nan, must be finite",
        "sprockets[1].inertia": "inf, must be finite",
        "title": "bytes has no place in a scene",
    }
    assert str(caught.value).count("mine: ") == 3
    with pytest.raises(cd.SceneError, match=r"chain\.pitch: -inf, must be finite"):
        cd.scenes.industrial_16b().replace({"chain.pitch": -np.inf})
    endless: dict[str, object] = {}
    endless["chain"] = endless
    with pytest.raises(cd.SceneError, match="nested deeper"):
        cd.Drive.from_dict(endless)
