"""The yardstick: the plain numba program of benchmarks/peers, frozen, timed beside every figure.

Machines are noisy by a factor of two from one minute to the next. A ratio to a program that does
the same work in the same minute is not.
"""

import hashlib
import os
import re
import sys
import tempfile
from pathlib import Path

PEERS = Path(__file__).resolve().parents[1] / "peers"
KERNEL = PEERS / "with_numba.py"

# Its time on a quiet machine of the kind on which targets were set, and what it was then.
QUIET = 28.7  # [ns per link and step]
FROZEN_HASH = "ff71ab4ec0b7b7f83f8ccba3a344005e3dfb5c6d6f4809efa09eb02489bd03c1"
FROZEN_NUMBA = "0.68.1"

STEP = 1e-5  # [s]
LENGTH = 0.1  # [s]: 10 000 steps, some 35 ms


class Yardstick:
    """The numba program, ready to be timed.

    Raises
    ------
    RuntimeError
        Its source is not the frozen one: figures would not compare with earlier ones.
    """

    def __init__(self) -> None:
        self.hash = hashlib.sha256(KERNEL.read_bytes()).hexdigest()
        if self.hash != FROZEN_HASH:
            message = (
                f"{KERNEL.name} has hash {self.hash[:12]}, the yardstick {FROZEN_HASH[:12]}: "
                "restore the file, or measure a new yardstick on a quiet machine and freeze that"
            )
            raise RuntimeError(message)
        os.environ.setdefault("NUMBA_NUM_THREADS", "1")
        # Compiled anew: numba shows no machine code of what it finds in its cache.
        self._cache = tempfile.TemporaryDirectory()
        os.environ["NUMBA_CACHE_DIR"] = self._cache.name
        sys.path.insert(0, str(PEERS))
        import measure
        import with_numba

        self._program = with_numba
        self.drive = measure.load()
        self.found: list[float] = []
        self.time()
        self.found.clear()

    def time(self) -> float:
        """Run it once and return ns per link and step, processor time."""
        run = self._program.run(self.drive, "verlet", STEP, LENGTH, every=1e-3)
        self.found.append(1e9 * run.cpu / run.steps / self.drive["chain"]["links"])
        return self.found[-1]

    def identity(self) -> str:
        """Return hash, version and instruction set."""
        import llvmlite.binding
        import numba

        code = "".join(self._program.verlet.inspect_asm().values())
        wide = {f"{bits} bits": len(re.findall(name, code)) for bits, name in REGISTERS}
        registers = ", ".join(f"{count} × {bits}" for bits, count in wide.items())
        version = numba.__version__
        if version != FROZEN_NUMBA:
            version += f" (**not the frozen {FROZEN_NUMBA}**)"
        return (
            f"`benchmarks/peers/{KERNEL.name}` with hash {self.hash[:12]}, numba {version}, "
            f"compiled for {llvmlite.binding.get_host_cpu_name()}; vector registers named in its "
            f"code: {registers}"
        )


REGISTERS = ((512, "zmm"), (256, "ymm"), (128, "xmm"))
