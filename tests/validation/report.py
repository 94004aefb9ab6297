"""Write docs/validation.md from the verdicts that the tests of the validation cases left.

`make validation-report` runs those tests with CHAINDRIVE_VERDICTS naming a file, to which each
appends a line of JSON for every value it judged, and then this script. It lists every folder of
tests/validation, and fails when one of them has no verdict.
"""

from __future__ import annotations

import argparse
import json
import math
import re
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TypeGuard

HERE = Path(__file__).resolve().parent
KEYS = (
    "case",
    "kind",
    "judged",
    "quantity",
    "unit",
    "expected",
    "found",
    "tolerance",
    "agrees",
    "source",
    "note",
)
JUDGED = ("quantitative", "trend", "undecided", "carried")
# By the first letter of a case, in the order of the report.
GROUPS = {
    "M": "Measured",
    "K": "Kinematics",
    "I": "Seating impacts",
    "C": "Contact and impact",
    "E": "Motion and energy",
    "F": "Friction",
    "L": "Load on the teeth",
    "S": "Joints with clearance",
    "T": "Tension of moving chains",
    "V": "Vibration and rest of spans",
    "X": "Other codes",
}


class ReportError(Exception):
    """The report cannot be true: a case without verdict, or a verdict without case."""


@dataclass(frozen=True)
class Case:
    """One folder of tests/validation."""

    name: str
    title: str
    source: str
    #: Reason for every quantity that the case lists and no test judges.
    carried: dict[str, str]
    #: Reason why no verdict is passed on the case as a whole.
    not_judged: str | None


@dataclass
class Row:
    """All values of one quantity of a case: the worst of them, and how many there are."""

    case: str
    kind: str
    judged: str
    quantity: str
    unit: str
    expected: object
    found: object
    tolerance: object
    agrees: bool
    note: str
    values: int = 1

    @property
    def share(self) -> float:
        """Deviation in parts of the tolerance, as far as there are numbers."""
        if self.found is None:
            return math.inf
        off, allowed = deviation(self.found, self.expected), allowance(self)
        if off is None or allowed is None:
            return 0.0 if self.agrees else math.inf
        if isinstance(self.tolerance, str) and self.tolerance.startswith("-"):
            off = max(-off, 0.0)
        off = abs(off)
        if off == 0.0:
            return 0.0
        return off / allowed if allowed > 0.0 else math.inf


def is_number(value: object) -> TypeGuard[float]:
    return isinstance(value, int | float) and not isinstance(value, bool)


def deviation(found: object, expected: object) -> float | None:
    """Found less expected, where both are numbers."""
    if is_number(found) and is_number(expected):
        return found - expected
    return None


def percentage(tolerance: object) -> float | None:
    """The number before the sign of a tolerance relative to the expected value, "2 %"."""
    match = re.fullmatch(r"±? ?([\d.e+-]+) ?%", tolerance) if isinstance(tolerance, str) else None
    return float(match[1]) if match else None


def allowance(row: Row) -> float | None:
    """How far off is allowed, in the unit of the quantity."""
    if is_number(row.tolerance):
        return float(row.tolerance)
    percent = percentage(row.tolerance)
    if percent is not None and is_number(row.expected):
        return 0.01 * percent * abs(row.expected)
    if isinstance(row.tolerance, str) and re.fullmatch(r"-[\d.e+-]+", row.tolerance):
        return -float(row.tolerance)
    return None


def read_cases(folder: Path) -> dict[str, Case]:
    """Every folder of tests/validation, by its name."""
    cases = {}
    for path in sorted(path for path in folder.iterdir() if path.is_dir()):
        if path.name.startswith((".", "_")):
            continue
        reference = path / "reference.json"
        if not reference.is_file():
            raise ReportError(f"{path.name} has no reference.json")
        content = json.loads(reference.read_text(encoding="utf-8"))
        absent = [key for key in ("title", "source") if not content.get(key)]
        if absent:
            raise ReportError(f"{path.name}/reference.json says nothing of {' and '.join(absent)}")
        carried = {}
        for entry in content.get("carried", []):
            if not entry.get("quantity") or not entry.get("reason"):
                raise ReportError(f"{path.name}: an entry of `carried` needs quantity and reason")
            carried[entry["quantity"]] = entry["reason"]
        cases[path.name] = Case(
            path.name, content["title"], content["source"], carried, content.get("not_judged")
        )
    if not cases:
        raise ReportError(f"{folder} holds no case")
    return cases


def read_verdicts(path: Path) -> list[Row]:
    """Values of one quantity become one row, the worst of them."""
    if not path.is_file():
        raise ReportError(f"{path} does not exist: did the tests run with CHAINDRIVE_VERDICTS?")
    rows: dict[tuple[str, ...], Row] = {}
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        try:
            value = json.loads(line)
        except json.JSONDecodeError as error:
            raise ReportError(f"{path}, line {number} is no JSON: {error}") from error
        absent = [key for key in KEYS if key not in value]
        if absent:
            raise ReportError(f"{path}, line {number} lacks {', '.join(absent)}")
        if value["kind"] not in ("measured", "computed"):
            raise ReportError(f"{path}, line {number}: kind is measured or computed")
        if value["judged"] not in JUDGED:
            raise ReportError(f"{path}, line {number}: judged is one of {', '.join(JUDGED)}")
        del value["source"]
        row = Row(**{key: value[key] for key in KEYS if key in value})
        # Whoever judged may have rounded differently.
        if row.agrees and row.share > 1.001:
            raise ReportError(f"{path}, line {number} agrees, though it is off by more: {line}")
        key = (row.case, row.kind, row.judged, row.quantity, row.unit)
        before = rows.get(key)
        if before is None:
            rows[key] = row
            continue
        worst = max(before, row, key=lambda row: (not row.agrees, row.share))
        worst.values = before.values + 1
        rows[key] = worst
    return list(rows.values())


def is_excused(case: Case, rows: list[Row]) -> bool:
    """Whether the case says why there is no verdict: on the whole, or on all that its test saw."""
    seen = {row.quantity for row in rows if row.case == case.name and row.judged == "carried"}
    return bool(case.not_judged or (case.carried and seen == set(case.carried)))


def check(cases: dict[str, Case], rows: list[Row]) -> None:
    """Every case has a verdict or says why not, and every verdict belongs to a case."""
    strange = sorted({row.case for row in rows} - set(cases))
    if strange:
        raise ReportError(f"verdicts of cases without a folder: {', '.join(strange)}")
    for row in rows:
        if row.judged == "carried" and row.quantity not in cases[row.case].carried:
            raise ReportError(f"{row.case} gives no reason in `carried` for: {row.quantity}")
    judged = {row.case for row in rows if row.judged != "carried"}
    without = [name for name in cases if name not in judged and not is_excused(cases[name], rows)]
    if without:
        raise ReportError(
            f"no verdict on {', '.join(without)}: judge them in a test, "
            "or say in `not_judged` of their reference.json why not"
        )
    both = sorted(name for name in judged if cases[name].not_judged)
    if both:
        raise ReportError(f"{', '.join(both)}: `not_judged`, and yet there is a verdict")


def escape(text: str) -> str:
    """A text as a cell of a table shows it."""
    return re.sub(r"([\\`*_|<>\[\]])", r"\\\1", " ".join(text.split()))


def sign(text: str) -> str:
    return text.replace("-", "−")


def show(value: object, unit: str) -> str:
    """A value with its unit."""
    if value is None:
        return "not a number"
    if unit in ("1", "-", "–"):
        unit = ""
    if is_number(value):
        return f"{sign(f'{value + 0.0:.6g}')} {escape(unit)}".rstrip()
    if isinstance(value, list):
        return ", ".join(show(part, "") for part in value) + (f" {escape(unit)}" if unit else "")
    return escape(str(value))


def show_error(row: Row) -> str:
    """Deviation in the terms of the tolerance."""
    off = deviation(row.found, row.expected)
    if off is None:
        return ""
    if percentage(row.tolerance) is not None and is_number(row.expected) and row.expected:
        percent = 100.0 * off / abs(row.expected)
        return sign(f"{percent:+.0f} %" if abs(percent) >= 10.0 else f"{percent:+.2g} %")
    return sign(f"{off:+.2g}") if off else "0"


def show_tolerance(row: Row) -> str:
    percent = percentage(row.tolerance)
    if percent is not None:
        return f"± {sign(f'{percent:.3g}')} %"
    if is_number(row.tolerance):
        return f"± {sign(f'{row.tolerance:.3g}')}" if row.tolerance else "exact"
    if row.tolerance is None:
        return ""
    return sign(escape(str(row.tolerance)))


def table(head: list[str], lines: list[list[str]]) -> list[str]:
    rule = ["---"] * len(head)
    return [f"| {' | '.join(cells)} |" for cells in [head, rule, *lines]]


HEAD = ["case", "quantity", "expected", "found", "error", "tolerance"]


def cells(row: Row) -> list[str]:
    trend = " (trend)" if row.judged == "trend" else ""
    # What is not judged may not have been looked for either.
    absent = row.judged == "carried" and row.found is None
    return [
        row.case,
        escape(row.quantity) + trend,
        "" if row.expected is None else show(row.expected, row.unit),
        "" if absent else show(row.found, row.unit),
        show_error(row),
        show_tolerance(row),
    ]


def summary(cases: dict[str, Case], rows: list[Row]) -> list[str]:
    """How many agree and miss, computed and measured, numbers and trends."""
    lines = []
    for kind in ("measured", "computed"):
        for judged, name in (("quantitative", "numbers"), ("trend", "trends")):
            these = [row for row in rows if row.kind == kind and row.judged == judged]
            misses = [row for row in these if not row.agrees]
            missed = {row.case for row in misses}
            lines.append(
                [
                    f"{kind}, {name}",
                    str(len({row.case for row in these} - missed)),
                    str(len(missed)),
                    str(len(these) - len(misses)),
                    str(len(misses)),
                ]
            )
    head = ["", "cases that agree", "cases that miss", "quantities that agree", "that miss"]
    decided = {row.case for row in rows if row.judged != "carried"}
    carried = sum(len(case.carried) for name, case in cases.items() if name in decided)
    undecided = sum(row.judged == "undecided" for row in rows)
    return [
        f"{len(cases)} cases. A case that is judged by numbers and by trends counts in both lines; "
        "it agrees when all of its quantities do.",
        "",
        *table(head, lines),
        "",
        f"Undecided, because open inputs leave more room than the measurement: {undecided}. "
        f"Carried without a verdict: quantities of cases that are judged: {carried}; whole "
        f"cases: {len(cases) - len(decided)}.",
    ]


def misses(cases: dict[str, Case], rows: list[Row]) -> list[str]:
    """Misses with the physics that is missing, and what no verdict is passed on."""
    missed = [row for row in rows if not row.agrees and row.judged in ("quantitative", "trend")]
    lines = ["## Misses", ""]
    if missed:
        lines += table([*HEAD, "why"], [[*cells(row), escape(row.note)] for row in missed])
    else:
        lines.append("None among the quantities that are judged.")
    found = {(row.case, row.quantity): row for row in rows if row.judged == "carried"}
    carried = []
    for case in cases.values():
        if case.not_judged:
            carried.append([case.name, "the whole case", "", "", "", "", escape(case.not_judged)])
        for quantity, reason in case.carried.items():
            row = found.get((case.name, quantity))
            empty = [case.name, escape(quantity), "", "", "", ""]
            carried.append([*(cells(row) if row else empty), escape(reason)])
    if carried:
        lines += [
            "",
            "### Carried, not judged",
            "",
            "The cases list these, and say why no verdict is passed on them. Tolerances are those "
            "of the quantities beside them that are judged.",
            "",
            *table([*HEAD, "why not"], carried),
        ]
    return lines


def group(name: str, cases: list[Case], rows: list[Row]) -> list[str]:
    """One table of what the cases of a group found, and where their numbers come from."""
    head = [*HEAD, "values"]
    lines = [f"## {name}", ""]
    judged = [row for row in rows if row.judged != "carried"]
    measured = any(row.kind == "measured" for row in judged)
    if measured:
        head.append("verdict")
    body = []
    for row in judged:
        line = [*cells(row), str(row.values)]
        if measured:
            verdict = "agrees" if row.agrees else "**misses**"
            verdict = "undecided" if row.judged == "undecided" else verdict
            line.append(f"{verdict}: {escape(row.note)}" if row.note.strip() else verdict)
        body.append(line)
    lines += table(head, body) if body else ["No quantity of these cases is judged."]
    lines += ["", *(f"- {c.name}, {escape(c.title)}: {escape(c.source)}" for c in cases)]
    return lines


def write(cases: dict[str, Case], rows: list[Row]) -> str:
    """The whole report."""
    # Tests run side by side: the order of their lines means nothing.
    rows = sorted(rows, key=lambda row: (row.case, row.judged, row.quantity))
    text = [
        "# Validation",
        "",
        "Written by `make validation-report` from the verdicts of the tests. A quantity with "
        "several values shows the one that is farthest off in parts of its tolerance; an error is "
        "found less expected, in per cent where the tolerance is, otherwise in the unit of the "
        'quantity. "−0.3" as a tolerance allows falling short by that much, and any excess.',
        "",
        *summary(cases, rows),
        "",
        *misses(cases, rows),
    ]
    letters = sorted({name[0] for name in cases} - set(GROUPS))
    for letter, title in [*GROUPS.items(), *((letter, letter) for letter in letters)]:
        these = [case for case in cases.values() if case.name[0] == letter]
        if these:
            text += ["", *group(title, these, [row for row in rows if row.case[0] == letter])]
    return "\n".join(text) + "\n"


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("verdicts", type=Path, help="file that CHAINDRIVE_VERDICTS named")
    parser.add_argument("--cases", type=Path, default=HERE, help="folder of the cases")
    parser.add_argument("--out", type=Path, default=HERE.parent.parent / "docs/validation.md")
    given = parser.parse_args(arguments)
    try:
        cases, rows = read_cases(given.cases), read_verdicts(given.verdicts)
        check(cases, rows)
    except ReportError as error:
        print(f"no report: {error}", file=sys.stderr)
        return 1
    given.out.write_text(write(cases, rows), encoding="utf-8")
    print(f"wrote {given.out}: {len(cases)} cases, {len(rows)} quantities")
    return 0


if __name__ == "__main__":
    sys.exit(main())
