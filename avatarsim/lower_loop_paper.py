"""The lower loop of the paper's Figure 3, method `paper`: attract, push out, adjust joints, and walk back what is left.

Every shown state has been checked: `find_overlaps` asked for the signed distance of each wanted pair with a link (or with a
body that gave way) in it and found none below zero. So what is shown never overlaps, provided that the frame began free. That
is all: nothing is known of the way between two shown states, and a limb may jump through what is thin, as the paper admits.
"""

from avatarsim.collide.status import CANCELLING, CONVERGED
from avatarsim.kernel import kernel
from avatarsim.lower_loop_memory import (
    BAD,
    BENT,
    CANCELLED,
    FORWARDS,
    GAVE_WAY,
    HELD,
    ITERATIONS,
    JOINTS,
    NOT_REACHED,
    OUT_OF_ROUNDS,
    PAIRS,
    PARALLEL,
    PUSHES,
    QUERIES,
    ROUNDS,
    START_OVERLAPS,
    SWEEPS,
    UNCHECKED,
    WALK_TESTS,
    WALKED_BACK,
    PaperMemory,
)
from avatarsim.lower_loop_roots import couple_roots, settle_roots
from avatarsim.posture.attraction import attract, share_of_way
from avatarsim.posture.chain import shuffle
from avatarsim.posture.cyclic_coordinate_descent import REACHED, joints_of
from avatarsim.posture.free_link import free_link, link_contacts
from avatarsim.posture.into_limits import into_limits
from avatarsim.posture.kinematics import forward
from avatarsim.posture.paper_settings import PaperSettings
from avatarsim.separate.overlaps import ASKED, DOUBTED, NOT_CHECKED, answer_for, find_overlaps
from avatarsim.separate.push_apart import push_apart
from avatarsim.separate.walk_back import interpolate, narrowed
from avatarsim.separate.who_gives_way import SIMULATED, shares
from avatarsim.settings import AttractionSettings, CouplingSettings
from avatarsim.spatial.vec3 import Vec3, add, along, put_row, row, sub
from avatarsim.world.geometry import Geometry, Poses, place
from avatarsim.world.skeleton import FREE, Posture, Skeleton

CHAINS_HIT, AVATARS_HIT, EVERYTHING = range(3)
"""What is walked back, the least first: the chains that overlap, their whole avatars, all that moved in this frame."""


@kernel
def place_links(geo: Geometry, skel: Skeleton, posture: Posture, poses_out: Poses, memory_out: PaperMemory) -> None:
    """Carry all links to ``posture``."""
    memory_out.counts[FORWARDS] += 1
    forward(geo, skel, posture, memory_out.none, poses_out, memory_out.axes)


@kernel
def may_translate(skel: Skeleton, body: int, must: bool, memory: PaperMemory) -> bool:
    """Whether a body may be pushed: a trunk link under a free root always, a limb's link not before ``must``."""
    if body < skel.first:
        return True
    link = body - skel.first
    return (memory.chains.trunk[link] or must) and skel.kind[memory.chains.root[link]] == FREE


@kernel
def move_body(
    geo: Geometry, skel: Skeleton, body: int, by: Vec3, posture_out: Posture, poses_out: Poses, memory_out: PaperMemory
) -> None:
    """Translate a simulated body, or the whole avatar of a link, by ``by`` [m]; a body stays if by is zero."""
    if by[0] == 0.0 and by[1] == 0.0 and by[2] == 0.0:
        return
    memory_out.counts[PUSHES] += 1
    if body < skel.first:
        put_row(poses_out.position, body, add(row(poses_out.position, body), by))
        place(geo, poses_out, body)
        memory_out.counts[GAVE_WAY] += 1
        memory_out.given_way[body] = True
        answer_for(geo, body, skel.first, True, memory_out.overlaps)
        return
    root = memory_out.chains.root[body - skel.first]
    put_row(posture_out.root, root, add(row(posture_out.root, root), by))
    place_links(geo, skel, posture_out, poses_out, memory_out)


@kernel
def push_bodies(
    geo: Geometry, skel: Skeleton, found: int, must: bool, settings: PaperSettings, posture_out: Posture, poses_out: Poses,
    memory_out: PaperMemory,
) -> None:
    """Push the overlapping pairs apart that translation can part; pairs of links of one avatar are left to the chains."""
    pairs = memory_out.overlaps.found
    for k in range(found):
        a, b = pairs[k, 0], pairs[k, 1]
        if a >= skel.first and memory_out.chains.root[a - skel.first] == memory_out.chains.root[b - skel.first]:
            continue
        both = may_translate(skel, a, must, memory_out) and may_translate(skel, b, must, memory_out)
        if not both and not (must and (memory_out.role[a] == SIMULATED or memory_out.role[b] == SIMULATED)):
            continue
        share_a, share_b = shares(memory_out.role[a], memory_out.role[b], must)
        status, by_a, by_b = push_apart(
            geo, poses_out, a, b, share_a, share_b, settings.stand_off, memory_out.overlaps.scratch
        )
        if status == CANCELLING:
            memory_out.counts[CANCELLED] += 1
        move_body(geo, skel, a, by_a, posture_out, poses_out, memory_out)
        move_body(geo, skel, b, by_b, posture_out, poses_out, memory_out)


@kernel
def treat_chain(
    geo: Geometry, skel: Skeleton, chain: int, settings: PaperSettings, posture_out: Posture, poses_out: Poses,
    memory_out: PaperMemory,
) -> None:
    """One goal for one chain: the first link from the trunk that overlaps is taken out by the joints inward of it."""
    chains, counts, scratch = memory_out.chains, memory_out.counts, memory_out.overlaps.scratch
    first = chains.first[chain]
    for at in range(first, chains.first[chain + 1]):
        link = chains.link[at]
        _, contacts, queries = link_contacts(geo, poses_out, skel.first + link, memory_out.points, scratch)
        counts[QUERIES] += queries
        if contacts == 0:
            continue
        joints = joints_of(skel, chains.link, first, at)
        if joints == 0:
            continue
        status, outcome, sweeps, parallel, bent = free_link(
            skel, chains.link, first, at, row(chains.limb, link), memory_out.points, contacts, settings,
            posture_out, poses_out, memory_out.axes, scratch,
        )
        if status != CONVERGED:
            counts[CANCELLED] += 1
            return
        counts[ITERATIONS] += 1
        counts[JOINTS] += joints
        counts[SWEEPS] += sweeps
        counts[PARALLEL] += 1 if parallel else 0
        counts[BENT] += 1 if bent else 0
        counts[NOT_REACHED] += 1 if outcome != REACHED else 0
        place_links(geo, skel, posture_out, poses_out, memory_out)
        return


@kernel
def free_chains(
    geo: Geometry, skel: Skeleton, settings: PaperSettings, posture_out: Posture, poses_out: Poses, memory_out: PaperMemory
) -> None:
    """Every chain that has an overlapping link gets one goal, in this frame's random order."""
    chains = memory_out.chains
    for k in range(memory_out.order.shape[0]):
        chain = memory_out.order[k]
        caught = False
        for at in range(chains.first[chain], chains.first[chain + 1]):
            caught = caught or memory_out.overlaps.hit[skel.first + chains.link[at]]
        if caught:
            treat_chain(geo, skel, chain, settings, posture_out, poses_out, memory_out)


@kernel
def choose_links(skel: Skeleton, level: int, memory_out: PaperMemory) -> None:
    """Mark the links that are walked back at this level; marks of earlier levels stay."""
    chains, hit, chosen = memory_out.chains, memory_out.overlaps.hit, memory_out.chosen
    if level == CHAINS_HIT:
        for c in range(chains.first.shape[0] - 1):
            caught = False
            for at in range(chains.first[c], chains.first[c + 1]):
                caught = caught or hit[skel.first + chains.link[at]]
            for at in range(chains.first[c], chains.first[c + 1]):
                chosen[chains.link[at]] = chosen[chains.link[at]] or caught
        return
    for link in range(skel.kind.shape[0]):
        if level == EVERYTHING:
            chosen[link] = True
        elif hit[skel.first + link] or chosen[link]:
            for other in range(skel.kind.shape[0]):
                chosen[other] = chosen[other] or chains.root[other] == chains.root[link]


@kernel
def show(
    geo: Geometry, skel: Skeleton, fraction: float, level: int, posture_out: Posture, poses_out: Poses, memory_out: PaperMemory
) -> bool:
    """Show the state at ``fraction`` of the way from the last checked one; whether it is free."""
    m = memory_out
    m.counts[WALK_TESTS] += 1
    interpolate(skel, m.checked, m.present, fraction, m.chosen, posture_out)
    if fraction > 0.0:
        # not at 0: the last checked state is shown again bit for bit
        into_limits(skel, posture_out)
    place_links(geo, skel, posture_out, poses_out, memory_out)
    if level == EVERYTHING:
        for body in range(skel.first):
            if m.given_way[body]:
                start, way = row(m.start, body), sub(row(m.end, body), row(m.start, body))
                put_row(poses_out.position, body, start if fraction == 0.0 else along(start, fraction, way))
                place(geo, poses_out, body)
                # where it began, its own contacts are not this loop's business
                answer_for(geo, body, skel.first, fraction > 0.0, m.overlaps)
    return find_overlaps(geo, poses_out, m.overlaps) == 0


@kernel
def walk_back(
    geo: Geometry, skel: Skeleton, settings: PaperSettings, posture_out: Posture, poses_out: Poses, memory_out: PaperMemory
) -> None:
    """Algorithm 1, step 4: back towards the last checked state, as little as bisection finds, as few links as will do."""
    m = memory_out
    m.counts[WALKED_BACK] += 1
    copy_posture(posture_out, m.present)
    for body in range(skel.first):
        put_row(m.end, body, row(poses_out.position, body))
    m.chosen[:] = False
    for level in range(EVERYTHING + 1):
        choose_links(skel, level, memory_out)
        if show(geo, skel, 0.0, level, posture_out, poses_out, memory_out):
            low, high = 0.0, 1.0
            while high - low > settings.walk_back:
                is_free = show(geo, skel, 0.5 * (low + high), level, posture_out, poses_out, memory_out)
                low, high = narrowed(low, high, is_free)
            # the same bits as when it was found free
            show(geo, skel, low, level, posture_out, poses_out, memory_out)
            m.counts[HELD] += 1 if low == 0.0 else 0
            return
    m.counts[START_OVERLAPS] += 1


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
def begin_frame(geo: Geometry, skel: Skeleton, tracker: Posture, posture: Posture, poses: Poses, memory_out: PaperMemory) -> None:
    """Remember where everything is, what the tracker wants, and draw the order of the chains."""
    m = memory_out
    m.counts[:] = 0
    m.overlaps.tally[:] = 0
    for body in range(skel.first):
        put_row(m.start, body, row(poses.position, body))
        if m.given_way[body]:
            m.given_way[body] = False
            answer_for(geo, body, skel.first, False, m.overlaps)
    copy_posture(posture, m.checked)
    copy_posture(tracker, m.target)
    shuffle(m.random, m.order)


@kernel
def follow_as_printed(
    geo: Geometry, skel: Skeleton, tracker: Posture, dt: float, settings: PaperSettings, coupling: CouplingSettings,
    attraction: AttractionSettings, posture_out: Posture, poses_out: Poses, memory_out: PaperMemory,
) -> None:
    """One frame of ``dt`` seconds: posture and poses follow the tracker as far as overlap removal lets them.

    Bodies that are no links are obstacles; simulated ones are moved only where driven ones could not part from them. Counts
    and statuses are in ``memory_out.counts`` (`lower_loop_memory.COUNT_NAMES`, `STATUS_NAMES`).
    """
    m, counts = memory_out, memory_out.counts
    begin_frame(geo, skel, tracker, posture_out, poses_out, memory_out)
    couple_roots(skel, tracker, posture_out, dt, coupling, settings.couple, memory_out)
    attract(skel, m.target, share_of_way(attraction.rate, dt), posture_out)
    place_links(geo, skel, posture_out, poses_out, memory_out)
    found = find_overlaps(geo, poses_out, m.overlaps)
    for turn in range(settings.rounds):
        if found <= 0:
            break
        counts[ROUNDS] += 1
        counts[PAIRS] += found
        push_bodies(geo, skel, found, turn >= settings.patience, settings, posture_out, poses_out, memory_out)
        free_chains(geo, skel, settings, posture_out, poses_out, memory_out)
        found = find_overlaps(geo, poses_out, m.overlaps)
    if found != 0:
        counts[UNCHECKED if found == NOT_CHECKED else OUT_OF_ROUNDS] += 1
        walk_back(geo, skel, settings, posture_out, poses_out, memory_out)
    settle_roots(skel, tracker, posture_out, dt, memory_out)
    counts[QUERIES] += m.overlaps.tally[ASKED]
    counts[BAD] += m.overlaps.tally[DOUBTED]
