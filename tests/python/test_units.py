"""Units of results as pint and UDUNITS read them, and quantities of pint as arguments."""

import functools
import re
import warnings

import pytest
import xarray as xr

import chaindrive as cd

pint = pytest.importorskip("pint")
UREG = pint.UnitRegistry()
# Rigid links with clearance, an arm beside a slider, several chains, oil films.
PRESETS = [
    "bicycle_derailleur",
    "industrial_16b",
    "marine_engine_oil",
    "timing_drive",
    "two_stage_timing",
]


def told(made: xr.Dataset | xr.DataArray) -> set[str]:
    """Return the units among the attributes of arrays."""
    arrays = made.variables.values() if isinstance(made, xr.Dataset) else [made]
    return {it.attrs["units"] for it in arrays if "units" in it.attrs}


def read(units: set[str]) -> None:
    """Read units by both libraries, which must agree on what they are in SI units."""
    cf_units = pytest.importorskip("cf_units")
    assert units
    for unit in units:
        by_pint = UREG.Quantity(1.0, UREG.parse_units(unit))
        by_cf = cf_units.Unit(unit)
        base = f"{by_pint.to_base_units().units:~C}".replace("**", "^") or "1"
        assert by_cf.convert(1.0, base) == pytest.approx(by_pint.to_base_units().m), unit


@functools.cache
def run_of(name: str, until: float = 2e-3) -> xr.Dataset:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        drive = getattr(cd.scenes, name)()
        events = ["teeth", "guides"]
        return cd.simulate(
            drive, until=until, run_in=0, every=1e-4, record="all", events=events, error=False
        )


def test_units_of_all_channels_are_units() -> None:
    read({unit for channel in cd.channels().values() for unit in channel.unit.split(" or ")})


@pytest.mark.parametrize("preset", PRESETS)
def test_units_of_a_run_and_its_page_are_units(preset: str) -> None:
    run = run_of(preset)
    for name, values in run.data_vars.items():
        if "units" not in values.attrs and values.dtype.kind == "f":
            read(set(values.attrs["entry_units"].split(", ")))
            assert name in {"tensioner_position", "tensioner_force"}
    read(told(run))
    columns = [name for section in run.drive.summary().sections for name in section["columns"]]
    # The page is for people, and has degrees as scenes do: `deg`, which UDUNITS does not know.
    for unit in {unit for name in columns for unit in re.findall(r"\[(.*)\]", name)}:
        UREG.parse_units(unit)


def test_units_of_analyses_are_units() -> None:
    run = run_of("timing_drive", until=0.01)
    of_drive = run.drive
    for found in [
        of_drive.spectrum("span_tension", kind="density"),
        of_drive.spectrum("sprocket_torque", sprocket="crank"),
        of_drive.transmission_error("crank", "intake"),
        of_drive.speed_ripple(),
        of_drive.impacts(),
        of_drive.impulse_spectrum(blocks=2),
        of_drive.losses(),
        of_drive.joint_work(bush_length=0.01),
        of_drive.wear(bush_length=0.01),
        of_drive.rainflow(),
        of_drive.rating(),
        cd.scenes.timing_drive().statics(),
        cd.scenes.timing_drive().modes(),
        cd.catalogue(),
    ]:
        read(told(found))


def test_levels_are_decibels_to_pint() -> None:
    """UDUNITS has no decibels, only logarithms that pint does not read."""
    run = run_of("timing_drive", until=0.01)
    level = run.drive.impulse_level(run, blocks=2)
    assert told(level) == {"dB", "1"}
    assert UREG.parse_units("dB") == UREG.decibel


def test_units_of_sweeps_are_units(tmp_path) -> None:
    paths = {"contact.teeth.law.stiffness": ["6e11 N/m^1.5"], "chain.drag": [0.0, 0.1]}
    settings = {"until": 1e-4, "run_in": 0}
    made = cd.sweep(cd.scenes.marine_engine(), paths, **settings)
    read(told(made))
    # The exponent n is another parameter.
    assert made["stiffness"].attrs["entry_units"] == "N/m^n"
    assert made["drag"].attrs["units"] == "N s/m^2"
    pytest.importorskip("zarr")
    output = f"{tmp_path}/sweep.zarr"
    stored = cd.sweep(cd.scenes.marine_engine(), paths, **settings, output=output)
    assert told(stored) == told(made)


def test_quantities_of_pint_are_settings_of_a_run() -> None:
    ring = cd.scenes.spinning_ring()
    every, step = 100 * UREG.us, 0.01 * UREG.ms
    run = cd.simulate(ring, until=1.5 * UREG.ms, every=every, step=step, method="rk4")
    same = cd.simulate(ring, until=1.5e-3, every=1e-4, step=1e-5, method="rk4")
    for name in ("until", "every", "step"):
        assert run.attrs[name] == pytest.approx(same.attrs[name], rel=1e-12)
    assert cd.simulate(ring, until=1e-3, accuracy=2 * UREG.percent).attrs["accuracy"] == 0.02
    simulation = cd.Simulation(ring, step=step, method="rk4")
    simulation.advance_to(1e-3)
    assert "100 steps" in repr(simulation)
    depth = cd.work_precision(
        ring, methods="verlet", steps=[20 * UREG.us], until=5 * UREG.ms, repeats=1
    )
    assert float(depth["step"][0]) == pytest.approx(2e-5)


def test_quantities_of_pint_are_values_of_a_scene() -> None:
    drive = cd.scenes.industrial_16b()
    torque = UREG.Quantity(-300, "lbf ft")
    changed = drive.replace(
        {
            "sprockets.driver.motion.speed": 200 * UREG.rpm,
            "chain.stiffness": UREG.Quantity(150, "kN/mm"),
            "sprockets.driven.load": [{"kind": "constant", "torque": torque}],
            "sprockets.driven.inertia": UREG.Quantity(500, "kg cm^2"),
        }
    )
    same = drive.replace(
        {
            "sprockets.driver.motion.speed": "200 rpm",
            "chain.stiffness": "150 kN/mm",
            "sprockets.driven.load": [{"kind": "constant", "torque": "-300 lbf ft"}],
            "sprockets.driven.inertia": "0.05 kg m^2",
        }
    )
    for path, one, other in cd.diff(changed, same):
        figure, _, unit = one.partition(" ")
        expected, _, same_unit = other.partition(" ")
        assert (float(figure), unit) == (pytest.approx(float(expected), rel=1e-12), same_unit), path
    sticky = cd.friction("coulomb", coefficient=0.1, slip_speed=2 * UREG.mm / UREG.s)
    assert sticky.parameters["slip_speed"] == 2e-3
    speeds = UREG.Quantity([100, 200], "rpm")
    swept = cd.sweep(drive, {"sprockets.driver.motion.speed": speeds}, until=1e-4, run_in=0)
    assert swept["speed"].to_numpy() == pytest.approx([10.472, 20.944], rel=1e-4)


def test_a_quantity_of_another_dimension_is_refused_in_our_words() -> None:
    ring = cd.scenes.spinning_ring()
    with pytest.raises(cd.SceneError, match=r"2\.0 kg.*a time") as caught:
        cd.simulate(ring, until=2 * UREG.kg)
    assert caught.value.path == "run.until"
    with pytest.raises(cd.SceneError, match="a mass") as caught:
        ring.replace({"chain.mass": 3 * UREG.inch})
    assert caught.value.path == "chain.mass"
    with pytest.raises(cd.SceneError, match="a time"):
        cd.simulate(ring, until=3 * UREG.ampere)
    with pytest.raises(cd.ParameterError, match="a speed"):
        cd.friction("coulomb", coefficient=0.1, slip_speed=2 * UREG.kg)
