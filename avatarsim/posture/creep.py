"""At a tracker that has rested for a while the avatar only creeps: who holds still is shown no limb that wanders.

Limbs that a tracker at rest presses into things slide to ever better places, and while a way out is searched the avatar follows
the tracker as far as it gets. Neither ends by itself in a given time. A way that was found is gone at full speed.
"""

from math import sqrt

from avatarsim.kernel import kernel
from avatarsim.posture.kinematics import forward
from avatarsim.posture.workspace import FORWARDS, LED, RESTED, UNDER_WAY, Memory
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.skeleton import Posture, Skeleton

CREEP_AFTER = 100
"""Frames of rest after which the avatar creeps. More: limbs wander for longer than two seconds; fewer: what a late change of the
contacts asks for takes visibly long."""

CREEP = 9e-4
"""Way [m] that no link's origin and no side of the box around a link exceeds in a frame then."""

ROUNDS = 3
"""Times a step is shortened: a large turn goes less far than its arc, so a share of it goes farther than its share."""


@kernel
def creeps(memory: Memory) -> bool:
    """Whether tracker and surroundings have rested long enough, and nobody goes along a way that was found."""
    return bool(memory.flags[RESTED] >= CREEP_AFTER and memory.flags[LED] != UNDER_WAY)


@kernel
def farthest_moved(skel: Skeleton, poses: Poses, memory: Memory) -> float:
    """How far [m] the trial takes the origin of a link, or a side of the box around it, from the checked state."""
    trial, most = memory.trial, 0.0
    for b in range(skel.first, trial.position.shape[0]):
        square = 0.0
        for i in range(3):
            d = trial.position[b, i] - poses.position[b, i]
            square += d * d
        most = max(most, sqrt(square))
        for i in range(6):
            most = max(most, abs(trial.hulls[b, i] - poses.hulls[b, i]))
    return most


@kernel
def slow_down(geo: Geometry, skel: Skeleton, posture: Posture, poses: Poses, memory_out: Memory) -> None:
    """Shorten the step in rows.x, whose trial is at hand, if it goes farther than CREEP; conditions that 0 fulfils hold on."""
    for _ in range(ROUNDS):
        most = farthest_moved(skel, poses, memory_out)
        if not (most > CREEP):
            return
        for j in range(memory_out.rows.x.shape[0]):
            memory_out.rows.x[j] *= CREEP / most
        memory_out.counts[FORWARDS] += 1
        forward(geo, skel, posture, memory_out.rows.x, memory_out.trial, memory_out.trial_axes)
