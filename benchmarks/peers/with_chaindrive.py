"""The marine drive in chaindrive, from Python as a user would."""

import time

import chaindrive as cd
from drive_data import scene
from measure import EVERY, Result


def run(method, step, until, every=EVERY, onset_depth=None):
    """Simulate.

    The CPU time of assembling the drive, measured by a run of no length, is taken off.
    """
    drive = scene()
    settings = {"every": every, "record": "link_tension", "method": method, "step": step}
    settings |= {"onset_depth": onset_depth, "error": False}
    begin = time.process_time()
    cd.simulate(drive, until=1e-9, **settings)
    assembled = time.process_time()
    result = cd.simulate(drive, until=until, **settings)
    cpu = time.process_time() - assembled - (assembled - begin)
    facts = result.attrs
    tension = result["link_tension"].values
    return Result(tension, cpu, facts["steps"], facts["evaluations"], until)
