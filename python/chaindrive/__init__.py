"""Simulator of roller chain drives: sprockets, guides, tensioners and the chain between them.

    >>> import chaindrive as cd
    >>> drive = cd.scenes.spinning_ring()
    >>> run = cd.simulate(drive, until=0.01, record=["link_tension"])
    >>> run["link_tension"].dims
    ('time', 'link')

A `Drive` is read from a scene file (`load`), from text, from a dict or from `scenes`; `simulate`
moves it and returns an `xarray.Dataset` with names, units and provenance; `sweep` does so for many
variants at once, and a `Simulation` is moved by a program of your own. Quantities are in SI
units throughout; scene files may carry units of their own. Counter-clockwise angles, tensions and
penetrations are positive.
"""

from chaindrive import design, errors, kinematics, plot, scenes
from chaindrive._core import __version__
from chaindrive.catalogue import catalogue
from chaindrive.channels import channels
from chaindrive.drive import Difference, Drive, diff, load, schema
from chaindrive.errors import (
    AssemblyError,
    CautiousResultWarning,
    ChaindriveError,
    ClashWarning,
    DistrustedResultWarning,
    IntegrationError,
    ParameterError,
    ResultWarning,
    ResumeError,
    SceneError,
    SimulationError,
    VerdictWarning,
    WriteError,
)
from chaindrive.friction import Friction, friction
from chaindrive.law import Law, law
from chaindrive.live import Simulation, Snapshot
from chaindrive.precision import work_precision
from chaindrive.profile import Profile
from chaindrive.results import open_result
from chaindrive.simulation import resume, simulate
from chaindrive.sweeping import sweep

__all__ = [
    "AssemblyError",
    "CautiousResultWarning",
    "ChaindriveError",
    "ClashWarning",
    "Difference",
    "DistrustedResultWarning",
    "Drive",
    "Friction",
    "IntegrationError",
    "Law",
    "ParameterError",
    "Profile",
    "ResultWarning",
    "ResumeError",
    "SceneError",
    "Simulation",
    "SimulationError",
    "Snapshot",
    "VerdictWarning",
    "WriteError",
    "__version__",
    "catalogue",
    "channels",
    "design",
    "diff",
    "errors",
    "friction",
    "kinematics",
    "law",
    "load",
    "open_result",
    "plot",
    "resume",
    "scenes",
    "schema",
    "simulate",
    "sweep",
    "work_precision",
]
