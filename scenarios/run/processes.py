"""Places where jobs run: processes here that have the harness loaded, or a cluster, on which nothing is timed."""

import argparse
import multiprocessing
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path

from avatarsim.running import processes
from avatarsim.running.cluster import Cluster
from avatarsim.running.processes import PATIENCE as TIMEOUT
from avatarsim.running.processes import Answer, Died, Forking, Task, Workers, alone
from scenarios.run.provenance import PLAN, code_hash, provenance

PRELOADED = (*processes.PRELOADED, "scenarios.run.preloaded")
"""Modules that the fork server of the harness imports once."""
SAME = ("code", "python", "versions", "folder")
"""Facts that a worker of a cluster has in common with the command, or its figures would be those of another program."""


def context() -> Forking:
    """Return the context that starts processes of the harness."""
    return processes.context(PRELOADED)


def side_by_side(
    function: Callable[[Task], Answer], tasks: Sequence[Task], workers: Workers, tidy: Callable[[Task], bool] = alone,
    patience: float = TIMEOUT,
) -> Iterator[tuple[Task, Answer | Died]]:
    """Run tasks as `avatarsim.running.processes.side_by_side`."""
    return processes.side_by_side(function, tasks, workers, tidy, patience, PRELOADED)


def facts(folder: Path | None) -> dict[str, object]:
    """Return facts of this process, and the time [ns] of the plan in `folder`, which another folder of that name has not."""
    known = {name: fact for name, fact in provenance([]).items() if name in (*SAME, "cpu")}
    plan = folder / PLAN if folder else None
    written = plan.stat().st_mtime_ns if plan and plan.exists() else None
    return {**known, "folder": (folder, written), "daemon": multiprocessing.current_process().daemon}


def cluster(address: str, folder: Path | None = None) -> Cluster:
    """Return the cluster of the scheduler at `address`, whose workers write into `folder`."""
    return Cluster(address, code_hash, partial(facts, folder), SAME, PRELOADED)


def workers_of(options: argparse.Namespace, folder: Path | None = None) -> Workers:
    """Return the workers of a command by its options --scheduler and --jobs."""
    address = getattr(options, "scheduler", None)
    return int(options.jobs) if address is None else cluster(address, folder)
