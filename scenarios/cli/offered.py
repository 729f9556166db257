"""Which scenes a command takes: catalogue and unseen ones, and of these what the patterns of `--filter` let through."""

from collections.abc import Iterable, Mapping
from fnmatch import fnmatchcase
from typing import TypeVar

from avatarsim.errors import UnknownName
from scenarios import catalog, drawn_crowds, own_scenes, unseen
from scenarios.job import CATALOGUE, Job
from scenarios.scenario import Scenario
from scenarios.unseen import seeds

Scene = TypeVar("Scene")


def patterns_of(text: str) -> list[str]:
    """Patterns with commas between them; blanks beside these do not count."""
    return [pattern.strip() for pattern in text.split(",")]


def unmatched(names: Iterable[str], text: str) -> list[str]:
    """The patterns that match none of the names."""
    known = list(names)
    return [pattern for pattern in patterns_of(text) if not any(fnmatchcase(name, pattern) for name in known)]


def filtered(scenes: Mapping[str, Scene], text: str) -> dict[str, Scene]:
    """Scenes by name that a pattern lets through; none if one of the patterns matches nothing: a misspelt name in a list would
    otherwise pass for a scene that held."""
    if unmatched(scenes, text):
        return {}
    patterns = patterns_of(text)
    return {name: scene for name, scene in scenes.items() if any(fnmatchcase(name, pattern) for pattern in patterns)}


MIXED = ("list", "run", "compare")
"""Commands that take the unseen scenes and a few drawn crowds along."""
NAMED = ("check", "bench")
"""Commands that take them only where a pattern names them: figures of these stand beside committed ones, and motions change."""


def scenarios(command: str, patterns: str | None = None) -> dict[str, Scenario]:
    """Every scene that `command` offers, the unseen ones last; `patterns` is the text of its filter, None without one."""
    found = catalog.scenarios()
    if own_scenes.scenarios():
        return found
    for beside in (unseen, drawn_crowds):
        named = any(pattern.startswith(beside.PREFIX) for pattern in patterns_of(patterns or ""))
        if command in MIXED or (command in NAMED and named):
            found = {**found, **beside.scenarios()}
    return found


def get(name: str) -> Scenario:
    """The scene called `name`, of any kind, a drawn crowd of any seed; UnknownName lists all."""
    if name.startswith(drawn_crowds.PREFIX):
        return drawn_crowds.get(name)
    known = scenarios("list")
    if name not in known:
        raise UnknownName("scenario", name, known)
    return known[name]


def catalogue_of(name: str) -> str:
    """The module whose `get` gives the scene."""
    if name.startswith(drawn_crowds.PREFIX):
        return drawn_crowds.NAME
    return unseen.NAME if name in unseen.scenarios() else CATALOGUE


def seed_of(name: str, asked: int) -> int:
    """The seed of a job: as asked for, but for an unseen scene, where OWN stands for the commit's own."""
    return seeds.drawn().seed if asked == seeds.OWN and name in unseen.scenarios() else asked


def origin(jobs: Iterable[Job]) -> dict[str, object]:
    """For a run's provenance: what the seed of its unseen motions was drawn from; empty where none was drawn."""
    drawn = any(job.catalogue == unseen.NAME and job.seed == seeds.drawn().seed for job in jobs)
    return {"unseen": seeds.drawn().said} if drawn else {}
