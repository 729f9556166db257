"""Minimum-jerk time courses (Flash and Hogan 1985), and the decaying offset that hides a change of source (Bollo 2016).
"""

from avatarsim.live.drive.tree import Posture, Tree
from avatarsim.live.drive.turns import add, norm, scaled, sub, turned_by, way

STEEPNESS = 1.875
"""Largest slope of a minimum-jerk course, of a way of 1 in a time of 1."""

SHORTEST = 0.4
"""[s] a change of source takes at least: a third of a second is what eyes still follow as one movement."""


def minimum_jerk(share: float) -> float:
    """Share of the way at a share of the time, both 0 to 1."""
    s = min(max(share, 0.0), 1.0)
    return s * s * s * (10.0 - 15.0 * s + 6.0 * s * s)


def pulse(share: float) -> float:
    """There and back: 1 at half the time."""
    return minimum_jerk(2.0 * share) if share < 0.5 else minimum_jerk(2.0 - 2.0 * share)


def largest_turn(a: Posture, b: Posture, turns: list[int], angles: list[int]) -> float:
    """[rad] the most that one of these joints turns between two postures."""
    found = [norm(way(a.turns[k], b.turns[k])) for k in turns] + [abs(b.angles[h] - a.angles[h]) for h in angles]
    return max(found, default=0.0)


def mixed(tree: Tree, a: Posture, b: Posture, share: float, links: list[int], out: Posture) -> None:
    """Put links' joints at a share of the way from one posture to another."""
    for k in links:
        node = tree.nodes[k]
        if node.is_ball:
            out.turns[k] = turned_by(scaled(way(a.turns[k], b.turns[k]), share), a.turns[k])
        for h in range(node.first_angle, node.first_angle + len(node.hinges)):
            out.angles[h] = a.angles[h] + share * (b.angles[h] - a.angles[h])
    tree.clip(out)


def within_limits(tree: Tree, posture: Posture) -> Posture:
    """The posture with each joint inside its limits."""
    found = posture.copy()
    tree.clip(found)
    return found


class Offset:
    """What is added to a source's postures so that its first one is what was shown; its decay moves roots by at most `speed`
    [m/s] and joints by at most `turn` [rad/s]."""

    def __init__(self, tree: Tree, shown: Posture, first: Posture, speed: float, turn: float) -> None:
        self._tree, self._age = tree, 0.0
        self._roots = [sub(a, b) for a, b in zip(shown.roots, first.roots, strict=True)]
        self._turns = [way(b, a) for a, b in zip(shown.turns, first.turns, strict=True)]
        self._angles = [a - b for a, b in zip(shown.angles, first.angles, strict=True)]
        farthest = max((norm(one) for one, node in zip(self._roots, tree.nodes, strict=True) if node.is_free), default=0.0)
        widest = max([norm(one) for one in self._turns] + [abs(one) for one in self._angles], default=0.0)
        self._length = max(SHORTEST, STEEPNESS * farthest / speed, STEEPNESS * widest / turn)

    def advance(self, dt: float) -> bool:
        """Let time pass; False once nothing is left of it."""
        self._age += dt
        return self._age < self._length

    def added(self, posture: Posture) -> Posture:
        """The posture, with what is left of the offset, inside the limits."""
        left = 1.0 - minimum_jerk(self._age / self._length)
        return within_limits(self._tree, Posture(
            [add(a, scaled(b, left)) for a, b in zip(posture.roots, self._roots, strict=True)],
            [turned_by(scaled(b, left), a) for a, b in zip(posture.turns, self._turns, strict=True)],
            [a + left * b for a, b in zip(posture.angles, self._angles, strict=True)],
        ))
