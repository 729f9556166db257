"""Settings of the engine: which are known, within what range, together with which others, and that they act."""

import math
from dataclasses import replace

import numpy as np
import pytest

from avatarsim.engine import Settings
from avatarsim.errors import InvalidInput, UnknownName
from avatarsim.scene.body import simulated, solid
from avatarsim.scene.shape import Piece, Sphere
from avatarsim.settings import Chosen, CouplingSettings, PostureSettings, meanings
from avatarsim.simulator import AvatarsimEngine
from tests.stability.hostile import DT
from tests.test_simulator import SCENE, loaded
from tests.worlds.little_worlds import at, hand_scene


def test_an_unknown_preset_is_named_and_the_known_ones_listed() -> None:
    with pytest.raises(UnknownName, match="preset of avatarsim is 'turbo'; valid: one of .*default"):
        AvatarsimEngine().load(SCENE, Settings(preset="turbo"), DT)


def test_an_unknown_option_is_named_and_the_known_ones_listed() -> None:
    with pytest.raises(UnknownName, match="option of avatarsim.* is 'stand_of'; valid: one of .*stand_off"):
        loaded(stand_of=1e-4)


@pytest.mark.parametrize("value", [-1.0, 0.0, math.nan, math.inf, "fast", None, True])
@pytest.mark.parametrize("name", ["stand_off", "steps", "spring"])
def test_options_are_finite_numbers(name: str, value: object) -> None:
    with pytest.raises(InvalidInput, match=f"option {name} is .* valid: a (whole )?number from [0-9e.-]+ to"):
        loaded(**{name: value})


def test_a_tolerance_above_the_stand_off_is_refused() -> None:
    with pytest.raises(InvalidInput, match="option tolerance is 0.001; valid: below stand_off, 0.0001 m"):
        AvatarsimEngine().load(SCENE, Settings("paper", {"tolerance": 1e-3}), DT)


def test_options_are_in_force_and_reported() -> None:
    told = loaded(stand_off=1e-3, steps=3, spring=500).settings_as_run()
    values = {name: pair[0] for name, pair in told.items() if isinstance(pair, tuple)}
    assert values["stand_off"] == 1e-3 and values["steps"] == 3 and values["spring"] == 500.0 and values["damping"] == 40.0
    assert values["method"] == "default"


@pytest.mark.parametrize("group", Chosen.__annotations__.values())
def test_every_setting_says_what_it_means_once(group: type) -> None:
    said = meanings(group)
    assert set(said) == set(group.__annotations__)
    assert all(len(text) > 20 and "  " not in text for text in said.values())
    assert len(set(said.values())) == len(said)


def test_a_meaning_is_whole_and_has_its_unit() -> None:
    assert meanings(PostureSettings)["stall_time"] == (
        "[s] without progress after which a path is searched, or else the frame record says that an avatar waits."
    )
    work, spring = meanings(PostureSettings)["work"], meanings(CouplingSettings)["spring"]
    assert work.startswith("work that a frame may cost") and work.endswith("record says so.")
    assert spring.startswith("[N/m]") and loaded().settings_as_run()["spring"] == (1000.0, spring)


def test_a_larger_stand_off_leaves_more_air() -> None:
    for stand_off in (2e-4, 2e-3):
        engine = loaded(stand_off=stand_off)
        for _ in range(20):
            record = engine.advance(at(SCENE.first_sample, (0.5, 0.0, 0.0)), DT)
        assert -record.shown.positions[1, 0] - 0.051 == pytest.approx(stand_off, rel=0.3)


def test_a_walk_back_without_an_end_is_refused() -> None:
    with pytest.raises(InvalidInput, match="option walk_back is 0"):
        AvatarsimEngine().load(SCENE, Settings("paper", {"walk_back": 0.0}), DT)


@pytest.mark.parametrize("stand_off", [2e-5, 2e-4, 1e-3, 5e-3])
def test_a_hand_pushes_what_is_loose_whatever_air_it_keeps(stand_off: float) -> None:
    """The upper loop has to know how near a driven body comes, or a ball that floats stops the user like a wall."""
    feather = (Piece(Sphere(0.05)),)
    ball = simulated("ball", feather, "wood", solid(feather, 0.2), (0.2, 0.0, 0.0))
    scene = replace(hand_scene((0.0, 0.0, 0.0), ball), gravity=(0.0, 0.0, 0.0))
    for speed in (0.003, 0.005, 0.0071):
        engine = loaded(scene, stand_off=stand_off)
        for k in range(int(0.5 / speed)):
            record = engine.advance(at(scene.first_sample, (speed * k, 0.0, 0.0)), DT)
        assert record.shown.positions[0, 0] > 0.5 + 0.1 - 2.0 * speed


@pytest.mark.parametrize(("field", "value"), [
    ("preset", None), ("preset", 3), ("options", None), ("options", [1]), ("options", {1: 2}), ("options", "steps"),
    ("seed", "a"), ("seed", 1.5), ("seed", True), ("seed", None), ("record_inside", 1), ("time_stages", "yes"),
])
def test_settings_of_another_type_are_refused(field: str, value: object) -> None:
    with pytest.raises(InvalidInput, match=f"{field} of the settings is .*; valid: "):
        Settings(**{field: value})


def test_seeds_and_flags_of_numpy_will_do() -> None:
    assert Settings(seed=np.int64(3), record_inside=np.bool_(True)).seed == 3


def test_a_seed_of_a_narrow_kind_is_the_number_that_it_says() -> None:
    plain, narrow = AvatarsimEngine(), AvatarsimEngine()
    plain.load(SCENE, Settings("paper", seed=5), DT)
    narrow.load(SCENE, Settings("paper", seed=np.int8(5)), DT)
    assert type(Settings(seed=np.int8(5)).seed) is int and plain.snapshot() == narrow.snapshot()


@pytest.mark.parametrize("settings", [None, {}, {"preset": "default"}, "default"])
def test_a_scene_is_loaded_with_settings(settings: object) -> None:
    with pytest.raises(InvalidInput, match="settings to load a scene with is .*; valid: Settings"):
        AvatarsimEngine().load(SCENE, settings, DT)
