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

# Type checkers take this name for true. To import it from `typing` would take most of the time
# that this package takes.
TYPE_CHECKING = False

if TYPE_CHECKING:
    from chaindrive import analysis as analysis
    from chaindrive import design as design
    from chaindrive import errors as errors
    from chaindrive import exchange as exchange
    from chaindrive import kinematics as kinematics
    from chaindrive import plot as plot
    from chaindrive import scenes as scenes
    from chaindrive import settings as settings
    from chaindrive._core import __build__ as __build__
    from chaindrive._core import __version__ as __version__
    from chaindrive.analysis.elongation import worn as worn
    from chaindrive.analysis.ramps import run_up as run_up
    from chaindrive.chain_catalogue import catalogue as catalogue
    from chaindrive.channel import Channel as Channel
    from chaindrive.channel import channels as channels
    from chaindrive.contact_law import Law as Law
    from chaindrive.contact_law import law as law
    from chaindrive.drive import Description as Description
    from chaindrive.drive import Difference as Difference
    from chaindrive.drive import Drive as Drive
    from chaindrive.drive import diff as diff
    from chaindrive.drive import load as load
    from chaindrive.drive import schema as schema
    from chaindrive.errors import AssemblyError as AssemblyError
    from chaindrive.errors import CautiousResultWarning as CautiousResultWarning
    from chaindrive.errors import ChaindriveError as ChaindriveError
    from chaindrive.errors import ClashWarning as ClashWarning
    from chaindrive.errors import DistrustedResultWarning as DistrustedResultWarning
    from chaindrive.errors import IntegrationError as IntegrationError
    from chaindrive.errors import ParameterError as ParameterError
    from chaindrive.errors import ResultWarning as ResultWarning
    from chaindrive.errors import ResumeError as ResumeError
    from chaindrive.errors import SceneError as SceneError
    from chaindrive.errors import SimulationError as SimulationError
    from chaindrive.errors import VerdictWarning as VerdictWarning
    from chaindrive.errors import WriteError as WriteError
    from chaindrive.exchange import save as save
    from chaindrive.friction_law import Friction as Friction
    from chaindrive.friction_law import friction as friction
    from chaindrive.live import Simulation as Simulation
    from chaindrive.live import Snapshot as Snapshot
    from chaindrive.live import View as View
    from chaindrive.live import step_many as step_many
    from chaindrive.page import Page as Page
    from chaindrive.precision import work_precision as work_precision
    from chaindrive.profile import Profile as Profile
    from chaindrive.replaying import Replay as Replay
    from chaindrive.replaying import replay as replay
    from chaindrive.reporting import report as report
    from chaindrive.results import open_result as open_result
    from chaindrive.results import take_over as take_over
    from chaindrive.simulation import resume as resume
    from chaindrive.simulation import simulate as simulate
    from chaindrive.sweeping import sweep as sweep

# What is imported when it is first asked for: xarray alone takes longer than all of a short
# command, and the command hears Ctrl-C before it imports the core. No name is that of a module
# that defines something else, which the import would hide.
_MODULES = (
    "analysis",
    "design",
    "errors",
    "exchange",
    "kinematics",
    "plot",
    "scenes",
    "settings",
)
_DEFINED_IN = {
    "_core": ("__build__", "__version__"),
    "analysis.elongation": ("worn",),
    "analysis.ramps": ("run_up",),
    "chain_catalogue": ("catalogue",),
    "channel": ("Channel", "channels"),
    "contact_law": ("Law", "law"),
    "drive": ("Description", "Difference", "Drive", "diff", "load", "schema"),
    "errors": (
        "AssemblyError",
        "CautiousResultWarning",
        "ChaindriveError",
        "ClashWarning",
        "DistrustedResultWarning",
        "IntegrationError",
        "ParameterError",
        "ResultWarning",
        "ResumeError",
        "SceneError",
        "SimulationError",
        "VerdictWarning",
        "WriteError",
    ),
    "exchange": ("save",),
    "friction_law": ("Friction", "friction"),
    "live": ("Simulation", "Snapshot", "View", "step_many"),
    "precision": ("work_precision",),
    "profile": ("Profile",),
    "page": ("Page",),
    "replaying": ("Replay", "replay"),
    "reporting": ("report",),
    "results": ("open_result", "take_over"),
    "simulation": ("resume", "simulate"),
    "sweeping": ("sweep",),
}
_HOME = {name: module for module, names in _DEFINED_IN.items() for name in names}

__all__ = sorted([*_MODULES, *_HOME])


# Type checkers know the names above, and would take any name for one of these.
if not TYPE_CHECKING:

    def __getattr__(name: str) -> object:
        import sys
        from importlib import import_module

        if name in _MODULES:
            return import_module(f"chaindrive.{name}")
        if name in _HOME:
            value = getattr(import_module(f"chaindrive.{_HOME[name]}"), name)
            globals()[name] = value
            return value
        # With the module at hand Python adds which name may have been meant.
        message = f"module 'chaindrive' has no attribute {name!r}"
        raise AttributeError(message, name=name, obj=sys.modules[__name__])


def __dir__() -> list[str]:
    return list(__all__)
