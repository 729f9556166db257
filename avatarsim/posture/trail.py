"""The trail of a frame: what every certified step in it moved, and where it left the links, if the frame is recorded."""

from avatarsim.kernel import kernel
from avatarsim.posture.goal import largest_part
from avatarsim.posture.motion_budget import note_gone
from avatarsim.posture.workspace import ADOPTED, Memory
from avatarsim.world.skeleton import Skeleton


@kernel
def note_step(skel: Skeleton, memory_out: Memory) -> None:
    """After the step in rows.x was adopted, whose poses are the trial: count it, unless it moves nothing, and keep the poses."""
    if largest_part(memory_out.rows.x) == 0.0:
        return
    note_gone(skel, memory_out.rows.x, memory_out.goal)
    k = memory_out.counts[ADOPTED]
    memory_out.counts[ADOPTED] = k + 1
    if k >= memory_out.trail.shape[0]:
        return
    trial = memory_out.trial
    for link in range(skel.kind.shape[0]):
        for i in range(3):
            memory_out.trail[k, link, i] = trial.position[skel.first + link, i]
            for j in range(3):
                memory_out.trail[k, link, 3 + 3 * i + j] = trial.rotation[skel.first + link, i, j]
