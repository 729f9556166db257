"""A ball that bounces in the test, by events and by steps, with figures given by hand."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from avatarsim.errors import InvalidScene
from runfiles.record import Recording
from scenarios.measure.bodies.bounce import bounces, flight, impacts
from scenarios.measure.timeline import timeline
from scenarios.measure.value import Missing
from scenarios.scenario import Drop
from tests.scenarios.examples import DT, RADIUS, drop, drop_scene, fist, fist_scene, resting, with_inside

G = 9.81


def exact(times: np.ndarray, ratios: list[float]) -> tuple[np.ndarray, np.ndarray, list[tuple[float, float, float]]]:
    """Return gap, speed and impacts (time, speed before, speed after) of a ball dropped from 1 m.
    It leaves its k-th impact with ratios[k] of its speed (0 after the last)."""
    begun, up, launch, events = 0.0, 0.0, 1.0, []
    gap, speed = np.zeros(len(times)), np.zeros(len(times))
    for ratio in [*ratios, 0.0]:
        hit = begun + (up + np.sqrt(up * up + 2.0 * G * launch)) / G
        chosen = (times >= begun) & (times < hit)
        t = times[chosen] - begun
        gap[chosen], speed[chosen] = launch + up * t - 0.5 * G * t * t, up - G * t
        before = G * (hit - begun) - up
        events.append((hit, before, ratio * before))
        begun, up, launch = hit, ratio * before, 0.0
        if ratio == 0.0:
            break
    return gap, speed, events


def by_events(ratios: list[float], frames: int = 90) -> Recording:
    """Return the recording of an event-driven engine: shown frames, and a pair of snapshots at each impact."""
    recording = resting(drop_scene(), frames)
    gap, speed, events = exact(recording.times, ratios)
    positions, velocities = recording.positions.copy(), recording.velocities.copy()
    positions[:, 1, 2], velocities[:, 1, 2] = gap + RADIUS, speed
    events = [event for event in events if event[0] < recording.times[-1]]
    times, frame, names = [], [], []
    inside_p, inside_v = np.tile(recording.positions[0], (2 * len(events), 1, 1)), np.zeros((2 * len(events), 2, 3))
    inside_p[:, 1, 2] = RADIUS
    for k, (at, before, after) in enumerate(events):
        times += [at, at]
        frame += [int(at / DT) + 1] * 2
        names += ["approach", "impact"]
        inside_v[2 * k, 1, 2], inside_v[2 * k + 1, 1, 2] = -before, after
    return with_inside(replace(recording, positions=positions, velocities=velocities), times, frame, names, inside_p, inside_v)


def by_steps(ratio: float, steps: int, frames: int = 90, soft: float = 0.0, early: bool = False) -> Recording:
    """Return the recording of a fixed-step engine with semi-implicit steps. At the slab the speed is reversed at once, or over
    `soft` [s] by a constant force. `early`: the contact is solved for the speed before gravity acts in that step."""
    recording = resting(drop_scene(), frames)
    h, z, v, push = DT / steps, 1.0, 0.0, None
    positions, velocities = recording.positions.copy(), recording.velocities.copy()
    inside_p, inside_v = np.tile(recording.positions[0], (frames * steps, 1, 1)), np.zeros((frames * steps, 2, 3))
    for k in range(frames * steps):
        # while the slab pushes, it also carries the ball's weight
        v -= G * h if push is None else 0.0
        if soft and push is None and z + v * h < 0.0 and v < -0.3:
            push = (1.0 + ratio) * -v / round(soft / h), -ratio * v
        if push is not None:
            v += push[0]
            if v >= push[1] - 1e-9:
                push = None
        elif not soft and z + v * h < 0.0 and v < 0.0:
            v = -ratio * (v + G * h if early else v) if v < -0.3 else 0.0
        elif soft and z + v * h < 0.0 and v < 0.0:
            v = 0.0
        z += v * h
        inside_p[k, 1, 2], inside_v[k, 1, 2] = z + RADIUS, v
        if (k + 1) % steps == 0:
            positions[(k + 1) // steps, 1, 2], velocities[(k + 1) // steps, 1, 2] = z + RADIUS, v
    times = [(k + 1) * h for k in range(frames * steps)]
    frame = [k // steps + 1 for k in range(frames * steps)]
    moved = replace(recording, positions=positions, velocities=velocities)
    return with_inside(moved, times, frame, ["step"] * len(times), inside_p, inside_v)


@pytest.mark.parametrize(("ratios", "error"), [
    ([0.4, 0.3], 0.16 - 0.09), ([0.3, 0.6], (0.3 * 0.6) ** 2 - 0.3**4), ([0.3], 0.3**4),
])
def test_apex_is_compared_with_every_bounces_closed_form(ratios: list[float], error: float) -> None:
    """Bounces that stop short miss their whole apex."""
    assert bounces(by_events(ratios), drop(), drop_scene())["apex_error_max"] == pytest.approx(error, abs=1e-9)


def test_impacts_slower_than_the_rest_speed_say_nothing() -> None:
    # 4.43, 1.33 and 0.40 m/s count; the fourth impact is at 0.12 m/s and is not compared
    found = bounces(by_events([0.3, 0.3, 0.3, 0.9]), drop(), drop_scene())
    assert found["restitution_error_max"] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("steps", [1, 4, 8])
@pytest.mark.parametrize("ratio", [0.3, 0.0, 0.75])
def test_a_hard_engine_of_fixed_steps_is_read_exactly(steps: int, ratio: float) -> None:
    recording = by_steps(ratio, steps)
    way = flight(timeline(recording, [1, 0]), Drop("ball", "slab", ratio, 1.0), np.array([0.0, 0.0, -G]))
    fast = [impact for impact in impacts(way) if impact.before > 0.3]
    assert fast and [impact.after / impact.before for impact in fast] == pytest.approx([ratio] * len(fast), abs=1e-12)
    found = bounces(recording, drop(restitution=0.3), drop_scene())
    assert found["restitution_error_max"] == pytest.approx(abs(ratio - 0.3), abs=1e-12)
    if ratio == 0.3 and steps > 1:
        # this engine reverses the ball in place when the step would pass through the slab: up to v dt above it
        assert isinstance(apex := found["apex_error_max"], float) and apex < 4.43 * DT / steps


@pytest.mark.parametrize("early", [False, True])
@pytest.mark.parametrize("asked", [0.3, 0.25])
def test_order_of_contact_and_gravity_does_not_matter(early: bool, asked: float) -> None:
    """At 60 steps a second one step of gravity is a third of the third approach speed: with or without it, the ratio is exact."""
    found = bounces(by_steps(0.3, 1, early=early), drop(restitution=asked), drop_scene())["restitution_error_max"]
    assert isinstance(found, float)
    assert found == pytest.approx(0.0, abs=1e-12) if asked == 0.3 else found > 0.02


def test_soft_contact_is_read_from_first_brake_to_release() -> None:
    found = bounces(by_steps(0.5, 8, soft=0.02), drop(restitution=0.5), drop_scene())
    assert isinstance(found["restitution_error_max"], float) and found["restitution_error_max"] < 1e-9
    wrong = bounces(by_steps(0.5, 8, soft=0.02), drop(restitution=0.3), drop_scene())
    assert wrong["restitution_error_max"] == pytest.approx(0.2, abs=1e-9)


def course(place: Callable[[np.ndarray], np.ndarray], speed: Callable[[np.ndarray], np.ndarray]) -> Recording:
    """Return a recording of the ball with these heights and velocities as functions of time."""
    recording = resting(drop_scene(), 90)
    recording.positions[:, 1, 2], recording.velocities[:, 1, 2] = place(recording.times), speed(recording.times)
    return recording


@pytest.mark.parametrize(("recording", "fault"), [
    (resting(drop_scene(), 90), "engine"), (course(lambda t: 1.0 + RADIUS - 0.5 * G * t**2, lambda t: -G * t), "engine"),
    (course(lambda t: t * np.nan, lambda t: t * np.nan), "engine"), (resting(drop_scene(), 20), "scene"),
], ids=["frozen", "through the slab", "not a number", "ends in the air"])
def test_ball_that_never_bounced_is_missing_by_fault(recording: Recording, fault: str) -> None:
    values = bounces(recording, drop(recording.frames), drop_scene()).values()
    assert values and all(isinstance(value, Missing) and value.fault == fault for value in values)


def test_impact_of_another_ball_is_not_taken_for_this_ones() -> None:
    recording = by_events([0.3, 0.3, 0.3])
    velocities = recording.inside_velocities.copy()
    velocities[1] = velocities[0]
    found = bounces(replace(recording, inside_velocities=velocities), drop(), drop_scene())
    # the first pair of snapshots now belongs to another ball, the later ones still to this one
    assert found["restitution_error_max"] == pytest.approx(0.0, abs=1e-12)


def test_no_drops_say_nothing_and_no_gravity_is_refused() -> None:
    assert bounces(resting(fist_scene(), 3), fist(3), fist_scene()) == {}
    with pytest.raises(InvalidScene, match="gravity"):
        flight(timeline(resting(drop_scene(), 1), [1, 0]), Drop("ball", "slab", 0.3, 1.0), np.zeros(3))
