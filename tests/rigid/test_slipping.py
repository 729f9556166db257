"""Velocity of a held corner after a segment of constant forces, and slips that end inside one."""

import numpy as np
import pytest

from avatarsim.collision.path import make_series
from avatarsim.rigid.contacts import Masses, add_contact, make_contacts
from avatarsim.rigid.resting import ATTEMPTS, SOLVED, SWEEPS, Care, hold, remainder, slip_that_ends
from avatarsim.rigid.rolling import curvature
from avatarsim.spatial import rotation

G = np.array([0.0, 0.0, -9.81])
MASS, INERTIA = 2.0, np.diag([0.04, 0.035, 0.02])
MEMBERS, MOVING, BRICK = np.array([1]), np.array([0, 1]), np.zeros(2, np.int64)


def standing(arm: np.ndarray, friction: float):
    """Return a brick on one corner, its centre of mass at the origin, on a floor."""
    contacts = make_contacts(4)
    masses = Masses(np.array([0.0, 1.0 / MASS]), np.stack([np.zeros((3, 3)), np.linalg.inv(INERTIA)]))
    assert add_contact(contacts, 1, 0, 0, (0.0, 0.0, 1.0), tuple(arm), tuple(arm), 2e-8)
    contacts.friction[0], contacts.standing[0] = friction, 1
    return contacts, masses


def held(contacts, masses, h: float, linear: np.ndarray, angular: np.ndarray):
    """Return (length of the segment, velocity and spin at its end)."""
    v, w, v_end, w_end = (np.zeros((2, 3)) for _ in range(4))
    v[1], w[1] = linear, angular
    curvature(contacts, v, w)
    memory, care = (np.zeros((4, 3)), np.zeros((4, 3))), Care(SOLVED, 25, SWEEPS, ATTEMPTS)
    inertia = np.stack([np.zeros((3, 3)), INERTIA])
    length, left = hold(
        contacts, masses, MEMBERS, MOVING, BRICK, G, inertia, h, v, w, v_end, w_end, *memory, care, np.zeros(2, np.int64),
        make_series(),
    )
    assert left <= 10.0 * SOLVED
    return float(length), v_end, w_end


def cases(count: int):
    """Arms to a corner below, spins, and segments over which they turn by a tenth at most."""
    random = np.random.default_rng(5)
    for _ in range(count):
        arm = np.array([*random.uniform(-0.05, 0.05, 2), -0.2])
        spin = random.normal(size=3) * random.choice([0.3, 3.0, 6.0])
        yield arm, spin, min(0.1 / np.linalg.norm(spin), 4e-3)


@pytest.mark.nojit
@pytest.mark.boundscheck
def test_a_held_corner_slips_by_no_more_than_the_remainder() -> None:
    """The corner is turned as the body turns, which constant forces know to second order only; nearly the bound is reached."""
    most = 0.0
    for arm, spin, h in cases(200):
        contacts, masses = standing(arm, 1.0)
        length, v_end, w_end = held(contacts, masses, h, -np.cross(spin, arm), spin)
        assert length == h
        mean = 0.5 * h * (spin + w_end[1])
        angle = np.linalg.norm(mean)
        turned = rotation.rotate(rotation.from_axis_angle(mean / angle, angle), arm)
        if contacts.impulse[0, 0] > 0.0 and np.hypot(*contacts.impulse[0, 1:]) < 0.99 * contacts.impulse[0, 0]:
            slip = np.linalg.norm((v_end[1] + np.cross(w_end[1], turned))[:2])
            angular = np.zeros((2, 3))
            angular[1] = spin
            bound = remainder(contacts, 0, h, angular, w_end)
            assert slip <= bound
            most = max(most, float(slip / bound))
    assert most > 0.7


@pytest.mark.nojit
@pytest.mark.boundscheck
def test_a_remainder_shortens_no_segment_and_a_slip_does() -> None:
    """A brick that pivots on its corner, once with half of the remainder allowed to a segment, once with a hundred times that."""
    arm, spin, h = np.array([0.02, 0.03, -0.2]), np.array([1.5, -2.0, 0.5]), 3e-3
    for part, whole in ((0.5, True), (100.0, False)):
        contacts, masses = standing(arm, 0.6)
        angular = np.zeros((2, 3))
        angular[1] = spin
        slip = part * remainder(contacts, 0, h, angular, angular)
        length, _, w_end = held(contacts, masses, h, -np.cross(spin, arm) + np.array([slip, 0.0, 0.0]), spin)
        assert bool(length == h) is whole
        assert length > 1e-5


def test_a_brick_that_slides_without_spin_has_no_remainder() -> None:
    """Any slip of it counts that goes farther than SLIPPED."""
    contacts, _ = standing(np.array([0.0, 0.0, -0.2]), 0.5)
    linear, still = np.zeros((2, 3)), np.zeros((2, 3))
    linear[1, 0] = 1e-5
    assert remainder(contacts, 0, 1e-2, still, still) == 0.0
    assert slip_that_ends(contacts, 0, 1e-2, linear, still, still) == ((1e-5, 0.0, 0.0), 1e-5)
    assert slip_that_ends(contacts, 0, 1e-4, linear, still, still)[1] == 0.0
