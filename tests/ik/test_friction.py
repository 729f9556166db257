"""Friction of links on fixed bodies."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from avatarsim.scene.body import ContactLaw, PairTable, fixed
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from tests.ik.scenes import walled_hinged
from tests.worlds.little_worlds import at, hand_scene
from tests.worlds.ride import Ride, ride

RADIUS, PRESSED = 0.1, 60
"""Half edge of the hand [m], and frames in which it is led under the table and rests there."""


def with_friction(scene: Scene, mu: float) -> Scene:
    """Return the scene with one coefficient of friction for all pairs."""
    laws = {pair: ContactLaw(law.restitution, mu) for pair, law in scene.materials.pairs.items()}
    return replace(scene, materials=PairTable(laws))


def table(mu: float) -> Scene:
    """Return a cube of a hand that begins on a table whose top is at height 0."""
    top = fixed("table", (Piece(Box((4.0, 4.0, 1.0))),), "wood", (0.0, 0.0, -0.5))
    cube = (Piece(Box((2 * RADIUS, 2 * RADIUS, 2 * RADIUS))),)
    return with_friction(hand_scene((0.0, 0.0, RADIUS + 1e-3), top, shape=cube), mu)


def led(go: Ride, start: tuple[float, float, float], end: tuple[float, float, float], frames: int, rest: int) -> np.ndarray:
    """Return where the hand is after its target went straight from start to end and rested there."""
    for k in range(frames + rest):
        share = min(1.0, (k + 1) / frames)
        go.frame(at(go.scene.first_sample, tuple((1.0 - share) * np.array(start) + share * np.array(end))))
    return np.array(go.record.shown.positions[-1])


@settings(max_examples=6)
@given(mu=st.floats(0.05, 0.9), depth=st.floats(0.01, 0.08), angle=st.floats(0.0, 6.28))
def test_a_hand_pressed_on_a_table_stays_in_the_friction_cone(mu: float, depth: float, angle: float) -> None:
    """A point that is drawn slowly aside ends on the circle about its target of radius mu times the depth; a cube tilts, and is
    nearer."""
    go, low, far = ride(table(mu)), (0.0, 0.0, RADIUS - depth), 0.12
    led(go, (0.0, 0.0, RADIUS + 1e-3), low, 20, PRESSED)
    aside = (far * np.cos(angle), far * np.sin(angle))
    shown = led(go, low, (*aside, low[2]), 240, 120)
    assert 0.5 * mu * depth - 1e-3 < np.hypot(*(shown[:2] - aside)) < mu * depth + 1e-3
    home = led(go, (*aside, low[2]), (*aside, RADIUS + 0.05), 20, 60)
    assert np.abs(home - [*aside, RADIUS + 0.05]).max() < 1e-9, "what sticks comes free"


def test_a_hand_drawn_along_a_table_quickly_follows() -> None:
    """Friction fades with the speed of the target: here 0.6 m/s."""
    go, low = ride(table(0.8)), (0.0, 0.0, RADIUS - 0.05)
    led(go, (0.0, 0.0, RADIUS + 1e-3), low, 20, PRESSED)
    shown = led(go, low, (0.6, 0.0, low[2]), 60, 0)
    assert abs(shown[0] - 0.6) < 2e-3


@pytest.mark.parametrize("off", [False, True])
def test_without_friction_the_posture_is_the_nearest(off: bool) -> None:
    """A coefficient of 0 and the effect switched off are the same to the bit."""
    scene = with_friction(walled_hinged(), 0.3 if off else 0.0)
    scene = replace(scene, narrow=("friction",)) if off else scene
    go, plain = ride(scene), ride(with_friction(walled_hinged(), 0.0))
    for k in range(60):
        sample = at(scene.first_sample, (0.012 * k, 0.01 * np.sin(k / 5.0), 1.1 - 0.001 * k))
        assert np.array_equal(go.frame(sample).shown.positions, plain.frame(sample).shown.positions)


def test_the_shown_posture_rests_as_soon_as_its_target_does() -> None:
    """Without friction a body that is pressed on a wall creeps on for seconds (0.1 m/s at first)."""
    speeds = []
    for mu in (0.0, 0.3):
        go = ride(with_friction(walled_hinged(), mu))
        for k in range(60):
            go.frame(at(go.scene.first_sample, (0.012 * k, 0.01 * np.sin(k / 5.0), 1.1 - 0.001 * k)))
        before = go.record.shown.positions
        for _ in range(30):
            go.frame(at(go.scene.first_sample, (0.012 * 59, 0.01 * np.sin(59 / 5.0), 1.1 - 0.059)))
        speeds.append(float(np.linalg.norm(go.record.shown.positions - before, axis=-1).max()))
    assert speeds[1] < 0.5 * speeds[0]
