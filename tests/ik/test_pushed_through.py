"""A hand without joints that is pushed through a table lies on it, and what moves within a frame is bounded, kept and counted.

Longer by hand: python -m tests.ik.test_pushed_through --pushes 2000.
"""

import argparse
import sys
from typing import Any

import numpy as np
import pytest

from avatarsim.engine import FrameRecord, Settings
from avatarsim.posture.look import LOOK_EVERY
from avatarsim.scene.avatar import rigid_avatar
from avatarsim.scene.body import Body, fixed
from avatarsim.scene.checks import Vector
from avatarsim.scene.mass import solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Ellipsoid, Piece, Shape, Sphere, ellipsoid_hull
from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.settings import PostureSettings
from avatarsim.simulator import AvatarsimEngine
from reference.judge import Judge
from tests.ik.test_trapped import BEHIND, POST, boomed, limbed, pocket, slab
from tests.stability.hostile import DT
from tests.worlds.little_worlds import at, hand
from tests.worlds.ride import ride

SETTINGS = PostureSettings()
A_FRAME = SETTINGS.steps * SETTINGS.move_cap
"""[m] the stated budget of a root beyond its user's own way, in a frame without a leap."""
SETTLES = 2e-3
"""[m] how much farther than its user a hand goes that turns to lie flat, or is pushed along by another of its corners."""

PATIENCE = SETTINGS.trapped_frames + LOOK_EVERY
"""Frames after which a trap is said at the latest."""

TABLES = {"thin": (1.0, 1.0, 0.05), "small": (0.4, 0.3, 0.02), "thick": (2.0, 1.2, 0.1)}
SHAPES = {
    "sphere": lambda size: Sphere(size),
    "box": lambda size: Box((6.0 * size, 5.0 * size, 2.0 * size)),
    "hull": lambda size: ellipsoid_hull((3.3 * size, 2.7 * size, size)),
    "ellipsoid": lambda size: Ellipsoid((3.3 * size, 2.7 * size, size)),
}
SIZES = (0.015, 0.01504, 0.0173)
"""[m] half the thickness: with the first, and steps that divide it, the user's palm ends flat against the table's lower side."""


def check_push(shape: Shape, half: float, extent: Vector, step: float, seed: int, x: float = 0.0, y: float = 0.0) -> None:
    """Push a palm, `half` its thickness [m], by `step` [m] a frame down through a table at (x, y), 0.1 m beyond: it stays on it,
    goes no farther in a frame than its user and SETTLES, and says what happens."""
    palm, top = (Piece(shape),), 0.5 * extent[2] + half + 0.03
    avatar, table = rigid_avatar("hand", palm, solid(palm, 0.5)), fixed("table", (Piece(Box(extent)),), "wood")
    start = at(rest((avatar,)), (x, y, top))
    scene, engine = Scene("pushed", (table,), (avatar,), start=start), AvatarsimEngine()
    before = engine.load(scene, Settings(seed=seed, record_inside=True), DT)
    judge, frames = Judge(scene), int((2.0 * top + 0.1) / step)
    for k in range(1, frames + PATIENCE + 1):
        record = engine.advance(at(start, (x, y, top - step * min(k, frames))), DT)
        assert record.shown.positions[1, 2] > 0.5 * extent[2] + 0.9 * half
        assert path_of(record, before, 1) < step + SETTLES
        assert record.counts["led"] == record.counts["crossings"] == record.counts["leaps"] == 0
        if k % max(1, frames // 12) == 0:
            assert judge.overlaps(record.shown.positions, record.shown.orientations).deepest == 0.0
        before = record
    # the user rests below, clear of the table
    assert record.statuses == {"trapped": 1, "walled": 1}


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("kind", SHAPES)
@pytest.mark.parametrize("name", TABLES)
def test_a_palm_that_is_pushed_through_a_table_lies_on_it(name: str, kind: str, size: float) -> None:
    for step, seed in ((0.002, 0), (0.005, 1), (0.01, 2), (0.01, 3)):
        check_push(SHAPES[kind](size), size, TABLES[name], step, seed)


def drawn_push(rng: np.random.Generator) -> dict[str, Any]:
    """Arguments of `check_push`, half of the lengths on round numbers."""

    def length(low: float, high: float) -> float:
        drawn = float(rng.uniform(low, high))
        return round(drawn, 3) if rng.random() < 0.5 else drawn

    half, extent = length(0.005, 0.04), (length(0.3, 2.0), length(0.3, 2.0), length(0.01, 0.15))
    x, y = (0.3 * extent[k] * float(rng.uniform(-1.0, 1.0)) for k in range(2))
    kind = str(rng.choice(sorted(SHAPES)))
    step = float(rng.choice([0.002, 0.005, 0.01, 0.02, rng.uniform(0.001, 0.02)]))
    return {
        "shape": SHAPES[kind](half), "half": half, "extent": extent, "x": x, "y": y, "step": step,
        "seed": int(rng.integers(1000)),
    }


def test_so_does_any_palm_on_any_table() -> None:
    rng = np.random.default_rng(4)
    for _ in range(25):
        check_push(**drawn_push(rng))


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


def main() -> int:
    """Many pushes drawn at random; 1 if one ends anywhere but on the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pushes", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    chosen, failed = parser.parse_args(), 0
    rng = np.random.default_rng(chosen.seed)
    for k in range(chosen.pushes):
        push = drawn_push(rng)
        try:
            check_push(**push)
        except AssertionError as error:
            failed += 1
            print(f"push {k}: {push}\n    {error}", flush=True)
    print(f"{chosen.pushes} pushes through tables, {failed} failed")
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())
