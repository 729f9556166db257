"""A certificate's entry made of audits that are written by hand."""

import math
from pathlib import Path
from typing import Any

import numpy as np

from avatarsim.cleaning import AtRest, Audit, Cleaned, Flagged, Moved, Opinion
from avatarsim.cleaning.result import Excluded
from avatarsim.clips import certificate
from avatarsim.clips.options import ClipOptions
from avatarsim.clips.reading import Reading
from avatarsim.scene.motion import Motion

FRAMES = 4


def motion() -> Motion:
    turned = np.tile([1.0, 0.0, 0.0, 0.0], (FRAMES, 2, 1))
    return Motion(np.arange(FRAMES) / 30.0, np.zeros((FRAMES, 2, 3)), turned, np.zeros((FRAMES, 1)))


def audit(depth: float = 0.0, opinion: bool = True) -> Audit:
    found = Opinion("coal", FRAMES, 1, depth, 30, 0, 0.0) if opinion else None
    depths = np.array([0.0, depth, 0.0, 0.0])
    return Audit(depths, ("hand", "table") if depth else None, np.array([1.0, 0.5 if depth else 1.0, 1.0]), 0.01 * depth, 0.0,
                 12.5, math.nan, (Excluded("a", "b", 0.02),), found, ("said of the audit",),
                 (AtRest("walk/a", "walk/c", 0.01, 0.005),), 0.07)


def entry(**changed: Any) -> dict[str, object]:
    links = np.array([0.01, 0.02]), np.array([0.03, 0.04]), np.array([0.05, 0.06])
    moved = Moved(("hand", "arm"), *links, ("elbow",), np.array([0.1]), np.array([0.2]),
                  ("finger",), np.array([0.001]), np.array([0.002]))
    cleaned = Cleaned(motion(), audit(0.03), audit(), moved, np.array([False, True, True, False]),
                      np.array([False, True, False, False]), (
        Flagged(1, 2, "overlap", ("hand", "table")), Flagged(3, 3, "blend")))
    files = (("walk.bvh", "0" * 64),)
    options = ClipOptions(Path("/models/deep/robot.xml"), Path("floor"), reading=Reading(asf="/skeletons/02.asf", fix=("a", "b")))
    decides = certificate.key(files, (("robot.xml", "1" * 64), ("assets/a.stl", "2" * 64)), (), options)
    outputs = {"motion": ("deep/walk.bvh", "3" * 64)}
    return certificate.entry(
        "deep/walk.bvh", "bvh", decides, motion(), cleaned.before, cleaned.after, cleaned, ["read so"], outputs, **changed
    )
