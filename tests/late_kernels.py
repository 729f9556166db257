"""Small scenes in which, between them, everything happens that a frame may call a kernel for; see test_rehearsal."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from avatarsim.compile_ahead import part_scene
from avatarsim.engine import FrameRecord, Settings
from avatarsim.scene.avatar import Avatar
from avatarsim.scene.body import fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Piece, Sphere, ellipsoid_hull
from avatarsim.scene.tracker import TrackerSample, rest
from tests.stability.hostile import DT
from tests.worlds.little_worlds import at, hand, mixed_avatar, panel
from tests.worlds.traps import BEFORE, BEHIND, limbed, pocket


@dataclass(frozen=True)
class Case:
    """A scene, how it is loaded, the user's motion, and the events meanwhile: counts, statuses, events, or "sleep"."""

    scene: Scene
    settings: Settings
    samples: Sequence[TrackerSample]
    happens: tuple[str, ...]
    dt: float = DT

    def sleeps(self, record: FrameRecord) -> bool:
        """Return whether no simulated body had a segment to fly in this frame."""
        return self.scene.effects.dynamics and record.counts["segments"] == 0


FLOOR = fixed("floor", (Piece(Box((4.0, 4.0, 0.1))),), "wood", (0.0, 0.0, -0.05))
BALL, CRATE, EGG = (Piece(Sphere(0.05)),), (Piece(Box((0.1, 0.1, 0.1))),), (Piece(ellipsoid_hull((0.05, 0.06, 0.08))),)
"""Shapes of loose bodies."""


def loose(name: str, pieces: tuple[Piece, ...], x: float, height: float) -> Scene:
    """Return one loose body above a floor."""
    return Scene(name, (FLOOR, simulated(name, pieces, "metal", solid(pieces, 0.2), (x, 0.0, height))))


def downwards(scene: Scene, frames: int) -> list[TrackerSample]:
    """Move the first avatar down to the floor and into it, next to and onto the bodies there."""
    x, y, z = scene.first_sample.positions[0]
    return [at(scene.first_sample, (x, y, max(z - 0.02 * k, -0.1))) for k in range(frames)]


def among_things(avatar: Avatar, height: float) -> Scene:
    """Return an avatar above a ball, a crate and an egg on a floor."""
    things = tuple(body for k, pieces in enumerate((BALL, CRATE, EGG))
                   for body in loose(("ball", "crate", "egg")[k], pieces, 0.3 * k, 0.2).bodies[1:])
    return Scene("things", (FLOOR, *things), (avatar,), start=at(rest((avatar,)), (0.3, 0.0, height)))


TOGETHER, THINGS = part_scene("together")[0], among_things(mixed_avatar(), 1.0)
SLAB = among_things(hand((Piece(Capsule(0.03, 0.1)),)), 0.5)
WALLED = Scene("walled", (panel(),), (limbed(),), start=at(rest((limbed(),)), BEFORE))
POCKET = Scene("pocket", pocket(), (limbed(),), start=at(rest((limbed(),)), (-0.1, 0.0, 0.0)))
DROPPED = loose("crate", CRATE, 0.0, 0.3)
HIT = ("impact", "approach", "segments", "contacts")

CASES = {
    "every kind of joint and shape": Case(THINGS, Settings(record_inside=True), downwards(THINGS, 90), (*HIT, "queries")),
    "as printed": Case(THINGS, Settings("paper", record_inside=True), downwards(THINGS, 60), (*HIT, "rounds")),
    "timed": Case(SLAB, Settings(time_stages=True), downwards(SLAB, 60), ("impacts", "iterations")),
    "no overlap is removed": Case(
        replace(SLAB, narrow=("overlap_removal",)), Settings(), downwards(SLAB, 60), ("impacts",)
    ),
    "a way out is searched": Case(POCKET, Settings(), [at(POCKET.first_sample, BEHIND)] * 90, ("planning", "following")),
    "an avatar waits behind a wall": Case(
        WALLED, Settings(options={"around": 0}), [at(WALLED.first_sample, BEHIND)] * 60, ("waiting",)
    ),
    "a crate falls asleep": Case(DROPPED, Settings(record_inside=True), [DROPPED.first_sample] * 120, (*HIT, "sleep")),
}
