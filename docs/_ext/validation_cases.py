"""The directive `validation-cases`: a table of the computed cases, from their folders."""

import json
from pathlib import Path
from typing import Any, ClassVar

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

CASES = Path(__file__).resolve().parents[2] / "tests" / "validation"


class ValidationCases(SphinxDirective):
    """Lists the cases whose names begin with a letter."""

    required_arguments = 1
    option_spec: ClassVar = {}

    def run(self) -> list[nodes.Node]:
        lines = ["| case | title | tolerance | source |", "|---|---|---|---|"]
        places = sorted(CASES.glob(f"{self.arguments[0]}*/reference.json"))
        if not places:
            raise self.error(f"no validation case begins with {self.arguments[0]}")
        for place in places:
            self.env.note_dependency(str(place))
            case = json.loads(place.read_text(encoding="utf-8"))
            row = [case["id"], case["title"], tolerance(case), case["source"]]
            if "not_judged" in case:
                row[1] += f" (not met: {case['not_judged'].removeprefix('not met.').strip()})"
            lines.append("| " + " | ".join(cell(text) for text in row) + " |")
        return self.parse_text_to_nodes("\n".join(lines))


def tolerance(case: dict[str, Any]) -> str:
    """Return the tolerance of a case in a line."""
    given = case["tolerance"]
    if not isinstance(given, dict):
        given = {"relative": given}
    return "; ".join(f"{name.replace('_', ' ')} {value:g}" for name, value in given.items())


def cell(text: str) -> str:
    """Return a text as the cell of a table in Markdown."""
    text = " ".join(text.split())
    for character in "\\*_`[]<>|$":
        text = text.replace(character, "\\" + character)
    return text


def setup(app: Sphinx) -> dict[str, bool]:
    app.add_directive("validation-cases", ValidationCases)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
