"""The default choice of method and step for every preset: what it takes, and what it costs."""

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np

import chaindrive as cd
from page import Page
from stepping import at_once

# Lengths of a short and a long run, in steps that a simulation takes that nobody asked for an
# accuracy. The error is examined over some four thousand of them.
SHORT, LONG = 20_000, 100_000
ACCURACY = 0.01
LADDER = 1.15  # ratio of neighbouring steps
RUNGS = range(-3, 9)
ALLOWED = 1.4  # evaluations of the chosen step over those of the cheapest reliable one


@dataclass(frozen=True)
class Run:
    """A run as a user asks for it, with what it tells and the time that was not stepping."""

    attributes: dict[str, Any]

    @property
    def evaluations_per_second(self) -> float:
        """Evaluations per simulated second."""
        return self.attributes["evaluations"] / self.attributes["time_reached"]

    @property
    def estimate(self) -> float:
        """Counted evaluations of the estimate over those of the run [–]."""
        return self.attributes.get("error_evaluations", 0.0) / self.attributes["evaluations"]

    @property
    def trials(self) -> float:
        """Counted evaluations of the trials over those of the run [–]."""
        return self.attributes.get("accuracy_evaluations", 0.0) / self.attributes["evaluations"]


def found_error(attributes: dict[str, Any]) -> str:
    """Tell the error that a choice found, and whether it keeps the accuracy."""
    kept = attributes["accuracy_kept"]
    if "accuracy_error" not in attributes:
        return f"not told, {kept}"
    return f"{100 * attributes['accuracy_error']:.2g} %, {kept}"


def as_asked(drive: cd.Drive, until: float) -> Run:
    """Run the default."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", cd.VerdictWarning)
        run = cd.simulate(drive, until=until, every=until / 200, record="energy_residual")
    return Run(dict(run.attrs))


def own_step(drive: cd.Drive) -> float:
    """Return the step of a drive where no accuracy is asked for."""
    instant = {"until": 1e-9, "every": 1e-9, "record": "energy_residual", "method": "auto"}
    run = cd.simulate(drive, error=False, **instant)
    return float(run.attrs["step"])


@dataclass(frozen=True)
class Ladder:
    """True errors of steps about the chosen one."""

    error: float
    """Of the chosen step, tight span, root mean square over the mean [–]."""
    over_best: float
    """Evaluations over those of the cheapest step that keeps the accuracy, as do both of its
    neighbours [–]; not a number where there is none."""


def ladder(drive: cd.Drive, run: Run, quick: bool) -> Ladder:
    """Measure the errors of a ladder of steps over the window that the run examined."""
    chosen = run.attributes
    rungs = range(-1, 2) if quick else RUNGS
    until = chosen["error_window"]
    table = cd.work_precision(
        drive,
        methods=chosen["method"],
        steps=[chosen["step"] * LADDER**rung for rung in rungs],
        until=0.2 * until if quick else until,
        repeats=1,
        replicates=1,
    )
    errors = table["error_tight_span_tension"].values
    work = table["evaluations"].values
    keeps = np.isfinite(errors) & (errors <= ACCURACY)
    # A step is reliable if both of its neighbours keep the accuracy too.
    reliable = keeps.copy()
    reliable[1:-1] &= keeps[:-2] & keeps[2:]
    reliable[[0, -1]] = False
    here = list(rungs).index(0)
    over = float(work[here] / work[reliable].min()) if reliable.any() else float("nan")
    return Ladder(float(errors[here]), over)


def report(page: Page) -> None:
    """Write the tables of counts and of their costs, and answer the targets."""
    page.add(
        "## The default, counted",
        "",
        "Every preset as `simulate` runs it, without a run-in, with an accuracy of "
        f"{100 * ACCURACY:g} %. Evaluations per simulated second are counted; they are held "
        "against the cheapest step of "
        f"a ladder of ratio {LADDER}, at which it and its two neighbours keep the accuracy "
        "(errors of the tight span, against a reference that a second method confirms, over the "
        "window that the run examined). *Found* is the error that the choice found, *true* the "
        "one of the ladder.",
    )
    names = ["marine_two_sprockets"] if page.quick else list(cd.scenes.presets())
    counts, costs, far, short_most, long_most = [], [], {}, {}, {}
    for name in names:
        drive = at_once(getattr(cd.scenes, name)())
        step = own_step(drive)
        share = 0.1 if page.quick else 1.0
        short = as_asked(drive, SHORT * share * step)
        chosen = short.attributes
        if "choice" not in chosen:
            # Some scenes name method and step themselves.
            counts.append([name, f"{chosen['method']}, {1e6 * chosen['step']:.3g}", *["–"] * 5])
            continue
        rungs = ladder(drive, short, page.quick)
        far[name] = rungs.over_best
        counts.append(
            [
                name,
                f"{chosen['method']}, {1e6 * chosen['step']:.3g}",
                f"{short.evaluations_per_second:.3g}",
                found_error(chosen),
                f"{100 * rungs.error:.2g} %",
                "–" if np.isnan(rungs.over_best) else f"{rungs.over_best:.2f}",
                f"{1e3 * chosen['error_window']:.3g}",
            ]
        )
        long = as_asked(drive, LONG * share * step)
        short_most[name] = short.trials + short.estimate
        long_most[name] = long.trials + long.estimate
        costs.append(
            [
                name,
                *(
                    cell
                    for run in (short, long)
                    for cell in (
                        f"{1e3 * run.attributes['time_reached']:.3g}",
                        f"{run.trials:.2g}",
                        f"{run.estimate:.2g}",
                    )
                ),
                f"{1e6 * long.attributes['step']:.3g}",
            ]
        )
    page.table(
        [
            "preset",
            "method, step [µs]",
            "evaluations per simulated s",
            "found",
            "true",
            "evaluations over the cheapest reliable",
            "window [ms]",
        ],
        counts,
    )
    page.add(
        "Trials of the choice and the estimate at the end, over the run itself, in counted "
        "evaluations.",
    )
    page.table(
        [
            "preset",
            "short run [ms]",
            "trials",
            "estimate",
            "long run [ms]",
            "trials",
            "estimate",
            "step of the long run [µs]",
        ],
        costs,
    )
    answer(page, "evaluations of the default over the cheapest reliable step", far, ALLOWED)
    answer(page, "trials and estimate over the run, short", short_most, 3.0)
    answer(page, "trials and estimate over the run, long", long_most, 0.05)


def answer(page: Page, what: str, found: dict[str, float], most: float) -> None:
    """Answer a target that every preset has to meet, by the one that is farthest from it."""
    known = {name: value for name, value in found.items() if not np.isnan(value)}
    kept = [name for name, value in known.items() if value <= most]
    told = f"{len(kept)} of {len(found)} keep it"
    if known:
        worst = max(known, key=lambda name: known[name])
        told = f"up to {known[worst]:.3g} ({worst}); {told}"
    if unknown := sorted(set(found) - set(known)):
        told += f", nothing to hold it against for {', '.join(unknown)}"
    page.target(what, f"≤ {most:g} for every preset", told, len(kept) == len(found))
