"""Cost of stepping from outside: ``python benchmarks/live``.

Three figures, each a median of pairs that are interleaved:

- time beyond the step from ``advance(1)`` to fresh values of five channels;
- a controller at 1 kHz over `simulate` with the same torque as a table, processor time;
- throughput of `step_many` over that of one simulation after the other.
"""

import statistics
import time
from collections.abc import Callable

import numpy as np

import chaindrive as cd

CHANNELS = ["span_tension", "sprocket_speed", "sprocket_angle", "sprocket_torque", "link_tension"]
PERIOD = 1e-3  # s


def paired(first: Callable[[], float], second: Callable[[], float], pairs: int) -> list[float]:
    """Return first over second of every pair, in turn."""
    return [first() / second() for _ in range(pairs)]


def quartiles(values: list[float]) -> str:
    low, middle, high = np.percentile(values, [25, 50, 75])
    return f"{middle:.3f} ({low:.3f} to {high:.3f})"


def beyond_the_step(steps: int = 20_000, pairs: int = 21) -> tuple[float, float, float]:
    """Return µs of a bare step in one call, and beyond it without and with energies in the view."""
    drive = cd.scenes.industrial_16b()
    bare = cd.Simulation(drive)
    lean, full = cd.Simulation(drive), cd.Simulation(drive)
    lean.view(CHANNELS)
    full.view([*CHANNELS[:4], "energy_residual"])
    starts = [it.snapshot() for it in (bare, lean, full)]

    def each(simulation: cd.Simulation, start: cd.Snapshot) -> float:
        simulation.restore(start)
        begin = time.perf_counter()
        for _ in range(steps):
            simulation.advance()
        return (time.perf_counter() - begin) / steps * 1e6

    def whole() -> float:
        bare.restore(starts[0])
        begin = time.perf_counter()
        bare.advance(steps)
        return (time.perf_counter() - begin) / steps * 1e6

    rows = [(whole(), each(lean, starts[1]), each(full, starts[2])) for _ in range(pairs)]
    bases, leans, fulls = (list(column) for column in zip(*rows, strict=True))
    beyond = [
        statistics.median(a - b for a, b in zip(them, bases, strict=True))
        for them in (leans, fulls)
    ]
    return statistics.median(bases), beyond[0], beyond[1]


def controller(until: float = 0.5, pairs: int = 21) -> list[float]:
    """Return processor time of a controller over that of the same torque as a table."""
    scene = cd.scenes.industrial_16b().to_dict()
    driver = scene["sprockets"][0]
    wanted = cd.Simulation(cd.scenes.industrial_16b()).view("sprocket_speed")["sprocket_speed"][0]
    del driver["motion"]
    driver["inertia"] = "0.5 kg m^2"
    driver["speed"] = f"{wanted} rad/s"
    free = cd.Drive.from_dict(scene, "free driver")
    times = np.arange(round(until / PERIOD)) * PERIOD
    shaft = driver["name"]

    def loop() -> np.ndarray:
        torques = []
        simulation.restore(start)
        speed = simulation.view("sprocket_speed")["sprocket_speed"]
        for t in times.tolist():
            simulation.advance_to(t)
            torque = 40.0 * (wanted - float(speed[0]))
            simulation.set_torque(shaft, torque)
            torques.append(torque)
        simulation.advance_to(until)
        return np.array(torques)

    simulation = cd.Simulation(free)
    start = simulation.snapshot()
    torques = loop()
    # The same torque in steps: every knot twice, a nanosecond apart.
    knots = np.column_stack([times, times + PERIOD - 1e-9]).ravel()
    table = {
        "kind": "time-table",
        "times": knots.tolist(),
        "torques": np.repeat(torques, 2).tolist(),
    }
    scene["sprockets"][0]["drive"] = [table]
    tabled = cd.Simulation(cd.Drive.from_dict(scene, "torque as a table"))
    tabled_start = tabled.snapshot()

    def live() -> float:
        begin = time.process_time()
        loop()
        return time.process_time() - begin

    def told() -> float:
        tabled.restore(tabled_start)
        begin = time.process_time()
        tabled.advance_to(until)
        return time.process_time() - begin

    return paired(live, told, pairs)


def throughput(count: int = 16, until: float = 0.1, pairs: int = 7) -> list[float]:
    """Return throughput of many at once over one after the other."""
    many = [cd.Simulation(cd.scenes.industrial_16b()) for _ in range(count)]
    starts = [simulation.snapshot() for simulation in many]

    def back() -> None:
        for simulation, start in zip(many, starts, strict=True):
            simulation.restore(start)

    def one_by_one() -> float:
        back()
        begin = time.perf_counter()
        for simulation in many:
            simulation.advance_to(until)
        return time.perf_counter() - begin

    def at_once() -> float:
        back()
        begin = time.perf_counter()
        cd.step_many(many, until)
        return time.perf_counter() - begin

    return paired(one_by_one, at_once, pairs)


def main() -> None:
    print(cd.simulate(cd.scenes.spinning_ring(), until=1e-5, error=False).attrs["instruction_set"])
    step, lean, full = beyond_the_step()
    print(f"a step {step:.2f} µs; beyond it {lean:.2f} µs, with an energy {full:.2f} µs")
    print(f"controller over table {quartiles(controller())}")
    print(f"many at once {quartiles(throughput())} times as much")


if __name__ == "__main__":
    main()
