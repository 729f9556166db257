"""Cameras that frame an avatar at a share of the height of the window, and the distance between worlds side by side."""

from dataclasses import dataclass
from math import cos, radians, sin, tan

import numpy as np

from avatarsim.live.messages import Array
from avatarsim.player.surfaces import corners
from avatarsim.scene.avatar import Avatar
from avatarsim.scene.body import Role
from avatarsim.scene.scene import Scene
from avatarsim.spatial import rotation

FIELD = radians(45.0)
"""Vertical field of view [rad]. Wider: shapes at the edges are distorted; narrower: walls come between the eye and the avatar."""
SHARE = 0.4
"""Height of the avatar as a share of the window's. More: nothing is seen around it; less: no finger is seen."""
FLAT = 0.7
"""Share of an avatar's width that counts as its height where it is flatter, as a hand that is seen from its edge."""
VIEWS = {"Home": (228.0, 24.0), "Side": (270.0, 8.0), "Above": (228.0, 70.0)}
"""Directions from the avatar to the eye by name: azimuth and elevation [degrees]. The first view is the first one."""
BELOW = 0.35
"""Distance from the avatar's middle down to the point looked at, in heights of the avatar: it is dragged into things below."""
ASIDE = 0.25
"""Distance to the right of worlds side by side that the eye looks at, in distances between the outer ones: the panel is there."""
WIDER = 1.1
"""Distance [in distances between two worlds] that the eye steps back for each further world."""
BETWEEN = 1.1
"""Distance between worlds side by side, in widths of their widest furniture."""


@dataclass(frozen=True, eq=False)
class Camera:
    """Position of an eye and the point it looks at, (3,) [m] each."""

    position: Array
    look_at: Array


def framed(avatar: Avatar, places: Array, turns: Array, view: str, offsets: Array) -> Camera:
    """Return the camera of a view that frames an avatar whose links have the poses (links, 3) [m] and (links, 4).

    Args:
        avatar: the driven one.
        places: of its links.
        turns: of its links.
        view: one of `VIEWS`.
        offsets: (worlds, 3) [m] of the worlds side by side; all of them are in the picture.
    """
    points = [
        rotation.rotate(turns[k], corners(piece)) + places[k] for k, link in enumerate(avatar.links) for piece in link.pieces
    ]
    cloud = np.concatenate(points) if points else np.asarray(places)
    middle = 0.5 * (cloud.min(axis=0) + cloud.max(axis=0))
    azimuth, elevation = (radians(angle) for angle in VIEWS[view])
    away = np.array((cos(azimuth) * cos(elevation), sin(azimuth) * cos(elevation), sin(elevation)))
    up = np.array((-cos(azimuth) * sin(elevation), -sin(azimuth) * sin(elevation), cos(elevation)))
    right = np.array((-sin(azimuth), cos(azimuth), 0.0))
    height = max(float(np.ptp(cloud @ up)), FLAT * float(np.ptp(cloud @ right)), 1e-3)
    distance = height / (2.0 * SHARE * tan(0.5 * FIELD)) + WIDER * float(np.linalg.norm(offsets[-1]))
    look_at = middle + offsets.mean(axis=0) + ASIDE * offsets[-1] - BELOW * height * up
    return Camera(look_at + distance * away, look_at)


def world_spacing(scene: Scene) -> Array:
    """Return the offset (3,) [m] from a world to the next one, to the right in the first view."""
    azimuth = radians(VIEWS["Home"][0])
    right = np.array((-sin(azimuth), cos(azimuth), 0.0))
    across = []
    for body in scene.bodies:
        points = np.concatenate([corners(piece) for piece in body.pieces]) if body.pieces else np.zeros((1, 3))
        across.append((rotation.rotate(np.asarray(body.orientation), points) + np.asarray(body.position)) @ right)
    # the largest fixed body is the ground, which may extend below the next world
    widths = sorted(float(np.ptp(one)) for one, body in zip(across, scene.bodies, strict=True) if body.role is Role.FIXED)
    width = widths[-2] if len(widths) > 1 else max([2.0 * scene.avatars[0].span, *widths])
    return BETWEEN * width * right
