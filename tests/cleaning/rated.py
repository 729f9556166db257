"""Robots for streams with limits of speed and acceleration, an independent measure of these, and a plain twin of the filter."""

from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from avatarsim.assets.models.coordinates import WIDTHS, Coordinates, coordinates_of
from avatarsim.assets.models.load import load_avatar
from avatarsim.assets.models.model import Model
from avatarsim.scene.body import Body, fixed
from avatarsim.scene.shape import Box, Piece
from avatarsim.spatial import rotation
from tests.worlds.little_worlds import mixed_avatar

TWO_ARMS = """<mujoco model="two arms"><compiler angle="radian"/><worldbody>
<body name="torso" pos="0 0 0.5"><geom type="box" size="0.1 0.15 0.25"/>
{arms}
</body>{bodies}</worldbody></mujoco>"""

ARM = """<body name="{s} upper" pos="0 {y} 0.2"><joint name="{s} lift" axis="1 0 0" range="-1.5 1.5"/>
<joint name="{s} swing" axis="0 1 0" range="-2.5 2.5"/><geom type="capsule" size="0.04" fromto="0 0 -0.05 0 0 -0.3"/>
<body name="{s} lower" pos="0 0 -0.35"><joint name="{s} elbow" axis="0 1 0" range="-2.4 0.2"/>
<geom type="capsule" size="0.035" fromto="0 0 -0.03 0 0 -0.25"/>
<body name="{s} palm" pos="0 0 -0.3"><joint name="{s} wrist" axis="0 0 1" range="-2 2"/>
<geom type="box" size="0.05 0.02 0.05"/></body></body></body>"""

WALL_AND_TABLE = (((0.1, 3.0, 3.0), (0.55, 0.0, 0.5)), ((0.4, 0.6, 0.04), (0.3, 0.5, 0.35)))
"""Sizes and places [m] of a wall and a table."""


def room() -> tuple[Body, ...]:
    """Return the wall and the table as bodies."""
    return tuple(fixed(f"body {k}", (Piece(Box(size)),), "wood", at) for k, (size, at) in enumerate(WALL_AND_TABLE))


def two_arms_text(with_room: bool = False) -> str:
    """Return the MJCF of an upright torso with two arms of four hinges."""
    arms = "".join(ARM.format(s=side, y=y) for side, y in (("left", 0.22), ("right", -0.22)))
    boxes = "".join(
        f'<geom type="box" size="{0.5 * x} {0.5 * y} {0.5 * z}" pos="{at[0]} {at[1]} {at[2]}"/>'
        for (x, y, z), at in WALL_AND_TABLE if with_room
    )
    return TWO_ARMS.format(arms=arms, bodies=boxes)


def two_arms(folder: Path) -> Model:
    """Return the robot of two arms."""
    path = folder / "arms.xml"
    path.write_text(two_arms_text())
    return load_avatar(path)


def mixed() -> Model:
    """Return a free root with a ball with limits, and hinges."""
    avatar = mixed_avatar()
    return Model(avatar, coordinates_of(avatar), (), ())


def home(model: Model) -> np.ndarray:
    """Return coordinates at rest, quaternions of length 1."""
    return np.concatenate([
        {"free": np.array([0.0, 0.0, 0.8, 1.0, 0.0, 0.0, 0.0]), "ball": np.eye(4)[0]}.get(slot.kind, np.zeros(1))
        for slot in coordinates(model).slots
    ])


def coordinates(model: Model) -> Coordinates:
    """Return the coordinates of a model that has some."""
    assert model.coordinates is not None
    return model.coordinates


def driven(model: Model, frames: int, rate: float, hold: int, size: float, seed: int) -> np.ndarray:
    """Return coordinates (frames, width) of a user: sines where `hold` is 0, else another posture every so many frames; joints go
    to `size` [rad], roots half as far [m]."""
    rng, times, base = np.random.default_rng(seed), np.arange(frames) / rate, home(model)
    found, first = np.tile(base, (frames, 1)), 0
    for slot in coordinates(model).slots:
        width = {"free": 6, "ball": 3}.get(slot.kind, 1)
        if hold:
            values = np.repeat(rng.uniform(-size, size, (frames // hold + 1, width)), hold, axis=0)[:frames]
            values[:hold] = 0.0
        else:
            waves = np.sin(2.0 * np.pi * np.outer(times, rng.uniform(0.1, 0.8, width)))
            values = rng.uniform(0.3, 1.0, width) * size * waves
        if slot.kind in ("free", "ball"):
            at = first + WIDTHS[slot.kind] - 4
            found[:, at : at + 4] = rotation.from_rotation_vector(values[:, -3:])
            if slot.kind == "free":
                found[:, first : first + 3] += 0.5 * values[:, :3]
        else:
            found[:, first] += values[:, 0]
        first += WIDTHS[slot.kind]
    return found


def steps_of(model: Model, rows: np.ndarray) -> list[np.ndarray]:
    """Return for each group of degrees the steps (F-1, d) between rows: angles, translations, rotation vectors in the frames of
    their links."""
    found, first = [], 0
    for slot in coordinates(model).slots:
        own = rows[:, first : first + WIDTHS[slot.kind]]
        if slot.kind == "free":
            found.append(np.diff(own[:, :3], axis=0))
        if slot.kind in ("free", "ball"):
            turns = Rotation.from_quat(own[:, -4:], scalar_first=True)
            found.append((turns[:-1].inv() * turns[1:]).as_rotvec())
        else:
            found.append(np.diff(own, axis=0))
        first += WIDTHS[slot.kind]
    return found


def largest_rates(model: Model, rows: np.ndarray, rate: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the largest speed and acceleration (groups) of rows that begin at rest."""
    speeds, accelerations = [], []
    for steps in steps_of(model, rows):
        speed = steps * rate
        change = np.diff(np.concatenate([np.zeros((1, speed.shape[1])), speed]), axis=0) * rate
        speeds.append(np.linalg.norm(speed, axis=1).max(initial=0.0))
        accelerations.append(np.linalg.norm(change, axis=1).max(initial=0.0))
    return np.array(speeds), np.array(accelerations)


def plain_twin(angles: np.ndarray, speed: float, acceleration: float, rate: float) -> np.ndarray:
    """Filter hinges without obstacles: the target's own step, and as much of its lag as half of the acceleration can brake; cut
    to the limits."""
    most, change = speed / rate * (1.0 - 1e-6), acceleration / rate**2 * (1.0 - 1e-6)
    shown, step, before, found = angles[0].copy(), np.zeros(angles.shape[1]), angles[0], [angles[0]]
    for target in angles[1:]:
        lag, own, ease = before - shown, np.clip(target - before, -most, most), 0.5 * change
        catch_up = np.sign(lag) * np.minimum(np.abs(lag), np.sqrt(0.25 * ease**2 + 2.0 * ease * np.abs(lag)) - 0.5 * ease)
        step = np.clip(own + catch_up, np.maximum(-most, step - change), np.minimum(most, step + change))
        shown, before = shown + step, target
        found.append(shown)
    return np.array(found)
