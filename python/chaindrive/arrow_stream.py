"""The table that the command writes to standard output, as an Arrow IPC stream."""

from __future__ import annotations

import csv
import os
import re
from collections.abc import Iterator
from threading import Thread
from typing import IO, Any

from chaindrive import _core
from chaindrive.errors import tell
from chaindrive.extras import extra

__all__ = ["command"]

_STDOUT = 1
_FAILED = 3
# How a table that is not at its end closes.
_INCOMPLETE = b"\n# incomplete: "


def command(arguments: list[str]) -> int:
    """Run a command that writes CSV, write an Arrow stream instead, and return the exit code."""
    try:
        arrow = extra("pyarrow", "Arrow streams")
        for module in ("pyarrow.csv", "pyarrow.ipc"):
            extra(module, "Arrow streams")
    except ModuleNotFoundError as error:
        tell(f"--format arrow: {error}")
        return 2
    refused: list[Exception] = []

    def convert() -> None:
        try:
            # The command hears by the end of the pipe that nobody reads any more.
            with os.fdopen(table, "rb") as read, os.fdopen(out, "wb") as write:
                _convert(arrow, read, write)
        except (OSError, arrow.ArrowException) as error:
            refused.append(error)

    out = os.dup(_STDOUT)
    table, written = os.pipe()
    os.dup2(written, _STDOUT)
    os.close(written)
    converter = Thread(target=convert)
    converter.start()
    try:
        code = _core._cli(arguments)
    finally:
        # With its last writer the pipe ends.
        os.close(_STDOUT)
        converter.join()
    if refused and code == 0:
        tell(f"stdout: {refused[0]}")
        return _FAILED
    return code


def _convert(arrow: Any, table: IO[bytes], out: IO[bytes]) -> None:
    """Write a table as a stream, which has its end mark only if the table is complete."""
    headings = table.readline().decode()
    if not headings:
        return
    fields = [_field(arrow, heading) for heading in next(csv.reader([headings]))]
    # Numbers are handed on as they come; whether texts are whole numbers, the last row tells.
    numbers = all(field.type == arrow.float64() for field in fields)
    writer, mark = None, b""
    for block in _blocks(table) if numbers else [table.read()]:
        rows, mark, _ = (b"\n" + block).partition(_INCOMPLETE)
        if not rows.strip():
            continue
        read = _read(arrow, rows, fields)
        writer = writer or arrow.ipc.new_stream(out, read.schema)
        writer.write_table(read)
        out.flush()
    if writer and not mark:
        writer.close()


def _field(arrow: Any, heading: str) -> Any:
    """Return name, type and unit of a column: what has a unit is a number."""
    found = re.fullmatch(r"(.*) \[([^\[\]]*)\]", heading)
    if found is None:
        return arrow.field(heading, arrow.string(), nullable=False)
    name, unit = found.groups()
    return arrow.field(name, arrow.float64(), nullable=False, metadata={"unit": unit})


def _blocks(table: Any) -> Iterator[bytes]:
    """Yield rows as they come, whole ones only."""
    rest = b""
    while block := table.read1(1 << 20):
        rows, end, rest = (rest + block).rpartition(b"\n")
        if end:
            yield rows + end


def _read(arrow: Any, rows: bytes, fields: list[Any]) -> Any:
    """Return rows as a table; texts are whole numbers where all of a column are."""
    names = [str(at) for at in range(len(fields))]
    types = {name: field.type for name, field in zip(names, fields, strict=True)}
    how = {
        "read_options": arrow.csv.ReadOptions(column_names=names, use_threads=False),
        "parse_options": arrow.csv.ParseOptions(newlines_in_values=True),
        "convert_options": arrow.csv.ConvertOptions(column_types=types, null_values=[]),
    }
    columns = arrow.csv.read_csv(arrow.BufferReader(rows), **how).columns
    for at, field in enumerate(fields):
        if field.type == arrow.string():
            try:
                columns[at] = columns[at].cast(arrow.int64())
            except arrow.ArrowInvalid:
                continue
            fields[at] = field.with_type(arrow.int64())
    return arrow.Table.from_arrays(columns, schema=arrow.schema(fields))
