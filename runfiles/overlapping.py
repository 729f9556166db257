"""Which bodies overlap in which state shown: the judge's pairs, kept beside the recording for what draws it."""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from runfiles import array_file
from runfiles.files import write_whole

FOLDER = "overlaps"
"""Where these files lie in a run's folder, named as the recordings are."""
MOST = 8
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
    """The deepest MOST pairs of each state, from what the judge says of each: (name, name, depth [m]), deepest first."""
    place = {name: k for k, name in enumerate(names)}
    rows = [(k, place[a], place[b], depth) for k, pairs in enumerate(pairs_shown) for a, b, depth in pairs[:MOST]]
    frame, first, second = (np.array([row[k] for row in rows], dtype=np.int64) for k in range(3))
    return Overlapping(frame, first, second, np.array([row[3] for row in rows], dtype=np.float64))


def path(folder: Path, stem: str) -> Path:
    """Where the file of the recording `stem` lies in the run folder."""
    return folder / FOLDER / f"{stem}.npz"


def write(found: Overlapping, folder: Path, stem: str) -> None:
    """Write the file of the recording `stem` into the run folder, whole or not at all."""
    arrays = {entry.name: getattr(found, entry.name) for entry in fields(found)}
    write_whole(path(folder, stem), lambda file: array_file.write(file, arrays))
