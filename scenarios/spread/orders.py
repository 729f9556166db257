"""What one engine shows under many seeds of its own, and the spread of it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from avatarsim.engine import Settings
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, link_poses
from avatarsim.spatial import rotation
from reference.judging.judge import Judge
from scenarios.engines import opened

Array = NDArray[np.float64]

JUDGED_EVERY = 10
"""Of the frames of each order every so many are judged: a hundred orders of 120 frames would take minutes."""


@dataclass(frozen=True)
class Spread:
    """Over `orders` runs that differ in the seed alone: how many different courses of frames; distance [m] of link origins and
    angle [deg] of link orientations from their mean over the orders, root mean square and largest, over all frames and links;
    offset [m] of link origins from the user, root mean square per order: least, median, largest; deepest overlap [m] judged."""

    preset: str
    orders: int
    different: int
    distance_rms: float
    distance_max: float
    angle_rms: float
    angle_max: float
    offset_least: float
    offset_median: float
    offset_most: float
    overlap_max: float


def shown(
    engine: str, preset: str, scene: Scene, samples: Sequence[TrackerSample], dt: float, seed: int
) -> tuple[Array, Array, str]:
    """Positions (F, n, 3) and orientations (F, n, 4) of every frame, and the hashes of all in one word."""
    running = opened(engine)
    try:
        running.load(scene, Settings(preset, seed=seed), dt)
        positions, orientations, hashes = [], [], []
        for sample in samples:
            frame = running.advance(sample, dt)
            positions.append(frame.shown.positions)
            orientations.append(frame.shown.orientations)
            # of every frame: at the end all are with their user again
            hashes.append(frame.state_hash())
        return np.array(positions), np.array(orientations), "".join(hashes)
    finally:
        running.close()


def mean_turns(orientations: Array) -> Array:
    """Mean (..., 4) of unit quaternions (N, ..., 4) that lie near one another: the longest axis of their scatter."""
    scatter = np.einsum("n...i,n...j->...ij", orientations, orientations)
    return np.asarray(np.linalg.eigh(scatter)[1][..., -1])


def from_mean(positions: Array, orientations: Array) -> tuple[Array, Array]:
    """Distances (N, F, L) [m] and angles (N, F, L) [rad] of N runs from the mean of all."""
    turn = rotation.multiply(rotation.conjugate(mean_turns(orientations)), orientations)
    angle = 2.0 * np.arctan2(np.linalg.norm(turn[..., 1:], axis=-1), np.abs(turn[..., 0]))
    return np.linalg.norm(positions - positions.mean(axis=0), axis=-1), np.asarray(angle)


def spread(
    preset: str, positions: Array, orientations: Array, raw: Array, hashes: Sequence[str], overlap_max: float
) -> Spread:
    """The spread of links at positions (N, F, L, 3), orientations (N, F, L, 4), whose user is at `raw` (F, L, 3)."""
    distance, angle = from_mean(positions, orientations)
    offset = np.sqrt(np.mean(np.sum((positions - raw) ** 2, axis=-1), axis=(1, 2)))
    degrees = np.degrees(angle)
    return Spread(
        preset, len(positions), len(set(hashes)), float(np.sqrt(np.mean(distance**2))), float(distance.max()),
        float(np.sqrt(np.mean(degrees**2))), float(degrees.max()), float(offset.min()), float(np.median(offset)),
        float(offset.max()), overlap_max,
    )


def measured(engine: str, preset: str, scene: Scene, samples: Sequence[TrackerSample], dt: float, orders: int) -> Spread:
    """Run under the seeds 0 to `orders` - 1 and measure."""
    runs = [shown(engine, preset, scene, samples, dt, seed) for seed in range(orders)]
    judge, first = Judge(scene), len(scene.bodies)
    # equal runs are judged once
    once = {last: (positions, turns) for positions, turns, last in runs}
    depths = [
        judge.overlaps(at, turn).deepest for positions, turns in once.values()
        for at, turn in zip(positions[::JUDGED_EVERY], turns[::JUDGED_EVERY], strict=True)
    ]
    positions, orientations = np.array([run[0][:, first:] for run in runs]), np.array([run[1][:, first:] for run in runs])
    raw = np.array([link_poses(scene.avatars, sample)[0] for sample in samples])
    return spread(preset, positions, orientations, raw, [run[2] for run in runs], float(np.max(depths)))
