"""Measure the whole Verlet step on older registers; write older_registers.json for inner_loop.py.

Run it as ``python benchmarks/report/older_registers.py``, on a processor with AVX-512. The library
takes the widest registers that the processor has, when a system is built. So it is built three
times from the sources as they are, in a temporary folder: as it is, and with the choice replaced.
Builds take turns, each beside the yardstick, which keeps the registers of the processor. It takes
some fifteen minutes.
"""

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
STORED = Path(__file__).with_name("older_registers.json")
# What the library takes: in the sources, and instead of it in each build.
CHOICE = re.compile(r"(?:pulp::)?Arch::new\(\)")
BUILDS = {
    "AVX-512": "pulp::Arch::new()",
    "AVX2": "pulp::x86::V3::try_new().map_or(pulp::Arch::Scalar, pulp::Arch::V3)",
    "SSE2": "pulp::Arch::Scalar",
}
# Pairs with the yardstick in a process, and processes of each build: builds take turns.
PAIRS, ROUNDS = 7, 5


def build(choice: str, sources: Path, wheels: Path) -> Path:
    """Build a wheel that takes other registers and unpack it; return the folder to import from."""
    changed = 0
    for crate in ("integrate", "mechanics"):
        for file in (ROOT / "crates" / crate / "src").rglob("*.rs"):
            text, here = CHOICE.subn(choice, file.read_text(encoding="utf-8"))
            (sources / file.relative_to(ROOT)).write_text(text, encoding="utf-8")
            changed += here
    if not changed:
        message = "the library no longer chooses its registers by `Arch::new()`"
        raise RuntimeError(message)
    maturin = [sys.executable, "-m", "maturin", "build", "--release", "--quiet"]
    maturin += ["--interpreter", sys.executable, "--out", str(wheels)]
    environment = os.environ | {"CARGO_TARGET_DIR": str(ROOT / "target" / "older_registers")}
    subprocess.run(maturin, cwd=sources, env=environment, check=True)
    (wheel,) = wheels.glob("*.whl")
    shutil.unpack_archive(wheel, wheels / "unpacked", "zip")
    return wheels / "unpacked"


def measure() -> dict[str, Any]:
    """Measure the installed library as inner_loop.py does."""
    sys.path.insert(0, str(ROOT / "benchmarks" / "peers"))
    import chaindrive as cd
    import provenance
    from stepping import Stretch, in_turn
    from yardstick import Yardstick

    drive = cd.scenes.marine_engine_bare().replace({"guides": []})
    pairs = in_turn(Yardstick(), {"": Stretch(drive).time}, PAIRS)[""]
    return {
        "own": pairs.own.tolist(),
        "yardstick": pairs.yardstick.tolist(),
        "machine": provenance.machine(),
    }


def build_all(folder: Path) -> dict[str, Path]:
    """Build every kind from the tracked files, as they are."""
    tracked = subprocess.run(
        ["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    sources = folder / "sources"
    for name in filter(None, tracked.stdout.split("\0")):
        (sources / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, sources / name)
    return {kind: build(choice, sources, folder / kind) for kind, choice in BUILDS.items()}


def measure_all(built: dict[str, Path]) -> dict[str, Any]:
    """Measure every build in processes of its own; return what is stored."""
    import numpy as np

    from stepping import Pairs

    rounds: dict[str, list[dict[str, Any]]] = {kind: [] for kind in built}
    for _ in range(ROUNDS):
        for kind, place in built.items():
            command = [sys.executable, __file__, "--measure"]
            environment = os.environ | {"PYTHONPATH": str(place)}
            done = subprocess.run(command, env=environment, stdout=subprocess.PIPE, check=True)
            rounds[kind].append(json.loads(done.stdout))
    found = {}
    for kind, rows in rounds.items():
        times = ("own", "yardstick")
        pairs = Pairs(*(np.concatenate([row[name] for row in rows]) for name in times))
        print(f"{kind}: {pairs.faster:.2f} ({pairs.scatter})")
        found[kind] = {
            "choice": BUILDS[kind],
            "ns": pairs.ns,
            "ratio": pairs.faster,
            "scatter": pairs.scatter,
            "pairs": len(pairs.own),
            "machine": rows[-1]["machine"],
        }
    return found


def main() -> None:
    """Build, measure and write."""
    if sys.argv[1:] == ["--measure"]:
        print(json.dumps(measure()))
        return
    with tempfile.TemporaryDirectory() as folder:
        found = measure_all(build_all(Path(folder)))
    STORED.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
