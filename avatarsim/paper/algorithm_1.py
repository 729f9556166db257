"""Lower loop of Schmidl and Lin 2004 (Figure 3, Algorithm 1): attract joints, push bodies apart, adjust joints by CCD, walk back.

Every shown state has been checked: `find_overlaps` computed the signed distance of each wanted pair with a link (or with a
simulated body that was pushed) and found none below zero. So a shown state has no overlap, provided that the frame began without.
The motion between two shown states is not checked: a limb may pass through a thin obstacle, as stated in the paper's conclusion.
"""

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.scratch import Scratch
from avatarsim.collision.status import CANCELLING, CONVERGED
from avatarsim.jit.by_reference import refer
from avatarsim.jit.kernel import kernel
from avatarsim.model.dynamics import SIMULATED
from avatarsim.model.geometry import Geometry, Poses, place
from avatarsim.model.skeleton import FREE, Posture, Skeleton, forward
from avatarsim.paper.attraction import attract, couple_roots, settle_roots, share_of_distance
from avatarsim.paper.ccd_ik import REACHED, free_link, joints_of, link_contacts
from avatarsim.paper.push_apart import DOUBTED, NOT_CHECKED, QUERIED, answer_for, find_overlaps, push_apart, shares
from avatarsim.paper.state import (
    BAD,
    BENT,
    CANCELLED,
    FORWARDS,
    GAVE_WAY,
    ITERATIONS,
    JOINTS,
    NOT_REACHED,
    OUT_OF_ROUNDS,
    PAIRS,
    PARALLEL,
    PUSHES,
    QUERIES,
    ROUNDS,
    SWEEPS,
    UNCHECKED,
    Chains,
    PaperMemory,
    shuffle,
)
from avatarsim.paper.walk_back import walk_back
from avatarsim.settings import AttractionSettings, CouplingSettings, PaperSettings
from avatarsim.spatial.vec3 import Rows, add, dot, put_row, row


@kernel
def may_translate(skel: Skeleton, chains: Chains, body: int, must: bool) -> bool:
    """Return True if a body may be pushed: a trunk link under a free root always, a limb's link not before ``must``."""
    if body < skel.first:
        return True
    link = body - skel.first
    return (chains.trunk[link] or must) and skel.kind[chains.root[link]] == FREE


@kernel
def push_bodies(
    geo: Geometry, skel: Skeleton, found: int, must: bool, stand_off: float, posture_out: Posture, poses_out: Poses,
    memory_out: PaperMemory,
) -> None:
    """Push overlapping pairs apart by translation; pairs of links of one avatar are left to the chains.

    A push of a link moves its whole avatar. ``must``: also for links of limbs that CCD could not free, and of simulated bodies.
    """
    m, chains = memory_out, memory_out.chains
    for k in range(found):
        a, b = m.overlaps.found[k, 0], m.overlaps.found[k, 1]
        if a >= skel.first and chains.root[a - skel.first] == chains.root[b - skel.first]:
            continue
        both = may_translate(skel, chains, a, must) and may_translate(skel, chains, b, must)
        if not both and not (must and (m.role[a] == SIMULATED or m.role[b] == SIMULATED)):
            continue
        share_a, share_b = shares(m.role[a], m.role[b], must)
        status, by_a, by_b = push_apart(geo, poses_out, a, b, share_a, share_b, stand_off, m.overlaps.scratch)
        if status == CANCELLING:
            m.counts[CANCELLED] += 1
        linked = False
        for side in range(2):
            body, by = (a, by_a) if side == 0 else (b, by_b)
            if not (dot(by, by) > 0.0):
                continue
            m.counts[PUSHES] += 1
            if body >= skel.first:
                root = chains.root[body - skel.first]
                put_row(posture_out.root, root, add(row(posture_out.root, root), by))
                linked = True
            else:
                put_row(poses_out.position, body, add(row(poses_out.position, body), by))
                place(geo, poses_out, body)
                m.counts[GAVE_WAY] += 1
                m.given_way[body] = True
                answer_for(body, True, m.overlaps)
        if linked:
            m.counts[FORWARDS] += 1
            forward(geo, skel, posture_out, m.none, poses_out, m.axes)


@kernel
def treat_chain(
    geo: Geometry, skel: Skeleton, chains: Chains, chain: int, settings: PaperSettings, posture_out: Posture, poses_out: Poses,
    axes_out: Rows, points_out: Rows, scratch: Scratch, counts_out: NDArray[np.int64],
) -> bool:
    """Treat one goal for one chain: the first link from the trunk that overlaps is taken out by the joints inward of it.

    Returns whether the posture changed; poses are then right for the chain's joints only.
    """
    first = chains.first[chain]
    for at in range(first, chains.first[chain + 1]):
        link = chains.link[at]
        _, contacts, queries = link_contacts(geo, poses_out, skel.first + link, points_out, scratch)
        counts_out[QUERIES] += queries
        joints = joints_of(skel, chains.link, first, at)
        if contacts == 0 or joints == 0:
            continue
        status, outcome, sweeps, parallel, bent = free_link(
            skel, chains.link, first, at, row(chains.limb, link), points_out, contacts, settings,
            posture_out, poses_out, axes_out, scratch,
        )
        if status != CONVERGED:
            counts_out[CANCELLED] += 1
            return False
        counts_out[ITERATIONS] += 1
        counts_out[JOINTS] += joints
        counts_out[SWEEPS] += sweeps
        counts_out[PARALLEL] += 1 if parallel else 0
        counts_out[BENT] += 1 if bent else 0
        counts_out[NOT_REACHED] += 1 if outcome != REACHED else 0
        return True
    return False


@kernel
def is_caught(chains: Chains, chain: int, hit: NDArray[np.bool_], first_link: int) -> bool:
    """Return True if a link of the chain was found overlapping."""
    for at in range(chains.first[chain], chains.first[chain + 1]):
        if hit[first_link + chains.link[at]]:
            return True
    return False


@kernel
def copy_posture(posture: Posture, posture_out: Posture) -> None:
    """Copy all of a posture."""
    for link in range(posture.root.shape[0]):
        for i in range(3):
            posture_out.root[link, i] = posture.root[link, i]
            for k in range(3):
                posture_out.turn[link, i, k] = posture.turn[link, i, k]
    for j in range(posture.angle.shape[0]):
        posture_out.angle[j] = posture.angle[j]


@kernel
def copy_places(positions: Rows, count: int, places_out: Rows) -> None:
    """Copy the first ``count`` positions."""
    for body in range(count):
        put_row(places_out, body, row(positions, body))


@kernel
def follow_as_printed(
    geo: Geometry, skel: Skeleton, tracker: Posture, dt: float, settings: PaperSettings, coupling: CouplingSettings,
    attraction: AttractionSettings, posture_out: Posture, poses_out: Poses, memory_out: PaperMemory,
) -> None:
    """Pass a frame of ``dt`` seconds: posture and poses follow the tracker as far as overlap removal permits.

    Bodies that are no links are obstacles; simulated ones are pushed only where driven ones could not be freed of them. Counts
    and statuses are in ``memory_out.counts`` (`state.COUNT_NAMES`, `STATUS_NAMES`).
    """
    geo, skel, tracker, settings, coupling = refer(geo), refer(skel), refer(tracker), refer(settings), refer(coupling)
    attraction, posture_out, poses_out = refer(attraction), refer(posture_out), refer(poses_out)
    memory_out = refer(memory_out)
    m, counts = memory_out, memory_out.counts
    counts[:] = 0
    m.overlaps.tally[:] = 0
    for body in range(skel.first):
        if m.given_way[body]:
            m.given_way[body] = False
            answer_for(body, False, m.overlaps)
    copy_places(poses_out.position, skel.first, m.start)
    copy_posture(posture_out, m.checked)
    copy_posture(tracker, m.target)
    shuffle(m.random, m.order)
    couple_roots(
        skel.kind, tracker.root, m.tracked, posture_out.root, m.mass, dt, coupling, settings.couple, m.velocity, m.target.root
    )
    attract(skel, m.target, share_of_distance(attraction.rate, dt), posture_out)
    moved, found, turn = True, 0, 0
    while True:
        if moved:
            counts[FORWARDS] += 1
            forward(geo, skel, posture_out, m.none, poses_out, m.axes)
        found = find_overlaps(geo, poses_out, m.overlaps)
        if found <= 0 or turn == settings.rounds:
            break
        counts[ROUNDS] += 1
        counts[PAIRS] += found
        push_bodies(geo, skel, found, turn >= settings.patience, settings.stand_off, posture_out, poses_out, memory_out)
        moved = False
        for k in range(m.order.shape[0]):
            if is_caught(m.chains, m.order[k], m.overlaps.hit, skel.first):
                if moved:
                    # another chain moved: its vertices may overlap this one
                    counts[FORWARDS] += 1
                    forward(geo, skel, posture_out, m.none, poses_out, m.axes)
                moved = treat_chain(
                    geo, skel, m.chains, m.order[k], settings, posture_out, poses_out, m.axes, m.points, m.overlaps.scratch,
                    counts,
                )
        turn += 1
    if found != 0:
        counts[UNCHECKED if found == NOT_CHECKED else OUT_OF_ROUNDS] += 1
        copy_posture(posture_out, m.present)
        copy_places(poses_out.position, skel.first, m.end)
        walk_back(geo, skel, settings.walk_back, posture_out, poses_out, memory_out)
    settle_roots(skel.kind, tracker.root, m.target.root, m.checked.root, posture_out.root, dt, m.velocity, m.tracked)
    counts[QUERIES] += m.overlaps.tally[QUERIED]
    counts[BAD] += m.overlaps.tally[DOUBTED]
