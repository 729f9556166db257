"""Poses of the bodies that are no links, taken over into the trial as a frame begins: they stand still while the avatars move."""

from avatarsim.ik.state import IkScratch
from avatarsim.jit.kernel import kernel
from avatarsim.jit.layout import Index
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.skeleton import Skeleton


@kernel
def notice_bodies(geo: Geometry, skel: Skeleton, poses: Poses, moving: Index, scratch_out: IkScratch) -> bool:
    """Take over the poses of bodies that may have moved, all of them where `moving` (nb) is empty; whether any had."""
    has_changed, is_known = False, moving.shape[0] > 0
    for b in range(skel.first):
        if not is_known or moving[b] == 1:
            has_changed = notice(geo, poses, b, scratch_out) or has_changed
    return has_changed


@kernel
def notice(geo: Geometry, poses: Poses, b: int, scratch_out: IkScratch) -> bool:
    """Take over the pose of one body; whether it was another one before."""
    trial, has_moved = scratch_out.trial, False
    for i in range(3):
        has_moved = has_moved or trial.position[b, i] != poses.position[b, i]
        for k in range(3):
            has_moved = has_moved or trial.rotation[b, i, k] != poses.rotation[b, i, k]
    if not has_moved:
        return False
    for i in range(3):
        trial.position[b, i] = poses.position[b, i]
        for k in range(3):
            trial.rotation[b, i, k] = poses.rotation[b, i, k]
    for i in range(6):
        trial.hulls[b, i] = poses.hulls[b, i]
        scratch_out.swept_links[b, i] = poses.hulls[b, i]
    for piece in range(geo.first_shape[b], geo.first_shape[b + 1]):
        for i in range(6):
            trial.boxes[piece, i] = poses.boxes[piece, i]
            scratch_out.swept[piece, i] = poses.boxes[piece, i]
        for v in range(geo.shapes.start[piece], geo.shapes.start[piece + 1]):
            for i in range(3):
                trial.vertices[v, i] = poses.vertices[v, i]
    return True
