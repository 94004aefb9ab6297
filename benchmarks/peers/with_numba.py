"""The marine drive in a plain numba program: particles, springs, Lankarani–Nikravesh contacts.

What a competent engineer writes in a few evenings: one scalar loop over the links, one over
rollers and sprockets, a distance test first, the nearest gap by its angle, and a memory of the
closing speed at touch, interpolated to zero gap and changed on accepted steps only. Velocity Verlet
and RK4.
"""

import math
import time
from collections import namedtuple

import numpy as np
from numba import njit

from measure import EVERY, Result, link_tension

# No check for division by zero, sums in any order: what speed-minded users of numba switch on.
FAST = {"cache": True, "fastmath": True, "error_model": "numpy"}

Model = namedtuple(
    "Model",
    "links mass rest stiffness damping gravity radius seat_radius contact factor floor "
    "centre height sine cosine flank tip teeth gap inertia torque prescribed speed",
)
Memory = namedtuple("Memory", "gap closing onset")


def model(drive):
    """Return the drive as arrays and numbers."""
    chain, law = drive["chain"], drive["contact"]
    wheels = drive["sprockets"]
    teeth = np.array([wheel["teeth"] for wheel in wheels], dtype=np.int64)
    # The seat ends 60° − 45°/z from its lowest point, the straight flank begins there.
    half = np.radians(60 - 45 / teeth)
    pitch_radius = 0.5 * chain["pitch"] / np.sin(np.pi / teeth)
    seat = drive["seat_radius"]
    height = pitch_radius - chain["roller_radius"] + seat
    tip = np.array([wheel["tip_radius"] for wheel in wheels])
    # Length of the flank from the seat to the tip circle, |a + u s| = R with a the seat's end.
    a = np.stack([seat * np.sin(half), height - seat * np.cos(half)])
    b = a[0] * np.cos(half) + a[1] * np.sin(half)
    flank = np.sqrt(b**2 + tip**2 - (a**2).sum(axis=0)) - b
    return Model(
        links=chain["links"],
        mass=chain["mass"],
        rest=np.array(chain["rest_length"]),
        stiffness=chain["stiffness"],
        damping=chain["damping"],
        gravity=drive["gravity"][1],
        radius=chain["roller_radius"],
        seat_radius=seat,
        contact=law["stiffness"],
        factor=0.75 * (1 - law["restitution"] ** 2),
        floor=law["onset_floor"],
        centre=np.array([wheel["centre"] for wheel in wheels]),
        height=height,
        sine=np.sin(half),
        cosine=np.cos(half),
        flank=flank,
        tip=tip,
        teeth=teeth,
        gap=np.array([wheel["gap_angle"] for wheel in wheels]),
        inertia=np.array([wheel["inertia"] or 1.0 for wheel in wheels]),
        torque=np.array([wheel["torque"] for wheel in wheels]),
        prescribed=np.array([wheel["prescribed"] for wheel in wheels]),
        speed=np.array([wheel["speed"] for wheel in wheels]),
    )


def state(drive):
    """Return position and velocity, (2 links + wheels,): x, y of every roller, then the angles."""
    place, velocity = np.array(drive["start"]["place"]), np.array(drive["start"]["velocity"])
    speed = [wheel["speed"] for wheel in drive["sprockets"]]
    q = np.concatenate([place.ravel(), np.zeros(len(speed))])
    v = np.concatenate([velocity.ravel(), speed])
    return q, v


def memory(m):
    """Return an empty memory: every contact open."""
    shape = (len(m.teeth), m.links)
    return Memory(np.ones(shape), np.zeros(shape), np.zeros(shape))


@njit(**FAST)
def approach(m, w, x, y, cosine, sine):
    """Gap between a roller and a wheel, and the normal on the roller in the plane."""
    dx, dy = x - m.centre[w, 0], y - m.centre[w, 1]
    # In the frame of the wheel, then in that of the nearest gap, whose axis is y.
    wx, wy = cosine * dx + sine * dy, cosine * dy - sine * dx
    step = 2 * math.pi / m.teeth[w]
    axis = m.gap[w] + step * np.rint((math.atan2(wy, wx) - m.gap[w]) / step)
    ac, a_s = math.cos(axis), math.sin(axis)
    gx, gy = a_s * wx - ac * wy, ac * wx + a_s * wy
    side = 1.0 if gx >= 0 else -1.0
    gx *= side
    # Half a gap: seat about (0, h), then a straight flank along u = (cos β, sin β)
    sx, sy = gx, gy - m.height[w]
    along = sx * m.cosine[w] + sy * m.sine[w]
    if along <= 0:
        distance = math.sqrt(sx * sx + sy * sy)
        gap = m.seat_radius - distance - m.radius
        nx, ny = (-sx / distance, -sy / distance) if distance > 0 else (0.0, 1.0)
    elif along <= m.flank[w]:
        nx, ny = -m.sine[w], m.cosine[w]
        gap = sx * nx + sy * ny + m.seat_radius - m.radius
    else:
        ex = sx - m.seat_radius * m.sine[w] - m.flank[w] * m.cosine[w]
        ey = sy + m.seat_radius * m.cosine[w] - m.flank[w] * m.sine[w]
        distance = math.sqrt(ex * ex + ey * ey)
        gap = distance - m.radius
        nx, ny = (ex / distance, ey / distance) if distance > 0 else (0.0, 1.0)
    nx *= side
    # Back into the plane.
    wx, wy = a_s * nx + ac * ny, a_s * ny - ac * nx
    return gap, cosine * wx - sine * wy, sine * wx + cosine * wy


@njit(**FAST)
def evaluate(m, remembered, found, frozen, q, v, a):
    """Accelerations; with `frozen` the speed at touch is the floor, and nothing is remembered."""
    n = m.links
    for i in range(2 * n):
        a[i] = 0.0
    for i in range(n):
        j = i + 1 if i + 1 < n else 0
        dx, dy = q[2 * j] - q[2 * i], q[2 * j + 1] - q[2 * i + 1]
        ux, uy = v[2 * j] - v[2 * i], v[2 * j + 1] - v[2 * i + 1]
        length = math.sqrt(dx * dx + dy * dy)
        inverse = 1.0 / length
        # T/ℓ = [k (ℓ − ℓ₀) + d ℓ̇]/ℓ
        pull = m.stiffness * (length - m.rest[i]) + m.damping * (dx * ux + dy * uy) * inverse
        pull *= inverse
        a[2 * i] += pull * dx
        a[2 * i + 1] += pull * dy
        a[2 * j] -= pull * dx
        a[2 * j + 1] -= pull * dy
    for w in range(len(m.teeth)):
        angle, spin = q[2 * n + w], v[2 * n + w]
        cosine, sine = math.cos(angle), math.sin(angle)
        cx, cy = m.centre[w, 0], m.centre[w, 1]
        reach = (m.tip[w] + m.radius) ** 2
        moment = 0.0
        for i in range(n):
            dx, dy = q[2 * i] - cx, q[2 * i + 1] - cy
            if dx * dx + dy * dy > reach:
                if not frozen:
                    found.gap[w, i] = 1.0
                    found.onset[w, i] = 0.0
                continue
            gap, nx, ny = approach(m, w, q[2 * i], q[2 * i + 1], cosine, sine)
            # Closing speed, the teeth moving with ω ẑ × d at the point of contact.
            px, py = dx - nx * m.radius, dy - ny * m.radius
            closing = -(v[2 * i] + spin * py) * nx - (v[2 * i + 1] - spin * px) * ny
            onset = m.floor
            if not frozen:
                found.gap[w, i] = gap
                found.closing[w, i] = closing
                onset = remembered.onset[w, i]
                if gap >= 0:
                    onset = 0.0
                elif onset == 0.0:
                    # The speed at zero gap between the accepted state and this one.
                    before = remembered.gap[w, i]
                    share = before / (before - gap) if before > 0 else 0.0
                    speed = remembered.closing[w, i]
                    onset = max(speed + share * (closing - speed), m.floor)
                found.onset[w, i] = onset
            if gap < 0:
                # F = K δ^1.5 clamp(1 + χ δ̇/v, 0, 1 + 4χ)
                ratio = min(closing / onset, 4.0)
                force = m.contact * -gap * math.sqrt(-gap) * max(1 + m.factor * ratio, 0.0)
                a[2 * i] += force * nx
                a[2 * i + 1] += force * ny
                moment -= force * (px * ny - py * nx)
        a[2 * n + w] = 0.0 if m.prescribed[w] else (moment + m.torque[w]) / m.inertia[w]
    for i in range(n):
        a[2 * i] /= m.mass
        a[2 * i + 1] = a[2 * i + 1] / m.mass + m.gravity


@njit(**FAST)
def keep(remembered, found):
    """Take what the accepted state found into the memory."""
    remembered.gap[:] = found.gap
    remembered.closing[:] = found.closing
    remembered.onset[:] = found.onset


@njit(**FAST)
def verlet(m, remembered, found, q, v, h, steps, stride):
    """Velocity Verlet; velocities predicted for the forces. Returns samples of q and v."""
    size = len(q)
    a, fresh, predicted = np.empty(size), np.empty(size), np.empty(size)
    samples = np.empty((steps // stride + 1, 2, size))
    evaluate(m, remembered, found, False, q, v, a)
    keep(remembered, found)
    samples[0, 0], samples[0, 1] = q, v
    for step in range(1, steps + 1):
        for i in range(size):
            q[i] += h * (v[i] + 0.5 * h * a[i])
            predicted[i] = v[i] + h * a[i]
        evaluate(m, remembered, found, False, q, predicted, fresh)
        for i in range(size):
            v[i] += 0.5 * h * (a[i] + fresh[i])
        a, fresh = fresh, a
        remembered, found = found, remembered
        if step % stride == 0:
            samples[step // stride, 0], samples[step // stride, 1] = q, v
    return samples


@njit(**FAST)
def rk4(m, remembered, found, q, v, h, steps, stride):
    """Classical Runge–Kutta; the memory changes on accepted states only."""
    size = len(q)
    k = np.empty((4, 2, size))
    place, speed = np.empty(size), np.empty(size)
    samples = np.empty((steps // stride + 1, 2, size))
    samples[0, 0], samples[0, 1] = q, v
    for step in range(1, steps + 1):
        k[0, 0] = v
        evaluate(m, remembered, found, False, q, v, k[0, 1])
        # The first stage is at the accepted state: what it found is remembered.
        keep(remembered, found)
        for stage in range(1, 4):
            share = h if stage == 3 else 0.5 * h
            for i in range(size):
                place[i] = q[i] + share * k[stage - 1, 0, i]
                speed[i] = v[i] + share * k[stage - 1, 1, i]
            k[stage, 0] = speed
            evaluate(m, remembered, found, False, place, speed, k[stage, 1])
        for i in range(size):
            q[i] += h / 6 * (k[0, 0, i] + 2 * (k[1, 0, i] + k[2, 0, i]) + k[3, 0, i])
            v[i] += h / 6 * (k[0, 1, i] + 2 * (k[1, 1, i] + k[2, 1, i]) + k[3, 1, i])
        if step % stride == 0:
            samples[step // stride, 0], samples[step // stride, 1] = q, v
    return samples


METHODS = {"verlet": (verlet, 1), "rk4": (rk4, 4)}


def run(drive, method, step, until, every=EVERY):
    """Simulate; the step must divide the sampling interval. Compiling is not counted."""
    function, cost = METHODS[method]
    m = model(drive)
    stride = round(every / step)
    if abs(stride * step / every - 1) > 1e-9:
        raise ValueError(f"a step of {step} s does not divide {every} s")
    function(m, memory(m), memory(m), *state(drive), step, stride, stride)
    q, v = state(drive)
    steps = round(until / step)
    begin = time.process_time()
    samples = function(m, memory(m), memory(m), q, v, step, steps, stride)
    cpu = time.process_time() - begin
    tension = tensions(drive, samples)
    return Result(tension, cpu, steps, cost * steps, until)


def tensions(drive, samples):
    """Tension of every link [N], (samples, links), from samples (samples, 2, coordinates)."""
    n = drive["chain"]["links"]
    motion = samples[:, :, : 2 * n].reshape(len(samples), 2, n, 2)
    return link_tension(drive, motion[:, 0], motion[:, 1])


if __name__ == "__main__":
    from measure import load, tight_tension

    drive = load()
    result = run(drive, "verlet", 1e-5, 1.0)
    tight = tight_tension(drive, result.tension)
    per = result.cpu / result.steps / drive["chain"]["links"]
    print(f"tight span {tight.mean():.0f} ± {tight.std():.0f} N, {1e9 * per:.1f} ns per link-step")
