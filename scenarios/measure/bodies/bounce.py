"""Bounces against the closed form: the ratio of velocities at the impact, and the height of every apex.

Also the times at which a ball bounces and stops bouncing, against the closed form.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from avatarsim.errors import InvalidScene
from avatarsim.scene.scene import Scene
from reference.closed_form import bounce_time, zeno_time
from runfiles.record import EVENTS, Recording
from scenarios.measure.expecting import expected, for_each, worst
from scenarios.measure.timeline import Timeline, timeline
from scenarios.measure.value import Missing, Value, Values, measure
from scenarios.scenario import Drop, Scenario

Array = NDArray[np.float64]

REST_SPEED = 0.3
"""Approach speed [m/s] below which an impact gives no restitution. A ball at rest on a fixed-step engine jitters at up to
g dt = 0.16 m/s (60 Hz), and engines treat slow contacts as resting (one of them below 0.2 m/s by default)."""
JITTER = 0.1
"""Approach speed [m/s] below which a contact does not end a flight; a 1 mm apex comes from 0.14 m/s."""
LOWEST_APEX = 1e-3
"""Smallest expected apex [m] that is compared; below, the contact's own softness decides."""
CONTACT = 0.1
"""Longest contact [s] within which a soft engine may turn the ball round; one by default takes 0.02 to 0.05."""
NEAR = 0.05
"""Gap [m] within which a change of velocity is an impact with the slab and not something else."""
LATE = 0.1
"""Time [s] by which the recording must outlast the closed form's apex for that apex to be measured."""
ENDED = 1e-9
"""Speed [m/s] below which a ball has stopped bouncing; a bounce of 1e-9 m/s is lower than an atom."""


@dataclass(frozen=True)
class Impact:
    """One impact: time [s], speed of approach and of separation [m/s] along the slab's normal.

    The approach of an engine with steps lies between `least`, its speed before the step, and `before`, which has the g dt of that
    step on top: some solve the contact before gravity acts on it and some after, and no recording states which. Events do.
    """

    time: float
    before: float
    after: float
    least: float

    def error(self, restitution: float) -> float:
        """Return the difference of the velocities' ratio from `restitution`, for whichever approach the engine has reversed."""
        low = self.after / self.before
        high = self.after / self.least if self.least > 0.0 else np.inf
        return max(0.0, low - restitution, restitution - high)


@dataclass(frozen=True, eq=False)
class Flight:
    """Ball against slab: `time` (T,), surface gap `height` (T,) [m], normal `speed` (T,) [m/s], `event` (T,), gravity [m/s^2]."""

    time: Array
    height: Array
    speed: Array
    event: NDArray[np.int64]
    gravity: float


def flight(line: Timeline, drop: Drop, gravity: Array) -> Flight:
    """Return the flight of the first of two bodies on `line` over the second. The gap at the start is `drop.height`."""
    strength = float(np.linalg.norm(gravity))
    if not strength > 0.0:
        raise InvalidScene(f"gravity of a scene that drops {drop.ball}", gravity.tolist(), "a vector of non-zero length")
    up = -gravity / strength
    apart = (line.positions[:, 0] - line.positions[:, 1]) @ up
    speed = (line.velocities[:, 0] - line.velocities[:, 1]) @ up
    return Flight(line.time, drop.height + apart - apart[0], speed, line.event, strength)


def impacts(way: Flight) -> list[Impact]:
    """Return all impacts in order: at events where the engine gives them, else at the reversals that its steps show."""
    return list(_at_events(way) if (way.event == EVENTS.index("impact")).any() else _between_steps(way))


def _at_events(way: Flight) -> Iterator[Impact]:
    """Yield impacts at events: v- of the snapshot "approach", v+ of the snapshot "impact" after it, at the same instant."""
    for k in np.flatnonzero(way.event == EVENTS.index("impact")):
        before, after = -float(way.speed[k - 1]), float(way.speed[k])
        # the event may be another ball's: then this one's velocity is the same on both sides, to the last bit
        if before > 0.0 and after != -before:
            yield Impact(float(way.time[k]), before, after, before)


def _between_steps(way: Flight) -> Iterator[Impact]:
    """Yield impacts of fixed steps, without events. In free flight the speed only falls; the first step in which it rises, near
    the slab, is the impact. v- is the speed before that step, with or without the g dt that the step itself adds (see Impact); v+
    is the largest speed before gravity makes it fall again, at most CONTACT later."""
    fresh = np.flatnonzero(np.diff(way.time, append=np.inf) > 0.0)
    time, height, speed = way.time[fresh], way.height[fresh], way.speed[fresh]
    k = 1
    while k < len(time):
        before = -float(speed[k - 1]) + way.gravity * float(time[k] - time[k - 1])
        if not (speed[k - 1] < 0.0 and speed[k] > speed[k - 1] and abs(height[k]) <= NEAR + before * (time[k] - time[k - 1])):
            k += 1
            continue
        last = k
        while last + 1 < len(time) and time[last + 1] - time[k] <= CONTACT and not 0.0 < speed[last] > speed[last + 1]:
            last += 1
        yield Impact(float(time[k]), before, max(0.0, float(np.max(speed[k : last + 1]))), -float(speed[k - 1]))
        k = last + 1


def apex(way: Flight, start: float, end: float) -> float:
    """Return the largest gap [m] between `start` and `end` [s]; between two samples by the parabola of the last rising one."""
    # the state right after the impact is at `start` itself; a low bounce has no other that rises
    chosen = (way.time >= start) & (way.time < end)
    if not chosen.any():
        return 0.0
    height, speed = way.height[chosen], way.speed[chosen]
    # beyond the last sample comes the next impact, so there it falls
    rising = np.flatnonzero((speed > 0.0) & (np.append(speed[1:], -1.0) <= 0.0))
    top = float(np.max(height))
    return max(top, float(height[rising[0]] + speed[rising[0]] ** 2 / (2.0 * way.gravity))) if len(rising) else top


def apex_errors(way: Flight, drop: Drop, all_impacts: list[Impact]) -> list[float]:
    """Return |apex - e^(2n) h| [m] for n = 1, 2, ... while the expected apex is at least LOWEST_APEX and within the recording.

    A bounce that did not happen reached 0."""
    fall, e, errors = float(np.sqrt(2.0 * drop.height / way.gravity)), drop.restitution, []
    impact_time, n = fall, 1
    hits = [impact.time for impact in all_impacts if impact.before > JITTER]
    while (expected := e ** (2 * n) * drop.height) >= LOWEST_APEX and impact_time + e**n * fall + LATE <= way.time[-1]:
        ends = [*hits[n:], np.inf]
        errors.append(abs(apex(way, hits[n - 1], ends[0]) - expected) if n <= len(hits) else expected)
        impact_time += 2.0 * e**n * fall
        n += 1
    return errors


@for_each("drops", Drop)
def bounces(recording: Recording, scene: Scene, drop: Drop) -> Values:
    """Return restitution_error_max and apex_error_max [m] of a drop."""
    way = of_drop(recording, scene, drop)
    all_impacts = impacts(way)
    fast = [impact for impact in all_impacts if impact.before > REST_SPEED]
    if not fast:
        never = Missing(f"no impact of {drop.ball} was seen", "engine")
        if way.time[-1] < np.sqrt(2.0 * drop.height / way.gravity) + LATE:
            never = Missing(f"the recording ends before {drop.ball} comes down", "scene")
        return {"restitution_error_max": never, "apex_error_max": never}
    heights = apex_errors(way, drop, all_impacts)
    flat: Value = Missing(f"no expected apex above {LOWEST_APEX:g} m in the frames that were run", "scene")
    return {
        "restitution_error_max": max(impact.error(drop.restitution) for impact in fast),
        "apex_error_max": max(heights) if heights else flat,
    }


def of_drop(recording: Recording, scene: Scene, drop: Drop) -> Flight:
    """Return the flight of the ball over the floor."""
    pair = [scene.names.index(drop.ball), scene.names.index(drop.floor)]
    return flight(timeline(recording, pair), drop, np.array(scene.gravity))


@for_each("drops", Drop)
def bounce_times(recording: Recording, scene: Scene, drop: Drop) -> Values:
    """Return bounce_time_error_max [s]: the n-th impact faster than 0.1 m/s against the closed form's. One that did not happen
    within the recording is the engine's fault."""
    way, errors = of_drop(recording, scene, drop), list[float]()
    seen = [impact.time for impact in impacts(way) if impact.before > JITTER]
    speed, n = float(np.sqrt(2.0 * drop.height * way.gravity)), 1
    # twice the limit: an impact just below or above it must not decide whether the count is right
    while speed > 2.0 * JITTER and (due := bounce_time(drop.height, drop.restitution, way.gravity, n)) + LATE < way.time[-1]:
        if n > len(seen):
            return {"bounce_time_error_max": Missing(f"impact {n} of {drop.ball} was not seen", "engine")}
        errors.append(abs(seen[n - 1] - due))
        speed, n = speed * drop.restitution, n + 1
    early: Value = Missing("the recording ends before the first impact", "scene")
    return {"bounce_time_error_max": max(errors) if errors else early}


@measure
def zeno_ends(recording: Recording, scenario: Scenario, scene: Scene) -> Values:
    """Return zeno_end_error_max [s]: difference of the first instant from which on a ball is at rest from the closed form's, over
    all drops with restitution below 1, if the scene has expects["zeno"]."""
    if not scenario.expects.get("zeno"):
        return {}
    ends = [_end(of_drop(recording, scene, drop), drop) for drop in expected(scenario, "drops", Drop)]
    return {"zeno_end_error_max": worst(ends)}


def _end(way: Flight, drop: Drop) -> Value:
    end = zeno_time(drop.height, drop.restitution, way.gravity)
    if end + LATE > way.time[-1]:
        return Missing("the recording ends before a ball comes to rest", "scene")
    moving = np.flatnonzero(~(np.abs(way.speed) <= ENDED))
    rests_from = int(moving[-1]) + 1 if len(moving) else 0
    if rests_from == len(way.time) or rests_from == 0:
        return Missing(f"{drop.ball} {'never came to rest' if rests_from else 'never moved'}", "engine")
    return abs(float(way.time[rests_from]) - end)
