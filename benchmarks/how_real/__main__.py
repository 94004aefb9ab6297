"""Write the tables and diagrams of docs/how-real.md: assumptions, what is left out, models, oil.

Run it as ``make how-real``, or ``python benchmarks/how_real [PRESET …] [--quick]``, which prints
what it would write. It takes some twenty minutes on two cores.
"""

import argparse
from pathlib import Path

import matplotlib as mpl

import models
import oil
import seatings
import tornado
from assumptions import cases
from left_out import left_out

mpl.use("Agg")

DOCS = Path(__file__).resolve().parents[2] / "docs"


def write_into(text: str, mark: str, lines: list[str]) -> str:
    """Return the text with lines between the marks of that name."""
    begin, end = f"<!-- {mark}: begin -->", f"<!-- {mark}: end -->"
    before, rest = text.split(begin)
    _, after = rest.split(end)
    return before + "\n".join([begin, "", *lines, end]) + after


def main() -> None:
    parser = argparse.ArgumentParser(description="Try the assumptions and the models of presets.")
    every = cases()
    names = [case.preset for case in every]
    parser.add_argument("presets", nargs="*", metavar="PRESET", help=f"of {', '.join(names)}; all")
    parser.add_argument("--quick", action="store_true", help="short runs, two assumptions each")
    arguments = parser.parse_args()
    unknown = set(arguments.presets) - set(names)
    if unknown:
        parser.error(f"unknown preset {', '.join(sorted(unknown))}; there are {', '.join(names)}")
    whole = not (arguments.presets or arguments.quick)
    wanted = arguments.presets or names
    added = left_out()
    if arguments.quick:
        every, added = (tuple(case.shortened() for case in it) for it in (every, added))
    drives = [drive for drive in models.DRIVES if drive[0] in wanted]
    share = 0.02 if arguments.quick else 1.0
    by_model = [line for drive in drives for line in models.table(*drive, share)]
    struck: list[str] = []
    if seatings.PRESET in wanted:
        struck = list(seatings.table(*((1, 0.2) if arguments.quick else (5, 1.0))))
    oiled: list[str] = []
    if oil.DRY in wanted:
        oiled = list(oil.table(0.1 if arguments.quick else 1.0))
    results, results_added = (
        [(case, tornado.effects(case)) for case in it if case.preset in wanted]
        for it in (every, added)
    )
    effects, effects_added = (
        [line for result in it for line in tornado.table(*result)]
        for it in (results, results_added)
    )
    if not whole:
        print("\n".join([*effects, *effects_added, *by_model, *struck, *oiled]))
        return
    page = DOCS / "how-real.md"
    text = write_into(page.read_text(encoding="utf-8"), "assumptions", effects)
    text = write_into(text, "left-out", effects_added)
    text = write_into(text, "models", by_model)
    text = write_into(text, "seatings", struck)
    page.write_text(write_into(text, "oil", oiled), encoding="utf-8")
    tornado.draw(results, DOCS / "how-real.png")
    oil.draw(DOCS / "how-real_oil.png")
    tornado.draw(results_added, DOCS / "how-real_left-out.png")


if __name__ == "__main__":
    main()
