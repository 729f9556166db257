"""Contacts of the shown state against plain twins, and their forces, which balance weights and springs."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

from avatarsim.engine import Settings
from avatarsim.errors import EngineInUse, InvalidInput, UnknownName
from avatarsim.pose_queries import Contact
from avatarsim.scene.avatar import Drive, rigid_avatar
from avatarsim.scene.body import fixed, simulated, solid
from avatarsim.scene.moving import moving
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample, rest
from scenarios import catalog
from tests.coupling.scenes import FLOOR, LAW, cube, fist
from tests.rigid.upper_world import G
from tests.worlds.little_worlds import at, hand_scene, panel
from tests.worlds.loaded import DT, loaded

FREE = Scene("hand", (panel(),), hand_scene((-0.5, 0.0, 0.0)).avatars, start=hand_scene((-0.5, 0.0, 0.0)).start)


def of_balls(centres: np.ndarray, radii: np.ndarray, within: float) -> dict[tuple[str, str], tuple]:
    """Return contacts of balls with each other and with a floor up to z = 0, by the distances of centres: gap, normal, point."""
    found = {}
    for k, (c, r) in enumerate(zip(centres, radii, strict=True)):
        if c[2] - r <= within:
            found["floor", f"b{k}"] = c[2] - r, np.array([0.0, 0.0, -1.0]), np.array([c[0], c[1], 0.5 * (c[2] - r)])
    for i, k in combinations(range(len(centres)), 2):
        apart = centres[i] - centres[k]
        far = float(np.sqrt(apart @ apart))
        if far - radii[i] - radii[k] <= within:
            n = apart / far
            half = 0.5 * ((centres[i] - radii[i] * n) + (centres[k] + radii[k] * n))
            found[f"b{i}", f"b{k}"] = far - radii[i] - radii[k], n, half
    return found


def told(contacts: tuple[Contact, ...]) -> dict[tuple[str, str], tuple]:
    """Return contacts by pair, of which there is one each."""
    found = {(one.a, one.b): (one.gap, one.normal, one.point) for one in contacts}
    assert len(found) == len(contacts)
    return found


@pytest.mark.parametrize("within", [0.0, 0.003, 0.05])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_balls_touch_where_their_centres_say(seed: int, within: float) -> None:
    rng = np.random.default_rng(seed)
    radii = rng.uniform(0.09, 0.115, 27)
    centres = np.array(np.meshgrid(*3 * [np.arange(3) * 0.25])).reshape(3, -1).T + [0.0, 0.0, 0.125]
    centres = centres + rng.uniform(-0.004, 0.004, centres.shape)
    shapes = [(Piece(Sphere(r)),) for r in radii]
    balls = tuple(simulated(f"b{k}", shape, "wood", solid(shape, 1.0), tuple(centres[k])) for k, shape in enumerate(shapes))
    engine = loaded(Scene("balls", (fixed("floor", (Piece(Box((4.0, 4.0, 0.2))),), "wood", (0.0, 0.0, -0.1)), *balls)))
    found, wanted = told(engine.contacts(within)), of_balls(centres, radii, within)
    assert found.keys() == wanted.keys() and (within < 0.05 or len(found) > 20)
    for pair, (gap, normal, point) in wanted.items():
        assert found[pair][0] == pytest.approx(gap, abs=1e-12)
        assert found[pair][1] == pytest.approx(normal, abs=1e-9) and found[pair][2] == pytest.approx(point, abs=1e-9)


def test_a_box_stands_on_its_four_corners() -> None:
    box = (Piece(Box((0.2, 0.3, 0.1))),)
    floor = fixed("floor", (Piece(Box((4.0, 4.0, 0.2))),), "wood", (0.0, 0.0, -0.1))
    engine = loaded(Scene("box", (floor, simulated("box", box, "wood", solid(box, 1.0), (0.5, 0.0, 0.051)))))
    assert engine.contacts() == ()
    found = engine.contacts(0.002)
    assert {(round(c.point[0], 9), round(c.point[1], 9)) for c in found} == {(0.4, 0.15), (0.4, -0.15), (0.6, 0.15), (0.6, -0.15)}
    for one in found:
        assert (one.a, one.b) == ("floor", "box") and one.gap == pytest.approx(0.001, abs=1e-12)
        assert one.normal == pytest.approx((0.0, 0.0, -1.0), abs=1e-12) and one.point[2] == pytest.approx(0.0005, abs=1e-12)
    for _ in range(60):
        engine.advance(NO_ONE, DT)
    assert len(engine.contacts()) == 4 and all(abs(one.gap) < 1e-4 for one in engine.contacts())


NO_ONE = TrackerSample(0.0, np.zeros((0, 3)), np.zeros((0, 4)), np.zeros(0))


@pytest.mark.parametrize("preset", ["default", "paper"])
def test_a_hand_that_leans_on_a_wall_touches_it_at_its_stand_off(preset: str) -> None:
    engine = loaded(FREE, preset)
    assert engine.contacts() == ()
    for k in range(1, 30):
        engine.advance(at(FREE.first_sample, (-0.5 + 0.02 * k, 0.0, 0.0)), DT)
    (one,) = engine.contacts()
    assert (one.a, one.b) == ("panel", "hand") and one.normal == pytest.approx((1.0, 0.0, 0.0), abs=1e-9)
    assert 0.0 <= one.gap <= 2.0 * (2e-4 if preset == "default" else 1e-4)
    assert one.point == pytest.approx((-0.001, 0.0, 0.0), abs=1e-3)
    assert not one.point.flags.writeable and not one.normal.flags.writeable


def test_asking_changes_nothing_and_pairs_left_out_are_left_out() -> None:
    ball = (Piece(Sphere(0.1)),)
    hand = rigid_avatar("hand", ball, solid(ball, 1.0))
    near = tuple(fixed(name, ball, "wood", (0.0, 0.2, z)) for name, z in (("one", 0.0), ("two", 0.05)))
    engine = loaded(Scene("s", near, (hand,), exclude=(("two", "hand"),)))
    before = engine.snapshot()
    assert [(one.a, one.b) for one in engine.contacts(0.5)] == [("one", "hand")]
    assert len(engine.contacts(0.5, of=("hand",))) == 1 and engine.contacts(0.5, of=("two",)) == ()
    assert engine.snapshot() == before


@pytest.mark.parametrize("within", [-1e-9, 1.5, float("nan"), "near"])
def test_a_gap_that_is_none_is_refused(within: float) -> None:
    with pytest.raises(InvalidInput, match="largest gap of contacts"):
        loaded(FREE).contacts(within)


def test_contacts_are_of_one_call_at_a_time() -> None:
    engine = loaded(FREE)
    with engine._alone(), pytest.raises(EngineInUse):
        engine.contacts()


K, SAME = 1000.0, 1e-6
"""Stiffness of hands [N/m], and how exact forces at rest are, relative."""


def on(name: str, contacts: tuple[Contact, ...], *others: str) -> np.ndarray:
    """Return the force on a body [N], of all or of some others."""
    total = np.zeros(3)
    for one in contacts:
        for body, other, force in ((one.a, one.b, one.force), (one.b, one.a, -one.force)):
            if body == name and (not others or other in others):
                total += force
    return total


def hands(*places: tuple[float, float, float]) -> TrackerSample:
    """Return samples of rigid hands."""
    return TrackerSample(0.0, np.array(places), np.tile((1.0, 0.0, 0.0, 0.0), (len(places), 1)), np.zeros(0))


def test_each_cube_of_a_stack_bears_the_weight_of_those_above() -> None:
    masses = [1.0, 3.0, 0.2, 5.0, 2.0, 0.7]
    cubes = [cube(mass, (0.001 * k, 0.0, 0.05 + 0.10001 * k), f"cube {k}") for k, mass in enumerate(masses)]
    engine = loaded(Scene("stack", (FLOOR, *cubes), materials=LAW))
    for _ in range(60):
        engine.advance(rest(()), DT)
    before = engine.snapshot()
    found = engine.contacts(forces=True)
    assert engine.snapshot() == before
    for k in range(len(masses)):
        below = "floor" if k == 0 else f"cube {k - 1}"
        assert on(f"cube {k}", found, below) == pytest.approx([0.0, 0.0, G * sum(masses[k:])], abs=SAME * G)
    assert np.isnan(engine.contacts()[0].normal_force)


def test_a_weight_on_a_hand_is_what_its_user_feels() -> None:
    palm = (Piece(Box((0.2, 0.2, 0.02))),)
    hand = rigid_avatar("palm", palm, solid(palm, 0.5), "m")
    engine = loaded(Scene("weight", (cube(0.3, (0.0, 0.0, 0.0605)),), (hand,), materials=LAW))
    for _ in range(120):
        engine.advance(rest((hand,)), DT)
    assert on("cube", engine.contacts(forces=True)) == pytest.approx([0.0, 0.0, 0.3 * G], abs=SAME)
    assert engine.felt("palm") == pytest.approx(np.array([[0.0, 0.0, -0.3 * G]]), abs=SAME)


def test_a_hand_presses_by_its_lag_up_to_its_largest_force() -> None:
    wall = fixed("wall", (Piece(Box((0.1, 2.0, 2.0))),), "m", (0.2, 0.0, 0.0))
    for drive, pressed in ((None, 1.0), (Drive(largest_force=20.0), 0.0)):
        hand = replace(fist(), drive=drive)
        # far below something falls, so that the scene has dynamics
        engine = loaded(Scene("wall", (wall, cube(1.0, (0.0, 0.0, -9.0))), (hand,), materials=LAW))
        for k in range(60):
            record = engine.advance(hands((min(0.2, 0.01 * k), 0.0, 0.0)), DT)
        force = K * (0.2 - record.shown.positions[2, 0]) if pressed else 20.0
        assert on("wall", engine.contacts(forces=True)) == pytest.approx([force, 0.0, 0.0], rel=SAME, abs=SAME)
        assert engine.felt("fist") == pytest.approx(np.array([[-force, 0.0, 0.0]]), rel=SAME, abs=SAME)


def test_two_pads_squeeze_by_their_lag_and_bear_the_weight() -> None:
    pad = (Piece(Box((0.02, 0.05, 0.05))),)
    pads = tuple(rigid_avatar(name, pad, solid(pad, 0.5), "m") for name in ("left", "right"))
    scene = Scene("pinch", (FLOOR, cube(0.3, (0.0, 0.0, 0.0501))), pads, materials=LAW,
                  start=hands((-0.08, 0.0, 0.05), (0.08, 0.0, 0.05)))
    engine = loaded(scene)
    for k in range(300):
        x, z = 0.08 - 0.03 * min(1.0, k / 30), 0.05 + 0.2 * min(1.0, max(0.0, (k - 60) / 60))
        record = engine.advance(hands((-x, 0.0, z), (x, 0.0, z)), DT)
    found = engine.contacts(forces=True)
    assert on("cube", found) == pytest.approx([0.0, 0.0, 0.3 * G], abs=1e-5)
    lag = 0.05 - record.shown.positions[3, 0]
    assert on("right", found)[0] == pytest.approx(-K * lag, rel=1e-4) and -K * lag > 1.0


def test_fingers_with_joints_bear_a_mug_together() -> None:
    scenario = catalog.get("mug_in_fingers")
    scene = scenario.build()
    engine, motion = loaded(scene, dt=scenario.dt), scenario.motion(scene, 0)
    for k in range(110):
        engine.advance(motion(k), scenario.dt)
    for _ in range(90):
        engine.advance(motion(109), scenario.dt)
    mass = next(body.mass.mass for body in scene.bodies if body.name == "mug" and body.mass is not None)
    found = engine.contacts(forces=True)
    assert on("mug", found) == pytest.approx([0.0, 0.0, mass * G], abs=1e-4)
    assert engine.felt("hand").shape == (4, 3)


def test_a_lift_bears_its_load_at_rest_rising_and_speeding_up() -> None:
    for force, mass, rise in ((300.0, 2.0, 0.005), (1e4, 50.0, 0.0)):
        lift = moving("lift", (Piece(Box((0.5, 0.5, 0.05))),), "m", position=(0.0, 0.0, 0.3), largest_force=force)
        engine = loaded(Scene("lift", (FLOOR, cube(mass, (0.0, 0.0, 0.376))), (lift,), materials=LAW))
        for k in range(90):
            engine.advance(rest(()), DT, moving={"lift": ((0.0, 0.0, 0.3 + rise * min(k, 60)), (1.0, 0.0, 0.0, 0.0))})
        assert on("cube", engine.contacts(forces=True), "lift") == pytest.approx([0.0, 0.0, mass * G], rel=SAME, abs=1e-4)
    for k in range(40):
        engine.advance(rest(()), DT, moving={"lift": ((0.0, 0.0, 0.3 + 1.5 * (k * DT) ** 2), (1.0, 0.0, 0.0, 0.0))})
    assert on("cube", engine.contacts(forces=True), "lift")[2] == pytest.approx(50.0 * (G + 3.0), rel=2e-2)


def test_forces_are_asked_for_where_there_are_any() -> None:
    hand = fist()
    engine = loaded(Scene("alone", (FLOOR,), (hand,), materials=LAW, start=hands((0.0, 0.0, 1.0))))
    with pytest.raises(InvalidInput):
        engine.contacts(forces=True)
    with pytest.raises(InvalidInput):
        engine.felt("fist")
    scene = Scene("two", (FLOOR, cube(1.0, (1.0, 0.0, 0.05))), (hand,), materials=LAW, start=hands((0.0, 0.0, 1.0)))
    engine.load(scene, Settings(), DT)
    with pytest.raises(UnknownName):
        engine.felt("nobody")
