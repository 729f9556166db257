"""Avatars: trees of links. The first link is the root; a rigid hand is an avatar of one link."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from avatarsim.errors import InvalidScene
from avatarsim.scene.body import Mass
from avatarsim.scene.checks import (
    FASTEST,
    Quaternion,
    Vector,
    bounded,
    depths,
    distinct,
    each,
    instance,
    name_pairs,
    named,
    pair,
    place,
    positive,
    unit_quaternion,
    within,
)
from avatarsim.scene.joint import Ball, Coupling, Free, Hinges, Joint, Rigid, Slide, axes_of, unit_of
from avatarsim.scene.shape import Piece, reach
from avatarsim.settings import CouplingSettings
from avatarsim.spatial import rotation


@dataclass(frozen=True)
class Link:
    """A rigid part of an avatar. Its frame sits in the joint's centre.

    `anchor` [m] is that centre in the parent's frame, `orientation` the link's frame in the parent's when the joint is at zero. A
    root that is not `Free` is anchored to the world. `mass` is the mass that others feel in an impact. `surface_velocity` [m/s]
    is that of its surface in its frame, as of a conveyor belt: loose bodies on it are carried along. Raises InvalidScene for
    other values.
    """

    name: str
    parent: str | None
    joint: Joint
    pieces: tuple[Piece, ...]
    mass: Mass
    material: str = "human"
    anchor: Vector = (0.0, 0.0, 0.0)
    orientation: Quaternion = rotation.IDENTITY
    surface_velocity: Vector = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        named("a link", self.name)
        instance(f"parent of link {self.name}", self.parent, str | None, "the name of a link, or None for the root")
        each(f"pieces of link {self.name}", self.pieces, Piece, "a Piece(shape)")
        instance(f"mass of link {self.name}", self.mass, Mass, "a Mass, for instance solid(pieces, kg)")
        named(f"the material of link {self.name}", self.material)
        joint: object = self.joint
        if not isinstance(joint, Free | Rigid | Hinges | Slide | Ball):
            valid = "Free(), Rigid(), Hinges((Hinge(...), ...)), Slide(...) or Ball(...)"
            raise InvalidScene(f"joint of link {self.name}", joint, valid)
        object.__setattr__(self, "anchor", place(f"anchor of link {self.name}", self.anchor))
        object.__setattr__(self, "orientation", unit_quaternion(f"orientation of link {self.name}", self.orientation))
        surface = bounded(f"surface velocity of link {self.name} [m/s]", self.surface_velocity, FASTEST)
        object.__setattr__(self, "surface_velocity", surface)


SOFTEST, STIFFEST = 1e-3, 1e9
"""Smallest force [N] of a drive, and its largest stiffness [N/m] and damping [N s/m]."""

PLAUSIBLE_SIZE = (0.01, 20.0)
"""Span [m] of an avatar, unless its author says otherwise: from a fingertip to a giant. Millimetres or centimetres taken for
metres fall outside, and would otherwise run without complaint and be wrong."""


@dataclass(frozen=True)
class Drive:
    """Virtual coupling of an avatar, equation 6: a spring and a damper between each link and its tracked pose.

    `stiffness` is K [N/m]; with a smaller value a load lowers a hand farther, and with 0 a body stays where others push it.
    `damping` is R [N s/m]; with a smaller value a hand oscillates after a collision. `largest_force` [N] limits the spring
    force. Raises InvalidScene if the force is not positive, or if the stiffness or the damping is negative.
    """

    stiffness: float = CouplingSettings().spring
    damping: float = CouplingSettings().damping
    largest_force: float = math.inf

    def __post_init__(self) -> None:
        object.__setattr__(self, "stiffness", within("stiffness of a drive [N/m]", self.stiffness, 0.0, STIFFEST))
        object.__setattr__(self, "damping", within("damping of a drive [N s/m]", self.damping, 0.0, STIFFEST))
        object.__setattr__(self, "largest_force", within("largest force of a drive [N]", self.largest_force, SOFTEST, math.inf))


@dataclass(frozen=True)
class Avatar:
    """A tree of links, parents before children, driven by a tracker.

    `chains` name the tips of the paper's chains (arms, legs, neck), `ignore` the pairs of links that may overlap because they do
    so at rest (a shoulder in a chest), however deep, `at_rest` those that may be no deeper [m] than stated. `couplings` name
    hinges and slides that follow others. `coupled_mass` [kg] is m in eq. 6 and the mass that a simulated body feels in an impact;
    by default the link's own mass. `drive` replaces the engine's options `spring` and `damping` for this avatar. `size_range` [m]
    is the range of its `span`: a human of 1.7 km was meant in millimetres. `moves`: it is no person but scenery that moves by
    itself, as `moving` makes it. Raises InvalidScene for links that are no tree, names that are no links, and other sizes.
    """

    name: str
    links: tuple[Link, ...]
    chains: tuple[str, ...] = ()
    ignore: tuple[tuple[str, str], ...] = ()
    coupled_mass: float | None = None
    size_range: tuple[float, float] = PLAUSIBLE_SIZE
    drive: Drive | None = None
    moves: bool = False
    at_rest: tuple[tuple[str, str, float], ...] = ()
    couplings: tuple[Coupling, ...] = ()

    def __post_init__(self) -> None:
        named("an avatar", self.name)
        each(f"links of avatar {self.name}", self.links, Link, "a Link")
        each(f"chains of avatar {self.name}", self.chains, str, "the name of a link")
        name_pairs(f"ignore of avatar {self.name}", self.ignore)
        object.__setattr__(self, "at_rest", depths(f"at_rest of avatar {self.name}", self.at_rest))
        if not self.links:
            raise InvalidScene(f"number of links of avatar {self.name}", 0, "at least 1")
        distinct(f"link of avatar {self.name}", (link.name for link in self.links))
        known: set[str] = set()
        for index, link in enumerate(self.links):
            if (link.parent is None) != (index == 0):
                raise InvalidScene(f"parent of link {link.name}", link.parent, "None for the first link and for no other")
            if link.parent is not None and link.parent not in known:
                raise InvalidScene(f"parent of link {link.name}", link.parent, f"an earlier link: {sorted(known)}")
            if isinstance(link.joint, Free) and index > 0:
                raise InvalidScene(f"joint of link {link.name}", "Free", "Rigid, Hinges, Slide or Ball below the root")
            known.add(link.name)
        for name in [*self.chains, *(name for both in (*self.ignore, *self.at_rest) for name in both[:2])]:
            if name not in known:
                raise InvalidScene(f"link named in chains, ignore or at_rest of {self.name}", name, f"one of {sorted(known)}")
        if self.coupled_mass is not None:
            positive(f"coupled mass of {self.name}", self.coupled_mass)
        instance(f"moves of {self.name}", self.moves, bool, "True or False")
        if self.drive is not None:
            instance(f"drive of {self.name}", self.drive, Drive, "Drive(stiffness, damping, largest_force) or None")
        self._check_couplings()
        least, most = pair(f"size_range of avatar {self.name}", self.size_range)
        low, high = (within(f"size_range of avatar {self.name} [m]", size, 0.0, math.inf) for size in (least, most))
        object.__setattr__(self, "size_range", (low, high))
        if any(link.pieces for link in self.links):
            within(f"span [m] of avatar {self.name} (lengths are metres; size_range widens this)", self.span, low, high)

    def _check_couplings(self) -> None:
        """Raise InvalidScene for couplings of angles that are not there, of followers that lead, and for limits of a follower
        that those of its leader let it leave."""
        each(f"couplings of avatar {self.name}", self.couplings, Coupling, "a Coupling(follower, leader, ratio, offset)")
        axes = [axis for link in self.links for axis in axes_of(link.joint)]
        followers = [one.follower for one in self.couplings]
        distinct(f"follower of avatar {self.name}", (str(number) for number in followers))
        for one in self.couplings:
            if one.follower >= len(axes):
                valid = f"an angle of the avatar: 0 to {len(axes) - 1}"
                raise InvalidScene(f"follower of a coupling of {self.name}", one.follower, valid)
            if one.leader in followers:
                raise InvalidScene(f"leader of a coupling of {self.name}", one.leader, "an angle that follows no other")
            leader, follower = axes[one.leader], axes[one.follower]
            low, high = sorted(one.ratio * limit + one.offset for limit in (leader.lower, leader.upper))
            slack = 1e-9 * max(1.0, abs(low), abs(high))
            if not (low >= follower.lower - slack and high <= follower.upper + slack):
                thing = f"angle {one.follower} of {self.name} at the limits of its leader [{unit_of(follower)}]"
                raise InvalidScene(thing, (low, high), f"within its own limits, {follower.lower:g} to {follower.upper:g}")

    def with_followers(self, angles: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return angles (..., n) of this avatar with those of followers as their leaders have them."""
        found = np.array(angles, dtype=np.float64)
        for one in self.couplings:
            found[..., one.follower] = one.ratio * found[..., one.leader] + one.offset
        return found

    @property
    def span(self) -> float:
        """Return twice the farthest distance [m] of a piece from the root's joint with limbs stretched and slides at zero."""
        way: dict[str, float] = {}
        farthest = 0.0
        for link in self.links:
            before = 0.0 if link.parent is None else way[link.parent] + float(np.linalg.norm(link.anchor))
            way[link.name] = before
            farthest = max(farthest, before + max((reach(piece) for piece in link.pieces), default=0.0))
        return 2.0 * farthest

    @property
    def link_names(self) -> tuple[str, ...]:
        """Return names of the links in a scene: `avatar/link`, of one link that of the avatar."""
        return (self.name,) if len(self.links) == 1 else tuple(f"{self.name}/{link.name}" for link in self.links)

    @cached_property
    def hinge_count(self) -> int:
        """Return the number of hinges and slides of all links together, which is that of the avatar's `TrackerSample.angles`."""
        return sum(len(axes_of(link.joint)) for link in self.links)


def rigid_avatar(name: str, pieces: tuple[Piece, ...], mass: Mass, material: str = "human") -> Avatar:
    """Return a driven body without joints, such as a rigid hand: one free link of this `name`, which carries all `pieces`.

    `mass` [kg] is m in eq. 6, the mass that a loose body feels. Raises InvalidScene for other values."""
    return Avatar(name, (Link(name, None, Free(), pieces, mass, material),))
