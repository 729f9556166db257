"""Effects that a scene needs: derived once from its parts, narrowed by its author if they wish.

Parts of a scene that need an effect, the reason, and the promise given up without it: one table, and the search for the parts.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from typing import NamedTuple

import numpy as np

from avatarsim.errors import InvalidScene
from avatarsim.scene.avatar import Avatar
from avatarsim.scene.body import Body, ContactLaw, PairTable, Role
from avatarsim.scene.joint import Ball, Hinges, Slide, axes_of


@dataclass(frozen=True)
class Effects:
    """One switch per effect. `frame.py` and `batch.py` choose the loops of a frame by them. Within a loop they are read once,
    when a world is built: self-contact by `Scene`, restitution and friction by `model.dynamics`, limits and cones by
    `model.skeleton`, coupling and dynamics by the loops; and by `simulator.py` and `snapshot.py` where a body comes, goes or is
    put elsewhere."""

    overlap_removal: bool = True
    kinematics: bool = True
    self_contact: bool = True
    limits: bool = True
    reach_cones: bool = True
    coupling: bool = True
    dynamics: bool = True
    restitution: bool = True
    friction: bool = True
    gyroscopic: bool = True
    continuous: bool = True
    sleeping: bool = True

    def __post_init__(self) -> None:
        for switch in fields(self):
            value = getattr(self, switch.name)
            if not isinstance(value, bool):
                raise InvalidScene(f"effect {switch.name}", value, "True or False")

    def narrowed(self, *off: str) -> "Effects":
        """Return these effects without those named in `off`."""
        return self._switched(off, False)

    def widened(self, *on: str) -> "Effects":
        """Return these effects and those named in `on`."""
        return self._switched(on, True)

    def _switched(self, names: tuple[str, ...], on: bool) -> "Effects":
        known = [f.name for f in fields(self)]
        for name in names:
            if name not in known:
                raise InvalidScene("effect", name, "one of " + ", ".join(known))
        return replace(self, **dict.fromkeys(names, on))

    def missing_from(self, derived: "Effects") -> tuple[str, ...]:
        """Return names of effects that `derived` has and this one lacks: those that an author took away."""
        return tuple(f.name for f in fields(self) if getattr(derived, f.name) and not getattr(self, f.name))


ROUND = 1e-9
"""Spread of the principal moments of inertia, relative to the largest, up to which a body turns like a ball: its gyroscopic
effect is below rounding after a minute. Larger: a nearly round body would not precess; smaller: rounding would need it."""


class Parts(NamedTuple):
    """Parts of a scene that may need effects."""

    bodies: tuple[Body, ...]
    avatars: tuple[Avatar, ...]
    materials: PairTable


@dataclass(frozen=True)
class Call:
    """One row of the table.

    `part` needs the `effect`; `why` is its purpose; `lapses` the promise of the engine that no longer holds for a scene whose
    author leaves it out (empty: none, the scene just shows less); `found` names the parts that need it.
    """

    effect: str
    part: str
    why: str
    lapses: str
    found: Callable[[Parts], Sequence[str]]


def moving(parts: Parts) -> list[str]:
    """Return simulated bodies, and bodies that move by themselves."""
    loose = [body.name for body in parts.bodies if body.role is Role.SIMULATED]
    return loose + [avatar.name for avatar in parts.avatars if avatar.moves]


def driven(parts: Parts) -> list[str]:
    """Return avatars."""
    return [avatar.name for avatar in parts.avatars]


def jointed(parts: Parts) -> list[str]:
    """Return avatars with joints that move."""
    return [a.name for a in parts.avatars if any(isinstance(link.joint, Hinges | Slide | Ball) for link in a.links)]


def many_limbed(parts: Parts) -> list[str]:
    """Return avatars with two links at least that are not parent and child."""
    return [avatar.name for avatar in parts.avatars if len(avatar.links) > 2]


def limited(parts: Parts) -> list[str]:
    """Return links with an interval for a hinge, a slide, or swing and twist."""
    joints = [(f"{avatar.name}/{link.name}", link.joint) for avatar in parts.avatars for link in avatar.links]
    return [name for name, joint in joints if axes_of(joint) or (isinstance(joint, Ball) and joint.limits)]


def coned(parts: Parts) -> list[str]:
    """Return links with a spherical polygon."""
    joints = [(f"{avatar.name}/{link.name}", link.joint) for avatar in parts.avatars for link in avatar.links]
    return [name for name, joint in joints if isinstance(joint, Ball) and joint.cone]


def both(parts: Parts) -> list[str]:
    """Return avatars, if there are simulated or moving bodies that they can meet."""
    return driven(parts) if moving(parts) else []


def met(parts: Parts) -> dict[str, ContactLaw]:
    """Return the contacts that a simulated body can make, by `material on material`."""
    free = [body.material for body in parts.bodies if body.role is Role.SIMULATED]
    held = [body.material for body in parts.bodies if body.role is not Role.SIMULATED]
    held += [link.material for avatar in parts.avatars for link in avatar.links]
    pairs = {tuple(sorted((a, b))) for a in set(free) for b in set(held)}
    pairs |= {tuple(sorted((a, b))) for k, a in enumerate(free) for b in set(free[k + 1 :])}
    return {f"{a} on {b}": parts.materials.pairs[a, b] for a, b in sorted(pairs) if (a, b) in parts.materials.pairs}


def bouncing(parts: Parts) -> list[str]:
    """Return pairs of materials that bounce."""
    return [f"{pair} {contact.restitution:g}" for pair, contact in met(parts).items() if contact.restitution > 0.0]


def rubbing(parts: Parts) -> list[str]:
    """Return pairs of materials with friction: of surfaces that simulated bodies meet, and of links and fixed bodies."""
    fixed = {body.material for body in parts.bodies if body.role is Role.FIXED}
    links = {link.material for avatar in parts.avatars for link in avatar.links}
    pairs = {(a, b) for a in links for b in fixed if (a, b) in parts.materials.pairs}
    pressed = {"{} on {}".format(*sorted(pair)): parts.materials.pairs[pair] for pair in sorted(pairs)}
    return [f"{pair} {contact.friction:g}" for pair, contact in (met(parts) | pressed).items() if contact.friction > 0.0]


def tumbling(parts: Parts) -> list[str]:
    """Return simulated bodies whose principal moments of inertia differ."""
    return [
        body.name for body in parts.bodies
        if body.role is Role.SIMULATED and body.mass is not None
        and np.ptp(np.linalg.eigvalsh(body.mass.inertia)) > ROUND * body.mass.inertia.max()
    ]


NO_OVERLAP, STAYS, BOUNCES, FAST = "1 (no overlap)", "2 (stays with the user)", "3 (bounces as stated)", "4 (speed)"
"""The engine's promises, as docs/concepts.md numbers them."""

CALLS = (
    Call("overlap_removal", "an avatar", "a tracked posture goes into things; the one shown must not", NO_OVERLAP, driven),
    Call("kinematics", "an avatar's hinge or ball joint", "links of a chain give way by turning in their joints", STAYS, jointed),
    Call("self_contact", "an avatar of three links or more", "limbs must not go through each other",
         NO_OVERLAP, many_limbed),
    Call("limits", "a limited hinge, slide or ball joint", "a posture must stay within what the joint allows", STAYS, limited),
    Call("reach_cones", "a ball joint with a reach cone", "a limb must stay in its spherical polygon", STAYS, coned),
    Call("coupling", "an avatar together with a simulated or moving body", "what a limb gives a body, it takes: eq. 6 brings it "
         "back", BOUNCES, both),
    Call("dynamics", "a simulated or moving body", "it falls, is pushed and pushes", BOUNCES, moving),
    Call("restitution", "a pair of materials, one of them a simulated body's, with restitution above 0",
         "bodies bounce, eq. 8", BOUNCES, bouncing),
    Call("friction", "a pair of materials with friction above 0, one of them a simulated body's or a link's",
         "bodies stick and roll, eq. 10; hands and feet stick to fixed bodies", BOUNCES, rubbing),
    Call("gyroscopic", "a simulated body with unequal moments of inertia", "its axis of rotation moves though nothing pushes it",
         BOUNCES, tumbling),
    Call("continuous", "a simulated or moving body", "impacts happen when surfaces meet, and thin things are not jumped",
         NO_OVERLAP, moving),
    Call("sleeping", "a simulated or moving body", "a body at rest costs near nothing", FAST, moving),
)
"""The table. A scene has an effect if a part of it needs it; the parts are found in the rows' order."""

KEPT = ("kinematics",)
"""Effects that no author can leave out."""
