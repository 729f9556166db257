"""A hand without joints that is pushed through a table lies on it, and what moves within a frame is bounded, kept and counted."""

import numpy as np
import pytest

from avatarsim.engine import FrameRecord, Settings
from avatarsim.scene.avatar import rigid_avatar
from avatarsim.scene.body import Body, fixed
from avatarsim.scene.mass import solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Ellipsoid, Piece, Shape, Sphere, ellipsoid_hull
from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.settings import PostureSettings
from avatarsim.simulator import AvatarsimEngine
from reference.judge import Judge
from tests.posture.little_worlds import at, hand
from tests.posture.ride import ride
from tests.posture.test_trapped import BEHIND, POST, boomed, limbed, pocket, slab
from tests.stability.hostile import DT

SETTINGS = PostureSettings()
A_FRAME = SETTINGS.steps * SETTINGS.move_cap
"""[m] the stated budget of a root beyond its user's own way, in a frame without a leap."""
SETTLES = 2e-3
"""[m] how much farther than its user a hand goes that turns to lie flat, or is pushed along by another of its corners."""

TABLES = {"thin": (1.0, 1.0, 0.05), "small": (0.4, 0.3, 0.02), "thick": (2.0, 1.2, 0.1)}
SHAPES = {
    "sphere": lambda size: Sphere(size),
    "box": lambda size: Box((6.0 * size, 5.0 * size, 2.0 * size)),
    "hull": lambda size: ellipsoid_hull((3.3 * size, 2.7 * size, size)),
    "ellipsoid": lambda size: Ellipsoid((3.3 * size, 2.7 * size, size)),
}
SIZES = (0.015, 0.01504, 0.0173)
"""[m] half the thickness: with the first, and steps that divide it, the user's palm ends flat against the table's lower side."""


def pushed(shape: Shape, table: Body, step: float, seed: int) -> list[FrameRecord]:
    """Records of a palm that starts 0.1 m above a table's centre and is pushed down by `step` [m] a frame, 0.15 m beyond."""
    palm, top = (Piece(shape),), 0.1
    avatar = rigid_avatar("hand", palm, solid(palm, 0.5))
    start = at(rest((avatar,)), (0.0, 0.0, top))
    engine = AvatarsimEngine()
    engine.load(Scene("pushed", (table,), (avatar,), start=start), Settings(seed=seed, record_inside=True), DT)
    judge, records = Judge(Scene("pushed", (table,), (avatar,), start=start)), []
    for k in range(1, int(0.25 / step) + 1):
        records.append(engine.advance(at(start, (0.0, 0.0, top - step * k)), DT))
    shown = [record.shown for record in records[:: max(1, len(records) // 12)]] + [records[-1].shown]
    assert all(judge.overlaps(one.positions, one.orientations).deepest == 0.0 for one in shown)
    return records


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("kind", SHAPES)
@pytest.mark.parametrize("name", TABLES)
def test_a_palm_that_is_pushed_through_a_table_lies_on_it(name: str, kind: str, size: float) -> None:
    extent, shape = TABLES[name], SHAPES[kind](size)
    for step, seed in ((0.002, 0), (0.005, 1), (0.01, 2), (0.01, 3)):
        records = pushed(shape, fixed("table", (Piece(Box(extent)),), "wood"), step, seed)
        places = np.array([record.shown.positions[1] for record in records])
        above = 0.5 * extent[2] + 0.9 * size
        assert places[:, 2].min() > above, (step, seed)
        assert np.linalg.norm(np.diff(places, axis=0), axis=1).max() < step + SETTLES, (step, seed)
        for record in records:
            assert record.counts["led"] == record.counts["crossings"] == record.counts["leaps"] == 0
        # once the user is clear of it below, the hand is said to be walled off
        assert records[-1].statuses["trapped"] == records[-1].statuses["walled"] == 1


@pytest.mark.parametrize("gap", [0.0, 1e-17, 1e-12, 1e-7, 4e-5, 6e-5])
def test_a_target_that_touches_the_far_side_is_none_to_lead_to(gap: float) -> None:
    """No path ends where a certified step could not; a target 6e-5 m off is free, and is gone to round the table if asked."""
    table = slab("table", (0.0, 0.0, 0.0), (0.05, 0.3, 0.3))
    beyond = (0.025 + 0.05 + gap, 0.0, 0.0)
    for around in (0, 1, 2):
        go = ride(Scene("s", (table,), (hand(),), start=at(rest((hand(),)), (-0.3, 0.0, 0.0))), around=around)
        led = 0
        for _ in range(60):
            led += go.frame(at(go.scene.first_sample, beyond)).counts["led"]
        assert (led > 0) == (gap > SETTINGS.least_gap and around == 2)
        assert (go.record.shown.positions[1, 0] > 0.0) == (led > 0)


def test_a_hand_without_joints_waits_beside_an_avatar_that_has_some() -> None:
    """Each avatar for itself: that another one has joints does not lead a palm round its table."""
    table, other = slab("table", (0.0, 0.0, 0.0), (0.05, 0.3, 0.3)), limbed()
    pair = (hand(), other)
    home = rest(pair)

    def users(x: float, y: float) -> TrackerSample:
        positions = home.positions.copy()
        positions[0], positions[1] = (x, 0.0, 0.0), (-0.1 if y == 0.0 else 0.3, 5.0 + y, 0.0)
        return TrackerSample(0.0, positions, home.rotations, home.angles)

    dead_end = tuple(slab(f"far {body.name}", (body.position[0], body.position[1] + 5.0, body.position[2]), box_of(body))
                     for body in pocket())
    go = ride(Scene("s", (table, *dead_end), pair, start=users(-0.3, 0.0)))
    for _ in range(40):
        go.frame(users(0.3, 0.0))
    assert go.place("hand")[0] < 0.0 and go.record.statuses["walled"] == 1
    led = 0
    for _ in range(120):
        # the hand waits for good, which keeps no path from the other
        led += go.frame(users(0.3, 1e-9)).counts["led"]
        assert go.place("hand")[0] < 0.0
    assert led > 0 and np.allclose(go.record.shown.positions[len(dead_end) + 2], (0.3, 5.0, 0.0), atol=1e-6)


def box_of(body: Body) -> tuple[float, float, float]:
    """Extent of a body of one box."""
    (piece,) = body.pieces
    assert isinstance(piece.shape, Box)
    return piece.shape.size


def path_of(record: FrameRecord, before: FrameRecord, root: int) -> float:
    """Length [m] of a root's way through all states of a frame."""
    places = np.array([before.shown.positions[root], *(one.positions[root] for one in record.inside)])
    return float(np.linalg.norm(np.diff(places, axis=0), axis=1).sum())


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("slow", [True, False])
def test_a_planned_path_is_walked_within_the_budget_of_each_frame_and_every_step_is_kept(slow: bool, seed: int) -> None:
    bodies, avatar = pocket(), limbed()
    scene = Scene("s", bodies, (avatar,), start=at(rest((avatar,)), (-0.1, 0.0, 0.0)))
    engine, judge = AvatarsimEngine(), Judge(scene)
    before = engine.load(scene, Settings(seed=seed, record_inside=True), DT)
    root, led, user = len(bodies), 0, -0.1
    for _ in range(150):
        moved = min(0.02 if slow else 0.25, BEHIND[0] - user)
        user += moved
        record = engine.advance(at(scene.first_sample, (user, 0.0, 0.0)), DT)
        # a step that contacts shove aside may go a little farther
        assert path_of(record, before, root) <= moved + A_FRAME + SETTINGS.stray_move
        assert len(record.inside) == max(1, record.counts["adopted"])
        assert record.statuses.get("led", 0) == record.counts["led"] <= record.counts["adopted"] + SETTINGS.steps
        if record.counts["led"]:
            deepest = [judge.overlaps(one.positions, one.orientations).deepest for one in record.inside]
            assert max(deepest) == 0.0 and np.array_equal(record.inside[-1].positions, record.shown.positions)
        led, before = led + record.counts["led"], record
    assert led > 0 and np.allclose(record.shown.positions[root], BEHIND, atol=1e-6)


def test_a_leap_is_counted_said_and_kept_step_by_step() -> None:
    ball, far = hand(), slab("far", (0.0, 9.0, 0.0), (1.0, 1.0, 1.0))
    scene, engine = Scene("s", (far,), (ball,), start=at(rest((ball,)), (0.0, 0.0, 0.0))), AvatarsimEngine()
    engine.load(scene, Settings(record_inside=True), DT)
    record = engine.advance(at(scene.first_sample, (3.0, 0.0, 0.0)), DT)
    assert record.statuses == {"leaps": 1} and record.counts["leaps"] == 1
    places = np.array([one.positions[1] for one in record.inside])
    assert len(places) == record.counts["adopted"] >= 3.0 / SETTINGS.move_cap - 1e-9
    assert np.diff(places[:, 0]).max() <= SETTINGS.move_cap + 1e-12 and np.array_equal(places[-1], (3.0, 0.0, 0.0))


def test_a_boom_that_is_swung_round_a_post_turns_and_moves_within_the_budget() -> None:
    avatar = boomed()
    scene = Scene("s", POST, (avatar,), start=at(rest((avatar,)), (0.0, 0.0, 0.0)))
    engine = AvatarsimEngine()
    before, led = engine.load(scene, Settings(record_inside=True), DT), 0
    for k in range(30):
        record = engine.advance(at(scene.first_sample, (0.0, min(0.02 * k, 0.3), 0.0)), DT)
        assert path_of(record, before, 1) <= 0.02 + A_FRAME + SETTINGS.stray_move
        led, before = led + record.counts["led"], record
    assert led > 0 and np.allclose(record.shown.positions[1], (0.0, 0.3, 0.0), atol=1e-6)


def test_a_frame_that_is_not_recorded_keeps_nothing_and_shows_the_same() -> None:
    hashes = []
    for record_inside in (False, True):
        scene = Scene("s", POST, (boomed(),), start=at(rest((boomed(),)), (0.0, 0.0, 0.0)))
        engine = AvatarsimEngine()
        engine.load(scene, Settings(record_inside=record_inside), DT)
        records = [engine.advance(at(scene.first_sample, (0.0, 0.02 * k, 0.0)), DT) for k in range(16)]
        assert all(bool(record.inside) == record_inside for record in records)
        hashes.append([record.state_hash() for record in records])
    assert hashes[0] == hashes[1]


def test_a_capsule_on_its_side_is_a_hand_like_any_other() -> None:
    lying = (Piece(Capsule(0.015, 0.08), (0.0, 0.0, 0.0), (0.5**0.5, 0.5**0.5, 0.0, 0.0)),)
    avatar, table = rigid_avatar("hand", lying, solid(lying, 0.5)), slab("table", (0.0, 0.0, 0.0), TABLES["thin"])
    go = ride(Scene("s", (table,), (avatar,), start=at(rest((avatar,)), (0.0, 0.0, 0.1))))
    for k in range(40):
        go.frame(at(go.scene.first_sample, (0.0, 0.0, 0.1 - 0.005 * k)))
        assert go.record.shown.positions[1, 2] > 0.04 and go.record.counts["led"] == 0
