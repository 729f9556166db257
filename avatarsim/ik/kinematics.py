"""Forward kinematics of one avatar: from a posture and a step in its tangent space to the poses of its links.

Tangent space: translation of a free root in the world's axes, rotation vector of roots and balls in the link's own axes (the step
R exp(w)), angles of hinges. World axes are those of the geometric Jacobian (Featherstone 2008, chapter 4).
"""

from avatarsim.ik.state import FORWARDS, Avatars, IkScratch
from avatarsim.kernel import kernel
from avatarsim.spatial.tangent import about, columns, product, put_columns, step_between, stepped, straightened, turned
from avatarsim.spatial.vec3 import Rows, Vec3, add, put_row, row, sub
from avatarsim.world.geometry import Array, Geometry, Poses, place
from avatarsim.world.skeleton import BALL, FREE, HINGES, Posture, Skeleton


@kernel
def carry_avatar(
    skel: Skeleton, avatars: Avatars, avatar: int, posture: Posture, step: Array, poses_out: Poses, axes_out: Rows
) -> None:
    """Positions and rotations of the links of an avatar at `posture` displaced by `step` (nd), and axes (nd, 3); no shapes."""
    bodies = skel.first
    for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        d, kind, parent = skel.first_dof[link], skel.kind[link], skel.parent[link]
        if kind == FREE:
            origin = add(row(posture.root, link), (step[d], step[d + 1], step[d + 2]))
            frame = stepped(columns(posture.turn, link), (step[d + 3], step[d + 4], step[d + 5]))
            for i in range(3):
                for k in range(3):
                    axes_out[d + i, k] = 1.0 if i == k else 0.0
                put_row(axes_out, d + 3 + i, frame[i])
        else:
            if parent >= 0:
                carrier = columns(poses_out.rotation, bodies + parent)
                origin = add(row(poses_out.position, bodies + parent), turned(carrier, row(skel.anchor, link)))
                frame = product(carrier, columns(skel.rest, link))
            else:
                origin, frame = row(skel.anchor, link), columns(skel.rest, link)
            if kind == BALL:
                frame = product(frame, stepped(columns(posture.turn, link), (step[d], step[d + 1], step[d + 2])))
                for i in range(3):
                    put_row(axes_out, d + i, frame[i])
            elif kind == HINGES:
                for j in range(d, skel.first_dof[link + 1]):
                    axis, angle = turned(frame, row(skel.axis, j)), posture.angle[j] + step[j]
                    put_row(axes_out, j, axis)
                    frame = (about(axis, angle, frame[0]), about(axis, angle, frame[1]), about(axis, angle, frame[2]))
        put_row(poses_out.position, bodies + link, origin)
        put_columns(poses_out.rotation, bodies + link, frame)


@kernel
def place_avatar(geo: Geometry, skel: Skeleton, avatars: Avatars, avatar: int, poses_out: Poses) -> None:
    """Carry the shapes of an avatar's links to where `carry_avatar` has put these."""
    for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        place(geo, poses_out, skel.first + link)


@kernel
def try_step(
    geo: Geometry, skel: Skeleton, avatars: Avatars, avatar: int, posture: Posture, scratch_out: IkScratch
) -> None:
    """The trial: an avatar displaced by the step, shapes and all."""
    s = scratch_out
    carry_avatar(skel, avatars, avatar, posture, s.step, s.trial, s.axes)
    place_avatar(geo, skel, avatars, avatar, s.trial)
    s.counts[FORWARDS] += 1


@kernel
def take_step(skel: Skeleton, avatars: Avatars, avatar: int, step: Array, posture_out: Posture) -> None:
    """Make posture + step the posture: rotations straightened, or they would drift; hinges within their limits to the bit."""
    for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        d, kind = skel.first_dof[link], skel.kind[link]
        if kind == FREE:
            for k in range(3):
                posture_out.root[link, k] += step[d + k]
            d += 3
        if kind == FREE or kind == BALL:
            frame = stepped(columns(posture_out.turn, link), (step[d], step[d + 1], step[d + 2]))
            put_columns(posture_out.turn, link, straightened(frame))
        elif kind == HINGES:
            for j in range(d, skel.first_dof[link + 1]):
                posture_out.angle[j] = min(max(posture_out.angle[j] + step[j], skel.limits[j, 0]), skel.limits[j, 1])


@kernel
def tangent_error(skel: Skeleton, avatars: Avatars, avatar: int, start: Posture, end: Posture, error_out: Array) -> None:
    """The difference (nd) of two postures in the tangent space of the first."""
    for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        d, kind = skel.first_dof[link], skel.kind[link]
        if kind == FREE:
            put(error_out, d, sub(row(end.root, link), row(start.root, link)))
            d += 3
        if kind == FREE or kind == BALL:
            put(error_out, d, step_between(columns(start.turn, link), columns(end.turn, link)))
        elif kind == HINGES:
            for j in range(d, skel.first_dof[link + 1]):
                error_out[j] = end.angle[j] - start.angle[j]


@kernel
def put(values_out: Array, first: int, v: Vec3) -> None:
    """Write a vector to three places from `first` on."""
    for k in range(3):
        values_out[first + k] = v[k]


@kernel
def parts_of(skel: Skeleton, link: int, step: Array) -> tuple[float, float]:
    """How far a root moves [m] and how far a joint turns [rad] by a step (nd); hinges of one joint together."""
    d, moved, turned_by = skel.first_dof[link], 0.0, 0.0
    if skel.kind[link] == FREE:
        moved = (step[d] * step[d] + step[d + 1] * step[d + 1] + step[d + 2] * step[d + 2]) ** 0.5
        d += 3
    for j in range(d, skel.first_dof[link + 1]):
        turned_by += step[j] * step[j]
    return moved, turned_by**0.5
