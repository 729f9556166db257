"""Memory of the search for a way out: a second avatar that nobody sees, and the tree of the postures that it reached."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.kernel import kernel
from avatarsim.posture.chain import seeded
from avatarsim.posture.workspace import Memory, make_memory
from avatarsim.spatial.tangent import columns, put_columns
from avatarsim.spatial.vec3 import put_row, row
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.skeleton import Posture, Skeleton

Array = NDArray[np.float64]
Index = NDArray[np.int64]

NODES = 1200
"""Postures that the tree holds; a walk of the unseen avatar takes 20 to 100. When it is full, the tree begins anew."""

LEAVES = 64
"""Ends of walks that the search may go on from; what ends later is not kept."""

FIRST_REST = 15
"""Frames that the search rests after its walks were in vain, doubled each time."""

# places in Way.state
(
    MODE, NODES_USED, LEAVES_USED, NODE, PHASE, WALKED, TRIES, LAST, AT, REFUSED, RESTED, REST, BLOCKING, BLOCKED, CUTS, CUT_FROM,
    CUT_TO, OPEN, TURN,
) = range(19)

# values of MODE
IDLE, SEARCHING, LEADING, RESTING = range(4)


class Way(NamedTuple):
    """memory, posture, poses of the unseen avatar; waypoint, goal Posture: where it walks to, and the tracker's, within limits.

    node_root (N, nl, 3), node_turn (N, nl, 3, 3), node_angle (N, nd): the tree's postures; before (N) which node each was reached
    from, -1 at the root; leaves (L) ends of walks, leaf_merit (L) their distance from the tracker's posture, see `goal.merit`;
    path (N) nodes from the shown posture to the tracker's, spare (N); best (2) least merit of this walk, and how far the trunk of
    the tree's root is from the tracker's [m]; random (1); state (19)
    """

    memory: Memory
    posture: Posture
    poses: Poses
    waypoint: Posture
    goal: Posture
    node_root: Array
    node_turn: Array
    node_angle: Array
    before: Index
    leaves: Index
    leaf_merit: Array
    path: Index
    spare: Index
    best: Array
    random: Index
    state: Index


def make_way(geo: Geometry, skel: Skeleton, posture: Posture, poses: Poses, shown: Memory, seed: int) -> Way:
    """Fresh memory; `shown` is that of the avatar that is seen, whose metric the unseen one shares."""
    nl, nd = len(skel.kind), int(skel.first_dof[-1])
    memory = make_memory(geo, skel, poses)
    memory.goal.inverse_weight[:] = shown.goal.inverse_weight
    memory.goal.closeness.turn_weight[:] = shown.goal.closeness.turn_weight
    memory.goal.closeness.far[:] = shown.goal.closeness.far
    here, waypoint, goal = (Posture(*(array.copy() for array in posture)) for _ in range(3))
    before, path, spare = (np.zeros(NODES, dtype=np.int64) for _ in range(3))
    state = np.zeros(19, dtype=np.int64)
    state[REST] = FIRST_REST
    return Way(
        memory, here, Poses(*(array.copy() for array in poses)), waypoint, goal,
        np.zeros((NODES, nl, 3)), np.zeros((NODES, nl, 3, 3)), np.zeros((NODES, nd)), before,
        np.zeros(LEAVES, dtype=np.int64), np.zeros(LEAVES), path, spare, np.zeros(2), seeded(seed), state,
    )


@kernel
def copy_posture(posture: Posture, posture_out: Posture) -> None:
    """The same posture."""
    for link in range(posture.root.shape[0]):
        put_row(posture_out.root, link, row(posture.root, link))
        put_columns(posture_out.turn, link, columns(posture.turn, link))
    for j in range(posture.angle.shape[0]):
        posture_out.angle[j] = posture.angle[j]


@kernel
def copy_poses(poses: Poses, poses_out: Poses) -> None:
    """The same poses of all bodies."""
    for b in range(poses.position.shape[0]):
        put_row(poses_out.position, b, row(poses.position, b))
        put_columns(poses_out.rotation, b, columns(poses.rotation, b))
        for i in range(6):
            poses_out.hulls[b, i] = poses.hulls[b, i]
    for s in range(poses.boxes.shape[0]):
        for i in range(6):
            poses_out.boxes[s, i] = poses.boxes[s, i]
    for v in range(poses.vertices.shape[0]):
        put_row(poses_out.vertices, v, row(poses.vertices, v))


@kernel
def add_node(posture: Posture, before: int, way_out: Way) -> None:
    """Make `posture` the next node, reached from node `before` (-1: the root), and the present one."""
    k = way_out.state[NODES_USED]
    for link in range(posture.root.shape[0]):
        for i in range(3):
            way_out.node_root[k, link, i] = posture.root[link, i]
            for j in range(3):
                way_out.node_turn[k, link, i, j] = posture.turn[link, i, j]
    for j in range(posture.angle.shape[0]):
        way_out.node_angle[k, j] = posture.angle[j]
    way_out.before[k] = before
    way_out.state[NODE], way_out.state[NODES_USED] = k, k + 1


@kernel
def get_node(way: Way, k: int, posture_out: Posture) -> None:
    """The posture of node k."""
    for link in range(posture_out.root.shape[0]):
        for i in range(3):
            posture_out.root[link, i] = way.node_root[k, link, i]
            for j in range(3):
                posture_out.turn[link, i, j] = way.node_turn[k, link, i, j]
    for j in range(posture_out.angle.shape[0]):
        posture_out.angle[j] = way.node_angle[k, j]


@kernel
def add_leaf(merit: float, way_out: Way) -> None:
    """Remember the present node as one to go on from."""
    k = way_out.state[LEAVES_USED]
    if k < way_out.leaves.shape[0]:
        way_out.leaves[k], way_out.leaf_merit[k] = way_out.state[NODE], merit
        way_out.state[LEAVES_USED] = k + 1
