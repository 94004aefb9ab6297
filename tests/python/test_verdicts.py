"""Verdicts on measured cases: what is recorded, and what makes a test fail."""

import json
from pathlib import Path
from typing import Any

import pytest
import verdicts
from verdicts import MeasuredCase

HIT = {
    "quantity": "loss",
    "unit": "W",
    "judged": "quantitative",
    "expected": 10.0,
    "tolerance": "10 %",
    "found": 10.5,
    "verdict": "agrees",
}
MISS = {
    "quantity": "sign",
    "judged": "trend",
    "expected": "more",
    "found": "less",
    "verdict": "misses",
    "missing": "wear",
}


@pytest.fixture
def lines(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """Makes a case with a hit, a miss and a carried row; reads what was recorded."""
    case = {
        "source": "a book",
        "rows": [HIT, MISS],
        "carried": [{"quantity": "noise", "reason": "no sound"}],
    }
    (tmp_path / "M99").mkdir()
    (tmp_path / "M99" / "reference.json").write_text(json.dumps(case), encoding="utf-8")
    monkeypatch.setattr(verdicts, "CASES", tmp_path)
    monkeypatch.setenv("CHAINDRIVE_VERDICTS", str(tmp_path / "verdicts.jsonl"))

    def read() -> list[dict[str, Any]]:
        text = (tmp_path / "verdicts.jsonl").read_text(encoding="utf-8")
        return [json.loads(line) for line in text.splitlines()]

    return read


def test_hits_misses_and_what_is_carried_are_recorded(lines: Any) -> None:
    with MeasuredCase("M99") as case:
        case.number("loss", 10.4, "by hand.")
        case.trend("sign", False, "less")
    carried, hit, miss = lines()
    assert (carried["judged"], carried["agrees"], carried["note"]) == ("carried", False, "no sound")
    assert (hit["judged"], hit["agrees"], hit["found"], hit["expected"]) == (
        "quantitative",
        True,
        10.4,
        10.0,
    )
    assert (hit["case"], hit["kind"], hit["unit"], hit["source"]) == (
        "M99",
        "measured",
        "W",
        "a book",
    )
    assert (miss["judged"], miss["agrees"], miss["note"]) == ("trend", False, "wear")
    keys = "case kind judged quantity unit expected found tolerance agrees source note"
    assert all(set(line) == set(keys.split()) for line in (carried, hit, miss))


@pytest.mark.parametrize(
    ("loss", "more", "said"),
    [
        (11.5, False, "loss: misses with 11.5, recorded: agrees"),
        (10.0, False, "loss: 10, recorded as 10.5"),
        (10.5, True, "sign: agrees with less, recorded: misses"),
    ],
)
def test_other_verdicts_and_figures_fail_and_are_recorded(
    lines: Any, loss: float, more: bool, said: str
) -> None:
    def judge() -> None:
        with MeasuredCase("M99") as case:
            case.number("loss", loss)
            case.trend("sign", more, "less")

    with pytest.raises(AssertionError, match=said):
        judge()
    assert lines()[-1]["quantity"] == said.partition(":")[0]


def test_no_row_is_forgotten(lines: Any) -> None:
    with pytest.raises(AssertionError, match="not judged: sign"), MeasuredCase("M99") as case:
        case.number("loss", 10.5)
    assert len(lines()) == 2
