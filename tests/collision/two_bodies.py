"""Continuous collision detection of two bodies: conservative advancement (Mirtich 1996) with accelerations, for tests.

The search is that of the upper loop, with tolerances and statuses of its own. A pair of pieces is advanced until its gap has come
down to the stand-off: that is ``time``, never late, without overlap. The search continues to a thousandth of the stand-off: that
is ``contact``, when the surfaces meet, never late but by rounding.
"""

from collections.abc import Sequence
from math import inf, isfinite
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.conservative_advancement import (
    BROKEN,
    CLEAR,
    DIPPED,
    FAR_OUT,
    IMPACT,
    OVERLAPPING,
    ROUNDS,
    SPENT,
    STAND_OFF,
    farthest,
    follow_both,
    margin_of,
    safe_time,
)
from avatarsim.collision.path import FREE, STEPS_CAP, STILL, TURN, Paths, Series, make_paths, make_series, move_along
from avatarsim.collision.scratch import Scratch, make_scratch
from avatarsim.collision.signed_distance import signed_distance_up_to
from avatarsim.collision.status import NOT_FINITE
from avatarsim.errors import InvalidInput
from avatarsim.jit.by_reference import refer
from avatarsim.jit.kernel import kernel
from avatarsim.model.dynamics import dynamics
from avatarsim.model.geometry import ELLIPSOID, Geometry, Poses, geometry, poses
from avatarsim.scene.body import Body, ContactLaw, PairTable, Role
from avatarsim.scene.checks import as_number, vector
from avatarsim.scene.scene import Scene
from avatarsim.spatial import rotation
from avatarsim.spatial.vec3 import norm, row
from avatarsim.tolerances import EPSILON, FINE, ROUNDING

Array = NDArray[np.float64]

ROUNDING_NEAR, ROUNDING_FAR = 64.0 * EPSILON, 4.0 * EPSILON
"""Parts of size and coordinates below which a gap is rounding: pieces so near touch, and do not overlap."""

CONTACT = 1e-3
"""Part of the stand-off at which the surfaces count as met: 1e-11 s at 2 m/s. Larger: contacts are found early by as much;
smaller: rounding decides when."""

RESTORED = 2.0
"""Pieces that started nearer than the stand-off keep all of it again once they have been this many times that far apart. 1:
rounding decides whether they have; more: they may come nearer again for longer."""


class Budget(NamedTuple):
    """Limits of a search: stand-off [m], rounds per pair of pieces and phase."""

    stand_off: float = STAND_OFF
    rounds: int = ROUNDS


class Found(NamedTuple):
    """Result of one search: outcome; time [s] up to which the gap surely holds; contact [s], inf if the surfaces do not meet
    before they part again or the horizon ends; gap at ``time`` [m], nan if unknown; rounds spent; pieces."""

    outcome: int
    time: float
    contact: float
    gap: float
    rounds: int
    piece_a: int
    piece_b: int


@kernel
def tumbles_too_far(angular: Array, paths: Paths, b: int, t: float) -> bool:
    """Return True if body b turns farther in t seconds than `tumbled` integrates."""
    return bool(paths.kind[b] == FREE and paths.round[b] == 0 and not (norm(row(angular, b)) * t < TURN * STEPS_CAP))


@kernel
def approach(
    geometry: Geometry, start: Poses, linear: Array, angular: Array, paths: Paths, series: Series, reach: Array, sa: int, sb: int,
    begin: float, h: float, target: float, lowered: bool, stand_off: float, rounding: float, rounds: int, trial: Poses,
    a_rows: Array, b_rows: Array, scratch: Scratch,
) -> tuple[int, float, float, int]:
    """Return the time >= begin at which the gap of shapes sa and sb has come down to ``target``: (outcome, time, gap, rounds).

    A ``lowered`` target is raised to the stand-off once the gap is RESTORED; until then only half of each safe step is taken, so
    that an arc from touch to touch is not crossed in one. A target below 0 means touching; the time is then the last one at which
    they did no more than that.
    """
    a, b = geometry.body[sa], geometry.body[sb]
    t, safe, last_gap, n = begin, begin, inf, (0.0, 0.0, 0.0)
    for spent in range(rounds):
        move_along(geometry, start, linear, angular, paths, series, a, t, trial)
        move_along(geometry, start, linear, angular, paths, series, b, t, trial)
        left = h - t
        margin = margin_of(geometry, paths, reach, a, b, left, stand_off)
        status, gap, n, _, _ = signed_distance_up_to(trial.vertices, geometry.shapes, sa, sb, n, margin, scratch)
        if status == NOT_FINITE or not (margin < inf):
            return BROKEN, 0.0, gap, spent + 1
        if gap > margin:
            return CLEAR, h, gap, spent + 1
        if lowered and gap >= RESTORED * stand_off:
            lowered, target = False, stand_off
        if spent == 0 or gap >= max(target, 0.0) - rounding:
            safe, last_gap = t, gap
        if spent > 0 and gap <= target + FINE * abs(target):
            return IMPACT, safe, last_gap, spent + 1
        count_a, count_b, horizon = follow_both(geometry, angular, paths, reach, sa, sb, n, left, trial, a_rows, b_rows)
        step = safe_time(
            geometry, angular, paths, reach, sa, sb, n, target, left, horizon, trial, a_rows, b_rows, count_a, count_b
        )
        if t + step >= h:
            return CLEAR, h, gap, spent + 1
        if tumbles_too_far(angular, paths, a, t + step) or tumbles_too_far(angular, paths, b, t + step):
            return SPENT, safe, last_gap, spent + 1
        step = 0.5 * step if lowered else step
        if spent > 0 and not (t + step > t):
            return IMPACT if gap <= 2.0 * stand_off else SPENT, safe, last_gap, spent + 1
        t += step
    return SPENT, safe, last_gap, rounds


@kernel
def first_contact_of_pieces(
    geometry: Geometry, start: Poses, linear: Array, angular: Array, paths: Paths, series: Series, reach: Array, sa: int, sb: int,
    h: float, budget: Budget, trial: Poses, a_rows: Array, b_rows: Array, scratch: Scratch,
) -> Found:
    """Return the first contact of shapes sa and sb on the paths of their bodies within h seconds.

    Args:
        start, linear, angular, paths, series, reach, trial, a_rows, b_rows: see `time_of_impact`; ``paths.time`` must not be 0
            or ``trial`` must be at ``start``.
        budget: the stand-off may be as small as 1e-12 of the coordinates; it is raised to 2e-13 of them.

    Returns:
        CLEAR: no gap as small as the stand-off within h. IMPACT: see `Found`; time is early by at most 1.1 stand-offs / closing
        speed, contact by 1.1e-3 of that. OVERLAPPING at the start: time and contact 0, gap the depth. SPENT: the gap holds up to
        time, nothing is known of later times (out of rounds, or tumbled by 1000 rad). BROKEN: something is not finite, or h < 0.

        Pieces that start nearer than the stand-off keep half their gap instead; if they touch, only an approach by more than
        rounding is an impact, at 0. Once apart they keep the stand-off.
    """
    a, b = geometry.body[sa], geometry.body[sb]
    if not (isfinite(h) and h >= 0.0 and budget.stand_off > 0.0):
        return Found(BROKEN, 0.0, 0.0, inf, 0, sa, sb)
    far = farthest(start, a, b)
    stand_off = max(budget.stand_off, FAR_OUT * far)
    rounding = ROUNDING_NEAR * max(geometry.shapes.extent[sa], geometry.shapes.extent[sb]) + ROUNDING_FAR * far
    move_along(geometry, start, linear, angular, paths, series, a, 0.0, trial)
    move_along(geometry, start, linear, angular, paths, series, b, 0.0, trial)
    zero = (0.0, 0.0, 0.0)
    status, gap, _, _, _ = signed_distance_up_to(trial.vertices, geometry.shapes, sa, sb, zero, 2.0 * stand_off, scratch)
    if status == NOT_FINITE:
        return Found(BROKEN, 0.0, 0.0, gap, 1, sa, sb)
    if gap < -rounding:
        return Found(OVERLAPPING, 0.0, 0.0, gap, 1, sa, sb)
    target = stand_off
    if gap < stand_off:
        target = 0.5 * gap if gap > 4.0 * rounding else -4.0 * rounding
    outcome, t, last_gap, rounds = approach(
        geometry, start, linear, angular, paths, series, reach, sa, sb, 0.0, h, target, target < stand_off, stand_off, rounding,
        budget.rounds, trial, a_rows, b_rows, scratch,
    )
    if outcome != IMPACT:
        return Found(outcome, t, inf, last_gap, rounds + 1, sa, sb)
    close = max(CONTACT * stand_off, 2.0 * rounding)
    if not (last_gap > close):
        return Found(outcome, t, t, last_gap, rounds + 1, sa, sb)
    outcome, contact, _, more = approach(
        geometry, start, linear, angular, paths, series, reach, sa, sb, t, h, close, False, close, rounding, budget.rounds, trial,
        a_rows, b_rows, scratch,
    )
    if outcome == CLEAR:
        contact = inf
    return Found(IMPACT, t, contact, last_gap, rounds + more + 1, sa, sb)


@kernel
def first_contact(
    geometry: Geometry, start: Poses, linear: Array, angular: Array, paths: Paths, series: Series, reach: Array, a: int, b: int,
    h: float, budget: Budget, trial: Poses, a_rows: Array, b_rows: Array, scratch: Scratch,
) -> Found:
    """Return the first contact of any piece of body a with any of body b; arguments and result as for pieces.

    The earliest time and the earliest contact may be of different pieces; those named are of the earliest time.
    """
    best, rounds, contact = Found(CLEAR, h, inf, inf, 0, -1, -1), 0, inf
    for sa in range(geometry.first_shape[a], geometry.first_shape[a + 1]):
        for sb in range(geometry.first_shape[b], geometry.first_shape[b + 1]):
            found = first_contact_of_pieces(
                geometry, start, linear, angular, paths, series, reach, sa, sb, min(h, contact), budget, trial, a_rows, b_rows,
                scratch,
            )
            rounds += found.rounds
            if found.outcome == BROKEN or found.outcome == OVERLAPPING:
                return found
            contact = min(contact, found.contact)
            if found.outcome != CLEAR and (best.outcome == CLEAR or found.time < best.time):
                best = found
    return Found(best.outcome, best.time, contact, best.gap, rounds, best.piece_a, best.piece_b)


NAMES = {
    CLEAR: "clear", IMPACT: "impact", DIPPED: "dipped", BROKEN: "not finite", SPENT: "out of rounds", OVERLAPPING: "overlapping",
}
"""Text to print for each outcome."""


def reaches(geo: Geometry) -> Array:
    """Return (nb,) largest distance of a body's points from its centre of mass, rounding radii left out [m]."""
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
    """Return `first_contact` of bodies 0 and 1 by kernels that the engine has compiled: tuples by value would be others."""
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
        # with equal principal moments spinning about any axis is free of torque
        round_ = np.array([not gyroscopic or np.ptp(m) <= ROUNDING * m.max() for m in moments], np.int64)
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
        """Set body frames (2, 3) [m] and (2, 4); velocities of centres of mass (2, 3) [m/s], spins (2, 3) [rad/s], world axes.

        Not checked: numbers that are not finite give the outcome "not finite".
        """
        turn = np.array(orientations, dtype=np.float64)
        centre = np.array(positions, dtype=np.float64) + rotation.rotate(turn, np.array(self._centres))
        self._start, self._trial = poses(self.geometry, centre, turn), poses(self.geometry, centre, turn)
        self._linear[:], self._angular[:] = velocities, angular_velocities

    def first_contact(
        self, seconds: float, *, acceleration_a: Sequence[float] = (0.0, 0.0, 0.0),
        acceleration_b: Sequence[float] = (0.0, 0.0, 0.0), budget: Budget | None = None,
    ) -> Found:
        """Return the first contact within `seconds` under constant accelerations [m/s^2] of simulated bodies: see `Found`.

        Raises:
            InvalidInput: seconds or an acceleration is not finite, or seconds < 0; a budget below 1 round or without stand-off.
        """
        if not 0.0 <= as_number(seconds) < np.inf:
            raise InvalidInput("horizon of a search for contact [s]", seconds, "a finite number, 0 or more")
        allowed = budget or Budget()
        if not (0.0 < as_number(allowed.stand_off) < np.inf and allowed.rounds >= 1):
            raise InvalidInput("budget of a search for contact", tuple(allowed), "a stand-off above 0 and at least 1 round")
        accelerations = [vector("acceleration of a", tuple(acceleration_a)), vector("acceleration of b", tuple(acceleration_b))]
        self._paths.linear[:] = np.where(self._paths.kind[:, None] == STILL, 0.0, accelerations)
        self._paths.time[:] = -1.0
        return Found(*first_contact_referred(
            self.geometry, self._start, self._linear, self._angular, self._paths, self._series, self._reach, float(seconds),
            Budget(float(allowed.stand_off), int(allowed.rounds)), self._trial, self._rows[0], self._rows[1], self._scratch,
        ))
