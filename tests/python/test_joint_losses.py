"""What joints lose, beside wrapping and the waves that engagement sends into the spans."""

import re

import pytest

import chaindrive as cd
from chaindrive.analysis.parts import one_chain, sprockets

FINE = {"method": "implicit-damping", "step": 2e-6}
# Run-in and record [s], that of the marine engine one turn of its camshaft, and the least excess
# over wrapping alone: only where the chain is fast do waves count.
DRIVES = {
    "industrial_16b": (0.2, 0.1, -0.01, {}),
    "marine_two_sprockets": (0.3, 0.6, 0.15, {}),
    "marine_engine": (0.945, 0.4724, 0.15, {}),
    "timing_drive": (0.16, 0.08, 0.13, {}),
    "bicycle": (0.05, 0.1, 0.0, FINE),
}


@pytest.mark.parametrize("name", DRIVES)
def test_joints_lose_what_wrapping_and_waves_cost(name: str) -> None:
    """P = Σ μ κ r T ω + Σ √(T m′)(π v/z)²/3 over the ends of spans, to −12 and +13 %.

    Measured: −7, −3, −11, −2 and −4 %. Waves leave a part of what they carry on teeth and guides:
    in the marine engine teeth of restitution 0.4 lose 0.43 of 5.7 kW.
    """
    run_in, until, excess, settings = DRIVES[name]
    record = ["span_tension", "sprocket_speed", "energy_losses", "energy_flows"]
    run = cd.simulate(
        getattr(cd.scenes, name)(),
        run_in=run_in,
        until=until,
        every=until / 2000,
        record=record,
        error=False,
        **settings,
    )
    chain = one_chain(run, None)
    lost = float(run.drive.losses()["power"].sel(place="joints"))
    tension = run["span_tension"].mean("time")
    speed = abs(run["sprocket_speed"].mean("time"))
    # Both ends of a span, in the order of the route.
    ends = [it for it in sprockets(run) for _ in range(2)]
    ends = ends[1:] + ends[:1]
    wrapping = waves = 0.0
    per_length = chain.mass_per_length
    for index, pull in enumerate(tension.values):
        for end in ends[2 * index : 2 * index + 2]:
            turns = float(speed.sel(sprocket=end))
            wrapping += chain.friction() * chain.pin_diameter() / 2 * pull * turns
            # π v/z = p ω/2
            waves += (pull * per_length) ** 0.5 * (chain.pitch * turns / 2) ** 2 / 3
    assert lost / wrapping - 1 > excess
    assert -0.12 < lost / (wrapping + waves) - 1 < 0.13
    told = re.search(r"sends waves of some ([\d.]+) (k?)W", run.attrs["summary"])
    assert told is not None
    assert float(told[1]) * (1e3 if told[2] else 1.0) == pytest.approx(waves, rel=0.01)
