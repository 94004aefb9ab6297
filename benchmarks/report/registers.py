"""The whole Verlet step on every set of registers of this processor, each in processes of its own.

The set is chosen once in a process, by the environment; the yardstick is compiled for the same one.
"""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
# Names in chaindrive, and what numba calls a processor that has them.
SETS = {"avx512": "x86-64-v4", "avx2": "x86-64-v3", "sse2": "x86-64"}
FEATURES = {
    "avx512": "+avx512f,+avx512bw,+avx512cd,+avx512dq,+avx512vl,+fma",
    "avx2": "+avx2,+fma",
    "sse2": "+sse2",
}
# Processes of each set; they take turns.
ROUNDS = 5


def main() -> None:
    """Print the times of pairs of this process."""
    pairs = int(sys.argv[1])
    sys.path.insert(0, str(ROOT / "benchmarks" / "peers"))
    import chaindrive as cd
    from stepping import Stretch, in_turn
    from yardstick import Yardstick

    drive = cd.scenes.marine_engine_bare().replace({"guides": []})
    found = in_turn(Yardstick(), {"": Stretch(drive).time}, pairs)[""]
    print(json.dumps({"own": found.own.tolist(), "yardstick": found.yardstick.tolist()}))


def measure(pairs: int, rounds: int = ROUNDS) -> dict[str, Any]:
    """Return the pairs of every set; none of one that the processor does not have."""
    import numpy as np

    from stepping import Pairs

    found: dict[str, list[dict[str, list[float]]]] = {name: [] for name in SETS}
    for _ in range(rounds):
        for name, processor in SETS.items():
            asked = {
                "CHAINDRIVE_INSTRUCTION_SET": name,
                "NUMBA_CPU_NAME": processor,
                "NUMBA_CPU_FEATURES": FEATURES[name],
            }
            command = [sys.executable, __file__, str(pairs)]
            done = subprocess.run(
                command, env=os.environ | asked, capture_output=True, text=True, check=False
            )
            if done.returncode == 0:
                found[name].append(json.loads(done.stdout))
            elif "CHAINDRIVE_INSTRUCTION_SET" not in done.stderr:
                # Of a set that the processor lacks the library says so; all else is an error.
                raise RuntimeError(done.stderr)
    return {
        name: Pairs(*(np.concatenate([row[what] for row in rows]) for what in ("own", "yardstick")))
        if rows
        else None
        for name, rows in found.items()
    }


if __name__ == "__main__":
    main()
