"""What became of a run: converged, bounded, distrusted, refused, or silently wrong.

=============  ==================================================================================
converged      mean and rms tension of every span are within 5 % of those of a run with half the
               step (or a 32nd of the tolerance), relative to the largest rms; the ledger closes
bounded        finite, and the ledger closes within 10 % of the energy moved
distrusted     the ledger does not close, and the summary of the run says so
refused        an error with a place and a hint, before the run or during it
WRONG          infinity or NaN in a result, or an open ledger without a word: a bug, always
=============  ==================================================================================

The ledger is added up here from the recorded stores and flows, not taken from the run's account.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

import chaindrive as cd

ALIKE = 0.05
OPEN = 0.1  # share of the energy moved at which a ledger is open
SAMPLES = 1000
CHANNELS = ["span_tension", "sprocket_speed", "energy_stores", "energy_flows", "link_tension"]

METHODS = {
    "verlet": {"method": "verlet"},
    "rk4": {"method": "rk4"},
    "rk4, onset ≤ 1 µm": {"method": "rk4", "onset_depth": 1e-6},
    "dormand-prince": {"method": "dormand-prince", "tolerance": 1e-6},
}
CLEARANCE_METHODS = {
    "verlet": {"method": "verlet"},
    "rk4": {"method": "rk4"},
    "rk4, onset ≤ 1 nm": {"method": "rk4", "onset_depth": 1e-9},
    "dormand-prince": {"method": "dormand-prince", "tolerance": 1e-6},
    "implicit-damping": {"method": "implicit-damping"},
    "generalized-alpha": {"method": "generalized-alpha"},
}
# Stores of motion come first.
KINETIC = ["chain_kinetic", "sprockets_kinetic", "tensioners_kinetic"]


@dataclass
class Verdict:
    """One cell of the table."""

    outcome: str
    detail: str = ""
    deviation: float = math.nan
    """From the run with half the step [–]."""
    residual: float = math.nan
    """Of the ledger, over the energy moved [–]."""
    tension: float = math.nan
    """Mean of the tightest span [N]."""
    steps: int = 0

    def __str__(self):
        """Write the cell."""
        if self.outcome == "refused":
            return "refused"
        text = self.outcome
        if math.isfinite(self.deviation):
            text += f" {_percent(self.deviation)}"
        return f"{text}; {self.residual:.0e}"


def _percent(share):
    return f"{100 * share:.2g} %"


def run(case, settings, drive):
    """Simulate a case with the settings of a method."""
    settings = dict(settings)
    every = case.until / SAMPLES
    if case.step_factor != 1.0 and settings["method"] != "dormand-prince":
        settings["step"] = case.step_factor * automatic_step(case, settings, drive)
    return cd.simulate(
        drive,
        until=case.until,
        run_in=0,
        every=every,
        record=CHANNELS,
        **(case.settings | settings),
    )


def automatic_step(case, settings, drive):
    """Return the step that the method chooses [s]."""
    every = case.until / SAMPLES
    probe = cd.simulate(drive, until=1e-9, run_in=0, every=every, record="span_tension", **settings)
    return probe.attrs["step"]


def halved(settings, run):
    """Return the settings of the run to compare with."""
    if settings["method"] == "dormand-prince":
        # Half the step of a method of fifth order.
        return settings | {"tolerance": settings["tolerance"] / 32}
    return settings | {"step": run.attrs["step"] / 2}


def statistics(case, run):
    """Mean and rms tension [N], (2, spans), after the transient; NaN is no statistic."""
    tension = run["span_tension"].values[round(case.transient * SAMPLES) :]
    return np.stack([np.nanmean(tension, axis=0), np.sqrt(np.nanmean(tension**2, axis=0))])


def ledger(run):
    """Residual and energy moved [J], added up from what was recorded."""
    stores = run["energy_stores"]
    flows = run["energy_flows"].values - run["energy_flows"].values[0]
    loss = np.array(["dissipated" in str(name) for name in run["flow"].values])
    kinetic = stores.sel(store=KINETIC).sum("store").values
    stored = stores.sum("store").values - kinetic
    supplied, lost = flows[:, ~loss].sum(axis=1), flows[:, loss].sum(axis=1)
    residual = (kinetic + stored) - (kinetic + stored)[0] - supplied + lost
    turnover = 0.5 * np.abs(np.diff(flows, axis=0)).sum()
    moved = max(turnover, np.ptp(kinetic), np.ptp(stored))
    return float(np.abs(residual).max()), float(moved)


def is_finite(run):
    """Whether everything recorded is finite.

    A span has no tension while no roller lies on one of its wheels; its NaN means that, and no
    other channel may have one.
    """
    finite = all(np.isfinite(run[name].values).all() for name in CHANNELS if name != "span_tension")
    return finite and not np.isinf(run["span_tension"].values).any()


def judge(case, settings, drive=None):
    """Run a case with a method, and with half the step, and judge."""
    try:
        drive = drive or case.drive()
        first = run(case, settings, drive)
    except cd.ChaindriveError as error:
        message = str(error).splitlines()[-1]
        return Verdict("refused", message)
    share, moved = ledger(first)
    share /= max(moved, 1e-9)
    tension = float(statistics(case, first)[0].max())
    verdict = Verdict("bounded", residual=share, tension=tension, steps=first.attrs["steps"])
    warned = first.attrs["verdict"] == "distrusted"
    if not is_finite(first):
        verdict.outcome, verdict.detail = "WRONG", "not finite"
        return verdict
    if share > OPEN:
        verdict.outcome = "distrusted" if warned else "WRONG"
        verdict.detail = f"{_percent(share)} of the energy moved is missing"
        return verdict
    try:
        second = run(replace(case, step_factor=1.0), halved(settings, first), drive)
    except cd.ChaindriveError as error:
        verdict.detail = f"half the step: {str(error).splitlines()[-1]}"
        return verdict
    ours, finer = statistics(case, first), statistics(case, second)
    verdict.deviation = float(np.abs(ours - finer).max() / finer[1].max())
    if verdict.deviation <= ALIKE:
        verdict.outcome = "converged"
    return verdict
