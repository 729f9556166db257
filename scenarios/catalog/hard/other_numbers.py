"""One little world at frame times of 1 us to 0.2 s, a hundred kilometres away, in mm and in km: no motion depends on these.

A ball is dropped and bounces until it rests, a box slides until it stops, three boxes stand on one another, and a ball is shot
at a wall from a centimetre. In other units lengths, speeds and gravity grow with `scale`; times and masses stay.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

from avatarsim.scene.body import Body
from avatarsim.scene.checks import Vector
from avatarsim.scene.shape import Box, Sphere
from reference.closed_form import bounce_state, stop_distance, stop_time
from scenarios.building.cases import LAID, NOWHERE, fixture, laws, loose
from scenarios.building.expected import Course, Rest
from scenarios.building.promises import SOUND
from scenarios.building.scenes import before, undriven
from scenarios.scenario import RENDERED, Bound, Scenario

FRAMES, GRAVITY = 120, 9.81
"""Frames of every scene, and gravity [m/s^2] at scale 1."""
RADIUS, HEIGHT, RESTITUTION = 0.1, 0.5, 0.5
"""Radius of the ball that is dropped, height of its lowest point [m], restitution: it rests after 0.96 s."""
SLIDES, SPEED, FRICTION = (0.4, 0.4, 0.1), 2.0, 0.5
"""Edges of the box that slides [m], its first speed [m/s], friction: it stops after 0.41 s and 0.41 m."""
EDGE, STACK = 0.2, ("lower", "middle", "upper")
"""Edge of the boxes that stand on one another [m], and their names."""
SHOT, FAST, NEAR = 0.05, 300.0, 0.01
"""Radius [m] and speed [m/s] of the ball that is shot, its way to the wall [m]: contact after 33 microseconds."""
FACE, HIGH, TALL = 3.0, 2.0, 2.0
"""Where the wall begins along x, at which height the ball is shot, height and width of the wall [m]."""
THICK = 20.0
"""Thickness of floor and wall [m]: at a thousandth of the size still more than an engine that stops 2 mm inside needs."""


@dataclass(frozen=True)
class Place:
    """Size of the world, and place of its origin [m]."""

    scale: float = 1.0
    origin: Vector = NOWHERE

    def at(self, x: float, y: float, z: float, laid: float = 0.0) -> Vector:
        """Return a place of the world, `laid` [m] above it whatever the scale."""
        ox, oy, oz = self.origin
        return ox + self.scale * x, oy + self.scale * y, oz + self.scale * z + laid

    def box(self, x: float, y: float, z: float) -> Box:
        """Return a box of the world."""
        return Box((self.scale * x, self.scale * y, self.scale * z))

    def along(self, speed: float) -> Vector:
        """Return a velocity [m/s] along x."""
        return self.scale * speed, 0.0, 0.0


def bodies(place: Place) -> Iterator[Body]:
    """Yield floor, its top at z = 0, wall, and the six bodies that move or rest."""
    yield fixture("floor", place.box(6.0, 4.0, THICK), "floor", place.at(0.0, 0.0, -0.5 * THICK))
    yield fixture("wall", place.box(THICK, TALL, TALL), "wall", place.at(FACE + 0.5 * THICK, 0.0, HIGH))
    yield loose("dropped", Sphere(place.scale * RADIUS), "ball", 1.0, place.at(-1.0, 1.0, HEIGHT + RADIUS))
    start = place.at(-1.0, 0.0, 0.5 * SLIDES[2], LAID)
    yield loose("slides", place.box(*SLIDES), "box", 1.0, start, velocity=place.along(SPEED))
    start = place.at(FACE - SHOT - NEAR, 0.0, HIGH)
    yield loose("shot", Sphere(place.scale * SHOT), "shot", 1.0, start, velocity=place.along(FAST))
    for k, name in enumerate(STACK):
        yield loose(name, place.box(EDGE, EDGE, EDGE), "box", 1.0, place.at(0.0, -1.0, (k + 0.5) * EDGE, (k + 1) * LAID))


def dropped(place: Place, time: float) -> Vector:
    """Return where the ball is that bounces."""
    return place.at(-1.0, 1.0, RADIUS + bounce_state(HEIGHT, RESTITUTION, GRAVITY, time)[0])


def slides(place: Place, time: float) -> Vector:
    """Return where the box is that slides."""
    ends = stop_time(SPEED, FRICTION, GRAVITY)
    left = max(0.0, ends - time) / ends
    return place.at(-1.0 + stop_distance(SPEED, FRICTION, GRAVITY) * (1.0 - left * left), 0.0, 0.5 * SLIDES[2], LAID)


def shot(place: Place, time: float) -> Vector:
    """Return where the ball is that comes back from the wall, falling all the while; nothing is in its way."""
    way, due = FAST * time, NEAR / FAST
    x = FACE - SHOT - NEAR + (way if time <= due else 2.0 * NEAR - way)
    return place.at(x, 0.0, HIGH - 0.5 * GRAVITY * time * time)


def scenario(name: str, title: str, place: Place, dt: float = RENDERED) -> Scenario:
    """Return the little world at a place, of a size, looked at every `dt` [s]."""
    courses = {"dropped": dropped, "slides": slides, "shot": shot}
    # a body that has hardly begun to fall has too little kinetic energy to compare the rounding of its height with
    alone = (("slides",), ("shot",), *((("dropped",),) if FRAMES * dt > 0.01 else ()))
    # deeper the ball is nearer to another side of the wall, and nothing brings it back
    lost = place.at(FACE + 0.5 * TALL, 0.0, 0.0)[0]
    return undriven(
        name, title, "Where everything is at any time; what stands, stands.", lambda: bodies(place),
        laws({
            ("ball", "floor"): (RESTITUTION, 0.0), ("box", "floor"): (0.0, FRICTION), ("box", "box"): (0.0, FRICTION),
            ("shot", "wall"): (1.0, 0.0),
        }),
        frames=FRAMES, dt=dt, family="other_numbers", gravity=(0.0, 0.0, -place.scale * GRAVITY), scale=place.scale,
        bounds=(
            *SOUND, Bound("course_error_max", 1e-7, "a body that turns at a gap of 2e-8 m is twice that off, and gravity adds"),
            Bound("drift_max", 1e-6, "bodies at rest stay where they are"), Bound("energy_gain_max", 1e-9, "energy stays"),
        ),
        regions=(before(lost, "shot", reason="the ball does not go through the wall"),),
        expects={
            "courses": tuple(Course(body, partial(at, place)) for body, at in courses.items()),
            "rests": (Rest(STACK, 0.0),), "alone": alone,
        },
    )


SCENARIOS = (
    *(scenario(name, f"A little world, looked at every {dt:g} s.", Place(), dt) for name, dt in (
        ("dt_torture", 0.2), ("dt_torture_30ms", 0.03), ("dt_torture_1ms", 1e-3), ("dt_torture_1us", 1e-6),
    )),
    scenario("far_from_origin", "A little world a hundred kilometres from the origin.", Place(origin=(6e4, -8e4, 1e3))),
    scenario("scale_mm", "A little world a thousandth as large.", Place(scale=1e-3)),
    scenario("scale_km", "A little world a thousand times as large.", Place(scale=1e3)),
)
