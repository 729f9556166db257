"""State as bytes: a run from a snapshot goes on to the bit, and bytes of another origin are refused."""

import copy
import hashlib
import pickle
import subprocess
import sys
import zlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from avatarsim.engine import FrameRecord
from avatarsim.errors import AvatarsimError, InvalidSnapshot, NotCopied
from avatarsim.scene.avatar import rigid_avatar
from avatarsim.scene.body import fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.simulator import AvatarsimEngine
from avatarsim.snapshot import DIGEST, HEAD, digest_of, retained_fields
from tests.stability.hostile import DT, hinged_trial, hostile_motion
from tests.worlds.little_worlds import at
from tests.worlds.loaded import loaded
from tests.worlds.traps import limbed, pocket

FRAMES = 400
"""Frames after a snapshot that have to be the same."""

BALL, BRICK, FIST = (Piece(Sphere(0.05)),), (Piece(Box((0.1, 0.08, 0.06))),), (Piece(Sphere(0.04)),)
FLOOR = fixed("floor", (Piece(Box((4.0, 4.0, 0.1))),), "wood", (0.0, 0.0, -0.05))


def heap() -> Scene:
    """Return bricks that fall onto each other, and a fist that comes by when all are asleep."""
    loose = [
        simulated(f"{k}", BRICK, "wood", solid(BRICK, 0.2), (0.03 * (k % 2), 0.02 * (k % 3), 0.1 + 0.12 * k))
        for k in range(8)
    ]
    hand = rigid_avatar("hand", FIST, solid(FIST, 0.5))
    return Scene("heap", (FLOOR, *loose), (hand,), start=at(rest((hand,)), (-0.6, 0.0, 0.1)))


def past_the_heap(scene: Scene) -> Callable[[int], TrackerSample]:
    """Return a motion: the fist waits for seven seconds and then sweeps to and fro."""
    return lambda k: at(scene.first_sample, (-0.6 + (0.5 - 0.5 * np.cos(0.02 * max(0, k - 420))), 0.0, 0.1))


def trapped() -> Scene:
    """Return an avatar with a joint in a dead end."""
    avatar = limbed()
    return Scene("pocket", pocket(), (avatar,), start=at(rest((avatar,)), (-0.5, 0.0, 0.0)))


def out_of_the_pocket(scene: Scene) -> Callable[[int], TrackerSample]:
    """Into the dead end, and then to the far side of its end: to get there a way back and round has to be found. Then again."""
    return lambda k: at(scene.first_sample, (min(-0.5 + 0.01 * (k % 400), 0.25), 0.0, 0.0))


def room() -> tuple[Scene, Callable[[int], TrackerSample]]:
    """Return sixteen links in a room of thin walls, thrown about."""
    trial = hinged_trial()
    motion = [sample for _, sample in islice(hostile_motion(trial, 5, 40, 40), LATEST + FRAMES)]
    return trial.scene, lambda k: motion[k]


def as_said(found: FrameRecord) -> tuple[object, ...]:
    """Return hash, time, counts and statuses of a record, without statuses on frames that were not recorded."""
    statuses = {name: count for name, count in found.statuses.items() if "not recorded" not in name}
    return found.state_hash(), found.shown.time, dict(found.counts), statuses


Moment = Callable[[FrameRecord], bool]
MOMENTS: dict[str, Moment] = {
    "falling": lambda record: bool(np.abs(record.shown.velocities).max() > 0.5),
    "asleep": lambda record: record.counts["segments"] == 0,
    "searching": lambda record: "planning" in record.statuses,
    "walking": lambda record: "following" in record.statuses,
    "pushed": lambda record: record.counts.get("rows", record.counts.get("pushes", 0)) > 0,
}
"""State of the frame before a snapshot: bodies in the air, all at rest, a path that is looked for, one that is walked,
and an avatar that something holds back."""


@dataclass(frozen=True)
class Case:
    """A scene, its motion, and the moments in which snapshots are taken."""

    scene: Scene
    motion: Callable[[int], TrackerSample]
    moments: tuple[str, ...]
    method: str = "default"
    options: Mapping[str, float] = field(default_factory=dict)

    def engine(self, **settings: Any) -> AvatarsimEngine:
        """Return an engine that has loaded the scene."""
        return loaded(self.scene, self.method, options=self.options, **settings)


LATEST = 460
"""Frames within which all those moments come."""


@cache
def cases() -> dict[str, Case]:
    """Return all of them."""
    bricks, dead_end, hall = heap(), trapped(), room()
    return {
        "a heap": Case(bricks, past_the_heap(bricks), ("falling", "asleep")),
        "a heap, method paper": Case(bricks, past_the_heap(bricks), ("falling",), "paper"),
        "a path": Case(dead_end, out_of_the_pocket(dead_end), ("searching", "walking"), options={"work": 200}),
        "thrown about": Case(*hall, ("pushed",)),
        "thrown about, method paper": Case(*hall, ("pushed",), "paper"),
    }


def run_up(case: Case, engine: AvatarsimEngine) -> tuple[list[FrameRecord], dict[str, tuple[int, bytes]]]:
    """Records of the frames up to the last moment of the case, and the number of frames and the snapshot of each moment."""
    seen: list[FrameRecord] = []
    kept: dict[str, tuple[int, bytes]] = {}
    while len(kept) < len(case.moments):
        assert len(seen) < LATEST, f"of {case.moments} only {list(kept)} came"
        seen.append(engine.advance(case.motion(len(seen)), DT))
        for moment in case.moments:
            if moment not in kept and MOMENTS[moment](seen[-1]):
                kept[moment] = len(seen), engine.snapshot()
    return seen, kept


@pytest.mark.parametrize("name", list(cases()))
def test_frames_after_a_snapshot_are_the_same_to_the_bit(name: str) -> None:
    """In an engine that has been elsewhere, had another seed, and records."""
    case = cases()[name]
    one, other = case.engine(), case.engine(seed=9, record_inside=True)
    seen, kept = run_up(case, one)
    for k in range(len(seen), len(seen) + FRAMES):
        seen.append(one.advance(case.motion(k), DT))
    for k in range(40):
        other.advance(case.motion(len(seen) - 1 - 3 * k), DT)
    for begun, data in kept.values():
        assert other.restore(data).state_hash() == seen[begun - 1].state_hash()
        assert other.snapshot() == data
        for k in range(begun, begun + FRAMES):
            assert as_said(other.advance(case.motion(k), DT)) == as_said(seen[k]), k


ELSEWHERE = """
import sys
from pathlib import Path
from tests.test_snapshot import DROP, DT, loaded, rest
engine = loaded(DROP)
engine.restore(Path(sys.argv[1]).read_bytes())
print([engine.advance(rest(()), DT).state_hash() for _ in range(60)])
"""
DROP = Scene("drop", (FLOOR, simulated("ball", BALL, "wood", solid(BALL, 0.2), (0.0, 0.0, 0.6), velocity=(1.0, 2.0, 3.0))))


def test_another_process_goes_on_to_the_bit(tmp_path: Path) -> None:
    engine, kept = loaded(DROP), tmp_path / "state"
    for _ in range(15):
        engine.advance(rest(()), DT)
    kept.write_bytes(engine.snapshot())
    expected = [engine.advance(rest(()), DT).state_hash() for _ in range(60)]
    done = subprocess.run(
        [sys.executable, "-c", ELSEWHERE, str(kept)], capture_output=True, text=True, cwd=Path(__file__).parents[1]
    )
    assert done.stdout.strip() == str(expected), done.stderr


@pytest.fixture(name="taken", scope="module")
def _taken() -> tuple[AvatarsimEngine, bytes]:
    """An engine at the heap, a little later than the snapshot of it."""
    scene, motion = heap(), past_the_heap(heap())
    engine = loaded(scene)
    for k in range(20):
        engine.advance(motion(k), DT)
    data = engine.snapshot()
    engine.advance(motion(20), DT)
    return engine, data


def refused(engine: AvatarsimEngine, data: Any, match: str) -> None:
    """Check that the engine refuses the bytes, and is unchanged."""
    before = engine.snapshot()
    with pytest.raises(InvalidSnapshot, match=match):
        engine.restore(data)
    assert engine.snapshot() == before


@pytest.mark.parametrize("data", [None, "text", 7, [1, 2], np.zeros(3)])
def test_what_is_no_bytes_is_refused(taken: tuple[AvatarsimEngine, bytes], data: object) -> None:
    refused(taken[0], data, "valid: the bytes that engine.snapshot")


def test_other_bytes_are_refused(taken: tuple[AvatarsimEngine, bytes]) -> None:
    engine, data = taken
    refused(engine, b"", "length of the snapshot is 0")
    gone = memoryview(data)
    gone.release()
    refused(engine, gone, "valid: bytes in memory that has not been released")
    refused(engine, bytes(500), "beginning of the snapshot .* something else")
    refused(engine, pickle.dumps({"position": data}), "beginning of the snapshot")
    refused(engine, data.replace(b"\r\n", b"\n", 1), "beginning of the snapshot")


def test_damage_is_found_wherever_it_is(taken: tuple[AvatarsimEngine, bytes]) -> None:
    engine, data = taken
    for place in range(0, len(data), len(data) // 150):
        damaged = bytearray(data)
        damaged[place] ^= 0x10
        for other in (bytes(damaged), data[:place]):
            with pytest.raises(InvalidSnapshot):
                engine.restore(other)
    refused(engine, data + b"\0", "checksum")
    assert engine.restore(memoryview(data)).shown.time == pytest.approx(20 * DT)  # type: ignore[arg-type]


def test_a_snapshot_is_of_one_scene_with_one_set_of_options(taken: tuple[AvatarsimEngine, bytes]) -> None:
    data = taken[1]
    heavier = replace(heap(), bodies=(FLOOR, *(replace(body, mass=solid(BALL, 0.3)) for body in heap().bodies[1:])))
    refused(loaded(heavier), data, "digest of the scene of the snapshot")
    refused(loaded(heap(), options={"steps": 3}), data, "digest of the settings of the snapshot")
    refused(loaded(heap(), "paper"), data, "digest of the settings of the snapshot")


def test_start_and_recording_are_no_part_of_a_snapshot(taken: tuple[AvatarsimEngine, bytes]) -> None:
    hand = heap().avatars
    elsewhere = replace(heap(), start=at(rest(hand), (-1.0, 0.4, 0.3)))
    assert loaded(elsewhere, record_inside=True, time_stages=True, seed=4).restore(taken[1]).shown.time > 0.0


def resealed(data: bytes, body: bytes, size: int | None = None) -> bytes:
    """Return a snapshot with another body, under a checksum that is right."""
    *head, _ = HEAD.unpack_from(data)
    whole = HEAD.pack(*head, len(body) if size is None else size) + zlib.compress(body, 1)
    return whole + hashlib.blake2b(whole, digest_size=DIGEST).digest()


def test_arrays_of_another_size_are_refused(taken: tuple[AvatarsimEngine, bytes]) -> None:
    engine, data = taken
    body = zlib.decompress(data[HEAD.size : -DIGEST])
    refused(engine, resealed(data, body + bytes(8)), "size of the snapshot's arrays")
    refused(engine, resealed(data, bytes(10**8), len(body)), "arrays of the snapshot")
    refused(engine, resealed(data, body[:-8], len(body)), "arrays of the snapshot")
    refused(engine, resealed(data, b"\xff" * len(body)), "of the snapshot")


FORGED = [-(2**63), -(10**12), -2, -1, 0, 1, 5, 63, 10**6, 2**40, 2**63 - 1, 0x7FF0000000000000, 0x7FF8000000000000]
"""Words that are laid in: far too small and too large, nearly right, and the bits of infinity and of nan."""


@pytest.mark.parametrize("name", ["a heap", "a path", "a heap, method paper", "thrown about"])
def test_a_forged_number_is_refused_or_harmless(name: str) -> None:
    """A checksum keeps no forger out. With any number in a state, no kernel leaves its memory."""
    case = cases()[name]
    engine, rng, outcomes = case.engine(), np.random.default_rng(3), set()
    begun, data = run_up(case, engine)[1][case.moments[0]]
    body = zlib.decompress(data[HEAD.size : -DIGEST])
    used = np.flatnonzero(np.frombuffer(body, "<i8", len(body) // 8))
    for _ in range(150):
        forged = np.frombuffer(body[: len(body) // 8 * 8], "<i8").copy()
        forged[rng.choice(used if rng.random() < 0.7 else len(forged))] = FORGED[rng.integers(len(FORGED))]
        try:
            engine.restore(resealed(data, forged.tobytes() + body[len(body) // 8 * 8 :]))
            for k in range(3):
                engine.advance(case.motion(begun + k), DT)
            outcomes.add("harmless")
        except InvalidSnapshot:
            outcomes.add("refused")
        except AvatarsimError:
            outcomes.add("said in the frame")
    engine.restore(data)
    assert outcomes >= {"harmless", "refused"}


def forged(engine: AvatarsimEngine, data: bytes, name: str, change: Callable[[np.ndarray], None]) -> bytes:
    """Return a snapshot with one array changed, under a checksum that is right."""
    body, at = bytearray(zlib.decompress(data[HEAD.size : -DIGEST])), 0
    for kept in retained_fields(engine._running()):
        if kept.name == name:
            array = np.frombuffer(body, kept.array.dtype, kept.array.size, at).reshape(kept.array.shape)
            change(array)
            return resealed(data, bytes(body))
        at += kept.array.nbytes
    raise KeyError(name)


def test_a_posture_that_could_not_be_shown_is_refused() -> None:
    """Beyond a joint limit; a link moved whole, vertices and boxes too, into a body at rest."""
    case = cases()["thrown about"]
    engine = case.engine()
    data = run_up(case, engine)[1]["pushed"][1]
    limited = np.isfinite(engine._running().world.skeleton.limits[:, 1])
    beyond = forged(engine, data, "World.posture.angle", lambda angle: np.copyto(angle, angle + 50.0 * limited))
    refused(engine, beyond, "state in the snapshot.*start angle of a hinge")

    hand, way = (rigid_avatar("hand", FIST, solid(FIST, 0.5)),), np.array([0.0, 0.0, -0.5])
    one = loaded(Scene("over a floor", (FLOOR,), hand, start=at(rest(hand), (0.0, 0.0, 0.5))))
    data = one.snapshot()
    for name in ("position", "vertices"):
        data = forged(one, data, f"World.poses.{name}", lambda array: np.copyto(array[-1:], array[-1:] + way))
    for name in ("boxes", "hulls"):
        data = forged(one, data, f"World.poses.{name}", lambda array: np.copyto(array[-1:], array[-1:] + np.tile(way, 2)))
    refused(one, data, "state in the snapshot.*hand")


@pytest.mark.parametrize("way", [copy.copy, copy.deepcopy, pickle.dumps])
def test_engines_are_not_copied_and_the_error_says_what_to_do(way: Callable[[object], object]) -> None:
    for engine in (AvatarsimEngine(), loaded(DROP)):
        with pytest.raises(NotCopied, match=r"engine\.snapshot\(\).*restore\(\)"):
            way(engine)


def test_digests_tell_descriptions_apart() -> None:
    shapes = [Sphere(1.0), Sphere(2.0), Box((1.0, 1.0, 1.0)), (1.0, 2.0), (1.0, (2.0,)), "1", 1, None, True, {"a": 1}, {"a": 2}]
    assert len({digest_of(shape) for shape in shapes}) == len(shapes)
    assert digest_of(Sphere(1)) == digest_of(Sphere(1.0)) and digest_of({"a": 1, "b": 2}) == digest_of({"b": 2, "a": 1})
