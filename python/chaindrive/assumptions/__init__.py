"""What is not known of a drive, and how far it moves what one reads off it.

`chaindrive.tornado` moves one assumption at a time to the ends of its range,
`chaindrive.uncertainty` draws all of them at once from distributions. Here stand what both read
off a drive: `OUTPUTS`, and `DERIVED`, the ones that are no statistic of a sweep.

    >>> import chaindrive as cd
    >>> cd.assumptions.OUTPUTS
    ('span_tension_mean', 'span_tension_std', 'contact_force_p99', 'loss_share')
"""

from chaindrive.assumptions.outputs import DERIVED, OUTPUTS

__all__ = ["DERIVED", "OUTPUTS"]


def __dir__() -> list[str]:
    return list(__all__)
