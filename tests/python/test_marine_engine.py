"""The marine engine as an engineer would look at it: spans that bear, rollers that seat."""

import numpy as np
import xarray as xr

import chaindrive as cd

#: A turn of crank and camshaft [s].
TURN = 60 / 127


def share_at(power: np.ndarray, orders: list[int], turns: int) -> float:
    """Share of the power of a spectrum over some turns at whole orders of the shafts."""
    return sum(power[turns * order] for order in orders) / power[1:].sum()


def test_the_tension_follows_crank_cams_and_teeth() -> None:
    turns, samples = 4, 2048
    run = cd.simulate(
        cd.scenes.marine_engine(),
        run_in=4 * TURN,
        until=turns * TURN,
        every=TURN / samples,
        record="span_tension",
        error=False,
    )
    tension = run["span_tension"].values[:-1]
    assert (tension > 2e3).all(), "no span goes slack"
    power = np.abs(np.fft.rfft(tension, axis=0)) ** 2
    tight = power[:, int(tension.mean(0).argmax())]
    # All that moves repeats with a turn: teeth, cylinders, orders 4 and 7 of the crank.
    assert share_at(tight, list(range(1, samples // 2)), turns) > 0.98
    assert share_at(tight, [7, 14, 21], turns) > 0.8, "fuel pumps and exhaust valves"
    nearby = np.median(tight[turns : 120 * turns])
    for order, of in [(4, "blades"), (7, "cylinders"), (48, "teeth"), (96, "twice the teeth")]:
        assert tight[turns * order] > 1e3 * nearby, of


def contacts_a_seating(run: xr.Dataset) -> np.ndarray:
    """Contacts of each roller with a wheel, from seating to leaving, of whole passages."""
    keys = zip(run["event_roller"].values, run["event_body"].values, strict=True)
    starts = run["event_start"].values
    passages: dict[tuple[int, int], list[float]] = {}
    for key, start in zip(keys, starts, strict=True):
        passages.setdefault(key, []).append(start)
    found = []
    for times in passages.values():
        # A roller is away from a wheel for longer than from its seat.
        for passage in np.split(np.sort(times), np.flatnonzero(np.diff(np.sort(times)) > 0.05) + 1):
            if passage[0] > starts.min() + 0.05 and passage[-1] < starts.max() - 0.05:
                found.append(len(passage))
    return np.array(found)


def test_rollers_seat_and_stay_under_constant_loads() -> None:
    run = cd.simulate(
        cd.scenes.marine_engine().replace(
            {
                "sprockets.camshaft.load": [{"kind": "constant", "torque": "3.75 kN m"}],
                "sprockets.crank.motion": {"kind": "constant", "speed": "-127 rpm"},
            }
        ),
        run_in="1 s",
        until="1 s",
        every="0.1 ms",
        record=["span_tension", "contact_force"],
        events=["teeth"],
        error=False,
    )
    tension = run["span_tension"]
    scatter = (tension.std("time") / tension.mean("time")).values
    highest = int(tension.values.mean(0).argmax())
    assert scatter[highest] < 0.13
    assert (np.delete(scatter, highest) < 0.20).all()
    seatings = contacts_a_seating(run)
    assert len(seatings) > 200
    assert np.median(seatings) <= 5
    force = run["contact_force"].values
    force = force[force > 0]
    assert np.quantile(force, 0.999) < 10 * np.median(force)
