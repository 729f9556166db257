"""State and scratch of certified substeps: per body, per near pair of pieces, per contact row."""

from typing import Annotated, NamedTuple

import numpy as np

from avatarsim.jit.kept import COUNT_OR_NONE, FLAG, KEPT
from avatarsim.jit.layout import IndexGrid, IndexLine, Line, Vectors
from avatarsim.model.geometry import Poses

UNKNOWN, KNOWN = 0, 1
"""State of a near pair of pieces: no direction known yet, or a direction and gap at the start of the substep."""

FIXED_GROUP = -1
"""Group index of bodies that are stopped by a body that does not move."""

PIECES_ROOM, PIECES_PER_PAIR = 65536, 2
"""Room for near pairs of pieces, or so many per near pair of bodies if that is more. An island whose pairs have no room waits for
the next frame, and the status reports it."""


class Substeps(NamedTuple):
    """nb bodies; near pairs of pieces up to `room`; contact rows up to `cap`. Flags are 0 or 1.

    members         (nb) bodies of the island that takes the substep
    crowd           (nb) flag: the island of the body advances by substeps
    calm            (nb) frames for which the body has been slow
    share           (nb) share of its own motion that the body keeps; the rest is the mean of its group
    group           (nb) union-find parent in a group of refused bodies, or FIXED_GROUP
    mean            (nb, 3) [m/s] weighted mean velocity of the group that the body represents; mass (nb) [kg] its weight
    wall            (nb, 3) normal, into the group, of the body along which the group that the body represents slides; 0 without
    velocity, turning   (nb, 3) velocities at the start of the motion in this substep [m/s], [rad/s]
    turn            (nb) [rad] angle turned in this substep
    bulge           (nb) [m] how far core points leave the chord of their motion
    changed, near   (nb) flags: velocity changed since the last certificate; within reach of a refused pair
    pushed          (nb) flag: a contact acts on the body
    room, wider     (nb) [m] motion of the body that the list of pairs of pieces covers, now and after an extension
    lacking         (1) flag: pairs of pieces that may meet have no room in the list
    found           (1) number of near pairs of pieces
    pieces          (room, 2) pieces; state (room) UNKNOWN or KNOWN; refused (room) flag
    normal, gap     (room, 3) direction out of B into A at the start, (room) gap there [m]
    approach        (cap) [m/s] velocity along the normal before the solve
    spare_impulse   (cap, 3) [N s] of the rows, solved with lifts
    idle            (cap) flag: the row takes no part in the solve
    kinetic         (1) [J] kinetic energy of the island before the solve
    lasting         (1) rows that have a key and are remembered; rows of refused pairs follow
    low, high       poses along the motion, for bisection
    spare_linear, spare_angular, change_linear, change_angular   (nb, 3) velocities before restitution, and its changes
    """

    members: IndexLine
    crowd: Annotated[IndexLine, KEPT, FLAG]
    calm: Annotated[IndexLine, KEPT, COUNT_OR_NONE]
    share: Line
    group: IndexLine
    mean: Vectors
    mass: Line
    wall: Vectors
    velocity: Vectors
    turning: Vectors
    turn: Line
    bulge: Line
    changed: IndexLine
    near: IndexLine
    pushed: IndexLine
    room: Line
    wider: Line
    lacking: IndexLine
    found: IndexLine
    pieces: IndexGrid
    state: IndexLine
    refused: IndexLine
    normal: Vectors
    gap: Line
    approach: Line
    spare_impulse: Vectors
    idle: IndexLine
    kinetic: Line
    lasting: IndexLine
    low: Poses
    high: Poses
    spare_linear: Vectors
    spare_angular: Vectors
    change_linear: Vectors
    change_angular: Vectors


def make_substeps(bodies: int, poses: Poses, room: int, cap: int) -> Substeps:
    """Allocate for so many bodies, near pairs of bodies and contact rows."""
    n, pieces = bodies, len(poses.boxes)
    many = min(max(PIECES_ROOM, PIECES_PER_PAIR * room), max(1, pieces * (pieces - 1) // 2))
    whole, vectors = np.zeros(n, np.int64), np.zeros((n, 3))
    low, high = (Poses(*(field.copy() for field in poses)) for _ in range(2))
    return Substeps(
        members=whole.copy(), crowd=whole.copy(), calm=whole.copy(), share=np.ones(n), group=np.arange(n, dtype=np.int64),
        mean=vectors.copy(), mass=np.zeros(n), wall=vectors.copy(), velocity=vectors.copy(), turning=vectors.copy(),
        turn=np.zeros(n), bulge=np.zeros(n), changed=whole.copy(), near=whole.copy(), pushed=whole.copy(),
        room=np.zeros(n), wider=np.zeros(n), lacking=np.zeros(1, np.int64), found=np.zeros(1, np.int64),
        pieces=np.zeros((many, 2), np.int64), state=np.zeros(many, np.int64), refused=np.zeros(many, np.int64),
        normal=np.zeros((many, 3)), gap=np.zeros(many), approach=np.zeros(cap), spare_impulse=np.zeros((cap, 3)),
        idle=np.zeros(cap, np.int64),
        kinetic=np.zeros(1), lasting=np.zeros(1, np.int64), low=low, high=high,
        spare_linear=vectors.copy(), spare_angular=vectors.copy(), change_linear=vectors.copy(), change_angular=vectors.copy(),
    )
