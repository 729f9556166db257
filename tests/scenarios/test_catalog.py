"""Every scene of the catalogue: found by its name, built free of overlap, with a valid motion."""

import tomllib
from dataclasses import replace
from math import inf
from pathlib import Path

import numpy as np
import pytest

from avatarsim.errors import InvalidInput, UnknownName
from avatarsim.scene.body import TABLE_1
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import link_poses_each
from reference.judging.judge import Judge
from scenarios import catalog
from scenarios.building.reach import reach
from scenarios.catalog.paper import ball_drop
from scenarios.catalog.recorded import mocap_clips
from scenarios.motion.mocap import clip_names
from scenarios.scenario import Bound, Motion, Region, Scenario
from tests.scenarios.scene_rules import (
    BRISK,
    begins_free_where_its_regions_allow,
    first_poses,
    moves_soundly,
    says_what_it_is_and_what_must_hold,
)

ALL = sorted(catalog.scenarios())
CEILINGS = Path(catalog.__file__).parents[1] / "ceilings.toml"

FASTEST = dict.fromkeys(("mocap_backflip", "mocap_dance_a", "mocap_kick", "mocap_run", "mocap_spinkick"), 0.21)
"""Clips that are faster as recorded: their feet reach up to 12.3 m/s."""
JUMPS_ABOUT = ("limit_torture", "limit_torture_hinges", "teleport", "thin_wall_hand")
"""Scenes whose users jump on purpose."""


def built(name: str) -> tuple[Scenario, Scene, Motion]:
    scenario = catalog.get(name).as_run(full=False)
    scene = scenario.build()
    return scenario, scene, scenario.motion(scene, 0)


def test_scenes_are_found_by_name_and_every_recorded_clip_is_one() -> None:
    assert all(scenario.name == name for name, scenario in catalog.scenarios().items())
    assert {"ball_drop", "hand_over_table", *(f"mocap_{clip}" for clip in clip_names())} <= set(ALL)
    with pytest.raises(UnknownName, match="ball_drop"):
        catalog.get("ball_dorp")


@pytest.mark.parametrize("name", ALL)
def test_a_scene_has_its_bounds_begins_free_and_moves_soundly(name: str) -> None:
    says_what_it_is_and_what_must_hold(catalog.get(name))
    scenario = catalog.get(name).as_run(full=False)
    begins_free_where_its_regions_allow(scenario)
    moves_soundly(scenario, inf if name in JUMPS_ABOUT else FASTEST.get(name, BRISK))


@pytest.mark.parametrize(
    ("name", "face"), [("mocap_punch_wall", mocap_clips.PUNCH_FACE), ("mocap_walk_wall", mocap_clips.WALK_FACE)]
)
def test_wall_is_a_foot_within_reach_and_never_wholly_passed(name: str, face: float) -> None:
    scenario, scene, motion = built(name)
    samples = [motion(frame) for frame in range(scenario.frames)]
    assert reach(scene.avatars, samples, (1.0, 0.0, 0.0)).max() - face == pytest.approx(0.3, abs=0.01)
    places, _ = link_poses_each(scene.avatars, samples)
    # the raw tracker is found on the wrong side, but most of the avatar never gets there
    wrong = places[:, :, 0] > scenario.regions[0].high[0]
    assert wrong.any() and wrong.mean(axis=1).max() < 0.5
    assert places[:, 0, 0].max() < face


def test_the_balls_fall_a_metre_onto_the_pairs_of_table_1() -> None:
    scenario, scene, _ = built("ball_drop")
    judge = Judge(scene)
    first, second, distances = judge.distances(*first_poses(scene), reach=2.0)
    names = np.array(scene.names)[judge.pieces.owner]
    apart = {frozenset(pair): distance for *pair, distance in zip(names[first], names[second], distances, strict=True)}
    materials, pairs = dict(zip(scene.names, scene.material_names, strict=True)), set()
    for drop in ball_drop.DROPS:
        assert apart[frozenset((drop.ball, drop.floor))] == pytest.approx(drop.height, abs=1e-9)
        assert drop.restitution == TABLE_1.contact(materials[drop.ball], materials[drop.floor]).restitution
        pairs.add(frozenset((materials[drop.ball], materials[drop.floor])))
    assert scenario.expects["drops"] == ball_drop.DROPS and len(pairs) == 6 == len(ball_drop.PAIRS)


def test_ceilings_are_of_bounds_and_at_most_a_millimetre() -> None:
    table = tomllib.loads(CEILINGS.read_text(encoding="utf-8"))
    assert set(table) <= set(ALL)
    for name, row in table.items():
        bounds = {bound.metric: bound.limit for bound in catalog.get(name).bounds}
        for metric, ceiling in row.items():
            assert ceiling > bounds[metric]
        assert row.get("residual_overlap_max", 1e-6) <= 1e-3


def test_a_number_that_is_none_breaks_every_bound() -> None:
    bound = Bound("residual_overlap_max", 1e-6, "because")
    assert bound.holds(1e-6) and not bound.holds(2e-6) and not bound.holds(float("nan"))
    for limit, reason in ((float("nan"), "because"), (1e-6, "")):
        with pytest.raises(InvalidInput, match="residual_overlap_max"):
            Bound("residual_overlap_max", limit, reason)


def test_regions_find_their_bodies_by_pattern() -> None:
    """Without any, or with an inverted box, they are refused, as are expectations that no measure reads."""
    scenario = catalog.get("ball_drop")
    with pytest.raises(UnknownName, match=r"expects.*'drop'.*drops"):
        replace(scenario, expects={"drop": scenario.expects["drops"]})
    region = Region(("human/left*", "ball"), (-1.0, -1.0, -1.0), (1.0, 1.0, 1.0), "because")
    assert region.indices(("floor", "ball", "human/left_hip", "human/neck")) == (1, 2)
    with pytest.raises(UnknownName, match="human/left"):
        region.indices(("floor", "ball"))
    with pytest.raises(InvalidInput, match="along y"):
        Region(("ball",), (0.0, 1.0, 0.0), (1.0, 1.0, 1.0), "because")
