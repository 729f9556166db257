"""The arrays of the planner, made once per scene."""

import numpy as np

from avatarsim.ik.make import empty_posture, indices, make_state, make_working, zeros
from avatarsim.ik.state import Avatars, IkState
from avatarsim.planner.state import NODES, NONE, SEARCH, Array, Ghost, Plan, Searches, packed_width
from avatarsim.spatial.random import MODULUS, seeded
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.skeleton import Posture, Skeleton


def make_planner(
    geo: Geometry, skel: Skeleton, avatars: Avatars, shown: IkState, posture: Posture, poses: Poses, gravity: Array, seed: int
) -> tuple[Plan, Ghost]:
    """A planner of avatars that stand at `posture`, in which they travel."""
    na, nl, nd = len(avatars.first_link) - 1, len(skel.kind), int(skel.first_dof[-1])
    searches = np.zeros(na, SEARCH).view(Searches)
    for a in range(na):
        # of the same seed each avatar draws its own
        searches["random"][a] = seeded((seed + 7919 * a) % MODULUS)[0]
    before, path = np.full((na, NODES), NONE, dtype=np.int64), indices(na, NODES)
    plan = Plan(searches, zeros(na, NODES + 1, packed_width(skel, avatars)), before, indices(na, NODES), path, indices(1))
    strength = float(np.linalg.norm(gravity))
    up = -gravity / strength if strength > 0.0 else zeros(3)
    ghost = Ghost(
        empty_posture(nl, nd), Poses(*(array.copy() for array in poses)),
        make_state(geo, skel, avatars, shown.tracking["reach"].copy(), zeros(nd, 3), posture),
        make_working(geo, skel, avatars, poses, 0), empty_posture(nl, nd), Posture(*(array.copy() for array in posture)), up,
    )
    return plan, ghost
