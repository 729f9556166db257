"""How far the avatar's body, not only its joints, is from where the user has it: one figure for places and turns together."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.body import Mass
from avatarsim.scene.scene import Scene
from avatarsim.spatial import rotation
from scenarios.record import Recording

Array = NDArray[np.float64]


def second_moments(mass: Mass) -> Array:
    """(3, 3) mean of x x^T [m^2] over a body's mass, about its centre of mass, from its inertia J = tr(S) 1 - S."""
    return np.asarray((0.5 * np.trace(mass.inertia) * np.eye(3) - mass.inertia) / mass.mass)


def body_offset(mass: Mass, shift: Array, change: Array) -> Array:
    """(F,) root mean square [m], over the mass of one body, of the way between where its points are in two poses.

    A point x of the body is `shift` (F, 3) [m] plus `change` x away, where `change` (F, 3, 3) is the difference of the two
    rotation matrices: mean |shift + change x|^2 = |shift + change c|^2 + tr(change S change^T)."""
    centre = shift + change @ np.array(mass.centre)
    spread = np.einsum("fij,jk,fik->f", change, second_moments(mass), change)
    return np.asarray(np.sqrt((centre**2).sum(axis=1) + np.maximum(spread, 0.0)))


def body_offsets(recording: Recording, scene: Scene) -> Array:
    """(F, L) root mean square distance [m] of each link's points from where the raw tracker has them, without the first state.

    The figure of what is seen: a hand that turns in order to bring its middle nearer carries its fingers away."""
    shown, raw = recording.orientations[1:, recording.links], recording.raw_orientations[1:]
    shift = recording.positions[1:, recording.links] - recording.raw_positions[1:]
    change = rotation.to_matrix(shown) - rotation.to_matrix(raw)
    found = [body_offset(link.mass, shift[:, k], change[:, k]) for k, link in enumerate(scene.links)]
    return np.array(found, dtype=np.float64).reshape(len(found), recording.frames).T
