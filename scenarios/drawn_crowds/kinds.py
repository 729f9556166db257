"""Kinds of drawn crowds: bodies poured, struck by something heavy, swept by a hand, gripped by two pads, kicked by a person."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from avatarsim.scene.avatar import Avatar
from avatarsim.scene.body import Body
from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Piece, Sphere, reach
from avatarsim.spatial import rotation
from scenarios.building.avatars.humanoid import humanoid
from scenarios.building.avatars.standing import standing
from scenarios.building.cases import LAID, driven, loose, slab, turned_by
from scenarios.building.reach import extent
from scenarios.building.things import drawn_box, drawn_turn, open_box
from scenarios.drawn_crowds.bodies import DENSITIES, FLOOR, HAND, THINGS, drawn_piece, drawn_table, lattice, of_density, spacing
from scenarios.motion.mocap import load_clip
from scenarios.motion.rigid_hands import Places, eased, hands_at, led
from scenarios.motion.track import to_and_fro
from scenarios.motion.untracked import untracked
from scenarios.scenario import RENDERED, Motion

MIN_BODIES, MAX_BODIES, FRAMES, SHORT = 5, 100, 120, 60
"""Bodies in a crowd; frames of two seconds, and of one."""
LASTS = FRAMES * RENDERED
SPAN, WALLS, THICK = 60.0, 0.2, 0.04
"""Width of the floor, to whose end nothing comes, height and thickness of a tray's walls [m]."""
DRIFT, SPIN = 0.3, 3.0
"""Largest first velocity [m/s], never upwards, and spin [rad/s] along each axis of poured bodies."""
STEEL, THROWN, SPEEDS, FLIES = 7800.0, (0.08, 0.16), (2.0, 6.0), (0.1, 0.3)
"""Density [kg/m^3], sizes [m] and speeds [m/s] of thrown bodies, and their way to the crowd [m]."""
HAND_MASS, LEGS, ABOVE = 0.5, (2, 4), 0.005
"""Mass of a hand or a pad [kg]; fewest and most straight parts of a sweep; height of a hand or pad above the floor [m]."""
PAD: Vector = (0.02, 0.05, 0.05)
"""Edges of a pad [m]."""
BESIDE, INTO, RISES = (0.01, 0.03), (0.005, 0.03), (0.1, 0.3)
"""Distance of the pads from the gripped body at the start, depth of their user in it, and height to which they rise [m]."""
CLIPS, ROOM = ("kick", "spinkick", "punch", "dance_a", "crawl", "roll", "getup_facedown"), 0.35
"""Clips of a person, and radius without bodies around its first position [m]."""
CLOSED, UP = (0.1, 0.4), (0.5, 1.3)
"""When pads close and rise [s]."""


@dataclass(frozen=True, eq=False)
class Crowd:
    """A scene drawn, its motion, and the names of the bodies that begin in the air."""

    scene: Scene
    motion: Callable[[Scene, int], Motion]
    falling: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Drawn:
    """Bodies before they have places, with the other parts of the scene."""

    name: str
    random: np.random.Generator
    pieces: list[Piece] = field(init=False)

    def __post_init__(self) -> None:
        count = int(self.random.integers(MIN_BODIES, MAX_BODIES + 1))
        object.__setattr__(self, "pieces", [drawn_piece(self.random) for _ in range(count)])

    @property
    def radii(self) -> list[float]:
        """Radii of balls about the origins that hold the bodies [m]."""
        return [reach(piece) for piece in self.pieces]

    def bodies(self, places: list[Vector], drift: float = 0.0, spin: float = 0.0) -> list[Body]:
        """Return the floor, and the bodies at their places, turned, made of and moving as it is drawn."""
        random = self.random
        bodies = [slab(SPAN, SPAN, FLOOR)]
        for k, (piece, place) in enumerate(zip(self.pieces, places, strict=True)):
            mass = of_density(piece, float(random.uniform(*DENSITIES)))
            material = THINGS[random.integers(len(THINGS))]
            (x, y, z), turning = drawn_vector(random, drift), drawn_vector(random, spin)
            velocity = (x, y, -abs(z))
            bodies.append(loose(f"thing_{k}", piece, material, mass, place, drawn_turn(random), velocity, turning))
        return bodies

    def crowd(self, bodies: list[Body], hands: tuple[Avatar, ...] = (), places: Places | None = None, first: int = 0) -> Crowd:
        """Return the scene with hands that are led to `places`; the bodies from the thing number `first` on fall."""
        start = hands_at(places(0.0)) if places else None
        scene = Scene(self.name, tuple(bodies), hands, drawn_table(self.random), start=start)
        return Crowd(scene, led(places) if places else untracked(), tuple(f"thing_{k}" for k in range(first, len(self.pieces))))


def drawn_vector(random: np.random.Generator, largest: float) -> Vector:
    """Return a vector, each of its parts up to `largest`."""
    x, y, z = random.uniform(-largest, largest, size=3).tolist()
    return x, y, z


def towards(azimuth: float) -> np.ndarray:
    """Return the horizontal unit vector at an angle [rad]."""
    return np.array([math.cos(azimuth), math.sin(azimuth), 0.0])


def poured(draw: Drawn) -> Crowd:
    """Pour the bodies onto the floor or, as often, into a tray, over whose walls they may fall."""
    random = draw.random
    a_layer = int(random.integers(4, 17))
    places = lattice(random, draw.radii, a_layer)
    bodies = draw.bodies(places, DRIFT, SPIN)
    if random.random() < 0.5:
        half = float(np.abs(np.array(places)[:, :2]).max()) + 0.5 * spacing(draw.radii)
        bodies += open_box(2.0 * half, WALLS, THICK, FLOOR)[1:]
    return draw.crowd(bodies)


def struck(draw: Drawn) -> Crowd:
    """Throw a heavy ball or box at the bodies, which stand close together as they fall."""
    random = draw.random
    places = lattice(random, draw.radii, math.ceil(len(draw.pieces) ** (2.0 / 3.0)))
    bodies = draw.bodies(places)
    size = float(random.uniform(*THROWN))
    heavy = Piece(Sphere(0.5 * size)) if random.random() < 0.5 else drawn_box(random, *THROWN)
    held = float(np.linalg.norm(np.array(places)[:, :2], axis=1).max()) + max(draw.radii)
    distance = held + reach(heavy) + float(random.uniform(*FLIES))
    way, speed = towards(random.uniform(0.0, 2.0 * math.pi)), float(random.uniform(*SPEEDS))
    x, y, z = (-distance * way + [0.0, 0.0, reach(heavy) + random.uniform(*FLIES)]).tolist()
    # as fast upwards as it falls on the way to the middle
    vx, vy, vz = (speed * way + [0.0, 0.0, 0.5 * 9.81 * distance / speed]).tolist()
    bodies.append(loose("thrown", heavy, THINGS[0], of_density(heavy, STEEL), (x, y, z), drawn_turn(random), (vx, vy, vz)))
    return draw.crowd(bodies)


def drawn_hand(random: np.random.Generator) -> tuple[Piece, float]:
    """Return a plate, an upright rod or a ball, and how high its middle is above its lowest point [m]."""
    kind, size, turn = int(random.integers(3)), float(random.uniform(0.04, 0.1)), float(random.uniform(0.0, math.pi))
    if kind == 0:
        plate = Box((0.03, float(random.uniform(0.15, 0.4)), 2.0 * size))
        return Piece(plate, orientation=turned_by((0.0, 0.0, 1.0), turn)), size
    if kind == 1:
        return Piece(Capsule(0.5 * size, 0.15)), 0.5 * size + 0.075
    return Piece(Sphere(size)), size


def swept(draw: Drawn) -> Crowd:
    """Lead a rigid hand through the bodies and out on the other side, along straight lines between places drawn among them."""
    random = draw.random
    places = lattice(random, draw.radii, math.ceil(len(draw.pieces) / int(random.integers(1, 4))))
    bodies = draw.bodies(places)
    piece, high = drawn_hand(random)
    held = float(np.linalg.norm(np.array(places)[:, :2], axis=1).max()) + max(draw.radii)
    legs = int(random.integers(LEGS[0], LEGS[1] + 1))
    points = [(held + reach(piece) + 0.02) * towards(random.uniform(0.0, 2.0 * math.pi))]
    points += [held * float(random.random()) * towards(random.uniform(0.0, 2.0 * math.pi)) for _ in range(legs - 1)]
    points.append(-points[0])
    corners = np.array(points) + [0.0, 0.0, high + ABOVE]

    def at(time: float) -> tuple[Vector]:
        k = min(int(time * legs / LASTS), legs - 1)
        share = eased(time, k * LASTS / legs, (k + 1) * LASTS / legs)
        x, y, z = (corners[k] + share * (corners[k + 1] - corners[k])).tolist()
        return ((x, y, z),)

    return draw.crowd(bodies, (driven("hand", piece, HAND_MASS, HAND),), at)


def gripped(draw: Drawn) -> Crowd:
    """Close two pads on one of the bodies, which lies in a hole amid the others, and rise."""
    random = draw.random
    piece = draw.pieces[0]
    # a capsule lies across, all others as they are
    turn = turned_by((1.0, 0.0, 0.0), 0.5 * math.pi) if isinstance(piece.shape, Capsule) else rotation.IDENTITY
    left, right, low = (extent(piece.shape, rotation.rotate(rotation.conjugate(np.array(turn)), np.array(d))) for d in (
        (-1.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, -1.0),
    ))
    opened, into, rise = (float(random.uniform(*between)) for between in (BESIDE, INTO, RISES))
    reached = max(left, right) + opened + PAD[0]
    hole = max(math.hypot(reached, 0.5 * PAD[1]), reach(piece))
    layers = int(random.integers(1, 5))
    others = lattice(random, draw.radii[1:], math.ceil((len(draw.pieces) - 1) / layers), hole)
    bodies = draw.bodies([(0.0, 0.0, low + LAID), *others])
    bodies[1] = replace(bodies[1], orientation=turn)

    def at(time: float) -> tuple[Vector, Vector]:
        gone = opened - (opened + into) * eased(time, *CLOSED)
        z = 0.5 * PAD[2] + ABOVE + rise * eased(time, *UP)
        return (right + 0.5 * PAD[0] + gone, 0.0, z), (-left - 0.5 * PAD[0] - gone, 0.0, z)

    pads = tuple(driven(name, Box(PAD), HAND_MASS, HAND) for name in ("right", "left"))
    return draw.crowd(bodies, pads, at, first=1)


def kicked(draw: Drawn) -> Crowd:
    """Let a person amid the bodies play a recorded clip."""
    random = draw.random
    places = lattice(random, draw.radii, math.ceil(len(draw.pieces) / int(random.integers(1, 4))), ROOM)
    human, clip = humanoid(), load_clip(CLIPS[random.integers(len(CLIPS))])
    person = replace(human, links=tuple(replace(link, material=HAND) for link in human.links))
    start = standing(person, heading=float(random.uniform(0.0, 2.0 * math.pi)))
    scene = Scene(draw.name, tuple(draw.bodies(places)), (person,), drawn_table(random), start=start)
    falling = tuple(f"thing_{k}" for k in range(len(draw.pieces)))
    return Crowd(scene, lambda scene, seed: to_and_fro(clip, scene, FRAMES), falling)
