"""Who counts as a crowd, when joints go their own way in it, and that no link goes farther in a frame than it may."""

from dataclasses import replace

import numpy as np
import pytest

from avatarsim.posture.crowd import (
    CATCH_UP,
    CROWD,
    HELD_BY,
    HELD_FRAMES,
    SLIDE,
    SPARSE,
    SPARSE_FRAMES,
    TOUCHING,
    is_crowded,
    is_pressed,
    measure_strides,
    meet_a_crowd,
    share_left,
    slide,
)
from avatarsim.posture.kinematics import forward
from avatarsim.posture.workspace import CROWDED, LED, LISTED, NEAR_BODIES, SLOW, SOUGHT, TRAVELS, UNDER_WAY
from avatarsim.scene.scene import Scene
from avatarsim.simulator import AvatarsimEngine, Settings
from avatarsim.world.skeleton import UNLIMITED
from avatarsim.world.world import build
from scenarios import catalog
from tests.posture.little_worlds import Little, hand, little, mixed_avatar, panel, random_sample

SHIFT = np.array([0.6, 0.0, 0.8])


@pytest.mark.nojit
def test_a_crowd_lasts_until_few_were_near_in_some_frames() -> None:
    memory = little(Scene("s", (), (hand(),))).memory
    seen = []
    for near in (CROWD, CROWD + 1, CROWD, SPARSE, SPARSE, CROWD + 1, SPARSE, CROWD, SPARSE, SPARSE, CROWD, SPARSE):
        memory.pairs.marks[NEAR_BODIES] = near
        seen.append(is_crowded(memory))
    # three frames with few, those with some not counted; then it takes a crowd again
    assert seen == [False, True, True, True, True, True, True, True, True, False, False, False]


@pytest.mark.nojit
def test_fewer_make_a_crowd_when_as_many_are_in_touch() -> None:
    memory = little(Scene("s", (), (hand(),))).memory
    seen = []
    for near, touching in ((TOUCHING + 1, TOUCHING), (TOUCHING, CROWD), (TOUCHING + 1, TOUCHING + 1)):
        memory.pairs.marks[NEAR_BODIES], memory.pairs.marks[LISTED] = near, touching
        seen.append(is_crowded(memory))
    assert seen == [False, False, True]


@pytest.mark.nojit
def test_joints_go_their_own_way_until_the_avatar_is_held_for_a_while() -> None:
    found = little(Scene("s", (), (hand(),)))
    (geo, skel, _, _), memory, seen = found.parts, found.memory, []
    held = int(HELD_FRAMES)
    for near, slow, touching in (
        (TOUCHING, 0, HELD_BY + 1), (CROWD + 1, 0, HELD_BY + 1), (CROWD + 1, held - 1, HELD_BY + 1),
        (CROWD + 1, held, HELD_BY + 1), (CROWD + 1, held, HELD_BY), (CROWD + 1, 0, HELD_BY + 1),
    ):
        memory.pairs.marks[NEAR_BODIES], memory.flags[SLOW], memory.pairs.marks[LISTED] = near, slow, touching
        seen.append(meet_a_crowd(geo, skel, memory))
    assert seen == [False, True, True, False, True, True]


def press(found: Little, *avatars: int, pairs: int = HELD_BY + 1) -> None:
    """List pairs in touch: one of the last link of each of these avatars and a wall, all others of two links of the first."""
    geo, skel, _, _ = found.parts
    half = len(skel.kind) // 2
    listed = [(half * k + half - 1, -1) for k in avatars] + [(0, 1)] * (pairs - len(avatars))
    for k, (link, other) in enumerate(listed):
        wall = geo.first_shape[skel.first + other] if other >= 0 else 0
        found.memory.pairs.listed[k] = [geo.first_shape[skel.first + link], wall]
    found.memory.pairs.marks[LISTED] = pairs


def test_who_is_held_by_few_or_by_their_own_links_strides_as_they_like() -> None:
    avatars = tuple(replace(mixed_avatar(), name=name) for name in ("one", "two"))
    found = little(Scene("s", (panel(),), avatars, start=random_sample(avatars, 1)))
    geo, skel, _, _ = found.parts
    roots = np.flatnonzero(skel.parent < 0)
    many = HELD_BY + 1
    for held, pairs, expected in (((), many, (False, False)), ((0, 1), HELD_BY, (False, False)), ((1,), many, (False, True))):
        press(found, *held, pairs=pairs)
        assert tuple(is_pressed(geo, skel, int(root), found.memory) for root in roots) == expected


@pytest.mark.parametrize("seed", range(6))
def test_a_stride_is_that_of_the_users_farthest_link_and_a_little(seed: int) -> None:
    avatars = tuple(replace(mixed_avatar(), name=name) for name in ("one", "two"))
    samples = [random_sample(avatars, 3 * seed + k) for k in range(3)]
    worlds = [build(Scene("there", (), avatars, start=sample)) for sample in samples]
    found = little(Scene("s", (panel(),), avatars, start=samples[0]))
    (geo, skel, _, _), goal = found.parts, found.memory.goal
    press(found, *(range(2) if seed % 2 else range(1, 2)))
    for k, posture in ((1, goal.before), (2, goal.tracker)):
        for there, now in zip(posture, worlds[k].posture, strict=True):
            there[:] = now
    goal.closeness.here[:] = worlds[0].poses.position
    measure_strides(geo, skel, found.memory)
    shown, before, user = (world.poses.position for world in worlds)
    np.testing.assert_array_equal(goal.stood, shown)
    half = len(shown) // 2
    for first, links in ((0, slice(0, half)), (half, slice(half, None))):
        strode = np.linalg.norm(user[links] - before[links], axis=1).max()
        behind = np.linalg.norm(user[links] - shown[links], axis=1).max()
        pressed = first > 0 or seed % 2
        assert goal.stride[first] == (pytest.approx(strode + max(SLIDE, CATCH_UP * behind), rel=1e-12) if pressed else UNLIMITED)


def crowded(stride: float, gone: float, seed: int, avatars: int = 1) -> Little:
    """Avatars in a crowd with strides [m], the first of which has gone some of it already [m], and the trial of a random step."""
    made = tuple(replace(mixed_avatar(), name=f"m{k}") for k in range(avatars))
    found = little(Scene("s", (), made, start=random_sample(made, seed)))
    geo, skel, posture, poses = found.parts
    memory = found.memory
    memory.goal.stride[:] = stride
    memory.goal.stood[:] = poses.position
    memory.goal.stood[0] -= gone * SHIFT
    memory.flags[CROWDED] = SPARSE_FRAMES
    memory.rows.x[:] = np.random.default_rng(seed).uniform(-0.03, 0.03, len(memory.rows.x))
    forward(geo, skel, posture, memory.rows.x, memory.trial, memory.trial_axes)
    return found


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("share", [0.0, 0.3, 0.999, 1.0, 2.0])
def test_a_step_is_shortened_along_itself_until_no_link_strides_too_far(share: float, seed: int) -> None:
    found = crowded(0.0, 0.0, seed)
    geo, skel, posture, poses = found.parts
    memory, step = found.memory, found.memory.rows.x.copy()
    ways = np.linalg.norm(memory.trial.position - poses.position, axis=1)
    memory.goal.stride[:] = share * ways.max()
    assert slide(geo, skel, posture, poses, memory) == (share < 1.0)
    x = memory.rows.x
    np.testing.assert_allclose(x, min(share, 1.0) * step, rtol=1e-12, atol=1e-300)
    # an arc is a little longer than its share of the chord
    assert np.linalg.norm(memory.trial.position - memory.goal.stood, axis=1).max() <= min(share, 1.0) * ways.max() * 1.02
    # the trial is that of the step, made anew or not
    trial = memory.trial.position.copy()
    forward(geo, skel, posture, x, memory.trial, memory.trial_axes)
    np.testing.assert_array_equal(trial, memory.trial.position)


@pytest.mark.parametrize(("gone", "left"), [(0.004, 0.006), (0.01, 0.0), (0.5, 0.0)])
def test_what_was_gone_in_this_frame_is_not_gone_again(gone: float, left: float) -> None:
    found = crowded(0.01, gone, seed=1)
    geo, skel, posture, poses = found.parts
    memory = found.memory
    memory.rows.x[:] = 0.0
    memory.rows.x[:3] = 0.02 * SHIFT
    memory.goal.stood[1:] = 1e3
    memory.goal.closeness.root[1:] = -1
    forward(geo, skel, posture, memory.rows.x, memory.trial, memory.trial_axes)
    assert share_left(skel, 0, poses, memory) == pytest.approx(left / 0.02, abs=1e-9)


def test_each_avatar_has_a_share_of_its_own() -> None:
    found = crowded(0.01, 0.0, seed=2, avatars=2)
    geo, skel, posture, poses = found.parts
    memory, before = found.memory, found.memory.rows.x.copy()
    half = int(skel.first_dof[np.flatnonzero(skel.parent < 0)[1]])
    memory.goal.stride[0] = 1e3
    assert slide(geo, skel, posture, poses, memory)
    np.testing.assert_array_equal(memory.rows.x[:half], before[:half])
    assert (np.abs(memory.rows.x[half:]) < 0.5 * np.abs(before[half:])).all()


def test_strides_are_long_without_a_crowd_to_a_user_elsewhere_and_on_a_free_way() -> None:
    found = crowded(0.0, 0.0, seed=3)
    geo, skel, posture, poses = found.parts
    memory, before = found.memory, found.memory.rows.x.copy()
    for flag, value, otherwise in ((TRAVELS, 1.0, 0.0), (SOUGHT, 1.0, 0.0), (CROWDED, 0.0, 1.0), (LED, UNDER_WAY, 0.0)):
        memory.flags[flag], memory.goal.led[0] = value, float(flag == LED)
        assert not slide(geo, skel, posture, poses, memory)
        memory.flags[flag] = otherwise
    np.testing.assert_array_equal(memory.rows.x, before)
    memory.goal.led[0] = 0.0
    assert slide(geo, skel, posture, poses, memory) and (memory.rows.x == 0.0).all()


def test_a_hand_that_comes_free_in_a_corner_does_not_jump() -> None:
    """The fourth seed: fingers wedged between two walls come free, and the hand jumped by 18 mm."""
    scenario = catalog.get("hand_in_corner").as_run(full=False)
    scene = scenario.build()
    motion, engine = scenario.motion(scene, 4), AvatarsimEngine()
    engine.load(scene, Settings(), scenario.dt)
    samples = [motion(k) for k in range(scenario.frames)]
    shown = np.array([engine.advance(sample, scenario.dt).shown.positions[len(scene.bodies)] for sample in samples])
    user = np.array([sample.positions[0] for sample in samples])
    ways = [np.linalg.norm(np.diff(path, axis=0), axis=1) for path in (shown, user)]
    assert np.linalg.norm(user - shown, axis=1).max() > 0.03
    assert (ways[0] - ways[1]).max() < 0.01
