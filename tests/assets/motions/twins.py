"""Places of joints by 4 x 4 matrices, one joint and one frame after the other: simple twins of the readers."""

import re

import numpy as np
from numpy.typing import NDArray
from trimesh.transformations import rotation_matrix, translation_matrix

from tests.assets.motions.files import AMC_ORDER

Array = NDArray[np.float64]


def turn(axis: int, degrees: float) -> Array:
    """Return the homogeneous matrix of a turn about a coordinate axis."""
    return np.asarray(rotation_matrix(np.radians(degrees), np.eye(3)[axis]))


def bvh_places(text: str) -> list[dict[str, Array]]:
    """Return for each frame the places of joints by name, in the file's axes and unit. Position channels replace the offset."""
    words = text.split()
    at = words.index("MOTION")
    columns = int(re.search(r"Frames: (\d+)", text)[1])  # type: ignore[index]
    numbers = np.array(words[at + 6 :], dtype=np.float64).reshape(columns, -1)
    return [_bvh_frame(words[1:at], row) for row in numbers]


def _bvh_frame(words: list[str], row: Array) -> dict[str, Array]:
    found: dict[str, Array] = {}
    stack: list[Array] = [np.eye(4)]
    name, offset, column = "", np.zeros(3), 0
    k = 0
    while k < len(words):
        if words[k] in ("ROOT", "JOINT"):
            name = words[k + 1]
        elif words[k] == "End":
            name = ""
        elif words[k] == "OFFSET":
            offset = np.array(words[k + 1 : k + 4], dtype=np.float64)
            stack.append(stack[-1] @ translation_matrix(offset))
        elif words[k] == "CHANNELS":
            turns = np.eye(4)
            for channel in words[k + 2 : k + 2 + int(words[k + 1])]:
                axis = "XYZ".index(channel[0])
                if channel.endswith("position"):
                    offset = np.where(np.arange(3) == axis, row[column], offset)
                else:
                    turns = turns @ turn(axis, row[column])
                column += 1
            stack[-1] = stack[-2] @ translation_matrix(offset) @ turns
            found[name] = stack[-1][:3, 3]
        elif words[k] == "}":
            stack.pop()
        k += 1
    return found


def asf_places(asf: str, row: Array) -> dict[str, Array]:
    """Return the beginnings of the small skeleton's bones in one frame of AMC, in the file's axes and unit."""
    bones: dict[str, dict[str, list[str]]] = {}
    for block in re.findall(r"begin\s+id(.*?)end", asf, re.DOTALL):
        lines = [line.split() for line in ("id" + block).splitlines() if line.strip()]
        bones[dict((line[0], line[1]) for line in lines)["name"]] = {line[0]: line[1:] for line in lines}
    numbers, at = {}, 0
    for name, count in AMC_ORDER:
        numbers[name] = row[at : at + count]
        at += count
    root = translation_matrix(numbers["root"][:3])
    for k in (2, 1, 0):
        root = root @ turn(k, numbers["root"][3 + k])
    found, world, ends = {"root": root[:3, 3]}, {"root": root}, {"root": np.zeros(3)}
    tree = [line.split() for line in asf[asf.index(":hierarchy") :].splitlines()[2:] if line.strip() and line.strip() != "end"]
    for parent, *children in tree:
        for child in children:
            bone = bones[child]
            order = bone["axis"][3]
            frame, own = np.eye(4), np.eye(4)
            for letter in order:
                frame = turn("XYZ".index(letter), float(bone["axis"]["XYZ".index(letter)])) @ frame
                dof = "r" + letter.lower()
                if dof in bone.get("dof", []):
                    own = turn("XYZ".index(letter), numbers[child][bone["dof"].index(dof)]) @ own
            world[child] = world[parent] @ translation_matrix(ends[parent]) @ frame @ own @ np.linalg.inv(frame)
            ends[child] = float(bone["length"][0]) * np.array(bone["direction"], dtype=np.float64)
            found[child] = world[child][:3, 3]
    return found
