"""Continuous collision detection for users: `first_contact` of two bodies, with arrays built once for many queries."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from avatarsim.collide.scratch import Scratch, make_scratch
from avatarsim.errors import InvalidInput
from avatarsim.jit.by_reference import refer
from avatarsim.jit.kernel import kernel
from avatarsim.motion.first_contact import Budget, Found, first_contact
from avatarsim.motion.free_rotation import Series, make_series
from avatarsim.motion.path import FREE, STILL, Paths, make_paths
from avatarsim.motion.time_of_impact import BROKEN, CLEAR, DIPPED, IMPACT, OVERLAPPING, SPENT
from avatarsim.scene.body import Body, Role
from avatarsim.scene.checks import as_number, vector
from avatarsim.scene.material import ContactLaw, PairTable
from avatarsim.scene.scene import Scene
from avatarsim.spatial import rotation
from avatarsim.world.dynamics import dynamics
from avatarsim.world.geometry import Geometry, Poses, geometry, poses
from avatarsim.world.shapes import ELLIPSOID

Array = NDArray[np.float64]

NAMES = {
    CLEAR: "clear", IMPACT: "impact", DIPPED: "dipped", BROKEN: "not finite", SPENT: "out of rounds", OVERLAPPING: "overlapping",
}
"""What to print for each outcome."""

ROUND = 1e-12
"""Principal moments closer than this part of the largest are equal: spinning about any axis is then free of torque."""


def reaches(geo: Geometry) -> Array:
    """(nb,) largest distance of a body's points from its centre of mass, rounding radii left out [m]."""
    found = np.zeros(len(geo.first_shape) - 1)
    for s, b in enumerate(geo.body):
        points = geo.local[geo.shapes.start[s] : geo.shapes.start[s + 1]]
        far = np.linalg.norm(points, axis=1)
        found[b] = max(found[b], far[0] + far[1:].max() if geo.shapes.kind[s] == ELLIPSOID else far.max())
    return found


@kernel
def first_contact_referred(
    geometry: Geometry, start: Poses, linear: Array, angular: Array, paths: Paths, series: Series, reach: Array, h: float,
    budget: Budget, trial: Poses, a_rows: Array, b_rows: Array, scratch: Scratch,
) -> Found:
    """`first_contact` of bodies 0 and 1 by kernels that the engine has compiled: tuples by value would be others."""
    return first_contact(
        refer(geometry), refer(start), linear, angular, refer(paths), refer(series), reach, 0, 1, h, budget, refer(trial), a_rows,
        b_rows, scratch,
    )


class TwoBodies:
    """Two bodies, fixed or simulated, in free flight under accelerations of their own.

    Poses and velocities are those of the `Body` objects until `set_state` changes them; a simulated body tumbles by Euler's
    equations unless ``gyroscopic`` is off, then its angular velocity stays.
    """

    def __init__(self, a: Body, b: Body, *, gyroscopic: bool = True) -> None:
        named = [Body("a", a.role, a.pieces, "m", mass=a.mass), Body("b", b.role, b.pieces, "m", mass=b.mass)]
        scene = Scene("two bodies", tuple(named), materials=PairTable({("m", "m"): ContactLaw(0.0, 0.0)}))
        self.geometry, masses = geometry(scene), dynamics(scene)
        moments = np.linalg.eigvalsh(masses.inertia)
        round_ = np.array([not gyroscopic or np.ptp(m) <= ROUND * m.max() for m in moments], np.int64)
        self._paths = make_paths(masses.inertia.copy(), masses.inverse_inertia.copy(), round_)
        self._paths.kind[:] = [FREE if body.role is Role.SIMULATED else STILL for body in (a, b)]
        self._centres = [np.array(x.mass.centre) if x.mass and x.role is Role.SIMULATED else np.zeros(3) for x in (a, b)]
        self._reach, self._series, self._scratch = reaches(self.geometry), make_series(), make_scratch()
        self._linear, self._angular = np.zeros((2, 3)), np.zeros((2, 3))
        self._rows = [np.zeros((int(np.diff(self.geometry.shapes.start).max()), 6)) for _ in range(2)]
        self.set_state(
            [a.position, b.position], [a.orientation, b.orientation], [a.velocity, b.velocity],
            [a.angular_velocity, b.angular_velocity],
        )

    def set_state(
        self, positions: Sequence[Sequence[float]], orientations: Sequence[Sequence[float]],
        velocities: Sequence[Sequence[float]], angular_velocities: Sequence[Sequence[float]],
    ) -> None:
        """Body frames (2, 3) [m] and (2, 4); velocities of the centres of mass (2, 3) [m/s], spins (2, 3) [rad/s], world axes.

        Not checked: what is not finite comes back as the outcome "not finite".
        """
        turn = np.array(orientations, dtype=np.float64)
        centre = np.array(positions, dtype=np.float64) + rotation.rotate(turn, np.array(self._centres))
        self._start, self._trial = poses(self.geometry, centre, turn), poses(self.geometry, centre, turn)
        self._linear[:], self._angular[:] = velocities, angular_velocities

    def first_contact(
        self, seconds: float, *, acceleration_a: Sequence[float] = (0.0, 0.0, 0.0),
        acceleration_b: Sequence[float] = (0.0, 0.0, 0.0), budget: Budget | None = None,
    ) -> Found:
        """First contact within `seconds`; constant accelerations [m/s^2] move what is not fixed. See `first_contact.Found`.

        Raises:
            InvalidInput: seconds or an acceleration is not finite, or seconds < 0; a budget below 1 round or without stand-off.
        """
        if not 0.0 <= as_number(seconds) < np.inf:
            raise InvalidInput("horizon of a search for contact [s]", seconds, "a finite number, 0 or more")
        allowed = budget or Budget()
        if not (0.0 < as_number(allowed.stand_off) < np.inf and allowed.rounds >= 1):
            raise InvalidInput("budget of a search for contact", tuple(allowed), "a stand-off above 0 and at least 1 round")
        pull = [vector("acceleration of a", tuple(acceleration_a)), vector("acceleration of b", tuple(acceleration_b))]
        self._paths.linear[:] = np.where(self._paths.kind[:, None] == STILL, 0.0, pull)
        self._paths.time[:] = -1.0
        return Found(*first_contact_referred(
            self.geometry, self._start, self._linear, self._angular, self._paths, self._series, self._reach, float(seconds),
            Budget(float(allowed.stand_off), int(allowed.rounds)), self._trial, self._rows[0], self._rows[1], self._scratch,
        ))
