"""Drives that a browser computes while one looks at them."""

from __future__ import annotations

import base64
import json
import zlib
from os import PathLike, fspath
from pathlib import Path
from typing import ClassVar

from chaindrive import _core
from chaindrive.drive import Drive, _needed
from chaindrive.errors import ChaindriveError
from chaindrive.shown_page import ShownPage

__all__ = ["Lab", "lab", "lab_link"]

#: The page without a scene, which wheels have and `make lab` builds.
PAGE = Path(__file__).with_name("library") / "lab.html"

#: Characters of a scene in a link, at most: the page takes no longer one.
_LONGEST_LINK = 32768


class Lab(ShownPage):
    """A drive as one HTML page that computes it, with the core of this package as WebAssembly."""

    _kind: ClassVar[str] = "lab"
    _height: ClassVar[int] = 820


def lab(drive: Drive, path: str | PathLike[str] | None = None) -> Lab:
    """Make a page in which a drive is computed while one looks at it.

    The page needs no server, network or installation. Speeds, loads and centres follow a slider
    while the drive runs; pretension, friction, teeth and the text of the scene start it anew. Press
    ``?`` in the page for its keys.

    Parameters
    ----------
    drive
        The drive on which it opens.
    path
        Where to write, ``.html``. Nothing is written when absent.

    Returns
    -------
    Lab
        The page, which a notebook shows.

    Raises
    ------
    ChaindriveError
        This build has no lab: a wheel has it, and ``make lab`` builds it.
    ValueError
        The path ends in something else.
    WriteError
        The file cannot be written; what was in its place is still there.

    Examples
    --------
    >>> import chaindrive as cd
    >>> page = cd.lab(cd.scenes.timing_drive())  # doctest: +SKIP
    >>> page.save("timing_drive.html")  # doctest: +SKIP
    """
    _needed(drive)
    if path is not None and Path(fspath(path)).suffix not in (".html", ".htm"):
        raise ValueError(f"{path!s}: the name must end in .html")
    place = None if path is None else _core.NewFile(path)
    try:
        built = PAGE.read_text(encoding="utf-8")
    except FileNotFoundError:
        message = "this build has no lab: take a wheel, which has one, or build it: make lab"
        raise ChaindriveError(message) from None
    page = Lab(_core.lab_page(built, drive.text, drive.name))
    if place is not None:
        place.write(page.html.encode())
    return page


def lab_link(drive: Drive, page: str = "lab.html") -> str:
    """Make a link that opens a lab on a drive: one page serves many drives.

    The scene stands, compressed, in the fragment of the address, which a browser does not send to
    the server.

    Parameters
    ----------
    drive
        The drive on which the page opens.
    page
        Address of a page that `lab` or ``chaindrive lab`` has made, of whatever drive.

    Raises
    ------
    ChaindriveError
        The scene takes more than 32 kB, compressed.

    Examples
    --------
    >>> import chaindrive as cd
    >>> link = cd.lab_link(cd.scenes.timing_drive(), "https://example.org/lab.html")
    >>> link[:35]
    'https://example.org/lab.html#scene='
    """
    _needed(drive)
    scene = json.dumps({"name": drive.name, "text": drive.text})
    raw = zlib.compressobj(level=9, wbits=-15)
    packed = base64.urlsafe_b64encode(raw.compress(scene.encode()) + raw.flush()).rstrip(b"=")
    if len(packed) > _LONGEST_LINK:
        size = -(-len(packed) // 1024)
        message = f"the scene takes {size} kB in a link, and 32 kB are the most: lab(drive, path)"
        raise ChaindriveError(message)
    return f"{page}#scene={packed.decode()}"
