"""Contact rows: the Jacobian of a pair's gap against finite differences of the signed distance."""

import numpy as np
import pytest

from avatarsim.collision.scratch import make_scratch
from avatarsim.collision.signed_distance import signed_distance
from avatarsim.ik.constraints import IDLE_STEPS, add_touching, keep_touching, touch
from avatarsim.ik.kinematics import try_step
from avatarsim.model.skeleton import Posture
from avatarsim.scene.scene import Scene
from avatarsim.settings import PostureSettings
from tests.ik.solvers import Solver, random_posture, solver_of
from tests.worlds.little_worlds import hand, panel, sliding_avatar

pytestmark = [pytest.mark.boundscheck]
SETTINGS, GAP, THICK = PostureSettings(), 0.004, 0.02
SCRATCH = make_scratch()


def scene(x: float) -> Scene:
    """Return a tree and a hand, and a panel across x."""
    return Scene("s", (panel(THICK, x),), (sliding_avatar(), hand()))


def before_a_panel(seed: int) -> tuple[Solver, list[tuple[int, int]]]:
    """The tree with its foremost piece GAP from a panel, a hand GAP from the tree at its other end; both pairs of pieces."""
    free = solver_of(scene(99.0))
    posture = random_posture(free, seed)
    posture.root[0], posture.root[-1] = (0.0, 0.0, 0.0), (-50.0, 0.0, 0.0)
    free.take(posture)
    geo, skel, poses = free.world.geometry, free.world.skeleton, free.world.poses
    driven, tree = int(geo.first_shape[skel.first]), int(geo.first_shape[skel.first + len(sliding_avatar().links)])
    found = solver_of(scene(float(poses.boxes[driven:tree, 3].max()) + GAP + 0.5 * THICK))
    foremost = driven + int(poses.boxes[driven:tree, 3].argmax())
    other = driven + int(poses.boxes[driven:tree, 0].argmin())
    vertices = poses.vertices[geo.shapes.start[other] : geo.shapes.start[other + 1]]
    last = vertices[vertices[:, 0].argmin()]
    posture.root[-1] = last - [geo.shapes.radius[other] + GAP + 0.05, 0.0, 0.0]
    found.take(Posture(posture.root, posture.turn, posture.angle))
    found.working.swept[0] = found.world.poses.boxes[0]
    return found, [(foremost, 0), (other, tree)]


def distance(found: Solver, vertices: np.ndarray, a: int, b: int) -> float:
    """Return the signed distance [m] of a pair of pieces."""
    return float(signed_distance(vertices, found.world.geometry.shapes, a, b, (0.0, 0.0, 0.0), SCRATCH)[1])


def listed(found: Solver, pairs: list[tuple[int, int]], is_soft: bool = False) -> None:
    """Rows of those pairs."""
    w = found.world
    found.solve_for_all()
    for a, b in pairs:
        touch(a, b, found.state.touching)
    found.state.pairs.step[0] += 1
    add_touching(found.rig, SETTINGS, is_soft, w.poses, found.state, found.working)


@pytest.mark.parametrize("seed", range(6))
def test_a_row_is_the_slope_of_the_gap_in_every_degree(seed: int) -> None:
    found, pairs = before_a_panel(seed)
    listed(found, pairs)
    rows, h, nd = found.working.rows, 1e-6, len(found.avatars.joint_of)
    assert rows.used[0] == 2 and rows.pair[:2].tolist() == [list(pair) for pair in pairs]
    assert rows.owner[:2].tolist() == [[0, -1], [0, 1]]
    wanted = np.zeros((2, nd))
    for j in range(nd):
        for sign in (1.0, -1.0):
            found.working.step[:] = 0.0
            found.working.step[j] = sign * h
            for avatar in range(found.count):
                try_step(found.rig, avatar, found.world.posture, found.working)
            for k, pair in enumerate(pairs):
                wanted[k, j] += sign * distance(found, found.working.trial.vertices, *pair) / (2.0 * h)
    own = found.avatars.first_dof[1]
    assert rows.jacobian[0, :own] == pytest.approx(wanted[0, :own], abs=1e-6) and (np.abs(wanted[0, own:]) < 1e-6).all()
    assert rows.jacobian[1, :nd] == pytest.approx(wanted[1], abs=1e-6)
    for k, pair in enumerate(pairs):
        gap = distance(found, found.world.poses.vertices, *pair)
        assert rows.bound[k] == pytest.approx(min(SETTINGS.stand_off, gap) - gap, abs=1e-9), "it may come as near as stand_off"


def test_a_near_pair_may_stay_and_a_squeezed_one_must_part() -> None:
    for gap, soft, wanted in ((1.5e-4, False, 0.0), (0.6e-4, False, 1.4e-4), (0.6e-4, True, 0.0)):
        found, pairs = before_a_panel(1)
        posture = found.world.posture
        posture.root[0, 0] += GAP - gap
        found.stand()
        listed(found, pairs[:1], soft)
        assert found.working.rows.bound[0] == pytest.approx(wanted, abs=1e-9)


def test_pressing_contacts_are_kept_and_others_forgotten() -> None:
    found, pairs = before_a_panel(2)
    listed(found, pairs)
    found.working.rows.multiplier[:2] = 1.0, 0.0
    for _ in range(IDLE_STEPS + 1):
        kept = found.state.touching.pair[: found.state.touching.used[0]].tolist()
        assert kept == [list(pair) for pair in pairs]
        keep_touching(found.rig, found.state, found.working)
    assert found.state.touching.pair[: found.state.touching.used[0]].tolist() == [list(pairs[0])]
