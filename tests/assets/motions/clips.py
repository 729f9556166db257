"""Clips in the 44 columns of DeepMimic, and a figure with its joint names, z up or y up."""

import json
from pathlib import Path

import numpy as np

from avatarsim.assets.models.coordinates import coordinates_of
from avatarsim.assets.models.model import Model
from avatarsim.assets.motions.deepmimic import LAYOUT
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.checks import Vector
from avatarsim.scene.joint import Ball, Free, Hinge, Hinges, Joint
from tests.assets.motions.robots import BALL, MASS

PARENTS = {
    "chest": "root", "neck": "chest", "hip": "root", "knee": "hip", "ankle": "knee", "shoulder": "chest", "elbow": "shoulder",
}
ANCHORS = {"chest": (0.0, 0.0, 0.24), "neck": (0.0, 0.0, 0.22), "hip": (0.0, 0.08, 0.0), "knee": (0.0, 0.0, -0.42),
           "ankle": (0.0, 0.0, -0.41), "shoulder": (0.0, 0.18, 0.2), "elbow": (0.0, 0.0, -0.27)}
"""Places of the left side's joints, z up."""


def upright(step: float = 0.5) -> list[float]:
    """Return one frame of a clip in which nothing is turned."""
    row = [step, 0.0, 0.9, 0.0]
    for _, width in LAYOUT:
        row += [1.0, 0.0, 0.0, 0.0] if width == 4 else [0.0]
    return row


def moving(frames: int, seed: int = 0) -> list[list[float]]:
    """Return frames of a clip in which all joints turn, at unequal steps; one quaternion is not of length 1."""
    rng = np.random.default_rng(seed)
    rows = []
    for _ in range(frames):
        row = [float(rng.uniform(0.01, 0.05)), *rng.uniform(-1.0, 1.0, 3).tolist()]
        for _, width in LAYOUT:
            values = rng.normal(size=width)
            row += (values / np.linalg.norm(values) if width == 4 else values).tolist()
        rows.append(row)
    rows[frames // 2][4:8] = [0.9 * value for value in rows[frames // 2][4:8]]
    return rows


def written(path: Path, frames: object, loop: str = "wrap") -> Path:
    """Return a clip file of these frames."""
    path.write_text(json.dumps({"Loop": loop, "Frames": frames}), encoding="utf-8")
    return path


def figure(y_up: bool = False) -> Model:
    """Return a figure of 13 links, and hands without joints in the clips that bend at a hinge."""

    def placed(vector: Vector) -> Vector:
        x, y, z = vector
        return (x, z, -y) if y_up else vector

    def link(name: str, parent: str | None, joint: Joint, anchor: Vector) -> Link:
        return Link(name, parent, joint, BALL, MASS, anchor=placed(anchor))

    links = []
    for name, width in LAYOUT:
        side, _, part = name.rpartition("_")
        x, y, z = ANCHORS.get(part, (0.0, 0.0, 0.0))
        parent = PARENTS.get(part)
        if side and parent in ("hip", "knee", "shoulder"):
            parent = f"{side}_{parent}"
        joint: Joint = Free() if parent is None else Ball() if width == 4 else Hinges((Hinge(placed((0.0, -1.0, 0.0))),))
        links.append(link(name, parent, joint, (x, -y if side == "right" else y, z)))
    links.append(link("left_hand", "left_elbow", Hinges((Hinge((1.0, 0.0, 0.0)),)), (0.0, 0.0, -0.25)))
    avatar = Avatar("figure", tuple(links))
    return Model(avatar, coordinates_of(avatar), (), ())
