"""A worn chain that jumps the teeth of an overloaded wheel, and lands again.

The marine engine without guides, its chain worn by 3 %, its tensioner wheel moved out until the
chain closes. The idler, which three pitches wrap, is braked for 20 ms: its slack side goes slack,
rollers climb its teeth, pass the tips and fall into the next gaps.

    python tests/hard_cases/tooth_jump.py    # draws docs/tooth_jump.png and prints what happened
"""

from pathlib import Path

import numpy as np

import chaindrive as cd
from chaindrive.pose import at_start

PULSE = (0.05, 0.06, 0.08, 0.09)  # begin, full, still full, end of the overload [s]
UNTIL = 0.4
EVERY = 2e-4
WEAR = 0.03
OVERLOAD = 20e3  # [N m]
CHANNELS = [
    "span_tension",
    "link_tension",
    "sprocket_angle",
    "sprocket_speed",
    "contact_force",
    "roller_x",
    "roller_y",
    "energy_residual",
]


def drive(overload=OVERLOAD, wear=WEAR):
    """Return the drive with a brake torque of `overload` [N m] on the idler."""
    scene = cd.scenes.marine_engine_bare().to_dict()
    direction = scene["tensioners"][0]["carrier"]["direction"]
    del scene["guides"], scene["tensioners"]
    torques = [0, 0, overload, overload, 0]
    for sprocket in scene["sprockets"]:
        sprocket.pop("support", None)
        sprocket.pop("mass", None)
        if sprocket["name"] == "idler":
            brake = {"kind": "time-table", "times": [0, *PULSE], "torques": torques}
            sprocket["load"] = [brake]
        if sprocket["name"] == "camshaft":
            sprocket["load"] = [{"kind": "constant", "torque": "1 kN m"}]
        if sprocket["name"] == "crank":
            sprocket["motion"] = {"kind": "constant", "speed": "-60 rpm"}
    scene["chain"]["elongation"] = wear
    scene["route"]["pretension"] = "2 kN"
    adjust = {"kind": "sprocket", "name": "tensioner", "direction": direction, "within": 0.2}
    scene["route"]["adjust"] = adjust
    return cd.Drive.from_dict(scene, name="tooth_jump")


def run(drive, **settings):
    """Simulate."""
    return cd.simulate(drive, until=UNTIL, every=EVERY, record=CHANNELS, **settings)


def behind(drive, run):
    """Pitches by which the idler has stayed behind the crank since the start, (time,).

    It moves about a constant while chain and wheels mesh; a jump adds a whole number.
    """
    teeth = {s["name"]: s["teeth"] for s in drive.to_dict()["sprockets"]}
    turned = {
        name: run["sprocket_angle"].sel(sprocket=name).values * z / (2 * np.pi)
        for name, z in teeth.items()
    }
    # Both turn clockwise, with negative angles.
    return turned["idler"] - turned["crank"]


def shift(drive, run, before, after):
    """By how many gaps the rollers on the idler sit further after than before, from their places.

    While a chain meshes, number of the gap less number of the roller is the same for every roller
    on the wheel, at every time: the two counts are taken modulo the number of teeth and compared.
    """
    near = None
    registers = []
    for at in (before, after):
        register, near = _register(drive, run, at, near)
        registers.append(register)
    teeth = drive.to_dict()["sprockets"][3]["teeth"]
    gaps = (registers[1] - registers[0]) % teeth
    return int(gaps - teeth if gaps > teeth / 2 else gaps)


def _register(drive, run, at, near):
    """Gap less roller on the idler, and the roller; beyond the last one they count on."""
    wheel = drive.to_dict()["sprockets"][3]
    teeth, centre = wheel["teeth"], [float(text.split()[0]) for text in wheel["centre"]]
    now = run.sel(time=at, method="nearest")
    away = np.stack([now["roller_x"].values, now["roller_y"].values], axis=1) - centre
    pitch_radius = 0.0889 / (2 * np.sin(np.pi / teeth))
    # Worn links ride outside the pitch circle by as much as they are longer.
    ride = 1 + drive.to_dict()["chain"]["elongation"]
    on = np.flatnonzero(np.abs(np.hypot(*away.T) / pitch_radius - ride) < 0.03)
    if len(on) < 2:
        raise ValueError(f"at {at} s {len(on)} rollers lie on the idler, needs two")
    # Gap axes of the laid chain: rollers of the drawing sit in them exactly.
    laid = at_start(drive, settled=False)
    from_centre = laid["chains"][0]["rollers"] - laid["sprockets"]["idler"]["centre"]
    seat = from_centre[np.abs(np.hypot(*from_centre.T) - pitch_radius) < 0.02 * pitch_radius]
    origin = np.arctan2(seat[len(seat) // 2, 1], seat[len(seat) // 2, 0])
    angle = np.arctan2(away[on, 1], away[on, 0]) - now["sprocket_angle"].values[3] - origin
    near = on[0] if near is None else near
    links = run.sizes["roller"]
    number = near + (on - near + links // 2) % links - links // 2
    register = angle * teeth / (2 * np.pi) - number
    # One number for all, but for the play in the gaps.
    mean = np.exp(2j * np.pi * register / teeth).mean()
    if abs(mean) < 0.99:
        raise ValueError(f"at {at} s the rollers on the idler do not sit in consecutive gaps")
    return int(np.rint(np.angle(mean) * teeth / (2 * np.pi))), int(number[0])


def last_tension(run, share=0.25):
    """Mean tension of all links over the last part of a run [N]."""
    tension = run["link_tension"].values
    return float(tension[-round(share * len(tension)) :].mean())


def draw(file):
    """Draw tension, lag and force of the worn chain and of a new one."""
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    _, axes = plt.subplots(3, 1, figsize=(9, 8), sharex=True)
    for wear, overload in [(WEAR, OVERLOAD), (WEAR, 1.5 * OVERLOAD), (0.0, OVERLOAD)]:
        model = drive(overload, wear)
        result = run(model)
        time = 1e3 * result["time"].values
        label = f"wear {100 * wear:.0f} %, brake {overload / 1e3:.0f} kN m"
        axes[0].plot(time, behind(model, result), label=label)
        axes[1].plot(time, 1e-3 * result["link_tension"].mean("link").values, lw=0.7)
        axes[2].plot(time, result["sprocket_speed"].sel(sprocket="idler").values, lw=0.8)
        gaps = shift(model, result, 0.045, UNTIL - 0.01)
        lag = behind(model, result)[-100:].mean()
        print(
            f"{label}: {gaps} gaps further, {lag:.2f} pitches behind, {last_tension(result):.0f} N"
        )
    axes[0].set_ylabel("idler behind crank [pitches]")
    axes[0].legend(fontsize=8)
    axes[1].set_ylabel("mean link tension [kN]")
    axes[2].set_ylabel("speed of the idler [rad/s]")
    axes[2].set_xlabel("time [ms]")
    for axis in axes:
        axis.axvspan(1e3 * PULSE[0], 1e3 * PULSE[-1], color="0.92")
        axis.grid(alpha=0.3)
    plt.tight_layout()
    plt.savefig(file, dpi=80)


if __name__ == "__main__":
    draw(Path(__file__).resolve().parents[2] / "docs" / "tooth_jump.png")
