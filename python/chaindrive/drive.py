"""Drives: read, built, changed, described."""

from __future__ import annotations

import json
import math
import tomllib
from collections.abc import Callable, Mapping
from os import PathLike, fspath
from typing import TYPE_CHECKING, Any, NamedTuple, cast

import numpy as np

from chaindrive import _core, data_sheet, fmu
from chaindrive.contact_law import Law
from chaindrive.errors import ParameterError, SceneError
from chaindrive.profile import Profile
from chaindrive.quantity import with_unit
from chaindrive.scene_values import scene_json

if TYPE_CHECKING:
    from typing import Self

    import xarray as xr
    from numpy.typing import NDArray

    from chaindrive.settings import Quantity

__all__ = ["Description", "Difference", "Drive", "diff", "load", "schema"]


class Drive:
    """A chain drive: a scene that was checked, ready to be simulated.

    Made by `load`, `Drive.from_toml`, `Drive.from_dict` or one of `chaindrive.scenes`; immutable.
    Drives compare by their text and can be pickled.

    Examples
    --------
    >>> import chaindrive as cd
    >>> drive = cd.scenes.marine_engine()
    >>> drive.links
    122
    >>> drive.replace({"sprockets.crank.motion.speed": "-80 rpm"}).links
    122
    """

    __slots__ = ("_inner",)
    _inner: _core.Drive

    def __init__(self) -> None:
        raise TypeError("use chaindrive.load, Drive.from_toml, Drive.from_dict or a preset")

    @classmethod
    def _of(cls, core: _core.Drive) -> Self:
        drive = cls.__new__(cls)
        object.__setattr__(drive, "_inner", core)
        return drive

    @classmethod
    def from_toml(cls, text: str, name: str = "scene") -> Self:
        """Read a scene from TOML.

        Parameters
        ----------
        text
            The scene.
        name
            Name of the scene in messages.

        Raises
        ------
        SceneError
            With everything that is wrong, each with its line.
        """
        return cls._of(_core.Drive.from_toml(text, name))

    @classmethod
    def from_dict(cls, scene: Mapping[str, Any], name: str = "scene") -> Self:
        """Build a scene from a dict with the keys of a scene file.

        Parameters
        ----------
        scene
            Numbers are in SI units, texts may carry a unit (``"88.9 mm"``), and quantities of
            pint carry theirs. NumPy arrays and scalars stand for lists and numbers, so that a
            measured motion or profile can be put in as it is.
        name
            Name of the scene in messages.

        Raises
        ------
        SceneError
            With everything that is wrong, each with its path.
        """
        return cls._of(_core.Drive.from_data(scene_json(scene, name, ""), name))

    def replace(self, changes: Mapping[str, Any]) -> Drive:
        """Return a new drive with some values of its scene replaced.

        Parameters
        ----------
        changes
            Values by dotted path; entries of lists by name or index: ``"chain.links"``,
            ``"sprockets.camshaft.inertia"``, ``"sprockets[1].load"``. Values as in `from_dict`.

        Raises
        ------
        SceneError
            A path leads nowhere, or the new scene is not a drive.
        """
        pairs = [(path, scene_json(value, self.name, path)) for path, value in changes.items()]
        return Drive._of(self._inner.replace(pairs))

    def resolved(self) -> Drive:
        """Return the drive with every default of its scene written out.

        Its `text` is TOML in SI units, in which every value that the scene leaves open stands with
        its source or "assumed" as a comment. It makes the same drive to the last bit, whatever the
        defaults of later versions are.

        Examples
        --------
        >>> import chaindrive as cd
        >>> full = cd.scenes.spinning_ring().resolved()
        >>> [line for line in full.text.splitlines() if "plate_height" in line][0][:50]
        'plate_height = 0.010667999999999999 # [m] 1.4 roll'
        """
        return Drive._of(self._inner.resolved())

    @property
    def text(self) -> str:
        """The text that reproduces the drive, in TOML or JSON as it was written."""
        return self._inner.text

    @property
    def name(self) -> str:
        """Name of the drive in messages: its file or preset."""
        return self._inner.name

    @property
    def title(self) -> str:
        """Title of the scene, in a line; may be empty."""
        return self._inner.title

    @property
    def links(self) -> int:
        """Number of links, of all chains."""
        return self._inner.links

    @property
    def chains(self) -> dict[str, int]:
        """Number of links of every chain, by its name; empty where there is one chain only."""
        return dict(self._inner.chains)

    @property
    def shafts(self) -> list[str]:
        """Names of the shafts that the scene names."""
        return self._inner.shafts

    @property
    def couplings(self) -> list[str]:
        """Names of the couplings between shafts."""
        return self._inner.couplings

    @property
    def sprockets(self) -> list[str]:
        """Names of the sprockets."""
        return self._inner.sprockets

    @property
    def guides(self) -> list[str]:
        """Names of the guides."""
        return self._inner.guides

    @property
    def tensioners(self) -> list[str]:
        """Names of the tensioners."""
        return self._inner.tensioners

    @property
    def run_defaults(self) -> dict[str, Any]:
        """Settings that `simulate` takes unless others are given, by name."""
        return self._inner.run_defaults()

    def to_dict(self) -> dict[str, Any]:
        """Return the scene as a dict, as it was written: quantities keep their units."""
        is_json = self.text.lstrip("\ufeff \t\r\n").startswith("{")
        read = json.loads if is_json else tomllib.loads
        return cast("dict[str, Any]", read(self.text.removeprefix("\ufeff")))

    def describe(self) -> Description:
        """Describe what will be simulated: route, statics, model, time scales, cost.

        Returns
        -------
        Description
            A dict of the facts in SI units that prints as a text. The cost is measured by a few
            hundred steps of the run that the scene suggests, with the default step where it names
            none; ``facts["cost"]["unless_chosen_for"]`` is the accuracy [–] for which `simulate`
            then chooses another.

        Raises
        ------
        AssemblyError
            The drive does not close or settle.
        """
        text, facts = self._inner.describe()
        return Description(json.loads(facts), text)

    def statics(self) -> xr.Dataset:
        """Return the static states on the way to the start of a run.

        Returns
        -------
        xarray.Dataset
            ``link_tension`` (stage, link) and ``span_tension`` (stage, span) [N], and the
            number of closed ``contacts`` (stage, sprocket). The stages are those the drive has
            of ``pretension``, ``gravity`` and ``load``; none when it starts without settling.

        Raises
        ------
        AssemblyError
            The drive does not close or settle.
        """
        import xarray as xr

        spans, stages = self._inner.statics()
        span_tensions = [tensions for _, _, tensions, _ in stages]
        count = len(stages)
        shape = (count, self.links)
        tensions = np.reshape([tensions for _, tensions, *_ in stages], shape)
        contacts = np.reshape([closed for *_, closed in stages], (count, len(self.sprockets)))
        force = {"units": "N"}
        return xr.Dataset(
            {
                "link_tension": (
                    ("stage", "link"),
                    tensions,
                    force | {"long_name": "static tension of every link"},
                ),
                "span_tension": (
                    ("stage", "span"),
                    np.reshape(np.asarray(span_tensions, dtype=float), (count, len(spans))),
                    force | {"long_name": "mean static tension of every span"},
                ),
                "contacts": (
                    ("stage", "sprocket"),
                    contacts,
                    {"units": "1", "long_name": "number of closed contacts on the sprocket"},
                ),
            },
            coords={
                "stage": [stage for stage, *_ in stages],
                "link": np.arange(self.links),
                "span": spans,
                "sprocket": self.sprockets,
            }
            | self._chain_of_every_link(),
            attrs={"scene": self.text},
        )

    def _chain_of_every_link(self) -> dict[str, Any]:
        """Return the coordinate ``link_chain``, where there are several chains."""
        chains = self.chains
        if not chains:
            return {}
        names = np.asarray(list(chains), dtype=np.str_)
        return {"link_chain": ("link", np.repeat(names, list(chains.values())))}

    def modes(self) -> xr.Dataset:
        """Return natural frequencies and mode shapes about the static state.

        Small free vibrations of the drive at rest: closed contacts count with their tangent
        stiffness, damping and chain speed not at all.

        Returns
        -------
        xarray.Dataset
            ``frequency`` (mode) [Hz], ascending, negative where the state is unstable; the shapes
            ``roller_x``, ``roller_y`` (mode, roller), ``sprocket_x``, ``sprocket_y`` (mode,
            sprocket) and ``tensioner_position`` (mode, tensioner) [m/√kg] and ``sprocket_angle``
            (mode, sprocket) [rad/√kg], of unit modal mass.

        Raises
        ------
        AssemblyError
            The drive does not close or settle, or starts without settling.
        """
        import xarray as xr

        found = self._inner.modes()
        frequency = found.pop("frequency")
        about = {"units": "Hz", "long_name": "natural frequency"}
        variables: dict[str, Any] = {"frequency": ("mode", frequency, about)}
        for name, values in found.items():
            unit = "rad/kg^0.5" if name == "sprocket_angle" else "m/kg^0.5"
            about = {"units": unit, "long_name": f"mode shape, {name.replace('_', ' ')}"}
            variables[name] = (("mode", name.split("_")[0]), values, about)
        coordinates = {
            "mode": np.arange(frequency.size),
            "roller": np.arange(found["roller_x"].shape[1]),
            "sprocket": np.asarray(self.sprockets, dtype=np.str_),
            "tensioner": np.asarray(self.tensioners, dtype=np.str_),
        }
        return xr.Dataset(variables, coords=coordinates, attrs={"scene": self.text})

    def natural_frequencies(self) -> NDArray[np.float64]:
        """Return the natural frequencies about the static state [Hz], (modes,); see `modes`."""
        return self._inner.modes()["frequency"]

    def law(self, body: str) -> Law:
        """Return the contact law of a sprocket or guide by name, or of ``"joints"``, ``"rollers"``.

        Of several chains each has its own: ``"primary.joints"``.

        Raises
        ------
        KeyError
            No sprocket or guide has this name, or the chain has no such contacts.
        """
        return Law._of(self._inner.law(body))

    def rated_power(self, teeth: int, speed: float, *, chain: str | None = None) -> float:
        """Return the power that a chain is rated for [W], at its smallest sprocket.

        ::

            P₁ = 0.004 Z^1.08 n^0.9 p^(3 − 0.07 p)    fatigue of the plates
            P₂ = 1000 K (Z/n)^1.5 p^0.8                impacts of rollers and bushes
            P = min(P₁, P₂) · 745.7 W                  p in inches, n in rpm

        For a single strand of 100 pitches under smooth load, for 15 000 hours, oiled as its speed
        asks. Known for the chains of ASME B29.1 in the catalogue, numbers 25 to 240, with
        their own pitch. K is 17, 29 for numbers 25 and 35, and 3.4 for number 41, with 0.0022 for
        0.004. ``chain.strands`` of the scene multiplies it by 1, 1.7, 2.5, 3.3, 3.9 or 4.6.
        ``chain.rated_power`` takes its place, whatever the teeth and the speed. Galling and the
        service factor are not in it. A run tells more: `chaindrive.analysis.rating`.

        Parameters
        ----------
        teeth
            Number of teeth Z of the smallest sprocket that takes part.
        speed
            Its speed [rad/s], of either sign; at rest nothing is carried.
        chain
            Name of the chain, where there are several.

        Raises
        ------
        ParameterError
            The chain is not rated, as there is no source for those of the B series; the
            number of teeth is not positive or the speed not finite; or there are several chains
            and none is named.
        KeyError
            No chain has this name.

        References
        ----------
        American Chain Association, *Chains for Power Transmission and Material Handling*, 1982, in
        the form of R. G. Budynas and J. K. Nisbett, *Shigley's Mechanical Engineering Design*,
        9th ed., 2011, eqs. 17-32 and 17-33.

        Examples
        --------
        >>> import chaindrive as cd
        >>> drive = cd.scenes.industrial_16b().replace({"chain.type": "16A-1"})
        >>> round(drive.rated_power(19, 31.4))  # 19 teeth at 300 rpm
        12159
        """
        if teeth < 1:
            raise ParameterError(f"teeth = {teeth}, must be positive", "teeth", "at least 1")
        if not math.isfinite(speed):
            raise ParameterError(f"speed = {speed}, must be finite", "speed", "finite [rad/s]")
        return self._inner.rated_power(chain, teeth, speed)

    def profile(self, name: str, *, settled: bool = True) -> Profile:
        """Return the whole profile of a sprocket or guide in its place.

        Parameters
        ----------
        name
            A sprocket, or a guide, shoes of tensioners among them. Where both have the name, the
            sprocket is meant.
        settled
            Where it stands at the start of a run; otherwise where it stands when the chain has
            been laid, before gravity and load move anything, which takes no time.

        Raises
        ------
        ParameterError
            No sprocket or guide has this name.
        AssemblyError
            The drive does not close or settle.
        """
        return Profile._of(self._inner.profile(name, settled), name)

    def svg(self, *, settled: bool = True) -> str:
        """Return the drive as it stands at the start, as the text of an SVG file.

        Coordinates are millimetres of the drive, x to the right and y upwards. Every part has an
        ``id``, such as ``sprocket-crank``, ``guide-shoe``, ``roller-17`` or ``plate-17``. A drive
        that does not assemble is drawn as it is laid, with gaps and clashes marked.

        Parameters
        ----------
        settled
            Whether the chain hangs and stretches as in static equilibrium, or lies as it was laid.
        """
        return self._inner.figure(settled, 0.0).svg(self.title or self.name)

    fmu = fmu.export

    def __repr__(self) -> str:
        return data_sheet.text(self.name, self.title, self._rows())

    def _repr_html_(self) -> str:
        return data_sheet.html(self.name, self.title, self._rows(), self._repr_svg_())

    def _repr_svg_(self) -> str:
        # As it is laid, which takes milliseconds for any drive.
        return self.svg(settled=False)

    def _rows(self) -> list[data_sheet.Row]:
        return data_sheet.rows(self.resolved().to_dict())

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Drive) and (self.name, self.text) == (other.name, other.text)

    def __hash__(self) -> int:
        return hash((self.name, self.text))

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"a Drive does not change; see Drive.replace for {name!r}")

    def __reduce__(self) -> tuple[Callable[[str, str], Drive], tuple[str, str]]:
        return _from_text, (self.text, self.name)


class Description(dict[str, Any]):
    """Facts about a drive in SI units; prints as a text."""

    def __init__(self, facts: Mapping[str, Any], text: str) -> None:
        super().__init__(facts)
        self._text = text

    def __str__(self) -> str:
        return self._text

    __repr__ = __str__


class Difference(NamedTuple):
    """A value that two drives do not have in common."""

    path: str
    """Place in the scenes, with entries of lists by name."""
    first: str | None
    """Value of the first drive, in SI units; None for nothing."""
    second: str | None
    """Value of the second drive, likewise."""


def diff(
    first: Drive | xr.Dataset | str | PathLike[str],
    second: Drive | xr.Dataset | str | PathLike[str],
) -> list[Difference]:
    """Return what differs between two drives, defaults included.

    Parameters
    ----------
    first, second
        Drives, results of `simulate`, or paths of scenes or results.

    Returns
    -------
    list of Difference
        Empty when both are the same drive, however their scenes are written.

    Raises
    ------
    SceneError
        A path that cannot be read, or a result that carries no scene.

    Examples
    --------
    >>> import chaindrive as cd
    >>> ring = cd.scenes.spinning_ring()
    >>> cd.diff(ring, ring.replace({"chain.links": 24}))
    [Difference(path='chain.links', first='20', second='24')]
    """
    return [Difference(*told) for told in _core.diff(_drive(first), _drive(second))]


def _drive(of: Drive | xr.Dataset | str | PathLike[str]) -> _core.Drive:
    return of._inner if isinstance(of, Drive) else load(of)._inner


def load(source: str | PathLike[str] | xr.Dataset) -> Drive:
    """Read a scene file, TOML or JSON, or the scene of a result.

    Parameters
    ----------
    source
        The file; or a result, in memory or as a Zarr folder: its drive with every default written
        out, so that it computes the same.

    Returns
    -------
    Drive

    Raises
    ------
    SceneError
        The file cannot be read, or with everything that is wrong in it; a dataset without a scene.

    Examples
    --------
    >>> import chaindrive as cd
    >>> run = cd.simulate(cd.scenes.spinning_ring(), until=1e-3)
    >>> cd.load(run).links
    20
    """
    # Not by its class: xarray takes half a second to import.
    attributes = getattr(source, "attrs", None)
    if attributes is None:
        return Drive._of(_core.Drive.read(fspath(cast("str | PathLike[str]", source))))
    text = attributes.get("resolved_scene", attributes.get("scene"))
    if text is None:
        raise SceneError(
            "the dataset carries no scene; give what `simulate`, `sweep` or `open_result` returned"
        )
    return _from_text(text, attributes.get("scene_name", "result"))


def schema() -> dict[str, Any]:
    """Return the JSON Schema of scene files (draft 2020-12), for editors and programs."""
    return cast("dict[str, Any]", json.loads(_core.schema()))


def _needed(drive: object) -> None:
    """Refuse what is not a drive, such as the name of a preset."""
    if not isinstance(drive, Drive):
        needed = "a Drive: chaindrive.load(path), or one of chaindrive.scenes"
        raise TypeError(f"the drive is {type(drive).__name__} {drive!r}, needed is {needed}")


def _number(drive: Drive, name: str, value: Quantity | None) -> float | None:
    """Return a setting of a run in SI units; a text is read as the scene reads it."""
    value = with_unit(value)
    if isinstance(value, str):
        return cast("float", drive.replace({f"run.{name}": value}).run_defaults[name])
    return cast("float | None", value)


def _from_text(text: str, name: str) -> Drive:
    return Drive._of(_core.Drive.from_text(text, name))
