"""Minimum-jerk time courses (Flash and Hogan 1985), and the decaying offset that hides a change of source (Bollo 2016)."""

from collections.abc import Sequence

import numpy as np

from avatarsim.live.drive.tree import Array, Posture, Tree
from avatarsim.spatial import rotation

STEEPNESS = 1.875
"""Largest slope of a minimum-jerk course over a distance of 1 in a time of 1."""

SHORTEST = 0.4
"""[s] Shortest change of source: a third of a second is still seen as one movement."""


def minimum_jerk(share: float) -> float:
    """Return the share of the way at a share of the time, both 0 to 1."""
    s = min(max(share, 0.0), 1.0)
    return s * s * s * (10.0 - 15.0 * s + 6.0 * s * s)


def pulse(share: float) -> float:
    """Return the share of a motion there and back: 1 at half the time."""
    return minimum_jerk(2.0 * share) if share < 0.5 else minimum_jerk(2.0 - 2.0 * share)


def shortened(vector: Array, most: float) -> Array:
    """Return the vector, shortened to length `most` if it is longer."""
    length = float(np.linalg.norm(vector))
    return vector * (most / length) if length > most else vector


def largest_turn(tree: Tree, a: Posture, b: Posture, links: Sequence[int]) -> float:
    """Return the largest turn [rad] of the joints of these links between two postures."""
    turned, angles = rotation.difference(a.turns[links], b.turns[links]), tree.angles(links)
    return _largest(turned, b.angles[angles] - a.angles[angles])


def _largest(vectors: Array, angles: Array) -> float:
    return float(max(np.linalg.norm(vectors, axis=1).max(initial=0.0), np.abs(angles).max(initial=0.0)))


def mixed(tree: Tree, a: Posture, b: Posture, share: float, links: Sequence[int], out: Posture) -> None:
    """Set links' joints to a share of the way from one posture to another."""
    balls, angles = [k for k in links if tree.nodes[k].is_ball], tree.angles(links)
    out.turns[balls] = rotation.slerp(a.turns[balls], b.turns[balls], share)
    out.angles[angles] = a.angles[angles] + share * (b.angles[angles] - a.angles[angles])
    tree.clip(out)


class Offset:
    """Decaying offset added to a source's postures, so that the first one equals the shown one; its decay moves roots by at most
    `speed` [m/s] and joints by at most `turn` [rad/s]."""

    def __init__(self, tree: Tree, shown: Posture, first: Posture, speed: float, turn: float) -> None:
        self._tree, self._age = tree, 0.0
        self._roots, self._angles = shown.roots - first.roots, shown.angles - first.angles
        self._turns = rotation.difference(first.turns, shown.turns)
        farthest = _largest(self._roots[[node.is_free for node in tree.nodes]], np.zeros(0))
        self._length = max(SHORTEST, STEEPNESS * farthest / speed, STEEPNESS * _largest(self._turns, self._angles) / turn)

    def advance(self, dt: float) -> bool:
        """Advance the decay; False once the offset has vanished."""
        self._age += dt
        return self._age < self._length

    def added(self, posture: Posture) -> Posture:
        """Return the posture plus the remaining offset, clipped to the limits."""
        left = 1.0 - minimum_jerk(self._age / self._length)
        return self._tree.clip(Posture(
            posture.roots + left * self._roots, rotation.turned(posture.turns, left * self._turns),
            posture.angles + left * self._angles,
        ))
