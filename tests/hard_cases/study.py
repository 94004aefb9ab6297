"""Run every hard case with every method and write docs/hard-cases.md.

python tests/hard_cases/study.py            # some minutes
python tests/hard_cases/study.py --only "e = 1"
"""

import argparse
import sys
import time
from pathlib import Path

import cases
import judge

PAGE = Path(__file__).resolve().parents[2] / "docs" / "hard-cases.md"
BEGIN, END = "<!-- written by tests/hard_cases/study.py -->", "<!-- until here -->"


def study(rows, methods, only):
    """Return the verdicts, by case and method."""
    found = {}
    for case in rows:
        if only and only not in case.name:
            continue
        found[case.name] = {}
        for name, settings in methods.items():
            begin = time.perf_counter()
            verdict = judge.judge(case, settings)
            found[case.name][name] = verdict
            print(
                f"{case.name:20} {name:20} {verdict!s:30} {verdict.tension:9.0f} N "
                f"{verdict.steps:8} steps {time.perf_counter() - begin:6.1f} s  {verdict.detail}",
                file=sys.stderr,
                flush=True,
            )
    return found


def table(rows, methods, found):
    """Write the verdicts as Markdown, with the messages of refusals below."""
    lines = [
        "| case | what is hard | " + " | ".join(methods) + " | tightest span |",
        "|" + "---|" * (len(methods) + 3),
    ]
    notes = {}
    for case in rows:
        if case.name not in found:
            continue
        cells = []
        for verdict in found[case.name].values():
            mark = ""
            if verdict.detail:
                mark = f" ({notes.setdefault(verdict.detail, len(notes) + 1)})"
            cells.append(f"{verdict}{mark}")
        lines.append(
            f"| {case.name} | {case.what} | "
            + " | ".join(cells)
            + f" | {spread(found[case.name])} |"
        )
    lines.append("")
    lines += [f"({number}) {detail}  " for detail, number in notes.items()]
    return "\n".join(lines).rstrip()


def spread(verdicts):
    """Least and greatest mean tension that the converged runs of a case found."""
    tensions = [v.tension for v in verdicts.values() if v.outcome == "converged"]
    if not tensions:
        return "–"
    least, greatest = min(tensions), max(tensions)
    unit, scale = ("kN", 1e3) if greatest > 1e4 else ("N", 1.0)
    return f"{least / scale:.4g} to {greatest / scale:.4g} {unit}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", help="cases whose name contains this; prints instead of writing")
    arguments = parser.parse_args()
    parts = []
    for title, rows, methods in [
        ("Particles", cases.PARTICLES, judge.METHODS),
        ("Clearance joints", cases.CLEARANCE, judge.CLEARANCE_METHODS),
    ]:
        found = study(rows, methods, arguments.only)
        parts.append(f"## {title}\n\n{table(rows, methods, found)}")
    text = "\n\n".join(parts)
    if arguments.only:
        print(text)
        return
    before, rest = PAGE.read_text(encoding="utf-8").split(BEGIN)
    after = rest.split(END)[1]
    PAGE.write_text(f"{before}{BEGIN}\n\n{text}\n\n{END}{after}", encoding="utf-8")


if __name__ == "__main__":
    main()
