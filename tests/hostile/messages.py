"""Doors for messages of trackers, as they come by UDP and WebSocket."""

import json
from pathlib import Path

import numpy as np

from avatarsim.live.ports.protocol import Goals, Shape, json_sample, packed_sample, parse
from avatarsim.scene.tracker import TrackerSample
from tests.hostile import valid_files as valid
from tests.hostile.doors import Door, FileDoor, Unsound, finite, of_files
from tests.hostile.mutation import damaged, damaged_json

LINKS = ("body/root", "body/arm", "hand")
SHAPE = Shape(LINKS, 2, ("table", *LINKS, "door"), (*LINKS, "door"))
SAMPLE = TrackerSample(0.0, np.full((3, 3), 0.5), np.tile([0.5, -0.5, 0.5, 0.5], (3, 1)), np.array([0.25, -1.5]))
GOALS = {"links": {"arm": {"position": [0.1, 0.2, 0.3]}, "hand": {"position": [1, 2, 3], "rotation": [0, 0, 1, 0]}}}


def packed() -> valid.Files:
    """Samples of both widths."""
    return {"4": packed_sample(SAMPLE, 4), "8": packed_sample(SAMPLE, 8)}


def texts() -> valid.Files:
    """A sample and goals as JSON."""
    return {"sample": json_sample(SAMPLE).encode(), "goals": json.dumps(GOALS).encode()}


def read(folder: Path, path: Path) -> object:
    """What a message says: a sample that fits the scene, or goals of links that it has."""
    found = parse(path.read_bytes(), SHAPE)
    if isinstance(found, Goals):
        if not set(found.links) <= set(SHAPE.handles):
            raise Unsound("a goal of no link")
        return [finite(goal) for goal in found.links.values()]
    if found.positions.shape != (3, 3) or found.rotations.shape != (3, 4) or found.angles.shape != (2,):
        raise Unsound("a sample of another shape")
    return finite(found)


def doors() -> tuple[Door, ...]:
    """All doors for messages."""
    return (
        of_files("packed sample", 30.0, FileDoor(packed, damaged, read)),
        of_files("JSON of a tracker", 40.0, FileDoor(texts, damaged_json, read)),
        of_files("bytes of a tracker", 30.0, FileDoor(texts, damaged, read)),
    )
