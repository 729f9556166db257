"""Rows of balls beyond their limits: the slope of what is broken, and the place where a wanted step meets the limits."""

import numpy as np
import pytest

from avatarsim.posture.limit_row import beyond_limits
from avatarsim.posture.limits import swing_and_twist
from avatarsim.posture.wanted_step import FIRST_PART, keep_limits
from avatarsim.posture.workspace import ADDING, COUNT
from avatarsim.scene.scene import Scene
from avatarsim.spatial import rotation
from avatarsim.spatial.tangent import columns, stepped
from tests.posture.little_worlds import LIMITS, Little, little, mixed_avatar

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]

SCENE, BALL_LINK, SMALL = Scene("s", (), (mixed_avatar(),)), 1, 1e-6
WHERE = pytest.mark.parametrize("seed", range(20))


def world(seed: int, swing: float) -> tuple[Little, int, np.random.Generator]:
    """A ball swung by `swing` [rad] from the middle of its cone, and its first degree of freedom."""
    rng, found = np.random.default_rng(seed), little(SCENE)
    _, skel, posture, _ = found.parts
    centre = skel.cone[BALL_LINK, 3:6]
    axis = np.cross(centre, rng.normal(size=3))
    shortest = rotation.to_matrix(rotation.between(skel.cone[BALL_LINK, :3], centre))
    posture.turn[BALL_LINK] = rotation.to_matrix(rotation.from_rotation_vector(swing * axis / np.linalg.norm(axis))) @ shortest
    return found, int(skel.first_dof[BALL_LINK]), rng


def broken(found: Little, x: np.ndarray) -> np.ndarray:
    """Swing beyond the cone, and twist below and above its range [rad], after a step x (3,)."""
    _, skel, posture, _ = found.parts
    swing, twist, _ = swing_and_twist(skel, BALL_LINK, stepped(columns(posture.turn, BALL_LINK), tuple(x.tolist())))
    return np.array([swing - LIMITS.swing, LIMITS.twist[0] - twist, twist - LIMITS.twist[1]])


@WHERE
def test_a_row_is_the_slope_of_what_the_step_breaks(seed: int) -> None:
    """At the end of a step of 0.35 rad more of the step is not a turn about the axes there: with these the slopes are 0.1 off."""
    found, d, rng = world(seed, 0.7)
    _, skel, posture, _ = found.parts
    rows = found.memory.rows
    x = rng.normal(size=3)
    x *= 0.35 / np.linalg.norm(x)
    rows.x[d : d + 3], found.memory.flags[ADDING] = x, 1.0
    beyond_limits(skel, posture, found.memory)
    over = broken(found, x)
    expected = [k for k in range(3) if over[k] > 0.0]
    assert rows.size[COUNT] == len(expected)
    for row, k in enumerate(expected):
        slope = [(broken(found, x + SMALL * axis)[k] - over[k]) / SMALL for axis in np.eye(3)]
        assert rows.jacobian[row, d : d + 3] == pytest.approx(-np.array(slope), abs=6e-3)


@WHERE
def test_a_limb_on_its_limits_meets_them_where_it_is_and_not_where_the_wanted_step_ends(seed: int) -> None:
    """However far the step goes, the rows are those of its first part."""
    found, d, rng = world(seed, LIMITS.swing - 1e-6)
    _, skel, posture, _ = found.parts
    memory, normals = found.memory, []
    while True:
        way = rng.normal(size=3)
        way *= 0.35 / np.linalg.norm(way)
        if broken(found, way * FIRST_PART / 0.35)[0] > 1e-4:
            break
    for share in (FIRST_PART / 0.35, 0.3, 1.0):
        memory.rows.size[:] = 0
        memory.goal.step[d : d + 3] = share * way
        keep_limits(skel, posture, memory)
        assert memory.rows.size[COUNT] >= 1
        normals.append((memory.rows.jacobian[0, d : d + 3].copy(), float(memory.rows.bound[0])))
    for normal, bound in normals[1:]:
        assert normal == pytest.approx(normals[0][0], abs=1e-12)
        assert bound == pytest.approx(normals[0][1], abs=1e-12)
    assert abs(normals[0][1]) < 1e-3, "standing all but obeys it"


@WHERE
def test_a_limb_that_reaches_its_limits_at_the_end_of_the_step_gets_its_row_there(seed: int) -> None:
    found, d, rng = world(seed, LIMITS.swing - 0.1)
    _, skel, posture, _ = found.parts
    memory = found.memory
    way = rng.normal(size=3)
    way *= 0.35 / np.linalg.norm(way)
    memory.goal.step[d : d + 3] = way
    keep_limits(skel, posture, memory)
    assert memory.rows.size[COUNT] == int((broken(found, way) > 0.0).sum())
