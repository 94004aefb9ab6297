"""What a sweep in a store costs beside the work of its variants: a study."""

import json
import subprocess
import sys
from uuid import uuid4

import numpy as np
import pytest

MEASURED_SWEEP = """
import json
import resource
import sys
import time

import numpy as np

import chaindrive as cd

first, count, jobs, store = *map(int, sys.argv[1:4]), sys.argv[4]
drive = cd.scenes.marine_two_sprockets().replace({"run.run_in": 0})
design = {"chain.damping_ratio": np.linspace(0.02, 0.06, 21_000)[first : first + count]}
settings = {"until": 20e-3, "every": 1e-3, "jobs": jobs}
# What is imported when it is first needed takes as long as hundreds of variants.
cd.sweep(drive, {"chain.damping_ratio": [0.05]}, until=1e-3, output=sys.argv[5])
wall, cpu = time.perf_counter(), time.process_time()
result = cd.sweep(drive, design=design, **settings, output=store)
wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
assert result.attrs["finished"] == count
print(json.dumps({"wall": wall, "cpu": cpu, "memory": memory}))
"""


def measured(script, *runs):
    """Run sweeps side by side, each in a process of its own, and return their accounts."""
    starts = []
    for run in runs:
        first = script.with_name(f"{uuid4()}.zarr")
        starts.append([sys.executable, str(script), *map(str, run), str(first)])
    processes = [subprocess.Popen(start, stdout=subprocess.PIPE, text=True) for start in starts]
    return [json.loads(process.communicate()[0]) for process in processes]


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="memory in kilobytes, two cores")
def test_ten_thousand_variants_keep_two_cores_busy_in_little_memory(tmp_path):
    """Against two processes that know nothing of each other, interleaved; `-s` prints the figures.

    Processor times are compared, since others may use the machine; wall times are printed.
    """
    script = tmp_path / "script.py"
    script.write_text(MEASURED_SWEEP)
    pairs, each = 7, 3000
    walls, costs = [], []
    for pair in range(pairs):
        first, half = pair * each, each // 2
        stores = [tmp_path / f"{pair} {part}.zarr" for part in "ab"]
        ranges = [(first, half, 1), (first + half, half, 1)]
        halves = measured(script, *((*it, store) for it, store in zip(ranges, stores, strict=True)))
        [sweep] = measured(script, (first, each, 2, tmp_path / f"{pair}.zarr"))
        walls.append(max(it["wall"] for it in halves) / sweep["wall"])
        costs.append(sweep["cpu"] / sum(it["cpu"] for it in halves) - 1.0)
    [some] = measured(script, (0, 1000, 2, tmp_path / "some.zarr"))
    [all_of_them] = measured(script, (0, 10_000, 2, tmp_path / "all.zarr"))
    figures = {
        "speed-up over that of two processes": sorted(walls),
        "overhead in processor time": sorted(costs),
        "sweep of 1 000": some,
        "sweep of 10 000": all_of_them,
    }
    print(json.dumps(figures, indent=1))
    assert np.median(walls) > 0.95
    assert np.median(costs) < 0.02
    # Four kilobytes a variant [MB]: copies of the values that are varied, and larger tasks.
    assert all_of_them["memory"] - some["memory"] < 9_000 * 4e-3
