"""Scenes: effects of each part, the author's choices, and the pairs that may touch."""

from dataclasses import fields, replace
from typing import Any

import pytest

from avatarsim.errors import InvalidScene
from avatarsim.scene.avatar import Avatar, rigid_avatar
from avatarsim.scene.body import Body, ContactLaw, PairTable, fixed, simulated, solid
from avatarsim.scene.effects import CALLS, KEPT, Effects
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from tests.stability.hostile import hinged_avatar

BALL, CRATE = (Piece(Sphere(0.1)),), (Piece(Box((0.1, 0.2, 0.3))),)
FLOOR = fixed("floor", (Piece(Box((4.0, 4.0, 0.2))),), "wood", (0.0, 0.0, -0.1))
DROP = simulated("drop", BALL, "metal", solid(BALL, 1.0), (0.0, 0.0, 1.0))
TUMBLE = simulated("tumble", CRATE, "wood", solid(CRATE, 1.0), (1.0, 0.0, 1.0))
HAND = rigid_avatar("hand", BALL, solid(BALL, 0.5))


def called(*bodies: Body, avatars: tuple[Avatar, ...] = (), **more: Any) -> set[str]:
    """Return effects of a scene of these parts."""
    scene = Scene("s", bodies, avatars, **more)
    return {effect for effect, parts in scene.calls.items() if parts}


def test_the_table_has_a_row_for_every_effect_in_order() -> None:
    assert [call.effect for call in CALLS] == [effect.name for effect in fields(Effects)]


def test_each_part_calls_for_its_effects_and_no_other() -> None:
    bodily = {"dynamics", "restitution", "friction", "continuous", "sleeping"}
    assert called(FLOOR) == set()
    assert called(FLOOR, DROP) == bodily
    assert called(FLOOR, TUMBLE) == bodily | {"gyroscopic"}
    assert called(FLOOR, avatars=(HAND,)) == {"overlap_removal", "friction"}
    assert called(DROP, avatars=(HAND,)) == bodily | {"overlap_removal", "coupling"}
    assert called(FLOOR, avatars=(hinged_avatar(),)) == {"overlap_removal", "kinematics", "self_contact", "limits", "friction"}


def test_materials_that_can_meet_call_for_bounce_and_friction() -> None:
    slick, rough = ContactLaw(0.0, 0.0), ContactLaw(0.5, 0.5)
    table = PairTable({("metal", "metal"): rough, ("wood", "metal"): slick, ("wood", "wood"): rough})
    assert not {"restitution", "friction"} & called(FLOOR, DROP, materials=table)
    assert {"restitution", "friction"} <= called(FLOOR, DROP, replace(DROP, name="other"), materials=table)
    assert Scene("s", (FLOOR, TUMBLE)).calls["friction"] == ("wood on wood 0.3",)


@pytest.mark.parametrize(("effect", "part"), [
    ("friction", "friction above 0"), ("self_contact", "three links"),
    ("coupling", "an avatar together with a simulated or moving body"), ("reach_cones", "reach cone"),
    ("dynamics", "a simulated or moving body"), ("limits", "a limited hinge"),
])
def test_a_scene_that_requires_what_it_lacks_is_refused_by_name(effect: str, part: str) -> None:
    with pytest.raises(InvalidScene) as error:
        Scene("bare", (FLOOR,), require=(effect,))
    said = str(error.value)
    assert f"'{effect}'" in said and "bare" in said and part in said


def test_what_is_required_must_not_be_narrowed_away() -> None:
    assert Scene("s", (FLOOR, DROP), require=("friction",)).effects.friction
    for asked in ("require", "force"):
        with pytest.raises(InvalidScene, match="narrows is 'friction'"):
            called(FLOOR, DROP, narrow=("friction",), **dict[str, Any]({asked: ("friction",)}))


@pytest.mark.parametrize("asked", ["narrow", "require", "force"])
def test_an_effect_that_nobody_knows_is_refused(asked: str) -> None:
    with pytest.raises(InvalidScene, match="'fricton'"):
        called(FLOOR, DROP, **dict[str, Any]({asked: ("fricton",)}))


@pytest.mark.parametrize("effect", KEPT)
def test_what_cannot_be_left_out_is_said(effect: str) -> None:
    with pytest.raises(InvalidScene, match=effect):
        Scene("s", (FLOOR,), (hinged_avatar(),), narrow=(effect,))


def test_what_lapses_is_what_was_called_for_and_taken_away() -> None:
    scene = Scene("s", (FLOOR, DROP), narrow=("continuous", "coupling"))
    assert dict(scene.lapsed) == {"continuous": "1 (no overlap)"}
    assert not Scene("s", (FLOOR, DROP)).lapsed


def test_a_scene_is_judged_whole_whatever_was_left_out() -> None:
    scene = Scene("s", (FLOOR,), (hinged_avatar(),), narrow=("self_contact",), force=("sleeping",))
    assert scene.whole.effects == scene.derived_effects and scene.whole.pair_filter.sum() > scene.pair_filter.sum()
    plain = Scene("s", (FLOOR, DROP))
    assert plain.whole is plain


def test_a_forced_effect_is_on_though_nothing_calls() -> None:
    scene = Scene("s", (FLOOR,), (HAND,), force=("sleeping", "reach_cones"))
    assert scene.effects.sleeping and scene.effects.reach_cones and not scene.effects.restitution
    assert not scene.lapsed


def test_narrowing_switches_off_what_is_named_and_nothing_else() -> None:
    less = Effects().narrowed("friction", "sleeping")
    assert not less.friction and not less.sleeping and less.restitution and less.overlap_removal
    assert Effects().narrowed() == Effects()
    derived = Effects(friction=False)
    assert derived.narrowed("friction", "sleeping").missing_from(derived) == ("sleeping",)


@pytest.mark.parametrize("value", [0, 1.0, "yes", None, ()])
def test_a_switch_is_true_or_false(value: object) -> None:
    with pytest.raises(InvalidScene, match="effect friction is .*True or False"):
        Effects(friction=value)  # type: ignore[arg-type]


def test_names_are_in_canonical_order() -> None:
    scene = Scene("s", (FLOOR, DROP), (hinged_avatar(), HAND))
    assert scene.names[:4] == ("floor", "drop", "dummy/pelvis", "dummy/chest") and scene.names[-1] == "hand"
    assert len(scene.names) == len(scene.roles) == len(scene.material_names) == 2 + 16 + 1


def test_the_pair_filter_leaves_out_what_it_says() -> None:
    avatar = replace(hinged_avatar(), ignore=(("head", "left_hand"),))
    scene = Scene("s", (FLOOR, fixed("wall", BALL, "wood"), DROP), (avatar, HAND), exclude=(("drop", "hand"),))
    wanted, at = scene.pair_filter, {name: k for k, name in enumerate(scene.names)}
    assert (wanted == wanted.T).all() and not wanted.diagonal().any() and not wanted.flags.writeable
    for a, b in (("floor", "wall"), ("dummy/head", "dummy/left_hand"), ("drop", "hand"), ("dummy/pelvis", "dummy/chest")):
        assert not wanted[at[a], at[b]]
    head = "dummy/head"
    for a, b in (("floor", "drop"), ("drop", head), ("floor", "hand"), ("hand", head), ("dummy/pelvis", head)):
        assert wanted[at[a], at[b]]
    # all that is left out: one pair of fixed bodies, two named pairs, a parent for every link below the root
    n = len(scene.names)
    assert n * (n - 1) // 2 - int(wanted.sum()) // 2 == 1 + 2 + 15


def test_without_self_contact_only_own_links_pass_each_other() -> None:
    scene = Scene("s", (FLOOR,), (hinged_avatar(), HAND), narrow=("self_contact",))
    assert not scene.pair_filter[1:17, 1:17].any()
    assert scene.pair_filter[1:17, 17].all() and scene.pair_filter[1:, 0].all()
