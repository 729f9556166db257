"""Arrays of the responses of avatars with joints to impulses at their contacts."""

from typing import NamedTuple

import numpy as np

from avatarsim.jit.layout import IndexLine, Stack

UNTOUCHED, WRENCH, LANES = -1, 6, 4
"""Place of a link that no contact touches; numbers of a force and a torque; numbers that the solver takes at a time, of which the
last one is zero."""

LINKED_ROOM = 512
"""Room for contacts of links that respond with all of their avatar; further ones take no impulse."""


class Responses(NamedTuple):
    """Velocities of the links of avatars per impulse at a contact, in fours as the solver has them (`solver.lay_out`).

    used (1) blocks in use; root (blocks) body index of the root link of the avatar of each;
    touches (nb) links of an avatar that contacts touch, at its root; touched (nb) their bodies, in places from its root on;
    place (nb) of a link among them, or UNTOUCHED;
    by_wrench (links, 6, links of an avatar, 8) velocities per unit force and unit torque on a touched link;
    velocity (blocks, links of an avatar, 3, 8) rows: velocities of each touched link per unit impulse along each axis of the
    contact.
    """

    used: IndexLine
    root: IndexLine
    touches: IndexLine
    touched: IndexLine
    place: IndexLine
    by_wrench: Stack
    velocity: Stack


def make_responses(bodies: int, links: int, most: int) -> Responses:
    """Allocate for so many links, at most so many of one avatar; nothing without any."""
    room = LINKED_ROOM if most > 0 else 0
    index = np.zeros(bodies, np.int64)
    return Responses(
        np.zeros(1, np.int64), np.zeros(room, np.int64), index, index.copy(), np.full(bodies, UNTOUCHED),
        np.zeros((links if most > 0 else 0, WRENCH, most, 2 * LANES)), np.zeros((room, most, 3, 2 * LANES)),
    )
