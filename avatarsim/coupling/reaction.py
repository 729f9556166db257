"""How joints yield to what impacts left on the links: the smallest change of posture that moves every hit link by its offset.

Eq. 6 gives each link an offset from where the tracker has it. A free root is moved by its own offset; the other links are held by
joints, so their offsets become angles, in the metric of the posture. What no joint can give, a free root gives by translation.

Weight of each degree of freedom when joints share an impulse: the mass matrix's diagonal for a body of even vertices.
"""

from math import inf

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel
from avatarsim.model.geometry import Geometry, Poses
from avatarsim.model.skeleton import FREE, HINGES, Posture, Skeleton
from avatarsim.spatial import rotation
from avatarsim.spatial.vec3 import Rows, Vec3, add, along, cross, dot, row, solved, sub
from avatarsim.tolerances import REGULAR, SHORT_TURN, SMALL

Array = NDArray[np.float64]

LEAST = 3.0
"""[median weights] least weight of a joint: without it nearly free joints, wrists and feet, spin to gain a millimetre."""

ROOT = 3.0
"""How much more a root weighs than what it moves: a body that a hand could yield for stands still."""


def joint_weights(geo: Geometry, skel: Skeleton, poses: Poses, axes: Array) -> Array:
    """Weight (nd) of every degree of freedom, in medians of them: mean squared motion of the vertices that it moves, at `poses`,
    with world axes (nd, 3) of the degrees."""
    weight = np.zeros(skel.first_dof[-1])
    for link in range(len(skel.kind)):
        b = skel.first + link
        rows = slice(geo.shapes.start[geo.first_shape[b]], geo.shapes.start[geo.first_shape[b + 1]])
        points = poses.vertices[rows]
        if not len(points):
            continue
        for m in range(len(skel.kind)):
            if not skel.related[link, m]:
                continue
            first, end = skel.first_dof[m : m + 2]
            if skel.kind[m] == FREE:
                weight[first : first + 3] += 1.0
                first += 3
            arms = rotation.cross(axes[first:end, None], points - poses.position[skel.first + m])
            weight[first:end] += (arms**2).sum(axis=-1).mean(axis=-1) + SMALL * SMALL
    roots = np.zeros(len(weight), dtype=bool)
    for link in np.flatnonzero(skel.kind == FREE).tolist():
        roots[skel.first_dof[link] : skel.first_dof[link + 1]] = True
    # degrees that move no vertex weigh nothing: they are left out of the median and get the floor
    moving = weight > 0.0
    joints = weight[~roots & moving] if (~roots & moving).any() else weight[moving]
    typical = float(np.median(joints)) if len(joints) else 1.0
    floored: Array = np.maximum(weight / typical, LEAST)
    floored[roots] *= ROOT
    return floored


ROUNDS = 4
"""Times all offsets are gone through. Links of one finger share joints; a lone link is done after one. Fewer: links that were
hit together stay off their offsets; more: time."""

MOST_TURN = SHORT_TURN
"""[rad] a joint yields at most: beyond it columns of the Jacobian point elsewhere. A link that is pushed farther waits for it."""


@kernel
def middle(poses: Poses, b: int) -> Vec3:
    """The point of a link that its offset moves [m]: the middle of the box around it."""
    h = poses.hulls
    return (0.5 * (h[b, 0] + h[b, 3]), 0.5 * (h[b, 1] + h[b, 4]), 0.5 * (h[b, 2] + h[b, 5]))


@kernel
def column(skel: Skeleton, m: int, j: int, arm: Vec3, axes: Rows) -> Vec3:
    """How a point at `arm` from the joint of link m moves with degree j; a free root only translates, as the paper has it."""
    axis = row(axes, j)
    if skel.kind[m] == FREE:
        return axis if j < skel.first_dof[m] + 3 else (0.0, 0.0, 0.0)
    return cross(axis, arm)


@kernel
def bounded(skel: Skeleton, posture: Posture, m: int, j: int, way: float) -> float:
    """The way of degree j, cut where its hinge ends and at `MOST_TURN`. Balls turn beyond their cones: the posture that comes of
    it is a target, which `ik.target` clips. Free roots are not bounded."""
    if skel.kind[m] == FREE:
        return way
    low, high = -MOST_TURN, MOST_TURN
    if skel.kind[m] == HINGES:
        low = max(low, min(0.0, skel.limits[j, 0] - posture.angle[j]))
        high = min(high, max(0.0, skel.limits[j, 1] - posture.angle[j]))
    return min(max(way, low), high)


@kernel
def yield_link(
    skel: Skeleton, posture: Posture, poses: Poses, axes: Rows, link: int, offset: Vec3, inverse_weight: Array, way_out: Array
) -> None:
    """Change way (nd) so that the middle of one link moves by `offset` [m], to first order and as far as the joints go."""
    point, b = middle(poses, skel.first + link), skel.first
    x, y, z, left, m = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), offset, link
    while m >= 0:
        arm = sub(point, row(poses.position, b + m))
        for j in range(skel.first_dof[m], skel.first_dof[m + 1]):
            c, e = column(skel, m, j, arm, axes), inverse_weight[j]
            x, y, z = along(x, e * c[0], c), along(y, e * c[1], c), along(z, e * c[2], c)
            left = along(left, -way_out[j], c)
        m = skel.parent[m]
    stiff = REGULAR * (x[0] + y[1] + z[2])
    if not (0.0 < stiff < inf):
        return
    load = solved(add(x, (stiff, 0.0, 0.0)), add(y, (0.0, stiff, 0.0)), add(z, (0.0, 0.0, stiff)), left)
    m = link
    while m >= 0:
        arm = sub(point, row(poses.position, b + m))
        for j in range(skel.first_dof[m], skel.first_dof[m + 1]):
            more = inverse_weight[j] * dot(column(skel, m, j, arm, axes), load)
            way_out[j] = bounded(skel, posture, m, j, way_out[j] + more)
        m = skel.parent[m]


@kernel
def recoil(
    skel: Skeleton, posture: Posture, poses: Poses, axes: Rows, offset: Rows, inverse_weight: Array, way_out: Array
) -> bool:
    """Fill way (nd), a step of `posture` with `poses` and `axes` (nd, 3), for offsets (nl, 3) of all links but free roots [m].

    Returns whether any link has an offset.
    """
    way_out[:] = 0.0
    found = False
    for turn in range(ROUNDS):
        hit = 0
        for link in range(skel.kind.shape[0]):
            x = row(offset, link)
            if skel.kind[link] != FREE and dot(x, x) > 0.0:
                yield_link(skel, posture, poses, axes, link, x, inverse_weight, way_out)
                hit += 1
        found = hit > 0
        if hit == 0 or (hit == 1 and turn == 1):
            break
    return found
