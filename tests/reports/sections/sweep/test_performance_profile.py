"""Performance profiles against a dumb twin that counts scenes, and what is said of them."""

import math
import random

import pytest

from reports.sections.sweep.performance_profile import profile, sentence, share_at

NAN = math.nan


def twin(times: dict[str, dict[str, float]], engine: str, factor: float) -> float:
    """The definition, scene by scene."""
    scenes = sorted({scene for own in times.values() for scene in own})
    solved = 0
    for scene in scenes:
        all_times = [own[scene] for own in times.values() if scene in own and not math.isnan(own[scene])]
        mine = times[engine].get(scene, NAN)
        if all_times and not math.isnan(mine) and mine / min(all_times) <= factor:
            solved += 1
    return solved / len(scenes)


@pytest.mark.parametrize("seed", range(8))
def test_it_counts_what_its_definition_counts(seed: int) -> None:
    rng = random.Random(seed)
    scenes, engines = [f"scene {k}" for k in range(rng.randint(1, 9))], ["a", "b", "c"]
    times = {
        engine: {
            name: NAN if rng.random() < 0.3 else rng.choice((1.0, 2.0, 2.0, 5.0, 30.0)) for name in scenes if rng.random() < 0.9
        }
        for engine in engines
    }
    times["a"] |= {scenes[0]: 3.0}
    found = profile(times)
    for engine in engines:
        shares = [share for _, share in found[engine]]
        assert shares == sorted(shares) and found[engine][0][0] == 1.0
        for factor in (1.0, 1.4, 2.0, 2.5, 5.0, 10.0, 30.0, 1e9):
            assert share_at(found[engine], factor) == pytest.approx(twin(times, engine, factor))


def test_a_scene_that_no_engine_solves_is_solved_by_none() -> None:
    found = profile({"a": {"x": 1.0, "y": NAN}, "b": {"x": 2.0, "y": NAN}})
    assert found == {"a": ((1.0, 0.5),), "b": ((1.0, 0.0), (2.0, 0.5))}


def test_the_engine_that_solves_most_is_named_first() -> None:
    found = profile({"a": {"x": 1.0, "y": NAN}, "b": {"x": 2.0, "y": 7.0}})
    said = sentence(found, 1e-3, 2)
    assert said == ("Of 2 scenes without an avatar, 1 mm is reached by a setting measured in: b 2 (fastest in 1), a 1 (fastest "
                    "in 1).")
    assert sentence(found, 1e-3, 2, {"a": 1}).endswith("Not said, as steps that might reach it were not measured: a in 1.")
