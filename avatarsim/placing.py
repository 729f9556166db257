"""Avatars and fixed bodies put elsewhere between two frames, if they are free there."""

from collections.abc import Mapping

import numpy as np

from avatarsim.collision.scratch import make_scratch
from avatarsim.collision.signed_distance import signed_distance
from avatarsim.engine import Moved
from avatarsim.errors import AvatarsimError, InvalidInput, InvalidSample, StartOverlaps, UnknownName
from avatarsim.frame import Frames
from avatarsim.free_start import move_apart
from avatarsim.ik.constraints import touch
from avatarsim.lower_loop import IkLoop
from avatarsim.model.conversion import read_sample
from avatarsim.model.geometry import may_meet, place, rest_depth
from avatarsim.model.world import Array, World, sample_arrays
from avatarsim.pose_queries import require_free, require_within_limits
from avatarsim.scene.body import Role
from avatarsim.scene.checks import finite_array, require_near
from avatarsim.scene.moving import Pose, checked_pose
from avatarsim.scene.tracker import TrackerSample, checked
from avatarsim.spatial import rotation
from avatarsim.tolerances import NOTHING


def require_placing(frames: Frames) -> IkLoop:
    """Return the lower loop. Raises InvalidInput in scenes and for presets in which nothing can be put elsewhere."""
    if not frames.driven or not isinstance(frames.lower, IkLoop) or frames.effects.dynamics:
        valid = "one with avatars and without moving bodies, loaded with the preset default and with overlaps removed"
        raise InvalidInput("scene to put avatars in", frames.world.scene.name, valid)
    return frames.lower


def put_avatars(
    frames: Frames, sample: TrackerSample, user: TrackerSample, bodies: Mapping[str, Pose], is_exact: bool
) -> tuple[Moved, ...]:
    """Put the avatars at `sample`, their users at `user`, and fixed bodies at poses of theirs; return which avatars overlapped
    there and are at the nearest free posture instead, unless `is_exact`.

    Raises the errors of `AvatarsimEngine.put`; then nothing has changed.
    """
    world = frames.world
    for one in (sample, user):
        checked(one, world.scene.avatars)
    require_near("roots of the posture", sample_arrays(sample)[0], InvalidSample)
    lower, given = require_placing(frames), _given(frames, bodies)
    first = 0 if given else world.skeleton.first
    piece = int(world.geometry.first_shape[first])
    firsts = first, first, int(world.geometry.shapes.start[piece]), piece, first
    before = [array.copy() for array in world.posture], [a[k:].copy() for a, k in zip(world.poses, firsts, strict=True)]
    try:
        read_sample(*sample_arrays(sample), world.hinges, world.posture)
        lower.show()
        _move(frames, given)
        require_within_limits(world, NOTHING)
        if is_exact:
            require_free(world)
        moved = () if is_exact else move_apart(world)
    except AvatarsimError:
        for array, kept in zip(world.posture, before[0], strict=True):
            array[...] = kept
        for array, k, kept in zip(world.poses, firsts, before[1], strict=True):
            array[k:] = kept
        raise
    frames.target.read(user)
    lower.place_avatars(frames.target)
    if given:
        lower.look_at_all()
    frames.passed = ()
    return moved


def weigh_links(frames: Frames, factors: Array) -> None:
    """Weigh link origins in the objective; raises the errors of `AvatarsimEngine.weigh_links`."""
    links = len(frames.world.scene.links)
    found = finite_array("weights of links", factors, (links,), InvalidInput)
    if not (found > 0.0).all():
        raise InvalidInput("weights of links", float(found.min()), "numbers above 0")
    require_placing(frames).weigh_links(found)


def place_bodies(frames: Frames, bodies: Mapping[str, Pose]) -> None:
    """Put fixed bodies elsewhere. Raises the errors of `AvatarsimEngine.place`; then nothing has changed."""
    lower, given, poses = require_placing(frames), _given(frames, bodies), frames.world.poses
    before = {b: (poses.position[b].copy(), poses.rotation[b].copy()) for b in given}
    _move(frames, given)
    world = frames.world
    near = [pair for b in given for pair in _near_pieces(world, b, lower.settings.stand_off)]
    found = dict[tuple[str, str], float]()
    for a, b, gap in near:
        names = world.scene.names[world.geometry.body[b]], world.scene.names[world.geometry.body[a]]
        found[names] = max(found.get(names, 0.0), -gap)
    if max(found.values(), default=0.0) > NOTHING:
        _move(frames, before)
        raise StartOverlaps([(*names, depth) for names, depth in found.items() if depth > NOTHING])
    for a, b, _ in near:
        # pieces near an avatar at rest are kept away from in the next frame, as if it had been touched
        touch(a, b, lower.state.touching)
    lower.look_at_all()
    frames.passed = ()


def _near_pieces(world: World, b: int, within: float) -> list[tuple[int, int, float]]:
    """Return pieces of links, pieces of body b up to `within` [m] away, and their signed distances [m] above the allowed
    depth."""
    geo, boxes, scratch, found = world.geometry, world.poses.boxes, make_scratch(), []
    first = int(geo.first_shape[world.skeleton.first])
    links = boxes[first:]
    for own in range(geo.first_shape[b], geo.first_shape[b + 1]):
        meets = (links[:, :3] <= boxes[own, 3:] + within) & (boxes[own, :3] - within <= links[:, 3:])
        for piece in (first + np.flatnonzero(meets.all(axis=1))).tolist():
            if not may_meet(geo.wanted, int(geo.body[piece]), b):
                continue
            gap = signed_distance(world.poses.vertices, geo.shapes, piece, own, (0.0, 0.0, 0.0), scratch)[1]
            gap += float(rest_depth(geo.rest, int(geo.body[piece]), b))
            if gap < within:
                found.append((piece, own, gap))
    return found


def _given(frames: Frames, bodies: Mapping[str, Pose]) -> dict[int, tuple[Array, Array]]:
    """Return positions (3,) [m] and rotations (3, 3) of fixed bodies, by their numbers. Raises UnknownName, InvalidSample."""
    scene = frames.world.scene
    known = [body.name for body in scene.bodies if body.role is Role.FIXED]
    found = {}
    for name, pose in bodies.items():
        if name not in known:
            raise UnknownName("fixed body", str(name), known)
        position, orientation = checked_pose(f"fixed body {name}", pose)
        found[scene.names.index(name)] = np.array(position), rotation.to_matrix(orientation)
    return found


def _move(frames: Frames, given: Mapping[int, tuple[Array, Array]]) -> None:
    """Write the poses of bodies, and carry their pieces there."""
    world = frames.world
    for b, (position, turn) in given.items():
        world.poses.position[b], world.poses.rotation[b] = position, turn
        place(world.geometry, world.poses, b)
