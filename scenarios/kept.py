"""The recordings that a run has kept, by scene: what later questions about the run are answered from."""

from fnmatch import fnmatchcase
from pathlib import Path

from avatarsim.errors import UnknownName
from scenarios import catalog
from scenarios.record import Recording, load
from scenarios.scenario import Scenario


def scenes_of(run: Path, who: str, pattern: str = "*") -> list[str]:
    """Names of the scenes of which `run` has the recording of `who` (engine.preset), seed 0."""
    ending = f".{who}.0.npz"
    names = [path.name.removesuffix(ending) for path in sorted((run / "recordings").glob(f"*{ending}"))]
    return [name for name in names if fnmatchcase(name, pattern)]


def recordings(run: Path, name: str, first: str) -> list[Recording]:
    """All recordings of a scene, seed 0, that of `first` (engine.preset) at the front. UnknownName without that one."""
    found = {path.name.removeprefix(f"{name}.").removesuffix(".0.npz"): path for path in
             sorted((run / "recordings").glob(f"{name}.*.0.npz"))}
    if first not in found:
        raise UnknownName(f"recording of {name} in {run}", first, found)
    return [load(path) for path in (found.pop(first), *found.values())]


def as_recorded(name: str, recording: Recording) -> Scenario:
    """The scenario at the length that was recorded."""
    return catalog.get(name).as_run(bool(recording.meta.get("full")))
