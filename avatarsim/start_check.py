"""Overlap check of the first pose at load, over every pair that the scene's pair filter lets through."""

import numpy as np

from avatarsim.collide.scratch import make_scratch
from avatarsim.collide.signed_distance import signed_distance
from avatarsim.collide.status import NOT_FINITE, OUT_OF_ROOM
from avatarsim.collide.sweep import sweep_and_prune
from avatarsim.collide.sweep_memory import make_sweep_memory
from avatarsim.errors import AvatarsimError, InvalidScene, StartOverlaps
from avatarsim.spatial.tangent import columns
from avatarsim.tolerances import NOTHING
from avatarsim.world.limits import cone_excess, has_cone
from avatarsim.world.skeleton import BALL, HINGES
from avatarsim.world.world import World


def overlapping_pairs(world: World) -> list[tuple[str, str, float]]:
    """Every wanted pair that overlaps, by name, with its depth [m], one entry per pair of bodies."""
    geo, poses, names = world.geometry, world.poses, world.scene.names
    scratch, found = make_scratch(), []
    for a, b in meeting_pairs(world):
        depth = 0.0
        for s in range(geo.first_shape[a], geo.first_shape[a + 1]):
            for t in range(geo.first_shape[b], geo.first_shape[b + 1]):
                gap = signed_distance(poses.vertices, geo.shapes, s, t, (0.0, 0.0, 0.0), scratch)[1]
                depth = max(depth, -gap)
        # resting contact described in decimal numbers may be off by rounding
        if depth > NOTHING:
            found.append((names[a], names[b], depth))
    return found


def meeting_pairs(world: World, within: float = 0.0) -> list[tuple[int, int]]:
    """Every wanted pair of bodies a < b whose boxes meet, each grown by half of `within` [m], in ascending order."""
    bodies, room, boxes = len(world.scene.names), 0, world.poses.hulls
    if within > 0.0:
        # and by as much as the sums round
        boxes = boxes + np.repeat([-0.5, 0.5], 3) * (within + NOTHING)
    while True:
        pairs = np.zeros((room, 2), np.int64)
        status, room = sweep_and_prune(boxes, world.geometry.wanted, make_sweep_memory(bodies, room), pairs)
        if status == NOT_FINITE:
            raise AvatarsimError("a box of the first pose is not finite: this is a defect, please report it with the scene")
        if status != OUT_OF_ROOM:
            return [(int(a), int(b)) for a, b in pairs[:room]]


def require_within_limits(world: World, slack: float = 0.0) -> None:
    """Raise InvalidScene when the first posture is beyond a joint limit, by more than `slack` [rad]: it could not be shown."""
    skel = world.skeleton
    for i, link in enumerate(world.scene.links):
        if skel.kind[i] == HINGES:
            for j in range(skel.first_dof[i], skel.first_dof[i + 1]):
                angle, (low, high) = world.posture.angle[j], skel.limits[j]
                if not low - slack <= angle <= high + slack:
                    raise InvalidScene(f"start angle of a hinge of {link.name} [rad]", float(angle), f"{low:g} to {high:g}")
        elif skel.kind[i] == BALL and has_cone(skel, i):
            excess = cone_excess(skel, i, columns(world.posture.turn, i))
            if not excess <= slack:
                thing = f"start rotation of {link.name} beyond its swing and twist limits [rad]"
                raise InvalidScene(thing, float(excess), "0 or less")


def require_free(world: World) -> None:
    """Raise StartOverlaps when the first pose is not free."""
    found = overlapping_pairs(world)
    if found:
        raise StartOverlaps(found)
