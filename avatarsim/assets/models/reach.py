"""Inverse kinematics of an avatar for goals of its links, from several postures.

No obstacles are known here: the Shield and the engine keep the avatar out of them. A free root does not move.
"""

from collections.abc import Mapping
from math import inf

import numpy as np
from numpy.typing import NDArray

from avatarsim.ik.bare_avatars import BareAvatars
from avatarsim.ik.goals import approach, make_goal_scratch, make_goals, mobility
from avatarsim.model.skeleton import Posture, carry
from avatarsim.scene.avatar import Avatar
from avatarsim.scene.tracker import TrackerSample

Array = NDArray[np.float64]
Index = NDArray[np.int64]

CALLS, ROUNDS = 60, 6
"""Calls of the solver at most, and rounds of each, after which joints at limits may move freely again. Fewer: goals out of reach
end farther from the nearest posture."""

REACHED = 1e-9
"""[m] Distance from its goal within which a link has reached it."""

LEVER = 0.3
"""[m] Length equivalent of a turn of a radian. More: slower near goals; less: slower towards goals that are out of reach."""

STARTS = 12
"""Most start postures, the given one first; then limbs that miss their goals begin anywhere: a joint may be stopped by its
limit on the way to a goal that is in reach from elsewhere. Fewer: such goals are missed; more: those out of reach take
longer."""

DAMPING = 1e-9
"""Least damping, as a share of the squared lever. More: goals of a nearly stretched limb are missed by micrometres; less: the
rounding of a singular system enters the posture."""

LONGEST = 0.5
"""[rad, levers] Longest step of any joint in a call. More: the arm comes out folded another way; less: more calls."""


class Limb:
    """The links of an avatar, alone in the world."""

    def __init__(self, avatar: Avatar, goals: Mapping[int, Array]) -> None:
        """Create a limb with `goals`: places (3,) [m] by the numbers of links."""
        self._alone = BareAvatars((avatar,))
        self._skel = self._alone.skeleton
        self._joint_of = np.repeat(np.arange(len(avatar.links)), np.diff(self._skel.first_dof))
        self._goals, self._scratch = make_goals(len(goals)), make_goal_scratch(self._skel, len(goals))
        for k, (link, place) in enumerate(goals.items()):
            self._goals.link[k], self._goals.place[k], self._goals.has_place[k] = link, place, True
        self._mobility = mobility(self._skel, range(len(avatar.links)), LEVER)
        single = np.isin(np.arange(len(self._joint_of)), self._alone.hinges)
        self._low, self._high = np.where(single, self._skel.limits.T, [[-inf], [inf]])

    def reach(self, start: TrackerSample) -> TrackerSample:
        """Return the posture near `start` with the links as near to their goals as is found."""
        best, missing = self._followed(self._alone.clipped(self._alone.read(start)))
        rng = np.random.default_rng(0)
        for _ in range(STARTS - 1):
            left = self._goals.link[np.abs(missing).max(axis=1) > REACHED]
            if not left.size:
                break
            found, way = self._followed(self._started_again(best, left, rng))
            if float((way * way).sum()) < float((missing * missing).sum()):
                best, missing = found, way
        return self._alone.sample(best, start.time)

    def _started_again(self, posture: Posture, links: Index, rng: np.random.Generator) -> Posture:
        """Return the posture with the hinges that carry these links anywhere within limits, at most half a turn away."""
        found = Posture(*(one.copy() for one in posture))
        carrying = np.asarray(self._skel.related[links].any(axis=0))[self._joint_of]
        low, high = np.maximum(self._low, posture.angle - np.pi), np.minimum(self._high, posture.angle + np.pi)
        found.angle[carrying] = rng.uniform(low, high)[carrying]
        return found

    def _followed(self, posture: Posture) -> tuple[Posture, Array]:
        """Return the posture found from one, and the remaining vectors (n, 3) to the goals [m]."""
        found, s = Posture(*(one.copy() for one in posture)), self._scratch
        for _ in range(CALLS):
            s.mobility[:] = self._mobility
            approach(self._skel, self._goals, LEVER, REACHED, ROUNDS, LONGEST, DAMPING, found, s)
            missing = self._missing(found)
            if not np.abs(missing).max(initial=0.0) > REACHED:
                break
        return found, missing

    def _missing(self, posture: Posture) -> Array:
        """Return the vectors (n, 3) from the links to their goals [m]."""
        carry(self._skel, posture, self._scratch.still, self._scratch.poses, self._scratch.axes)
        return np.asarray(self._goals.place - self._scratch.poses.position[self._goals.link])
