"""Contact rows against finite differences of the gap."""

import numpy as np
import pytest

from avatarsim.collide.scratch import make_scratch
from avatarsim.collide.signed_distance import signed_distance
from avatarsim.collide.support import gap_along
from avatarsim.posture.certificate import nearest_direction
from avatarsim.posture.contact_row import forget_idle_pairs, list_pair, rows_of_listed, support_row, witness_row
from avatarsim.posture.kinematics import forward, take
from avatarsim.posture.workspace import COUNT, DROPPED, LISTED
from avatarsim.scene.body import fixed
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.world.skeleton import Posture
from tests.posture.little_worlds import SETTINGS, Little, hand_scene, little, mixed_avatar, panel, random_sample

pytestmark = [pytest.mark.boundscheck]
NO_SEED = (0.0, 0.0, 0.0)
H = 1e-6
BLOCK = fixed("block", (Piece(Box((0.5, 0.4, 0.3))),), "wood", (3.0, 1.0, 0.5), (0.5, 0.5, -0.5, 0.5))
BALL = fixed("ball", (Piece(Sphere(0.3)),), "wood", (-2.0, 1.0, 0.5))


def world(seed: int) -> Little:
    """The mixed avatar in a random posture between a block and a ball; pieces 0 and 1 are theirs."""
    avatar = mixed_avatar()
    return little(Scene("s", (BLOCK, BALL), (avatar,), start=random_sample((avatar,), seed)))


def exact_gap(found: Little, a: int, b: int, step: np.ndarray) -> float:
    """Signed distance after a step."""
    geo, skel, posture, _ = found.parts
    trial = found.memory.trial
    forward(geo, skel, posture, step, trial, found.memory.trial_axes)
    return float(signed_distance(trial.vertices, geo.shapes, a, b, NO_SEED, make_scratch())[1])


def differences(gap: object, nd: int) -> np.ndarray:
    """Central differences of a function of the step."""
    return np.array([(gap(H * e) - gap(-H * e)) / (2.0 * H) for e in np.eye(nd)])


# pieces: 0 block, 1 ball, 2 root, 3 a, 4 and 5 b, 6 c, 7 d
@pytest.mark.parametrize("pair", [(2, 0), (3, 0), (4, 0), (5, 0), (6, 0), (7, 1), (6, 1), (6, 2), (7, 3), (7, 6), (5, 2)])
@pytest.mark.parametrize("seed", range(3))
def test_witness_rows_are_the_gradient_of_the_gap(seed: int, pair: tuple[int, int]) -> None:
    found = world(seed)
    geo, skel, _, poses = found.parts
    a, b = pair
    gap, n, simplex = nearest_direction(geo, poses, NO_SEED, a, b, np.inf, found.memory)
    if not gap > 1e-3:
        pytest.fail("the posture of this seed overlaps: choose another")
    rows, nd = found.memory.rows, len(found.memory.rows.x)
    rows.size[:] = 0
    witness_row(geo, skel, a, b, n, gap, 0.25, simplex, poses, found.memory.axes, rows.here, found.memory)
    assert rows.size[COUNT] == 1 and rows.pair[0].tolist() == [a, b]
    assert gap == pytest.approx(exact_gap(found, a, b, np.zeros(nd)), abs=1e-12)
    assert rows.jacobian[0] == pytest.approx(differences(lambda x: exact_gap(found, a, b, x), nd), abs=2e-5)
    assert rows.bound[0] == pytest.approx(0.25 - gap)


@pytest.mark.parametrize("seed", range(3))
def test_support_rows_are_the_gradient_along_their_direction_at_the_trial(seed: int) -> None:
    found = world(seed)
    geo, skel, posture, _ = found.parts
    rows, nd, trial = found.memory.rows, len(found.memory.rows.x), found.memory.trial
    rng = np.random.default_rng(seed)
    n = rng.normal(size=3)
    n = tuple(float(v) for v in n / np.linalg.norm(n))
    step = 0.3 * rng.normal(size=nd)

    def along_n(x: np.ndarray) -> float:
        forward(geo, skel, posture, step, trial, found.memory.trial_axes)
        # rates at the trial: the trial becomes the posture, displaced by x

        moved = Posture(*(array.copy() for array in posture))
        take(skel, moved, step)
        forward(geo, skel, moved, x, trial, found.memory.trial_axes)
        return float(gap_along(trial.vertices, geo.shapes, 6, 0, n))

    rates = differences(along_n, nd)
    gap = along_n(np.zeros(nd))
    rows.x[:] = step
    rows.size[:] = 0
    forward(geo, skel, posture, step, trial, found.memory.trial_axes)
    support_row(geo, skel, 6, 0, n, 0.1, found.memory)
    assert rows.jacobian[0] == pytest.approx(rates, abs=1e-5)
    # the condition is on the whole step: J (x - step) >= wanted - gap
    assert rows.bound[0] - rows.jacobian[0] @ step == pytest.approx(0.1 - gap, abs=1e-9)


def test_a_full_table_counts_what_it_drops() -> None:
    found = world(0)
    geo, skel, _, poses = found.parts
    rows = found.memory.rows
    rows.size[COUNT] = len(rows.bound)
    gap, n, simplex = nearest_direction(geo, poses, NO_SEED, 6, 0, np.inf, found.memory)
    witness_row(geo, skel, 6, 0, n, gap, 0.1, simplex, poses, found.memory.axes, rows.here, found.memory)
    assert rows.size[COUNT] == len(rows.bound) and found.memory.counts[DROPPED] == 1


def test_pairs_are_listed_once_and_forgotten_when_idle() -> None:
    found = world(0)
    first = int(found.world.geometry.first_shape[found.world.skeleton.first])
    pairs = found.memory.pairs
    for _ in range(3):
        list_pair(6, 0, first, found.memory)
        list_pair(7, 1, first, found.memory)
    assert pairs.marks[LISTED] == 2
    forget_idle_pairs(first, 1, found.memory)
    list_pair(7, 1, first, found.memory)
    forget_idle_pairs(first, 1, found.memory)
    assert pairs.marks[LISTED] == 1 and pairs.listed[0].tolist() == [7, 1]
    assert pairs.active.sum() == 1
    list_pair(6, 0, first, found.memory)
    assert pairs.marks[LISTED] == 2


def test_a_full_list_takes_no_more() -> None:
    found = world(0)
    first = int(found.world.geometry.first_shape[found.world.skeleton.first])
    pairs = found.memory.pairs
    pairs.marks[LISTED] = len(pairs.listed)
    list_pair(6, 0, first, found.memory)
    assert pairs.marks[LISTED] == len(pairs.listed) and not pairs.active.any()


@pytest.mark.parametrize("gap", [1e-6, 5e-5, 1.5e-4, 1e-3])
def test_standing_still_obeys_every_row_of_pairs_that_are_not_squeezed(gap: float) -> None:
    """Right-hand sides are at most 0 for gaps above twice the least; closer pairs are asked back to the stand-off."""
    found = little(hand_scene((-0.051 - gap, 0.0, 0.0), panel()))
    geo, skel, _, poses = found.parts
    list_pair(1, 0, 1, found.memory)
    rows_of_listed(geo, skel, poses, SETTINGS, found.memory)
    assert found.memory.rows.size[COUNT] == 1
    bound = found.memory.rows.bound[0]
    if gap > 2.0 * SETTINGS.least_gap:
        assert bound == pytest.approx(min(SETTINGS.stand_off, gap) - gap, abs=1e-12) and bound <= 0.0
    else:
        assert bound == pytest.approx(SETTINGS.stand_off - gap, abs=1e-12)
