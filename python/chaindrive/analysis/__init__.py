"""Analysis of runs: spectra and modes, contacts and losses, wear and fatigue.

Every function takes a run, the `xarray.Dataset` of `chaindrive.simulate`, and returns labelled
arrays in SI units. The same functions are methods of ``run.drive``, see `DriveAccessor`. SciPy
does the mathematics: the extra ``analysis``.

    >>> import chaindrive as cd
    >>> run = cd.simulate(cd.scenes.spinning_ring(), until=0.02, record=["link_tension"])
    >>> run.drive.spectrum("link_tension", link=3).dims
    ('frequency',)
"""

from chaindrive.analysis.around import tension_around_loop
from chaindrive.analysis.capacity import rating
from chaindrive.analysis.dissipation import losses
from chaindrive.analysis.duty import utilisation
from chaindrive.analysis.elongation import wear, worn
from chaindrive.analysis.engagement import decay, tooth_load
from chaindrive.analysis.fatigue import cycles, rainflow
from chaindrive.analysis.impulses import impulse_level, impulse_spectrum
from chaindrive.analysis.joints import joint_work
from chaindrive.analysis.order_names import order_names
from chaindrive.analysis.orders import campbell, mesh_orders, order_map, order_slice, order_spectrum
from chaindrive.analysis.ramps import run_up
from chaindrive.analysis.running import (
    critical_speeds,
    moving_string,
    running_modes,
    span_frequencies,
)
from chaindrive.analysis.seating import impacts
from chaindrive.analysis.spans import span_envelope, span_lines, span_motion
from chaindrive.analysis.spectra import peaks, spectrum
from chaindrive.analysis.transmission import speed_ripple, transmission_error

__all__ = [
    "campbell",
    "critical_speeds",
    "cycles",
    "decay",
    "impacts",
    "impulse_level",
    "impulse_spectrum",
    "joint_work",
    "losses",
    "mesh_orders",
    "moving_string",
    "order_map",
    "order_names",
    "order_slice",
    "order_spectrum",
    "peaks",
    "rainflow",
    "rating",
    "run_up",
    "running_modes",
    "span_envelope",
    "span_frequencies",
    "span_lines",
    "span_motion",
    "spectrum",
    "speed_ripple",
    "tension_around_loop",
    "tooth_load",
    "transmission_error",
    "utilisation",
    "wear",
    "worn",
]


def __dir__() -> list[str]:
    return list(__all__)
