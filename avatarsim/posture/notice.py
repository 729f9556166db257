"""Where does everybody stand who is no link, and where do the links begin, as a frame begins?"""

from avatarsim.kernel import kernel
from avatarsim.posture.workspace import NOW, Memory
from avatarsim.spatial.vec3 import put_row, row
from avatarsim.world.arena import Index
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.skeleton import Skeleton


@kernel
def notice(geo: Geometry, poses: Poses, b: int, memory_out: Memory) -> bool:
    """Copy the pose of a body that is no link into the trial; returns whether it was another one before."""
    trial, moved = memory_out.trial, False
    for i in range(3):
        moved = moved or trial.position[b, i] != poses.position[b, i]
        for k in range(3):
            moved = moved or trial.rotation[b, i, k] != poses.rotation[b, i, k]
    if not moved:
        return False
    for i in range(3):
        trial.position[b, i] = poses.position[b, i]
        for k in range(3):
            trial.rotation[b, i, k] = poses.rotation[b, i, k]
    for i in range(6):
        trial.hulls[b, i] = poses.hulls[b, i]
        memory_out.swept_hulls[b, i] = poses.hulls[b, i]
    for s in range(geo.first_shape[b], geo.first_shape[b + 1]):
        for i in range(6):
            trial.boxes[s, i] = poses.boxes[s, i]
            memory_out.swept[s, i] = poses.boxes[s, i]
        for v in range(geo.shapes.start[s], geo.shapes.start[s + 1]):
            for i in range(3):
                trial.vertices[v, i] = poses.vertices[v, i]
    return True


@kernel
def notice_others(geo: Geometry, skel: Skeleton, poses: Poses, memory_out: Memory) -> bool:
    """Copy the poses of all bodies that are not links into the trial, which stand still meanwhile; whether any had moved."""
    changed = False
    for b in range(skel.first):
        changed = notice(geo, poses, b, memory_out) or changed
    look_again(skel, poses, changed, memory_out)
    return changed


@kernel
def notice_movers(geo: Geometry, skel: Skeleton, poses: Poses, moving: Index, memory_out: Memory) -> bool:
    """The same of those only that may have moved (nb): to look at thousands of objects at rest would take most of the frame."""
    changed = False
    for b in range(skel.first):
        if moving[b] == 1:
            changed = notice(geo, poses, b, memory_out) or changed
    look_again(skel, poses, changed, memory_out)
    return changed


@kernel
def look_again(skel: Skeleton, poses: Poses, changed: bool, memory_out: Memory) -> None:
    """A frame begins: directions remembered are a frame old, and if somebody moved the list of who is near is made anew."""
    here = memory_out.goal.closeness.here
    for link in range(here.shape[0]):
        put_row(here, link, row(poses.position, skel.first + link))
    memory_out.pairs.marks[NOW] += 1
    if changed:
        # an empty reach makes the list anew
        memory_out.reach[:] = 0.0
