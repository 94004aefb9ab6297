"""Errors of neighbouring steps, which tell whether the accuracy of a step is luck."""

import numpy as np

import chaindrive as cd
from page import Page
from stepping import Stretch, in_turn

COUNT = 10  # steps, each 3 % from the next
WINDOW = 0.03  # [s]
RUN_IN = 0.1  # [s]


def report(page: Page) -> None:
    """Write the errors of ten steps that end at the default one."""
    drive = cd.scenes.bicycle().replace({"run.run_in": 0.01 if page.quick else RUN_IN})
    window = 1e-3 if page.quick else WINDOW
    settings = {"until": window, "every": window, "record": "span_tension", "error": False}
    chosen = cd.simulate(drive, **settings).attrs
    steps = chosen["step"] / 1.03 ** np.arange(2 if page.quick else COUNT)
    table = cd.work_precision(
        drive, methods=chosen["method"], steps=steps, until=window, repeats=1, replicates=1
    )
    errors = table["error_tight_span_tension"].values
    kept = {"method": chosen["method"], "step": chosen["step"]}
    stretch = Stretch(drive, page.quick, run_in=float(chosen["run_in"]), **kept)
    found = in_turn(
        page.yardstick,
        {"bicycle": stretch.time},
        page.pairs,
    )["bicycle"]
    # Simulated over processor time: h / (t n) with the time t of a link and step, n links.
    factor = 1e9 * chosen["step"] / (found.quiet * chosen["links"])
    worst = float(np.nanmax(errors)) if np.isfinite(errors).all() else float("nan")
    page.add(
        "## Errors that do not depend on luck",
        "",
        f"The bicycle with play, friction and compliance, {1e3 * window:g} ms after a run-in of "
        f"{1e3 * float(chosen['run_in']):g} ms: errors of the tight span, root mean square over "
        f"the mean, of {len(steps)} steps spaced by 3 % that end at the default one, "
        f"{1e6 * chosen['step']:.3g} µs, with {chosen['method']}.",
    )
    page.table(
        ["step [µs]", *(f"{1e6 * step:.3g}" for step in steps)],
        [["error [%]", *(f"{100 * error:.2g}" for error in errors)]],
    )
    page.add(
        f"The default steps at {factor:.2g} × real time at rest. The references differ by "
        f"{100 * float(table.attrs['agreement_tight_tension']):.1g} %.",
        "",
    )
    for bound, wanted in ((1e-3, 1.5), (1e-2, 2.5)):
        page.target(
            f"bicycle, all ten steps within {100 * bound:g} % of the tight span, stepping, at rest",
            f"≥ {wanted:g} × real time",
            f"{factor:.2g} × with errors up to {100 * worst:.2g} %",
            factor >= wanted and worst <= bound,
        )
