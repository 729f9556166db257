"""The arrays of the posture solver, made once per scene."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.scratch import make_scratch
from avatarsim.ik.broad_phase import forget_near
from avatarsim.ik.kinematics import carry_avatar
from avatarsim.ik.state import (
    ACTIVE_CAP,
    COUNT_NAMES,
    MOST_PRESSED,
    ROWS_MOST,
    ROWS_PER_AVATAR,
    TOUCHING_PER_AVATAR,
    TRACKING,
    Array,
    Avatars,
    Budget,
    ConstraintRows,
    Failed,
    IkScratch,
    IkState,
    Index,
    Inertia,
    Objective,
    Rig,
    Touching,
    Tracking,
    make_contacts,
    make_pair_cache,
)
from avatarsim.model.couplings import elimination_parents
from avatarsim.model.geometry import Geometry, Poses
from avatarsim.model.skeleton import FREE, SLIDE, Posture, Skeleton


def zeros(*shape: int) -> Array:
    """Return an array of zeros."""
    return np.zeros(shape)


def indices(*shape: int) -> Index:
    """Return an array of integers."""
    return np.zeros(shape, dtype=np.int64)


def empty_posture(nl: int, nd: int) -> Posture:
    """Return a posture of zeros."""
    return Posture(np.zeros((nl, 3)), np.tile(np.eye(3), (nl, 1, 1)), np.zeros(nd))


def reaches(geo: Geometry, skel: Skeleton, poses: Poses) -> Array:
    """Return how far (nl) [m] each link reaches from its joint; NaN where it has no shape."""
    found = np.full(len(skel.kind), np.nan)
    for link in range(len(skel.kind)):
        b = skel.first + link
        for s in range(geo.first_shape[b], geo.first_shape[b + 1]):
            points = poses.vertices[geo.shapes.start[s] : geo.shapes.start[s + 1]] - poses.position[b]
            found[link] = np.fmax(found[link], np.linalg.norm(points, axis=1).max() + geo.shapes.radius[s])
    return found


FINGER_WEIGHT = 1e-3
"""Weight of a sliding finger in the objective, as a share of any other link's. Larger: a finger that is blocked pulls its arm
aside; smaller: the distance of a blocked finger from its target vanishes in the rounding of the arm."""


def finger_links(skel: Skeleton) -> NDArray[np.bool_]:
    """Mark (nl) the fingers of grippers, with links rigid with them: slides that carry no joint and have another such slide on
    the same moving link. A slide alone is an axis of an arm, as that of a SCARA."""
    nl = len(skel.kind)
    movers = np.diff(skel.first_dof) > 0
    carrier = np.full(nl, -1)
    for link in range(nl):
        parent = skel.parent[link]
        carrier[link] = parent if parent < 0 or movers[parent] else carrier[parent]
    ends = [int(k) for k in np.flatnonzero(skel.kind == SLIDE) if not np.any(skel.related[:, k] & movers & (np.arange(nl) != k))]
    fingers = [k for k in ends if sum(carrier[k] == carrier[other] for other in ends) > 1 and carrier[k] >= 0]
    return np.asarray(skel.related[:, fingers].any(axis=1))


def make_avatars(
    geo: Geometry, skel: Skeleton, poses: Poses, friction: tuple[NDArray[np.int64], Array] | None = None
) -> tuple[Avatars, Array]:
    """Return the constants of the avatars, and the mean reach (na) [m] of their links, 1 where no link has a shape.

    `friction`: materials (nb) and coefficients (nm, nm) as of `World.link_friction`; without it there is none."""
    nl, nd = len(skel.kind), int(skel.first_dof[-1])
    roots = np.flatnonzero(skel.parent < 0)
    first_link = np.append(roots, nl).astype(np.int64)
    avatar = np.repeat(np.arange(len(roots)), np.diff(first_link)).astype(np.int64)
    joint_of = np.repeat(np.arange(nl), np.diff(skel.first_dof)).astype(np.int64)
    paths: list[list[int]] = []
    for j, above in enumerate(elimination_parents(skel)):
        paths.append([*(paths[above] if above >= 0 else ()), j])
    path = indices(nd, max((len(one) for one in paths), default=1))
    for j, degrees in enumerate(paths):
        path[j, : len(degrees)] = degrees
    reach, far = np.ones(len(roots)), reaches(geo, skel, poses)
    weight = zeros(nd)
    for a in range(len(roots)):
        links = np.arange(first_link[a], first_link[a + 1])
        if np.isfinite(far[links]).any():
            reach[a] = np.nanmean(far[links])
        joints = max(int((np.diff(skel.first_dof)[links] > 0).sum()), 1)
        weight[skel.first_dof[links[0]] : skel.first_dof[links[-1] + 1]] = reach[a] ** 2 * len(links) / joints
    for link in np.flatnonzero(skel.kind == FREE):
        weight[skel.first_dof[link] : skel.first_dof[link] + 3] = 0.0
    for link in np.flatnonzero(skel.kind == SLIDE):
        # a metre counts as a metre: only radians are converted to metres by the reach
        weight[skel.first_dof[link]] /= reach[avatar[link]] ** 2
    shares = np.where(finger_links(skel), FINGER_WEIGHT, 1.0)
    weight *= shares[joint_of]
    depth = np.array([len(one) - 1 for one in paths], dtype=np.int64)
    material, coefficients = friction or (np.full(len(geo.first_shape) - 1, -1), zeros(1, 1))
    parts = first_link, skel.first_dof[first_link], avatar, joint_of, path, depth, weight, shares, material, coefficients
    return Avatars(*parts), reach


def make_state(geo: Geometry, skel: Skeleton, avatars: Avatars, reach: Array, axes: Array, posture: Posture) -> IkState:
    """Return the state of avatars that have been at rest at `posture` so far, with axes (nd, 3) there."""
    nl, na = len(skel.kind), len(reach)
    driven = len(geo.body) - int(geo.first_shape[skel.first])
    tracking = np.zeros(na, TRACKING).view(Tracking)
    tracking["reach"], tracking["island"], tracking["ease"] = reach, np.arange(na), 1.0
    pairs = TOUCHING_PER_AVATAR * na
    # a target that begins where the avatar does has not leapt there
    target, tracker, shown = (Posture(*(array.copy() for array in posture)) for _ in range(3))
    nd = len(avatars.joint_of)
    state = IkState(
        tracking, target, tracker, zeros(nl, 3), zeros(nl), make_contacts(ROWS_PER_AVATAR * na),
        Touching(indices(1), indices(pairs, 2), indices(pairs)), make_pair_cache(driven, len(geo.body)),
        indices(na, max(skel.first, 1)), indices(na), zeros(na, 6), axes, Budget(zeros(nl), zeros(nl), zeros(nl), zeros(nl),
        zeros(2)), Inertia(shown, zeros(nd), zeros(nd), zeros(nd), zeros(nd)),
    )
    forget_near(state)
    return state


def make_objective(avatars: Avatars, nl: int, nd: int) -> Objective:
    """Return room for the model of a step."""
    return Objective(
        zeros(nl, 3), zeros(nl, 3, 3), zeros(nl, 3), zeros(nd), zeros(nd), zeros(nl), zeros(nl), zeros(nl, 3), zeros(nl, 3),
        zeros(nl, 3), zeros(nl, 3, 3), zeros(nl, 3, 3), zeros(nd, 6), zeros(*avatars.path.shape), zeros(nd),
    )


def make_rows(avatars: Avatars, nd: int) -> ConstraintRows:
    """Return room for the rows of a step."""
    m = min(ROWS_PER_AVATAR * (len(avatars.first_link) - 1), ROWS_MOST)
    return ConstraintRows(
        indices(1), indices(1), indices(m), indices(m, 2), indices(m, 2), zeros(m, nd), zeros(m, nd), zeros(m), zeros(m),
        zeros(m), np.full(m, MOST_PRESSED), zeros(m), zeros(m), zeros(m, 3), zeros(m, 6), zeros(m, m),
        np.zeros(1, dtype=np.bool_), zeros(ACTIVE_CAP, ACTIVE_CAP), indices(ACTIVE_CAP), zeros(ACTIVE_CAP),
    )


def make_working(geo: Geometry, skel: Skeleton, avatars: Avatars, poses: Poses, trail_steps: int) -> IkScratch:
    """Return working memory, with room for the poses of `trail_steps` steps of a frame."""
    nl, nd, na = len(skel.kind), int(skel.first_dof[-1]), len(avatars.first_link) - 1
    return IkScratch(
        empty_posture(nl, nd), Poses(*(array.copy() for array in poses)), zeros(nd, 3), poses.boxes.copy(), poses.hulls.copy(),
        zeros(na, 6), zeros(nd), zeros(nd), zeros(nd), zeros(nd), indices(na), indices(na), make_objective(avatars,
        nl, nd),
        make_rows(avatars, nd), Failed(indices(1), indices(TOUCHING_PER_AVATAR * na, 2)), make_scratch(),
        indices(len(COUNT_NAMES)), zeros(trail_steps, nl, 12),
    )


def spans(skel: Skeleton) -> Avatars:
    """Return which links and degrees each avatar has, and nothing else of them."""
    first_link = np.append(np.flatnonzero(skel.parent < 0), len(skel.kind)).astype(np.int64)
    none = zeros(1)
    return Avatars(
        first_link, skel.first_dof[first_link], first_link, first_link, indices(1, 1), first_link, none, none, first_link,
        zeros(1, 1),
    )


def make_solver(
    geo: Geometry, skel: Skeleton, posture: Posture, poses: Poses, trail_steps: int = 0,
    friction: tuple[NDArray[np.int64], Array] | None = None,
) -> tuple[Avatars, IkState, IkScratch]:
    """Return all that the solver needs for a world at its first posture."""
    nd = int(skel.first_dof[-1])
    axes, own = zeros(nd, 3), spans(skel)
    for a in range(len(own.first_link) - 1):
        carry_avatar(Rig(geo, skel, own), a, posture, zeros(nd), poses, axes)
    avatars, reach = make_avatars(geo, skel, poses, friction)
    return avatars, make_state(geo, skel, avatars, reach, axes, posture), make_working(geo, skel, avatars, poses, trail_steps)
