"""One scene of a run, searched: a module of its own, so that worker processes find it by name under any command."""

from pathlib import Path

from scenarios.nearest.frames import Frames, Sample
from scenarios.results.kept import as_recorded, recordings


def searched(name: str, run: Path, first: str, count: int) -> list[Sample] | None:
    """The samples of one scene; None where there is no avatar."""
    found = recordings(run, name, first)
    scenario = as_recorded(name, found[0])
    scene = scenario.build()
    if not scene.links:
        return None
    others = [one for one in found[1:] if one.frames == found[0].frames]
    return list(Frames(scenario, scene, found[0], others).samples(count))
