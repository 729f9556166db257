"""Changes of a case: free of overlap at the start, equal bits without a change, the same path of the user at any rate."""

import numpy as np
import pytest

from reference.judging.judge import Judge
from scenarios import catalog
from scenarios.run.provenance import scene_hash
from scenarios.scenario import RENDERED
from scenarios.studies.hard_cases.plan import CASES, STARTS, together
from scenarios.studies.hard_cases.variation import Variation, at_time, varied
from tests.scenarios.scene_rules import first_poses


@pytest.mark.parametrize("start", STARTS)
@pytest.mark.parametrize("name", CASES)
def test_changed_start_is_free_and_within_its_change(name: str, start: float) -> None:
    scenario = catalog.get(name)
    plain, scene = scenario.build(), varied(scenario, RENDERED, Variation(start=start, seed=3)).here
    before, after = (np.array([body.position for body in s.bodies]).reshape(-1, 3) for s in (plain, scene))
    # the sum of two positions is rounded
    assert np.abs(after - before).max(initial=0.0) <= start + 1e-12
    moving = [k for k, role in enumerate(plain.roles[: len(plain.bodies)]) if role.name == "SIMULATED"]
    assert all((after[k] != before[k]).any() for k in moving)
    assert Judge(scene).overlaps(*first_poses(scene)).deepest == 0.0


@pytest.mark.parametrize("name", CASES)
def test_plain_is_the_scene_itself(name: str) -> None:
    scenario = catalog.get(name)
    scene, case = scenario.build(), varied(scenario, 0.2, Variation())
    assert scene_hash(case.scene) == scene_hash(scene) and case.dt == pytest.approx(RENDERED, rel=1e-12)
    motion = scenario.motion(scene, 0)
    for k, sample in enumerate(case.samples):
        same = motion(k)
        assert (sample.positions == same.positions).all() and (sample.rotations == same.rotations).all()
        assert (sample.angles == same.angles).all()


def test_the_user_goes_the_same_way_at_any_rate() -> None:
    scenario = catalog.get("hand_in_bowl")
    scene = scenario.build()
    motion = scenario.motion(scene, 0)
    a, b = motion(9), motion(10)
    between = at_time(scene, motion, RENDERED, 10.25 * RENDERED)
    assert np.allclose(between.positions, 0.75 * a.positions + 0.25 * b.positions, atol=1e-15)
    assert between.time == 10.25 * RENDERED
    first = at_time(scene, motion, RENDERED, 0.5 * RENDERED)
    assert np.allclose(first.positions, 0.5 * (scene.first_sample.positions + motion(0).positions))


def test_each_alone_and_all_together_one_draw_per_row_and_column() -> None:
    draws = together(12)
    assert draws == together(12) and draws != together(12, seed=1)
    for values in (
        [np.log(trial.change.start) for trial in draws], [np.log(trial.change.dt) for trial in draws],
        [np.log(trial.change.scale) for trial in draws], [np.log(trial.change.far) for trial in draws],
    ):
        low, high = min(values), max(values)
        assert high - low > 0.0
        # Latin: every twelfth of the range has one draw
        assert len({int(12 * (v - low) / (high - low) * 0.999) for v in values}) >= 8
    assert all(1e-9 <= t.change.start <= 1e-3 and 1e-3 <= t.change.dt <= 1.0 / 15.0 for t in draws)
    assert all(1e-3 <= t.change.scale <= 1e3 and 1e1 <= t.change.far <= 1e5 and t.change.user == 0 for t in draws)
