"""Joints as poses show them: rotations between parent and child, turned back into angles. Reports of an engine that its poses
do not show are ignored."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.joint import Joint, Slide, axes_of
from avatarsim.scene.scene import Scene
from avatarsim.spatial import rotation

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Place:
    """Where one link is among the links (`child`, `parent`, from 0; no parent: the world) and its hinge angles (`angles`)."""

    joint: Joint
    child: int
    parent: int | None
    angles: slice
    anchor: Array
    orientation: Array


def places(scene: Scene) -> Iterator[Place]:
    """Yield all joints of all avatars, link by link."""
    first = hinge = 0
    for avatar in scene.avatars:
        at = {link.name: first + k for k, link in enumerate(avatar.links)}
        for link in avatar.links:
            count = len(axes_of(link.joint))
            parent = None if link.parent is None else at[link.parent]
            yield Place(
                link.joint, at[link.name], parent, slice(hinge, hinge + count), np.array(link.anchor), np.array(link.orientation),
            )
            hinge += count
        first += len(avatar.links)


def relative(place: Place, orientations: Array) -> Array:
    """Return (F, 4) rotation of the link against its parent (or the world), of link orientations (F, L, 4)."""
    child = orientations[:, place.child]
    if place.parent is None:
        return child
    return rotation.multiply(rotation.conjugate(orientations[:, place.parent]), child)


def turned(place: Place, orientations: Array) -> Array:
    """Return (F, 4) rotation that the joint has made from its zero."""
    return rotation.multiply(rotation.conjugate(place.orientation), relative(place, orientations))


def angle_between(a: Array, b: Array) -> Array:
    """Return the angle [rad], 0 to pi, of the turn between quaternions (..., 4)."""
    turn = rotation.multiply(rotation.conjugate(a), b)
    return np.asarray(2.0 * np.arctan2(np.linalg.norm(turn[..., 1:], axis=-1), np.abs(turn[..., 0])))


def angle_about(axis: Array, turn: Array) -> Array:
    """Return the signed angle [rad] in (-pi, pi] of the twist of quaternions (..., 4) about the unit `axis`."""
    angle = 2.0 * np.arctan2(turn[..., 1:] @ axis, turn[..., 0])
    return np.asarray(np.pi - (np.pi - angle) % (2.0 * np.pi))


def beyond(angle: Array, low: float, high: float) -> Array:
    """Return the excess [rad] of angles (...) outside [low, high], a whole turn being no turn. nan stays nan."""
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    away = np.abs(np.pi - (np.pi - (angle - middle)) % (2.0 * np.pi))
    return np.asarray(np.maximum(away - half, 0.0))


def gaps(scene: Scene, positions: Array, orientations: Array) -> Array:
    """Return (F,) largest distance [m] of a link's frame from the place on its parent, or the line, of its joint."""
    worst = np.zeros(len(positions))
    for place in places(scene):
        if place.parent is not None:
            held = positions[:, place.parent] + rotation.rotate(orientations[:, place.parent], place.anchor)
            away = positions[:, place.child] - held
            if isinstance(place.joint, Slide):
                along = rotation.rotate(rotation.multiply(orientations[:, place.parent], place.orientation), place.joint.axis)
                away = away - np.sum(away * along, axis=-1, keepdims=True) * along
            worst = np.maximum(worst, np.linalg.norm(away, axis=-1))
    return worst
