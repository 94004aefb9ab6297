"""Messages: one tree of exceptions, each with the place and a hint where they are known."""

import pickle

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
    with pytest.raises(cd.ParameterError) as caught:
        cd.scenes.marine_engine().replace({"chain.mass": value})
    assert caught.value.path == "chain.mass"


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
