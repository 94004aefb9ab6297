"""Simulator of roller chain drives: sprockets, guides, tensioners and the chain between them.

    >>> import chaindrive as cd
    >>> drive = cd.scenes.spinning_ring()
    >>> run = cd.simulate(drive, until=0.01, record=["link_tension"])
    >>> run["link_tension"].dims
    ('time', 'link')

A `Drive` is read from a scene file (`load`), from text, from a dict or from `scenes`; `simulate`
moves it and returns an `xarray.Dataset` with names, units and provenance; `sweep` does so for many
variants at once, and a `Simulation` is moved by a program of your own. Quantities are in SI
units throughout; scene files may carry units of their own. Counter-clockwise angles, tensions and
penetrations are positive.
"""

# Public names and the modules that define them, a line each, as type checkers read them. Nothing
# is imported before it is asked for: xarray alone takes longer than all of a short command, and the
# command hears Ctrl-C before it imports the core. No name is that of a module that defines
# something else, which the import would hide.
_STUB = __spec__.loader.get_data(f"{__file__}i").decode()
_LINES = [line.split() for line in _STUB.splitlines() if line.startswith("from ")]
_HOME = {name: module for _, module, _, _, _, name in _LINES}

__all__ = sorted(_HOME)


def __getattr__(name: str) -> object:
    import sys
    from importlib import import_module

    if _HOME.get(name) == __name__:
        return import_module(f"{__name__}.{name}")
    if name in _HOME:
        value = getattr(import_module(_HOME[name]), name)
        globals()[name] = value
        return value
    # With the module at hand Python adds which name may have been meant.
    message = f"module 'chaindrive' has no attribute {name!r}"
    raise AttributeError(message, name=name, obj=sys.modules[__name__])


def __dir__() -> list[str]:
    return list(__all__)
