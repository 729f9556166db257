"""Scenes: what contradicts itself is refused, which pairs may touch, which effects are called for."""

from dataclasses import replace

import numpy as np
import pytest

from avatarsim.errors import InvalidSample, InvalidScene
from avatarsim.scene.avatar import Avatar, rigid_avatar
from avatarsim.scene.body import ContactLaw, PairTable, fixed, simulated, solid
from avatarsim.scene.effects import Effects
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.scene.tracker import rest
from tests.stability.hostile import hinged_avatar, hinged_trial

BALL = (Piece(Sphere(0.1)),)
CRATE = (Piece(Box((0.1, 0.2, 0.3))),)
FLOOR = fixed("floor", (Piece(Box((4.0, 4.0, 0.2))),), "wood", (0.0, 0.0, -0.1))
HAND = rigid_avatar("hand", BALL, solid(BALL, 0.5))
DROP = simulated("drop", BALL, "metal", solid(BALL, 1.0), (0.0, 0.0, 1.0))


@pytest.mark.parametrize(
    ("arguments", "part"),
    [
        ({}, "number of bodies of scene s is 0"),
        ({"bodies": (FLOOR, FLOOR)}, "body of scene s is 'floor'; valid: names that occur once only"),
        ({"bodies": (fixed("hand", BALL, "wood"),), "avatars": (HAND,)}, "'hand'"),
        ({"bodies": (replace(FLOOR, material="cheese"),)}, "material of floor is 'cheese'; valid: one of human, metal, wood"),
        ({"bodies": (FLOOR,), "gravity": (0.0, 0.0, float("nan"))}, "gravity"),
        ({"bodies": (FLOOR,), "exclude": (("floor", "roof"),)}, "name in exclude is 'roof'"),
        ({"bodies": (FLOOR,), "narrow": ("gravity",)}, "effect is 'gravity'"),
    ],
)
def test_what_contradicts_itself_is_refused(arguments: dict[str, object], part: str) -> None:
    with pytest.raises(InvalidScene) as error:
        Scene("s", **arguments)
    assert part in str(error.value)


def test_the_start_must_fit_the_avatars() -> None:
    with pytest.raises(InvalidSample, match="tracker positions"):
        Scene("s", avatars=(HAND,), start=rest((hinged_avatar(),)))


def test_names_are_in_canonical_order() -> None:
    scene = Scene("s", (FLOOR, DROP), (hinged_avatar(), HAND))
    assert scene.names[:4] == ("floor", "drop", "dummy/pelvis", "dummy/chest") and scene.names[-1] == "hand"
    assert len(scene.names) == len(scene.roles) == len(scene.material_names) == 2 + 16 + 1


def test_the_pair_filter_is_symmetric_and_leaves_out_what_it_says() -> None:
    avatar = replace(hinged_avatar(), ignore=(("head", "left_hand"),))
    scene = Scene("s", (FLOOR, fixed("wall", BALL, "wood"), DROP), (avatar, HAND), exclude=(("drop", "hand"),))
    wanted, at = scene.pair_filter, {name: k for k, name in enumerate(scene.names)}
    assert (wanted == wanted.T).all() and not wanted.diagonal().any() and not wanted.flags.writeable
    for a, b in (("floor", "wall"), ("dummy/head", "dummy/left_hand"), ("drop", "hand"), ("dummy/pelvis", "dummy/chest")):
        assert not wanted[at[a], at[b]]
    for a, b in (
        ("floor", "drop"),
        ("drop", "dummy/head"),
        ("floor", "hand"),
        ("hand", "dummy/head"),
        ("dummy/pelvis", "dummy/head"),
    ):
        assert wanted[at[a], at[b]]
    # all that is left out: one pair of fixed bodies, two named pairs, a parent for every link below the root
    n = len(scene.names)
    assert n * (n - 1) // 2 - int(wanted.sum()) // 2 == 1 + 2 + 15


def test_without_self_contact_links_of_one_avatar_pass_each_other_but_not_another_avatar() -> None:
    scene = Scene("s", (FLOOR,), (hinged_avatar(), HAND), narrow=("self_contact",))
    assert not scene.pair_filter[1:17, 1:17].any()
    assert scene.pair_filter[1:17, 17].all() and scene.pair_filter[1:, 0].all()


def test_effects_are_those_that_the_parts_call_for() -> None:
    lone = Scene("s", (FLOOR, DROP)).effects
    assert not (lone.overlap_removal or lone.kinematics or lone.coupling or lone.limits or lone.reach_cones or lone.gyroscopic)
    assert lone.dynamics and lone.restitution and lone.friction
    crate = simulated("crate", CRATE, "wood", solid(CRATE, 1.0))
    assert Scene("s", (crate,)).effects.gyroscopic
    hand = Scene("s", (FLOOR,), (HAND,)).effects
    assert hand.overlap_removal and not (hand.dynamics or hand.coupling or hand.kinematics or hand.self_contact or hand.friction)
    arm = hinged_trial().scene.effects
    assert arm.kinematics and arm.limits and arm.self_contact and not arm.reach_cones
    assert Scene("s", (FLOOR, DROP), (HAND,)).effects.coupling


def test_pairs_without_friction_or_bounce_call_for_none() -> None:
    ice = PairTable(
        {
            ("wood", "metal"): ContactLaw(0.0, 0.0), ("metal", "metal"): ContactLaw(0.0, 0.0),
            ("human", "human"): ContactLaw(1.0, 1.0),
        }
    )
    effects = Scene("s", (FLOOR, DROP), materials=ice).effects
    assert not effects.friction and not effects.restitution


def test_narrowing_only_takes_away() -> None:
    scene = Scene("s", (FLOOR, DROP), narrow=("friction", "coupling"))
    assert not scene.effects.friction and scene.effects.restitution
    assert scene.effects.missing_from(scene.derived_effects) == ("friction",)


def test_the_default_start_is_rest() -> None:
    scene = Scene("s", avatars=(HAND,))
    assert (scene.first_sample.positions == 0.0).all()
    assert isinstance(scene.effects, Effects) and isinstance(scene.avatars[0], Avatar)
    assert np.array(scene.gravity)[2] == -9.81


@pytest.mark.parametrize("name", ["", "  ", None, 3])
def test_a_name_that_nobody_can_read_is_refused(name: object) -> None:
    ball = fixed("ball", (Piece(Sphere(0.1)),), "wood")
    with pytest.raises(InvalidScene, match="name of a scene"):
        Scene(name, (ball,))
    with pytest.raises(InvalidScene, match="name of a body"):
        fixed(name, (Piece(Sphere(0.1)),), "wood")
