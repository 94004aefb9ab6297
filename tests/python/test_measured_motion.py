"""Published measurements of forces and motions: agreement and miss alike."""

import math
from typing import Any

import numpy as np
import pytest
import xarray as xr
from verdicts import MeasuredCase

import chaindrive as cd

PITCH = 12.7e-3
FRICTION = "contact.joints.friction.coefficient"
FAST = {"error": False}
"""Numerical errors are estimated elsewhere."""


@pytest.mark.slow
def test_m06_timing_chains() -> None:
    with MeasuredCase("M06") as case:
        every = 5e-5
        run = cd.simulate(
            case.drive(),
            run_in=0.2,
            until=0.2,
            every=every,
            method="verlet",
            record=["sprocket_angle", "span_tension", "link_tension"],
            **FAST,
        )
        peaks = run["span_tension"].max("time")
        tight = str(peaks["span"].to_numpy()[int(np.argmax(peaks.to_numpy()))])
        names = [str(name) for name in peaks["span"].to_numpy()]
        figures = ", ".join(f"{name} {float(peaks.sel(span=name)):.0f} N" for name in names)
        case.trend("span of the greatest force", tight == "crank-exhaust", figures)
        low, high = (
            float(
                cd.simulate(
                    case.drive().replace(
                        {
                            f"sprockets.{shaft}.load": [
                                {"kind": "constant", "torque": 2.0},
                                {"kind": "harmonic", "amplitude": amplitude, "order": 4} | phase,
                            ]
                            for shaft, phase in (
                                ("exhaust", {}),
                                ("intake", {"phase": "90 deg"}),
                            )
                        }
                    ),
                    run_in=0.16,
                    until=0.08,
                    every=every,
                    method="verlet",
                    record=["link_tension"],
                    **FAST,
                )["link_tension"].max()
            )
            for amplitude in (10.0, 20.0)
        )
        case.number(
            "greatest link force, petrol engine",
            float(run["link_tension"].max()),
            "Camshaft torques of 10 to 20 N m.",
            interval=(low, high),
        )
        angle = run["sprocket_angle"] - run["sprocket_angle"][0]
        # Two turns of the crank are one of the camshaft.
        twist = np.degrees(2 * angle.sel(sprocket="exhaust") - angle.sel(sprocket="crank"))
        case.number(
            "twist of the exhaust camshaft against the crank, amplitude",
            float(np.ptp(twist.to_numpy())) / 2,
        )
        force = run["span_tension"].sel(span=tight).to_numpy()
        spectrum = np.abs(np.fft.rfft((force - force.mean()) * np.hanning(len(force))))
        orders = np.fft.rfftfreq(len(force), every) / 50  # 50 turns of the crank a second
        greatest = float(orders[spectrum.argmax()])
        case.trend(
            "orders that dominate the force",
            round(greatest) in (4, 6, 8),
            f"order {greatest:.1f} of the crank",
        )


def test_m07_m12_m14_are_carried() -> None:
    for name in ("M07", "M12", "M14"):
        with MeasuredCase(name) as case:
            assert case.data["carried"]
            assert not case.data["rows"]


def test_m08_a_longer_camshaft_chain() -> None:
    with MeasuredCase("M08") as case:
        drive = case.drive().replace(
            {"route.adjust": {"kind": "slider", "name": "tightener", "within": 0.1}}
        )
        centre = np.array([1.220977776126, 2.150])
        places = []
        for elongation in (0.0, 0.0025, 0.005, 0.0075, 0.01):
            run = cd.simulate(
                drive.replace({"chain.elongation": elongation}),
                until=1e-4,
                run_in=0,
                every=1e-4,
                method="verlet",
                record=["roller_x", "roller_y", "sprocket_y"],
                **FAST,
            )
            x, y = run["roller_x"][0].to_numpy(), run["roller_y"][0].to_numpy()
            # Rollers 11 and 50 lie in the middle of their wraps, on crank and camshaft.
            crank = math.atan2(y[11], x[11])
            cam = math.atan2(y[50] - centre[1], x[50] - centre[0])
            radius = math.hypot(x[50] - centre[0], y[50] - centre[1])
            places.append((math.degrees(cam - crank), 1e3 * radius))
        angles, radii = np.array(places).T
        # The drive runs clockwise: a roller that lies farther counter-clockwise comes later.
        later = angles[1:] - angles[0]
        case.trend(
            "timing of the camshaft, 0 to 1 % longer",
            bool(np.all(np.diff(angles) > 0)),
            "later by " + ", ".join(f"{it:.2f}" for it in later) + " degrees",
        )
        case.trend(
            "rollers on the camshaft's wheel, 0 to 1 % longer",
            bool(np.all(np.diff(radii) > 0)),
            "farther out by " + ", ".join(f"{it:.2f}" for it in radii[1:] - radii[0]) + " mm",
        )


FIRST = 7
"""Last link of the tight strand in the scene of M10."""


def shares(drive: cd.Drive) -> np.ndarray:
    """Tensions over the wrap of a settled sprocket, in parts of the tight one."""
    links = cd.simulate(drive, **FAST)["link_tension"][0].to_numpy()
    return links[FIRST : FIRST + 12] / links[FIRST]


def turned(drive: cd.Drive, speed: float, friction: float) -> np.ndarray:
    """Tensions over the wrap after a turn by two teeth: positive speeds lead to the slack side."""
    rubbing = drive.replace(
        {
            "sprockets.sprocket.motion": {"kind": "ramp", "from": 0, "to": speed, "duration": 0.05},
            "contact.teeth.friction": {"coefficient": friction, "slip_speed": 1e-3},
            "contact.joints.friction": {"kind": "spring-slider", "coefficient": friction},
        }
    )
    run = cd.simulate(rubbing, until=0.4, every=1e-3, **FAST)
    gap = math.tau / 20
    angle = run["sprocket_angle"][:, 0].to_numpy()
    after = int(np.argmin(np.abs(np.abs(angle) - 2 * gap)))
    assert abs(abs(angle[after]) - 2 * gap) < 2e-3
    first = FIRST - round(angle[after] / gap)
    links = run["link_tension"][after].to_numpy()
    return links[first : first + 12] / links[first]


@pytest.mark.slow
def test_m10_load_on_twenty_teeth() -> None:
    with MeasuredCase("M10") as case:
        drive = case.drive()
        even = shares(drive)

        def changed(path: str, *values: float) -> float:
            return max(float(abs(shares(drive.replace({path: it})) - even).max()) for it in values)

        teeth = changed("contact.teeth.law.stiffness", 25e6, 400e6)
        case.trend(
            "elasticity of the sprocket",
            teeth < 0.05,
            f"{100 * teeth:.1f} % of the tight tension for a quarter and four times the stiffness",
        )
        chain = changed("chain.stiffness", 23.825e6, 95.3e6)
        case.trend(
            "elasticity of the chain",
            chain < 0.05,
            f"{100 * chain:.1f} % of the tight tension for half and twice the stiffness",
        )
        # Toward the tight side the sprocket is driven by the chain, else it drives.
        rubbing = {
            (speed, friction): turned(drive, speed, friction)
            for speed in (2.0, -2.0)
            for friction in (0.0, 0.05, 0.1)
        }
        smooth, rough = (
            float(abs(rubbing[2.0, it] - rubbing[-2.0, it]).max()) for it in (0.0, 0.1)
        )
        case.trend(
            "driver against driven sprocket",
            rough > 0.02 and smooth < 0.1 * rough,
            f"{100 * rough:.1f} % of the tight tension with friction, {100 * smooth:.2f} % without",
        )
        oil = max(float(abs(rubbing[it, 0.1] - rubbing[it, 0.05]).max()) for it in (2.0, -2.0))
        case.trend(
            "lubricant",
            oil < 0.05,
            f"{100 * oil:.1f} % of the tight tension between coefficients of 0.1 and 0.05",
        )
        peaks = [
            float(shares(drive.replace({"chain.elongation": it})).max())
            for it in (0.0, -0.001, -0.002, -0.004)
        ]
        case.trend(
            "sprocket of a larger pitch",
            bool(np.all(np.diff(peaks) > 0)),
            "greatest link tension "
            + ", ".join(f"{it:.2f}" for it in peaks)
            + " times the tight one with a chain 0, 0.1, 0.2, 0.4 % shorter",
        )


def test_m13_lift_off_from_a_pulley() -> None:
    with MeasuredCase("M13") as case:
        drive = case.drive()
        radius = float(drive.to_dict()["guides"][0]["face"]["radius"]) + 7.75e-3 / 2

        def pulled(acceleration: float) -> tuple[float, float, float]:
            """Time of lift-off [s], height of the free end then [m], its last speed ratio."""
            times = np.linspace(0, 0.464, 59)
            places = -0.5 * acceleration * times**2
            motion = {"kind": "table", "times": times.tolist(), "values": places.tolist()}
            until = 0.45 * math.sqrt(9.81 / acceleration)
            run = cd.simulate(
                drive.replace({"chain.ends": [{"kind": "driven", "y": motion}, "free"]}),
                until=until,
                method="verlet",
                step=1.5e-6,
                **FAST,
            )
            assert float(abs(run["energy_residual"]).max()) < 1e-3
            x, y, time = (run[it].to_numpy() for it in ("roller_x", "roller_y", "time"))
            # Off by 0.2 mm anywhere but near the tangent points, where strands leave.
            above = (np.arctan2(y, x) > 0.3) & (np.arctan2(y, x) < 2.84)
            off = (np.hypot(x, y) - radius > 2e-4) & above
            first = int(np.argmax(off.any(axis=1)))
            assert off[first].any()
            last = slice(-40, None)
            rise = float(np.polyfit(time[last], y[last, -1], 1)[0])
            pull = -float(np.polyfit(time[last], y[last, 0], 1)[0])
            return float(time[first]), float(y[first, -1]), rise / pull

        lifted, height, ratio = pulled(9.81)
        _, other_height, other_ratio = pulled(19.62)
        case.trend(
            "chain and pulley",
            height < 0 and other_height < 0,
            f"the end is {-height:.2f} and {-other_height:.2f} m below the pulley's axis then",
        )
        case.trend(
            "free end after lift-off",
            ratio > 1.02 and other_ratio > 1.02,
            f"its speed is {ratio:.2f} and {other_ratio:.2f} times that of the pulled end",
        )
        # (g + a) (l − a t²/2) = a² t²
        length, g, a = 80 * PITCH, 9.81, 9.81
        closed = math.sqrt((g + a) * length / (a * a + a * (a + g) / 2))
        assert case.row("time of lift-off")["expected"] == pytest.approx(closed, rel=1e-3)
        case.number("time of lift-off", lifted)


def test_m15_falling_folded_chain() -> None:
    with MeasuredCase("M15") as case:
        drive = case.drive()
        length, stone = 80 * PITCH, math.sqrt(2 * 80 * PITCH / 9.81)

        def fall(**changes: Any) -> tuple[float, bool]:
            run = cd.simulate(drive.replace(changes), **FAST)
            tip = run["roller_y"][:, -1].to_numpy()
            time = run["time"].to_numpy()
            lowest = int(tip.argmin())
            assert tip[lowest] < -0.97 * length
            # From a tenth of its fall on the end is below a stone let go with it.
            falling = slice(int(np.argmax(tip < -0.1 * length)), lowest)
            ahead = bool(np.all(tip[falling] < -0.5 * 9.81 * time[falling] ** 2))
            return float(time[lowest]) / stone, ahead

        ratio, ahead = fall()
        rubbed = {"contact.joints.friction": {"kind": "spring-slider", "coefficient": 0.15}}
        others = [
            fall(**{"chain.start.to": [0.02, 0.0]}),
            fall(**{"chain.start.to": [0.2, 0.0]}),
            fall(**rubbed),
        ]
        times = [it for it, _ in others]
        case.trend(
            "free end against a stone",
            ahead and all(it for _, it in others),
            "ahead of it from a tenth of the fall on, for all distances and frictions",
        )
        case.number(
            "time of fall over that of a stone through the length of the chain",
            ratio,
            f"{min(times):.3f} to {max(times):.3f} over the range.",
        )


def turning_points(run: xr.Dataset) -> np.ndarray:
    """Angles at which the pendulum turns [rad], from the vertical."""
    angle = run["sprocket_angle"][:, 0].to_numpy() + math.radians(20)
    late = run["time"].to_numpy()[1:-1] > 0.02
    before, at, after = angle[:-2], angle[1:-1], angle[2:]
    turns = ((at - before) * (after - at) <= 0) & (before != at) & late
    # A parabola through three samples.
    bend = before - 2 * at + after
    with np.errstate(divide="ignore", invalid="ignore"):
        peaks = at - (before - after) ** 2 / (8 * bend)
    return peaks[turns]


PIN_RADIUS = 2.045e-3
"""Of chain 081 [m]."""


MOMENT = 24.525
"""m g l of the pendulum [N m]."""


def next_turning_point(start: float, torque: float) -> float:
    """Amplitude after a half swing: m g l (cos x₁ − cos x₀) = C (x₀ + x₁), by halving."""
    low, high = 0.0, start
    for _ in range(60):
        middle = (low + high) / 2
        left = MOMENT * (math.cos(middle) - math.cos(start)) - torque * (start + middle)
        low, high = (middle, high) if left > 0 else (low, middle)
    return low


def friction_torque(run: xr.Dataset, points: np.ndarray) -> float:
    """Energy lost up to the last turning point, over the angle travelled [N m]."""
    angle = run["sprocket_angle"][:, 0].to_numpy()
    travelled = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(angle)))])
    path = np.abs(np.diff(np.concatenate([[math.radians(20)], points]))).sum()
    return float(np.interp(path, travelled, run["energy_losses"].sum("place").to_numpy())) / path


def torque_in_closed_form(run: xr.Dataset, pull: float, coefficient: float) -> float:
    """C = 2 μ' r N,   N = (T + T₁)/2,   T₁ the mean tension of the first link on the chainring.

    A link on the chainring at an angle β to the strand bears T₁ = T (cos β − cot χ sin β), from the
    balance of its roller; β runs from 0 to the pitch angle α. The settled chain shows T₁ at α/2,
    and with it cot χ.
    """
    pitch_angle = math.tau / 44
    seen = float(run["link_tension"][0, 10]) / pull
    cotangent = (math.cos(pitch_angle / 2) - seen) / math.sin(pitch_angle / 2)
    mean = (math.sin(pitch_angle) - cotangent * (1 - math.cos(pitch_angle))) / pitch_angle
    return 2 * math.sin(math.atan(coefficient)) * PIN_RADIUS * pull * (1 + mean) / 2


def swing(
    drive: cd.Drive, pull: float, coefficient: float, until: float = 1.5
) -> tuple[xr.Dataset, np.ndarray]:
    """Let the pendulum of M16 swing; where it turns."""
    run = cd.simulate(
        drive.replace(
            {
                "chain.ends": [{"kind": "pulled", "force": [0.0, -pull]}] * 2,
                FRICTION: coefficient,
            }
        ),
        until=until,
        method="verlet",
        step=1.5e-6,
        **FAST,
    )
    return run, turning_points(run)


def test_a_pendulum_on_a_chain_is_braked_by_its_joints() -> None:
    """The strongest friction of M16, over its first half swings."""
    run, points = swing(cd.scenes.chain_pendulum(), 1000.0, 0.2, 1.2)
    closed = torque_in_closed_form(run, 1000.0, 0.2)
    assert friction_torque(run, points) == pytest.approx(closed, rel=0.05)


@pytest.mark.slow
def test_m16_pendulum_on_a_chain() -> None:
    with MeasuredCase("M16") as case:
        drive = case.drive()
        start = math.radians(20)
        _, free = swing(drive, 1000.0, 0.0)
        # The weight of the strands shifts the middle: two peaks, one on either side.
        kept = float(abs(free[-1] - free[-2])) / 2 / start
        case.trend(
            "pendulum without friction in the joints",
            kept > 0.99,
            f"{100 * kept:.1f} % of the swing left after {len(free)} half swings",
        )
        slopes = {}
        for pull, coefficient in ((1000.0, 0.1), (1000.0, 0.2), (1000.0, 0.05), (235.0, 0.1)):
            nominal = (pull, coefficient) == (1000.0, 0.1)
            run, points = swing(drive, pull, coefficient, 4.0 if nominal else 1.5)
            quantity = f"friction torque of {pull / 1e3:.3g} kN and {coefficient}"
            if pull < 1000:
                quantity = f"friction torque of {pull:.0f} N and {coefficient}"
            row = case.row(quantity)
            closed = torque_in_closed_form(run, pull, coefficient)
            assert row["expected"] == pytest.approx(closed, rel=1e-3)
            case.number(quantity, friction_torque(run, points))
            peaks = np.abs(np.concatenate([[start], points]))
            count = np.arange(len(peaks))
            slope, level = np.polyfit(count, peaks, 1)
            off = float(np.abs(peaks - level - slope * count).max()) / (peaks[0] - peaks[-1])
            slopes[pull, coefficient] = (slope, off)
            if nominal:
                quantity = "fifth turning point of 1 kN and 0.1"
                row = case.row(quantity)
                turned = [start]
                for _ in range(5):
                    turned.append(next_turning_point(turned[-1], closed))
                assert row["expected"] == pytest.approx(math.degrees(turned[5]), rel=1e-3)
                case.number(quantity, math.degrees(peaks[5]))
        steep, bent = slopes[1000.0, 0.1]
        gentle, _ = slopes[235.0, 0.1]
        case.trend(
            "decay with a chain",
            bent < 0.03 and steep < 2 * gentle < 0,
            f"off a straight line by {100 * bent:.1f} % of the decay; "
            f"{-math.degrees(steep):.2f} degrees a half swing at 1 kN, "
            f"{-math.degrees(gentle):.2f} at 235 N",
        )
