"""Kinematic trees of all avatars as arrays: links, joints and joint limits.

Forward kinematics: from a posture and a step in its tangent space to the poses of links.

Tangent space: translation of a free root in the world's axes, rotation vector of roots and balls in the link's own axes (the step
R exp(w)), angles of hinges, ways of slides. World axes are those of the geometric Jacobian (Featherstone 2008, chapter 4).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel
from avatarsim.jit.layout import FlagGrid, Grid, IndexGrid, IndexLine, Line, Matrices, Vectors
from avatarsim.model.ball_limits import BallLimits, ball_limits
from avatarsim.model.geometry import Geometry, Poses, place
from avatarsim.scene.joint import Free, Rigid, Slide, axes_of
from avatarsim.scene.scene import Scene
from avatarsim.spatial import rotation
from avatarsim.spatial.tangent import about, columns, product, put_columns, stepped, straightened, turned
from avatarsim.spatial.vec3 import Rows, add, along, put_row, row

Array = NDArray[np.float64]
Index = NDArray[np.int64]

RIGID, HINGES, BALL, FREE, SLIDE = 0, 1, 2, 3, 4
"""Kinds of joints. Tangent degrees of freedom: none, one per hinge, three, six (translation, then rotation), one."""

UNLIMITED = 1e9
"""Value for no limit [rad, m]: far beyond any angle or place, yet safe to subtract."""


class Skeleton(NamedTuple):
    """Constants of nl links with nd tangent degrees of freedom.

    first      body index of link 0; link i is body first + i
    kind       (nl) joint kind
    parent     (nl) parent link, -1 at a root
    first_dof  (nl + 1) tangent degrees of link i are first_dof[i] .. first_dof[i + 1]
    anchor     (nl, 3) joint centre in the parent's frame [m]
    rest       (nl, 3, 3) link frame in the parent's at zero
    axis       (nd, 3) axes of hinges and slides in the link frame
    limits     (nd, 2) limits of hinges [rad] and slides [m]
    balls      limits of ball joints
    follow     (nf, 2) degrees that follow others: the follower, its leader
    ratio      (nf, 2) ratio and offset [rad, m] of each: follower = ratio leader + offset
    related    (nl, nl) True at [i, m] where link m is i or one of its ancestors: degrees of m move i
    """

    first: int
    kind: IndexLine
    parent: IndexLine
    first_dof: IndexLine
    anchor: Vectors
    rest: Matrices
    axis: Vectors
    limits: Grid
    balls: BallLimits
    related: FlagGrid
    follow: IndexGrid
    ratio: Grid


class Posture(NamedTuple):
    """A posture: root (nl, 3) position of free roots in the world [m]; turn (nl, 3, 3) rotation matrix of balls and free roots in
    their parents, the world for a root; angle (nd) of hinges [rad], way of slides [m]. Rows of links and degrees of another kind
    are not read."""

    root: Vectors
    turn: Matrices
    angle: Line


def skeleton(scene: Scene) -> Skeleton:
    """Return arrays of all links of `scene`."""
    links, nl = scene.links, len(scene.links)
    kind, parent, first_dof = np.zeros(nl, dtype=np.int64), np.full(nl, -1, dtype=np.int64), [0]
    axis: list[tuple[float, float, float]] = []
    limits: list[tuple[float, float]] = []
    at: dict[tuple[str, str], int] = {}
    owned = [(avatar, link) for avatar in scene.avatars for link in avatar.links]
    for i, (avatar, link) in enumerate(owned):
        at[avatar.name, link.name] = i
        if link.parent is not None:
            parent[i] = at[avatar.name, link.parent]
        joint = link.joint
        if own := axes_of(joint):
            kind[i] = SLIDE if isinstance(joint, Slide) else HINGES
            axis += [one.axis for one in own]
            kept = scene.effects.limits
            limits += [(one.lower, one.upper) if kept else (-UNLIMITED, UNLIMITED) for one in own]
        elif not isinstance(joint, Rigid):
            kind[i] = FREE if isinstance(joint, Free) else BALL
            free = 6 if isinstance(joint, Free) else 3
            axis += [(0.0, 0.0, 0.0)] * free
            limits += [(-UNLIMITED, UNLIMITED)] * free
        first_dof.append(len(axis))
    related = np.eye(nl, dtype=np.bool_)
    for i in range(nl):
        if parent[i] >= 0:
            related[i] |= related[parent[i]]
    return Skeleton(
        len(scene.bodies), kind, parent, np.array(first_dof, dtype=np.int64),
        np.array([link.anchor for link in links], dtype=np.float64).reshape(nl, 3),
        np.array([rotation.to_matrix(link.orientation) for link in links], dtype=np.float64).reshape(nl, 3, 3),
        np.array(axis, dtype=np.float64).reshape(-1, 3), np.array(limits, dtype=np.float64).reshape(-1, 2),
        ball_limits(scene), related, *couplings(scene, kind, first_dof),
    )


def couplings(scene: Scene, kind: Index, first_dof: list[int]) -> tuple[Index, Array]:
    """Return `Skeleton.follow` and `Skeleton.ratio` of a scene."""
    angled = np.flatnonzero((kind == HINGES) | (kind == SLIDE))
    degrees = [j for link in angled for j in range(first_dof[link], first_dof[link + 1])]
    first, follow, ratio = 0, [], []
    for avatar in scene.avatars:
        follow += [(degrees[first + one.follower], degrees[first + one.leader]) for one in avatar.couplings]
        ratio += [(one.ratio, one.offset) for one in avatar.couplings]
        first += avatar.hinge_count
    return np.array(follow, dtype=np.int64).reshape(-1, 2), np.array(ratio, dtype=np.float64).reshape(-1, 2)


def hinge_dofs(skel: Skeleton) -> Index:
    """Return the tangent index of every hinge and slide, in the order of TrackerSample.angles."""
    hinged = np.flatnonzero((skel.kind == HINGES) | (skel.kind == SLIDE))
    spans = [range(skel.first_dof[link], skel.first_dof[link + 1]) for link in hinged]
    return np.array([j for span in spans for j in span], dtype=np.int64)


@kernel
def has_angles(skel: Skeleton, link: int) -> bool:
    """Return whether a link's degrees are angles of hinges or the way of a slide, each with limits of its own."""
    return bool(skel.kind[link] == HINGES or skel.kind[link] == SLIDE)


@kernel
def translations(skel: Skeleton, link: int) -> int:
    """Return how many of a link's degrees, from its first one on, are translations."""
    if skel.kind[link] == FREE:
        return 3
    return 1 if skel.kind[link] == SLIDE else 0


@kernel
def forward(geo: Geometry, skel: Skeleton, posture: Posture, step: Rows, poses_out: Poses, axes_out: Rows) -> None:
    """Compute poses of all links at `posture` displaced by `step` (nd), shapes and all; world axes (nd, 3) of every degree."""
    carry(skel, posture, step, poses_out, axes_out)
    place_links(geo, skel, poses_out)


@kernel
def place_links(geo: Geometry, skel: Skeleton, poses_out: Poses) -> None:
    """Carry the shapes of all links to where `carry` has put these."""
    for link in range(skel.kind.shape[0]):
        place(geo, poses_out, skel.first + link)


@kernel
def carry(skel: Skeleton, posture: Posture, step: Rows, poses_out: Poses, axes_out: Rows) -> None:
    """Compute positions, rotations and axes alone: a hand of many pieces takes most of its time for their vertices."""
    carry_links(skel, 0, skel.kind.shape[0], posture, step, poses_out, axes_out)


@kernel
def carry_links(
    skel: Skeleton, first: int, end: int, posture: Posture, step: Rows, poses_out: Poses, axes_out: Rows
) -> None:
    """Compute positions and rotations of links first .. end - 1, whole avatars, at `posture` displaced by `step` (nd), and axes.

    Hinge and slide: angle or way + step. Ball and root: R exp(step), the step in the link's own axes. Root position: + step.
    """
    kinds, first_dof, parents, bodies = skel.kind, skel.first_dof, skel.parent, skel.first
    anchors, rests, axis_of = skel.anchor, skel.rest, skel.axis
    turns, roots, angles, positions, rotations = posture.turn, posture.root, posture.angle, poses_out.position, poses_out.rotation
    for link in range(first, end):
        d, kind, parent = first_dof[link], kinds[link], parents[link]
        if kind == FREE:
            origin = (roots[link, 0] + step[d], roots[link, 1] + step[d + 1], roots[link, 2] + step[d + 2])
            frame = stepped(columns(turns, link), (step[d + 3], step[d + 4], step[d + 5]))
            for i in range(3):
                for k in range(3):
                    axes_out[d + i, k] = 1.0 if i == k else 0.0
                put_row(axes_out, d + 3 + i, frame[i])
        else:
            if parent >= 0:
                carrier = columns(rotations, bodies + parent)
                origin = add(row(positions, bodies + parent), turned(carrier, row(anchors, link)))
                frame = product(carrier, columns(rests, link))
            else:
                origin, frame = row(anchors, link), columns(rests, link)
            if kind == BALL:
                frame = product(frame, stepped(columns(turns, link), (step[d], step[d + 1], step[d + 2])))
                for i in range(3):
                    put_row(axes_out, d + i, frame[i])
            elif kind == SLIDE:
                axis = turned(frame, row(axis_of, d))
                put_row(axes_out, d, axis)
                origin = along(origin, angles[d] + step[d], axis)
            elif kind == HINGES:
                for j in range(d, first_dof[link + 1]):
                    axis, angle = turned(frame, row(axis_of, j)), angles[j] + step[j]
                    put_row(axes_out, j, axis)
                    frame = (about(axis, angle, frame[0]), about(axis, angle, frame[1]), about(axis, angle, frame[2]))
        put_row(positions, bodies + link, origin)
        put_columns(rotations, bodies + link, frame)


@kernel
def displace(skel: Skeleton, posture_out: Posture, step: Rows) -> None:
    """Make posture + step the posture, limits or not."""
    displace_links(skel, 0, skel.kind.shape[0], posture_out, step)


@kernel
def displace_links(skel: Skeleton, first: int, end: int, posture_out: Posture, step: Rows) -> None:
    """Displace the posture of links first .. end - 1; rotations are straightened, or they would drift apart over the frames."""
    for link in range(first, end):
        d, kind = skel.first_dof[link], skel.kind[link]
        if kind == FREE:
            for k in range(3):
                posture_out.root[link, k] += step[d + k]
            d += 3
        if kind == FREE or kind == BALL:
            frame = stepped(columns(posture_out.turn, link), (step[d], step[d + 1], step[d + 2]))
            put_columns(posture_out.turn, link, straightened(frame))
        elif has_angles(skel, link):
            for j in range(d, skel.first_dof[link + 1]):
                posture_out.angle[j] += step[j]
