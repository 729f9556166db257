"""Moving bodies: they follow given poses, carry their loads, give way where they would crush, stay where they are put."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from avatarsim.engine import FrameRecord, Settings
from avatarsim.errors import InvalidSample, InvalidScene, UnknownName
from avatarsim.many_worlds import advance_many
from avatarsim.scene.avatar import Avatar
from avatarsim.scene.body import Body, fixed
from avatarsim.scene.joint import Hinge, Hinges
from avatarsim.scene.moving import Pose, moving
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, ConvexHull, Piece, Shape, Sphere
from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.simulator import AvatarsimEngine
from avatarsim.tolerances import JUDGED
from tests.coupling.scenes import FLOOR, LAW, cube, deepest, fist
from tests.rigid.upper_world import G
from tests.worlds.loaded import DT, loaded

UPRIGHT = (1.0, 0.0, 0.0, 0.0)
LEAF = (Piece(Box((0.8, 0.04, 1.0)), (0.42, 0.0, 0.52)),)
"""Of a door, whose hinges are at its frame's origin."""
LEFT = Hinges((Hinge((0.0, 0.0, 1.0), -2.0, 2.0),))


def pieces(shape: Shape) -> tuple[Piece, ...]:
    """Return one shape."""
    return (Piece(shape),)


def turned(angle: float) -> tuple[float, float, float, float]:
    """Return the turn about z."""
    return float(np.cos(0.5 * angle)), 0.0, 0.0, float(np.sin(0.5 * angle))


@dataclass
class Run:
    """Frames that were shown: positions (frames, n, 3), orientations, angles, and records."""

    scene: Scene
    records: list[FrameRecord]

    def place(self, name: str) -> np.ndarray:
        """Return positions (frames, 3) of a body."""
        k = self.scene.names.index(name)
        return np.array([record.shown.positions[k] for record in self.records])

    @property
    def deepest(self) -> float:
        """Largest overlap [m] by the judge."""
        return deepest(self.scene, self.records)

    def blocked(self) -> np.ndarray:
        """Return the number of blocked bodies in each frame."""
        return np.array([record.statuses.get("blocked", 0) for record in self.records])


Given = Callable[[int], Mapping[str, Pose]]


def run(
    bodies: list[Body], avatars: list[Avatar], frames: int, given: Given,
    users: Callable[[int], Sequence[tuple[float, ...]]] | None = None,
) -> Run:
    """Return frames in which moving bodies are given poses, and rigid hands are where ``users`` has them."""
    persons = [avatar for avatar in avatars if not avatar.moves]

    def sample(k: int) -> TrackerSample:
        at = rest(persons, k * DT)
        return at if users is None else replace(at, positions=np.array(users(k), dtype=np.float64).reshape(-1, 3))

    start = rest(avatars)
    start.positions[[not avatar.moves for avatar in avatars]] = sample(0).positions
    scene = Scene("moving", tuple(bodies), tuple(avatars), materials=LAW, start=start)
    engine = AvatarsimEngine()
    records = [engine.load(scene, Settings(), DT)]
    for k in range(1, frames):
        records.append(engine.advance(sample(k), DT, moving=given(k)))
    return Run(scene, records)


def lift(**options: Any) -> Avatar:
    """Return a platform whose top is at 0.1 m."""
    return moving("lift", pieces(Box((1.0, 1.0, 0.08))), "m", position=(0.0, 0.0, 0.06), **options)


def rising(k: int) -> float:
    """Return the height of the lift [m]: after 20 frames 0.5 m in a second."""
    return 0.06 + 0.5 * min(1.0, max(0.0, (k - 20) * DT))


def lifted(load: Body, frames: int, high: Callable[[int], float] = rising, **options: float) -> Run:
    """Return a load on the lift, which is given its height in every frame."""
    return run([FLOOR, load], [lift(**options)], frames, lambda k: {"lift": ((0.0, 0.0, high(k)), UPRIGHT)})


def test_a_lift_carries_a_box_that_sleeps_once_it_stands() -> None:
    seen = lifted(cube(2.0, (0.0, 0.0, 0.151), "box"), 200)
    lag = [rising(k) - z for k, z in enumerate(seen.place("lift")[:, 2])]
    # while it rises at constant speed
    assert lag[60] == pytest.approx(2.0 * G / 1e6, rel=1e-3)
    assert np.abs(np.diff(seen.place("box")[22:79, 2]) - 0.5 * DT).max() < 1e-5
    assert seen.place("box")[-1, 2] == pytest.approx(0.65, abs=1e-4)
    assert np.abs(seen.place("box")[:, :2]).max() < 1e-6
    assert seen.deepest <= JUDGED and not seen.blocked().any()
    assert seen.records[60].counts["substeps"] > 0 and seen.records[-1].counts["segments"] == 0


@pytest.mark.parametrize(("mass", "force", "rises"), [(2.0, 10.0, False), (5000.0, 4e4, False), (5000.0, 6e4, True)])
def test_a_lift_raises_what_its_largest_force_can_bear(mass: float, force: float, rises: bool) -> None:
    """Five tons are 49 kN; the lift's own ten kilograms are no limit."""
    seen = lifted(
        cube(mass, (0.0, 0.0, 0.201), "box", 0.2), 120, lambda k: 0.06 + 0.3 * min(1.0, k / 90),
        largest_force=force, stiffness=1e7,
    )
    assert (seen.place("lift")[-1, 2] > 0.3) == rises and seen.deepest <= JUDGED
    assert rises or (seen.place("lift")[-1, 2] < 0.06 and seen.blocked()[30:].all())


def test_a_turntable_keeps_a_box_at_its_radius() -> None:
    """To 0.1 mm in ten seconds at 3 rad/s, which it has after two."""
    around = np.linspace(0.0, 2.0 * np.pi, 32, endpoint=False)
    rim = [(0.6 * np.cos(a), 0.6 * np.sin(a), z) for a in around for z in (-0.02, 0.02)]
    table = moving("table", pieces(ConvexHull(np.array(rim))), "m", position=(0.0, 0.0, 0.03))
    angle = np.cumsum([min(3.0, 1.5 * k * DT) * DT for k in range(600)])
    seen = run([cube(1.0, (0.2, 0.0, 0.1), "box")], [table], 600, lambda k: {"table": ((0.0, 0.0, 0.03), turned(angle[k]))})
    radius = np.linalg.norm(seen.place("box")[:, :2], axis=1)
    assert np.abs(radius - 0.2).max() < 1e-4
    assert seen.deepest <= JUDGED


def test_a_belt_brings_a_box_to_its_speed() -> None:
    """By friction mu g at first, then with the belt."""
    belt = moving("belt", pieces(Box((4.0, 0.6, 0.1))), "m", position=(0.0, 0.0, 0.05), surface_velocity=(1.0, 0.0, 0.0))
    seen = run([cube(1.0, (-1.5, 0.0, 0.15), "box")], [belt], 100, lambda k: {})
    speed = np.diff(seen.place("box")[:, 0]) / DT
    assert speed[5] - speed[2] == pytest.approx(0.6 * G * 3.0 * DT, rel=0.02)
    assert speed[-1] == pytest.approx(1.0, abs=1e-4)
    assert np.ptp(seen.place("belt"), axis=0).max() < 1e-4


def door(**options: Any) -> Avatar:
    """Return a door in hinges."""
    return moving("door", LEAF, "m", joint=LEFT, **options)


def closing(k: int) -> float:
    """Return the angle of a door [rad]: to -1.2 and back."""
    return -min(0.8 * k * DT, 1.2) if k < 150 else -1.2 + min(0.8 * (k - 150) * DT, 1.2)


WALL = fixed("wall", pieces(Box((1.0, 0.1, 1.0))), "m", (0.5, -0.6, 0.5))
STOP = fixed("stop", pieces(Box((0.1, 0.4, 1.0))), "m", (0.3, -0.5, 0.5))
"""Behind a hand that a door closes on, and at its side."""
BEHIND = (0.5, -0.4, 0.5)


def closed(bodies: list[Body], frames: int, **options: float) -> Run:
    """Return a door that closes on a hand whose user stays."""
    return run([FLOOR, *bodies], [door(**options), fist()], frames, lambda k: {"door": closing(k)}, lambda k: [BEHIND])


def test_a_door_pushes_a_hand_away_and_leaves_no_lag() -> None:
    """Also against a wall, from which the hand cannot get away."""
    for bodies in ([], [WALL], [WALL, STOP]):
        seen = closed(bodies, 330)
        assert seen.deepest <= JUDGED
        assert np.linalg.norm(seen.place("fist")[-1] - BEHIND) < 1e-6
        assert abs(seen.records[-1].angles[0]) < 1e-6
        # while both wait
        assert np.ptp(seen.place("fist")[140:150], axis=0).max() < 1e-5
    assert seen.blocked()[100:150].all()


@pytest.mark.parametrize("force", [30.0, 300.0])
def test_a_door_presses_with_its_largest_force_at_most(force: float) -> None:
    """A hand of K = 1000 N/m that it cannot pass yields force / K at its lever."""
    seen = closed([WALL, STOP], 150, largest_force=force)
    assert seen.blocked()[-1] == 1
    assert seen.records[-1].angles[0] > -1.2 + 0.05


def test_a_door_stops_at_boxes_without_a_jerk() -> None:
    """Eight of them, wedged against walls."""
    walls = [
        fixed("back", pieces(Box((2.0, 0.1, 0.6))), "m", (0.4, -0.6, 0.3)),
        fixed("side", pieces(Box((0.1, 1.2, 0.6))), "m", (0.97, -0.6, 0.3)),
        fixed("near", pieces(Box((0.1, 0.45, 0.6))), "m", (0.1, -0.4, 0.3)),
    ]
    boxes = [cube(2.0, (0.25 + 0.19 * (k % 4), -0.25 - 0.19 * (k // 4), 0.0901), f"box {k}", 0.18) for k in range(8)]
    seen = run([FLOOR, *walls, *boxes], [door()], 300, lambda k: {"door": -min(0.8 * k * DT, 1.5)})
    angles = np.array([record.angles[0] for record in seen.records])
    assert angles[-1] > -1.45 and seen.blocked()[-1] == 1
    assert np.ptp(angles[-60:]) < 1e-5
    # it bounces off them by less than half of its step in a frame
    assert np.diff(angles).max() < 0.4 * DT
    assert seen.deepest <= JUDGED


def test_a_door_without_a_spring_stays_where_a_hand_left_it() -> None:
    def hand(k: int) -> list[tuple[float, ...]]:
        y = -0.4 + min(0.8, 0.5 * k * DT)
        return [(0.6, y if k < 150 else 0.4 - min(0.8, 0.5 * (k - 150) * DT), 0.5)]

    for order in (1, -1):
        seen = run([FLOOR], [door(stiffness=0.0), fist()][::order], 600, lambda k: {}, hand)
        angles = np.array([record.angles[0] for record in seen.records])
        assert angles[140] > 0.6
        assert np.ptp(angles[250:]) < 1e-4 and np.ptp(angles[400:]) < 1e-9
        assert np.linalg.norm(seen.place("fist")[-1] - (0.6, -0.4, 0.5)) < 1e-6
        assert seen.deepest <= JUDGED


def test_hands_that_a_door_pushes_push_others() -> None:
    """Two hands in a row; neither hops when it passes the push on."""
    users = [(0.6, -0.3, 0.5), (0.6, -0.42, 0.5)]
    seen = run([FLOOR], [door(), fist("one"), fist("other")], 330, lambda k: {"door": closing(k)}, lambda k: users)
    assert seen.deepest <= JUDGED
    for name in ("one", "other"):
        assert np.linalg.norm(np.diff(seen.place(name), axis=0), axis=1).max() < 0.05
    assert np.linalg.norm(seen.place("other")[-1] - users[1]) < 1e-6


def test_a_hand_leaning_on_a_wall_stays_as_a_door_passes() -> None:
    wall = fixed("wall", pieces(Box((0.1, 0.4, 1.0))), "m", (1.1, -0.4, 0.5))
    seen = run([FLOOR, wall], [door(), fist()], 330, lambda k: {"door": closing(k)},
               lambda k: [(0.99 + min(0.06, 0.01 * k), -0.45, 0.5)])
    assert np.ptp(seen.place("fist")[20:], axis=0).max() < 1e-3
    assert seen.deepest <= JUDGED


def test_moving_bodies_pass_each_other_and_what_is_fixed() -> None:
    other = moving("other", LEAF, "m", position=(0.4, 0.0, 0.0))
    seen = run([FLOOR, fixed("wall", pieces(Box((0.1, 0.4, 1.0))), "m", (0.5, -0.4, 0.5))], [door(), other], 150,
               lambda k: {"door": closing(k)})
    assert not seen.blocked().any()
    assert np.abs(np.array([one.angles[0] for one in seen.records]) - [closing(k) for k in range(150)]).max() < 1e-6


def test_what_is_not_given_keeps_its_last_pose() -> None:
    scene = Scene("two ways", (FLOOR, cube(1.0, (0.0, 0.0, 0.151), "box")), (lift(), fist()), materials=LAW,
                  start=replace(rest((lift(), fist())), positions=np.array([(0.0, 0.0, 0.06), (0.3, 0.0, 0.6)])))
    engines = [AvatarsimEngine() for _ in range(3)]
    for engine in engines:
        engine.load(scene, Settings(), DT)
    person = replace(rest((fist(),)), positions=np.array([(0.3, 0.0, 0.6)]))
    for k in range(90):
        z = rising(min(k, 50))
        whole = replace(scene.first_sample, time=k * DT, positions=np.array([(0.0, 0.0, z), (0.3, 0.0, 0.6)]))
        one = engines[0].advance(whole, DT)
        # after 50 frames the lift is not given any more
        given = {"lift": ((0.0, 0.0, z), UPRIGHT)} if k <= 50 else {}
        other = engines[1].advance(replace(person, time=k * DT), DT, moving=given)
        many = advance_many([engines[2]], [person], DT, moving=[given])[0]
        assert one.state_hash() == other.state_hash() == many.state_hash()
        if k == 60:
            engines[1].restore(engines[0].snapshot())
        if k == 70:
            for engine in engines:
                engine.change(replace(scene, name="changed"))


@pytest.mark.parametrize(("given", "error"), [
    ({"lift": (0.0, 0.0, 0.0)}, InvalidSample), ({"lift": ((0.0, 0.0, float("nan")), UPRIGHT)}, InvalidSample),
    ({"lift": ((0.0, 0.0, 0.1), (2.0, 0.0, 0.0, 0.0))}, InvalidSample), ({"door": 1.0}, UnknownName), ([1.0], InvalidSample),
    ({"lift": "up"}, InvalidSample), ({"lift": 1.0}, InvalidSample), ({"fist": ((0.0, 0.0, 0.0), UPRIGHT)}, UnknownName),
])
def test_poses_that_are_none_are_refused_and_nothing_has_moved(given: object, error: type[Exception]) -> None:
    engine = loaded(Scene("lift", (), (lift(),), materials=LAW))
    before = engine.snapshot()
    with pytest.raises(error):
        engine.advance(rest(()), DT, moving=given)  # type: ignore[arg-type]
    assert engine.snapshot() == before
    with pytest.raises(UnknownName):
        loaded(Scene("hand", (), (fist(),), materials=LAW)).advance(rest((fist(),)), DT, moving={"fist": (BEHIND, UPRIGHT)})


@pytest.mark.parametrize("wrong", [
    {"mass": 0.0}, {"stiffness": -1.0}, {"largest_force": 0.0}, {"surface_velocity": (1.0, 2.0)}, {"damping": float("inf")},
])
def test_a_moving_body_that_cannot_be_is_refused(wrong: dict[str, object]) -> None:
    with pytest.raises(InvalidScene):
        moving("lift", pieces(Sphere(0.1)), "m", **wrong)  # type: ignore[arg-type]


@pytest.mark.parametrize("off", ["coupling", "dynamics"])
def test_without_the_coupling_it_follows_its_poses_as_hands_do(off: str) -> None:
    scene = Scene("narrowed", (), (lift(),), materials=LAW, narrow=(off,))
    engine = loaded(scene)
    for k in range(40):
        record = engine.advance(rest(()), DT, moving={"lift": ((0.0, 0.0, 0.06 + 0.001 * k), UPRIGHT)})
    assert record.shown.positions[0, 2] == pytest.approx(0.099, abs=1e-9)


def test_a_jump_of_its_pose_throws_nothing_far() -> None:
    """Half a metre in one frame is made up at the speed of catching up, 5 m/s on either side of its own."""
    seen = lifted(cube(2.0, (0.0, 0.0, 0.151), "box"), 120, lambda k: 0.06 + 0.5 * (k > 20))
    assert max(float(np.abs(one.shown.velocities[1]).max()) for one in seen.records) < 10.0
    assert abs(seen.place("lift")[-1, 2] - 0.56) < 1e-3 and seen.deepest <= JUDGED


def test_angles_beyond_the_limits_of_hinges_are_clipped() -> None:
    seen = run([FLOOR], [door()], 300, lambda k: {"door": min(0.02 * k, 3.0)})
    assert seen.records[-1].angles[0] == pytest.approx(2.0, abs=1e-9) and not seen.blocked()[-60:].any()
