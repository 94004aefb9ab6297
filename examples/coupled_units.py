"""The valve drive in two stages, cut at its intermediate shaft into two functional mock-up units.

Compares couplings of the two with the whole drive: means of the tensions, motion over the first
2 ms, and the energy that goes astray. Needs fmpy: ``pip install fmpy``.
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

import fmpy
import matplotlib.pyplot as plt
import numpy as np
from fmpy.fmi3 import FMU3Slave

import chaindrive as cd

SHAFT = "intermediate"
"""Sprocket of the first stage on the shaft that is cut."""
PINION = "pinion"
"""Sprocket of the second stage on it."""

HELD, LINEAR = 1, 2
ANGLE = 4

GIVEN_UP = 1e4
"""Energy [J] at which nobody waits for the end."""


def stages() -> tuple[cd.Drive, cd.Drive, cd.Drive]:
    """Return the whole drive, and its two stages.

    The shaft with all its inertia and the oil pump stays in the first: only the torque of the
    second chain on the pinion crosses the cut, and the angle of the shaft the other way.
    """
    whole = cd.scenes.two_stage_timing().replace({"settle": False})
    scene = whole.to_dict()

    def part(chain: str, sprockets: set[str], arms: set[str]) -> dict:
        kept = {"guides": arms | {it.replace("arm", "rail") for it in arms}}
        kept["guides"] |= {it.replace("arm", "shoe") for it in arms}
        made = {key: value for key, value in scene.items() if key != "shafts"}
        made["chains"] = [it for it in scene["chains"] if it["name"] == chain]
        made["sprockets"] = [dict(it) for it in scene["sprockets"] if it["name"] in sprockets]
        made["guides"] = [it for it in scene["guides"] if it["name"] in kept["guides"]]
        made["tensioners"] = [it for it in scene["tensioners"] if it["name"] in arms]
        return made

    first = part("primary", {"crank", SHAFT}, {"lower arm"})
    second = part("secondary", {PINION, "camshaft"}, {"upper arm"})
    shaft = next(it for it in first["sprockets"] if it["name"] == SHAFT)
    pinion = next(it for it in second["sprockets"] if it["name"] == PINION)
    (axle,) = scene["shafts"]
    inertias = [shaft["inertia"], pinion.pop("inertia"), axle["inertia"]]
    shaft["inertia"] = sum(float(it.split()[0]) for it in inertias)
    shaft["load"] = axle["load"]
    crank = next(it for it in scene["sprockets"] if it["name"] == "crank")
    ratio = crank["teeth"] / shaft["teeth"]
    speed = float(crank["motion"]["speed"].split()[0]) * ratio
    pinion["motion"] = {"kind": "constant", "speed": f"{speed} rpm"}
    return whole, cd.Drive.from_dict(first, "first"), cd.Drive.from_dict(second, "second")


class Unit:
    """An instance of a unit by the names of its variables."""

    def __init__(self, folder: Path) -> None:
        description = fmpy.read_model_description(str(folder))
        self.reference = {it.name: it.valueReference for it in description.modelVariables}
        self.slave = FMU3Slave(
            guid=description.instantiationToken,
            modelIdentifier=description.coSimulation.modelIdentifier,
            unzipDirectory=str(folder),
            instanceName=folder.name,
        )
        self.slave.instantiate()

    def get(self, name: str) -> float:
        """Read a number."""
        return self.slave.getFloat64([self.reference[name]])[0]

    def set(self, name: str, value: float) -> None:
        """Set an input."""
        self.slave.setFloat64([self.reference[name]], [value])

    def choose(self, name: str, value: int) -> None:
        """Set an enumeration."""
        self.slave.setInt64([self.reference[name]], [value])

    def start(self) -> None:
        """Begin at the time zero."""
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()

    def end(self) -> None:
        """End and free the instance."""
        self.slave.terminate()
        self.slave.freeInstance()


def coupled(
    folders: tuple[Path, Path],
    step: float,
    until: float,
    courses: tuple[int, int],
    names: list[str],
    *,
    waits: bool = False,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Move both units with one exchange a step.

    Neither waits for the other; or the second `waits` for the step of the first, and has its
    angle at the end. Returns times, values (time, name), and ``coupling_energy_error`` (time,).
    """
    first, second = (Unit(folder) for folder in folders)
    for unit, course in zip((first, second), courses, strict=True):
        unit.choose("extrapolation", course)
        unit.start()
    second.choose(f"input[{PINION}]", ANGLE)
    owner = [first if name in first.reference else second for name in names]
    times, values, energy = [], [], []
    try:
        for index in range(round(until / step)):
            time = index * step
            angle = first.get(f"sprocket_angle[{SHAFT}]")
            first.set(f"set_torque[{SHAFT}]", second.get(f"sprocket_torque[{PINION}]"))
            first.slave.doStep(time, step)
            if waits:
                angle = first.get(f"sprocket_angle[{SHAFT}]")
            second.set(f"set_angle[{PINION}]", angle)
            second.slave.doStep(time, step)
            times.append(time + step)
            values.append([unit.get(name) for unit, name in zip(owner, names, strict=True)])
            energy.append(sum(unit.get("coupling_energy_error") for unit in (first, second)))
            if not abs(energy[-1]) < GIVEN_UP:
                break
    except fmpy.fmi1.FMICallException:
        pass  # The motion of a coupling that is not stable ends.
    first.end()
    second.end()
    return np.array(times), np.array(values), np.array(energy)


WAYS = {
    "both at once, held": ((HELD, HELD), False),
    "both at once, linear": ((LINEAR, LINEAR), False),
    "one after the other, held": ((HELD, HELD), True),
    "one after the other, torque linear": ((LINEAR, HELD), True),
}
"""Courses of the torque and of the angle, and whether the second waits for the first."""

FIRST = "sprocket_speed[camshaft]"
"""What is compared over the first milliseconds."""


def units(folder: Path, *drives: cd.Drive) -> tuple[Path, ...]:
    """Write units of drives and unpack them, as an importer does."""
    unpacked = []
    for drive in drives:
        unit = drive.fmu(folder / f"{drive.name}.fmu", run=False)
        unpacked.append(Path(fmpy.extract(str(unit), str(folder / drive.name))))
    return tuple(unpacked)


def speeds(whole: cd.Drive, every: float, until: float) -> np.ndarray:
    """Return the speed of the camshaft of the whole drive [rad/s]."""
    run = cd.simulate(whole, until=until, every=every, run_in="0 s", record="sprocket_speed")
    return run["sprocket_speed"].sel(sprocket="camshaft").values[1:]


def means(whole: cd.Drive, begin: float, until: float) -> tuple[list[str], np.ndarray]:
    """Return names and means of the span tensions of the whole drive [N]."""
    run = cd.simulate(whole, until=until, every=1e-5, run_in="0 s", record="span_tension")
    names = [f"span_tension[{span}]" for span in run["span"].values]
    return names, run["span_tension"].sel(time=slice(begin, None)).mean("time").values


def draw(steps: tuple[float, ...], table: dict[str, np.ndarray], path: Path) -> None:
    """Draw the errors of the speed and of the means over the step, a line for every coupling."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4), layout="constrained")
    for name, errors in table.items():
        left.loglog(1e6 * np.array(steps), errors[:, 0], "o-", label=name)
        right.loglog(1e6 * np.array(steps), 100 * errors[:, 1], "o-")
    left.set(xlabel="exchange step [µs]", ylabel="speed of the camshaft, rms error [rad/s]")
    left.legend(fontsize="small")
    right.axhline(0.1, color="0.7", linewidth=1)
    right.set(xlabel="exchange step [µs]", ylabel="mean span tensions, largest error [%]")
    for axes in (left, right):
        axes.set_xticks([1e6 * step for step in steps], [f"{1e6 * step:.0f}" for step in steps])
        axes.minorticks_off()
        axes.grid(alpha=0.3)
    figure.savefig(path, dpi=110)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--until", type=float, default=0.24, help="end of the means [s]")
    parser.add_argument("--results", type=Path, default=Path("results"))
    given = parser.parse_args()
    given.results.mkdir(parents=True, exist_ok=True)
    whole, first, second = stages()
    begin = given.until / 6
    names, reference = means(whole, begin, given.until)
    every, early, steps = 40e-6, 2e-3, (40e-6, 20e-6, 10e-6, 5e-6)
    exact = speeds(whole, every, early)
    print(f"{'coupling':36}{'step':>8}{'speed':>12}{'means':>11}{'energy':>10}")
    table = {}
    with tempfile.TemporaryDirectory() as folder:
        pair = units(Path(folder), first, second)
        for name, (courses, waits) in WAYS.items():
            errors = []
            for step in steps:
                _, motion, _ = coupled(pair, step, early, courses, [FIRST], waits=waits)
                stride = round(every / step)
                off = np.sqrt(np.mean((motion[stride - 1 :: stride, 0] - exact) ** 2))
                times, tension, energy = coupled(
                    pair, step, given.until, courses, names, waits=waits
                )
                mean = tension[times >= begin].mean(axis=0)
                errors.append([off, np.abs(mean / reference - 1).max()])
                print(
                    f"{name:36}{step * 1e6:5.0f} µs{off:7.4f} rad/s"
                    f"{100 * errors[-1][1]:8.3f} %{energy[-1]:9.2f} J"
                )
            table[name] = np.array(errors)
        for step in (80e-6, 160e-6, 320e-6):
            times, _, energy = coupled(pair, step, 0.02, (HELD, HELD), [FIRST])
            print(f"held, {step * 1e6:.0f} µs: {energy[-1]:.0f} J after {times[-1] * 1e3:.1f} ms")
    draw(steps, table, given.results / "coupled_units.png")


if __name__ == "__main__":
    main()
