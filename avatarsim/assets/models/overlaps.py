"""Overlaps of a model at its reference: measured as when a scene is loaded, and taken away before it is.

Depths are those of EPA (van den Bergh 2001). An avatar with a free root, and a loose body, that stand in something fixed are
raised; what overlaps after that is excluded and said.
"""

from collections.abc import Sequence
from dataclasses import replace

from avatarsim.assets.models.model import Model
from avatarsim.model.world import build
from avatarsim.pose_queries import overlapping_pairs
from avatarsim.scene.body import Role

MARGIN = 1e-4
"""[m] How far above what it stood in a body is put: half of the distance that the engine keeps by itself."""

ROUNDS = 8
"""How often a body is raised: by its depth each time, which is enough at once where what it stands in is level."""

HIGHEST = 0.5
"""[m] How far a body is raised at most, an avatar by its span: many files have the root of one that stands in the ground's plane.
More: it hangs in a wall, and where it is meant to be is a guess."""

Pairs = list[tuple[str, str, float]]


def freed(model: Model, root_moves: bool) -> tuple[Model, tuple[str, ...]]:
    """The model without overlaps at its start, and sentences on what was done; `root_moves` says whether its avatar's root is
    free. Bodies are raised; pairs that overlap then are in `exclude`, or in the avatar's `ignore`."""
    raised: dict[str, float] = {}
    stuck: set[str] = set()
    pairs = overlapping_pairs(build(model.scene()))
    for _ in range(ROUNDS):
        lifts = {name: depth + MARGIN for name, depth in _lifts(model, pairs, root_moves).items() if name not in stuck}
        for name in [name for name, lift in lifts.items() if raised.get(name, 0.0) + lift > _highest(model, name)]:
            stuck.add(name)
            lifts[name] = -raised.get(name, 0.0)
        if not any(lifts.values()):
            break
        for name, lift in lifts.items():
            raised[name] = raised.get(name, 0.0) + lift
        model = _raised(model, lifts)
        pairs = overlapping_pairs(build(model.scene()))
    said = []
    if lifted := [f"{name} by {1e3 * lift:.3g} mm" for name, lift in raised.items() if lift > 0.0]:
        said.append(f"raised at the start, to stand on what they stood in: {', '.join(lifted)}")
    if pairs:
        listed = ", ".join(f"{a} and {b} by {1e3 * depth:.3g} mm" for a, b, depth in sorted(pairs, key=lambda pair: -pair[2]))
        said.append(f"{len(pairs)} pairs overlap at the reference and never touch: {listed}")
    return _without(model, pairs), tuple(said)


def _highest(model: Model, name: str) -> float:
    """How far [m] the body or avatar of this name is raised at most."""
    return HIGHEST if model.avatar is None or name != model.avatar.name else max(HIGHEST, model.avatar.span)


def _lifts(model: Model, pairs: Pairs, root_moves: bool) -> dict[str, float]:
    """How deep [m] each body that may be raised, and the avatar, stand in something fixed."""
    loose = {body.name for body in model.bodies if body.role is Role.SIMULATED}
    fixed = {body.name for body in model.room} - loose
    found: dict[str, float] = {}
    for a, b, depth in pairs:
        for one, other in ((a, b), (b, a)):
            if other not in fixed:
                continue
            if one in loose:
                found[one] = max(found.get(one, 0.0), depth)
            elif model.avatar is not None and root_moves:
                found[model.avatar.name] = max(found.get(model.avatar.name, 0.0), depth)
    own = model.avatar.name if model.avatar is not None and root_moves else ""
    together = {own, *(body for body, link in model.attached if own and (link == own or link.startswith(f"{own}/")))}
    for body, _ in model.attached:
        if body not in together:
            # it keeps its place on what it is welded to
            found.pop(body, None)
    if own:
        # what is attached to the avatar is raised with it
        if lift := max((found.get(name, 0.0) for name in together), default=0.0):
            found |= dict.fromkeys(together, lift)
    return found


def _raised(model: Model, lifts: dict[str, float]) -> Model:
    """The model with bodies, and its avatar's start, moved up [m]."""
    bodies = tuple(
        replace(body, position=(*body.position[:2], body.position[2] + lifts[body.name])) if body.name in lifts else body
        for body in model.bodies
    )
    start = model.start
    if model.avatar is not None and start is not None and model.avatar.name in lifts:
        positions = start.positions.copy()
        positions[0, 2] += lifts[model.avatar.name]
        start = replace(start, positions=positions)
    return replace(model, bodies=bodies, start=start)


def _without(model: Model, pairs: Sequence[tuple[str, str, float]]) -> Model:
    """The model in which these pairs never touch."""
    avatar, own, others = model.avatar, [], []
    named = {} if avatar is None else {f"{avatar.name}/{link.name}": link.name for link in avatar.links}
    for a, b, _ in pairs:
        if a in named and b in named:
            own.append((named[a], named[b]))
        else:
            others.append((a, b))
    if avatar is not None and own:
        avatar = replace(avatar, ignore=(*avatar.ignore, *own))
    at_rest = (*model.at_rest, *((a, b) for a, b, _ in pairs))
    return replace(model, avatar=avatar, exclude=(*model.exclude, *others), at_rest=at_rest)
