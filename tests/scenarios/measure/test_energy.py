from dataclasses import replace

import numpy as np
import pytest

from scenarios.measure.energy import energy, kinetic
from scenarios.measure.value import Missing
from scenarios.record import Recording
from tests.scenarios.examples import RADIUS, drop_scene, fist_scene, resting

G, MASS = 9.81, 2.0


def falling(frames: int = 20) -> Recording:
    recording = resting(drop_scene(), frames)
    positions, velocities = recording.positions.copy(), recording.velocities.copy()
    positions[:, 1, 2] = 1.0 + RADIUS - 0.5 * G * recording.times**2
    velocities[:, 1, 2] = -G * recording.times
    return replace(recording, positions=positions, velocities=velocities)


def test_free_fall_adds_nothing() -> None:
    found = energy(falling(), drop_scene())
    assert found["energy_added_max"] == pytest.approx(0.0, abs=1e-12)
    assert found["lift_energy_max"] == pytest.approx(0.0, abs=1e-12)


def test_an_injected_kick_comes_out_in_joules() -> None:
    recording = falling()
    velocities = recording.velocities.copy()
    velocities[12:, 1, 0] = 3.0
    assert energy(replace(recording, velocities=velocities), drop_scene())["energy_added_max"] == pytest.approx(9.0, abs=1e-9)


def test_an_injected_spin_comes_out_in_joules() -> None:
    recording = falling()
    spins = recording.angular_velocities.copy()
    spins[5:, 1, 1] = 10.0
    inertia = 0.4 * MASS * RADIUS**2
    assert energy(replace(recording, angular_velocities=spins), drop_scene())["energy_added_max"] == pytest.approx(50.0 * inertia)


def test_an_injected_lift_is_lift_and_not_gain() -> None:
    recording = resting(drop_scene(), 10)
    positions = recording.positions.copy()
    positions[4:, 1, 2] += 0.01
    found = energy(replace(recording, positions=positions), drop_scene())
    assert found["lift_energy_max"] == pytest.approx(MASS * G * 0.01, abs=1e-12)
    assert found["energy_added_max"] == pytest.approx(0.0, abs=1e-12)


def test_losing_energy_is_no_gain() -> None:
    recording = falling()
    velocities = recording.velocities.copy()
    velocities[10:, 1, 2] *= 0.3
    assert energy(replace(recording, velocities=velocities), drop_scene())["energy_added_max"] == pytest.approx(0.0, abs=1e-9)


def test_kinetic_energy_uses_the_bodys_own_axes() -> None:
    turn = np.array([[[np.cos(np.pi / 4), 0.0, 0.0, np.sin(np.pi / 4)]]])
    inertia = np.diag([1.0, 2.0, 3.0])[None]
    found = kinetic(np.array([4.0]), inertia, turn, np.array([[[0.0, 0.0, 2.0]]]), np.array([[[1.0, 0.0, 0.0]]]))
    # world x is the body's -y after a quarter turn about z
    assert found == pytest.approx(np.array([[0.5 * (4.0 * 4.0 + 2.0)]]))


def test_frames_with_a_driven_link_in_reach_explain_themselves() -> None:
    scene = drop_scene()
    avatar = replace(fist_scene().avatars[0])
    both = replace(scene, avatars=(avatar,))
    recording = resting(both, 5)
    velocities = recording.velocities.copy()
    velocities[3:, 1, 0] = 3.0
    pushed = replace(recording, velocities=velocities)
    far = energy(pushed, both)
    assert far["energy_added_max"] == pytest.approx(9.0)
    near = recording.positions.copy()
    near[:, 2, 2] = 0.9
    value = energy(replace(pushed, positions=near), both)["energy_added_max"]
    assert isinstance(value, Missing) and value.fault == "scene"


def test_no_simulated_body_no_energy() -> None:
    assert energy(resting(fist_scene(), 3), fist_scene()) == {}
