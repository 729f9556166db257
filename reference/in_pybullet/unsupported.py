"""Features of a scene that PyBullet does not support, as data: feature -> consequence."""

import math
from collections.abc import Mapping

import numpy as np

from avatarsim.scene.joint import Ball
from avatarsim.scene.scene import Scene
from reference.narrowing import alike_in_game_engines

WIDEST = math.radians(85.0)
"""Widest swing limit [rad] that Bullet gets. Wider: a limb at 90 degrees about y is at 0 or 180 degrees about x, and is thrown by
the second; smaller: more joints are without a limit of their swing."""


def unsupported(scene: Scene) -> Mapping[str, str]:
    """Return the differences; empty when PyBullet can express all of the scene."""
    features = alike_in_game_engines(scene)
    limits = [link.joint.limits for link in scene.links if isinstance(link.joint, Ball) and link.joint.limits is not None]
    if limits:
        wide = sum(limit.swing > WIDEST for limit in limits)
        features["swing cones"] = (
            "a joint has limits of two angles and of twist. A cone is the pyramid about it, up to 16 degrees wider in its corners"
            + (f". Of {wide} joints with cones wider than {np.degrees(WIDEST):g} degrees only twist is limited" if wide else "")
            + ". Motors hold harder beyond the cone (tuned only)"
        )
    return features
