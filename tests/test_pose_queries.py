"""Contacts of the shown state against dumb twins: closed forms over all pairs, without a broad phase."""

from itertools import combinations

import numpy as np
import pytest

from avatarsim.errors import EngineInUse, InvalidInput
from avatarsim.pose_queries import Contact
from avatarsim.scene.avatar import rigid_avatar
from avatarsim.scene.body import fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample
from tests.stability.hostile import DT
from tests.worlds.little_worlds import at, hand_scene, panel
from tests.worlds.loaded import loaded

FLOOR = Box((4.0, 4.0, 0.2))
FREE = Scene("hand", (panel(),), hand_scene((-0.5, 0.0, 0.0)).avatars, start=hand_scene((-0.5, 0.0, 0.0)).start)


def of_balls(centres: np.ndarray, radii: np.ndarray, within: float) -> dict[tuple[str, str], tuple]:
    """Contacts of balls with each other and with a floor up to z = 0, by the distances of centres: gap, normal, point."""
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
    """Contacts by pair, of which there is one each."""
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
    engine = loaded(Scene("balls", (fixed("floor", (Piece(FLOOR),), "wood", (0.0, 0.0, -0.1)), *balls)))
    found, wanted = told(engine.contacts(within)), of_balls(centres, radii, within)
    assert found.keys() == wanted.keys() and (within < 0.05 or len(found) > 20)
    for pair, (gap, normal, point) in wanted.items():
        assert found[pair][0] == pytest.approx(gap, abs=1e-12)
        assert found[pair][1] == pytest.approx(normal, abs=1e-9) and found[pair][2] == pytest.approx(point, abs=1e-9)


def test_a_box_stands_on_its_four_corners() -> None:
    box = (Piece(Box((0.2, 0.3, 0.1))),)
    floor = fixed("floor", (Piece(FLOOR),), "wood", (0.0, 0.0, -0.1))
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
    assert engine.snapshot() == before


@pytest.mark.parametrize("within", [-1e-9, 1.5, float("nan"), "near"])
def test_a_gap_that_is_none_is_refused(within: float) -> None:
    with pytest.raises(InvalidInput, match="largest gap of contacts"):
        loaded(FREE).contacts(within)


def test_contacts_are_of_one_call_at_a_time() -> None:
    engine = loaded(FREE)
    with engine._alone(), pytest.raises(EngineInUse):
        engine.contacts()
