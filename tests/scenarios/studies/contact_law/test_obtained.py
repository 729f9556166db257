"""The method against synthetic flights of known restitution and friction, by closed form and by steps."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenarios.studies.contact_law.obtained import friction, restitution

G = 9.81


def flight(e: float, dt: float, speed: float = 3.96, height: float = 0.2, seconds: float = 0.3) -> tuple[np.ndarray, np.ndarray]:
    """Return exact heights and speeds of a ball that is thrown down and bounces once with restitution `e`."""
    hit = (-speed + math.sqrt(speed**2 + 2.0 * G * height)) / G
    times = np.arange(round(seconds / dt) + 1) * dt
    arrived = speed + G * hit
    before = (height - speed * times - 0.5 * G * times**2, -speed - G * times)
    since = times - hit
    after = (e * arrived * since - 0.5 * G * since**2, e * arrived - G * since)
    late = times >= hit
    return np.where(late, after[0], before[0]), np.where(late, after[1], before[1])


@given(st.sampled_from([1 / 60, 1 / 240, 1 / 1000, 1 / 4000]), st.floats(0.4, 1.2), st.floats(0.1, 0.3))
def test_an_exact_bounce_gives_its_restitution(dt: float, e: float, height: float) -> None:
    z, v = flight(e, dt, height=height)
    assert restitution(z, v, G, dt) == pytest.approx(e, abs=1e-9)


def stepped(e: float, dt: float) -> tuple[np.ndarray, np.ndarray]:
    """Return a ball of semi-implicit steps that is reversed in the step after its overlap is found, as with fixed steps."""
    z, v = [0.2], [-3.96]
    for _ in range(round(0.3 / dt)):
        speed = -e * v[-1] if z[-1] < 0.0 and v[-1] < 0.0 else v[-1] - G * dt
        v.append(speed)
        z.append(z[-1] + dt * speed)
    return np.array(z), np.array(v)


def test_late_steps_are_off_by_what_they_are_late() -> None:
    errors = [abs(restitution(*stepped(0.75, dt), G, dt) - 0.75) for dt in (1 / 60, 1 / 240, 1 / 1000, 1 / 4000)]
    assert errors[0] < 0.05 and errors[-1] < 1e-3 and errors[-1] < errors[0]


def test_who_stays_on_the_floor_has_not_bounced_or_has_no_figure() -> None:
    z, v = flight(0.0, 1 / 240)
    for below in (0.0, 0.01):
        assert restitution(np.where(z < 0.0, 0.0, z) - below, np.where(z < 0.0, 0.0, v), G, 1 / 240) == 0.0
    # who never arrives or goes through has no figure
    z, v = flight(0.5, 1 / 240)
    assert math.isnan(restitution(z[:5], v[:5], G, 1 / 240))
    z[40:] = -0.2
    assert math.isnan(restitution(z, v, G, 1 / 240)) and math.isnan(restitution(np.full(9, np.nan), np.full(9, np.nan), G, 0.1))


def slide(mu: float, dt: float, angle: float = 0.0, drag: float = 0.0, steps: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """Return velocities and heights of a body that arrives at 2 m/s and 25 m/s along, with its impulse spread over some steps."""
    velocity = [np.array([25.0 * math.cos(angle), 25.0 * math.sin(angle), -2.0])]
    height, left = [0.1], steps
    for _ in range(round(0.2 / dt)):
        v = velocity[-1] * (1.0 - drag * dt)
        if height[-1] <= 2.0 * dt and left:
            left -= 1
            v = v + 3.0 / steps * np.array([-mu * math.cos(angle), -mu * math.sin(angle), 1.0])
        velocity.append(v)
        height.append(height[-1] + dt * v[2])
    return np.array(velocity), np.array(height)


@pytest.mark.parametrize("dt", [1 / 60, 1 / 240, 1 / 4000])
@pytest.mark.parametrize("mu", [0.0, 0.1, 0.8])
@pytest.mark.parametrize("steps", [1, 2])
def test_friction_is_the_ratio_of_impulses(dt: float, mu: float, steps: int) -> None:
    for angle in (0.0, math.pi / 4):
        assert friction(*slide(mu, dt, angle, steps=steps), dt) == pytest.approx(mu, abs=1e-12)


@pytest.mark.parametrize("dt", [1 / 60, 1 / 240])
def test_drag_is_no_friction(dt: float) -> None:
    assert friction(*slide(0.3, dt, drag=0.5), dt) == pytest.approx(0.3, abs=0.005)
    assert friction(*slide(0.0, dt, drag=0.5), dt) == pytest.approx(0.0, abs=0.005)


def test_who_is_not_hit_or_hit_at_once_has_no_friction() -> None:
    velocity, height = slide(0.3, 1 / 240)
    assert math.isnan(friction(velocity[:3], height[:3], 1 / 240)) and math.isnan(friction(velocity[12:], height[12:], 1 / 240))


@pytest.mark.parametrize("dt", [1 / 240, 1 / 1000, 1 / 4000])
def test_a_contact_that_takes_its_time_is_a_contact(dt: float) -> None:
    velocity, height = [np.array([25.0, 0.0, -2.0])], [0.1]
    for _ in range(round(0.2 / dt)):
        # a damper of 20 ms that slides and does not bounce
        push = 95.0 * dt * max(0.0, -velocity[-1][2]) if height[-1] < 0.0 else 0.0
        velocity.append(velocity[-1] + push * np.array([-0.4, 0.0, 1.0]))
        height.append(height[-1] + dt * velocity[-1][2])
    assert friction(np.array(velocity), np.array(height), dt) == pytest.approx(0.4, abs=1e-12)
