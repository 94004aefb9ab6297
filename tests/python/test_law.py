"""Contact laws on arrays."""

import numpy as np
import pytest

import chaindrive as cd
from chaindrive import contact_law


@pytest.fixture
def steel():
    power = {"stiffness": 6e11, "exponent": 1.5}
    dissipation = {"kind": "lankarani-nikravesh", "restitution": 0.8}
    return cd.law("power", **power, dissipation=dissipation, onset_floor=1e-3)


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


PIN = {"hole": 1.85e-3, "pin": 1.8e-3, "length": 4.5e-3, "modulus": 113.736263736e9}
FLANK = {"radius": 3.875e-3, "other": 18.6e-3, "length": 2.2e-3, "modulus": 113.736263736e9}
CYLINDERS = [
    "johnson",
    "conformal",
    "radzimovsky",
    "esdu-78035",
    "dubowsky-freudenstein",
    "cylindrical",
    "hertz",
]


@pytest.mark.parametrize(
    ("kind", "inside", "outside"),
    [
        ("johnson", 263.3, 60.61),
        ("conformal", 262.8, 60.61),
        ("radzimovsky", 249.6, 59.23),
        ("esdu-78035", 190.7, None),
        ("dubowsky-freudenstein", 180.6, None),
        ("cylindrical", 268.1, 55.92),
        ("hertz", 39.14, 8.588),
    ],
)
def test_two_cylinders(kind, inside, outside):
    """Forces at 1 µm, pin in bushing and roller on flank, from an independent program."""
    assert cd.law(kind, **PIN).force(1e-6) == pytest.approx(inside, rel=3e-4)
    if outside is not None:
        assert cd.law(kind, **FLANK).force(1e-6) == pytest.approx(outside, rel=3e-4)


def test_cylinders_on_a_curve():
    curve = {"radius": 4e-3, "length": 2e-3, "modulus": 1e11, "depth_cap": 6e-3}
    flat = cd.law("cylindrical", curvature=0.0, **curve)
    assert flat.parameters["elastic"] == {
        "kind": "johnson",
        "length_scale": 4 * 6e-3,
        "modulus_length": 2e8,
    }
    seat = cd.law("johnson", curvature=-1 / 4.04e-3, **curve)
    pin = cd.law("johnson", hole=4.04e-3, pin=4e-3, length=2e-3, modulus=1e11)
    assert seat.force(1e-6) == pytest.approx(pin.force(1e-6), rel=1e-12)


@pytest.mark.parametrize("kind", CYLINDERS)
@pytest.mark.parametrize("pair", [PIN, FLANK], ids=["inside", "outside"])
def test_response_is_consistent(kind, pair):
    law = cd.law(kind, **pair, dissipation="exact", restitution=0.6)
    depth = np.linspace(1e-6, 1e-5, 2001)
    middle = 0.5 * (depth[1:] + depth[:-1])
    here = law.respond(middle, 0.2, 0.5)
    assert (here.force > here.elastic).all()
    slope = np.diff(law.force(depth, 0.2, 0.5)) / np.diff(depth)
    np.testing.assert_allclose(slope, here.stiffness, rtol=1e-4)
    np.testing.assert_allclose(here.damping, here.elastic * law.factor / 0.5, rtol=1e-12)
    np.testing.assert_allclose(here.stiffness, law.stiffness(middle, 0.2, 0.5))
    work = np.diff(law.energy(depth)) / np.diff(depth)
    np.testing.assert_allclose(work, here.elastic, rtol=1e-4)


@pytest.mark.parametrize(
    ("dissipation", "delivered"),
    [
        ("exact", 0.5),
        ("hunt-crossley", 0.6630),
        ("lankarani-nikravesh", 0.7252),
        ("lee-wang", 0.7992),
        ("herbert-mcwhannell", 0.5936),
        ("gonthier", 0.4877),
        ("zhiying-qishao", 0.4826),
        ("flores", 0.4704),
        ("hu-guo", 0.4877),
    ],
)
def test_restitution_delivered(dissipation, delivered):
    law = cd.law("johnson", **PIN, dissipation=dissipation, restitution=0.5)
    assert law.restitution == pytest.approx(delivered, abs=5e-5)


def test_restitution_without_hysteresis():
    assert cd.law("johnson", **PIN).restitution == 1.0
    viscous = cd.law("johnson", **PIN, damping=3.0)
    assert viscous.restitution is None
    assert viscous.factor is None


def test_numbers_give_numbers(steel):
    for value in (*steel.respond(1e-5, 0.1, 0.2), steel.energy(1e-5)):
        assert isinstance(value, float)
    assert steel.respond([1e-5, 2e-5], [[0.1], [0.2]]).stiffness.shape == (2, 2)


def test_friction():
    """Values of the printed formulas, see crates/contact/tests/friction.rs."""
    dry = cd.friction("brown-mcphee", static_coefficient=0.15, coefficient=0.1, slip_speed=1e-3)
    force = dry.force(2.0, [-1e-3, 0.0, 2e-3, 0.1])
    np.testing.assert_allclose(force, [0.2998658599, 0.0, -0.2653060774, -0.2000015990], atol=1e-9)
    assert isinstance(dry.force(1.0, 1e-3), float)
    assert dry.damping(1.0, 0.0) == pytest.approx((4 * 0.1 + 16 / 9 * 0.05) / 1e-3)
    assert dry.damping(np.ones((3, 1)), np.ones(2)).shape == (3, 2)
    assert dry.parameters["kind"] == "brown-mcphee"
    assert cd.friction("none").force(1.0, 1.0) == 0.0
    bristles = cd.friction(
        "lugre",
        static_coefficient=0.15,
        coefficient=0.1,
        slip_speed=1e-3,
        stiffness=1e5,
        damping=30.0,
        viscosity=0.4,
    )
    held = bristles.rub(1000.0, 0.0, state=5e-7, dt=1.0)
    assert held.force == pytest.approx(-50.0)
    assert held.state == 5e-7
    slid = bristles.rub(1000.0, [-1.0, 1.0], dt=10.0)
    np.testing.assert_allclose(slid.force, bristles.force(1000.0, [-1.0, 1.0]), rtol=1e-12)
    with pytest.raises(cd.ParameterError, match="upper_speed"):
        cd.friction("ambrosio", coefficient=0.1, lower_speed=2.0, upper_speed=1.0)
    with pytest.raises(cd.ParameterError, match="stiction"):
        cd.friction("stiction", coefficient=0.1)


def test_dissipations_have_short_forms():
    power = {"stiffness": 1e8, "exponent": 1.0}
    short = cd.law("power", **power, restitution=0.9)
    long = cd.law("power", **power, dissipation={"kind": "exact", "restitution": 0.9})
    assert short.parameters == long.parameters
    assert cd.law("power", **power, damping=10.0).damping(1e-3) == 10.0
    named = cd.law("power", **power, dissipation="flores", restitution=0.9)
    assert named.parameters["dissipation"] == {"kind": "flores", "restitution": 0.9}
    none = cd.law("power", **power, dissipation="none")
    assert none.parameters == cd.law("power", **power).parameters


def test_the_law_of_a_body():
    law = cd.scenes.marine_engine().law("crank")
    assert law.parameters["elastic"] == {"kind": "power", "stiffness": 6e11, "exponent": 1.5}
    with pytest.raises(KeyError, match="nobody"):
        cd.scenes.marine_engine().law("nobody")


@pytest.mark.parametrize(
    ("kind", "parameters", "path", "message"),
    [
        ("power", {}, "stiffness", r"lacks 'stiffness'; give stiffness and exponent$"),
        ("linaer", {"stiffness": 1e8}, "kind", "no law is called 'linaer'; did you mean 'linear'"),
        ("rubber", {}, "kind", "there are linear, power, hertz"),
        ("linear", {"stiffness": 1e8, "hardness": 1.0}, "hardness", "give stiffness$"),
        ("hertz", {"stiffness": 1e9}, "stiffness", "length, modulus and one of: hole and pin"),
        ("hertz", {}, "cylinders", "length, modulus and one of: hole and pin"),
        ("power", PIN, "hole", "no parameter 'hole'; give stiffness and exponent$"),
        ("linear", {"stiffness": 1e8, "dissipation": "floris"}, "dissipation", "mean 'flores'"),
        ("linear", {"stiffness": 1e8, "dissipation": "flores"}, "restitution", "lacks"),
    ],
)
def test_what_is_missing_or_unknown(kind, parameters, path, message):
    with pytest.raises(cd.ParameterError, match=message) as caught:
        cd.law(kind, **parameters)
    assert caught.value.path == path
    assert "variant" not in str(caught.value)


@pytest.mark.parametrize("kind", sorted(contact_law._LAWS))
def test_names_of_parameters_are_those_of_the_core(kind):
    parameters = {"exponent": 1.2}
    names = contact_law._LAWS[kind]
    given = {name: parameters.get(name, 1e-3) for name in names} or PIN
    assert cd.law(kind, **given).force(1e-6) > 0.0


def test_a_linear_law_is_a_power_of_one():
    linear = cd.law("linear", stiffness=1e8, restitution=0.8)
    assert (
        linear.parameters == cd.law("power", stiffness=1e8, exponent=1, restitution=0.8).parameters
    )


def test_frictions_are_those_of_scenes():
    """With their defaults, units and messages."""
    short = cd.friction("coulomb", coefficient=0.1)
    assert short.parameters == cd.friction("coulomb", coefficient=0.1, slip_speed=0.05).parameters
    assert (
        short.parameters == cd.friction("coulomb", coefficient=0.1, slip_speed="5 cm/s").parameters
    )
    drive = cd.scenes.marine_engine().replace({"contact.teeth.friction": {"coefficient": 0.1}})
    resolved = drive.resolved().to_dict()
    assert resolved["contact"]["teeth"]["friction"]["slip_speed"] == 0.05
    assert cd.friction("spring-slider", coefficient=0.1, stiffness="50 MN/m").force(1.0, 1.0) < 0.0
    for kind, parameters, path, message in [
        ("coulom", {"coefficient": 0.1}, "kind", "did you mean `coulomb`"),
        ("coulomb", {}, "coefficient", "missing; give coefficient of friction|missing; give the"),
        ("coulomb", {"coeficient": 0.1}, "coeficient", "did you mean `coefficient`"),
        ("coulomb", {"coefficient": -0.1}, "coefficient", "-0.1"),
        ("spring-slider", {"coefficient": 0.1}, "stiffness", "give it, such as"),
    ]:
        with pytest.raises(cd.ParameterError, match=message) as caught:
            cd.friction(kind, **parameters)
        assert caught.value.path == path


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
    with pytest.raises(cd.ParameterError, match="one of them"):
        cd.law("johnson", **PIN, dissipation={"kind": "flores"}, restitution=0.5)
    with pytest.raises(cd.ParameterError, match=r"take 0\.02"):
        cd.law("johnson", **PIN, dissipation="exact", restitution=0.0)
    with pytest.raises(cd.ParameterError, match=r"clearance = .*5e-6"):
        cd.law("cylindrical", hole=1.804e-3, pin=1.8e-3, length=1e-3, modulus=1e11)
    with pytest.raises(cd.ParameterError, match="above"):
        cd.law("johnson", **PIN | {"pin": 2e-3})
    with pytest.raises(cd.ParameterError, match="do not describe two cylinders"):
        cd.law("johnson", hole=2e-3, radius=1e-3, length=1e-3, modulus=1e11)
    with pytest.raises(cd.ParameterError, match="do not describe two cylinders"):
        cd.law("johnson", hole=2e-3, pin=1e-3, length=1e-3)
    with pytest.raises(cd.ParameterError, match="power"):
        cd.law("power", **PIN)
