"""Run-ups of two presets: where the mesh stands among orders, and where it meets running modes."""

import numpy as np
import pytest
import xarray as xr

import chaindrive as cd
from chaindrive import analysis

pytestmark = pytest.mark.slow

RECORD = ["span_tension", "link_tension", "roller_x", "roller_y", "sprocket_speed"]


def highest_near(cut: xr.Dataset, frequency: float, share: float = 0.05) -> float:
    """Return where an order has its highest amplitude near a frequency [Hz]."""
    near = np.abs(cut["frequency"] / frequency - 1.0) < share
    at = cut["amplitude"].where(near).argmax("turn")
    return float(cut["frequency"].isel(turn=at))


@pytest.fixture(scope="module")
def marine() -> xr.Dataset:
    drive = cd.scenes.marine_engine_bare()
    return cd.run_up(
        drive, "28 rpm", "50 rpm", until=60.0, every="2 ms", record=RECORD, error=False
    )


@pytest.mark.parametrize("span", ["camshaft-tensioner", "tensioner-idler", "idler-crank"])
def test_the_mesh_of_the_marine_drive_is_order_48(marine: xr.Dataset, span: str) -> None:
    motion = marine.drive.span_motion(span, places=0.37)
    spread = marine.drive.order_spectrum(motion, "crank")
    mesh = analysis.peaks(spread.sel(order=slice(40, 56)), count=1)
    assert float(mesh["order"][0]) == pytest.approx(48.0, rel=1e-3)


@pytest.mark.parametrize(
    ("span", "expected"),
    [
        ("camshaft-tensioner", [38.3]),
        ("tensioner-idler", [23.6, 29.3]),
        ("idler-crank", [26.4, 31.5, 36.3]),
    ],
)
def test_spans_of_the_marine_drive_answer_at_their_running_modes(
    marine: xr.Dataset, span: str, expected: list[float]
) -> None:
    """Left out is the fourth mode of the short span, 31.1 Hz: it swings so far that it stiffens."""
    modes = marine.drive.running_modes(speeds=np.linspace(3.0, 5.2, 9), up_to=45.0)
    critical = analysis.critical_speeds(modes, 48)
    mine = critical["frequency"][(critical["part"] == span) & (critical["share"] > 0.6)].to_numpy()
    motion = marine.drive.span_motion(span, places=0.37)
    orders = marine.drive.order_map(motion, "crank", turns=3, overlap=0.9)
    cut = analysis.order_slice(orders, 48, half_width=0.5)
    for frequency in expected:
        mode = float(mine[np.abs(mine - frequency).argmin()])
        assert mode == pytest.approx(frequency, abs=0.2)
        assert highest_near(cut, mode) == pytest.approx(mode, rel=0.02), frequency


def test_the_timing_drive_swings_on_its_chain_when_order_4_meets_the_mode() -> None:
    """The camshafts against the crank: tensions that loads swing leave this mode alone."""
    drive = cd.scenes.timing_drive()
    run = cd.run_up(
        drive, "2300 rpm", "3000 rpm", until=0.8, every="0.2 ms", record=RECORD, error=False
    )
    modes = run.drive.running_modes(speeds=np.array([2400, 2600, 2800]) * np.pi / 30, up_to=250)
    critical = analysis.critical_speeds(modes, 4)
    mode = float(critical["frequency"][critical["part"] == "wheels and tensioners"][0])
    orders = run.drive.order_map("sprocket_speed", "crank", sprocket="exhaust", turns=2)
    cut = analysis.order_slice(orders, 4, half_width=0.4)
    assert highest_near(cut, mode, share=0.1) == pytest.approx(mode, rel=0.02)
    motion = run.drive.span_motion("crank-fixed", places=0.37)
    spread = run.drive.order_spectrum(motion, "crank")
    mesh = analysis.peaks(spread.sel(order=slice(12, 25)), count=1)
    assert float(mesh["order"][0]) == pytest.approx(18.0, rel=1e-3)
