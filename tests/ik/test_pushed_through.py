"""A hand without joints that is pushed through a table lies on it, and goes no farther in a frame than its user.

Longer by hand: python -m tests.ik.test_pushed_through --pushes 2000.
"""

import argparse
import sys
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from avatarsim.engine import FrameRecord, Settings
from avatarsim.scene.avatar import rigid_avatar
from avatarsim.scene.body import fixed, solid
from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Ellipsoid, Piece, Shape, Sphere, ellipsoid_hull
from avatarsim.scene.tracker import rest
from avatarsim.settings import PostureSettings
from avatarsim.simulator import AvatarsimEngine
from reference.judging.judge import Judge
from tests.stability.hostile import DT
from tests.worlds.little_worlds import at, block, hand
from tests.worlds.ride import ride

SETTINGS = PostureSettings()
SETTLES = 2e-3
"""[m] how much farther than its user a hand goes that turns to lie flat, or is pushed along by another of its corners."""

PATIENCE = 2 + int(SETTINGS.stall_time / DT)
"""Frames after which a waiting avatar must report it."""

TABLES = {"thin": (1.0, 1.0, 0.05), "small": (0.4, 0.3, 0.02), "thick": (2.0, 1.2, 0.1)}
SHAPES: dict[str, Callable[[float], Shape]] = {
    "sphere": lambda size: Sphere(size),
    "box": lambda size: Box((6.0 * size, 5.0 * size, 2.0 * size)),
    "hull": lambda size: ellipsoid_hull((3.3 * size, 2.7 * size, size)),
    "ellipsoid": lambda size: Ellipsoid((3.3 * size, 2.7 * size, size)),
}
SIZES = (0.015, 0.01504, 0.0173)
"""[m] half the thickness: with the first, and steps that divide it, the user's palm ends flat against the table's lower side."""


def check_push(shape: Shape, half: float, extent: Vector, step: float, seed: int, x: float = 0.0, y: float = 0.0) -> None:
    """Push a palm, `half` its thickness [m], by `step` [m] a frame down through a table at (x, y), 0.1 m beyond: it stays on it,
    goes no farther in a frame than its user and SETTLES, and reports its state."""
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
        assert record.counts["following"] == 0
        if k % max(1, frames // 12) == 0:
            assert judge.overlaps(record.shown.positions, record.shown.orientations).deepest == 0.0
        before = record
    # the user rests below, clear of the table
    assert record.statuses == {"waiting": 1}


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("kind", SHAPES)
@pytest.mark.parametrize("name", TABLES)
def test_a_palm_that_is_pushed_through_a_table_lies_on_it(name: str, kind: str, size: float) -> None:
    for step, seed in ((0.002, 0), (0.005, 1), (0.01, 2), (0.01, 3)):
        check_push(SHAPES[kind](size), size, TABLES[name], step, seed)


def drawn_push(rng: np.random.Generator) -> dict[str, Any]:
    """Return arguments of `check_push`, half of the lengths on round numbers."""

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


@pytest.mark.parametrize("around", [0, 1, 2])
@pytest.mark.parametrize("gap", [0.0, 1e-12, 1e-7, 2e-3])
def test_leads_to_the_far_side_only_if_asked_for(gap: float, around: int) -> None:
    table = block("table", (0.0, 0.0, 0.0), (0.05, 0.3, 0.3))
    go = ride(Scene("s", (table,), (hand(),), start=at(rest((hand(),)), (-0.3, 0.0, 0.0))), around=around)
    led = sum(go.frame(at(go.scene.first_sample, (0.025 + 0.05 + gap, 0.0, 0.0))).counts["following"] for _ in range(240))
    assert (led > 0) == (around == 2) and (go.record.shown.positions[1, 0] > 0.0) == (led > 0)


def path_of(record: FrameRecord, before: FrameRecord, root: int) -> float:
    """Return length [m] of a root's way through all states of a frame."""
    places = np.array([before.shown.positions[root], *(one.positions[root] for one in record.inside)])
    return float(np.linalg.norm(np.diff(places, axis=0), axis=1).sum())


def test_a_capsule_on_its_side_is_a_hand_like_any_other() -> None:
    lying = (Piece(Capsule(0.015, 0.08), (0.0, 0.0, 0.0), (0.5**0.5, 0.5**0.5, 0.0, 0.0)),)
    avatar, table = rigid_avatar("hand", lying, solid(lying, 0.5)), block("table", (0.0, 0.0, 0.0), TABLES["thin"])
    go = ride(Scene("s", (table,), (avatar,), start=at(rest((avatar,)), (0.0, 0.0, 0.1))))
    for k in range(40):
        go.frame(at(go.scene.first_sample, (0.0, 0.0, 0.1 - 0.005 * k)))
        assert go.record.shown.positions[1, 2] > 0.04 and go.record.counts["following"] == 0


def main() -> int:
    """Run many pushes drawn at random; return 1 if one ends anywhere but on the table."""
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
