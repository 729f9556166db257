"""Carry-over of state from one world into another that shares bodies and avatars by name: how bodies come and go between frames.

The new world is built as at a load, by the same checks. Of what both have, the new one takes poses and velocities to the bit, of
avatars also what their users asked for last and the offsets that collisions have left (eq. 6). What is found anew within a frame
or two is not carried: sleep, warm starts of the solvers, and the search for a path.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.frame import Frames
from avatarsim.loops.ik_loop import IkLoop
from avatarsim.loops.paper import PaperLoop
from avatarsim.scene.avatar import Avatar
from avatarsim.scene.body import Role
from avatarsim.scene.joint import Hinges
from avatarsim.scene.scene import Scene
from avatarsim.world.geometry import place
from avatarsim.world.skeleton import Posture
from avatarsim.world.world import World

Rows = NDArray[np.int64]


class Shared(NamedTuple):
    """Places in the old world and in the new one of what both have, (n, 2) each: simulated bodies, avatars, links, degrees."""

    bodies: Rows
    avatars: Rows
    links: Rows
    degrees: Rows


def shared(old: World, new: World) -> Shared:
    """What two worlds share: simulated bodies of one name; avatars of one name whose links and joints are alike."""
    found = {body.name: b for b, body in enumerate(old.scene.bodies) if body.role is Role.SIMULATED}
    bodies = [
        (found[body.name], b) for b, body in enumerate(new.scene.bodies) if body.role is Role.SIMULATED and body.name in found
    ]
    known = {avatar.name: (a, avatar, link) for a, (avatar, link) in enumerate(first_links(old.scene))}
    avatars: list[tuple[int, int]] = []
    links: list[tuple[int, int]] = []
    degrees: list[tuple[int, int]] = []
    for a, (avatar, link) in enumerate(first_links(new.scene)):
        before = known.get(avatar.name)
        if before is None or tree_of(before[1]) != tree_of(avatar):
            continue
        avatars.append((before[0], a))
        count, one, other = len(avatar.links), old.skeleton.first_dof[before[2] :], new.skeleton.first_dof[link:]
        links += [(before[2] + k, link + k) for k in range(count)]
        degrees += [(int(one[0]) + k, int(other[0]) + k) for k in range(int(other[count] - other[0]))]
    return Shared(*(np.array(rows, dtype=np.int64).reshape(-1, 2) for rows in (bodies, avatars, links, degrees)))


def first_links(scene: Scene) -> list[tuple[Avatar, int]]:
    """Each avatar and the place of its first link among all."""
    firsts = np.cumsum([0, *(len(avatar.links) for avatar in scene.avatars)]).tolist()
    return list(zip(scene.avatars, firsts[:-1], strict=True))


def tree_of(avatar: Avatar) -> list[tuple[object, ...]]:
    """What a posture of an avatar depends on, limits aside: names and parents of links, and what their joints turn about."""
    return [
        (link.name, link.parent, type(link.joint), link.anchor, link.orientation,
         tuple(hinge.axis for hinge in link.joint.hinges) if isinstance(link.joint, Hinges) else ())
        for link in avatar.links
    ]


def taken(into: NDArray[np.generic], of: NDArray[np.generic], rows: Rows) -> None:
    """Rows of one array into rows of another."""
    into[rows[:, 1]] = of[rows[:, 0]]


def take_posture(into: Posture, of: Posture, both: Shared) -> None:
    """The posture of what both worlds have."""
    taken(into.root, of.root, both.links)
    taken(into.turn, of.turn, both.links)
    taken(into.angle, of.angle, both.degrees)


def carry_poses(old: World, new: World, both: Shared) -> None:
    """Poses and velocities of bodies, and postures of avatars: before the loops of the new world are made, and once more after
    that, since to make them places the links by their postures, which rounds."""
    links = both.links + (old.skeleton.first, new.skeleton.first)
    take_posture(new.posture, old.posture, both)
    for rows in (both.bodies, links):
        taken(new.poses.position, old.poses.position, rows)
        taken(new.poses.rotation, old.poses.rotation, rows)
        if new.scene.effects.dynamics:
            taken(new.velocities.linear, old.velocities.linear, rows)
            taken(new.velocities.angular, old.velocities.angular, rows)
    for a, b in both.bodies.tolist():
        if (old.centres[a] != new.centres[b]).any():
            # another centre of mass in the same body: the body's frame is what stays
            arm = new.poses.rotation[b] @ (new.centres[b] - old.centres[a])
            new.poses.position[b] += arm
            new.velocities.linear[b] += np.cross(new.velocities.angular[b], arm)
    for b in (*both.bodies[:, 1].tolist(), *links[:, 1].tolist()):
        place(new.geometry, new.poses, b)


def carry_loops(old: Frames, new: Frames, both: Shared) -> None:
    """Time, and of the avatars what their users asked for last and what the coupling has stored; after the loops are made."""
    carry_poses(old.world, new.world, both)
    new.time = old.time
    if new.driven:
        new.lower.go_on(False)
    if not (old.driven and new.driven):
        return
    take_posture(new.target.posture, old.target.posture, both)
    one, other = old.lower, new.lower
    if isinstance(one, PaperLoop) and isinstance(other, PaperLoop):
        taken(other.memory.tracked, one.memory.tracked, both.links)
        taken(other.memory.velocity, one.memory.velocity, both.links)
    if isinstance(one, IkLoop) and isinstance(other, IkLoop):
        take_posture(other.state.before, one.state.before, both)
        take_posture(other.state.own, one.state.own, both)
        taken(other.state.tracking.speed, one.state.tracking.speed, both.avatars)
        carry_springs(old, new, one, other, both)


def carry_springs(old: Frames, new: Frames, one: IkLoop, other: IkLoop, both: Shared) -> None:
    """Offsets of the coupling, and where the tracker had the links in the last frame: their velocities are counted from there."""
    if not (len(one.springs.mass) and len(other.springs.mass)):
        # a scene in which nothing can be struck has no springs
        return
    for name in ("offset", "rate", "pressed"):
        taken(getattr(other.springs, name), getattr(one.springs, name), both.links)
    links = both.links + (old.world.skeleton.first, new.world.skeleton.first)
    other.springs.turn[:] = one.springs.turn
    for into, of in ((other.springs.one, one.springs.one), (other.springs.other, one.springs.other)):
        taken(into.position, of.position, links)
        taken(into.rotation, of.rotation, links)
