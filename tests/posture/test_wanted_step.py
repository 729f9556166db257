"""Which rows make the straight step a hindered one, and what is left of them when the metric changes."""

import numpy as np
import pytest

from avatarsim.posture.nearest_step import nearest_step
from avatarsim.posture.wanted_step import hindered, weigh_anew
from avatarsim.posture.workspace import BOUND, BUILT, COUNT, COUPLED
from tests.posture.test_nearest_step import arrays, slow

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]


@pytest.mark.parametrize("kind", [BOUND, -3, 0])
@pytest.mark.parametrize("missing", [-0.1, 0.1])
def test_only_a_contact_that_the_step_breaks_is_in_its_way(kind: int, missing: float) -> None:
    goal, rows = arrays(4, np.random.default_rng(1))
    rows.jacobian[0], rows.pair[0], rows.size[COUNT] = np.ones(4), (kind, 2), 1
    rows.bound[0] = goal.step.sum() + missing
    assert hindered(goal.step, rows) == (kind >= 0 and missing > 0.0)
    rows.bound[0] = np.nan
    assert hindered(goal.step, rows) == (kind >= 0), "what is no number is in the way"


@pytest.mark.parametrize("seed", range(4))
def test_a_metric_that_comes_later_solves_as_if_it_had_been_there_from_the_first(seed: int) -> None:
    """Contacts and limits stay, bounds of the step before go, and nothing of the old metric is left."""
    rng = np.random.default_rng(seed)
    goal, rows = arrays(6, rng)
    goal.low[:], goal.high[:] = goal.step - 0.05, goal.step + 0.05
    rows.jacobian[:2], rows.pair[:2] = rng.normal(size=(2, 6)), ((0, 1), (-3, 0))
    rows.bound[:2] = rows.jacobian[:2] @ goal.step + 0.02
    rows.size[COUNT] = 2
    jacobian, bound = rows.jacobian[:2].copy(), rows.bound[:2].copy()
    rows.jacobian[2], rows.bound[2], rows.pair[2], rows.size[COUNT] = np.eye(6)[0], 7.0, (BOUND, 0), 3
    rows.jacobian[3], rows.bound[3], rows.pair[3], rows.size[COUNT] = jacobian[0], bound[0], (0, 2), 4
    nearest_step(goal, rows, 50, 1e-9)
    goal.inverse_weight[:] = rng.uniform(0.2, 2.0, 6)
    weigh_anew(rows)
    assert rows.size[COUNT] == 3 and rows.size[BUILT] == 0 and (rows.multiplier[:3] == 0.0).all()
    assert rows.pair[:3].tolist() == [[0, 1], [-3, 0], [0, 2]] and (rows.jacobian[2] == jacobian[0]).all()
    assert goal.closeness.mode[COUPLED] == 0.0
    nearest_step(goal, rows, 5000, 1e-14)
    assert rows.x == pytest.approx(slow(goal, jacobian, bound), abs=1e-5)
