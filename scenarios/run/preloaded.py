"""Preloading for the fork server: modules and data that every worker process needs, loaded once before forks.

A part that fails is skipped; the worker process that needs it fails where it is used and reports it.
"""

from contextlib import suppress
from importlib import import_module


def harness() -> None:
    """Import the harness and the judge: half a second for each of hundreds of processes."""
    for name in ("scenarios.run.accuracy", "scenarios.run.timing", "reference.judging.judge"):
        import_module(name)


def catalogue() -> None:
    """Import all scenes."""
    import_module("scenarios.catalog").scenarios()


def target_kernels() -> None:
    """Load the kernels that lead other engines along the tracker's motion, which takes longer than a short run."""
    scene = import_module("scenarios.catalog").get("parallel_link").build()
    targets = import_module("reference.targets").Targets(scene, clamp=True)
    first = targets.within_limits(scene.first_sample)
    targets.ahead(targets.between(first, first, import_module("numpy").zeros(2)), 1.0)


def source_hash() -> None:
    """Hash every source file."""
    import_module("scenarios.run.provenance").code_hash()


def preload() -> None:
    """Load all parts."""
    for part in (harness, catalogue, target_kernels, source_hash):
        with suppress(Exception):
            part()


preload()
