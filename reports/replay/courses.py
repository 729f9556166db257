"""Lines over the time of a scene: overlap, distance from the user, energy, frame time of every engine."""

from collections.abc import Mapping, Sequence

import numpy as np

from avatarsim.spatial import rotation
from reports.reading.kept import Array, Drawn, Shown
from reports.reading.load import Series

Lines = Mapping[str, tuple[Array, Array]]
"""Times [s] and values by "engine/preset"."""

MEASURES: Mapping[str, tuple[str, str, float | None]] = {
    "overlap": ("Overlap", "m", 1e-9),
    "offset": ("Distance from the user", "m", None),
    "energy": ("Energy", "J", None),
    "time": ("Frame time", "us", 1e-1),
}
"""Title, unit, and where a logarithmic axis begins."""


def energy(one: Shown, scene: Drawn) -> Array:
    """Return kinetic and potential energy [J] of the simulated bodies in each state, less the potential energy of the first."""
    total = np.zeros(len(one.times))
    for k, body in enumerate(scene.bodies):
        if not body["mass"]:
            continue
        mass, centre = float(body["mass"]["mass"]), np.array(body["mass"]["centre"], dtype=np.float64)
        inertia = np.array(body["mass"]["inertia"], dtype=np.float64)
        turns = one.orientations[:, k]
        with np.errstate(all="ignore"):
            spin = rotation.rotate(rotation.conjugate(turns), one.angular_velocities[:, k])
            middle = one.positions[:, k] + rotation.rotate(turns, centre)
            moving = 0.5 * mass * np.sum(one.velocities[:, k] ** 2, axis=1) + 0.5 * np.einsum("ti,ij,tj->t", spin, inertia, spin)
            total = total + moving - mass * (middle - middle[0]) @ scene.gravity
    return total


def courses(series: Mapping[str, Series], shown: Sequence[Shown], scene: Drawn | None, dt: float) -> dict[str, Lines]:
    """Return the lines of each measure that an engine has."""
    by_measure: dict[str, dict[str, tuple[Array, Array]]] = {name: {} for name in MEASURES}
    for run, own in series.items():
        if own.overlap.size:
            by_measure["overlap"][run] = np.asarray(dt * np.arange(own.overlap.size)), own.overlap
        if np.isfinite(own.frame_time).any():
            by_measure["time"][run] = np.asarray(dt * (1.0 + np.arange(own.frame_time.size))), own.frame_time
    for one in shown:
        if one.run.startswith("tracker/"):
            continue
        if count := one.raw_positions.shape[1]:
            apart = np.linalg.norm(one.positions[:, -count:] - one.raw_positions, axis=2)
            by_measure["offset"][one.run] = one.times, apart.max(axis=1)
        if scene is not None and any(body["mass"] for body in scene.bodies):
            by_measure["energy"][one.run] = one.times, energy(one, scene)
    return {name: lines for name, lines in by_measure.items() if lines}
