"""What the command prints for programs: JSON of the form that its schema says, and tables."""

import csv
import functools
import io
import json
import signal
import subprocess
import sys
from typing import Any

import jsonschema
import numpy as np
import pytest

import chaindrive as cd

SHORT = [
    "--until",
    "0.1 ms",
    "--every",
    "0.1 ms",
    "--method",
    "auto",
    "--no-error",
    "--run-in",
    "0",
]


def command(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "chaindrive", *arguments],
        capture_output=True,
        text=True,
        check=False,
    )


def closed(schema: Any) -> Any:
    """The schema, refusing keys that it does not name."""
    if isinstance(schema, dict):
        schema = {key: closed(value) for key, value in schema.items()}
        if "properties" in schema:
            schema.setdefault("additionalProperties", False)
        return schema
    return [closed(it) for it in schema] if isinstance(schema, list) else schema


@functools.cache
def schema(of: str) -> Any:
    return closed(json.loads(command("schema", of).stdout))


def answer(*arguments: str) -> Any:
    done = command(*arguments, "--json")
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    document = json.loads(done.stdout)
    jsonschema.validate(document, schema(arguments[0]))
    return document


# Particles with guides and a tensioner, rigid links, several chains, a chain without sprockets.
QUICK = ["marine_engine", "bicycle", "two_stage_timing", "hanging_chain"]


@pytest.mark.parametrize(
    "preset",
    [
        pytest.param(preset, marks=[] if preset in QUICK else pytest.mark.slow)
        for preset in cd.scenes.presets()
    ],
)
def test_answers_about_every_preset_are_of_the_form_of_their_schema(preset):
    checked = answer("check", preset)["scenes"]
    assert [it["scene"] for it in checked] == [preset]
    assert checked[0]["sound"]["degrees_of_freedom"] > 0
    resolved = answer("resolve", preset)
    jsonschema.validate(resolved["scene"], cd.schema())
    ran = answer("run", preset, *SHORT)
    assert ran["status"] == "complete"
    assert ran["attributes"]["scene_name"] == preset
    described = answer("describe", preset, "--method", "auto", "--until", "1 ms")
    assert ("chain" in described) != ("chains" in described)
    if command("design", preset).returncode == 0:
        assert answer("design", preset)["chains"]


def test_answers_about_what_there_is():
    names = [it["name"] for it in answer("channels")["channels"]]
    assert names == list(cd.channels())
    chains = answer("catalogue")["chains"]
    (one,) = answer("catalogue", "80")["chains"]
    assert one in chains
    assert one["name"] == "16A-1"
    assert one["numbers"]["pitch"]["value"] == pytest.approx(0.0254)


def test_differences():
    assert answer("diff", "marine_engine", "marine_engine") == {"differences": []}
    differences = answer("diff", "marine_engine", "marine_engine_bare")["differences"]
    assert all(it["first"] != it["second"] for it in differences)
    assert len(differences) > 3


SWEEP = ["sweep", "spinning_ring", "--vary", "chain.links=20,24", *SHORT[:6]]


def test_a_sweep(tmp_path):
    swept = answer(*SWEEP, "-o", str(tmp_path / "ring.csv"))
    assert (swept["status"], swept["variants"], swept["finished"]) == ("complete", 2, 2)
    assert swept["swept"] == ["chain.links"]


@pytest.mark.parametrize(
    ("arguments", "code", "place"),
    [
        (["run", "marine_engin"], 2, "marine_engin"),
        (["check", "wrong.toml"], 2, None),
        (["run", "wrong.toml"], 2, "wrong.toml"),
        (["run", "marine_engine", "--method", "verlt"], 2, "arguments"),
        (["describe", "marine_engine", "--set", "links=80"], 2, "--set links"),
        (["catalogue", "16b1"], 2, None),
    ],
)
def test_a_failure_is_one_document_too(arguments, code, place, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "wrong.toml").write_text('[chain]\npitch = "12 rpm"\n', encoding="utf-8")
    done = command(*arguments, "--json")
    assert done.returncode == code
    document = json.loads(done.stderr)
    jsonschema.validate(document, schema("error"))
    assert document["error"].get("where") == place
    assert document["error"]["exit_code"] == code
    if place == "wrong.toml":
        first = document["error"]["problems"][0]
        assert (first["path"], first["line"]) == ("title", 1) or first["path"]
        pitch = [it for it in document["error"]["problems"] if it["path"] == "chain.pitch"]
        assert [(it["line"], it["column"]) for it in pitch] == [(2, 9)]


TABLE = ["run", "spinning_ring", "--until", "2 ms", "--every", "1 ms", "--step", "10 us"]
RECORD = ["--record", "energy_kinetic,link_tension"]


def test_a_table_on_standard_output_is_that_of_a_file(tmp_path):
    done = command(*TABLE, *RECORD, "-o", "-")
    assert done.returncode == 0, done.stderr
    assert command(*TABLE, *RECORD, "-o", str(tmp_path / "ring.csv"), "-q").returncode == 0
    assert done.stdout == (tmp_path / "ring.csv").read_text(encoding="utf-8")
    assert "verdict" in done.stderr
    assert command(*TABLE, "-o", "-", "--json").returncode == 2
    assert command(*TABLE, "-o", "x.csv", "--format", "arrow").returncode == 2


def stream(*arguments: str) -> Any:
    ipc = pytest.importorskip("pyarrow.ipc")
    whole = [sys.executable, "-m", "chaindrive", *arguments, "-o", "-", "--format", "arrow"]
    done = subprocess.run(whole, capture_output=True, check=True)
    return ipc.open_stream(io.BytesIO(done.stdout)).read_all()


def test_arrow_has_the_numbers_of_the_table_and_their_units(tmp_path):
    table = stream(*TABLE, *RECORD)
    text = command(*TABLE, *RECORD, "-o", "-").stdout.splitlines()
    headings = text[0].split(",")
    assert [
        f"{field.name} [{field.metadata[b'unit'].decode()}]" for field in table.schema
    ] == headings
    rows = [[float(cell) for cell in line.split(",")] for line in text[1:]]
    assert [list(row.values()) for row in table.to_pylist()] == rows


def test_a_sweep_on_standard_output():
    table = stream(*SWEEP)
    kinds = {str(field.type) for field in table.schema}
    assert kinds == {"int64", "double", "string"}
    assert table.column("variant").to_pylist() == [0, 1]
    assert table.column("links").to_pylist() == [20, 24]
    text = command(*SWEEP, "-o", "-").stdout.splitlines()
    assert len(text) == 3
    assert len(text[0].split(",")) == table.num_columns


@pytest.mark.parametrize(
    ("rows", "links", "complete"),
    [
        ('20,1e-300,nan,"two\nlines, 7"\n24,-0.0,-inf,\n', "int64", True),
        ("7,0.1,inf,3\n16B-1,2.0,NaN,\n# incomplete: interrupted\n", "string", False),
    ],
)
def test_a_stream_has_every_digit_and_its_end_mark_when_it_is_complete(rows, links, complete):
    arrow = pytest.importorskip("pyarrow")
    pytest.importorskip("pyarrow.csv")
    from chaindrive.arrow_stream import _convert

    out = io.BytesIO()
    text = f'links,"force[a, b [1]] [N]",share [1],error\n{rows}'
    _convert(arrow, io.BufferedReader(io.BytesIO(text.encode())), out)
    assert out.getvalue().endswith(b"\xff\xff\xff\xff\0\0\0\0") is complete
    table = arrow.ipc.open_stream(io.BytesIO(out.getvalue())).read_all()
    assert table.column_names == ["links", "force[a, b [1]]", "share", "error"]
    assert str(table.schema.field("links").type) == links
    read = list(csv.reader(io.StringIO(rows.partition("#")[0])))
    assert [str(it) for it in table["links"].to_pylist()] == [row[0] for row in read]
    for column, name in enumerate(table.column_names[1:3], 1):
        numbers = np.array([float(row[column]) for row in read])
        np.testing.assert_array_equal(table[name].to_numpy(), numbers)
    if "two" in rows:
        assert table["error"].to_pylist() == ["two\nlines, 7", ""]


def test_a_stream_asks_for_its_extra():
    script = (
        "import sys; sys.modules['pyarrow'] = None\n"
        "from chaindrive.__main__ import main; sys.exit(main())"
    )
    whole = [sys.executable, "-c", script, *TABLE, "-o", "-", "--format=arrow"]
    done = subprocess.run(whole, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (2, "")
    assert "take the package pyarrow: pip install 'chaindrive[parquet]'" in done.stderr


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_a_stream_that_is_stopped_or_not_read_says_so():
    ipc = pytest.importorskip("pyarrow.ipc")
    run = ["run", "spinning_ring", "--until", "1e5 s", *TABLE[4:], "-o", "-", "--format", "arrow"]
    whole = [sys.executable, "-m", "chaindrive", *run]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with subprocess.Popen(whole, **pipes) as run:
        batches = ipc.open_stream(run.stdout)
        assert batches.read_next_batch().num_rows > 0
        run.send_signal(signal.SIGTERM)
        assert sum(batch.num_rows for batch in batches) > 0
        assert run.wait(60) == 130
    with subprocess.Popen(whole, **pipes) as run:
        assert ipc.open_stream(run.stdout).read_next_batch().num_rows > 0
        run.stdout.close()
        assert run.wait(60) == 3
        assert b"stdout" in run.stderr.read()


def test_nothing_is_coloured(monkeypatch):
    for name in ("CLICOLOR_FORCE", "FORCE_COLOR"):
        monkeypatch.setenv(name, "1")
    for arguments in (["--help"], ["run", "x"], ["rnu"], ["check", "spinning_ring"]):
        done = command(*arguments)
        assert "\x1b" not in done.stdout + done.stderr
