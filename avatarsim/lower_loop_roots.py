"""Where the roots of the avatars want to be: eq. 6 between tracker and driven body, solved exactly over one frame.

x in m x'' = -K x - R x' is the root's place relative to the tracker's, and so is x' its velocity: while the tracker moves
evenly the root does not trail behind. The orientation of the root has no spring in the paper; it is attracted like a joint.
"""

from avatarsim.impact.coupling import coupled
from avatarsim.kernel import kernel
from avatarsim.lower_loop_memory import PaperMemory
from avatarsim.settings import CouplingSettings
from avatarsim.spatial.vec3 import add, norm, put_row, row, scale, sub
from avatarsim.world.skeleton import FREE, Posture, Skeleton

UNDISTURBED = 1e-12
"""[m] a root that was shown this near to where eq. 6 wanted it keeps the velocity of eq. 6; else it has that of its shown way."""


@kernel
def couple_roots(
    skel: Skeleton, tracker: Posture, shown: Posture, dt: float, coupling: CouplingSettings, couple: int, memory_out: PaperMemory
) -> None:
    """Write target.root (eq. 6's place after ``dt`` seconds) and, for the time being, the root's velocity."""
    for link in range(skel.kind.shape[0]):
        if skel.kind[link] != FREE:
            continue
        there, before = row(tracker.root, link), row(memory_out.tracked, link)
        if couple == 0 or not (dt > 0.0):
            put_row(memory_out.target.root, link, there)
            continue
        tracker_velocity = scale(sub(there, before), 1.0 / dt)
        offset, velocity = sub(row(shown.root, link), before), sub(row(memory_out.velocity, link), tracker_velocity)
        moved, slowed = coupled(memory_out.mass[link], coupling.spring, coupling.damping, offset, velocity, dt)
        put_row(memory_out.target.root, link, add(there, moved))
        put_row(memory_out.velocity, link, add(slowed, tracker_velocity))


@kernel
def settle_roots(skel: Skeleton, tracker: Posture, shown: Posture, dt: float, memory_out: PaperMemory) -> None:
    """After the frame: a root that was pushed or walked back has the velocity of the way it was shown to go."""
    for link in range(skel.kind.shape[0]):
        if skel.kind[link] != FREE or not (dt > 0.0):
            continue
        now = row(shown.root, link)
        if not (norm(sub(now, row(memory_out.target.root, link))) <= UNDISTURBED):
            put_row(memory_out.velocity, link, scale(sub(now, row(memory_out.checked.root, link)), 1.0 / dt))
        there = row(tracker.root, link)
        # a tracker that is no number must not be remembered
        put_row(memory_out.tracked, link, there if norm(there) < 1e300 else now)
