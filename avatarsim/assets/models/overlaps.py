"""Overlaps of a model at home, its start: moved apart where something is loose, else guarded at their present depth.

Depths are those of EPA (van den Bergh 2001). An avatar with a free root that overlaps something fixed is raised, and a loose
body is moved out of overlaps. A pair of links that overlaps then may be no deeper than it is, and a stand-off (`Scene.at_rest`).
"""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets.models.model import Model
from avatarsim.errors import StartOverlaps
from avatarsim.model.world import World, build
from avatarsim.pose_queries import Overlap, deepest_overlaps, width
from avatarsim.scene.body import Role
from avatarsim.tolerances import NOTHING, POSTURE_GAP

Array = NDArray[np.float64]

LOOSE = 'move the loose body, or what it is welded to, in the file, leave out its geoms (leave=("name", ...)), '\
        "or start at another keyframe"
GROUND = "give the root another height or place, start at another keyframe, or name the pair in <exclude> of the file or exclude="
INSIDE = 'a piece lies so deep in another that no depth says when it goes through: leave it out (leave=("name", ...)), '\
         "start at another keyframe, or let the pairs never touch: exclude="
"""Advice for rejected pairs: with a loose body; of a free avatar and the room; of a piece deep inside another."""

MARGIN = 1e-4
"""[m] Gap after a body is moved out of another: half of the stand-off."""

ROUNDS = 8
"""Most rounds in which bodies are moved by their depths, piles from below. Level ground takes one."""

HIGHEST = 0.5
"""[m] Longest move of a body; of an avatar at least its span, since many files have its root in the plane of the ground. Larger:
bodies leave walls at unintended places."""

SWALLOWED = 1.5
"""Depth, as a share of the least width of the smaller piece, from which a pair is refused: that piece lies half a width below the
surface of the other, and may move that far inside it undetected. Smaller: robots are refused whose neighbours overlap by
design (in 92 public ones up to 1.14, of an upper arm and a forearm that rolls in it); larger: fingers that are in a thigh at
zero angles (2.2 to 2.5) pass for guarded."""

ALLOWED = POSTURE_GAP
"""[m] Additional depth allowed beyond that at home: the stand-off of the engine. At 0 standing at home is a contact."""


def freed(model: Model, root_moves: bool) -> tuple[Model, tuple[str, ...]]:
    """Return the model with loose bodies moved apart, its avatar raised and all other overlaps guarded, and sentences on that.

    `root_moves` is True if the avatar's root is free. Raises StartOverlaps for pairs that can be neither moved nor guarded.
    """
    shifts, stuck = dict[str, Array](), set[str]()
    world = build(model.scene())
    found = deepest_overlaps(world)
    for _ in range(ROUNDS):
        moves = {name: move for name, move in _moves(model, world, found, root_moves).items() if name not in stuck}
        for name in moves:
            if np.linalg.norm(shifts.get(name, 0.0) + moves[name]) > _farthest(model, name):
                stuck.add(name)
                moves[name] = -shifts.get(name, np.zeros(3))
        if not any(move.any() for move in moves.values()):
            break
        for name, move in moves.items():
            shifts[name] = shifts.get(name, np.zeros(3)) + move
        model = _moved(model, moves)
        world = build(model.scene())
        found = deepest_overlaps(world)
    lengths = {name: 1e3 * float(np.linalg.norm(shift)) for name, shift in shifts.items()}
    notes = []
    if listed := [f"{name} by {length:.3g} mm" for name, length in lengths.items() if length > 0.0]:
        notes.append(f"raised or moved at the start, out of what they stood in: {', '.join(listed)}")
    loose, fixed, _ = _roles(model)
    # links that touch at home, to rounding, could not be shown there either
    found = [
        one for one in deepest_overlaps(world, least=-NOTHING)
        if one.depth > NOTHING or not ({one.a, one.b} & loose or (root_moves and {one.a, one.b} & fixed))
    ]
    return _guarded(model, world, found, root_moves, notes)


def _farthest(model: Model, name: str) -> float:
    """Return the longest move [m] of the body or avatar of this name."""
    return HIGHEST if model.avatar is None or name != model.avatar.name else max(HIGHEST, model.avatar.span)


def _roles(model: Model) -> tuple[set[str], set[str], set[str]]:
    """Return names of loose bodies, of fixed ones, and of loose ones that are attached to the avatar."""
    loose = {body.name for body in model.bodies if body.role is Role.SIMULATED}
    own = model.avatar.name if model.avatar is not None else None
    held = {body for body, link in model.attached if own is not None and (link == own or link.startswith(f"{own}/"))}
    return loose, {body.name for body in model.room} - loose, held


def _moves(model: Model, world: World, found: Iterable[Overlap], root_moves: bool) -> dict[str, Array]:
    """Return moves (3,) [m] of loose bodies and of the avatar, from below, so that one round raises a whole pile."""
    loose, fixed, held = _roles(model)
    free = loose - {body for body, _ in model.attached}
    own = model.avatar.name if model.avatar is not None and root_moves else None
    height = dict(zip(world.scene.names, (world.poses.hulls[:, 2] + world.poses.hulls[:, 5]).tolist(), strict=True))
    moves = dict[str, Array]()
    lift = 0.0
    for one in sorted(found, key=lambda one: max(height[one.a], height[one.b])):
        a_goes, b_goes = one.a in free, one.b in free
        if own is not None and not (a_goes or b_goes):
            together = held | (set(world.scene.names) - loose - fixed)
            if (one.a in fixed and one.b in together) or (one.b in fixed and one.a in together):
                lift = max(lift, one.depth + MARGIN)
        if not (a_goes or b_goes):
            continue
        upwards = a_goes and (not b_goes or height[one.a] > height[one.b])
        goes, stays, n = (one.a, one.b, np.array(one.normal)) if upwards else (one.b, one.a, -np.array(one.normal))
        nothing = np.zeros(3)
        before = moves.get(goes, nothing)
        way = one.depth + MARGIN + float(n @ (moves.get(stays, nothing) - before))
        moves[goes] = before + max(way, 0.0) * n
    if own is not None and lift > 0.0:
        # bodies attached to the avatar are raised with it
        moves |= dict.fromkeys((own, *sorted(held)), np.array([0.0, 0.0, lift]))
    return moves


def _moved(model: Model, moves: dict[str, Array]) -> Model:
    """Return the model with bodies and the avatar's start moved [m]."""
    bodies = []
    for body in model.bodies:
        if body.name in moves:
            x, y, z = (float(v) for v in np.array(body.position) + moves[body.name])
            body = replace(body, position=(x, y, z))
        bodies.append(body)
    start = model.start
    if model.avatar is not None and start is not None and model.avatar.name in moves:
        positions = start.positions.copy()
        positions[0] += moves[model.avatar.name]
        start = replace(start, positions=positions)
    return replace(model, bodies=tuple(bodies), start=start)


def _guarded(
    model: Model, world: World, found: Iterable[Overlap], root_moves: bool, notes: list[str]
) -> tuple[Model, tuple[str, ...]]:
    """Return the model with the depths of overlapping pairs bounded, or raise StartOverlaps; welded bodies pass their avatar."""
    loose, fixed, held = _roles(model)
    own = model.avatar.name if model.avatar is not None else ""
    # welded bodies and the links of an avatar are one group; a moving body and the bodies welded to it are another
    owner = dict(model.attached) | dict.fromkeys(held | (set(world.scene.names) - loose - fixed), own)
    welded, guarded, refused = list[Overlap](), list[Overlap](), dict[str, list[Overlap]]()
    for one in sorted(found, key=lambda one: -one.depth):
        pair = {one.a, one.b}
        if pair & loose:
            together = owner.get(one.a, one.a) == owner.get(one.b, one.b)
            (welded if together else refused.setdefault(LOOSE, [])).append(one)
        elif pair & fixed and root_moves:
            refused.setdefault(GROUND, []).append(one)
        elif one.depth > SWALLOWED * min(width(world, one.pieces[0]), width(world, one.pieces[1])):
            refused.setdefault(INSIDE, []).append(one)
        else:
            guarded.append(one)
    if refused:
        inside = tuple((one.a, one.b) for one in refused.get(INSIDE, ()))
        advice = "; ".join(f"{what}{inside}" if what == INSIDE else what for what in refused)
        raise StartOverlaps([(one.a, one.b, one.depth) for some in refused.values() for one in some], advice)
    for some, what in ((guarded, "overlap at the start and may be no deeper"), (welded, "are welded, overlap, and never touch")):
        if some:
            listed = ", ".join(f"{one.a} and {one.b} by {1e3 * one.depth:.3g} mm" for one in some)
            notes.append(f"{len(some)} pairs {what}: {listed}")
    exclude = (*model.exclude, *((one.a, one.b) for one in welded))
    avatar, own_pairs, others = model.avatar, [], list(model.at_rest)
    links = {} if avatar is None else {f"{avatar.name}/{link.name}": link.name for link in avatar.links}
    for one in guarded:
        if one.a in links and one.b in links:
            own_pairs.append((links[one.a], links[one.b], one.depth + ALLOWED))
        else:
            others.append((one.a, one.b, one.depth + ALLOWED))
    if avatar is not None and own_pairs:
        avatar = replace(avatar, at_rest=(*avatar.at_rest, *own_pairs))
    return replace(model, avatar=avatar, exclude=exclude, at_rest=tuple(others)), tuple(notes)
