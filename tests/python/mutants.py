"""Damaged input of every kind, drawn by lot: refused in time and in words of ours, or taken.

A kind names a generator, which yields calls for ever. A call returns or raises one of `KNOWN`.
As a program it tries many, and prints what it found:

    python tests/python/mutants.py --seed 1 --count 20000
"""

import argparse
import csv
import io
import json
import os
import random
import resource
import signal
import subprocess
import sys
import tempfile
import time
import warnings
import zlib
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from faulthandler import cancel_dump_traceback_later, dump_traceback_later
from logging import ERROR, getLogger
from pathlib import Path
from typing import Any

import chaindrive as cd
from chaindrive import _core

Call = Callable[[], object]

#: Exceptions that calls may raise. `ProgramError`, which is a `ChaindriveError`, is none of them.
KNOWN = (cd.ChaindriveError, ValueError, TypeError, OSError)
#: CPU time after which a call is interrupted, and wall time after which it is deaf [s].
PATIENCE, DEAF = 5.0, 300.0
#: Mutants of a process: what was interrupted may still be settling there.
PART = 500

WORDS = [
    *("nan", "inf", "-1", "0", "1e308", "-1e-308", "1e400", "5e-324", "99999999999999999999"),
    *('""', '"1e300 km"', "[]", "{}", "true", "=", "\n", "[x]", "[[chain]]", "'mm'", "\u202e"),
    *("kind = 'table'", "links = 1", "\ufffd", "µ", "[[sprockets]]\n", "3 rpm", "1979-05-27"),
]
VALUES: list[Any] = [
    *(0, -0.0, 1, -1, 2, 3, 2**31 - 1, 2**32, 2**63 - 1, -(2**63), 1e300, -1e300, 1e-300, 5e-324),
    *(0.5, 1e-9, 1e3, 1e6, 1e9, "", "0 mm", "1 nm", "1e9 m", "-5 kN", "1e400", "1e-400 s", "auto"),
    *("none", "constant", "\x1b[2J", "=1+1", True, [], [1, 2], [[0, 0]], {}, {"kind": "none"}),
]


def damaged(held: bytearray, lot: random.Random) -> bytes:
    """Return bytes with some of them cut, changed, put in, or with larger numbers."""
    match lot.randrange(5):
        case 0:
            del held[lot.randrange(len(held) + 1) :]
        case 1:
            for _ in range(lot.randint(1, 8)):
                held[lot.randrange(len(held))] = lot.randrange(256)
        case 2:
            at = lot.randrange(len(held) + 1)
            held[at:at] = bytes(lot.randrange(32, 127) for _ in range(lot.randint(1, 20)))
        case 3:
            digits = [at for at, it in enumerate(held) if chr(it).isdigit()] or [0]
            at = lot.choice(digits)
            held[at : at + 1] = b"9" * lot.randint(1, 12)
        case 4:
            first, last = sorted(lot.randrange(len(held) + 1) for _ in range(2))
            held[first:first] = held[first : min(last, first + 200)]
    return bytes(held)


def worded(text: str, lot: random.Random) -> str:
    """Return a text with words put in, or in place of values."""
    for _ in range(lot.randint(1, 3)):
        at, word = lot.randrange(len(text) + 1), lot.choice(WORDS)
        sign = text.find(lot.choice("=:,"), at) + 1
        if sign and lot.randrange(3):
            end = next((i for i in range(sign, len(text)) if text[i] in ",\n]}"), len(text))
            text = f"{text[:sign]} {word}{text[end:]}"
        else:
            text = text[:at] + word + text[at:]
    return text


def places(value: Any, path: str = "") -> Iterator[str]:
    """Yield the paths of a scene, tables and lists included."""
    if path:
        yield path
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from places(inner, f"{path}.{key}" if path else key)
    elif isinstance(value, list):
        for index, inner in enumerate(value[:4]):
            yield from places(inner, f"{path}[{index}]")


def used(drive: cd.Drive, lot: random.Random) -> None:
    """Describe a drive, and move a part of them."""
    # Settling takes minutes from some thousand links on, and can be interrupted.
    if drive.links < 300:
        drive.describe()
        if lot.randrange(4) == 0:
            cd.simulate(drive, until=2e-6, every=1e-6, step=1e-6, run_in=0, error=False)


def _presets(lot: random.Random) -> cd.Drive:
    return getattr(cd.scenes, lot.choice(sorted(cd.scenes.presets())))()


def scenes_of_text(lot: random.Random, folder: Path, ending: str) -> Iterator[Call]:
    place = folder / f"scene{ending}"
    while True:
        drive = _presets(lot)
        text = drive.text if ending == ".toml" else json.dumps(drive.to_dict(), indent=1)
        if lot.randrange(2):
            whole = worded(text, lot).encode(errors="surrogatepass")
        else:
            whole = damaged(bytearray(text.encode()), lot)
        place.write_bytes(whole)
        yield lambda: used(cd.load(place), lot)


def replaced(lot: random.Random, folder: Path) -> Iterator[Call]:
    while True:
        drive = _presets(lot)
        # With all defaults.
        paths = list(places(drive.resolved().to_dict()))
        changes = {lot.choice(paths): lot.choice(VALUES) for _ in range(lot.randint(1, 3))}
        yield lambda drive=drive, changes=changes: used(drive.replace(changes), lot)


def drawings(lot: random.Random, folder: Path) -> Iterator[Call]:
    place = folder / "drawing.dxf"
    cd.exchange.write_dxf(place, cd.scenes.industrial_16b().profile("driver"))
    whole = place.read_bytes()

    # Warnings of what it mends.
    getLogger("ezdxf").setLevel(ERROR)

    def read() -> None:
        for curve in cd.exchange.read_dxf(place):
            cd.exchange.face(curve)

    while True:
        place.write_bytes(damaged(bytearray(whole), lot))
        yield read


def stores(lot: random.Random, folder: Path) -> Iterator[Call]:
    place = folder / "ring.zarr"
    ring = cd.scenes.spinning_ring()
    cd.simulate(ring, until=4e-3, every=1e-4, error=False, output=place, checkpoint_every=1e-3)
    files = {it: it.read_bytes() for it in sorted(place.rglob("*")) if it.is_file()}
    opened: list[Call] = [
        lambda: cd.replay(cd.open_result(place)),
        lambda: cd.open_result(place).drive.summary(),
        lambda: cd.load(place),
        lambda: cd.resume(place, until=4.2e-3),
    ]
    while True:
        for file in [it for it in place.rglob("*") if it.is_file() and it not in files]:
            file.unlink()
        for file, held in files.items():
            file.parent.mkdir(parents=True, exist_ok=True)
            if not file.exists() or file.read_bytes() != held:
                file.write_bytes(held)
        file = lot.choice(list(files))
        file.write_bytes(damaged(bytearray(files[file]), lot))
        yield lot.choice(opened)


def snapshots(lot: random.Random, folder: Path) -> Iterator[Call]:
    simulation = cd.Simulation(cd.scenes.spinning_ring())
    whole = bytes(simulation.snapshot())
    end = whole.index(b"\n")

    def restored(held: bytes) -> None:
        snapshot = cd.Snapshot(held)
        simulation.restore(snapshot)
        simulation.advance(1e-6)

    while True:
        if lot.randrange(2):
            held = damaged(bytearray(whole), lot)
        else:
            # Behind a seal that is made good.
            content = damaged(bytearray(whole[end + 1 :]), lot)
            line = whole[:end].rpartition(b" ")[0]
            held = line + b" %08x\n" % zlib.crc32(content) + content
        yield lambda held=held: restored(held)


def tables(lot: random.Random, folder: Path) -> Iterator[Call]:
    """Tables of `sweep --design`."""
    place = folder / "table.csv"
    paths = [it for it in places(cd.scenes.spinning_ring().resolved().to_dict()) if it[:3] != "run"]
    command = ["chaindrive", "sweep", "spinning_ring", "--design", str(place), "--json"]
    command += ["--until", "1e-5", "--every", "1e-5", "--step", "1e-6", "--jobs", "1", "-q"]

    def swept() -> None:
        code = _core._cli(command)
        if code not in (0, 1, 2, 3):
            message = f"exit code {code}"
            raise AssertionError(message)

    while True:
        columns = [lot.choice([*paths, "", "x.y"]) for _ in range(lot.randint(1, 3))]
        text = io.StringIO()
        table = csv.writer(text)
        table.writerow(columns)
        for _ in range(lot.randint(0, 3)):
            table.writerow([lot.choice([*VALUES, *WORDS]) for _ in columns])
        whole = text.getvalue().encode(errors="surrogatepass")
        place.write_bytes(damaged(bytearray(whole), lot) if lot.randrange(4) == 0 else whole)
        yield swept


#: Kinds of mutants, with their share.
KINDS: dict[str, tuple[Callable[[random.Random, Path], Iterator[Call]], int]] = {
    "toml": (lambda lot, folder: scenes_of_text(lot, folder, ".toml"), 5),
    "json": (lambda lot, folder: scenes_of_text(lot, folder, ".json"), 4),
    "replace": (replaced, 4),
    "drawings": (drawings, 2),
    "stores": (stores, 2),
    "snapshots": (snapshots, 2),
    "tables": (tables, 1),
}


@dataclass
class Found:
    """What came of mutants."""

    complaints: list[str] = field(default_factory=list)
    taken: Counter[str] = field(default_factory=Counter)
    refused: Counter[str] = field(default_factory=Counter)
    slowest: float = 0.0
    #: Largest memory of the process [GB].
    memory: float = 0.0


class TooLongError(BaseException):
    """The patience for a call is over."""


def tried(kind: str, seed: int | str, count: int, folder: Path, found: Found) -> None:
    """Try mutants of a kind: each ends in time, in words of ours, or hears that it is to end."""

    def interrupt(*_: object) -> None:
        raise TooLongError

    folder.mkdir()
    lot = random.Random(f"{kind} {seed}")
    calls = KINDS[kind][0](lot, folder)
    before = signal.signal(signal.SIGPROF, interrupt)
    try:
        for number in range(count):
            call = next(calls)
            begun = time.process_time()
            about = f"{kind} {number} of seed {seed}"
            dump_traceback_later(DEAF, exit=True)
            signal.setitimer(signal.ITIMER_PROF, PATIENCE)
            try:
                call()
                found.taken[kind] += 1
            except TooLongError:
                found.complaints.append(f"{about}: {time.process_time() - begun:.1f} CPU s")
            except KNOWN as error:
                found.refused[kind] += 1
                if isinstance(error, cd.ProgramError) or not str(error):
                    found.complaints.append(f"{about}: {error!r}")
            except BaseException as error:
                found.complaints.append(f"{about}: {error!r}")
            finally:
                signal.setitimer(signal.ITIMER_PROF, 0.0)
                cancel_dump_traceback_later()
            found.slowest = max(found.slowest, time.process_time() - begun)
    finally:
        signal.signal(signal.SIGPROF, before)
    found.memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024e-9


def tried_all(seed: int | str, count: int, folder: Path) -> Found:
    """Try mutants of all kinds by their shares; what commands print is left out."""
    found = Found()
    whole = sum(share for _, share in KINDS.values())
    kept, out = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    errors = os.dup(2)
    sys.stdout.flush()
    try:
        os.dup2(out, 1)
        for kind, (_, share) in KINDS.items():
            os.dup2(out if kind == "tables" else errors, 2)
            # Of those that settle for long.
            getLogger("chaindrive").setLevel(ERROR)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                tried(kind, seed, count * share // whole, folder / kind, found)
    finally:
        for number, held in ((1, kept), (2, errors)):
            os.dup2(held, number)
            os.close(held)
        os.close(out)
    return found


def main() -> int:
    """Try mutants, part by part, each in a process of its own, and tell what was found."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", default="1")
    parser.add_argument("--count", type=int, default=20_000)
    given = parser.parse_args()
    if given.count <= PART:
        with tempfile.TemporaryDirectory() as folder:
            found = tried_all(given.seed, given.count, Path(folder))
        print(f"taken {found.taken.total()}, refused {found.refused.total()}")
        print(f"slowest {found.slowest:.2f} CPU s, memory {found.memory:.2f} GB")
        print("".join(f"{it}\n" for it in found.complaints), end="")
        return bool(found.complaints)
    failed = 0
    for part in range(given.count // PART):
        seed = f"{given.seed}.{part}"
        command = [sys.executable, __file__, "--seed", seed, "--count", str(PART)]
        code = subprocess.run(command, check=False).returncode
        failed += code != 0
        print(f"seed {seed}: exit code {code}", flush=True)
    return failed > 0


if __name__ == "__main__":
    sys.exit(main())
