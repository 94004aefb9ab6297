"""Work and precision of the methods."""

import matplotlib.pyplot as plt

import chaindrive as cd
from page import Page
from stepping import at_once


def report(page: Page) -> None:
    """Draw error against processor time of every method."""
    page.add(
        "## Work and precision",
        "",
        "`chaindrive.work_precision`: errors of the tight span, root mean square over the mean, "
        "against a reference that a second method confirms, over processor time as it was.",
    )
    drives = {
        "large chain on two sprockets": cd.scenes.marine_two_sprockets(),
        "marine engine as in the paper": cd.scenes.marine_engine_bare(),
        "bicycle, clearance joints": cd.scenes.bicycle(),
    }
    if page.quick:
        drives = dict(list(drives.items())[:1])
    figure, axes = plt.subplots(
        1, len(drives), figsize=(4.5 * len(drives), 3.6), squeeze=False, layout="constrained"
    )
    for (name, drive), axis in zip(drives.items(), axes[0], strict=True):
        options = {"methods": "verlet", "until": 2e-3} if page.quick else {"replicates": 1}
        table = cd.work_precision(at_once(drive), repeats=1, **options)
        cd.plot.work_precision(table, ax=axis)
        axis.set_title(name, fontsize=9)
    page.figure(figure, "work_precision", "Error against time of the methods")
