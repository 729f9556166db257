"""Margins of a ball joint inside its limits: swing, twist and reach cone, negative outside."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.joint import Ball, ReachCone
from avatarsim.spatial import rotation
from tests.nearest_free.tree import turn_by

Array = NDArray[np.float64]

SMALL = 1e-6
"""Turn [rad] over which a margin's slope is taken; smaller drowns in rounding, larger cuts corners of cones."""


def angles_to(directions: Array, limb: Array) -> Array:
    """Return angles (k,) [rad] between unit `directions` (k, 3) and the unit `limb` (3,)."""
    along = directions @ limb
    return np.asarray(np.arctan2(np.linalg.norm(directions - along[:, None] * limb, axis=1), along))


class ConeBorder:
    """The planes of a reach cone: of the triangles that it is made of, and of the lunes over its edges."""

    def __init__(self, cone: ReachCone) -> None:
        starts, seen = cone.vertices, np.array(cone.visible_point)
        ends = np.roll(starts, -1, axis=0)
        edges = np.cross(starts, ends)
        self.corners, self.triangles = starts, (np.cross(seen, starts), edges, np.cross(ends, seen))
        self.normals = edges / np.linalg.norm(edges, axis=1)[:, None]
        self.lunes = np.cross(self.normals, starts), np.cross(ends, self.normals)

    def margin(self, limb: Array) -> float:
        """Return the angle [rad] from the unit `limb` (3,) to the border, negative outside the cone."""
        nearest = float(angles_to(self.corners, limb).min())
        # the foot of the limb on an edge's great circle counts where it lies on the edge
        over = (self.lunes[0] @ limb >= 0.0) & (self.lunes[1] @ limb >= 0.0)
        if over.any():
            nearest = min(nearest, float(np.abs(0.5 * np.pi - angles_to(self.normals[over], limb)).min()))
        first, edge, second = (planes @ limb >= 0.0 for planes in self.triangles)
        return nearest if (first & edge & second).any() else -nearest


class BallLimits:
    """The limits of one ball joint, whose link is turned by `zero` (3, 3) against its parent when the joint is at zero."""

    def __init__(self, ball: Ball, zero: Array) -> None:
        self.limits, self.border = ball.limits, ConeBorder(ball.cone) if ball.cone else None
        self.axis = np.array([1.0, 0.0, 0.0])
        if ball.limits:
            self.axis, self.centre = np.array(ball.limits.axis), np.array(ball.limits.centre)
            self.shortest = rotation.to_matrix(rotation.between(self.axis, self.centre))
        elif ball.cone:
            self.axis = zero.T @ np.array(ball.cone.visible_point)

    def margins(self, relative: Array) -> Array:
        """Return margins [rad] of a link turned by `relative` (3, 3) against its parent: swing, lower and upper twist, cone, as
        far as there are such limits."""
        found: list[float] = []
        limb = relative @ self.axis
        if self.limits:
            found.append(self.limits.swing - float(angles_to(self.centre[None], limb)[0]))
            r = self.shortest.T @ relative
            # of the quaternion (w, v) of r, v.a / w is this sine over this cosine; no square root needs to be taken
            sine = (r[2, 1] - r[1, 2]) * self.axis[0] + (r[0, 2] - r[2, 0]) * self.axis[1] + (r[1, 0] - r[0, 1]) * self.axis[2]
            twist = 2.0 * float(np.arctan2(sine, 1.0 + np.trace(r)))
            twist = float(np.pi - (np.pi - twist) % (2.0 * np.pi))
            found += [twist - self.limits.twist[0], self.limits.twist[1] - twist]
        if self.border:
            found.append(self.border.margin(limb))
        return np.array(found)

    def rows(self, relative: Array) -> tuple[Array, Array]:
        """Return margins (m,) and their slopes (m, 3) for small turns about the link's own axes."""
        here = self.margins(relative)
        slopes = [(self.margins(relative @ turn) - here) / SMALL for turn in TURNS]
        return here, np.array(slopes).T.reshape(len(here), 3)


TURNS = [turn_by(SMALL * axis) for axis in np.eye(3)]
"""A small turn about each axis."""
