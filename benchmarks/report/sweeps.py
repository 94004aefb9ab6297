"""A sweep on two cores beside two independent processes in the same minutes."""

import os
import subprocess
import sys

import numpy as np

from page import Page

SWEEP = """
import sys, time
import numpy as np
import chaindrive as cd
speeds, jobs = int(sys.argv[1]), int(sys.argv[2])
vary = {
    "sprockets.crank.motion.speed": np.linspace(-6.3, -16.0, speeds),
    "route.pretension": np.linspace(10e3, 28e3, 10),
}
drive = cd.scenes.marine_engine_bare().replace({"run.run_in": 0})
begin = time.perf_counter()
result = cd.sweep(drive, vary, until=0.02, every=1e-3, jobs=jobs)
took = time.perf_counter() - begin
measured = [name for name in ("stepping_time", "real_time_factor") if name in result]
values = result.drop_vars(measured)
import hashlib
digest = hashlib.sha256()
for name in sorted(map(str, values.data_vars)):
    data = values[name].values
    # Texts are objects, whose bytes are addresses.
    digest.update(repr(data.tolist()).encode() if data.dtype == object else data.tobytes())
print(took, digest.hexdigest())
"""


def start(speeds: int, jobs: int) -> subprocess.Popen[str]:
    """Start a process that sweeps."""
    command = [sys.executable, "-c", SWEEP, str(speeds), str(jobs)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True)


def finish(process: subprocess.Popen[str]) -> tuple[float, str]:
    """Wait for a process; return the time of its sweep and the hash of the numbers."""
    output, _ = process.communicate()
    if process.returncode != 0:
        raise RuntimeError(f"a sweep ended with exit code {process.returncode}")
    took, digest = output.split()
    return float(took), digest


def report(page: Page) -> None:
    """Write what two threads take over two processes, and whether the numbers are the same."""
    cores = min(2, os.cpu_count() or 1)
    speeds = 2 if page.quick else 10
    ratios, digests = [], set()
    for _ in range(page.pairs):
        # One sweep of all variants, then a sweep of half of them in each process.
        both, digest = finish(start(speeds, cores))
        digests.add(digest)
        apart = [finish(it)[0] for it in [start(speeds // cores, 1) for _ in range(cores)]]
        # Variants a second: N/t of the one, Σ (N/2)/tᵢ of the others.
        ratios.append(1 / (both * sum(1 / (cores * took) for took in apart)))
    _, serial = finish(start(speeds, 1))
    same = digests == {serial}
    ratio = float(np.median(ratios))
    page.add(
        "## Sweeps",
        "",
        f"{10 * speeds} variants of the marine engine as in the paper over speed and pretension, "
        f"20 ms each: {cores} threads of one sweep are {ratio:.2f} times as fast as {cores} "
        f"independent processes with {10 * speeds // cores} variants each, interleaved (median of "
        f"{len(ratios)} pairs, {min(ratios):.2f} to {max(ratios):.2f}); the numbers are "
        f"{'the same to the last bit' if same else 'NOT the same'} as those of one thread. See "
        "[sweeps](sweeps.md).",
        "",
    )
    page.target(
        f"sweep of {10 * speeds} variants on {cores} cores",
        f"≥ 0.95 × {cores} independent processes, same bits",
        f"{ratio:.2f} ×, {'same bits' if same else 'other bits'}",
        same and ratio >= 0.95,
    )
