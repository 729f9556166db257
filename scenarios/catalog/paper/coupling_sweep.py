"""Eq. 6 over masses and frame times: hands of 0.1 to 10 kg, on the spring of the virtual coupling, strike balls as they pass.

Closed form, elastic and without friction: a hand that is led at V and strikes a ball at rest goes on with (m - M) / (m + M) V,
the ball with 2 m / (m + M) V; from then on the hand's offset from its user is that of a damped spring with the hand's mass,
thrown back with 2 M / (m + M) V. Balls of a quarter of their hand's mass are faster than the user and are not met again. Balls
four times as heavy as their hand are caught up with again and again: the paper's worry about endless loops.

In the 60 frames of a quick comparison the raw motion is inside each of the eight balls for 24, up to 0.1 m deep.
"""

from collections.abc import Callable

import numpy as np

from avatarsim.scene.avatar import rigid_avatar
from avatarsim.scene.body import Body, ContactLaw, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Piece, Sphere
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from reference.closed_form import spring_state, two_spheres
from scenarios.building.cases import NOWHERE, pair_table
from scenarios.building.expected import Course, OfTime, steady
from scenarios.building.promises import FINITE, MOVES, NO_OVERLAP
from scenarios.scenario import Bound, Motion, Scenario

MASSES = (0.1, 0.4, 1.0, 10.0)
"""Of the hands [kg]; 0.4 is critically damped."""
LIGHT, HEAVY = 0.25, 4.0
"""Mass of a ball over that of its hand."""
SPRING, DAMPING = 1000.0, 40.0
"""Eq. 6 with the paper's K [N/m] and R [N s/m], which are the engine's defaults."""
SPEED, RADIUS, GAP = 0.5, 0.05, 0.1
"""Speed of the users [m/s], radius of hands and balls, way to the ball [m]: they meet after 0.2 s."""
LANE, SECONDS = 0.5, 1.0
"""Distance of the hands [m], length of the run [s]."""
RATES = (30, 60, 240)
"""Frames per second."""
CASES = tuple((mass, ratio) for ratio in (LIGHT, HEAVY) for mass in MASSES)


def build(name: str) -> Scene:
    """Eight hands side by side, a ball before each."""
    piece, bodies, hands = (Piece(Sphere(RADIUS)),), list[Body](), []
    for k, (mass, ratio) in enumerate(CASES):
        at = (2.0 * RADIUS + GAP, LANE * k, 0.0)
        bodies.append(simulated(f"ball_{mass:g}_{ratio:g}", piece, "ball", solid(piece, ratio * mass), at))
        hands.append(rigid_avatar(f"hand_{mass:g}_{ratio:g}", piece, solid(piece, mass), "hand"))
    materials = pair_table(("ball", "hand"), {("ball", "hand"): ContactLaw(1.0, 0.0)})
    return Scene(name, tuple(bodies), tuple(hands), materials=materials, gravity=NOWHERE, start=led(0.0))


def led(time: float) -> TrackerSample:
    """Where all users are at a time [s]."""
    count = len(CASES)
    places = np.stack([np.full(count, SPEED * time), LANE * np.arange(count), np.zeros(count)], axis=1)
    return TrackerSample(time, places, np.tile(rotation.IDENTITY, (count, 1)), np.zeros(0))


def motion_at(dt: float) -> Callable[[Scene, int], Motion]:
    """Straight on, looked at every `dt` [s]."""
    return lambda scene, seed: lambda frame: led((frame + 1) * dt)


def hand_goes(mass: float, y: float) -> OfTime:
    """Place [m] of a hand that strikes a light ball."""
    due = GAP / SPEED
    after, _ = two_spheres(mass, LIGHT * mass, SPEED, 0.0, 1.0)

    def at(time: float) -> tuple[float, float, float]:
        off = spring_state(0.0, after - SPEED, mass, SPRING, DAMPING, time - due)[0] if time > due else 0.0
        return SPEED * time + off, y, 0.0

    return at


def courses(dt: float) -> tuple[Course, ...]:
    """Places of all hands with light balls, and velocities of these: samples leave open when in a frame a hand strikes."""
    found = []
    for k, (mass, ratio) in enumerate(CASES):
        if ratio == LIGHT:
            found.append(Course(f"hand_{mass:g}_{ratio:g}", hand_goes(mass, LANE * k)))
            _, after = two_spheres(mass, ratio * mass, SPEED, 0.0, 1.0)
            found.append(Course(f"ball_{mass:g}_{ratio:g}", velocity=steady(after, 0.0, 0.0), since=GAP / SPEED + 1.5 * dt))
    return tuple(found)


def at_rate(rate: int) -> Scenario:
    """The grid at so many frames per second."""
    name = "coupling_sweep" if rate == 60 else f"coupling_sweep_{rate}"
    return Scenario(
        name=name,
        title=f"Hands of 0.1 to 10 kg strike balls as they pass, at {rate} frames per second.",
        judged="How hands return on the spring of eq. 6, and where the balls go; that pushing heavy balls ends.",
        build=lambda: build(name),
        motion=motion_at(1.0 / rate),
        frames=round(SECONDS * rate),
        dt=1.0 / rate,
        bounds=(
            NO_OVERLAP, FINITE, *MOVES,
            Bound("course_error_max", 1e-6, "eq. 6 in closed form at any frame time; contact is a gap of 2e-8 m"),
            Bound("velocity_error_max", 1e-9, "eq. 9 with the hand's coupled mass; nothing but rounding is left"),
        ),
        expects={"courses": courses(1.0 / rate)},
    )


SCENARIOS = tuple(at_rate(rate) for rate in RATES)
