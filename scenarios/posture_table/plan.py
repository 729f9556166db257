"""The plan of the table: which jobs, in which groups, for which engines and presets, each asked for by a name that exists."""

import secrets
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from importlib import import_module
from pathlib import Path

from avatarsim.errors import AvatarsimError, InvalidInput, UnknownName
from runfiles.naming import GATED
from scenarios import catalog, unseen
from scenarios.engines import opened
from scenarios.job import CATALOGUE, Job
from scenarios.posture_table import probes
from scenarios.running.harness import named_runs
from scenarios.running.offered import patterns_of, unmatched
from scenarios.scenario import Scenario
from scenarios.variants import takes_part

QUICK = 3
"""With --quick one scene, motion and frame of so many is taken."""
CATALOGUED = "catalogue"
"""Name of the group of the catalogue's scenes with an avatar."""
GROUPS = (CATALOGUED, "rooms", "probes")
"""What --groups may name."""
SEEDS = 2**31
"""Seeds are drawn below this."""

Run = tuple[str, str]
"""Engine and preset."""


@dataclass(frozen=True)
class Wanted:
    """What the command line asks for: scenes by `pattern`; `rooms` of the drawn motions, `motions` in each from `seed` on;
    probes with the clips of a folder; of each scene `frames` at most."""

    runs: tuple[Run, ...]
    groups: tuple[str, ...]
    pattern: str
    rooms: tuple[str, ...]
    motions: int
    seed: int
    clips: Path | None
    frames: int | None
    quick: bool


def drawn_seed() -> int:
    """A seed that no earlier run had: what is tuned on its motions is measured on others the next time."""
    return secrets.randbelow(SEEDS - 1) + 1


def runs_of(presets: Sequence[str], rivals: Sequence[str]) -> tuple[Run, ...]:
    """Our presets and others as engine/preset. UnknownName for a preset or an engine that there is not."""
    known = opened(GATED[0]).presets
    for preset in presets:
        if preset not in known:
            raise UnknownName(f"preset of engine {GATED[0]}", preset, known)
    others = named_runs("--rivals", rivals)
    return tuple(dict.fromkeys([*((GATED[0], preset) for preset in presets), *others]))


def group_of(name: str) -> str:
    """The group in which the table pools a scene."""
    if name.startswith(probes.PREFIX):
        return probes.group_of(name)
    return name if name.startswith(unseen.PREFIX) else CATALOGUED


def jobs(wanted: Wanted) -> list[Job]:
    """Every run, scene by scene. InvalidInput where there is none, or a pattern matches no scene."""
    found: list[Job] = []
    names = list(_scenes(wanted))
    if not names:
        raise InvalidInput("--groups", " ".join(wanted.groups), "groups with scenes; probes need --clips")
    if slips := unmatched([name for name, _, _ in names], wanted.pattern):
        raise InvalidInput("--scenes", ", ".join(slips), "patterns that match scenes of the groups asked for")
    patterns = patterns_of(wanted.pattern)
    for name, catalogue, seed in names:
        if any(fnmatchcase(name, pattern) for pattern in patterns):
            scenario: Scenario = import_module(catalogue).get(name)
            frames = wanted.frames
            if wanted.quick:
                frames = min(frames or scenario.frames, -(-scenario.as_run(False).frames // QUICK))
            found += [Job(name, engine, preset, seed, frames=frames, catalogue=catalogue)
                      for engine, preset in wanted.runs if takes_part(engine, preset, scenario)]
    return found


def _scenes(wanted: Wanted) -> Iterator[tuple[str, str, int]]:
    """Scene, the catalogue it is in, and seed."""
    every = QUICK if wanted.quick else 1
    if CATALOGUED in wanted.groups:
        for name in _with_avatar()[::every]:
            yield name, CATALOGUE, 0
    if "rooms" in wanted.groups:
        for room in wanted.rooms:
            for k in range(-(-wanted.motions // every)):
                yield f"{unseen.PREFIX}{room}", unseen.NAME, wanted.seed + k
    if "probes" in wanted.groups:
        for name in probes.names(every):
            yield name, probes.NAME, 0


def _with_avatar() -> list[str]:
    """Scenes of the catalogue in which there is an avatar, or which cannot be built to see: their runs will say why."""
    def has(scenario: Scenario) -> bool:
        try:
            return bool(scenario.build().links)
        except AvatarsimError:
            return True

    return [name for name, scenario in catalog.scenarios().items() if has(scenario)]


def rooms() -> Mapping[str, str]:
    """Rooms of the drawn motions by the name that --rooms takes."""
    return {name.removeprefix(unseen.PREFIX): name for name in unseen.scenarios()}
