"""Clusters on this machine, to which tests hand out work."""

import contextlib
import os
from collections.abc import Iterator
from concurrent.futures import Executor
from pathlib import Path

import pytest


@contextlib.contextmanager
def cluster(folder: Path) -> Iterator[Executor]:
    """An executor of a Dask cluster of two processes."""
    distributed = pytest.importorskip("distributed")
    here = {"n_workers": 2, "threads_per_worker": 1, "processes": True, "host": "127.0.0.1"}
    here |= {"dashboard_address": None, "local_directory": folder / "dask"}
    with distributed.LocalCluster(**here) as cluster, distributed.Client(cluster) as client:
        assert len(set(client.run(os.getpid).values()) - {os.getpid()}) == 2
        with client.get_executor() as executor:
            yield executor
