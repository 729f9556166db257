"""Checks of an engine that joins the comparison: `check_engine(MyEngine)`, for the tests of its adapter.

Small scenes without contact, in which the right answer is known: shapes and units of records, poses, velocities, limits,
determinism, refusals. Features that an engine reports as unsupported are not checked.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import closing, suppress
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.engine import Engine, FrameRecord, Settings, require_record
from avatarsim.errors import AvatarsimError, InvalidInput, MissingPackage, UnsupportedScene, described
from avatarsim.scene.avatar import Avatar, Link, rigid_avatar
from avatarsim.scene.body import Body, fixed, simulated, solid
from avatarsim.scene.joint import Hinge, Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Piece, Shape, Sphere
from avatarsim.scene.tracker import TrackerSample, link_poses
from avatarsim.spatial import rotation

Array = NDArray[np.float64]

DT = 1.0 / 60.0
"""Time of a frame [s]."""
FRAMES = 60
"""Frames of a check: a second."""
START_SLACK = 1e-5
"""Largest distance [m] of a first pose from the scene's, and angle [rad]: single precision passes, a wrong frame does not."""
FOLLOW_SLACK = 0.02
"""Largest distance [m] between a free hand and its user, half a second after the user stopped."""
LIMIT_SLACK = math.radians(3.0)
"""Largest angle [rad] beyond a limit: soft limits pass, missing ones do not."""
LIMIT = 0.5
"""Limit [rad] of the joint that is led beyond it."""
UNIT_SLACK = 1e-5
"""Largest difference of a quaternion's length from 1."""
SPIN = 2.0
"""Angular velocity [rad/s] of the body that spins, and its speed [m/s]."""

Make = Callable[[], Engine]
"""Class of an engine, or a function that makes one."""


@dataclass(frozen=True)
class Finding:
    """A fault of an engine.

    check  "protocol", "record", "start", "follows", "limits", "falls", "spins", "determinism", "refusals", "shapes" or "presets"
    scene  name of the scene, "" outside of one
    text   the expected and the actual value
    """

    check: str
    scene: str
    text: str

    def __str__(self) -> str:
        return f"{self.check}{f' ({self.scene})' if self.scene else ''}: {self.text}"


class Run(NamedTuple):
    """Records of a scene, the first of the load, and features that the engine lacks."""

    scene: Scene
    records: list[FrameRecord]
    lacks: Mapping[str, str]


def check_engine(make: Make, preset: str | None = None, *, raises: bool = True) -> tuple[Finding, ...]:
    """Check an engine.

    Args:
        make: its class, constructed without arguments.
        preset: its preset; the first without.
        raises: raise an AssertionError that names all findings; else they are returned.

    Returns:
        Its faults; empty for a sound engine.
    """
    findings = tuple(_findings(make, preset))
    if findings and raises:
        raise AssertionError("\n".join([f"{len(findings)} findings:", *map(str, findings)]))
    return findings


def _findings(make: Make, preset: str | None) -> Iterator[Finding]:
    try:
        engine = make()
    except Exception as error:
        yield Finding("protocol", "", f"it cannot be made: {described(error)}")
        return
    faults = list(_protocol(engine))
    yield from faults
    with suppress(Exception):
        engine.close()
    if faults:
        return
    chosen = preset or engine.presets[0]
    for check, scene, led, judge in CASES:
        try:
            run = ran(make, scene(), led, chosen)
            yield from _judged(run, check, judge)
            again = ran(make, scene(), led, chosen)
        except (UnsupportedScene, MissingPackage):
            continue
        except Exception as error:
            yield Finding(check, scene().name, described(error))
            continue
        if [one.state_hash() for one in run.records] != [one.state_hash() for one in again.records]:
            yield Finding("determinism", run.scene.name, "two fresh engines show different states for the same samples")
    yield from (Finding("refusals", "hand", text) for text in _refusals(make, chosen))
    yield from _shapes(make, chosen)
    yield from (Finding("presets", "hand", text) for text in _presets(make))


def _judged(run: Run, check: str, judge: Callable[[Run], Iterator[str]]) -> Iterator[Finding]:
    """Yield the faults of a run's records; of sound ones the findings of their judge."""
    if faults := list(_record_faults(run)):
        yield from (Finding("record", run.scene.name, text) for text in faults)
    else:
        yield from (Finding(check, run.scene.name, text) for text in judge(run))


def ran(make: Make, scene: Scene, led: Callable[[Scene, float], TrackerSample], preset: str) -> Run:
    """Run an engine through a scene for a second. Raises UnsupportedScene where it reports that it cannot."""
    with closing(make()) as engine:
        lacks = dict(engine.unsupported(scene))
        if "scene" in lacks:
            raise UnsupportedScene("scene", scene.name, lacks["scene"])
        records = [engine.load(scene, Settings(preset), DT)]
        lacks |= engine.unsupported(scene)
        for k in range(1, FRAMES + 1):
            records.append(engine.advance(led(scene, k * DT), DT))
        return Run(scene, records, lacks)


def _protocol(engine: object) -> Iterator[Finding]:
    """Yield faults of names and types."""
    parts = ("name", "version", "presets", "unsupported", "settings_as_run", "load", "advance", "close")
    if missing := [part for part in parts if not hasattr(engine, part)]:
        yield Finding("protocol", "", f"it has no {', '.join(missing)}")
        return
    for part in ("name", "version"):
        value = getattr(engine, part)
        if not isinstance(value, str) or not value:
            yield Finding("protocol", "", f"{part} is {value!r}; valid: a text")
    presets = engine.presets  # type: ignore[attr-defined]
    if not isinstance(presets, tuple) or not presets or not all(isinstance(one, str) for one in presets):
        yield Finding("protocol", "", f"presets are {presets!r}; valid: a tuple of texts, the default first")


def _record_faults(run: Run) -> Iterator[str]:
    """Yield the first fault of shapes, numbers, quaternions and times of records."""
    hinges = sum(avatar.hinge_count for avatar in run.scene.avatars)
    for k, record in enumerate(run.records):
        try:
            shown = require_record(record, run.scene.names, f"of frame {k}").shown
        except InvalidInput as error:
            yield str(error)
            return
        for name in ("positions", "orientations", "velocities", "angular_velocities"):
            if not np.isfinite(getattr(shown, name)).all():
                yield f"{name} of frame {k} are not all finite"
                return
        length = np.linalg.norm(shown.orientations, axis=1)
        if (np.abs(length - 1.0) > UNIT_SLACK).any():
            yield f"a quaternion of frame {k} has length {length[np.argmax(np.abs(length - 1.0))]:.6g}; valid: 1"
            return
        if len(record.angles) not in (0, hinges):
            yield f"frame {k} has {len(record.angles)} joint angles; valid: {hinges}, or none"
            return
        if abs(shown.time - k * DT) > 0.5 * DT:
            yield f"the time of frame {k} is {shown.time:.6g} s; valid: {k * DT:.6g} s, counted from load"
            return


def _start(run: Run) -> Iterator[str]:
    """Yield differences of the first poses from those of the scene."""
    shown, scene = run.records[0].shown, run.scene
    places, turns = link_poses(scene.avatars, scene.first_sample)
    places = np.vstack([np.array([body.position for body in scene.bodies]).reshape(-1, 3), places])
    turns = np.vstack([np.array([body.orientation for body in scene.bodies]).reshape(-1, 4), turns])
    off = np.linalg.norm(shown.positions - places, axis=1)
    turned = _angles(shown.orientations, turns)
    for k, name in enumerate(scene.names):
        if off[k] > START_SLACK or turned[k] > START_SLACK:
            yield (f"{name} begins {1e3 * off[k]:.3g} mm and {math.degrees(turned[k]):.3g} degrees from its place: "
                   "poses are of body frames, quaternions begin with the scalar")


def _follows(run: Run) -> Iterator[str]:
    """Yield the distance of a hand that meets no obstacle."""
    yield from _start(run)
    place, turn = link_poses(run.scene.avatars, _led_hand(run.scene, FRAMES * DT))
    shown = run.records[-1].shown
    off = float(np.linalg.norm(shown.positions[-1] - place[0]))
    turned = float(_angles(shown.orientations[-1:], turn)[0])
    if off > FOLLOW_SLACK or turned > LIMIT_SLACK:
        yield (f"a free hand is {1e3 * off:.3g} mm and {math.degrees(turned):.3g} degrees from its user, "
               "half a second after the user stopped")


def _limits(run: Run) -> Iterator[str]:
    """Yield the angle beyond limits of a joint whose user is 0.5 rad beyond."""
    yield from _start(run)
    if any("limit" in feature for feature in run.lacks):
        return
    turns = np.array([record.shown.orientations for record in run.records])
    angle = np.array(_angles(turns[:, -1], turns[:, -2]))
    if (most := float(angle.max())) > LIMIT + LIMIT_SLACK:
        yield f"a hinge with the limit {math.degrees(LIMIT):.3g} degrees turns by {math.degrees(most):.3g}"
    elif float(angle[-1]) < 0.5 * LIMIT:
        yield f"a hinge that is led to its limit of {math.degrees(LIMIT):.3g} degrees turns by {math.degrees(angle[-1]):.3g}"


def _falls(run: Run) -> Iterator[str]:
    """Yield differences of a falling ball from its closed form."""
    yield from _start(run)
    if "dynamics" in run.lacks:
        return
    height = np.array([record.shown.positions[0, 2] for record in run.records])
    speed = np.array([record.shown.velocities[0, 2] for record in run.records])
    g, t = run.scene.gravity[2], np.arange(len(height)) * DT
    off = np.abs(height - height[0] - 0.5 * g * t**2).max()
    # the error of a first-order integrator whose step is the frame
    if off > abs(g) * DT * t[-1]:
        yield f"a ball falls {off:.3g} m otherwise than g t^2 / 2 in a second"
    if (wrong := np.abs(speed - g * t).max()) > 2.0 * abs(g) * DT:
        yield f"the velocity of a falling ball differs by {wrong:.3g} m/s from g t; velocities are in world axes, in m/s"


def _spins(run: Run) -> Iterator[str]:
    """Yield differences of the motion of a free body from the velocities that are shown with it."""
    yield from _start(run)
    if "dynamics" in run.lacks:
        return
    mass = run.scene.bodies[0].mass
    assert mass is not None
    shown = [record.shown for record in run.records]
    turns = np.array([one.orientations[0] for one in shown])
    centres = np.array([one.positions[0] for one in shown]) + rotation.rotate(turns, np.asarray(mass.centre))
    moved = np.diff(centres, axis=0) / DT
    if (wrong := np.abs(moved - np.array([one.velocities[0] for one in shown[1:]])).max()) > 0.05 * SPIN:
        yield f"the velocity of a free body differs by {wrong:.3g} m/s from its motion: velocities are of the centre of mass"
    turn = rotation.to_rotation_vector(rotation.multiply(turns[1:], rotation.conjugate(turns[:-1]))) / DT
    if (wrong := np.abs(turn - np.array([one.angular_velocities[0] for one in shown[1:]])).max()) > 0.05 * SPIN:
        yield f"the angular velocity of a free body differs by {wrong:.3g} rad/s from its motion; it is in world axes"


def _refusals(make: Make, preset: str) -> Iterator[str]:
    """Yield wrong inputs that are taken, or refused by another error than InvalidInput."""
    scene = _hand()
    sample = scene.first_sample
    broken = replace(sample, positions=np.full_like(sample.positions, np.nan))
    short = replace(sample, positions=sample.positions[:0])
    cases: tuple[tuple[str, Settings, TrackerSample, float], ...] = (
        ("a preset that it does not have", Settings("no such preset"), sample, DT),
        ("an option that it does not have", Settings(preset, {"no such option": 1.0}), sample, DT),
        ("a tracker sample of NaN", Settings(preset), broken, DT), ("a sample without its link", Settings(preset), short, DT),
        ("a frame of 0 s", Settings(preset), sample, 0.0),
    )
    for what, settings, led, dt in cases:
        try:
            with closing(make()) as engine:
                engine.load(scene, settings, DT)
                engine.advance(led, dt)
        except InvalidInput:
            continue
        except Exception as error:
            yield f"{what} raises {described(error)}; valid: avatarsim.errors.InvalidInput, or a kind of it"
        else:
            yield f"{what} is taken; valid: avatarsim.errors.InvalidInput, or a kind of it"


def _shapes(make: Make, preset: str) -> Iterator[Finding]:
    """Yield shapes at which an engine fails otherwise than by a typed refusal."""
    cube = np.array([[x, y, z] for x in (-0.1, 0.1) for y in (-0.1, 0.1) for z in (-0.1, 0.1)])
    shapes: tuple[Shape, ...] = (
        Sphere(0.1), Capsule(0.05, 0.2), Box((0.1, 0.2, 0.3)), Ellipsoid((0.1, 0.2, 0.15)), ConvexHull(cube)
    )
    for shape in shapes:
        pieces = (Piece(shape),)
        scene = Scene("shape", (simulated("thing", pieces, "wood", solid(pieces, 1.0)),))
        try:
            run = ran(make, scene, lambda scene, time: replace(scene.first_sample, time=time), preset)
        except AvatarsimError:
            continue
        except Exception as error:
            valid = "avatarsim.errors.UnsupportedShape where it has none"
            yield Finding("shapes", scene.name, f"{type(shape).__name__} raises {described(error)}; valid: {valid}")
            continue
        yield from _judged(run, "shapes", _start)


def _presets(make: Make) -> Iterator[str]:
    """Yield presets that do not load, and settings that are no mapping."""
    with closing(make()) as engine:
        names = engine.presets
    for name in names:
        try:
            with closing(make()) as engine:
                engine.load(_hand(), Settings(name), DT)
                if not isinstance(engine.settings_as_run(), Mapping):
                    yield f"settings_as_run of preset {name} is no mapping"
        except Exception as error:
            yield f"preset {name} does not load: {described(error)}"


def _angles(a: Array, b: Array) -> Array:
    """Return the angles [rad] between orientations (..., 4)."""
    turn = rotation.to_rotation_vector(rotation.multiply(a, rotation.conjugate(b)))
    angles: Array = np.linalg.norm(turn, axis=-1)
    return angles


def _hand() -> Scene:
    """Return a hand that is turned and off the origin, over a floor that it does not reach."""
    pieces = (Piece(Box((0.1, 0.08, 0.03))),)
    turned = tuple(rotation.from_axis_angle((0.0, 0.0, 1.0), 0.7))
    start = TrackerSample(0.0, np.array([[0.2, 0.1, 0.5]]), np.array([turned]), np.zeros(0))
    floor = fixed("floor", (Piece(Box((2.0, 2.0, 0.1))),), "wood", position=(0.0, 0.0, -0.05))
    return Scene("hand", (floor,), (rigid_avatar("hand", pieces, solid(pieces, 0.5)),), start=start)


def _led_hand(scene: Scene, time: float) -> TrackerSample:
    """Return the user's hand: half a second to the side, then still."""
    first = scene.first_sample
    return replace(first, time=time, positions=first.positions + [0.1 * min(time, 0.5), 0.0, 0.0])


def _arm() -> Scene:
    """Return two links with a hinge between them, the first fixed to the world."""
    pieces = (Piece(Capsule(0.03, 0.2), (0.15, 0.0, 0.0), (math.sqrt(0.5), 0.0, math.sqrt(0.5), 0.0)),)
    hinge = Hinges((Hinge((0.0, 1.0, 0.0), -LIMIT, LIMIT),))
    mass = solid(pieces, 1.0)
    upper = Link("upper", None, hinge, pieces, mass, anchor=(0.0, 0.0, 1.0))
    lower = Link("lower", "upper", hinge, pieces, mass, anchor=(0.32, 0.0, 0.0))
    return Scene("arm", (), (Avatar("arm", (upper, lower)),))


def _led_arm(scene: Scene, time: float) -> TrackerSample:
    """Return the user's arm: the second joint goes to twice its limit in half a second."""
    return replace(scene.first_sample, time=time, angles=np.array([0.0, 2.0 * LIMIT * min(2.0 * time, 1.0)]))


def _ball() -> Scene:
    """Return a ball in the air."""
    pieces = (Piece(Sphere(0.05)),)
    return Scene("ball", (simulated("ball", pieces, "wood", solid(pieces, 1.0), (0.0, 0.0, 10.0)),))


def _thrown() -> Scene:
    """Return a body that flies and spins about a principal axis, without gravity; its frame is not in its centre of mass."""
    pieces = (Piece(Box((0.1, 0.1, 0.1)), (0.2, 0.0, 0.0)),)
    along, about = (SPIN, 0.0, 0.0), (0.0, 0.0, SPIN)
    high = (0.0, 0.0, 10.0)
    thing: Body = simulated("thing", pieces, "wood", solid(pieces, 1.0), high, velocity=along, angular_velocity=about)
    return Scene("thrown", (thing,), gravity=(0.0, 0.0, 0.0))


def _alone(scene: Scene, time: float) -> TrackerSample:
    """Return the sample of a scene without avatars."""
    return replace(scene.first_sample, time=time)


CASES = (
    ("follows", _hand, _led_hand, _follows), ("limits", _arm, _led_arm, _limits), ("falls", _ball, _alone, _falls),
    ("spins", _thrown, _alone, _spins),
)
"""Check, scene, motion of its user, and judge of the records."""
