"""A controller at 1 kHz holds the speed of a large chain drive by the torque on its crank.

The drive starts at rest with a crank that is free to turn. Every millisecond the controller reads
the speed, and sets the torque that a PI law asks for; in the middle of the run the load doubles.

Run it as ``python examples/speed_controller.py [--until SECONDS] [--results FOLDER]``.
"""

import argparse
from pathlib import Path

import matplotlib as mpl
import numpy as np

import chaindrive as cd

PERIOD = 1e-3  # s
WANTED = -100.0 * 2.0 * np.pi / 60.0  # rad/s, clockwise
PROPORTIONAL, INTEGRAL = 3.0e4, 3.0e5  # N m s, N m
LARGEST = 60e3  # N m
LOAD = 5e3  # N m, added in the middle of the run


def free_drive() -> cd.Drive:
    """Return the two-sprocket drive with a crank that a torque turns."""
    scene = cd.scenes.marine_two_sprockets().to_dict()
    crank, camshaft = scene["sprockets"]
    del crank["motion"]
    crank["inertia"] = "500 kg m^2"
    camshaft["load"] = [{"kind": "resistance", "linear": 300.0}]  # N m s
    return cd.Drive.from_dict(scene, "two sprockets, free crank")


def controlled(drive: cd.Drive, until: float) -> np.ndarray:
    """Return time [s], speed [rad/s] and torque [N m] of every period of the controller."""
    simulation = cd.Simulation(drive)
    simulation.set_torque("camshaft", LOAD, at=until / 2.0)
    view = simulation.view("sprocket_speed")
    speeds, crank = view["sprocket_speed"], view.labels["sprocket_speed"].index("crank")
    rows = []
    integral = 0.0
    for k in range(round(until / PERIOD) + 1):
        simulation.advance_to(k * PERIOD)
        speed = float(speeds[crank])
        error = WANTED - speed
        torque = PROPORTIONAL * error + INTEGRAL * integral
        if abs(torque) < LARGEST:
            integral += error * PERIOD  # not while the torque is at its limit
        torque = min(max(torque, -LARGEST), LARGEST)
        simulation.set_torque("crank", torque)
        rows.append((simulation.time, speed, torque))
    return np.array(rows)


def main() -> None:
    parser = argparse.ArgumentParser(description="Control the speed of a chain drive.")
    parser.add_argument("--until", type=float, default=1.5, help="end of the run [s]")
    parser.add_argument("--results", type=Path, default=Path("results"), help="folder to write to")
    arguments = parser.parse_args()
    arguments.results.mkdir(parents=True, exist_ok=True)

    time, speed, torque = controlled(free_drive(), arguments.until).T
    print(f"speed at the end {speed[-1] * 30.0 / np.pi:.2f} rpm, torque {torque[-1]:.0f} N m")
    mpl.use("Agg")
    from matplotlib import pyplot as plt

    figure, (above, below) = plt.subplots(2, sharex=True, figsize=(8, 6), layout="constrained")
    above.plot(time, speed * 30.0 / np.pi)
    above.axhline(WANTED * 30.0 / np.pi, color="grey", linewidth=0.8)
    above.set_ylabel("crank speed [rpm]")
    below.plot(time, torque)
    below.set(ylabel="torque [N m]", xlabel="time [s]")
    figure.savefig(arguments.results / "speed_controller.png", dpi=110)


if __name__ == "__main__":
    main()
