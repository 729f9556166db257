"""One little world with a closed form for everything in it, at any size, anywhere, at any frame time.

A ball is dropped and bounces until it rests, a box slides until it stops, three boxes stand on one another, and a ball is shot at
a wall from a centimetre. Written in other units nothing changes but the numbers: lengths, speeds and gravity grow with `scale`,
times and masses stay, so that every verdict must stay as well.
"""

from dataclasses import dataclass

from avatarsim.scene.body import Body, ContactLaw, fixed, simulated, solid
from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from reference.closed_form import bounce_state, stop_distance, stop_time
from scenarios.building.cases import LAID, pair_table
from scenarios.building.expected import Course, Rest
from scenarios.scenario import INFINITE, Region

GRAVITY, MASS = 9.81, 1.0
"""Gravity [m/s^2] at scale 1, mass [kg] of every body at every scale."""
RADIUS, HEIGHT, RESTITUTION = 0.1, 0.5, 0.5
"""Radius of the ball that is dropped, height of its lowest point [m], restitution: it rests after 0.96 s."""
SLIDES, SPEED, FRICTION = (0.4, 0.4, 0.1), 2.0, 0.5
"""Edges of the box that slides [m], its first speed [m/s], friction: it stops after 0.41 s and 0.41 m."""
EDGE = 0.2
"""Edge of the boxes that stand on one another [m]."""
SHOT, FAST, NEAR = 0.05, 300.0, 0.01
"""Radius [m] and speed [m/s] of the ball that is shot, its way to the wall [m]: contact after 33 microseconds."""
FACE, HIGH = 3.0, 2.0
"""Where the wall begins along x, and at which height the ball is shot [m]."""
THICK = 20.0
"""Thickness of floor and wall [m]: at a thousandth of the size still more than an engine that stops 2 mm inside needs."""
TALL = 2.0
"""Height and width of the wall [m]."""
FALLEN = 0.01
"""From then on [s] the energy of the ball that falls is looked at."""
STACK = ("lower", "middle", "upper")


@dataclass(frozen=True)
class Place:
    """How large the world is, and where its origin lies [m]."""

    scale: float = 1.0
    origin: Vector = (0.0, 0.0, 0.0)

    def at(self, x: float, y: float, z: float, laid: float = 0.0) -> Vector:
        """A place of the world, `laid` [m] above it whatever the scale."""
        ox, oy, oz = self.origin
        return ox + self.scale * x, oy + self.scale * y, oz + self.scale * z + laid

    def edges(self, x: float, y: float, z: float) -> Vector:
        """Lengths of the world."""
        return self.scale * x, self.scale * y, self.scale * z


def bodies(place: Place) -> tuple[Body, ...]:
    """Floor, its top at z = 0, wall, and the six bodies that move or rest."""
    s = place.scale
    floor, wall = (Piece(Box(place.edges(6.0, 4.0, THICK))),), (Piece(Box(place.edges(THICK, TALL, TALL))),)
    ball, slider = (Piece(Sphere(s * RADIUS)),), (Piece(Box(place.edges(*SLIDES))),)
    cube, shot = (Piece(Box(place.edges(EDGE, EDGE, EDGE))),), (Piece(Sphere(s * SHOT)),)
    found = [
        fixed("floor", floor, "floor", place.at(0.0, 0.0, -0.5 * THICK)),
        fixed("wall", wall, "wall", place.at(FACE + 0.5 * THICK, 0.0, HIGH)),
        simulated("dropped", ball, "ball", solid(ball, MASS), place.at(-1.0, 1.0, HEIGHT + RADIUS)),
        simulated("slides", slider, "box", solid(slider, MASS), place.at(-1.0, 0.0, 0.5 * SLIDES[2], LAID),
                  velocity=(s * SPEED, 0.0, 0.0)),
        simulated("shot", shot, "shot", solid(shot, MASS), place.at(FACE - SHOT - NEAR, 0.0, HIGH),
                  velocity=(s * FAST, 0.0, 0.0)),
    ]
    found += [
        simulated(name, cube, "box", solid(cube, MASS), place.at(0.0, -1.0, (k + 0.5) * EDGE, (k + 1) * LAID))
        for k, name in enumerate(STACK)
    ]
    return tuple(found)


def small_world(name: str, place: Place) -> Scene:
    """The scene."""
    stated = {
        ("ball", "floor"): ContactLaw(RESTITUTION, 0.0), ("box", "floor"): ContactLaw(0.0, FRICTION),
        ("box", "box"): ContactLaw(0.0, FRICTION), ("shot", "wall"): ContactLaw(1.0, 0.0),
    }
    materials = pair_table(("floor", "wall", "ball", "box", "shot"), stated)
    return Scene(name, bodies(place), materials=materials, gravity=(0.0, 0.0, -place.scale * GRAVITY))


def regions(place: Place) -> tuple[Region, ...]:
    """Where the ball that is shot may be: where the face that it meets is its nearest way out of the wall. Deeper it is nearer to
    another side, and nothing brings it back."""
    lost = place.at(FACE + 0.5 * TALL, 0.0, 0.0)[0]
    return (Region(("shot",), (-INFINITE, -INFINITE, -INFINITE), (lost, INFINITE, INFINITE), "the ball does not go through "
                                                                                             "the wall"),)


def dropped(place: Place, time: float) -> Vector:
    """Where the ball is that bounces."""
    return place.at(-1.0, 1.0, RADIUS + bounce_state(HEIGHT, RESTITUTION, GRAVITY, time)[0])


def slides(place: Place, time: float) -> Vector:
    """Where the box is that slides."""
    ends = stop_time(SPEED, FRICTION, GRAVITY)
    left = max(0.0, ends - time) / ends
    return place.at(-1.0 + stop_distance(SPEED, FRICTION, GRAVITY) * (1.0 - left * left), 0.0, 0.5 * SLIDES[2], LAID)


def shot(place: Place, time: float) -> Vector:
    """Where the ball is that comes back from the wall, falling all the while; nothing is in its way."""
    way, due = FAST * time, NEAR / FAST
    x = FACE - SHOT - NEAR + (way if time <= due else 2.0 * NEAR - way)
    return place.at(x, 0.0, HIGH - 0.5 * GRAVITY * time * time)


def expects(place: Place, seconds: float) -> dict[str, object]:
    """Courses of those that move, rest of those that stand, and energy, for a run of so many seconds."""
    courses = (
        Course("dropped", lambda time: dropped(place, time)), Course("slides", lambda time: slides(place, time)),
        Course("shot", lambda time: shot(place, time)),
    )
    # a body that has hardly begun to fall has too little kinetic energy to compare the rounding of its height with
    alone = (("slides",), ("shot",), *((("dropped",),) if seconds > FALLEN else ()))
    return {"courses": courses, "rests": (Rest(STACK, 0.0),), "alone": alone}
