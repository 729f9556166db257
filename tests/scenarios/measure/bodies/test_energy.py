"""Energy of simulated bodies: injected gains are found in joules, and energy from a driven link is not a gain."""

from dataclasses import replace

import numpy as np
import pytest

from runfiles.record import EVENTS
from scenarios.measure.bodies.energy import energy, kinetic
from scenarios.measure.value import Missing
from tests.scenarios.examples import DT, RADIUS, drop_scene, fist_scene, resting

G, MASS = 9.81, 2.0


@pytest.mark.parametrize(("field", "change", "added"), [
    ("velocities", (0.0, 0.0, 0.0), 0.0), ("velocities", (3.0, 0.0, 0.0), 9.0), ("velocities", (0.0, 0.0, 0.7), 0.0),
    ("angular_velocities", (0.0, 10.0, 0.0), 50.0 * 0.4 * MASS * RADIUS**2),
])
def test_injected_energy_gain_comes_out_in_joules(field: str, change: tuple[float, float, float], added: float) -> None:
    recording = resting(drop_scene(), 20)
    recording.positions[:, 1, 2] = 1.0 + RADIUS - 0.5 * G * recording.times**2
    recording.velocities[:, 1, 2] = -G * recording.times
    getattr(recording, field)[12:, 1] += change
    assert energy(recording, drop_scene())["energy_added_max"] == pytest.approx(added, abs=1e-9)


def test_an_injected_lift_is_lift_and_not_gain() -> None:
    recording = resting(drop_scene(), 10)
    recording.positions[4:, 1, 2] += 0.01
    found = energy(recording, drop_scene())
    assert found["lift_energy_max"] == pytest.approx(MASS * G * 0.01, abs=1e-12)
    assert found["lift_height_max"] == pytest.approx(0.01, abs=1e-12)
    assert found["energy_added_max"] == pytest.approx(0.0, abs=1e-12)


def test_kinetic_energy_uses_the_bodys_own_axes() -> None:
    turn = np.array([[[np.cos(np.pi / 4), 0.0, 0.0, np.sin(np.pi / 4)]]])
    inertia = np.diag([1.0, 2.0, 3.0])[None]
    found = kinetic(np.array([4.0]), inertia, turn, np.array([[[0.0, 0.0, 2.0]]]), np.array([[[1.0, 0.0, 0.0]]]))
    # world x is the body's -y after a quarter turn about z
    assert found == pytest.approx(np.array([[0.5 * (4.0 * 4.0 + 2.0)]]))


def test_frames_with_a_driven_link_in_reach_explain_themselves() -> None:
    scene = drop_scene()
    both = replace(scene, avatars=fist_scene().avatars)
    recording = resting(both, 5)
    recording.velocities[3:, 1, 0] = 3.0
    assert energy(recording, both)["energy_added_max"] == pytest.approx(9.0)
    recording.positions[:, 2, 2] = 0.9
    value = energy(recording, both)["energy_added_max"]
    assert isinstance(value, Missing) and value.fault == "scene"


@pytest.mark.parametrize(("fist_after", "coupled", "added"), [(18.0, None, 153.0), (4.0, None, 0.0), (4.0, 10.0, 71.0)])
def test_what_a_link_takes_in_an_impact_is_weighed(fist_after: float, coupled: float | None, added: float) -> None:
    """A ball of 2 kg brings 9 J and stops; the fist of 1 kg, or of its stated coupled mass, leaves with a given speed."""
    scene = replace(drop_scene(), avatars=(replace(fist_scene().avatars[0], coupled_mass=coupled),))
    recording = resting(scene, 3)
    velocities, states = np.zeros((2, 3, 3)), np.zeros((2, 3, 4))
    velocities[0, 1, 0], velocities[1, 2, 0] = 3.0, fist_after
    states[:, :, 0] = 1.0
    struck = replace(
        recording, inside_time=np.full(2, DT), inside_frame=np.ones(2, dtype=np.int64),
        inside_event=np.array([EVENTS.index("approach"), EVENTS.index("impact")]), inside_positions=np.zeros((2, 3, 3)),
        inside_orientations=states, inside_velocities=velocities, inside_angular_velocities=np.zeros((2, 3, 3)),
    )
    assert energy(struck, scene)["energy_added_max"] == pytest.approx(added, abs=1e-12)
