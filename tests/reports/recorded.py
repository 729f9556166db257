"""A small run with recordings, made by hand: a ball falls into a slab, a hand passes through it."""

import json
from pathlib import Path

import numpy as np

from runfiles import array_file

STATES = 20
AT_ORIGIN = {"position": [0.0, 0.0, 0.0], "orientation": [1.0, 0.0, 0.0, 0.0]}
SLAB, BALL = ({"kind": "box", "size": [1.0, 1.0, 0.1]} | AT_ORIGIN), ({"kind": "sphere", "radius": 0.1} | AT_ORIGIN)
MASS = {"mass": 2.0, "centre": [0.0, 0.0, 0.0], "inertia": (0.1 * np.eye(3)).tolist()}
BODIES: list[dict[str, object]] = [
    {"name": "slab", "role": "fixed", "mass": None, "pieces": [SLAB]},
    {"name": "ball", "role": "simulated", "mass": MASS, "pieces": [BALL]},
    {"name": "hand", "role": "driven", "mass": None, "pieces": [BALL]},
]
"""A hand, a ball and a slab, in canonical order."""


def scene(folder: Path, name: str, **change: object) -> None:
    """Write the file of the scene with some fields changed."""
    (folder / "scenes").mkdir(exist_ok=True)
    whole = {"schema_version": 1, "scene": name, "gravity": [0.0, 0.0, -10.0], "bodies": BODIES} | change
    (folder / "scenes" / f"{name}.json").write_text(json.dumps(whole))


def recording(folder: Path, name: str, run: str, states: int = STATES, sinks: bool = False) -> None:
    """Write a recording: the ball falls freely from 1 m, the hand moves down with the tracker; with `sinks`, also the pairs."""
    times = np.arange(states) / 60.0
    positions = np.zeros((states, 3, 3))
    positions[:, 1, 2] = 1.0 - 5.0 * times**2
    positions[:, 2, 2] = 0.5 - 0.05 * np.arange(states)
    velocities = np.zeros((states, 3, 3))
    velocities[:, 1, 2] = -10.0 * times
    turns = np.zeros((states, 3, 4))
    turns[..., 0] = 1.0
    (folder / "recordings").mkdir(exist_ok=True)
    stem = f"{name}.{run.replace('/', '.')}.0.npz"
    arrays = {
        "meta": np.array(json.dumps({"schema_version": 2})), "times": times, "positions": positions, "orientations": turns,
        "velocities": velocities, "angular_velocities": np.zeros((states, 3, 3)), "raw_positions": positions[:, 2:],
        "raw_orientations": turns[:, 2:],
    }
    with (folder / "recordings" / stem).open("wb") as file:
        array_file.write(file, arrays)
    if sinks:
        (folder / "overlaps").mkdir(exist_ok=True)
        frame, first, second = np.array([[9, 10, 10], [2, 2, 0], [0, 0, 1]])
        np.savez(folder / "overlaps" / stem, frame=frame, first=first, second=second, depth=np.array([0.01, 0.02, 5e-7]))
