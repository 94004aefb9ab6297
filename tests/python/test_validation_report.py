"""The report on the validation cases: nothing left out, misses first, tables that hold."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).resolve().parents[1] / "validation/report.py"


def case(folder, name, **more):
    (folder / name).mkdir(parents=True)
    content = {"id": name, "title": f"Case {name}", "source": "a | b, *Journal* 1", **more}
    text = json.dumps(content)
    (folder / name / "reference.json").write_text(text, encoding="utf-8")


def verdict(name, quantity="speed", **more):
    line = {
        "case": name,
        "kind": "computed",
        "judged": "quantitative",
        "quantity": quantity,
        "unit": "m/s",
        "expected": 2.0,
        "found": 2.001,
        "tolerance": "1.0 %",
        "agrees": True,
        "source": "theory",
        "note": "",
    }
    return line | more


@pytest.fixture
def write(tmp_path):
    """Write the report of some verdicts on the cases in `cases`."""

    def run(verdicts):
        lines = [json.dumps(line) + "\n" for line in verdicts]
        (tmp_path / "verdicts").write_text("".join(lines), encoding="utf-8")
        command = [sys.executable, str(SCRIPT), str(tmp_path / "verdicts")]
        command += ["--cases", str(tmp_path / "cases"), "--out", str(tmp_path / "page.md")]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        page = tmp_path / "page.md"
        text = page.read_text(encoding="utf-8") if page.exists() else None
        return done.returncode, done.stderr, text

    return run


def rows(page, start):
    return [line for line in page.splitlines() if line.startswith(f"| {start} ")]


def test_a_case_without_verdict_is_an_error_that_names_it(tmp_path, write):
    for name in ("K01", "K02", "V07"):
        quantities = ("sag", "pull")
        carried = [{"quantity": quantity, "reason": "unknown"} for quantity in quantities]
        case(tmp_path / "cases", name, carried=carried)
    # Of V07 its test saw a part only.
    code, message, page = write([verdict("K02"), verdict("V07", "sag", judged="carried")])
    assert code != 0
    assert "K01, V07" in message
    assert "K02" not in message
    assert page is None


def test_a_case_may_say_why_it_has_no_verdict(tmp_path, write):
    case(tmp_path / "cases", "K01")
    case(tmp_path / "cases", "X09", not_judged="its teeth are chords")
    code, message, page = write([verdict("K01")])
    assert (code, message) == (0, "")
    [row] = rows(page, "X09")
    assert "its teeth are chords" in row
    assert "whole cases: 1." in page
    # So may one whose test finds nothing that it can judge.
    case(tmp_path / "cases", "M07", carried=[{"quantity": "noise", "reason": "no sound"}])
    seen = {"judged": "carried", "found": None, "expected": None, "agrees": False}
    code, message, page = write([verdict("K01"), verdict("M07", "noise", **seen)])
    assert (code, message) == (0, "")
    assert rows(page, "M07") == ["| M07 | noise |  |  |  | ± 1 % | no sound |"]
    assert "whole cases: 2." in page
    # Once it is judged it needs no excuse.
    code, message, _ = write([verdict("K01"), verdict("M07", "noise", **seen), verdict("X09")])
    assert code != 0
    assert "X09" in message


def test_misses_come_first(tmp_path, write):
    case(tmp_path / "cases", "K01")
    case(tmp_path / "cases", "M02")
    case(tmp_path / "cases", "V03", carried=[{"quantity": "ripple", "reason": "resonance"}])
    miss = {"kind": "measured", "found": 2.5, "agrees": False, "note": "no oil in the joints"}
    code, _, page = write(
        [
            verdict("K01"),
            verdict("M02", "loss", **miss),
            verdict("M02", "order", kind="measured", judged="trend", expected="rises", found="up"),
            verdict("V03"),
            verdict("V03", "ripple", judged="carried", found=2.2, agrees=False),
        ]
    )
    assert code == 0
    first, *_ = (line for line in page.splitlines() if line.startswith("| ") and "speed" in line)
    before = page[: page.index(first)]
    assert "| M02 | loss | 2 m/s | 2.5 m/s | +25 % | ± 1 % | no oil in the joints |" in before
    assert "| V03 | ripple | 2 m/s | 2.2 m/s | +10 % | ± 1 % | resonance |" in before
    assert "| measured, numbers | 0 | 1 | 0 | 1 |" in page
    assert "| measured, trends | 1 | 0 | 1 | 0 |" in page
    assert "| computed, numbers | 2 | 0 | 2 | 0 |" in page
    assert page.index("## Misses") < page.index("## Measured") < page.index("## Kinematics")


def test_the_worst_value_stands_for_a_quantity(tmp_path, write):
    case(tmp_path / "cases", "K01")
    values = [verdict("K01", found=found) for found in (2.001, 2.015, 1.99)]
    values += [
        verdict("K01", "order", expected=4.0, found=found, tolerance="-0.3") for found in (3.8, 9)
    ]
    values += [
        verdict("K01", "turn", tolerance=1e-3),
        verdict("K01", "turn", found=None, agrees=False),
    ]
    _, _, page = write(values)
    _, order, speed, turn = rows(page, "K01")
    assert "| 2.015 m/s | +0.75 % | ± 1 % | 3 |" in speed
    assert "| 3.8 m/s | −0.2 | −0.3 | 2 |" in order
    assert "not a number" in turn
    # Of two misses and a hit the greater miss is shown.
    values = [verdict("K01", found=found, agrees=found < 2.02) for found in (2.3, 2.001, 2.5)]
    _, _, page = write(values)
    assert all("| 2.5 m/s | +25 % |" in row for row in rows(page, "K01"))


def test_cells_are_escaped(tmp_path, write):
    case(tmp_path / "cases", "K01")
    quantity, unit = "|v| of\nrollers_*", "E* <m>"
    _, _, page = write([verdict("K01", quantity, unit=unit, note="a | b", agrees=False)])
    assert "a \\| b, \\*Journal\\* 1" in page
    for row in rows(page, "K01"):
        assert "\\|v\\| of rollers\\_\\*" in row
        assert "E\\* \\<m\\>" in row
        bars = row.replace("\\|", "").count("|")
        assert bars == 8


@pytest.mark.parametrize(
    ("line", "said"),
    [
        (verdict("Z99"), "without a folder: Z99"),
        (verdict("K01", "sag", judged="carried"), "no reason in `carried` for: sag"),
        (verdict("K01", judged="guessed"), "line 1"),
        (verdict("K01", found=2.1), "line 1 agrees, though"),
        (verdict("K01", found=None), "line 1 agrees, though"),
        ({"case": "K01"}, "line 1 lacks kind"),
    ],
)
def test_verdicts_that_cannot_be_are_refused(tmp_path, write, line, said):
    case(tmp_path / "cases", "K01")
    code, message, page = write([line, verdict("K01")])
    assert code != 0
    assert said in message
    assert page is None
