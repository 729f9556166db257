"""Traps: found out of under the same certificate, said in the frame records, and jumped out of only where that is asked for."""

from collections.abc import Iterable

import numpy as np
import pytest

from avatarsim.engine import FrameRecord, Settings
from avatarsim.errors import InvalidInput
from avatarsim.posture.look import LOOK_EVERY
from avatarsim.scene.avatar import Avatar, Link, rigid_avatar
from avatarsim.scene.body import Body, fixed, simulated
from avatarsim.scene.checks import Vector
from avatarsim.scene.joint import Free, Hinge, Hinges
from avatarsim.scene.mass import solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.settings import PostureSettings
from avatarsim.simulator import AvatarsimEngine
from avatarsim.spatial import rotation
from reference.judge import Judge
from tests.stability.hostile import DT, link_error
from tests.worlds.little_worlds import at, hand, panel

SETTINGS = PostureSettings()
BEFORE, BEHIND = (-0.3, 0.0, 0.0), (0.3, 0.0, 0.0)
LARGEST_STEP = 2.0 * 3.0**0.5 * (SETTINGS.move_cap + SETTINGS.stray_move)
"""[m] what a root can move in a frame of two steps."""


def slab(name: str, centre: Vector, size: Vector) -> Body:
    """A fixed box."""
    return fixed(name, (Piece(Box(size)),), "wood", centre)


def pocket() -> tuple[Body, ...]:
    """A dead end, open towards -x, 0.3 m wide and 0.3 m deep, between -0.3 and 0."""
    return (
        slab("end", (0.02, 0.0, 0.0), (0.02, 0.4, 0.4)),
        slab("left", (-0.13, 0.17, 0.0), (0.3, 0.02, 0.4)),
        slab("right", (-0.13, -0.17, 0.0), (0.3, 0.02, 0.4)),
        slab("over", (-0.13, 0.0, 0.17), (0.3, 0.4, 0.02)),
        slab("under", (-0.13, 0.0, -0.17), (0.3, 0.4, 0.02)),
    )


def limbed() -> Avatar:
    """A ball of 5 cm with a smaller one on a hinge: an avatar with a joint."""
    ball, tip = (Piece(Sphere(0.05)),), (Piece(Sphere(0.03)),)
    joint = Hinges((Hinge((0.0, 0.0, 1.0), -1.0, 1.0),))
    links = (
        Link("root", None, Free(), ball, solid(ball, 1.0)),
        Link("tip", "root", joint, tip, solid(tip, 0.1), anchor=(-0.1, 0.0, 0.0)),
    )
    return Avatar("limbed", links, ("tip",))


def play(
    bodies: tuple[Body, ...], avatar: Avatar, start: Vector, samples: Iterable[Vector], seed: int = 0, **options: float
) -> tuple[list[FrameRecord], Scene]:
    """Records of all frames, in none of which anything overlaps."""
    scene = Scene("s", bodies, (avatar,), start=at(rest((avatar,)), start))
    engine, judge = AvatarsimEngine(), Judge(scene)
    engine.load(scene, Settings(options=options, seed=seed), DT)
    records = []
    for k, place in enumerate(samples):
        sample = at(scene.first_sample, place)
        records.append(engine.advance(TrackerSample(k * DT, sample.positions, sample.rotations, sample.angles), DT))
        shown = records[-1].shown
        assert judge.overlaps(shown.positions, shown.orientations).deepest == 0.0
    return records, scene


def goal(scene: Scene, place: Vector) -> TrackerSample:
    """The tracker's sample at a place."""
    return at(scene.first_sample, place)


def total(records: list[FrameRecord], name: str) -> int:
    """Sum of a count over all frames."""
    return sum(record.counts[name] for record in records)


def test_who_does_not_search_a_way_round_a_wall_is_as_near_as_it_can_be_before_it() -> None:
    """A bar that is pushed on its end through a wall turns broadside on, which brings its middle nearer to the tracker's."""
    lean = rotation.from_axis_angle((0.0, 0.0, 1.0), 0.3)
    bar = (Piece(Box((0.4, 0.05, 0.05)), (0.0, 0.0, 0.0), (float(lean[0]), 0.0, 0.0, float(lean[3]))),)
    beyond = [(0.9, 0.0, 0.0)] * 90
    wall = slab("wall", (0.5, 0.0, 0.0), (0.02, 3.0, 3.0))
    records, _ = play((wall,), rigid_avatar("bar", bar, solid(bar, 1.0)), (0.0, 0.0, 0.0), beyond)
    assert records[-1].counts["walled"] == 1
    # on its end, leaning by 0.3 rad, its middle would be 0.2 m before the wall
    assert 0.49 - records[-1].shown.positions[-1, 0] < 0.1
    # without limbs that could get caught there is nothing to wait for: it turns before anybody has looked what walls it off
    assert records[8].counts["walled"] == 0 and 0.49 - records[8].shown.positions[-1, 0] < 0.15


@pytest.mark.boundscheck
def test_a_dead_end_is_left_step_by_step() -> None:
    behind = [BEHIND] * 90
    stays, scene = play(pocket(), limbed(), (-0.1, 0.0, 0.0), behind, search_work=0)
    assert link_error(scene, stays[-1], goal(scene, BEHIND)) > 0.2
    leaves, _ = play(pocket(), limbed(), (-0.1, 0.0, 0.0), behind)
    assert link_error(scene, leaves[-1], goal(scene, BEHIND)) < 1e-6
    places = np.array([record.shown.positions[len(scene.bodies)] for record in leaves])
    assert np.linalg.norm(np.diff(places, axis=0), axis=1).max() < LARGEST_STEP
    assert total(leaves, "led") > 0 and total(leaves, "crossings") == total(leaves, "resyncs") == 0


def test_a_trap_is_said_as_long_as_it_lasts() -> None:
    there_and_back = [BEHIND] * 60 + [(-0.1, 0.0, 0.0)] * 30
    records, _ = play(pocket(), limbed(), (-0.1, 0.0, 0.0), there_and_back, search_work=0)
    said = [record.statuses.get("trapped", 0) for record in records]
    assert said == [record.counts["trapped"] for record in records]
    first = said.index(1)
    # the frame of the tracker's leap is the first of these frames; looked at every few
    assert SETTINGS.trapped_frames - 1 <= first <= SETTINGS.trapped_frames + LOOK_EVERY
    assert all(said[first:60]) and not any(said[61:])


def test_limbs_pressed_into_a_wall_are_not_trapped() -> None:
    records, scene = play((panel(0.2),), limbed(), BEFORE, [(-0.05, 0.0, 0.0)] * 80)
    assert link_error(scene, records[-1], goal(scene, (-0.05, 0.0, 0.0))) > 0.05
    assert total(records, "trapped") == total(records, "led") == total(records, "crossings") == 0


@pytest.mark.parametrize("avatar", [hand(), limbed()])
def test_who_is_walled_off_waits_and_says_so(avatar: Avatar) -> None:
    wide = (slab("wall", (0.0, 0.0, 0.0), (0.01, 40.0, 40.0)),)
    records, scene = play(wide, avatar, BEFORE, [BEHIND] * 90)
    assert all(record.shown.positions[1, 0] < 0.0 for record in records)
    assert records[-1].statuses["trapped"] == records[-1].statuses["walled"] == 1 and total(records, "crossings") == 0


def test_a_hand_without_joints_is_pushed_onto_a_table_and_not_led_round_it() -> None:
    table = (slab("table", (0.0, 0.0, 0.0), (0.05, 0.3, 0.3)),)
    waits, _ = play(table, hand(), BEFORE, [BEHIND] * 90)
    assert waits[-1].shown.positions[1, 0] < 0.0 and total(waits, "led") == 0
    goes, scene = play(table, hand(), BEFORE, [BEHIND] * 90, around=2)
    assert link_error(scene, goes[-1], goal(scene, BEHIND)) < 1e-6 and total(goes, "led") > 0
    limbs, _ = play(table, limbed(), BEFORE, [BEHIND] * 90, around=0)
    assert limbs[-1].shown.positions[1, 0] < 0.0 and total(limbs, "led") == 0


def boomed() -> Avatar:
    """A ball with a boom of 0.3 m towards -x that hardly turns."""
    ball, boom = (Piece(Sphere(0.05)),), (Piece(Box((0.24, 0.02, 0.02)), (-0.18, 0.0, 0.0)),)
    joint = Hinges((Hinge((0.0, 0.0, 1.0), -0.1, 0.1),))
    return Avatar(
        "boomed",
        (Link("root", None, Free(), ball, solid(ball, 1.0)), Link("boom", "root", joint, boom, solid(boom, 0.1))),
        ("boom",),
    )


POST = (slab("post", (-0.2, 0.1, 0.0), (0.02, 0.02, 20.0)),)
"""In the way of the boom, not of the ball."""


@pytest.mark.parametrize("walled", [True, False])
def test_a_jump_is_taken_only_where_it_is_asked_for_and_said(walled: bool) -> None:
    if walled:
        bodies, avatar, start, end = (panel(0.01),), limbed(), BEFORE, BEHIND
    else:
        bodies, avatar, start, end = POST, boomed(), (0.0, 0.0, 0.0), (0.0, 0.3, 0.0)
    other, asked = ("trapped_jump", "walled_jump") if walled else ("walled_jump", "trapped_jump")
    for options in ({}, {other: 30.0}):
        never, scene = play(bodies, avatar, start, [end] * 60, search_work=0, **options)
        assert total(never, "crossings") == 0
        assert never[-1].counts["trapped"] == 1 and never[-1].counts["walled"] == int(walled)
        assert link_error(scene, never[-1], goal(scene, end)) > 0.05
    once, _ = play(bodies, avatar, start, [end] * 60, search_work=0, **{asked: 30.0})
    crossed = [k for k, record in enumerate(once) if record.counts["crossings"]]
    # not before the thirtieth frame
    assert len(crossed) == 1 and crossed[0] >= 29
    assert once[crossed[0]].statuses["crossings"] == 1 and once[crossed[0]].statuses["trapped"] == 1
    assert link_error(scene, once[crossed[0]], goal(scene, end)) < 1e-6
    assert total(once[crossed[0] + 1 :], "trapped") == 0


def test_a_boom_behind_a_post_is_led_round_it() -> None:
    records, scene = play(POST, boomed(), (0.0, 0.0, 0.0), [(0.0, 0.3, 0.0)] * 60)
    assert link_error(scene, records[-1], goal(scene, (0.0, 0.3, 0.0))) < 1e-6
    assert total(records, "led") > 0


def test_a_boom_whose_user_comes_out_of_the_post_beyond_it_is_there_in_four_frames() -> None:
    places = [(0.0, 0.02 * k, 0.0) for k in range(12)]
    records, scene = play(POST, boomed(), (0.0, 0.0, 0.0), places)
    errors = [link_error(scene, record, goal(scene, place)) for record, place in zip(records, places, strict=True)]
    # post and boom are as thick as two centimetres together: inside from 0.08 to 0.12 m
    assert errors[6] > 0.005 and total(records[:7], "led") == 0
    # the way round is 0.7 m long, and a frame goes 0.3 m farther than its user
    assert records[7].counts["led"] > 0 and records[7].statuses["led"] == records[7].counts["led"]
    assert max(errors[10:]) < 1e-3 and total(records, "crossings") == total(records, "resyncs") == 0


def test_a_moving_tracker_is_followed_while_a_way_is_searched() -> None:
    wide = (slab("wall", (0.0, 0.0, 0.0), (0.01, 40.0, 40.0)),)
    sliding = [(0.3, 0.02 * k, 0.0) for k in range(90)]
    records, scene = play(wide, limbed(), BEFORE, sliding)
    for record, place in zip(records[20:], sliding[20:], strict=True):
        assert abs(record.shown.positions[1, 1] - place[1]) < 0.05
    assert total(records, "led") == 0


def test_a_tracker_that_jumps_away_ends_the_search_at_once() -> None:
    records, scene = play(pocket(), limbed(), (-0.1, 0.0, 0.0), [BEHIND] * 12 + [(-0.6, 0.0, 0.0)] * 20)
    assert link_error(scene, records[-1], goal(scene, (-0.6, 0.0, 0.0))) < 1e-6
    assert total(records[12:], "trapped") == 0


def test_the_seed_alone_decides_which_way_is_taken() -> None:
    def hashes(seed: int) -> list[str]:
        records, _ = play(pocket(), limbed(), (-0.1, 0.0, 0.0), [BEHIND] * 60, seed=seed)
        return [record.state_hash() for record in records]

    assert hashes(1) == hashes(1)
    assert hashes(1) != hashes(2)


@pytest.mark.parametrize("name", ["search_after", "search_work", "around", "trapped_frames", "trapped_jump", "walled_jump"])
@pytest.mark.parametrize("value", [-1, 0.5, float("nan"), "soon"])
def test_bad_values_of_the_settings_are_refused(name: str, value: object) -> None:
    scene = Scene("s", (panel(),), (hand(),), start=at(rest((hand(),)), BEFORE))
    with pytest.raises(InvalidInput, match=name):
        AvatarsimEngine().load(scene, Settings(options={name: value}), DT)


@pytest.mark.parametrize(("name", "value"), [("around", 3), ("untie", 2)])
def test_values_beyond_the_choices_are_refused(name: str, value: int) -> None:
    scene = Scene("s", (panel(),), (hand(),), start=at(rest((hand(),)), BEFORE))
    with pytest.raises(InvalidInput, match=name):
        AvatarsimEngine().load(scene, Settings(options={name: value}), DT)



def test_what_moves_elsewhere_does_not_make_frames_count_twice() -> None:
    """A ball that falls far away has the second half of each frame run; patience is in frames all the same."""
    ball = (Piece(Sphere(0.05)),)
    far = simulated("far", ball, "wood", solid(ball, 0.2), (50.0, 0.0, 0.0))
    crossed = []
    for more in ((), (far,)):
        records, _ = play((panel(0.01), *more), limbed(), BEFORE, [BEHIND] * 60, search_work=0, walled_jump=30)
        crossed.append([k for k, record in enumerate(records) if record.counts["crossings"]])
    assert len(crossed[0]) == 1 and crossed[0] == crossed[1]
