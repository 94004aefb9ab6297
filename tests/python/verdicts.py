"""Verdicts on measured cases: the rows of a case, how they are judged, and the lines of the report.

A row of a `reference.json` is a measured number with a tolerance, or a trend in words, with the
verdict that was recorded and the figure that was found. A test judges every row anew. It fails when
the verdict is another one, agreement, miss or undecided, when the figure has left what was
recorded, and when a row was forgotten. Where the environment variable `CHAINDRIVE_VERDICTS` names
a file, each row is appended to it as a line of JSON, before the test can fail.
"""

import json
import os
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import chaindrive as cd

CASES = Path(__file__).resolve().parents[1] / "validation"

STALE = 0.03
"""How far a figure may be from the recorded one before the record counts as stale [–]."""


class MeasuredCase:
    """A case of `tests/validation`, as a context: at its end every row must have been judged."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.data: dict[str, Any] = json.loads(
            (CASES / name / "reference.json").read_text(encoding="utf-8")
        )
        self._open = {row["quantity"]: row for row in self.data.get("rows", [])}

    def __enter__(self) -> Self:
        for row in self.data.get("carried", []):
            self._record(
                judged="carried",
                quantity=row["quantity"],
                unit=row.get("unit", ""),
                expected=row.get("expected"),
                found=None,
                tolerance=None,
                agrees=False,
                note=row["reason"],
            )
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if error is None:
            assert not self._open, f"{self.name}: not judged: {', '.join(self._open)}"

    def drive(self) -> cd.Drive:
        """Drive of the case: its `scene` is a file, as seen from the cases, or a preset."""
        scene: str = self.data["scene"]
        if scene.endswith(".toml"):
            return cd.load(CASES / scene)
        preset: cd.Drive = getattr(cd.scenes, scene)()
        return preset

    def row(self, quantity: str) -> dict[str, Any]:
        """Row of the case that has this quantity."""
        rows: list[dict[str, Any]] = self.data["rows"]
        return next(row for row in rows if row["quantity"] == quantity)

    def number(
        self,
        quantity: str,
        found: float,
        note: str = "",
        interval: tuple[float, float] | None = None,
    ) -> None:
        """Judge a measured number by its tolerance: absolute, or a share of it ("10 %").

        With an interval over the ranges of the open inputs, that is judged in the place of the
        number: it agrees where it reaches the tolerance, and is undecided where it does and is
        wider than the tolerance on both sides.
        """
        row = self._open.pop(quantity)
        tolerance = row["tolerance"]
        share = isinstance(tolerance, str)
        allowed = float(tolerance.rstrip("% ")) / 100 * abs(row["expected"]) if share else tolerance
        found = float(found)
        low, high = interval or (found, found)
        reaches = low - allowed <= row["expected"] <= high + allowed
        verdict = "agrees" if reaches else "misses"
        if reaches and high - low > 2 * allowed:
            verdict = "undecided"
        if interval:
            note = f"{low:.4g} to {high:.4g} {row['unit']} over the open inputs. {note}".strip()
        self._judge(row, verdict, float(f"{found:.5g}"), note)
        off = abs(found - row["found"])
        assert off <= STALE * max(abs(row["found"]), abs(row["expected"])), (
            f"{self.name}, {quantity}: {found:.5g}, recorded as {row['found']}"
        )

    def trend(self, quantity: str, holds: bool, found: str) -> None:
        """Judge a statement about signs and order; `found` tells the figures behind it."""
        self._judge(self._open.pop(quantity), "agrees" if holds else "misses", found, "")

    def _judge(self, row: dict[str, Any], now: str, found: float | str, note: str) -> None:
        notes = [note, row.get("note", ""), row.get("missing", "")]
        self._record(
            judged="undecided" if now == "undecided" else row["judged"],
            quantity=row["quantity"],
            unit=row.get("unit", ""),
            expected=row["expected"],
            found=found,
            tolerance=row.get("tolerance"),
            agrees=now == "agrees",
            note=" ".join(part for part in notes if part),
            kind=row.get("kind", "measured"),
        )
        told = f"{found}, measured: {row['expected']}: {now}. {note}"
        print(f"{self.name}, {row['quantity']}: {told}")
        assert now == row["verdict"], (
            f"{self.name}, {row['quantity']}: {now} with {found}, recorded: {row['verdict']} with "
            f"{row['found']}, measured: {row['expected']}"
        )

    def _record(self, kind: str = "measured", **row: Any) -> None:
        target = os.environ.get("CHAINDRIVE_VERDICTS")
        if not target:
            return
        line = {"case": self.name, "kind": kind, **row, "source": self.data["source"]}
        # Other processes append to the same file: one write a line keeps lines whole.
        file = os.open(target, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o644)
        try:
            os.write(file, (json.dumps(line, ensure_ascii=False) + "\n").encode())
        finally:
            os.close(file)
