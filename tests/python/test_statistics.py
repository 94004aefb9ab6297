"""Means over time: the same from every phase of the start, known as well as intervals say."""

import numpy as np
import pytest
import xarray as xr

import chaindrive as cd


def from_phases(name: str, phases: list[float], run_in: str, until: str) -> xr.Dataset:
    """Statistics of a preset that is run in, from some phases."""
    drive = getattr(cd.scenes, name)().replace({"run.run_in": run_in})
    result = cd.sweep(drive, {"route.phase": phases}, until=until)
    assert (result["error"] == "").all()
    return result


def test_the_phase_of_the_start_makes_no_other_drive() -> None:
    """The same chain on the same centres, wherever it begins: lengths of links to the last bits."""
    for model, phases in [("particles", (0.0, 0.3, 0.5, 0.9)), ("clearance-joints", (0.0, 0.5))]:
        drives = [
            cd.scenes.bicycle().replace({"chain.model": model, "route.phase": phase})
            for phase in phases
        ]
        means = []
        for drive in drives:
            run = cd.simulate(
                drive,
                run_in="0.1 s",
                until="60 ms",
                every="50 us",
                record="span_tension",
                error=False,
            )
            means.append(run["span_tension"].mean("time").values)
        tight, slack = np.array(means).T
        # Version 0.1 laid chains whose slack spans were 17 % apart.
        assert np.ptp(tight) < 0.02 * tight.mean(), model
        assert np.ptp(slack) < 0.05 * slack.mean(), model


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "run_in", "until"),
    [
        ("marine_engine_bare", "2 s", "20 s"),
        ("marine_two_sprockets", "2 s", "4 s"),
        ("industrial_16b", "0.5 s", "0.5 s"),
        ("bicycle", "0.2 s", "1 s"),
    ],
)
def test_means_do_not_depend_on_the_phase_of_the_start(name: str, run_in: str, until: str) -> None:
    result = from_phases(name, [0.0, 0.25, 0.5, 0.75], run_in, until)
    means = result["span_tension_mean"]
    apart = (means.max("phase") - means.min("phase")) / means.mean("phase")
    known = (result["span_tension_half_width"] / means).max("phase")
    print(name, (100 * apart).values.round(3), "%,", (100 * known).values.round(3), "%")
    assert (apart < 0.01).all()
    assert (known < 0.005).all()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "run_in", "until", "starts"),
    [
        ("marine_engine_bare", 1.0, "0.4 s", 120),  # 40 teeth, chaotic
        ("industrial_16b", 4.0, "0.42 s", 24),  # 40 teeth
        ("timing_drive", 1.0, "44 ms", 40),  # four periods of the cams
    ],
)
def test_intervals_hold_as_often_as_they_say(
    name: str, run_in: float, until: str, starts: int
) -> None:
    """Records of one motion from many moments on; all of them know it better than each.

    Noise would leave 5 % outside. Motions that repeat leave hardly any, hence no bound above on
    what is held; that intervals are not wide is judged by their width.
    """
    moments = run_in * (1.0 + 0.3 * np.random.default_rng(2026).random(starts))
    drive = getattr(cd.scenes, name)()
    result = cd.sweep(drive, {"run.run_in": sorted(moments)}, until=until)
    for statistic in ("mean", "std", "p1", "p99"):
        values = result[f"span_tension_{statistic}"]
        of = "" if statistic == "mean" else f"{statistic}_"
        widths = result[f"span_tension_{of}half_width"]
        errors = abs(values - values.mean("run_in"))
        held = float((errors <= widths).mean())
        # The least that an interval is: 2e-4 of the tension.
        least = 2e-4 * abs(result["span_tension_mean"]).mean("run_in")
        needed = errors.quantile(0.95, "run_in").clip(least)
        ratio = float((widths.median("run_in") / needed).median())
        print(name, statistic, held, ratio)
        # 95 % are asked. 88 % would be met by all but the 1st percentile of `timing_drive`: four
        # periods are four blocks, whose quantiles scatter less than they err (86 % of 120).
        assert held >= 0.85, statistic
        # Of four blocks Student's t alone is 1.6 times that of many.
        assert ratio < 4.5, statistic


def test_what_is_recorded_moves_no_statement() -> None:
    """Page and attributes of a run, but for its times, whatever it records."""
    drive = cd.scenes.industrial_16b()
    settings = {"until": "40 ms", "run_in": "30 ms", "step": 1e-5, "method": "verlet"}
    told = []
    for record in ([], ["contact_force", "link_tension"], "all"):
        run = cd.simulate(drive, record=record, error=False, **settings)
        numbers = {
            name: value
            for name, value in run.attrs.items()
            if isinstance(value, (int, float)) and not name.endswith(("_time", "_factor", "_step"))
        }
        assert len(numbers) > 40
        told.append((run.attrs["summary"], numbers))
    assert told[0] == told[1] == told[2]
