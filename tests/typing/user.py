"""What a type checker says to a user's program; `make check` runs it, nothing else does.

Every `type: ignore` is a mistake that must be found: mypy complains of those that it does not need.
"""

from typing import assert_type

import xarray as xr

import chaindrive as cd

drive = cd.scenes.marine_engine()
assert_type(drive, cd.Drive)
assert_type(cd.load("drive.toml").replace({"chain.links": 124}), cd.Drive)
assert_type(cd.simulate(drive, until="20 ms", record=["span_tension", "roller_x"]), xr.Dataset)
assert_type(cd.simulate(drive, record="all", method="verlet", accuracy_of="losses"), xr.Dataset)
assert_type(cd.channels()["span_tension"].unit, str)
assert_type(cd.__build__, str)
assert_type(cd.__version__, str)
cd.simulate(drive, record=list(cd.channels()))

settings: cd.settings.RunSettings = {"until": 0.1, "events": ["teeth", "joints"]}
cd.simulate(drive, **settings)
steel = cd.law("power", stiffness=6e11, exponent=1.5, dissipation="hunt-crossley", restitution=0.8)
assert_type(steel, cd.Law)
run = cd.simulate(drive)
assert_type(cd.replay(run), cd.Replay)
cd.replay(run, plot=["span_tension"]).save("run.html")
assert_type(cd.load(run), cd.Drive)
cd.friction("coulomb", coefficient=0.1, slip_speed="5 cm/s")
flange = cd.measurement.Sensor("sprocket_torque[driver]", gain_uncertainty=0.002)
data = cd.measured("rig.csv", channels={"flange": flange}, turns={"driver": "300 rpm"})
assert_type(cd.compare(run, data), xr.Dataset)
assert_type(cd.check_data(drive, data, free={"chain.stiffness": (1e8, "200 MN/m")}), xr.Dataset)

cd.simulate(drive, method="euler")  # type: ignore[arg-type]
cd.simulate(drive, record="span_tensions")  # type: ignore[arg-type]
cd.simulate(drive, events=["tooth"])  # type: ignore[list-item]
cd.friction("columb", coefficient=0.1)  # type: ignore[arg-type]
cd.scenes.marine_engin()  # type: ignore[attr-defined]
cd.simulat(drive)  # type: ignore[attr-defined]
faulty: cd.settings.RunSettings = {"untill": 0.1}  # type: ignore[typeddict-unknown-key]
