"""Pairs of pieces that may meet within a substep: of near bodies, those whose boxes are nearer than both bodies may go.

How far a body may go is a guess from its velocity. Where contacts send it farther, the list is made wider.
"""

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel
from avatarsim.model.dynamics import Dynamics
from avatarsim.model.geometry import Geometry, Poses
from avatarsim.rigid.contact_generation import boxes_apart
from avatarsim.rigid.state import Memory
from avatarsim.rigid.substep_state import UNKNOWN
from avatarsim.spatial.vec3 import norm, row

Array = NDArray[np.float64]
Index = NDArray[np.int64]

FARTHER = 2.0
"""How many times as far as by its velocity without contact a body is thought to go. Smaller: lists are made wider more often;
larger: they are longer."""


@kernel
def may_go(dynamics: Dynamics, memory: Memory, members: Index, h: float) -> None:
    """Set how far points of the members may go in h seconds, by their velocities without contact, and begin a new list."""
    pull, found = norm((dynamics.gravity[0], dynamics.gravity[1], dynamics.gravity[2])), memory.substeps.found
    for m in range(members.shape[0]):
        b = members[m]
        memory.substeps.room[b] = 0.0
        if memory.moving[b] == 1:
            speed = norm(row(memory.linear_end, b)) + norm(row(memory.angular_end, b)) * memory.span[b]
            memory.substeps.room[b] = memory.margin[0] + FARTHER * h * (speed + h * pull)
    found[0] = 0


@kernel
def beyond(boxes: Array, piece: int, hulls: Array, b: int, margin: float) -> bool:
    """Return whether the box of a piece is more than ``margin`` [m] away from that around body b."""
    for x in range(3):
        if boxes[piece, x] > hulls[b, 3 + x] + margin or hulls[b, x] > boxes[piece, 3 + x] + margin:
            return True
    return False


@kernel
def list_pieces(geometry: Geometry, poses: Poses, memory: Memory, pairs: Index, before: Array, now: Array) -> bool:
    """Append the pairs of pieces of near pairs (count, 2) of bodies that are within reach ``now`` but were not ``before``.

    before, now: (nb) [m] how far bodies may go. No direction is known for the new ones. Returns whether there was room for all.
    """
    sub_, boxes, count = memory.substeps, poses.boxes, memory.substeps.found[0]
    for p in range(pairs.shape[0]):
        a, b = pairs[p, 0], pairs[p, 1]
        reach, old = now[a] + now[b], before[a] + before[b]
        if memory.moving[a] + memory.moving[b] == 0 or not (reach > old):
            continue
        for sa in range(geometry.first_shape[a], geometry.first_shape[a + 1]):
            if beyond(boxes, sa, poses.hulls, b, reach):
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
    """`list_pieces` of all islands that a member leads."""
    islands = memory.islands
    for m in range(members.shape[0]):
        i = islands.label[members[m]]
        if islands.order[islands.first[i]] == members[m]:
            pairs = islands.pairs[islands.pair_first[i] : islands.pair_first[i + 1]]
            if not list_pieces(geometry, poses, memory, pairs, before, now):
                return False
    return True
