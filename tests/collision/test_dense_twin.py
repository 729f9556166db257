"""First contacts of tumbling solids and a brute-force twin: every axis tried at densely sampled instants, then bisection."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from avatarsim.collision.conservative_advancement import CLEAR, IMPACT, STAND_OFF
from avatarsim.scene.body import Body, Mass, simulated, solid
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Piece, Shape, Sphere
from tests.collision.dense import Flying, Pair, first_touch
from tests.collision.two_bodies import Found, TwoBodies

Array = NDArray[np.float64]

END = 0.2
"""Horizon of all searches [s]."""


def quaternion(turn: Rotation) -> tuple[float, float, float, float]:
    """Return the quaternion scalar first."""
    return tuple(turn.as_quat()[[3, 0, 1, 2]])


def pair_of_hulls(seed: int, corners: int = 10) -> tuple[list[Body], list[Flying]]:
    """Return two random hulls that fly at each other and tumble, for the engine and for the twin."""
    rng = np.random.default_rng(seed)
    bodies, twins = [], []
    for side in (-1.0, 1.0):
        points = rng.normal(size=(corners, 3)) * rng.uniform(0.03, 0.1, size=3)
        shape = ConvexHull(points)
        mass = solid((Piece(shape),), 1.0)
        points = points - np.array(mass.centre)
        shape, mass = ConvexHull(points), Mass(1.0, (0.0, 0.0, 0.0), mass.inertia)
        turn = Rotation.random(random_state=int(rng.integers(1 << 30)))
        position = side * np.array([0.35, 0.0, 0.0]) + 0.05 * rng.normal(size=3)
        velocity = -side * np.array([rng.uniform(1.0, 20.0), 0.0, 0.0]) + rng.normal(size=3)
        spin = rng.normal(size=3) * rng.choice([1.0, 10.0, 60.0])
        bodies.append(simulated(
            f"hull {side}", (Piece(shape),), "m", mass, tuple(position), quaternion(turn), tuple(velocity), tuple(spin)
        ))
        pull = np.array([0.0, 0.0, -9.81]) if side > 0.0 else np.zeros(3)
        twins.append(Flying(points, position, turn, velocity, spin, pull, mass.inertia))
    return bodies, twins


def agree(found: Found, twins: list[Flying], samples: int = 400, exact: float = 1e-13) -> bool:
    """Compare with a twin whose own times are good to ``exact`` seconds; returns whether there was an impact."""
    pair = Pair(*twins)
    truth = first_touch(pair.apart, END, samples, 0.01 * exact)
    if found.outcome == CLEAR:
        assert truth is None
        return False
    assert found.outcome == IMPACT
    assert truth is None or found.time <= found.contact <= truth + exact
    assert pair.apart(np.linspace(0.0, found.time, 200)).all()
    if truth is not None and abs(found.contact - truth) <= 1e-9:
        return True
    # a graze between two samples, or one so slow that a hair's breadth takes longer: then the surfaces really are that near
    at = min(found.contact, END)
    closest = found.time if found.contact > END else at
    assert pair.separation(np.array([closest]))[0] <= (1.2 * STAND_OFF if found.contact > END else 3e-11)
    return True


@pytest.mark.parametrize("gyroscopic", [False, True])
def test_tumbling_hulls(gyroscopic: bool) -> None:
    impacts = 0
    for seed in range(3 if gyroscopic else 12):
        bodies, twins = pair_of_hulls(seed)
        found = TwoBodies(*bodies, gyroscopic=gyroscopic).first_contact(END, acceleration_b=(0.0, 0.0, -9.81))
        if not gyroscopic:
            twins = [Flying(x.points, x.position, x.turn, x.velocity, x.spin, x.pull) for x in twins]
        # the twin that tumbles is integrated numerically, to about 1e-11
        impacts += agree(found, twins, exact=1e-10 if gyroscopic else 1e-13)
    assert impacts >= (2 if gyroscopic else 6)


def test_grazing_hulls() -> None:
    """Shifted sideways, in steps that halve, to where they just miss each other: on both sides of that the twin agrees."""
    for seed in (3, 5):
        bodies, twins = pair_of_hulls(seed)
        twins = [Flying(x.points, x.position, x.turn, x.velocity, x.spin, x.pull) for x in twins]
        hit, miss = 0.0, 0.5
        for _ in range(24):
            shift = 0.5 * (hit + miss)
            a, b = bodies
            assert a.mass is not None
            moved = (a.position[0], a.position[1] + shift, a.position[2])
            there = TwoBodies(simulated(a.name, a.pieces, "m", a.mass, moved, a.orientation, a.velocity, a.angular_velocity), b,
                              gyroscopic=False)
            found = there.first_contact(END, acceleration_b=(0.0, 0.0, -9.81))
            first = twins[0]
            shifted = Flying(first.points, np.array(moved), first.turn, first.velocity, first.spin, first.pull)
            if agree(found, [shifted, twins[1]]):
                hit = shift
            else:
                miss = shift
        assert miss - hit < 1e-7


@pytest.mark.parametrize("seed", range(6))
def test_a_tumbling_ellipsoid_over_a_moving_plane(seed: int) -> None:
    """The reach of an ellipsoid along n is sqrt(n Q n); the plane is a huge box that falls and does not turn."""
    rng = np.random.default_rng(seed)
    radii = rng.uniform(0.01, 0.2, size=3)
    turn = Rotation.random(random_state=seed)
    spin, speed = rng.normal(size=3) * 30.0, rng.uniform(0.5, 5.0)
    pieces = (Piece(Ellipsoid(tuple(radii))),)
    body = simulated("egg", pieces, "m", solid(pieces, 1.0), (0.0, 0.0, 0.3), quaternion(turn), (0.0, 0.0, -speed), tuple(spin))
    slab = (Piece(Box((4.0, 4.0, 0.2))),)
    floor = simulated("slab", slab, "m", solid(slab, 1.0), (0.0, 0.0, -0.1), velocity=(0.3, 0.0, 1.0))
    found = TwoBodies(body, floor, gyroscopic=False).first_contact(0.5, acceleration_a=(0.0, 0.0, -9.81))

    def above(t: Array) -> NDArray[np.bool_]:
        now = (Rotation.from_rotvec(t[:, None] * spin) * turn).as_matrix()
        reach = np.sqrt(((now[:, 2, :] * radii) ** 2).sum(axis=1))
        return np.asarray(0.3 - speed * t - 0.5 * 9.81 * t**2 - reach - t > 0.0)

    truth = first_touch(above, 0.5, 4000)
    assert truth is not None and found.outcome == IMPACT
    assert found.time <= found.contact <= truth + 1e-13
    assert found.contact == pytest.approx(truth, abs=1e-9)


SOLIDS: tuple[Shape, ...] = (
    Sphere(0.1), Box((0.1, 0.15, 0.2)), Capsule(0.05, 0.2), Ellipsoid((0.1, 0.12, 0.15)),
    ConvexHull(np.random.default_rng(8).normal(size=(12, 3)) * 0.07),
)
VECTORS = st.lists(st.floats(-1.0, 1.0), min_size=3, max_size=3).map(np.array)


@st.composite
def meetings(draw: st.DrawFn) -> tuple[list[Body], list[Array]]:
    """Return two solids that meet at 20 m/s or more, off centre, spinning slowly against that; and their accelerations.

    Slower, a pull to the side of 10 m/s^2 can take one past the other.
    """
    bodies = []
    for side in (-1.0, 1.0):
        pieces = (Piece(SOLIDS[draw(st.integers(0, len(SOLIDS) - 1))]),)
        turn = Rotation.from_rotvec(np.pi * draw(VECTORS))
        position = side * np.array([0.4, 0.0, 0.0]) + 0.005 * draw(VECTORS)
        velocity = -side * np.array([draw(st.floats(10.0, 50.0)), 0.0, 0.0]) + 0.1 * draw(VECTORS)
        mass, spin = solid(pieces, 1.0), 4.0 * draw(VECTORS)
        bodies.append(simulated(f"{side}", pieces, "m", mass, tuple(position), quaternion(turn), tuple(velocity), tuple(spin)))
    return bodies, [10.0 * draw(VECTORS), 10.0 * draw(VECTORS)]


def search(bodies: list[Body], pulls: list[Array]) -> Found:
    """Return the first contact of the two."""
    return TwoBodies(*bodies).first_contact(END, acceleration_a=tuple(pulls[0]), acceleration_b=tuple(pulls[1]))


def changed(body: Body, turn: Rotation, shift: Array, drift: Array) -> Body:
    """Return the body as seen from elsewhere: turned, shifted, drifting."""
    assert body.mass is not None
    now = turn * Rotation.from_quat(np.array(body.orientation)[[1, 2, 3, 0]])
    position, velocity = turn.apply(body.position) + shift, turn.apply(body.velocity) + drift
    spin = tuple(turn.apply(body.angular_velocity))
    return simulated(body.name, body.pieces, "m", body.mass, tuple(position), quaternion(now), tuple(velocity), spin)


@settings(max_examples=40, deadline=None)
@given(meetings(), VECTORS, VECTORS, VECTORS)
def test_who_looks_does_not_matter(
    meeting: tuple[list[Body], list[Array]], turn: Array, shift: Array, drift: Array
) -> None:
    """Symmetric in A and B; the same from a turned, shifted and steadily drifting point of view; never overlapping before."""
    bodies, pulls = meeting
    here = search(bodies, pulls)
    assert here.outcome == IMPACT and 0.0 < here.time < here.contact < END
    swapped = search(bodies[::-1], pulls[::-1])
    about, far, fast = Rotation.from_rotvec(np.pi * turn), 10.0 * shift, 100.0 * drift
    there = search([changed(body, about, far, fast) for body in bodies], [about.apply(pull) for pull in pulls])
    for other in (swapped, there):
        assert other.outcome == IMPACT
        assert other.contact == pytest.approx(here.contact, abs=1e-9)
        assert other.time == pytest.approx(here.time, abs=2e-8)
