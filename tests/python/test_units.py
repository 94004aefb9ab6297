"""Units of results, as other programs read them: pint, and UDUNITS for the CF conventions."""

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


def run_of(name: str) -> xr.Dataset:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        drive = getattr(cd.scenes, name)()
        events = ["teeth", "guides"]
        return cd.simulate(
            drive, until=0.01, run_in=0, every=1e-4, record="all", events=events, error=False
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
    run = run_of("timing_drive")
    of_drive = run.drive
    for found in [
        of_drive.spectrum("span_tension", kind="density"),
        of_drive.spectrum("sprocket_torque", sprocket="crank"),
        of_drive.transmission_error("crank", "intake"),
        of_drive.speed_ripple(),
        of_drive.impacts(),
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


def test_units_of_sweeps_are_units(tmp_path) -> None:
    paths = {"contact.teeth.law.stiffness": ["6e11 N/m^1.5"], "chain.drag": [0.0, 0.1]}
    made = cd.sweep(cd.scenes.marine_engine(), paths, until=1e-3)
    read(told(made))
    # The exponent n is another parameter.
    assert made["stiffness"].attrs["entry_units"] == "N/m^n"
    assert made["drag"].attrs["units"] == "N s/m^2"
    pytest.importorskip("zarr")
    stored = cd.sweep(cd.scenes.marine_engine(), paths, until=1e-3, output=f"{tmp_path}/sweep.zarr")
    assert told(stored) == told(made)
