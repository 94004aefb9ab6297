"""Impulses at mesh orders: lines of periodic trains, densities of random ones, levels in dB."""

import numpy as np
import pytest
import xarray as xr

import chaindrive as cd
from chaindrive import analysis

TAU = 2.0 * np.pi
TEETH = {"driver": 19, "driven": 57}
MESH = 250.0  # Hz


@pytest.fixture(scope="module")
def drive() -> xr.Dataset:
    """Return a run whose scene the trains below are given to."""
    run = cd.simulate(
        cd.scenes.industrial_16b(),
        until=1e-3,
        run_in=0,
        record="sprocket_angle",
        events="teeth",
        error=False,
    )
    teeth = {name: it.teeth for name, it in analysis.parts.sprockets(run).items()}
    assert teeth == TEETH
    return run


def struck(
    drive: xr.Dataset,
    times: np.ndarray,
    impulses: np.ndarray | float,
    meshes: int,
    sense: float = 1.0,
) -> xr.Dataset:
    """Make a run in which the driver is struck, and the other one a thousandth as much."""
    seconds = meshes / MESH
    time = np.linspace(0.0, seconds, 41)
    turned = {name: sense * TAU * MESH / teeth * time for name, teeth in TEETH.items()}
    angles = np.column_stack([turned[name] for name in drive["sprocket"].to_numpy()])
    impulses = np.broadcast_to(impulses, times.shape)
    count = times.size
    events = {
        "event_kind": np.full(2 * count, "tooth"),
        "event_body": np.repeat(list(TEETH), count),
        "event_start": np.tile(times, 2),
        "event_onset_speed": np.concatenate([impulses, 1e-3 * impulses]),
    }
    return xr.Dataset(
        {name: ("event", values) for name, values in events.items()},
        coords={"time": time, "sprocket": drive["sprocket"].to_numpy()},
        attrs=drive.attrs,
    ).assign(sprocket_angle=(("time", "sprocket"), angles, {"units": "rad"}))


@pytest.fixture(scope="module")
def unit(drive: xr.Dataset) -> float:
    """Return the mass for which J = (1 + e) m v is v."""
    return 1.0 / (1.0 + analysis.parts.sprockets(drive)["driver"].restitution)


def periodic(meshes: int, each: int = 1) -> np.ndarray:
    return (np.arange(meshes * each) + 0.3) / (MESH * each)


@pytest.mark.parametrize(("sense", "each"), [(1.0, 1), (-1.0, 1), (1.0, 2)])
def test_a_periodic_train_has_lines_of_two_impulses_a_period(
    drive: xr.Dataset, unit: float, sense: float, each: int
) -> None:
    """Fourier series: Σ J δ(t − k T) = J/T + (2J/T) Σ cos(2π n t / T)."""
    run = struck(drive, periodic(64, each), 3.0, 64, sense)
    found = analysis.impulse_spectrum(run, mass=unit)
    assert found.attrs == {"blocks": 8, "meshes": 8}
    order = found["order"].to_numpy()
    line = np.isclose(order % each, 0.0) | np.isclose(order % each, each)
    amplitude = found["amplitude"].sel(sprocket="driver").to_numpy()
    height = 2.0 * 3.0 * MESH * each
    assert line.sum() == 8 // each
    np.testing.assert_allclose(amplitude[line], height, rtol=1e-9)
    np.testing.assert_allclose(amplitude[~line], 0.0, atol=1e-9 * height)
    other = found["amplitude"].sel(sprocket="driven").to_numpy()
    np.testing.assert_allclose(other[line], 1e-3 * height, rtol=1e-9)
    assert float(found["mesh_frequency"][0]) == pytest.approx(MESH, rel=1e-12)
    assert float(found["rate"][0]) == pytest.approx(MESH * each, rel=1e-12)


def poisson(random: np.random.Generator, rate: float, meshes: int) -> np.ndarray:
    seconds = meshes / MESH
    return np.sort(random.uniform(0.0, seconds, random.poisson(rate * seconds)))


def test_a_poisson_train_has_a_flat_density(drive: xr.Dataset, unit: float) -> None:
    """Campbell's theorem: 2 λ J². Lines a block apart are independent, and so are blocks."""
    rate, impulse = 20.0 * MESH, 0.3
    run = struck(drive, poisson(np.random.default_rng(5), rate, 640), impulse, 640)
    found = analysis.impulse_spectrum(run, blocks=80, up_to=8.0, mass=unit).sel(sprocket="driver")
    flat = 2.0 * rate * impulse**2
    density = found["density"].to_numpy()
    estimates = 80 * density.size
    assert estimates == 80 * 64
    assert density.mean() == pytest.approx(flat, rel=4.0 / np.sqrt(estimates))
    # Flat: neither half is above the other by more than that.
    for part in (density[:32], density[32:]):
        assert part.mean() == pytest.approx(flat, rel=4.0 / np.sqrt(estimates / 2))
    drawn = 4.0 / np.sqrt(rate * 640 / MESH)
    assert float(found["broadband"]) == pytest.approx(flat, rel=drawn)
    assert float(found["broadband"]) == pytest.approx(2 * float(found["rate"]) * impulse**2)
    # A² / 2 in a band of the width 1/T is the density times that width.
    width = MESH / 8
    np.testing.assert_allclose(found["amplitude"] ** 2 / 2, found["density"] * width, rtol=1e-12)


def test_twice_the_impulse_is_six_decibels(drive: xr.Dataset) -> None:
    random = np.random.default_rng(6)
    times = poisson(random, 5.0 * MESH, 64)
    impulses = random.exponential(size=times.size)
    reference = struck(drive, times, impulses, 64)
    found = analysis.impulse_level(struck(drive, times, 2.0 * impulses, 64), reference, name="half")
    twice = 20.0 * np.log10(2.0)
    np.testing.assert_allclose(found["level"], twice, rtol=1e-12)
    np.testing.assert_allclose(found["broadband_level"], twice, rtol=1e-12)
    np.testing.assert_allclose(0.5 * (found["low"] + found["high"]), twice, rtol=1e-9)
    assert (found["high"] > found["low"]).all()
    told = "at mesh orders 1, 2, 3 re half, band ± 0.25 mesh orders, "
    told += "mean over 8 blocks of 8 mesh periods"
    assert found["level"].attrs == {"units": "dB", "long_name": f"impulse level {told}"}
    for end in ("low", "high"):
        assert found[end].attrs["long_name"].endswith(f"95% interval of the impulse level {told}")
    assert "pressure" not in str(found)


def test_what_does_not_matter_moves_no_level(drive: xr.Dataset, unit: float) -> None:
    """Whole periods a block, offset of time, order of events, a missing rest, a contact before."""
    random = np.random.default_rng(7)
    # Every fourth mesh differs: 4 mesh periods are a period of the train.
    impulses = np.tile([1.0, 3.0, 2.0, 0.5], 24)
    run = struck(drive, periodic(96), impulses, 96)
    usual = analysis.impulse_spectrum(run, meshes=4, mass=unit)
    assert usual.attrs["blocks"] == 24
    assert float(usual["amplitude"][0].sel(order=0.25)) > 1.0
    later = run.assign_coords(time=run["time"] + 7.0).assign(event_start=run["event_start"] + 7.0)
    shuffled = run.isel(event=random.permutation(run.sizes["event"]))
    before = xr.concat(
        [run, run.isel(event=[0]).assign(event_start=("event", [0.0]))],
        "event",
        data_vars="minimal",
    )
    variants = {
        "blocks": analysis.impulse_spectrum(run, meshes=12, mass=unit),
        "offset": analysis.impulse_spectrum(later, meshes=4, mass=unit),
        "order": analysis.impulse_spectrum(shuffled, meshes=4, mass=unit),
        "rest": analysis.impulse_spectrum(run, meshes=20, mass=unit),
        "before": analysis.impulse_spectrum(before, meshes=4, mass=unit),
        "after": analysis.impulse_spectrum(run, meshes=4, mass=unit, after=8.0 / MESH),
    }
    scale = float(usual["amplitude"][0].max())
    for name, found in variants.items():
        at = found.sel(order=usual["order"], method="nearest", tolerance=1e-9)
        np.testing.assert_allclose(
            at["amplitude"], usual["amplitude"], rtol=1e-9, atol=1e-9 * scale, err_msg=name
        )
    xr.testing.assert_identical(variants["order"], usual)
    assert variants["rest"].attrs == {"blocks": 4, "meshes": 20}
    level = analysis.impulse_level(later, shuffled, blocks=6)
    np.testing.assert_allclose(level["level"], 0.0, atol=1e-9)


def test_intervals_of_levels_hold_the_truth(drive: xr.Dataset) -> None:
    """Of two drives that differ by chance only 95 % of intervals hold 0 dB."""
    random = np.random.default_rng(8)
    runs = [struck(drive, poisson(random, 5.0 * MESH, 64), 1.0, 64) for _ in range(60)]
    held = []
    for one, other in zip(runs[::2], runs[1::2], strict=True):
        found = analysis.impulse_level(one, other).sel(sprocket="driver")
        held.append(((found["low"] <= 0.0) & (found["high"] >= 0.0)).to_numpy())
    # 85.5 of 90 expected, standard deviation 2.1.
    assert 79 <= np.sum(held) <= 90


def test_a_faster_drive_strikes_harder_at_its_own_mesh(drive: xr.Dataset, unit: float) -> None:
    """Blows as fast as the chain, twice as often: four times the line 2J/T."""
    reference = struck(drive, periodic(64), 1.0, 64)
    faster = struck(drive, periodic(64), 2.0, 64)
    half = {"time": faster["time"] / 2}
    faster = faster.assign_coords(half).assign(event_start=faster["event_start"] / 2)
    found = analysis.impulse_level(faster, reference, mass=unit)
    np.testing.assert_allclose(found["level"], 40.0 * np.log10(2.0), rtol=1e-9)


def test_what_a_level_cannot_be_made_of_is_named(drive: xr.Dataset) -> None:
    run = struck(drive, periodic(16), 1.0, 16)
    with pytest.raises(cd.ParameterError, match="no contacts were logged"):
        analysis.impulse_spectrum(run.drop_vars("event_kind"))
    with pytest.raises(cd.ParameterError, match=r"16 teeth of dri.* too few for 20 blocks"):
        analysis.impulse_spectrum(run, blocks=20)
    with pytest.raises(cd.ParameterError, match="blocks = 1, must be 2"):
        analysis.impulse_spectrum(run, blocks=1)
    with pytest.raises(cd.ParameterError, match=r"the first order is 0\.5"):
        analysis.impulse_spectrum(run, up_to=0.2)
    with pytest.raises(cd.ParameterError, match=r"order 1\.5 holds no line; they stand 1 apart"):
        analysis.impulse_level(run, run, orders=(1.5,), blocks=16)
    back = run.assign(sprocket_angle=np.sin(MESH * run["time"]) * run["sprocket_angle"])
    with pytest.raises(cd.ParameterError, match="driver stands or goes back"):
        analysis.impulse_spectrum(back)
    # Silence has no level re anything, and nothing has one re silence.
    silent = run.isel(event=[])
    level = analysis.impulse_level(silent, run)
    assert np.isneginf(level["level"]).all()
    assert not np.isfinite(analysis.impulse_level(run, silent)["level"]).any()
    assert analysis.impulse_level(silent, silent)["level"].isnull().all()


def test_reports_hold_levels_and_orders(drive: xr.Dataset) -> None:
    from matplotlib import pyplot

    run = struck(drive, periodic(32), 2.0, 32)
    reference = struck(drive, periodic(32), 1.0, 32)
    from chaindrive import reporting

    (told,) = reporting.impulse_levels(run, reference)
    assert "Impulse level at mesh orders 1, 2, 3 re " in told
    assert "mean over 8 blocks of 4 mesh periods" in told
    assert told.count("+6.02") == 2 * (3 * 3 + 1)
    assert "no sound pressure" in told
    ax = cd.plot.impulse_spectrum(run)
    assert [line.get_label() for line in ax.lines] == list(run["sprocket"].to_numpy())
    assert "[" in ax.get_ylabel()
    pyplot.close(ax.figure)
