"""Drawn crowds: equal for equal seeds, of all kinds and shapes, free of overlap at the start."""

from collections import Counter

import pytest

from avatarsim.errors import InvalidInput, UnknownName
from avatarsim.scene.body import Role
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Sphere
from reference.judging.judge import Judge
from scenarios import drawn_crowds
from scenarios.drawn_crowds import KINDS
from scenarios.drawn_crowds.bodies import FRICTIONS, RESTITUTIONS
from scenarios.run.provenance import scene_hash
from scenarios.unseen import seeds
from tests.scenarios.scene_rules import first_poses


def scenes(count: int) -> list[Scene]:
    return [drawn_crowds.draw(seed).build() for seed in range(count)]


def test_a_seed_draws_one_scene_and_motion() -> None:
    def of(seed: int) -> tuple[str, bytes]:
        scenario = drawn_crowds.draw.__wrapped__(seed)
        scene = scenario.build()
        motion = scenario.motion(scene, seed)
        return scene_hash(scene), b"".join(motion(frame).positions.tobytes() for frame in range(scenario.frames))

    for seed in range(len(KINDS)):
        assert of(seed) == of(seed) and of(seed)[0] != of(seed + len(KINDS))[0]
    assert of(2)[1] != of(8)[1] and of(3)[1] != of(9)[1]


def test_ninety_crowds_overlap_nowhere_at_the_start() -> None:
    for scene in scenes(90):
        assert Judge(scene).overlaps(*first_poses(scene)).deepest == 0.0, scene.name


def test_ninety_crowds_have_every_kind_shape_and_law() -> None:
    drawn = scenes(90)
    assert Counter(scene.name.split("_")[1] for scene in drawn) == dict.fromkeys((kind.__name__ for kind in KINDS), 15)
    loose = [[body for body in scene.bodies if body.role is Role.SIMULATED and body.name != "thrown"] for scene in drawn]
    assert min(map(len, loose)) < 10 and max(map(len, loose)) > 90 and all(5 <= len(bodies) <= 100 for bodies in loose)
    assert {type(body.pieces[0].shape) for bodies in loose for body in bodies} == {Box, Capsule, ConvexHull, Sphere}
    hands = {(scene.name.split("_")[1], len(scene.avatars)) for scene in drawn}
    assert hands == {("poured", 0), ("struck", 0), ("swept", 1), ("gripped", 2), ("kicked", 1), ("moved", 2)}
    assert sum("wall_0" in scene.names for scene in drawn if "poured" in scene.name) not in (0, 15)
    for scene in drawn:
        for law in scene.materials.pairs.values():
            assert FRICTIONS[0] <= law.friction <= FRICTIONS[1] and RESTITUTIONS[0] <= law.restitution <= RESTITUTIONS[1]


def test_a_crowd_is_found_by_its_name_of_any_seed() -> None:
    assert drawn_crowds.get("crowd_swept_8") is drawn_crowds.draw(8)
    for name in ("crowd_swept_6", "crowd_swept_", "crowd_swept_-2", "swept_8", "crowd_swept_08", "crowd_swept_²"):
        with pytest.raises(UnknownName):
            drawn_crowds.get(name)
    with pytest.raises(InvalidInput):
        drawn_crowds.draw(-1)


def test_the_commits_own_crowds_are_one_of_each_kind() -> None:
    first = seeds.draw().seed
    assert [name.split("_")[1:] for name in drawn_crowds.scenarios()] == [
        [drawn_crowds.draw(seed).name.split("_")[1], str(seed)] for seed in range(first, first + len(KINDS))
    ]
