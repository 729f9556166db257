"""Crowds that nothing was tuned for: random bodies poured, struck, swept, gripped, kicked and moved, one for each seed."""

from collections.abc import Callable
from functools import cache

import numpy as np

from avatarsim.errors import InvalidInput, UnknownName
from runfiles.naming import CROWD_PREFIX as PREFIX
from scenarios.building import stage
from scenarios.building.promises import GAINS_NOTHING, KEEPS_TIME, SOUND
from scenarios.drawn_crowds.bodies import LOW
from scenarios.drawn_crowds.kinds import FRAMES, SHORT, Crowd, Drawn, gripped, kicked, poured, struck, swept
from scenarios.drawn_crowds.moved import moved
from scenarios.scenario import Bound, Scenario
from scenarios.unseen import seeds

__all__ = ["NAME", "PREFIX", "draw", "get", "scenarios"]

NAME = __name__
"""The module that a job names as its catalogue."""
KINDS: tuple[Callable[[Drawn], Crowd], ...] = (poured, struck, swept, gripped, kicked, moved)
"""Successive seeds go through these in turn."""
PROMISES = (
    *SOUND, KEEPS_TIME,
    Bound("substep_overlap_max", 1e-6, "nothing overlaps inside a frame either"),
    Bound("travel_missing", 0.0, "all bodies begin in the air, and fall"),
)


@cache
def draw(seed: int) -> Scenario:
    """Return the crowd of a seed, whose name ends with its kind and the seed. Raises InvalidInput for a seed below 0."""
    if seed < 0:
        raise InvalidInput("seed of a drawn crowd", seed, "0 at least")
    kind = KINDS[seed % len(KINDS)]
    name = f"{PREFIX}{kind.__name__}_{seed}"
    crowd = kind(Drawn(name, np.random.default_rng([seed, *PREFIX.encode()])))
    free = not crowd.scene.avatars
    moving = tuple(body.name for body in crowd.scene.bodies if body.mass is not None)
    # a lift gives way to bodies too heavy for it, into the floor
    scenery = {avatar.name for avatar in crowd.scene.avatars if avatar.moves}
    users = tuple(name for name in crowd.scene.names[len(crowd.scene.bodies) :] if name not in scenery)
    return Scenario(
        name, f"{len(moving)} random bodies are {kind.__name__}.",
        "Overlap, time kept and, without a hand, energy; nothing was tuned for it.", lambda: crowd.scene, crowd.motion, FRAMES,
        SHORT, bounds=(*PROMISES, *((GAINS_NOTHING,) if free else ())), regions=(stage.above_floor(*moving, *users),),
        metrics=("stalled_bodies",),
        expects={"travel": dict.fromkeys(crowd.falling, 0.5 * LOW), **({"alone": (moving,)} if free else {})},
    )


def get(name: str) -> Scenario:
    """Return the crowd called `name`, of any seed. Raises UnknownName where no seed has it."""
    digits = name.rpartition("_")[2]
    scenario = draw(int(digits)) if name.startswith(PREFIX) and digits.isdecimal() else None
    if scenario is None or scenario.name != name:
        raise UnknownName("drawn crowd", name, (f"{PREFIX}{kind.__name__}_SEED" for kind in KINDS))
    return scenario


def scenarios() -> dict[str, Scenario]:
    """Return a crowd of each kind by name, from the commit's own seed on."""
    first = seeds.draw().seed
    return {crowd.name: crowd for crowd in map(draw, range(first, first + len(KINDS)))}
