"""The marine drive in Exudyn: rigid links of no rotation, spring-dampers, circles on curves.

Written from the documentation of Exudyn's  Its contact of curves and circles wants bodies
with a rotation, so every roller has three coordinates; there are no constraints, because its
explicit solvers, the fastest for this drive, refuse them. The driven crank is a wheel of immense
inertia. Teeth are chords, four a tooth: bottom, two flanks, tip.
"""

import math
import os
import tempfile
import time
from pathlib import Path

import exudyn as exu
import numpy as np
from exudyn.itemInterface import (
    LoadCoordinate,
    LoadMassProportional,
    MarkerBodyMass,
    MarkerBodyRigid,
    MarkerNodeCoordinate,
    MarkerNodeRigid,
    Node1D,
    NodeGenericData,
    NodeRigidBody2D,
    ObjectConnectorSpringDamper,
    ObjectContactCurveCircles,
    ObjectRigidBody2D,
    ObjectRotationalMass1D,
)

from measure import EVERY, Result, link_tension

FLYWHEEL = 1e12  # inertia that stands for a prescribed speed [kg m²]
LOAD = 5e3  # force at which the linear contact sinks as deep as the power law [N]
REBOUND = 0.847  # restitution that Lankarani and Nikravesh's law delivers, asked for 0.8


def chords(drive, wheel, refine):
    """Chords of the wheel [m], (chords, 4): outside of the seat's arc, the exterior on their right.

    The seat is replaced by tangents, so that a roller on the ground of a gap sits where it sits on
    the arc; `refine` further tangents on either side of the lowest point.
    """
    z = wheel["teeth"]
    half = math.radians(60 - 45 / z)
    pitch, radius = drive["chain"]["pitch"], drive["chain"]["roller_radius"]
    seat = drive["seat_radius"]
    height = 0.5 * pitch / math.sin(math.pi / z) - radius + seat
    normals = np.linspace(-half, half, 3 + 2 * refine)
    # Corners of the circumscribed polygon lie between two tangents.
    between = 0.5 * (normals[1:] + normals[:-1])
    stretch = seat / math.cos(0.5 * (normals[1] - normals[0]))
    corners = [(stretch * math.sin(b), height - stretch * math.cos(b)) for b in between]
    # The last tangent is the flank and runs to the tip circle.
    ax, ay = seat * math.sin(half), height - seat * math.cos(half)
    b = ax * math.cos(half) + ay * math.sin(half)
    s = math.sqrt(b * b + wheel["tip_radius"] ** 2 - ax * ax - ay * ay) - b
    tip = (ax + s * math.cos(half), ay + s * math.sin(half))
    # The axis of the gap is y; counter-clockwise about the wheel is from its right tip to its left.
    gap = [tip, *corners[::-1], (-tip[0], tip[1])]
    points = []
    for k in range(z):
        turn = wheel["gap_angle"] + 2 * math.pi * k / z - 0.5 * math.pi
        c, s = math.cos(turn), math.sin(turn)
        points += [(c * x - s * y, s * x + c * y) for x, y in gap]
    rows = [[*start, *end] for start, end in zip(points, points[1:] + points[:1], strict=True)]
    return np.array(rows)


def contact(drive, rows, teeth):
    """Stiffness and damping per length of chord, of a roller on the ground of a gap.

    The force of a chord is its length times (k δ + d δ̇). The linear law meets the power law at
    LOAD, and lets a free roller rebound as the Lankarani–Nikravesh law asked for 0.8 does.
    """
    law = drive["contact"]
    depth = (LOAD / law["stiffness"]) ** (1 / law["exponent"])
    stiffness = LOAD / depth
    # e = exp(−πζ/√(1 − ζ²)),   d = 2 ζ √(k m)
    decrement = -math.log(REBOUND) / math.pi
    ratio = decrement / math.hypot(1, decrement)
    damping = 2 * ratio * math.sqrt(stiffness * drive["chain"]["mass"])
    chords_a_gap = len(rows) // teeth
    start, end = np.split(rows[(chords_a_gap - 1) // 2], 2)  # the lowest of the first gap
    length = math.dist(start, end)
    return stiffness / length, damping / length


def build(drive, refine=0, model=0):
    """Return the assembled system."""
    container = exu.SystemContainer()
    system = container.AddSystem()
    chain = drive["chain"]
    place, velocity = np.array(drive["start"]["place"]), np.array(drive["start"]["velocity"])
    radius, links = chain["roller_radius"], chain["links"]
    centres = []
    for at, moving in zip(place, velocity, strict=True):
        node = system.AddNode(
            NodeRigidBody2D(referenceCoordinates=[*at, 0.0], initialVelocities=[*moving, 0.0])
        )
        body = system.AddObject(
            ObjectRigidBody2D(
                mass=chain["mass"], inertia=0.5 * chain["mass"] * radius**2, nodeNumber=node
            )
        )
        centres.append(system.AddMarker(MarkerNodeRigid(nodeNumber=node)))
        weight = system.AddMarker(MarkerBodyMass(bodyNumber=body))
        gravity = [*drive["gravity"], 0.0]
        system.AddLoad(LoadMassProportional(markerNumber=weight, loadVector=gravity))
    for link in range(links):
        system.AddObject(
            ObjectConnectorSpringDamper(
                markerNumbers=[centres[link], centres[(link + 1) % links]],
                referenceLength=chain["rest_length"][link],
                stiffness=chain["stiffness"],
                damping=chain["damping"],
            )
        )
    for wheel in drive["sprockets"]:
        rotation = system.AddNode(
            Node1D(referenceCoordinates=[0.0], initialVelocities=[wheel["speed"]])
        )
        body = system.AddObject(
            ObjectRotationalMass1D(
                inertia=FLYWHEEL if wheel["prescribed"] else wheel["inertia"],
                nodeNumber=rotation,
                referencePosition=[*wheel["centre"], 0.0],
            )
        )
        if wheel["torque"]:
            angle = system.AddMarker(MarkerNodeCoordinate(nodeNumber=rotation, coordinate=0))
            system.AddLoad(LoadCoordinate(markerNumber=angle, load=wheel["torque"]))
        carrier = system.AddMarker(MarkerBodyRigid(bodyNumber=body, localPosition=[0.0, 0.0, 0.0]))
        rows = chords(drive, wheel, refine)
        stiffness, damping = contact(drive, rows, wheel["teeth"])
        data = system.AddNode(
            NodeGenericData(
                initialCoordinates=[-1.0, 0.0, 0.0] * len(rows),
                numberOfDataCoordinates=3 * len(rows),
            )
        )
        system.AddObject(
            ObjectContactCurveCircles(
                markerNumbers=[carrier, *centres],
                nodeNumber=data,
                circlesRadii=[radius] * links,
                segmentsData=exu.MatrixContainer(rows),
                contactStiffness=stiffness,
                contactDamping=damping,
                contactModel=model,
            )
        )
    system.Assemble()
    return container, system


SOLVERS = {
    "verlet": exu.DynamicSolverType.VelocityVerlet,
    "rk4": exu.DynamicSolverType.RK44,
    "generalized-alpha": exu.DynamicSolverType.GeneralizedAlpha,
}


def run(drive, method, step, until, refine=0, model=0, every=EVERY):
    """Simulate; building the system is not counted."""
    container, system = build(drive, refine, model)
    steps = round(until / step)
    settings = exu.SimulationSettings()
    integration = settings.timeIntegration
    integration.numberOfSteps = steps
    integration.endTime = until
    integration.verboseMode = 0
    integration.automaticStepSize = False
    integration.adaptiveStep = False
    integration.explicit.computeEndOfStepAccelerations = False
    integration.explicit.computeMassMatrixInversePerBody = False
    integration.explicit.useLieGroupIntegration = False
    settings.linearSolver.solverType = exu.LinearSolverType.EigenSparse
    solution = settings.solution
    solution.precision = 16
    solution.file.writePeriod = every
    solution.file.export.velocities = True
    solution.file.export.accelerations = False
    solution.file.export.dataCoordinates = False
    solution.sensors.writePeriod = until
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "solution.txt"
        solution.file.name = str(file)
        begin = time.process_time()
        system.SolveDynamic(settings, solverType=SOLVERS[method])
        cpu = time.process_time() - begin
        rows = np.loadtxt(file, comments="#", delimiter=",")
    del container
    # Time, then displacements from the reference, then velocities.
    links, wheels = drive["chain"]["links"], len(drive["sprockets"])
    size = 3 * links + wheels
    place = rows[:, 1 : 1 + 3 * links].reshape(len(rows), links, 3)[..., :2]
    place = place + np.array(drive["start"]["place"])
    speed = rows[:, 1 + size : 1 + size + 3 * links].reshape(len(rows), links, 3)[..., :2]
    evaluations = steps * {"verlet": 1, "rk4": 4}.get(method, 0)
    return Result(link_tension(drive, place, speed), cpu, steps, evaluations, until)


if __name__ == "__main__":
    from measure import load, tight_tension

    os.environ.setdefault("OMP_NUM_THREADS", "1")
    drive = load()
    result = run(drive, "verlet", 1e-5, 0.01)
    tight = tight_tension(drive, result.tension)
    per = result.cpu / result.steps / drive["chain"]["links"]
    print(f"tight span {tight.mean():.0f} ± {tight.std():.0f} N, {1e9 * per:.1f} ns per link-step")
