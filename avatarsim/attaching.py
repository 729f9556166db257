"""Attaching bodies to links between frames: at their present places, and those that an avatar grips."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from avatarsim.coupling.coupled_bodies import link_together
from avatarsim.errors import InvalidInput, InvalidSnapshot, UnknownName, UnsupportedScene
from avatarsim.frame import Frames
from avatarsim.lower_loop import IkLoop
from avatarsim.model.world import World
from avatarsim.pose_queries import Contact
from avatarsim.scene.body import Role
from avatarsim.scene.scene import Scene

Array = NDArray[np.float64]


def attach(frames: Frames, body: str, link: str) -> None:
    """Attach a simulated body to a link, where they are now. Raises UnknownName and InvalidInput as `AvatarsimEngine.attach`."""
    scene, drive, poses = frames.world.scene, frames.world.drive, frames.world.poses
    require_attaching(frames, "scene to attach a body in")
    for name, role, kind in ((body, Role.SIMULATED, "simulated body"), (link, Role.DRIVEN, "link")):
        known = [one for one, its in zip(scene.names, scene.roles, strict=True) if its is role]
        if name not in known:
            raise UnknownName(kind, name, known)
    b, k = scene.names.index(body), scene.names.index(link)
    if drive.carrier[b] >= 0:
        raise InvalidInput(f"body to attach to {link}", body, f"one that {scene.names[drive.carrier[b]]} does not hold already")
    turn = poses.rotation[k]
    drive.carrier[b], drive.tied[b] = k, drive.tied[k]
    drive.attached_place[b] = turn.T @ (poses.position[b] - poses.position[k])
    drive.attached_turn[b] = turn.T @ poses.rotation[b]
    link_together(drive, frames.world.skeleton)
    frames.upper.memory.asleep[b] = 0


def require_attaching(frames: Frames, thing: str) -> None:
    """Raise UnsupportedScene where bodies cannot be attached."""
    able = isinstance(frames.lower if frames.driven else None, IkLoop) and frames.effects.coupling and frames.effects.dynamics
    if not able:
        valid = "one with avatars, simulated bodies, coupling and dynamics, loaded with the preset default"
        raise UnsupportedScene(thing, frames.world.scene.name, valid)


def attach_at_start(frames: Frames, old: World | None) -> None:
    """Attach the pairs of the scene; of a scene that was changed those that the ``old`` one did not have.

    Raises UnsupportedScene if the scene does not support attached bodies, its own or earlier ones, and InvalidInput as `attach`.
    """
    known = () if old is None else old.scene.attached
    names = frames.world.scene.names
    if old is not None and any(body in names and link in names for body, link in attached(old).items()):
        require_attaching(frames, "scene to change to while bodies are attached")
    carrier_of = attached(frames.world)
    for body, link in frames.world.scene.attached:
        if (body, link) not in known and carrier_of.get(body) != link:
            attach(frames, body, link)


def require_sound(world: World) -> None:
    """Raise InvalidSnapshot for attached bodies that are not simulated, or that are attached to no link."""
    roles = world.scene.roles
    for b, k in enumerate(world.drive.carrier.tolist()):
        sound = k < 0 or (roles[b] is Role.SIMULATED and roles[k] is Role.DRIVEN)
        leader = int(world.drive.tied[k]) if k >= 0 else b
        if not sound or (roles[b] is not Role.DRIVEN and int(world.drive.tied[b]) != leader):
            raise InvalidSnapshot(f"link that {world.scene.names[b]} is attached to", k, "the number of a link, -1 for none")


def release(world: World, body: str) -> None:
    """Release a body. Raises UnknownName if it is not attached."""
    carrier_of = attached(world)
    if not isinstance(body, str) or body not in carrier_of:
        raise UnknownName("attached body", str(body), carrier_of)
    b = world.scene.names.index(body)
    world.drive.carrier[b], world.drive.tied[b] = -1, b
    link_together(world.drive, world.skeleton)


def attached(world: World) -> Mapping[str, str]:
    """Return names of attached bodies and of the links that they are attached to."""
    names = world.scene.names
    return {names[b]: names[link] for b, link in enumerate(world.drive.carrier.tolist()) if link >= 0}


def gripped(contacts: Sequence[Contact], scene: Scene, avatar: str) -> Mapping[str, str]:
    """Return the simulated bodies that an avatar grips, and the link that touches each first; UnknownName for no avatar.

    An antipodal grip (Nguyen, Constructing Force-Closure Grasps, 1988): the line between two contacts is within both friction
    cones.
    """
    if avatar not in (known := [one.name for one in scene.avatars]):
        raise UnknownName("avatar", avatar, known)
    first, own = len(scene.bodies), set[str]()
    for one in scene.avatars:
        if one.name == avatar:
            own = set(scene.names[first : first + len(one.links)])
        first += len(one.links)
    loose = {name for name, role in zip(scene.names, scene.roles, strict=True) if role is Role.SIMULATED}
    material = dict(zip(scene.names, scene.material_names, strict=True))
    touched = dict[str, list[tuple[str, Array, Array, float]]]()
    for contact in contacts:
        for body, link, normal in ((contact.a, contact.b, contact.normal), (contact.b, contact.a, -contact.normal)):
            if body in loose and link in own:
                friction = scene.materials.contact(material[body], material[link]).friction
                touched.setdefault(body, []).append((link, contact.point, normal, friction))
    return {
        body: points[0][0] for body, points in touched.items()
        if any(is_antipodal(one[1:], other[1:]) for one in points for other in points)
    }


def is_antipodal(one: tuple[Array, Array, float], other: tuple[Array, Array, float]) -> bool:
    """Return whether two contacts (point [m], normal into the body, friction) can hold a body between them."""
    offset = other[0] - one[0]
    far = float(np.linalg.norm(offset))
    if far == 0.0:
        return False
    return all(
        float(np.linalg.norm(np.cross(normal, offset))) <= friction * sign * float(normal @ offset)
        for (_, normal, friction), sign in ((one, 1.0), (other, -1.0))
    )
