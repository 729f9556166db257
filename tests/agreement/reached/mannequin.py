"""A mannequin of sixteen links and twenty-two hinges: torso, neck, head and pelvis, arms that point forward at rest, legs."""

import numpy as np

from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import solid
from avatarsim.scene.checks import Vector
from avatarsim.scene.joint import Free, Hinge, Hinges, Rigid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Capsule, Piece
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from tests.agreement.scenes import rotation_of_z_to_x

X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
THREE = Hinges((Hinge(Y, -3.0, 3.0), Hinge(Z, -1.5, 1.5), Hinge(X, -1.5, 1.5)))
WRIST = 1.2
"""Limit of the wrist [rad]; an elbow is straight at its own."""
HANGS = 1.3
"""Angle of the shoulder at the start [rad]."""


def _forward(radius: float, length: float) -> tuple[Piece, ...]:
    return (Piece(Capsule(radius, length), (0.5 * length, 0.0, 0.0), rotation_of_z_to_x()),)


def _down(radius: float, length: float) -> tuple[Piece, ...]:
    return (Piece(Capsule(radius, length), (0.0, 0.0, -0.5 * length)),)


def mannequin() -> Avatar:
    """Return the mannequin; all its links are capsules."""
    torso = (Piece(Capsule(0.14, 0.3)),)
    links = [Link("torso", None, Free(), torso, solid(torso, 25.0))]

    def add(name: str, parent: str, joint: Hinges | Rigid, pieces: tuple[Piece, ...], mass: float, anchor: Vector) -> None:
        links.append(Link(name, parent, joint, pieces, solid(pieces, mass), anchor=anchor))

    for name, above, radius, length, mass, up in (
        ("pelvis", "torso", 0.13, 0.1, 10.0, -0.3), ("neck", "torso", 0.05, 0.05, 1.0, 0.35),
        ("head", "neck", 0.09, 0.08, 4.0, 0.15),
    ):
        add(name, above, Rigid(), (Piece(Capsule(radius, length)),), mass, (0.0, 0.0, up))
    for side, y in (("left", 1.0), ("right", -1.0)):
        add(f"{side}_upper", "torso", THREE, _forward(0.045, 0.26), 2.0, (0.0, 0.24 * y, 0.15))
        add(f"{side}_fore", f"{side}_upper", Hinges((Hinge(Y, -2.4, 0.0),)), _forward(0.04, 0.22), 1.2, (0.28, 0.0, 0.0))
        wrist = Hinges((Hinge(Y, -WRIST, WRIST), Hinge(Z, -0.5, 0.5)))
        add(f"{side}_hand", f"{side}_fore", wrist, _forward(0.03, 0.1), 0.5, (0.25, 0.0, 0.0))
        add(f"{side}_thigh", "pelvis", THREE, _down(0.07, 0.34), 8.0, (0.0, 0.12 * y, -0.15))
        add(f"{side}_shin", f"{side}_thigh", Hinges((Hinge(Y, 0.0, 2.4),)), _down(0.05, 0.34), 3.5, (0.0, 0.0, -0.4))
        add(f"{side}_foot", f"{side}_shin", Hinges((Hinge(Y, -0.8, 0.8),)), _down(0.04, 0.12), 1.0, (0.0, 0.0, -0.42))
    return Avatar("mannequin", tuple(links))


AVATAR = mannequin()


def posed(time: float, shoulder: float) -> TrackerSample:
    """Return a sample with both arms stretched and the shoulders at an angle [rad]."""
    angles = []
    for link in AVATAR.links:
        for k in range(len(link.joint.hinges) if isinstance(link.joint, Hinges) else 0):
            angles.append(shoulder if k == 0 and link.name.endswith("_upper") else 0.0)
    places = np.zeros((len(AVATAR.links), 3))
    places[0, 2] = 1.2
    return TrackerSample(time, places, np.tile(rotation.IDENTITY, (len(places), 1)), np.array(angles))


def hanging() -> Scene:
    """Return a scene of the mannequin alone, its arms hanging."""
    return Scene("mannequin", (), (AVATAR,), start=posed(0.0, HANGS))
