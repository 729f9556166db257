"""Trial and step of one avatar: forward kinematics and the tangent space of its posture (see `model.skeleton`)."""

from avatarsim.ik.state import FORWARDS, IkScratch, Rig
from avatarsim.jit.kernel import kernel
from avatarsim.model.couplings import set_followers
from avatarsim.model.geometry import Array, Poses, place
from avatarsim.model.skeleton import (
    BALL,
    FREE,
    SLIDE,
    Posture,
    Skeleton,
    carry_links,
    displace_links,
    has_angles,
)
from avatarsim.spatial.tangent import columns, step_between
from avatarsim.spatial.vec3 import Rows, Vec3, row, sub


@kernel
def carry_avatar(rig: Rig, avatar: int, posture: Posture, step: Array, poses_out: Poses, axes_out: Rows) -> None:
    """Compute positions and rotations of an avatar's links at `posture` displaced by `step` (nd), and axes (nd, 3); no shapes."""
    avatars = rig.avatars
    first, end = avatars.first_link[avatar], avatars.first_link[avatar + 1]
    carry_links(rig.skel, first, end, posture, step, poses_out, axes_out)


@kernel
def place_avatar(rig: Rig, avatar: int, poses_out: Poses) -> None:
    """Carry the shapes of an avatar's links to where `carry_avatar` has put these."""
    avatars = rig.avatars
    for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        place(rig.geo, poses_out, rig.skel.first + link)


@kernel
def try_step(rig: Rig, avatar: int, posture: Posture, scratch_out: IkScratch) -> None:
    """Set the trial: an avatar displaced by the step, shapes and all."""
    s = scratch_out
    carry_avatar(rig, avatar, posture, s.step, s.trial, s.axes)
    place_avatar(rig, avatar, s.trial)
    s.counts[FORWARDS] += 1


@kernel
def take_step(rig: Rig, avatar: int, step: Array, posture_out: Posture) -> None:
    """Make posture + step the posture; hinges and slides end within limits, followers to the bit where their leaders have
    them."""
    skel, avatars = rig.skel, rig.avatars
    first, end = avatars.first_link[avatar], avatars.first_link[avatar + 1]
    displace_links(skel, first, end, posture_out, step)
    for link in range(first, end):
        if has_angles(skel, link):
            for j in range(skel.first_dof[link], skel.first_dof[link + 1]):
                posture_out.angle[j] = min(max(posture_out.angle[j], skel.limits[j, 0]), skel.limits[j, 1])
    set_followers(skel, skel.first_dof[first], skel.first_dof[end], 0.0, posture_out)


@kernel
def tangent_error(rig: Rig, avatar: int, start: Posture, end: Posture, error_out: Array) -> None:
    """Compute the difference (nd) of two postures in the tangent space of the first."""
    skel, avatars = rig.skel, rig.avatars
    for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        d, kind = skel.first_dof[link], skel.kind[link]
        if kind == FREE:
            put(error_out, d, sub(row(end.root, link), row(start.root, link)))
            d += 3
        if kind == FREE or kind == BALL:
            put(error_out, d, step_between(columns(start.turn, link), columns(end.turn, link)))
        elif has_angles(skel, link):
            for j in range(d, skel.first_dof[link + 1]):
                error_out[j] = end.angle[j] - start.angle[j]


@kernel
def put(values_out: Array, first: int, v: Vec3) -> None:
    """Write a vector to three places from `first` on."""
    for k in range(3):
        values_out[first + k] = v[k]


@kernel
def parts_of(skel: Skeleton, link: int, step: Array) -> tuple[float, float]:
    """Return how far a root or a slide moves [m] and a joint turns [rad] by a step (nd), hinges of one joint together."""
    d, moved, turned_by = skel.first_dof[link], 0.0, 0.0
    if skel.kind[link] == FREE:
        moved = (step[d] * step[d] + step[d + 1] * step[d + 1] + step[d + 2] * step[d + 2]) ** 0.5
        d += 3
    elif skel.kind[link] == SLIDE:
        return abs(step[d]), 0.0
    for j in range(d, skel.first_dof[link + 1]):
        turned_by += step[j] * step[j]
    return moved, turned_by**0.5


@kernel
def longest_part(rig: Rig, avatar: int, step: Array, move: float, turn: float) -> float:
    """Return the largest part of an avatar's step (nd): of roots and slides in units of `move` [m], of joints of `turn` [rad]."""
    avatars = rig.avatars
    longest = 0.0
    for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        moved, turned = parts_of(rig.skel, link, step)
        longest = max(longest, moved / move, turned / turn)
    return longest
