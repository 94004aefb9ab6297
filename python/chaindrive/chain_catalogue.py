"""The catalogue of chains: dimensions, masses, stiffness, and where they are from."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from chaindrive import _core

__all__ = ["catalogue"]


def catalogue() -> xr.Dataset:
    """Return the chains that a scene can name, ``chain = "16B-1"``.

    Returns
    -------
    xarray.Dataset
        One variable a column, (chain,), in SI units, NaN where the table has no value, with
        ``units``, ``long_name`` and ``status``: the name of the variable that says in words
        where each value is from, a catalogue, a computation or an assumption. ``ansi`` is the ANSI
        number, ``kind`` what runs on the teeth, ``makers_differ`` where makers do.

    Examples
    --------
    >>> import chaindrive as cd
    >>> chains = cd.catalogue()
    >>> float(chains["pitch"].sel(chain="16B-1"))
    0.0254
    >>> "assumed" in str(chains["mass_status"].sel(chain="16B-1").item())
    True
    """
    table = _core.catalogue()
    variables: dict[str, Any] = {}
    for name, (values, unit, text, status) in table["numbers"].items():
        about = {"units": unit, "long_name": text, "status": status}
        variables[name] = ("chain", values, about)
    texts = {name: table[name] for name in ("ansi", "kind", "makers_differ")} | table["statuses"]
    for name, values in texts.items():
        variables[name] = ("chain", np.asarray(values, dtype=np.str_))
    return xr.Dataset(variables, coords={"chain": np.asarray(table["chain"], dtype=np.str_)})
