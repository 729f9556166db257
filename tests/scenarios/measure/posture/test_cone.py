"""Many directions at once are as far outside a reach cone as each of them alone."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.scene.joint import ReachCone
from scenarios.measure.posture.limits import beyond_cone, beyond_cone_each
from tests.model.test_reach_cone import CONES


@pytest.mark.parametrize("name", CONES)
@given(seed=st.integers(0, 2**31))
def test_each_is_as_alone(name: str, seed: int) -> None:
    cone: ReachCone = CONES[name]
    draw = np.random.default_rng(seed)
    # all round, near the corners, and exactly on them
    corners = np.array(cone.vertices)
    limbs = np.concatenate([draw.normal(size=(12, 3)), corners + 1e-3 * draw.normal(size=corners.shape), corners])
    limbs /= np.linalg.norm(limbs, axis=1, keepdims=True)
    limbs[3] = np.nan
    expected = [beyond_cone(cone, limb) for limb in limbs]
    np.testing.assert_allclose(beyond_cone_each(cone, limbs), expected, atol=1e-12)


def test_no_direction_at_all() -> None:
    assert beyond_cone_each(next(iter(CONES.values())), np.zeros((0, 3))).shape == (0,)
