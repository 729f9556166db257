"""The measure of nearness against dense algebra and against differences of the measure itself."""

from dataclasses import replace

import numpy as np
import pytest

from avatarsim.engine import Settings
from avatarsim.posture.closeness import couple, gain_of, locate, merit_of, solve
from avatarsim.posture.goal import aim, clip_to_limits, farthest, want
from avatarsim.posture.kinematics import forward, take
from avatarsim.posture.workspace import BEST, BEYOND, LOCATED, Closeness
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.joint import Free, Rigid
from avatarsim.scene.mass import solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Piece, Sphere
from avatarsim.scene.tracker import rest
from avatarsim.simulator import AvatarsimEngine
from avatarsim.world.skeleton import FREE, HINGES, Posture
from avatarsim.world.world import posture_of
from tests.posture.little_worlds import SETTINGS, Little, at, little, mixed_avatar, panel, random_sample
from tests.stability.hostile import DT

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]
SCENE = Scene("s", (), (mixed_avatar(), replace(mixed_avatar(), name="n")))


def towards(seed: int, far: float = 1e9) -> Little:
    """A world whose goal is a random posture, limits or not, a little away, with everything about it known."""
    found = little(SCENE)
    skel, posture = found.world.skeleton, found.world.posture
    start = posture_of(skel, found.world.hinges, random_sample(SCENE.avatars, seed))
    for mine, other in zip(posture, start, strict=True):
        mine[:] = other
    # inside, so that small steps both ways are taken whole
    posture.angle[:] = np.clip(posture.angle, skel.limits[:, 0] + 0.2, skel.limits[:, 1] - 0.2)
    c = found.memory.goal.closeness
    c.turn_weight[c.turn_weight > 0.0] = 0.07
    c.far[0] = far
    stand(found)
    target = Posture(*(array.copy() for array in posture))
    take(skel, target, np.random.default_rng(seed + 50).normal(0.0, 0.15, len(c.pull)))
    for mine, other in zip(found.memory.goal.tracker, target, strict=True):
        mine[:] = other
    locate(skel, target, c)
    c.mode[LOCATED] = 1.0
    aim(skel, posture, SETTINGS, found.memory.goal)
    return found


def stand(found: Little) -> None:
    """Forward kinematics of the posture: axes, and where its link origins are."""
    geo, skel, posture, poses = found.parts
    found.memory.rows.x[:] = 0.0
    forward(geo, skel, posture, found.memory.rows.x, poses, found.memory.axes)
    found.memory.goal.closeness.here[:] = poses.position[skel.first :]


def merit_after(found: Little, step: np.ndarray) -> float:
    """The measure after a step, by forward kinematics."""
    skel, posture = found.world.skeleton, found.world.posture
    kept = [array.copy() for array in posture]
    take(skel, posture, step)
    stand(found)
    aim(skel, posture, SETTINGS, found.memory.goal)
    value = merit_of(found.memory.goal.closeness, found.memory.goal.closeness.here, found.memory.goal.wanted)
    for mine, other in zip(posture, kept, strict=True):
        mine[:] = other
    stand(found)
    aim(skel, posture, SETTINGS, found.memory.goal)
    return value


def dense(found: Little) -> np.ndarray:
    """J^T J of all link origins, pulls beyond `far` weaker, plus weights of angles on the diagonal: M without what bends it."""
    skel, c, nd = found.world.skeleton, found.memory.goal.closeness, len(found.memory.goal.closeness.pull)
    total = np.diag(c.turn_weight)
    for link in range(len(skel.kind)):
        rates = np.zeros((3, nd))
        for j in range(nd):
            m = int(np.searchsorted(skel.first_dof, j, side="right")) - 1
            if skel.related[link, m]:
                shift = skel.kind[m] == FREE and j < skel.first_dof[m] + 3
                axis = found.memory.axes[j]
                rates[:, j] = axis if shift else np.cross(axis, c.here[link] - c.here[m])
        total += rates.T @ rates * min(1.0, c.far[0] / np.linalg.norm(c.there[link] - c.here[link]))
    return total


def factored(c: Closeness) -> np.ndarray:
    """M as the factor has it."""
    lower = np.zeros((len(c.depth), len(c.depth)))
    for j, deep in enumerate(c.depth):
        lower[j, c.path[j, : deep + 1]] = c.factor[j, : deep + 1]
    return lower.T @ lower


@pytest.mark.parametrize("seed", range(5))
def test_origins_are_those_of_forward_kinematics(seed: int) -> None:
    found = towards(seed)
    c = found.memory.goal.closeness
    locate(found.world.skeleton, found.world.posture, c)
    assert c.there == pytest.approx(c.here, abs=1e-12)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("far", [1e9, 0.05])
def test_the_factor_is_that_of_the_dense_matrix_and_what_bends_up_joins_the_diagonal(seed: int, far: float) -> None:
    found = towards(seed, far)
    c = found.memory.goal.closeness
    couple(found.world.skeleton, found.memory.axes, found.memory.goal.wanted, c)
    more = factored(c) - dense(found)
    assert more - np.diag(np.diag(more)) == pytest.approx(0.0, abs=1e-10)
    assert (np.diag(more) >= -1e-10).all() and np.diag(more).max() > 1e-3


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("far", [1e9, 0.05])
def test_the_pull_is_down_the_slope_of_the_measure(seed: int, far: float) -> None:
    found = towards(seed, far)
    c = found.memory.goal.closeness
    couple(found.world.skeleton, found.memory.axes, found.memory.goal.wanted, c)
    slope = factored(c) @ c.pull
    for j, h in enumerate(np.eye(len(slope)) * 1e-6):
        assert (merit_after(found, -h) - merit_after(found, h)) / 2e-6 == pytest.approx(slope[j], abs=1e-5)


@pytest.mark.parametrize("seed", range(3))
def test_solve_and_gain_beside_dense_algebra(seed: int) -> None:
    found = towards(seed)
    c, rng = found.memory.goal.closeness, np.random.default_rng(seed)
    couple(found.world.skeleton, found.memory.axes, found.memory.goal.wanted, c)
    whole, vector = factored(c), rng.normal(size=len(c.pull))
    solved = vector.copy()
    solve(c, solved)
    assert whole @ solved == pytest.approx(vector, abs=1e-10)
    gain, square = gain_of(c, c.pull, vector)
    assert square == pytest.approx(vector @ whole @ vector) and gain == pytest.approx(vector @ whole @ (c.pull - 0.5 * vector))


@pytest.mark.parametrize("seed", range(5))
def test_a_tracker_beyond_its_limits_is_measured_as_it_is(seed: int) -> None:
    """The goal is at the limit, the wish beyond; `farthest` says that nothing is left where no posture inside was nearer."""
    found = little(SCENE)
    skel, posture, goal = found.world.skeleton, found.world.posture, found.memory.goal
    tracker = posture_of(skel, found.world.hinges, at(rest(SCENE.avatars), (0.0, 0.0, 0.0)))
    clip_to_limits(skel, tracker, goal)
    assert goal.closeness.mode[BEYOND] == 0.0
    hinge = int(np.flatnonzero(skel.limits[:, 1] < 100.0)[seed % 3])
    tracker.angle[hinge] = skel.limits[hinge, 1] + 0.4
    clip_to_limits(skel, tracker, goal)
    assert goal.tracker.angle[hinge] == skel.limits[hinge, 1]
    # the mean square over hinges and links that have none
    joints = int((skel.kind != HINGES).sum() + np.diff(skel.first_dof)[skel.kind == HINGES].sum())
    assert goal.closeness.mode[BEYOND] == pytest.approx(0.4**2 / joints)
    # shown: the tracker's posture with each joint clipped
    for mine, inside in zip(posture, goal.tracker, strict=True):
        mine[:] = inside
    posture.root[0] += 0.3
    stand(found)
    aim(skel, posture, SETTINGS, goal)
    want(skel, posture, goal)
    assert goal.wanted[hinge] == pytest.approx(0.4) and goal.full[hinge] == 0.0
    # until somebody has asked how near the posture inside is, the way there counts
    assert farthest(goal) == pytest.approx(0.3)
    locate(skel, goal.own, goal.closeness)
    here = merit_of(goal.closeness, goal.closeness.here, goal.wanted)
    goal.closeness.mode[BEST] = 0.5 * here
    assert farthest(goal) == pytest.approx(0.3)
    # a shown posture nearer to the tracker's own than the clipped one has nothing left to go
    goal.closeness.mode[BEST] = 2.0 * here
    assert farthest(goal) == 0.0


def test_an_excess_that_is_rounded_away_when_squared_is_one() -> None:
    found = little(SCENE)
    skel, goal = found.world.skeleton, found.memory.goal
    tracker = posture_of(skel, found.world.hinges, at(rest(SCENE.avatars), (0.0, 0.0, 0.0)))
    hinge = int(np.flatnonzero(skel.limits[:, 1] < 100.0)[0])
    tracker.angle[hinge] = np.nextafter(skel.limits[hinge, 1], np.inf)
    clip_to_limits(skel, tracker, goal)
    assert goal.closeness.mode[BEYOND] > 0.0


def test_a_far_origin_counts_by_its_distance_and_not_by_the_square() -> None:
    c = little(SCENE).memory.goal.closeness
    c.far[0], c.there[:] = 0.2, c.here
    c.there[0, 0] += 5.0
    assert merit_of(c, c.here, np.zeros(len(c.pull))) == pytest.approx(0.2 * (5.0 - 0.1))


@pytest.mark.boundscheck
@pytest.mark.nojit
def test_a_rigid_link_at_the_end_asks_for_no_angle_of_a_root() -> None:
    """Nobody has joints, so roots turn less readily; a link that has no degrees at all has no turn to ask for."""
    ball = (Piece(Sphere(0.05)),)
    end = Link("end", "root", Rigid(), ball, solid(ball, 1.0), anchor=(0.2, 0.0, 0.0))
    hand = Avatar("hand", (Link("root", None, Free(), ball, solid(ball, 1.0)), end))
    scene = Scene("s", (panel(x=1.0),), (hand,), start=at(rest((hand,)), (0.0, 0.0, 0.0)))
    engine = AvatarsimEngine()
    engine.load(scene, Settings(), DT)
    for k in range(30):
        record = engine.advance(at(scene.first_sample, (0.05 * k, 0.0, 0.0)), DT)
    assert record.shown.positions[2, 0] == pytest.approx(1.0 - 0.05, abs=2e-3)
