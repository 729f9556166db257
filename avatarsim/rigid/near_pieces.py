"""Pairs of pieces that may meet within a substep: pieces of near bodies whose boxes are closer than the motion of both bodies.

The motion is estimated from the velocity. If contacts make a body move farther, the list is extended.
"""

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel
from avatarsim.model.dynamics import Dynamics
from avatarsim.model.geometry import Geometry, Poses
from avatarsim.rigid.contact_generation import boxes_apart
from avatarsim.rigid.near_pairs import boxes_near
from avatarsim.rigid.state import Memory
from avatarsim.rigid.substep_state import UNKNOWN
from avatarsim.spatial.vec3 import norm, row

Array = NDArray[np.float64]
Index = NDArray[np.int64]

FARTHER = 2.0
"""Safety factor of the estimated motion of a body, from its velocity without contact. Smaller: lists are extended more often;
larger: lists are longer."""


@kernel
def may_go(dynamics: Dynamics, memory: Memory, members: Index, h: float) -> None:
    """Estimate the motion [m] of the members in h seconds from their velocities without contact, and clear the list."""
    gravity, found = norm((dynamics.gravity[0], dynamics.gravity[1], dynamics.gravity[2])), memory.substeps.found
    for m in range(members.shape[0]):
        b = members[m]
        memory.substeps.room[b] = 0.0
        if memory.moving[b] == 1:
            speed = norm(row(memory.linear_end, b)) + norm(row(memory.angular_end, b)) * memory.span[b]
            memory.substeps.room[b] = memory.margin[0] + FARTHER * h * (speed + h * gravity)
    found[0] = 0


@kernel
def list_pieces(geometry: Geometry, poses: Poses, memory: Memory, pairs: Index, before: Array, now: Array) -> bool:
    """Append pairs of pieces of near pairs (count, 2) of bodies that are within reach ``now`` and were not ``before``.

    Args:
        before, now: (nb) [m] motion of the bodies.

    Returns:
        Whether there was room for all.
    """
    sub_, boxes, count = memory.substeps, poses.boxes, memory.substeps.found[0]
    for p in range(pairs.shape[0]):
        a, b = pairs[p, 0], pairs[p, 1]
        reach, old = now[a] + now[b], before[a] + before[b]
        if memory.moving[a] + memory.moving[b] == 0 or not (reach > old):
            continue
        for sa in range(geometry.first_shape[a], geometry.first_shape[a + 1]):
            if not boxes_near(boxes, poses.hulls, sa, b, reach):
                continue
            for sb in range(geometry.first_shape[b], geometry.first_shape[b + 1]):
                if boxes_apart(boxes, sa, sb, reach) or not (old < 0.0 or boxes_apart(boxes, sa, sb, old)):
                    continue
                if count >= sub_.state.shape[0]:
                    return False
                sub_.pieces[count, 0], sub_.pieces[count, 1] = sa, sb
                sub_.state[count], sub_.refused[count] = UNKNOWN, 1
                count += 1
    sub_.found[0] = count
    return True


@kernel
def list_pieces_of(geometry: Geometry, poses: Poses, memory: Memory, members: Index) -> bool:
    """List anew the pairs of pieces of all islands that a member leads; False without room."""
    memory.substeps.found[0] = 0
    for m in range(members.shape[0]):
        memory.substeps.wider[members[m]] = -1.0
    return list_more(geometry, poses, memory, members, memory.substeps.wider, memory.substeps.room)


@kernel
def list_more(geometry: Geometry, poses: Poses, memory: Memory, members: Index, before: Array, now: Array) -> bool:
    """Run `list_pieces` for all islands that a member leads."""
    islands = memory.islands
    for m in range(members.shape[0]):
        i = islands.label[members[m]]
        if islands.order[islands.first[i]] == members[m]:
            pairs = islands.pairs[islands.pair_first[i] : islands.pair_first[i + 1]]
            if not list_pieces(geometry, poses, memory, pairs, before, now):
                return False
    return True
