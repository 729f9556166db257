"""Overlapping pairs of bodies in each state shown, as found by the judge, in a file next to the recording."""

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from avatarsim.errors import InvalidFile
from runfiles import array_file
from runfiles.files import write_whole

FOLDER = "overlaps"
"""Where these files lie in a run's folder, named as the recordings are."""
MAX_PAIRS = 8
"""Most pairs kept per state, deepest first: a heap that fell into itself has thousands, and a picture shows a few."""

Pairs = Sequence[tuple[str, str, float]]


@dataclass(frozen=True, eq=False)
class Overlapping:
    """k overlapping pairs: `frame` (k,) of states shown, from 0; `first`, `second` (k,) places of the two in canonical order;
    `depth` (k,) [m]."""

    frame: NDArray[np.int64]
    first: NDArray[np.int64]
    second: NDArray[np.int64]
    depth: NDArray[np.float64]


def gathered(pairs_shown: Sequence[Pairs], names: Sequence[str]) -> Overlapping:
    """Return the deepest MOST pairs of each state, from the judge's (name, name, depth [m]) of each, deepest first."""
    place = {name: k for k, name in enumerate(names)}
    rows = [(k, place[a], place[b], depth) for k, pairs in enumerate(pairs_shown) for a, b, depth in pairs[:MAX_PAIRS]]
    frame, first, second = (np.array([row[k] for row in rows], dtype=np.int64) for k in range(3))
    return Overlapping(frame, first, second, np.array([row[3] for row in rows], dtype=np.float64))


def path(folder: Path, stem: str) -> Path:
    """Return the file of the recording `stem` in a run's folder."""
    return folder / FOLDER / f"{stem}.npz"


def write(pairs: Overlapping, folder: Path, stem: str) -> None:
    """Write the file of the recording `stem` into the run folder, whole or not at all."""
    write_whole(path(folder, stem), lambda file: array_file.write(file, vars(pairs)))


def read(folder: Path, stem: str, states: int, bodies: int) -> list[tuple[int, int, int, float]]:
    """Read (frame, first, second, depth [m]) of a recording of so many states of so many bodies and links; none without a file.

    Raises:
        InvalidFile: for a damaged file.
    """
    place = path(folder, stem)
    if not os.path.exists(place):
        return []
    stored = array_file.read(place)
    for name, kind, most in (("frame", "i", states), ("first", "i", bodies), ("second", "i", bodies), ("depth", "f", math.inf)):
        array = stored.get(name)
        if array is None or array.dtype.kind != kind or array.shape != (stored["frame"].size,):
            raise InvalidFile(f"{name} in {place}", "missing, or of another shape or kind", "the whole file that a run wrote")
        if array.size and not 0 <= array.min() <= array.max() < most:
            raise InvalidFile(f"{name} in {place}", array.max(), f"from 0 to below {most}")
    return list(zip(*(stored[name].tolist() for name in ("frame", "first", "second", "depth")), strict=True))
