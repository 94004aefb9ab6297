"""Which measurement would settle most, held against what the uncertainty of a gain leaves."""

import numpy as np
import pytest
import xarray as xr

import chaindrive as cd

LOAD = "sprockets.driven.load[0].torque"
MU = "contact.joints.friction.coefficient"
PRETENSION = "route.pretension"
FREE = {LOAD: (-1600.0, -1300.0), PRETENSION: (1000.0, 2000.0), MU: (0.05, 0.15)}
CANDIDATES = {
    "flange": {"quantity": "sprocket_torque[driver]", "gain_uncertainty": 0.03},
    "slack": "span_tension[driver-driven]",
    "losses": "losses",
}


def drive() -> cd.Drive:
    """At twice its speed a record of four pitches takes half the time."""
    return cd.scenes.industrial_16b().replace(
        {"run.run_in": "10 ms", "sprockets.driver.motion.speed": "600 rpm"}
    )


@pytest.fixture(scope="module")
def proposed() -> xr.Dataset:
    points = {"as it is": {}, "slow": {"sprockets.driver.motion.speed": "300 rpm"}}
    return cd.next_measurement(drive(), FREE, CANDIDATES, excitations=points, until=0.025)


@pytest.mark.costs("sensitivities at two operating points")
def test_a_flange_leaves_the_error_of_its_gain(proposed: xr.Dataset) -> None:
    """3 % of 1433 N m, beside ± 150 N m between which all is alike: σ = 150/√3."""
    before = proposed["before"].to_numpy()
    np.testing.assert_allclose(before, [150.0 / 3**0.5, 500.0 / 3**0.5, 0.05 / 3**0.5])
    gain = 0.03 * 1433.0
    wanted = (gain**-2 + before[0] ** -2) ** -0.5
    after = proposed["after"].sel(excitation="as it is")
    assert float(after.sel(candidate="flange", target=LOAD)) == pytest.approx(wanted, rel=0.1)
    assert (proposed["after"] <= proposed["before"] * (1.0 + 1e-9)).all()


@pytest.mark.costs("sensitivities at two operating points")
def test_every_channel_settles_what_it_sees(proposed: xr.Dataset) -> None:
    """The slack span its pretension, the losses the friction of the pins."""
    share = (proposed["after"] / proposed["before"]).sel(excitation="as it is")
    assert share.sel(target=PRETENSION).idxmin("candidate").item() == "slack"
    assert share.sel(target=MU).idxmin("candidate").item() == "losses"
    best = proposed.sel(
        excitation=proposed.attrs["best_excitation"], candidate=proposed.attrs["best_candidate"]
    )
    assert float(best["shrinking"]) == float(proposed["shrinking"].min())
    assert proposed.attrs["best_candidate"] in proposed.attrs["summary"]


def test_a_longer_record_leaves_less() -> None:
    free = {LOAD: FREE[LOAD]}
    precise = {"strand": {"quantity": "span_tension[driven-driver]", "gain_uncertainty": 1e-5}}
    # Unit, scale and sign of a file change nothing, nor does a name with a slash.
    precise["N/S"] = precise["strand"] | {"unit": "kN", "scale": 50.0, "sign": -1}
    short, long = (
        cd.next_measurement(drive(), free, precise, until=0.05, record=it) for it in (0.05, "5 s")
    )
    np.testing.assert_array_equal(*short["after"].squeeze())
    assert (long["after"] < short["after"]).all()
    assert (long["length"] > 0.0).all()


def test_a_prediction_is_settled_from_where_a_fit_left_it() -> None:
    """Of one parameter the error of an output shrinks as that of the parameter does."""
    free = {LOAD: FREE[LOAD]}
    parameters = {"parameter": [LOAD], "parameter_2": [LOAD]}
    known = xr.Dataset({"covariance": (tuple(parameters), [[900.0]])}, coords=parameters)
    foretold = xr.Dataset(
        {
            "sensitivity": (("output", "parameter"), [[60.0]]),
            "standard_error": ("parameter", [30.0]),
        },
        coords={"output": ["mean"], "parameter": [LOAD]},
    )
    given = {"candidates": ["sprocket_torque[driver]"], "known": known, "until": 0.025}
    one = cd.next_measurement(drive(), free, settle=foretold, **given)
    other = cd.next_measurement(drive(), free, settle=LOAD, **given)
    assert float(other["before"].squeeze()) == pytest.approx(30.0)
    assert float(one["before"].squeeze()) == pytest.approx(60.0)
    assert float(one["after"].squeeze()) == pytest.approx(2.0 * float(other["after"].squeeze()))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"candidates": []}, "no candidate"),
        ({"candidates": ["tension"]}, "no quantity of a drive"),
        ({"candidates": ["vibration"]}, "no quantity with an amplitude"),
        ({"candidates": "losses", "rate": 0}, "rate = 0.0, must be positive"),
        ({"until": "-1 s"}, "until = -1.0, must be positive"),
        ({"record": np.inf}, "record = inf, must be positive"),
        ({"settle": "chain.mass"}, "is not free"),
        ({"settle": xr.Dataset()}, "no prediction"),
        ({"known": xr.Dataset(coords={"parameter": []})}, "known has no"),
        ({"free": {"sensors.flange.gain": (0.9, 1.1)}}, "the sensors of a record"),
    ],
)
def test_what_cannot_be_chosen_from_is_told(change: dict[str, object], words: str) -> None:
    given = {"free": FREE, "candidates": CANDIDATES} | change
    with pytest.raises(cd.MeasurementError, match=words):
        cd.next_measurement(drive(), **given)
