"""A worn chain that jumps a tooth of an overloaded wheel, and lands again.

The load of the driven wheel of the 16B drive is a pulse: while it lasts the wheel hangs back, the rollers
climb its teeth, pass the tips and fall into the next gaps.
"""

import numpy as np

import chaindrive as cd

PULSE = [0.05, 0.06, 0.08, 0.09]  # begin, full, still full, end of the overload [s]
UNTIL = 0.4


def drive(overload, elongation=0.03, pretension=200.0, teeth=(19, 57)):
    """Return the drive with a load of 300 N m and a pulse of `overload` [N m] on top."""
    scene = cd.scenes.industrial_16b()
    load = [
        {"kind": "constant", "torque": -300.0},
        {"kind": "time-table", "times": [0.0, *PULSE], "torques": [0, 0, -overload, -overload, 0]},
    ]
    adjust = {"kind": "sprocket", "name": "driven", "direction": [1, 0], "within": 0.1}
    return scene.replace(
        {
            "chain.elongation": elongation,
            "route": {"pretension": pretension, "adjust": adjust},
            "sprockets.driven.load": load,
        }
    )


def jumped(run, teeth=(19, 57)):
    """Pitches that the driver has sent round and the driven wheel has not taken, (time,).

    Constant while chain and wheels mesh, except for what gives; a whole number more after a jump.
    """
    turned = run["sprocket_angle"].values * np.array(teeth) / (2 * np.pi)
    return turned[:, 0] - turned[:, 1]


def seats(drive, run, at, sprocket="driven"):
    """Number of the gap in which every seated roller sits, by roller, at a time [s].

    Gaps are counted from the direction of the first one when the chain was laid.
    """
    wheel = drive._inner.drawing(False)["sprockets"][sprocket]
    now = run.sel(time=at, method="nearest")
    index = drive.sprockets.index(sprocket)
    centre = np.array([now["sprocket_x"].values[index], now["sprocket_y"].values[index]])
    away = np.stack([now["roller_x"].values, now["roller_y"].values], axis=1) - centre
    near = np.hypot(*away.T) < wheel["pitch_radius"] + 0.25 * drive_pitch(drive)
    step = 2 * np.pi / wheel["teeth"]
    angle = np.arctan2(away[:, 1], away[:, 0]) - now["sprocket_angle"].values[index]
    return {int(i): int(np.rint(angle[i] / step)) % wheel["teeth"] for i in np.flatnonzero(near)}


def drive_pitch(drive):
    """Pitch of the chain [m]."""
    return drive._inner.drawing(False)["pitch"]
