"""Where a command of the harness runs its jobs: in processes here, or on a cluster whose workers run the same sources.

A worker has to run the same sources with the same packages as the command, and to see the folder of the run under the same path:
recordings are written there. Frames are never timed on a cluster.
"""

import argparse
import multiprocessing
from functools import partial
from pathlib import Path

from avatarsim.running.cluster import Cluster
from avatarsim.running.processes import Workers
from scenarios.run.processes import PRELOADED
from scenarios.run.provenance import code_hash, provenance
from scenarios.run.resume import PLAN

OPTION = "--scheduler"
SAME = ("code", "python", "versions", "folder")
"""What a worker has in common with this command, or its figures would be those of another."""
HELP = "run what is not timed on the Dask cluster of this scheduler, as tcp://HOST:8786, in place of processes here"


def about(folder: Path | None) -> dict[str, object]:
    """What this process runs, and whether it sees `folder`: when the plan in it was written tells it from a copy [ns]."""
    told = {name: found for name, found in provenance([]).items() if name in (*SAME, "cpu")}
    plan = folder / PLAN if folder else None
    written = plan.stat().st_mtime_ns if plan and plan.exists() else None
    return {**told, "folder": (folder, written), "daemon": multiprocessing.current_process().daemon}


def cluster(address: str, folder: Path | None = None) -> Cluster:
    """The cluster of the scheduler at `address`, whose workers see `folder` if jobs write there."""
    return Cluster(address, code_hash, partial(about, folder), SAME, PRELOADED)


def workers_of(asked: argparse.Namespace, folder: Path | None = None) -> Workers:
    """Where a command runs its jobs, by its options: on a cluster, whose workers write into `folder`, or in processes here."""
    address = getattr(asked, "scheduler", None)
    return int(asked.jobs) if address is None else cluster(address, folder)
