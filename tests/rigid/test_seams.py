"""Internal edges of floors that are cut in pieces: they move no body, and every real step is met."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from avatarsim.collision.signed_distance import signed_distance
from avatarsim.rigid.contact_generation import find_contacts
from avatarsim.rigid.internal_edges import FLUSH, level_seams
from avatarsim.scene.body import Body, fixed, simulated, solid
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Piece, Shape, Sphere
from reference.closed_form import roll_speed, stop_distance
from tests.rigid.upper_world import G, World, thing

SPEED, FRICTION = 2.0, 0.5
SIZE = (0.3, 0.3, 0.1)
STAND_OFF = 2e-8
TIMES = (1.0 / 30.0, 1.0 / 60.0, 1.0 / 240.0, 1.0 / 1000.0)
EVEN = np.linspace(-3.0, 3.0, 97)
CUTS = {"halves": np.array([-3.0, 0.0, 3.0]), "64 a metre": EVEN, "slivers": np.sort([*EVEN[::4], *(EVEN[:-1:4] + 1e-4)])}


def pieces(cuts: Sequence[float] | np.ndarray, heights: Sequence[float] | None = None) -> list[Piece]:
    """Return boxes side by side along x, tops at z = 0 or at heights."""
    tops = np.zeros(len(cuts) - 1) if heights is None else np.array(heights)
    return [
        Piece(Box((float(b - a), 2.0, 0.2)), (float(0.5 * (a + b)), 0.0, float(top - 0.1)))
        for a, b, top in zip(cuts[:-1], cuts[1:], tops, strict=True)
    ]


def floor(cuts: Sequence[float] | np.ndarray, heights: Sequence[float] | None = None) -> Body:
    """Return one fixed body of those pieces."""
    return fixed("floor", tuple(pieces(cuts, heights)), "m")


def slider(x: float = -1.0, gap: float = STAND_OFF, **more: Any) -> Body:
    """Return a box on the floor that slides along x."""
    more.setdefault("velocity", (SPEED, 0.0, 0.0))
    return thing("box", Box(SIZE), (x, 0.0, 0.5 * SIZE[2] + gap), **more)


def slid(bodies: Sequence[Body], dt: float, seconds: float = 0.6) -> World:
    """Return the world after so long; nothing overlaps by more than resting bodies may dip meanwhile."""
    world = World(bodies, restitution=0.0, friction=FRICTION)
    while world.time < seconds - 1e-12:
        world.frame(dt)
        assert world.gap() >= FLUSH
    return world


@pytest.mark.parametrize("dt", TIMES)
@pytest.mark.parametrize("cuts", CUTS)
@pytest.mark.parametrize("gap", [STAND_OFF, 0.4 * STAND_OFF, 0.0, -1e-7])
def test_a_box_slides_over_seams_as_far_as_over_a_whole_floor(dt: float, cuts: str, gap: float) -> None:
    """At the stand-off, below it, and from the dip of a resting body. The energy to leave a dip is taken from the motion."""
    world = slid([floor(CUTS[cuts]), slider(gap=gap)], dt)
    x, y, _ = world.poses.position[1]
    assert x == pytest.approx(-1.0 + stop_distance(SPEED, FRICTION, G), abs=1e-6)
    assert abs(y) < 1e-6
    assert not world.velocities.linear[1].any()
    assert not world.impacts


def test_pieces_may_be_bodies_of_their_own() -> None:
    """Twelve fixed bodies, and the box turned by half a radian across the seams."""
    cuts = np.linspace(-3.0, 3.0, 13)
    bodies = [fixed(f"f{k}", (piece,), "m") for k, piece in enumerate(pieces(cuts))]
    world = slid([*bodies, slider(orientation=(np.cos(0.25), 0.0, 0.0, np.sin(0.25)))], 1.0 / 60.0)
    assert world.poses.position[-1, 0] == pytest.approx(-1.0 + stop_distance(SPEED, FRICTION, G), abs=1e-6)


@pytest.mark.parametrize("dt", TIMES)
def test_hulls_with_seams_at_an_angle(dt: float) -> None:
    """Prisms whose seams all lie another way."""
    xs, random = np.linspace(-3.0, 3.0, 31), np.random.default_rng(0)
    lean, found = 0.05 * random.uniform(-1.0, 1.0, len(xs)), []
    for k in range(len(xs) - 1):
        top = np.array([(xs[i] + s * lean[i], s, 0.0) for i in (k, k + 1) for s in (-1.0, 1.0)])
        found.append(Piece(ConvexHull(np.vstack([top, top - (0.0, 0.0, 0.2)]))))
    world = slid([fixed("floor", tuple(found), "m"), slider()], dt)
    assert world.poses.position[1, 0] == pytest.approx(-1.0 + stop_distance(SPEED, FRICTION, G), abs=1e-6)


def test_a_body_of_pieces_slides_over_a_floor_of_pieces() -> None:
    """Seams above and below, the way at an angle to all of them."""
    parts = tuple(Piece(Box((0.1, 0.3, 0.1)), (x, 0.0, 0.0)) for x in (-0.1, 0.0, 0.1))
    velocity = (SPEED, 0.3, 0.0)
    body = simulated("b", parts, "m", solid(parts, 1.0), position=(-1.0, 0.0, 0.05 + STAND_OFF), velocity=velocity)
    world = slid([floor(CUTS["64 a metre"]), body], 1.0 / 60.0)
    speed = float(np.hypot(*velocity[:2]))
    way = stop_distance(speed, FRICTION, G) / speed
    assert np.allclose(world.poses.position[1, :2], (-1.0 + way * velocity[0], way * velocity[1]), atol=1e-6)


@pytest.mark.parametrize("dt", TIMES)
@pytest.mark.parametrize("cuts", CUTS)
@pytest.mark.parametrize("shape", [Sphere(0.1), Capsule(0.1, 0.4)])
def test_what_rolls_or_slides_on_a_round_side_feels_no_seam(dt: float, cuts: str, shape: Shape) -> None:
    """A ball slides until it rolls at 5/7 of its speed, all over seams; a capsule slides along its axis until it stops."""
    along_x = (np.cos(0.25 * np.pi), 0.0, np.sin(0.25 * np.pi), 0.0)
    body = thing("b", shape, (-1.0, 0.0, 0.1 + 0.5 * STAND_OFF), orientation=along_x, velocity=(SPEED, 0.0, 0.0))
    world = slid([floor(CUTS[cuts]), body], dt)
    if isinstance(shape, Sphere):
        assert world.velocities.linear[1, 0] == pytest.approx(roll_speed(SPEED), abs=1e-6)
    else:
        assert world.poses.position[1, 0] == pytest.approx(-1.0 + stop_distance(SPEED, FRICTION, G), abs=1e-6)
    assert not world.impacts


@pytest.mark.parametrize("dt", TIMES)
@pytest.mark.parametrize("height", [1e-6, 1e-5, 1e-4])
@pytest.mark.parametrize("apart", [False, True])
def test_a_step_up_stops_the_box(dt: float, height: float, apart: bool) -> None:
    """Its side meets the side of the next piece, at x = 0, be that piece of the same body or another one."""
    step = pieces((-3.0, 0.0, 3.0), (0.0, height))
    bodies = [fixed(f"f{k}", (p,), "m") for k, p in enumerate(step)] if apart else [fixed("floor", tuple(step), "m")]
    world = slid([*bodies, slider(x=-0.4)], dt)
    # in long frames its events are too many, and it stops a stand-off of substeps before
    assert world.poses.position[-1, 0] == pytest.approx(-0.5 * SIZE[0], abs=1e-6 if dt < 1.0 / 30.0 else 1e-4)
    assert world.impacts


@pytest.mark.parametrize("dt", TIMES)
@pytest.mark.parametrize("height", [-1e-6, -1e-5, -1e-4])
def test_a_step_down_holds_nobody_back(dt: float, height: float) -> None:
    """The box goes on over the edge, and lies with one end on it."""
    world = slid([floor((-3.0, 0.0, 3.0), (0.0, height)), slider(x=-0.4)], dt)
    assert world.poses.position[1, 0] == pytest.approx(-0.4 + stop_distance(SPEED, FRICTION, G), abs=1e-4)


def test_a_ridge_across_the_way_is_no_seam() -> None:
    """A wedge that rises 0.1 mm out of the floor has a slanting side, and is met."""
    wedge = ConvexHull(np.array([(x, y, z) for y in (-1.0, 1.0) for x, z in ((-0.05, -0.1), (0.05, -0.1), (0.0, 1e-4))]))
    world = slid([floor((-3.0, 3.0)), fixed("ridge", (Piece(wedge),), "m"), slider(x=-0.4)], 1.0 / 60.0)
    assert world.impacts


def found(world: World) -> None:
    """Contacts of all pairs, as at the start of a segment."""
    n = len(world.bodies)
    world.memory.moving[:] = world.dynamics.role == 1
    pairs = np.array([(a, b) for a in range(n) for b in range(a + 1, n)], np.int64)
    find_contacts(world.geometry, world.dynamics, world.poses, world.velocities, pairs, world.memory)


@pytest.mark.nojit
@pytest.mark.boundscheck
def test_a_leaning_contact_gets_the_normal_of_the_next_face() -> None:
    """10 nm before the seam the nearest point of the next piece is ahead and below; so many points, all straight up."""
    world = World([floor((-3.0, 0.0, 3.0)), slider(x=-0.5 * SIZE[0] - 1e-8, gap=1e-8)])
    shapes, memory = world.geometry.shapes, world.memory
    _, gap, n, _, _ = signed_distance(world.poses.vertices, shapes, 1, 2, (0.0, 0.0, 0.0), memory.scratch)
    assert gap == pytest.approx(np.sqrt(2.0) * 1e-8, rel=1e-3)
    assert abs(n[0]) == pytest.approx(np.sqrt(0.5), rel=1e-3)
    found(world)
    used = int(memory.contacts.used[0])
    assert used >= 5
    assert np.abs(np.abs(memory.contacts.frame[:used, 0, 2]) - 1.0).max() < 1e-12
    assert np.allclose(memory.contacts.gap[:used], 1e-8, atol=1e-12)


@pytest.mark.nojit
@pytest.mark.boundscheck
def test_a_floor_and_a_wall_keep_their_normals() -> None:
    """The corner of a room is no seam."""
    wall = fixed("wall", (Piece(Box((1.0, 2.0, 2.0)), (0.5, 0.0, 1.0)),), "m")
    world = World([floor((-3.0, 3.0)), wall, slider(x=-0.5 * SIZE[0] - STAND_OFF)])
    found(world)
    contacts = world.memory.contacts
    before = contacts.frame[: contacts.used[0]].copy()
    assert {tuple(np.abs(np.round(n)).astype(int)) for n in before[:, 0]} == {(0, 0, 1), (1, 0, 0)}
    level_seams(world.geometry, world.poses, world.velocities, world.memory)
    assert np.array_equal(before, contacts.frame[: contacts.used[0]])
