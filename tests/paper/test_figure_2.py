"""Figure 2: an avatar moves into a wall; the extended arm and a leg are pushed back."""

import numpy as np

from scenarios.catalog.paper.into_wall import FACE
from tests.coupling.scenes import deepest
from tests.paper.scene_run import of_shown, of_user, scene_run

FRAMES = 92


def test_arm_and_leg_are_pushed_back_and_the_rest_goes_on() -> None:
    scene, records = scene_run("avatar_into_wall", FRAMES)
    names = [name.split("/")[1] for name in scene.names[len(scene.bodies) :]]
    user = of_user("avatar_into_wall", FRAMES)
    off = np.linalg.norm(user - of_shown("avatar_into_wall", FRAMES), axis=-1)
    at = {name: off[:, k] for k, name in enumerate(names)}
    pressed = slice(36, 60)
    for name in ("right_wrist", "left_ankle"):
        # decimetres behind the wall's face, and pushed back by more than that
        behind = user[pressed, names.index(name), 0] - FACE
        assert behind.min() > 0.1 and (at[name][pressed] > behind).all()
    # the trunk stays with its user: it is limbs that give way
    assert at["root"][pressed].max() < 0.15 * at["left_ankle"][pressed].max()
    # before and after the wall is in the way, everything is where the user is
    assert off[:18].max() < 1e-3 and off[-6:].max() < 1e-3


def test_the_user_is_far_in_the_wall_and_what_is_shown_is_not() -> None:
    scene, records = scene_run("avatar_into_wall", FRAMES)
    assert of_user("avatar_into_wall", FRAMES)[:, :, 0].max() > FACE + 0.15
    assert of_shown("avatar_into_wall", FRAMES)[:, :, 0].max() < FACE
    assert deepest(scene, records[::6]) <= 1e-6
