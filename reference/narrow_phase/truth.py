"""What is true of the pairs of a sequence: by qhull's Minkowski difference, never by a contender."""

import numpy as np
from numpy.typing import NDArray

from reference.judging.geometry import rounded_points
from reference.judging.minkowski import signed_distance
from reference.narrow_phase.cells import Sequence

Array = NDArray[np.float64]


def truths(sequence: Sequence, frames: range) -> Array:
    """Signed distances (len(frames), pairs) [m], exact to rounding: hull of all differences, less the two radii."""
    points = [rounded_points(shape) for shape in sequence.shapes]
    found = np.zeros((len(frames), sequence.pairs))
    for row, frame in enumerate(frames):
        placed = [
            core @ turn.T + at
            for (core, _), turn, at in zip(points, sequence.turns[frame], sequence.at[frame], strict=True)
        ]
        for k in range(sequence.pairs):
            a, b = 2 * k, 2 * k + 1
            found[row, k] = signed_distance(placed[a], points[a][1], placed[b], points[b][1])
    return found


def errors(answers: Array, truth: Array) -> Array:
    """How far answers are from the truth [m]; inf for an answer that is missing or is no number."""
    return np.asarray(np.where(np.isfinite(answers), np.abs(answers - truth), np.inf))
