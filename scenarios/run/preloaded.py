"""Preloading for the fork server: what every worker process of the harness needs of the project is imported once, before forks.

A module at fault is left to the worker process that needs it, which fails where it is used and says so.
"""

from contextlib import suppress
from importlib import import_module

NEEDED = ("scenarios.run.accuracy", "scenarios.run.timing", "reference.judging.judge")
"""The harness and the judge; importing them takes half a second, and a comparison has hundreds of worker processes."""
SMALL = "parallel_link"
"""A scene with an avatar, quickly made: for what is compiled, or read from where compiled code is kept, at its first use."""


def every_scene() -> None:
    """Import the whole catalogue."""
    import_module("scenarios.catalog").scenarios()


def targets_in_use() -> None:
    """Use what leads other engines along the tracker's motion: its kernels take longer to be read than a short run takes."""
    scene = import_module("scenarios.catalog").get(SMALL).build()
    targets = import_module("reference.targets").Targets(scene, clamp=True)
    first = targets.within_limits(scene.first_sample)
    targets.ahead(targets.between(first, first, import_module("numpy").zeros(2)), 1.0)


def sources_read() -> None:
    """Hash every source file, which each worker process would do again."""
    import_module("scenarios.run.provenance").code_hash()


def preload() -> None:
    """All of it, each part as far as it goes."""
    for name in NEEDED:
        with suppress(Exception):
            import_module(name)
    for part in (every_scene, targets_in_use, sources_read):
        with suppress(Exception):
            part()


preload()
