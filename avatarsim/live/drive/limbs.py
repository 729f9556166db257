"""Detection of legs, arms and fingers by the tree and by names that mirror each other (bilateral symmetry).

A link has a side if exchanging left and right in its name gives another link's name: the words, or the letters l and r at its
beginning or end. A limb is a row of at least `LIMB` links of one side, down to a fork or an end. The legs are the pair of limbs
that reaches lowest at the start, and lower than the root; the arms are the remaining pair that is attached highest.
Fingers are rows of links without a fork, at most `FINGER` long, at least `FINGERS` of which hang on one link; they are no limbs,
regardless of their names (on a hand, "lf" is the little and "rf" the ring finger).
"""

import re
from dataclasses import dataclass
from math import hypot

from avatarsim.live.drive.tree import Posture, Tree
from avatarsim.scene.joint import MANY_TURNS, Slide

LIMB = 3
"""Fewest links of a limb: thigh, shank, foot. Less: eyes would be limbs."""

FINGER, FINGERS = 0.2, 3
"""Largest length [m] of a finger without its last bone, and fewest fingers of a hand: a gripper with three, an adult's middle
finger of 0.1 m; longer ones are limbs."""

ONE_WAY = 2.0
"""Factor by which a hinge's range must be larger one way than the other to close a finger; a finger spreads both ways."""


@dataclass(frozen=True)
class Limb:
    """Links of a limb, from the trunk to its `tip`."""

    links: tuple[int, ...]

    @property
    def tip(self) -> int:
        """Link at which the limb ends, or forks into fingers or toes."""
        return self.links[-1]


@dataclass(frozen=True)
class Limbs:
    """Left and right leg, left and right arm of one avatar; empty if absent."""

    legs: tuple[Limb, ...] = ()
    arms: tuple[Limb, ...] = ()


@dataclass(frozen=True)
class Finger:
    """A finger: the link that it is attached to, and its own links in order."""

    hand: int
    links: tuple[int, ...]


SIDES = (("left", "right"), ("Left", "Right"), ("LEFT", "RIGHT"))


def mirrored(name: str) -> list[tuple[str, str]]:
    """Return possible names after exchanging left and right, each with the side in the given name: "left" or "right"."""
    found = []
    for left, right in SIDES:
        for here, there, side in ((left, right, "left"), (right, left, "right")):
            if here in name:
                found.append((name.replace(here, there), side))
    for left, right in (("l", "r"), ("L", "R")):
        for here, there, side in ((left, right, "left"), (right, left, "right")):
            if name.startswith(here):
                found.append((there + name[1:], side))
            if re.search(f"[^a-zA-Z]{here}$", name):
                found.append((name[:-1] + there, side))
    return found


def limbs_of(tree: Tree, posture: Posture) -> Limbs:
    """Return legs and arms of the first avatar, in its start posture; no legs if its root is not free."""
    own = [k for k, node in enumerate(tree.nodes) if node.avatar == 0]
    index = {tree.nodes[k].name: k for k in own}
    side: dict[int, str] = {}
    other: dict[int, int] = {}
    for k in own:
        for name, which in mirrored(tree.nodes[k].name):
            if name in index and k not in side:
                side[k], other[k] = which, index[name]
    pairs, fingers = [], {k for finger in fingers_of(tree) for k in finger.links}
    for k in own:
        if k in fingers or side.get(k) != "left" or side.get(tree.nodes[k].parent) == "left" or side.get(other[k]) != "right":
            continue
        left, right = _row(tree, side, k), _row(tree, side, other[k])
        if min(len(left), len(right)) >= LIMB and min(len(tree.moving(left)), len(tree.moving(right))) >= 2:
            pairs.append((Limb(left), Limb(right)))
    places, _ = tree.poses(posture)
    legs: tuple[Limb, ...] = ()
    lowest = min(pairs, key=lambda pair: places[pair[0].tip, 2], default=None)
    if lowest is not None and tree.nodes[0].is_free and places[lowest[0].tip, 2] < places[0, 2]:
        legs = lowest
        pairs.remove(lowest)
    arms = max(pairs, key=lambda pair: places[pair[0].links[0], 2], default=())
    return Limbs(legs, arms)


def _row(tree: Tree, side: dict[int, str], first: int) -> tuple[int, ...]:
    """Return a link and those below it of the same side, down to a fork or an end."""
    found = [first]
    while len(tree.children[found[-1]]) == 1 and side.get(tree.children[found[-1]][0]) == side.get(first):
        found.append(tree.children[found[-1]][0])
    return tuple(found)


def fingers_of(tree: Tree) -> tuple[Finger, ...]:
    """Return the fingers of all avatars."""
    found = []
    for hand, children in enumerate(tree.children):
        rows = [tuple(tree.subtree(child)) for child in children]
        short = [row for row in rows if all(len(tree.children[k]) < 2 for k in row) and _length(tree, row) <= FINGER]
        if len(short) >= FINGERS:
            found += [Finger(hand, row) for row in short]
    return tuple(found)


def _length(tree: Tree, row: tuple[int, ...]) -> float:
    return sum(hypot(*tree.nodes[k].anchor) for k in row[1:])


def closing(tree: Tree, fingers: tuple[Finger, ...]) -> tuple[tuple[int, float, float], ...]:
    """Return (number of the angle, open angle, closed angle) [rad] of the hinges of fingers that make a fist."""
    found = []
    for finger in fingers:
        for k in finger.links:
            for h, hinge in enumerate(tree.nodes[k].hinges, start=tree.nodes[k].first_angle):
                low, high = hinge.lower, hinge.upper
                if isinstance(hinge, Slide):
                    continue
                if max(-low, high) >= MANY_TURNS or not max(-low, high) > ONE_WAY * max(0.0, min(-low, high)):
                    continue
                rest = min(max(0.0, low), high)
                found.append((h, rest, high if high > -low else low))
    return tuple(found)


def handle_links(tree: Tree) -> tuple[int, ...]:
    """Return the links to drag: free roots and ends of limbs; for an avatar with several hands these instead of their fingers."""
    hands: dict[int, set[int]] = {}
    for finger in fingers_of(tree):
        hands.setdefault(tree.nodes[finger.hand].avatar, set()).add(finger.hand)
    hand = {one.links[-1]: one.hand for one in fingers_of(tree) if len(hands[tree.nodes[one.hand].avatar]) > 1}
    found = [k for k, node in enumerate(tree.nodes) if node.parent < 0 and node.is_free]
    found += [hand.get(k, k) for k, children in enumerate(tree.children) if not children]
    return tuple(sorted(set(found)))
