"""A small robot of every kind of joint, made by hand, and motions of it in files as other tools write them."""

import io
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, cast

import numpy as np

from avatarsim.assets.models.coordinates import Coordinates, Slot, coordinates_of
from avatarsim.assets.models.model import Model
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import solid
from avatarsim.scene.checks import Vector
from avatarsim.scene.joint import Ball, Free, Hinge, Hinges, Joint, Rigid
from avatarsim.scene.motion import Motion
from avatarsim.scene.shape import Piece, Sphere
from avatarsim.scene.tracker import poses_of_links
from avatarsim.spatial import rotation
from avatarsim.spatial.rotation import Array

BALL = (Piece(Sphere(0.05)),)
MASS = solid(BALL, 1.0)
X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)

JOINTS = ("waist", "left_shoulder", "right_shoulder", "left_elbow")
"""The robot's hinges, in its model's order."""


class Driven(Model):
    """A model of which mypy knows that it has an avatar."""

    avatar: Avatar
    coordinates: Coordinates


def driven(model: Model | None) -> Driven:
    """Return the same model, which must have an avatar."""
    assert model is not None and model.avatar is not None and model.coordinates is not None
    return cast(Driven, model)


def link(name: str, parent: str | None, joint: Joint, anchor: Vector = (0.0, 0.0, 0.3)) -> Link:
    return Link(name, parent, joint, BALL, MASS, anchor=anchor)


def robot(free: bool = True) -> Driven:
    """Return a free pelvis, four hinges and a rigid hand; coordinates as a file names them, one hinge with a reference angle."""
    root = Free() if free else Rigid()
    avatar = Avatar("robot", (
        link("pelvis", None, root),
        link("torso", "pelvis", Hinges((Hinge(Z),))),
        link("left_arm", "torso", Hinges((Hinge(Y),)), (0.0, 0.2, 0.2)),
        link("left_forearm", "left_arm", Hinges((Hinge(Y),)), (0.0, 0.0, -0.3)),
        link("left_hand", "left_forearm", Rigid(), (0.0, 0.0, -0.2)),
        link("right_arm", "torso", Hinges((Hinge(X),)), (0.0, -0.2, 0.2)),
    ))
    slots = (
        *((Slot("floating_base", "free", 0),) if free else ()),
        Slot("waist", "hinge", 1, 0), Slot("left_shoulder", "hinge", 2, 1),
        Slot("right_shoulder", "hinge", 5, 3), Slot("left_elbow", "hinge", 3, 2, rest=0.25),
    )
    return driven(Model(avatar, Coordinates(slots, 6, 4), (), ()))


def held() -> Model:
    """Return the robot with its left shoulder held at 0.3 rad: a slot of its own that moves no link."""
    whole = robot()
    slots = tuple(
        Slot(slot.name, "fixed", -1, rest=0.3) if slot.name == "left_shoulder" else slot for slot in whole.coordinates.slots
    )
    return Model(whole.avatar, Coordinates(slots, 6, 4), (), ())


def puppet() -> Driven:
    """Return a free root, a ball and a link of two hinges, with coordinates link by link."""
    hinges = Hinges((Hinge(X), Hinge(Y)))
    avatar = Avatar("puppet", (link("root", None, Free()), link("head", "root", Ball()), link("hand", "head", hinges)))
    return driven(Model(avatar, coordinates_of(avatar), (), ()))


def walk(frames: int, joints: int = len(JOINTS), seed: int = 0) -> Array:
    """Return rows (frames, 7 + joints) of a smooth motion: root position, unit quaternion w first, angles."""
    rng = np.random.default_rng(seed)
    u = np.linspace(0.0, 1.0, frames)[:, None]
    places = np.array([0.5, 0.2, 0.9]) + u * np.array([1.0, 0.3, 0.05])
    turns = rotation.from_rotation_vector(np.sin(2.0 * u) * np.array([0.1, 0.2, 0.6]))
    angles = 0.4 * np.sin(3.0 * u + rng.uniform(0.0, 3.0, joints))
    return np.concatenate([places, turns, angles], axis=1)


def places(model: Model | None, motion: Motion) -> Array:
    """Return places (F, links, 3) [m] of the avatar's links."""
    return poses_of_links((driven(model).avatar,), motion.positions, motion.rotations, motion.angles)[0]


def saved(path: Path, arrays: Mapping[str, Any], save: Callable[..., None] = np.savez) -> Path:
    """Return an .npz file of these entries."""
    save(path, **{key: np.asarray(values) for key, values in arrays.items()})
    return path


def entries(content: bytes) -> dict[str, Any]:
    """Return the entries of an .npz file."""
    with np.load(io.BytesIO(content), allow_pickle=False) as found:
        return dict(found)
