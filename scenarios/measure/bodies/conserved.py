"""Conservation in a group of bodies that nothing else touches: momentum, angular momentum, and never more energy than before."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.scene import Scene
from avatarsim.spatial import rotation
from runfiles.record import Recording
from scenarios.measure.bodies.energy import kinetic
from scenarios.measure.expecting import expected
from scenarios.measure.value import Values, measure
from scenarios.scenario import Scenario

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Group:
    """Some simulated bodies over all T states shown: mass (b,) [kg], inertia (b, 3, 3), and per state centre (T, b, 3), velocity,
    spin (T, b, 3), orientation (T, b, 4)."""

    mass: Array
    inertia: Array
    centre: Array
    velocity: Array
    spin: Array
    orientation: Array

    def momentum_drift(self) -> float:
        """Return the largest |P - P0| over the first sum of m |v|."""
        momentum = self.mass[:, None] * self.velocity
        total = momentum.sum(axis=1)
        scale = np.linalg.norm(momentum[0], axis=-1).sum()
        return _relative(np.linalg.norm(total - total[0], axis=-1), float(scale))

    def angular_momentum_drift(self) -> float:
        """Return the largest |L - L0| about the common centre, over the largest sum of the bodies' own shares."""
        middle = (self.mass[:, None] * self.centre).sum(axis=1) / self.mass.sum()
        common = (self.mass[:, None] * self.velocity).sum(axis=1) / self.mass.sum()
        own = rotation.rotate(rotation.conjugate(self.orientation), self.spin)
        turning = rotation.rotate(self.orientation, np.einsum("bij,tbj->tbi", self.inertia, own))
        arm, relative = self.centre - middle[:, None], self.velocity - common[:, None]
        shares = self.mass[:, None] * rotation.cross(arm, relative)
        total = (shares + turning).sum(axis=1)
        lengths = self.mass * np.linalg.norm(arm, axis=-1) * np.linalg.norm(relative, axis=-1)
        scale = (lengths + np.linalg.norm(turning, axis=-1)).sum(axis=1).max()
        return _relative(np.linalg.norm(total - total[0], axis=-1), float(scale))

    def energy(self, gravity: Array) -> Array:
        """Return (T,) kinetic and potential energy [J]; the origin has none."""
        moving = kinetic(self.mass, self.inertia, self.orientation, self.velocity, self.spin)
        return np.asarray((moving - self.mass * (self.centre @ gravity)).sum(axis=1))

    def fastest(self) -> float:
        """Return the largest kinetic energy [J] of any state."""
        return float(np.max(kinetic(self.mass, self.inertia, self.orientation, self.velocity, self.spin).sum(axis=1)))


def _relative(errors: Array, scale: float) -> float:
    """Return the largest error over `scale`; nan where the scale is 0 or no number: a group that never moved has kept nothing."""
    return float(np.max(errors)) / scale if scale > 0.0 else float("nan")


def group(recording: Recording, scene: Scene, names: tuple[str, ...]) -> Group:
    """Return the bodies called `names`, which are simulated."""
    own = [scene.names.index(name) for name in names]
    masses = [mass for k in own if (mass := scene.bodies[k].mass) is not None]
    turned = recording.orientations[:, own]
    offset = rotation.rotate(turned, np.array([m.centre for m in masses]))
    return Group(
        np.array([m.mass for m in masses]), np.array([m.inertia for m in masses]), recording.positions[:, own] + offset,
        recording.velocities[:, own], recording.angular_velocities[:, own], turned,
    )


@measure
def conserved(recording: Recording, scenario: Scenario, scene: Scene) -> Values:
    """Return momentum_drift_max and angular_momentum_drift_max over the groups of names in expects["isolated"]; energy_drift_max
    (|E - E0|) over those in expects["elastic"]; energy_gain_max (rise of E from state to state) over those in expects["alone"].
    All relative, energies to the largest kinetic energy of the group. Each empty when not expected."""
    gravity = np.array(scene.gravity)
    drifts: dict[str, list[float]] = {}
    for names in expected(scenario, "isolated", tuple):
        own = group(recording, scene, names)
        drifts.setdefault("momentum_drift_max", []).append(own.momentum_drift())
        drifts.setdefault("angular_momentum_drift_max", []).append(own.angular_momentum_drift())
    for names in expected(scenario, "elastic", tuple):
        own = group(recording, scene, names)
        energy = own.energy(gravity)
        drifts.setdefault("energy_drift_max", []).append(_relative(np.abs(energy - energy[0]), own.fastest()))
    for names in expected(scenario, "alone", tuple):
        own = group(recording, scene, names)
        rises = np.maximum(np.diff(own.energy(gravity), prepend=np.inf)[1:], 0.0)
        # bodies that rest all the time have gained nothing
        drifts.setdefault("energy_gain_max", []).append(0.0 if np.max(rises) == 0.0 else _relative(rises, own.fastest()))
    # np.max keeps nan, which max() may lose
    return {metric: float(np.max(values)) for metric, values in drifts.items()}
