"""Eq. 6 over masses and frame times: hands of 0.1 to 10 kg, on the spring of the virtual coupling, strike balls as they pass.

Closed form, elastic and without friction: a hand led at V that strikes a ball at rest goes on with (m - M) / (m + M) V, the
ball with 2 m / (m + M) V; the hand's offset from its user is then that of a damped spring, thrown back with 2 M / (m + M) V.
Balls four times as heavy as their hand are caught up with again and again: the paper's worry about endless loops.
"""

from collections.abc import Iterator

from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Sphere
from avatarsim.scene.tracker import TrackerSample
from reference.closed_form import spring_state, two_spheres
from scenarios.building.cases import NOWHERE, driven, laws, loose
from scenarios.building.expected import Course, OfTime, steady
from scenarios.building.promises import FINITE, MOVES, NO_OVERLAP
from scenarios.motion.rigid_hands import by_time, hands_at
from scenarios.scenario import Bound, Scenario

MASSES, LIGHT, HEAVY = (0.1, 0.4, 1.0, 10.0), 0.25, 4.0
"""Masses of the hands [kg], of which 0.4 is critically damped, and of a ball over that of its hand."""
SPRING, DAMPING = 1000.0, 40.0
"""Eq. 6 with the paper's K [N/m] and R [N s/m], which are the engine's defaults."""
SPEED, RADIUS, GAP, LANE = 0.5, 0.05, 0.1, 0.5
"""Speed of the users [m/s], radius of hands and balls, way to the ball [m], met after 0.2 s, and distance of the hands [m]."""
CASES = tuple((mass, ratio) for ratio in (LIGHT, HEAVY) for mass in MASSES)


def build(name: str) -> Scene:
    """Return eight hands side by side, a ball before each."""
    ball = Sphere(RADIUS)
    bodies = tuple(
        loose(f"ball_{mass:g}_{ratio:g}", ball, "ball", ratio * mass, (2.0 * RADIUS + GAP, LANE * k, 0.0))
        for k, (mass, ratio) in enumerate(CASES)
    )
    hands = tuple(driven(f"hand_{mass:g}_{ratio:g}", ball, mass, "hand") for mass, ratio in CASES)
    return Scene(name, bodies, hands, laws({("ball", "hand"): (1.0, 0.0)}), gravity=NOWHERE, start=led(0.0))


def led(time: float) -> TrackerSample:
    """Return where all users are at a time [s]."""
    return hands_at([(SPEED * time, LANE * k, 0.0) for k in range(len(CASES))], time)


def hand_goes(after: float, mass: float, y: float) -> OfTime:
    """Return the place [m] of a hand that continues at the speed `after` [m/s] after it has struck a ball."""
    due = GAP / SPEED

    def at(time: float) -> tuple[float, float, float]:
        off = spring_state(0.0, after - SPEED, mass, SPRING, DAMPING, time - due)[0] if time > due else 0.0
        return SPEED * time + off, y, 0.0

    return at


def courses(dt: float) -> Iterator[Course]:
    """Yield places of all hands with light balls, and velocities of these: samples leave open when in a frame a hand strikes."""
    for k, mass in enumerate(MASSES):
        own, others = two_spheres(mass, LIGHT * mass, SPEED, 0.0, 1.0)
        yield Course(f"hand_{mass:g}_{LIGHT:g}", hand_goes(own, mass, LANE * k))
        yield Course(f"ball_{mass:g}_{LIGHT:g}", velocity=steady(others, 0.0, 0.0), since=GAP / SPEED + 1.5 * dt)


def at_rate(rate: int) -> Scenario:
    """Return the grid at so many frames per second, for a second."""
    name = "coupling_sweep" if rate == 60 else f"coupling_sweep_{rate}"
    return Scenario(
        name, f"Hands of 0.1 to 10 kg strike balls as they pass, at {rate} frames per second.",
        "How hands return on the spring of eq. 6, and where the balls go; that pushing heavy balls ends.",
        lambda: build(name), by_time(led, 1.0 / rate), rate, dt=1.0 / rate,
        bounds=(
            NO_OVERLAP, FINITE, *MOVES,
            Bound("course_error_max", 1e-6, "eq. 6 in closed form at any frame time; contact is a gap of 2e-8 m"),
            Bound("velocity_error_max", 1e-9, "eq. 9 with the hand's coupled mass; nothing but rounding is left"),
        ),
        expects={"courses": tuple(courses(1.0 / rate))}, family="coupling_sweep",
    )


SCENARIOS = tuple(map(at_rate, (30, 60, 240)))
