"""Walk back (Schmidl and Lin 2004, Algorithm 1, step 4): interpolation to the last checked state, and its bisection.

Projection of an interpolated posture into the joint limits.

Walk back (Algorithm 1, step 4): bisection towards the last checked state until nothing overlaps.
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel
from avatarsim.model.geometry import Geometry, Poses, place
from avatarsim.model.joint_limits import has_cone, inside_cone
from avatarsim.model.skeleton import BALL, FREE, HINGES, Posture, Skeleton, forward
from avatarsim.paper.push_apart import answer_for, find_overlaps
from avatarsim.paper.state import FORWARDS, HELD, START_OVERLAPS, WALK_TESTS, WALKED_BACK, Chains, PaperMemory
from avatarsim.spatial.tangent import columns, put_columns, step_between, stepped, straightened
from avatarsim.spatial.vec3 import along, put_row, row, scale, sub


@kernel
def interpolate(
    skel: Skeleton, checked: Posture, present: Posture, fraction: float, chosen: NDArray[np.bool_], posture_out: Posture
) -> None:
    """Compute a posture between ``checked`` (fraction 0) and ``present`` (1) in the ``chosen`` (nl) links, others ``present``.

    Hinges and root positions on the straight line, balls and orientations of roots on the great circle. At fraction 0 and 1
    the bits are those of the ends: 0 holds even when the present posture is not a number.
    """
    for link in range(skel.kind.shape[0]):
        kind, f = skel.kind[link], fraction if chosen[link] else 1.0
        between = 0.0 < f < 1.0
        end_root, end_turn, end_angle = present.root, present.turn, present.angle
        if f <= 0.0:
            end_root, end_turn, end_angle = checked.root, checked.turn, checked.angle
        if kind == HINGES:
            for j in range(skel.first_dof[link], skel.first_dof[link + 1]):
                posture_out.angle[j] = end_angle[j]
                if between:
                    posture_out.angle[j] = checked.angle[j] + f * (present.angle[j] - checked.angle[j])
        if kind == FREE:
            start, end = row(checked.root, link), row(end_root, link)
            put_row(posture_out.root, link, along(start, f, sub(end, start)) if between else end)
        if kind == FREE or kind == BALL:
            turn = columns(end_turn, link)
            if between:
                first = columns(checked.turn, link)
                turn = straightened(stepped(first, scale(step_between(first, turn), f)))
            put_columns(posture_out.turn, link, turn)


@kernel
def narrowed(low: float, high: float, is_free: bool) -> tuple[float, float]:
    """Bisect once: return the half interval whose lower end is free and whose upper end is not, after its middle was tested."""
    middle = 0.5 * (low + high)
    return (middle, high) if is_free else (low, middle)


@kernel
def into_limits(skel: Skeleton, posture_out: Posture) -> None:
    """Clip every hinge and project every ball.

    Between two angles inside an interval all are inside; between two rotations inside a wide swing cone the great circle may
    leave it, by more than a radian.
    """
    for link in range(skel.kind.shape[0]):
        if skel.kind[link] == HINGES:
            for j in range(skel.first_dof[link], skel.first_dof[link + 1]):
                posture_out.angle[j] = min(max(posture_out.angle[j], skel.limits[j, 0]), skel.limits[j, 1])
        elif skel.kind[link] == BALL and has_cone(skel.balls, link):
            put_columns(posture_out.turn, link, inside_cone(skel.balls, link, columns(posture_out.turn, link)))


CHAINS_HIT: Final = 0
AVATARS_HIT: Final = 1
EVERYTHING: Final = 2
"""Links that are walked back, the least first: the chains that overlap, their whole avatars, all that moved in this frame."""


@kernel
def choose_links(
    chains: Chains, hit: NDArray[np.bool_], first_link: int, level: int, chosen_out: NDArray[np.bool_]
) -> None:
    """Mark the links that are walked back at this level, from the bodies that are ``hit``; earlier marks stay."""
    nl = chosen_out.shape[0]
    if level == CHAINS_HIT:
        chosen_out[:] = False
        for c in range(chains.first.shape[0] - 1):
            caught = False
            for at in range(chains.first[c], chains.first[c + 1]):
                caught = caught or hit[first_link + chains.link[at]]
            for at in range(chains.first[c], chains.first[c + 1]):
                chosen_out[chains.link[at]] = chosen_out[chains.link[at]] or caught
        return
    for link in range(nl):
        if level == EVERYTHING:
            chosen_out[link] = True
        elif hit[first_link + link] or chosen_out[link]:
            for other in range(nl):
                chosen_out[other] = chosen_out[other] or chains.root[other] == chains.root[link]


@kernel
def walk_back(
    geo: Geometry, skel: Skeleton, precision: float, posture_out: Posture, poses_out: Poses, memory_out: PaperMemory
) -> None:
    """Show the state farthest from the last checked one that bisection finds free, walking back as few links as will do.

    ``memory.present`` and ``memory.end`` hold the state that overlaps. First each level is tried at the checked state itself;
    the first one that is free there is bisected to ``precision``, a share of the way. If even the checked state of everything
    is not free (something else moved into it), it is shown all the same and START_OVERLAPS is counted.
    """
    m = memory_out
    m.counts[WALKED_BACK] += 1
    level, fraction, low, high, found_level, last = CHAINS_HIT, 0.0, 0.0, 1.0, False, False
    choose_links(m.chains, m.overlaps.hit, skel.first, level, m.chosen)
    while True:
        interpolate(skel, m.checked, m.present, fraction, m.chosen, posture_out)
        if fraction > 0.0:
            # not at 0: the last checked state is shown again bit for bit
            into_limits(skel, posture_out)
        m.counts[FORWARDS] += 1
        forward(geo, skel, posture_out, m.none, poses_out, m.axes)
        for body in range(skel.first):
            if level == EVERYTHING and m.given_way[body]:
                start, motion = row(m.start, body), sub(row(m.end, body), row(m.start, body))
                put_row(poses_out.position, body, start if fraction == 0.0 else along(start, fraction, motion))
                place(geo, poses_out, body)
                # at its start pose, which is the upper loop's, its own pairs are not checked
                answer_for(body, fraction > 0.0, m.overlaps)
        if last:
            # the same bits as when they were found free
            m.counts[HELD] += 1 if low == 0.0 else 0
            return
        m.counts[WALK_TESTS] += 1
        is_free = find_overlaps(geo, poses_out, m.overlaps) == 0
        if found_level:
            low, high = narrowed(low, high, is_free)
        elif is_free:
            found_level = True
        elif level == EVERYTHING:
            m.counts[START_OVERLAPS] += 1
            m.counts[HELD] += 1
            return
        else:
            level += 1
            choose_links(m.chains, m.overlaps.hit, skel.first, level, m.chosen)
            continue
        last = high - low <= precision
        fraction = low if last else 0.5 * (low + high)
