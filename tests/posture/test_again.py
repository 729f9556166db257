"""A hand that is asked a second time in a frame, after loose objects have moved on, has what that frame has left."""

from dataclasses import replace

import numpy as np
import pytest

from avatarsim.engine import Settings
from avatarsim.posture.again import leave_the_rest
from avatarsim.scene.avatar import rigid_avatar
from avatarsim.scene.body import Body, fixed, simulated
from avatarsim.scene.mass import solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.scene.tracker import rest
from avatarsim.settings import PostureSettings
from avatarsim.simulator import AvatarsimEngine
from tests.posture.little_worlds import at, little, mixed_avatar

SETTINGS = PostureSettings()
ANY_FRAME = SETTINGS.steps * SETTINGS.move_cap
"""[m] what a root goes in a frame in which nobody leaps."""
STRAY = SETTINGS.steps * SETTINGS.stray_move
"""[m] what contacts may shove it aside in such a frame."""
SLOWEST = 1.0 / 15.0
"""[s] a frame in which what is pushed has the time to fly away."""


@pytest.mark.parametrize(("way", "user", "steps", "share"), [
    (0.0, 0.0, SETTINGS.steps, 1.0), (0.3 * ANY_FRAME, 0.0, SETTINGS.steps, 0.7), (ANY_FRAME, 0.0, SETTINGS.steps, 0.0),
    (2.0 * ANY_FRAME, 0.0, SETTINGS.steps, 0.0), (ANY_FRAME, 0.5 * SETTINGS.move_cap, 1, 0.5), (0.1, 1.0, 1, 1.0),
])
def test_a_root_has_what_is_left_and_joints_are_not_held(way: float, user: float, steps: int, share: float) -> None:
    world = little(Scene("s", (), (mixed_avatar(),)))
    goal, (_, skel, posture, _) = world.memory.goal, world.parts
    goal.allowed[:] = 1.0
    goal.leapt[0, 0] = user
    for begun, now in zip(goal.begun, posture, strict=True):
        begun[:] = now
    goal.begun.root[0, 1] -= way
    leave_the_rest(skel, SETTINGS, steps, posture, goal)
    assert goal.allowed[:3] == pytest.approx(share, abs=1e-12) and (goal.allowed[3:] == 1.0).all()


def pile() -> tuple[Body, ...]:
    """Eighteen loose boxes and balls on a floor, a hair apart."""
    side = 0.12
    box, ball = (Piece(Box((side, side, side))),), (Piece(Sphere(0.5 * side)),)
    floor = fixed("floor", (Piece(Box((40.0, 40.0, 0.2))),), "wood", (0.0, 0.0, -0.1))
    places = [(k % 3, k // 3 % 3, k // 9) for k in range(18)]
    return (floor, *(
        simulated(
            f"b{k}", box if k % 2 else ball, "wood", solid(box, 0.5),
            (0.6 + x * (side + 0.002), -0.13 + y * (side + 0.002), 0.5 * side + 1e-3 + z * (side + 0.002)),
        )
        for k, (x, y, z) in enumerate(places)
    ))


def test_a_hand_that_a_pile_lets_go_of_does_not_shoot_through_it() -> None:
    palm = (Piece(Box((0.1, 0.1, 0.2))),)
    avatar = rigid_avatar("hand", palm, solid(palm, 1.0))
    home = at(rest((avatar,)), (-1.2, 0.0, 0.4))
    scene = Scene("pile", pile(), (avatar,), start=home)
    engine, root = AvatarsimEngine(), len(scene.bodies)
    before = engine.load(scene, Settings(seed=1), SLOWEST).shown.positions[root].copy()
    random, user, ways = np.random.default_rng(1), home, []
    for frame in range(60):
        asked = home
        if frame >= 15:
            asked = at(home, (-1.2 if frame // 6 % 2 else 2.4, float(random.uniform(-0.1, 0.1)), 0.15))
        asked = replace(asked, time=(frame + 1) * SLOWEST)
        now = engine.advance(asked, SLOWEST).shown.positions[root].copy()
        own = float(np.linalg.norm(asked.positions[0] - user.positions[0]))
        ways.append(float(np.linalg.norm(now - before)) - own)
        before, user = now, asked
    # what it goes beyond its user's own way; without a bound on the second time it was 0.457
    assert 0.2 < max(ways) <= ANY_FRAME + STRAY
