"""Contact laws on arrays."""

import numpy as np
import pytest

import chaindrive as cd


@pytest.fixture
def steel():
    return cd.law("power", stiffness=6e11, exponent=1.5, restitution=0.8, onset_floor=1e-3)


def test_force_is_the_printed_formula(steel):
    """F = K δⁿ (1 + ¾ (1 − e²) δ̇ / δ̇₀)."""
    depth, rate, onset = 2e-5, 0.3, 0.6
    expected = 6e11 * depth**1.5 * (1.0 + 0.75 * (1.0 - 0.8**2) * rate / onset)
    assert steel.force(depth, rate, onset) == pytest.approx(expected, rel=1e-14)
    slope = 6e11 * depth**1.5 * 0.75 * (1.0 - 0.8**2) / onset
    assert steel.damping(depth, rate, onset) == pytest.approx(slope, rel=1e-14)


def test_arguments_broadcast(steel):
    depth = np.linspace(-1e-5, 1e-5, 7)[:, None]
    rate = np.array([-0.1, 0.0, 0.1])
    force = steel.force(depth, rate, 0.2)
    assert force.shape == (7, 3)
    assert (force[:4] == 0.0).all()
    assert (np.diff(force[4:], axis=1) > 0.0).all()
    assert steel.force(1e-5).shape == ()
    assert steel.force([]).shape == (0,)
    assert steel.force(np.asfortranarray(np.ones((2, 3)))).shape == (2, 3)
    with pytest.raises(ValueError, match="broadcast"):
        steel.force(np.zeros(3), np.zeros(2))


@pytest.mark.parametrize(
    "law",
    [
        cd.law("power", stiffness=1e8, exponent=1.0),
        cd.law("power", stiffness=6e11, exponent=1.5),
        cd.law("johnson", length_scale=4 * 5e-5, modulus_length=113.7e9 * 4.5e-3),
    ],
    ids=lambda law: law.parameters["elastic"]["kind"],
)
def test_stiffness_and_energy_belong_to_the_force(law):
    depth = np.linspace(1e-6, 1e-5, 2001)
    force = law.force(depth)
    middle = 0.5 * (depth[1:] + depth[:-1])
    np.testing.assert_allclose(np.diff(force) / np.diff(depth), law.stiffness(middle), rtol=1e-4)
    np.testing.assert_allclose(
        np.diff(law.energy(depth)) / np.diff(depth), law.force(middle), rtol=1e-4
    )


def test_dissipations_have_short_forms():
    power = {"stiffness": 1e8, "exponent": 1.0}
    short = cd.law("power", **power, restitution=0.9)
    long = cd.law("power", **power, dissipation={"kind": "lankarani_nikravesh", "restitution": 0.9})
    assert short.parameters == long.parameters
    assert cd.law("power", **power, damping=10.0).damping(1e-3) == 10.0
    none = cd.law("power", **power, dissipation="none")
    assert none.parameters == cd.law("power", **power).parameters


def test_the_law_of_a_body():
    law = cd.scenes.marine_engine().law("crank")
    assert law.parameters["elastic"] == {"kind": "power", "stiffness": 6e11, "exponent": 1.5}
    with pytest.raises(KeyError, match="nobody"):
        cd.scenes.marine_engine().law("nobody")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("power",), "stiffness"),
        (("rubber",), "rubber"),
    ],
)
def test_what_is_missing_or_unknown(arguments, message):
    with pytest.raises(cd.ParameterError, match=message):
        cd.law(*arguments)


def test_parameters_out_of_range():
    with pytest.raises(cd.ParameterError) as caught:
        cd.law("power", stiffness=1e8, exponent=1.5, restitution=1.4)
    assert caught.value.path == "restitution"
    assert str(caught.value).startswith("restitution = 1.4, must be")
    with pytest.raises(cd.ParameterError, match="hardness"):
        cd.law("power", stiffness=1e8, exponent=1.5, hardness=3.0)
    with pytest.raises(cd.ParameterError):
        cd.law("power", stiffness=np.inf, exponent=1.5)
    with pytest.raises(cd.ParameterError, match="one of them"):
        cd.law("power", stiffness=1e8, exponent=1.5, restitution=0.5, damping=3.0)
