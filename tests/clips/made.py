"""Small clips and robots, written as other tools write theirs: a figure that sinks into the floor and rises again."""

from pathlib import Path
from typing import Any

import numpy as np

from tests.assets.motions.files import end, joint, root

BVH = root(
    "Hips", "ZXY", joint("Spine", "0 0.1 0", "ZXY", joint("Head", "0 0.45 0", "ZXY", end("0 0.25 0"))),
    joint("LeftUpLeg", "0.12 0 0", "ZXY", joint("LeftLeg", "0 -0.42 0", "ZXY", end("0 -0.42 0"))),
    joint("RightUpLeg", "-0.12 0 0", "ZXY", joint("RightLeg", "0 -0.42 0", "ZXY", end("0 -0.42 0"))),
) + "MOTION\n"
"""A figure of 1.6 m without arms, y up, in metres."""

COLUMNS = 6 + 6 * 3

ROBOT = """\
<mujoco model="stick">
  <worldbody>
    <body name="base" pos="0 0 0.5">
      <freejoint name="root"/>
      <geom name="trunk" type="sphere" size="0.1" group="3"/>
      <geom name="shell" type="ellipsoid" size="0.08 0.09 0.07" contype="0" conaffinity="0" mass="0"/>
      <body name="arm" pos="0.12 0 0">
        <joint name="elbow" type="hinge" axis="0 1 0" range="-1.5 1.5"/>
        <geom name="rod" type="capsule" fromto="0.03 0 0 0.3 0 0" size="0.03"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""
"""A robot with a free root and one hinge."""


def bvh(path: Path, frames: int = 12, sinks: float = 0.15, seed: int = 0) -> Path:
    """Return a clip of the figure, which sinks by `sinks` [m] into the floor in its middle; `seed` sways it a little."""
    rows = np.zeros((frames, COLUMNS))
    share = np.arange(frames) / max(frames - 1, 1)
    rows[:, 0] = 0.01 * seed
    rows[:, 1] = 1.05 - (0.13 + sinks) * np.sin(np.pi * share) ** 2
    rows[:, 6] = 2.0 * np.sin(2.0 * np.pi * share + seed)
    lines = [f"Frames: {frames}", "Frame Time: 0.0333333", *(" ".join(f"{one:.6f}" for one in row) for row in rows)]
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(BVH + "\n".join(lines) + "\n", encoding="utf-8")
    return path


def robot(folder: Path) -> Path:
    """Return the robot's model file."""
    path = folder / "robot.xml"
    path.write_text(ROBOT, encoding="utf-8")
    return path


def csv(path: Path, frames: int = 10) -> Path:
    """Return a trajectory of the robot, quaternions w last: its trunk goes down to the floor and 5 cm into it."""
    share = np.linspace(0.0, 1.0, frames)
    rows = np.zeros((frames, 8))
    rows[:, 2] = 0.4 - 0.35 * np.sin(np.pi * share)
    rows[:, 6] = 1.0
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("\n".join(",".join(f"{one:.6f}" for one in row) for row in rows) + "\n", encoding="utf-8")
    return path


def carrying(path: Path, frames: int = 12, **entries: Any) -> Path:
    """Return a trajectory of the robot, and the poses of a cube of 0.1 m that comes into its arm."""
    share = np.linspace(0.0, 1.0, frames)
    rows = np.zeros((frames, 8))
    rows[:, 2], rows[:, 3] = 0.6, 1.0
    places = np.stack([0.3 + 0.0 * share, 0.0 * share, 0.35 + 0.25 * share], axis=1)
    turns = np.tile((1.0, 0.0, 0.0, 0.0), (frames, 1))
    np.savez(path, fps=30, qpos=rows, object_pos_w=places, object_quat_w=turns, object_name="cube", **entries)
    return path


def content(folder: Path) -> dict[str, bytes]:
    """Return all files below a folder, by their paths."""
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}
