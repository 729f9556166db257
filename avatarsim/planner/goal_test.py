"""Goal test: is there a free posture near the target's, and near enough to be worth a path?

Asked one after the other: the target's posture, the target's root with the joints of the shown posture and of the travel
posture, and the same three with the root drawn aside. The first that is free and has at most half of the shown posture's
objective is the goal. A hand that presses on a table is half as near nowhere, so it is led nowhere.
"""

from avatarsim.ik.certify import certify
from avatarsim.ik.kinematics import tangent_error
from avatarsim.ik.objective import LOSS_RADIUS, value_of
from avatarsim.ik.state import Avatars
from avatarsim.ik.target import copy_posture
from avatarsim.jit.kernel import kernel
from avatarsim.planner.ghost import put_ghost
from avatarsim.planner.state import Ghost
from avatarsim.settings import PostureSettings
from avatarsim.spatial.vec3 import norm, put_row, row, scale, sub
from avatarsim.world.geometry import Geometry
from avatarsim.world.skeleton import FREE, Posture, Skeleton

CLOSER = 0.5
"""Share of the shown posture's objective that a goal has at most. Larger: avatars walk about for little."""

JOINTS, DIRECTIONS, RINGS = 3, 7, 4
"""Postures of the joints, directions in which the root is drawn aside, and distances: half a loss radius, doubled each time."""

CANDIDATES = JOINTS * (1 + DIRECTIONS * RINGS)


@kernel
def place_candidate(
    geo: Geometry, skel: Skeleton, avatars: Avatars, avatar: int, number: int, shown: Posture, target: Posture, ghost_out: Ghost
) -> bool:
    """Put the ghost at a candidate; False where there is none of this number: without a free root, or at the target already."""
    g, root = ghost_out, avatars.first_link[avatar]
    joints, place = number % JOINTS, number // JOINTS
    if number > 0 and skel.kind[root] != FREE:
        return False
    copy_posture(skel, avatars, avatar, target if joints == 0 else shown if joints == 1 else g.travel, g.posture)
    if skel.kind[root] == FREE:
        for i in range(3):
            g.posture.root[root, i] = target.root[root, i]
            for k in range(3):
                g.posture.turn[root, i, k] = target.turn[root, i, k]
    if place > 0:
        ring, direction = (place - 1) // DIRECTIONS, (place - 1) % DIRECTIONS
        aside = 0.5 * LOSS_RADIUS * g.state.tracking.reach[avatar] * 2**ring
        if direction < DIRECTIONS - 1:
            g.posture.root[root, direction // 2] += aside if direction % 2 == 0 else -aside
        else:
            back = sub(row(shown.root, root), row(target.root, root))
            far = norm(back)
            if far < aside:
                return False
            put_row(g.posture.root, root, sub(row(target.root, root), scale(back, -aside / far)))
    put_ghost(geo, skel, avatars, avatar, g)
    return True


@kernel
def is_goal(
    geo: Geometry, skel: Skeleton, avatars: Avatars, settings: PostureSettings, avatar: int, target: Posture, value: float,
    ghost_out: Ghost
) -> bool:
    """Whether the ghost stands free where a path may end: the shown posture's objective is `value` [m^2].

    The ghost's own objective holds the link origins of the target."""
    g = ghost_out
    tangent_error(skel, avatars, avatar, g.posture, target, g.scratch.objective.error)
    there, _ = value_of(skel, avatars, avatar, g.state, g.poses, g.scratch.objective)
    if not there <= CLOSER * value:
        return False
    return is_free(geo, skel, avatars, settings, g)


@kernel
def is_free(geo: Geometry, skel: Skeleton, avatars: Avatars, settings: PostureSettings, ghost_out: Ghost) -> bool:
    """Whether the ghost overlaps nothing and keeps its limits: then standing still is certified."""
    g = ghost_out
    g.scratch.step[:] = 0.0
    g.state.tracking.is_certified[g.scratch.members[0]] = 0
    return certify(geo, skel, avatars, settings, g.posture, g.poses, 0, 1, False, False, g.state, g.scratch) == 0
