"""A rider's torque on the cranks of a bicycle, read from the angle of the pedals at 1 kHz.

The legs push hardest where the cranks are level and hardly at all where they stand upright, and
give way as the cranks turn faster: a torque that no table over time has. The chain
feels it as a pull that swells and fades twice a turn.

Run it as ``python examples/rider.py [--until SECONDS] [--results FOLDER]``.
"""

import argparse
from pathlib import Path

import matplotlib as mpl
import numpy as np

import chaindrive as cd

PERIOD = 1e-3  # s
CADENCE = -90.0 * 2.0 * np.pi / 60.0  # rad/s, clockwise
MEAN = -5.0 * 44.0 / 18.0  # N m, what the load of the rear wheel takes at the cranks
# Assumed: level cranks have almost twice the mean torque, and a tenth more speed has none.
SWING = 0.9  # of the mean
YIELDING = 10.0  # of the mean, over the cadence


def ridden() -> cd.Drive:
    """Return the bicycle with cranks that a torque turns."""
    scene = cd.scenes.bicycle().to_dict()
    chainring = scene["sprockets"][0]
    del chainring["motion"]
    chainring["speed"] = f"{CADENCE} rad/s"
    chainring["inertia"] = "0.1 kg m^2"  # legs and cranks: assumed
    return cd.Drive.from_dict(scene, "bicycle with a rider")


def legs(angle: float, speed: float) -> float:
    """Torque on the cranks [N m] at their angle from level [rad] and speed [rad/s]."""
    push = 1.0 + SWING * np.cos(2.0 * angle) - YIELDING * (speed / CADENCE - 1.0)
    return MEAN * max(push, 0.0)


def ride(drive: cd.Drive, until: float) -> np.ndarray:
    """Return time [s], torque [N m], cadence [rad/s] and pull [N] of every period."""
    simulation = cd.Simulation(drive)
    view = simulation.view(["sprocket_angle", "sprocket_speed", "span_tension"])
    angle, speed, tension = view["sprocket_angle"], view["sprocket_speed"], view["span_tension"]
    rows = []
    for k in range(round(until / PERIOD) + 1):
        simulation.advance_to(k * PERIOD)
        torque = legs(angle[0], speed[0])
        simulation.set_torque("chainring", torque)
        rows.append((simulation.time, torque, speed[0], np.ptp(tension)))
    return np.array(rows)


def main() -> None:
    parser = argparse.ArgumentParser(description="Ride a bicycle chain.")
    parser.add_argument("--until", type=float, default=0.4, help="end of the run [s]")
    parser.add_argument("--results", type=Path, default=Path("results"), help="folder to write to")
    arguments = parser.parse_args()
    arguments.results.mkdir(parents=True, exist_ok=True)

    time, torque, speed, pull = ride(ridden(), arguments.until).T
    print(f"cadence {speed.max() * -9.5493:.1f} to {speed.min() * -9.5493:.1f} rpm")
    print(f"pull, tight span less slack span, {pull.min():.0f} to {pull.max():.0f} N")
    mpl.use("Agg")
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(3, sharex=True, figsize=(8, 7), layout="constrained")
    labels = ("torque [N m]", "cadence [rpm]", "pull of the chain [N]")
    for axis, values, label in zip(axes, (torque, speed * -9.5493, pull), labels, strict=True):
        axis.plot(time, values)
        axis.set_ylabel(label)
    axes[-1].set_xlabel("time [s]")
    figure.savefig(arguments.results / "rider.png", dpi=110)


if __name__ == "__main__":
    main()
