"""Distance of a posture from the user's, in the two figures of the table: link origins and joint angles."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.spatial import rotation
from tests.nearest_free.tree import Placed, Tree, skew

Array = NDArray[np.float64]

NO_TURN = 1e-6
"""Angle [rad] below which a rotation vector's rate is the angular velocity itself."""


def rates_of_log(vector: Array) -> Array:
    """(3, 3) matrix that takes an angular velocity about the turned frame's axes to the rate of the rotation vector (3,)."""
    angle, k = float(np.linalg.norm(vector)), skew(vector)
    if angle < NO_TURN:
        return np.asarray(np.eye(3) + 0.5 * k)
    bend = (1.0 - 0.5 * angle / np.tan(0.5 * angle)) / angle**2
    return np.asarray(np.eye(3) + 0.5 * k + bend * (k @ k))


class Closeness:
    """Distance to a goal: root mean square of link origins [m] and of joint angles [rad], as `tracker_offset_rms` and
    `tracker_angle_rms` of one frame. `arm` [m] is the weight of a radian relative to a metre."""

    def __init__(self, tree: Tree, goal: Placed, arm: float) -> None:
        self.tree, self.goal, self.arm = tree, goal, arm

    def vectors(self, placed: Placed) -> tuple[Array, Array]:
        """Return ways (L, 3) [m] of link origins and rotation vectors (J, 3) [rad] of joints from the goal's."""
        jointed = self.tree.jointed
        turns = np.swapaxes(self.goal.relative[jointed], 1, 2) @ placed.relative[jointed]
        return placed.positions - self.goal.positions, rotation.to_rotation_vector(rotation.from_matrix(turns)).reshape(-1, 3)

    def figures(self, placed: Placed) -> tuple[float, float]:
        """Return (offset [m], angle [rad]), each a root mean square over links, over joints."""
        ways, turns = self.vectors(placed)
        return tuple(float(np.sqrt(np.mean((v**2).sum(axis=1)))) if len(v) else 0.0 for v in (ways, turns))  # type: ignore[return-value]

    def score(self, placed: Placed) -> float:
        """Return the objective to minimise [m^2]: offset squared plus (arm times angle) squared."""
        offset, angle = self.figures(placed)
        return offset**2 + (self.arm * angle) ** 2

    def linearised(self, placed: Placed) -> tuple[Array, Array]:
        """Return rates (k, n) and errors (k,) whose sum of squares is the score."""
        tree = self.tree
        ways, turns = self.vectors(placed)
        rows = [tree.point_rates(placed, k, placed.positions[k]) / np.sqrt(len(ways)) for k in range(len(ways))]
        scale = self.arm / np.sqrt(max(len(turns), 1))
        for link, vector in zip(tree.jointed, turns, strict=True):
            own = np.zeros((3, tree.n))
            first, last = tree.first[link], tree.first[link + 1]
            spun = ~tree.shifts[first:last]
            own[:, first:last][:, spun] = (placed.axes[first:last][spun] @ placed.turns[link]).T
            rows.append(scale * (rates_of_log(vector) @ own))
        return np.vstack(rows), np.concatenate([ways.ravel() / np.sqrt(len(ways)), scale * turns.ravel()])
