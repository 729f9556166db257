"""The shield with limits of speed and acceleration: kept in every call, with a proved way to rest from each row."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.assets.models.load import load_avatar
from avatarsim.assets.models.model import Model
from avatarsim.cleaning import Options, Shield
from avatarsim.cleaning.chords import Chords, certified, scene_of
from avatarsim.errors import InvalidInput, UnknownName
from avatarsim.scene.motion import Motion
from tests.cleaning.rated import (
    coordinates,
    driven,
    home,
    largest_rates,
    mixed,
    plain_twin,
    room,
    two_arms,
    two_arms_text,
)

RATE = 60.0


@pytest.fixture(scope="module")
def arms(tmp_path_factory: pytest.TempPathFactory) -> Model:
    """The robot of two arms."""
    return two_arms(tmp_path_factory.mktemp("arms"))


def motion_of(model: Model, rows: np.ndarray) -> Motion:
    """Return the rows as a motion."""
    return coordinates(model).motion(rows, np.arange(len(rows)) / RATE)


def require_sound(model: Model, chords: Chords, rows: np.ndarray) -> None:
    """Raise AssertionError where a row or a way between two is not free, or a joint is beyond its limits."""
    motion = motion_of(model, rows)
    assert (certified(chords, motion).until == 1.0).all()
    for frame in range(len(rows)):
        sample = motion.sample(frame)
        assert chords.nearest(sample, 1e-3)[0] > -1e-9 and max(chords.clipped(sample)[1]) <= 1e-9


def require_limited(model: Model, rows: np.ndarray, speed: np.ndarray, acceleration: np.ndarray) -> None:
    """Raise AssertionError where rows that begin at rest are faster than the limits, to the last digit."""
    fastest, steepest = largest_rates(model, rows, RATE)
    assert (fastest <= speed).all() and (steepest <= acceleration).all(), (fastest / speed, steepest / acceleration)


def drive(shield: Shield, given: np.ndarray) -> tuple[np.ndarray, list[np.ndarray]]:
    """Return the output, and before each fourth row the ways to rest, with the two rows before them."""
    out: list[np.ndarray] = []
    ways: list[np.ndarray] = []
    for k, q in enumerate(given):
        out.append(shield(q))
        if k % 4 == 1:
            ways.append(np.concatenate([np.array(out[-2:]), shield.stop()]))
    return np.array(out), ways


def require_stops(model: Model, chords: Chords, ways: list[np.ndarray], speed: np.ndarray, acceleration: np.ndarray) -> int:
    """The same of ways to rest; how many rows they have."""
    count = 0
    for way in ways:
        require_sound(model, chords, way)
        count += len(way) - 2
        # seen backwards, a way to rest begins at rest
        fastest, steepest = largest_rates(model, way[::-1], RATE)
        assert (fastest <= speed).all() and (steepest <= acceleration).all()
    return count


def require_kept(model: Model, rows: np.ndarray, ways: list[np.ndarray], speed: np.ndarray, acceleration: np.ndarray) -> int:
    """Nothing in the room is touched and limits are kept, also by the ways to rest; how many rows these have."""
    chords = Chords(scene_of(model, room(), Options()))
    require_sound(model, chords, rows)
    require_limited(model, rows, speed, acceleration)
    return require_stops(model, chords, ways, speed, acceleration)


@pytest.mark.parametrize("hold", [0, 15])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_two_arms_keep_limits_and_stay_free(arms: Model, hold: int, seed: int) -> None:
    speed, acceleration = np.full(8, 2.0), np.full(8, 9.0)
    given = driven(arms, 240, RATE, hold, 3.0, seed)
    shield = Shield(arms, room(), RATE, speed_limits=2.0, acceleration_limits=9.0)
    rows, ways = drive(shield, given)
    assert require_kept(arms, rows, ways, speed, acceleration) > 100
    chords = Chords(scene_of(arms, room(), Options()))
    without = np.array([chords.nearest(motion_of(arms, given).sample(k), 1e-3)[0] for k in range(len(given))])
    assert (without < 0.0).sum() > 50
    # it follows nearly as well as the limits alone let it
    assert np.abs(rows - given).mean() < 1.5 * np.abs(plain_twin(given, 2.0, 9.0, RATE) - given).mean()


@pytest.mark.parametrize("hold", [0, 15])
def test_roots_and_balls_are_limited_in_their_norm(hold: int) -> None:
    model = mixed()
    speed, acceleration = np.array([1.0, 2.5, 2.0, 2.0, 2.0, 3.0]), np.array([5.0, 15.0, 9.0, 9.0, 9.0, 20.0])
    names = coordinates(model).names
    limits = [{name: (float(one[0]), float(one[1])) if name == names[0] else float(one[k + 1]) for k, name in enumerate(names)}
              for one in (speed, acceleration)]
    shield = Shield(model, room(), RATE, speed_limits=limits[0], acceleration_limits=limits[1])
    rows, ways = drive(shield, driven(model, 240, RATE, hold, 1.5, 4))
    assert require_kept(model, rows, ways, speed, acceleration) > 50


@given(st.integers(0, 10**6), st.none() | st.floats(0.2, 6.0), st.none() | st.floats(1.0, 60.0), st.sampled_from([0, 3, 15]))
def test_limits_hold_for_any_numbers(seed: int, speed: float | None, acceleration: float | None, hold: int) -> None:
    model = mixed()
    shield = Shield(model, room(), RATE, speed_limits=speed, acceleration_limits=acceleration)
    rows, _ = drive(shield, driven(model, 40, RATE, hold, 2.0, seed))
    require_kept(model, rows, [], np.full(6, speed or np.inf), np.full(6, acceleration or np.inf))
    assert len(shield.stop()) == 0 or acceleration is not None


def test_nothing_overlaps_by_mujoco_on_the_same_shapes(arms: Model) -> None:
    mujoco = pytest.importorskip("mujoco")
    shield = Shield(arms, room(), RATE, speed_limits=3.0, acceleration_limits=12.0)
    rows, ways = drive(shield, driven(arms, 240, RATE, 15, 3.0, 9))
    model = mujoco.MjModel.from_xml_string(two_arms_text(with_room=True))
    data, ends = mujoco.MjData(model), np.zeros(6)
    body, parent = model.geom_bodyid, model.body_parentid
    pairs = [
        (i, j) for i in range(model.ngeom) for j in range(i)
        if body[i] != body[j] and parent[body[i]] != body[j] and parent[body[j]] != body[i]
    ]
    least = np.inf
    for row in np.concatenate([rows, 0.5 * (rows[1:] + rows[:-1]), *ways]):
        data.qpos[:] = row
        mujoco.mj_kinematics(model, data)
        least = min(least, *(mujoco.mj_geomDistance(model, data, i, j, 0.02, ends) for i, j in pairs))
    assert -1e-6 < least < 2e-3


def test_what_is_free_and_slow_comes_out_as_it_went_in(arms: Model) -> None:
    shield = Shield(arms, (), RATE, speed_limits=2.0, acceleration_limits=9.0)
    given = home(arms) + 0.2 * (1.0 - np.cos(2.0 * np.pi * np.arange(120) / 120.0))[:, None] * np.eye(8)[3]
    out = np.array([shield(q) for q in given])
    assert np.array_equal(out, given) and shield.is_free


def test_in_free_space_it_is_the_plain_filter(arms: Model) -> None:
    given = home(arms) + driven(arms, 200, RATE, 15, 0.3, 5) * np.array([0.0, 1, 0, 1, 0, 1, 0, 1])
    given[:, [2, 6]] = -0.6
    shield = Shield(arms, (), RATE, speed_limits=1.0, acceleration_limits=6.0)
    out = np.array([shield(q) for q in given])
    assert out == pytest.approx(plain_twin(given, 1.0, 6.0, RATE), abs=1e-9)


def test_calls_without_a_target_go_along_the_way_to_rest(arms: Model) -> None:
    shield = Shield(arms, room(), RATE, speed_limits=2.0, acceleration_limits=9.0)
    with pytest.raises(InvalidInput, match="first call"):
        shield(None)
    rows, _ = drive(shield, driven(arms, 60, RATE, 15, 3.0, 7))
    way = shield.stop()
    assert len(way) > 3
    braked = np.array([shield(None) for _ in range(len(way) + 3)])
    assert braked[: len(way)] == pytest.approx(way, abs=1e-12)
    assert (np.ptp(braked[len(way) :], axis=0) == 0.0).all() and len(shield.stop()) == 0 and not shield.is_free
    require_limited(arms, np.concatenate([rows, braked]), np.full(8, 2.0), np.full(8, 9.0))
    shield(rows[0])


def test_without_limits_a_call_without_a_target_stays(arms: Model) -> None:
    shield = Shield(arms, room(), RATE, speed_limits=None)
    rows, _ = drive(shield, driven(arms, 30, RATE, 15, 3.0, 7))
    assert np.array_equal(shield(None), rows[-1]) and shield.stop().shape == (0, 8)


def test_what_is_refused_leaves_the_stream_as_it_was(arms: Model) -> None:
    shields = [Shield(arms, room(), RATE, speed_limits=2.0, acceleration_limits=9.0) for _ in range(2)]
    for k, q in enumerate(driven(arms, 40, RATE, 15, 3.0, 8)):
        if k % 5 == 2:
            with pytest.raises(InvalidInput):
                shields[0](np.where(np.arange(8) == k % 8, np.nan, q))
        assert np.array_equal(shields[0](q), shields[1](q))


def test_a_stream_that_begins_in_the_wall_begins_beside_it() -> None:
    model = mixed()
    inside = home(model)
    inside[0] = 0.5
    shield = Shield(model, room(), RATE, speed_limits=1.0, acceleration_limits=5.0)
    rows = np.array([shield(inside) for _ in range(20)])
    require_kept(model, rows, [], np.full(6, 1.0), np.full(6, 5.0))


def test_limits_by_name_in_order_and_as_one_number_are_the_same(arms: Model) -> None:
    given, names = driven(arms, 40, RATE, 15, 3.0, 1), coordinates(arms).names
    wrist = dict.fromkeys(names, 2.0) | {"left wrist": None}
    ways: tuple[tuple[object, object], ...] = (
        (2.0, dict.fromkeys(names, 2.0)), ([2.0] * 8, np.full(8, 2.0)), (2, dict.fromkeys(names, 2)),
        (wrist, [wrist[name] for name in names]),
    )
    for one, other in ways:
        shields = [Shield(arms, (), RATE, speed_limits=speed, acceleration_limits=9.0) for speed in (one, other)]  # type: ignore[arg-type]
        assert all(np.array_equal(shields[0](q), shields[1](q)) for q in given)


@pytest.mark.parametrize("wrong", [
    -1.0, 0.0, float("nan"), float("inf"), "fast", [1.0] * 7, np.ones(9), [1.0] * 7 + [float("nan")], [1.0] * 7 + [-1.0],
    np.ones((8, 2)), {"left lift": 1.0}, True, b"file",
])
def test_limits_that_do_not_fit_are_refused(arms: Model, wrong: object) -> None:
    for limits in ({"speed_limits": wrong}, {"acceleration_limits": wrong}):
        with pytest.raises(InvalidInput):
            Shield(arms, (), RATE, **limits)  # type: ignore[arg-type]


def test_limits_of_joints_that_are_not_there_are_refused(arms: Model) -> None:
    with pytest.raises(UnknownName):
        Shield(arms, (), RATE, speed_limits={"left knee": 1.0})
    with pytest.raises(InvalidInput):
        Shield(arms, (), RATE, acceleration_limits="file")
    three = {**dict.fromkeys(coordinates(mixed()).names, 1.0), "root": (1.0, 2.0, 3.0)}
    with pytest.raises(InvalidInput):
        Shield(mixed(), (), RATE, speed_limits=three)  # type: ignore[arg-type]


@pytest.mark.parametrize(("speed", "acceleration"), [(1e4, 30.0), (1e4, 1e-3), (1e300, 1e-300), (None, 1e-2)])
def test_a_speed_limit_beyond_reach_keeps_acceleration(arms: Model, speed: float | None, acceleration: float) -> None:
    given = driven(arms, 60, RATE, 15, 3.0, 4)
    shields = [Shield(arms, room(), RATE, speed_limits=one, acceleration_limits=acceleration) for one in (speed, None)]
    rows, ways = drive(shields[0], given)
    require_kept(arms, rows, [], np.full(8, speed or np.inf), np.full(8, acceleration))
    assert np.array_equal(rows, [shields[1](q) for q in given]) and len(shields[0].stop()) > 1


URDF = """<robot name="r"><link name="world"/>{parts}</robot>"""
PART = """<link name="l{k}"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><origin xyz="0 0 0.15"/><geometry><box size="0.05 0.05 0.2"/></geometry></collision></link>
<joint name="j{k}" type="revolute"><parent link="{above}"/><child link="l{k}"/><origin xyz="0 0 0.3"/><axis xyz="0 1 0"/>
<limit lower="-2" upper="2" effort="10"{velocity}/></joint>"""


def urdf(folder: Path, *velocities: str) -> Model:
    """Return a chain of hinges with these limits of speed."""
    parts = [
        PART.format(k=k, above=f"l{k - 1}" if k else "world", velocity=f' velocity="{one}"' if one else "")
        for k, one in enumerate(velocities)
    ]
    (folder / "r.urdf").write_text(URDF.format(parts="".join(parts)))
    return load_avatar(folder / "r.urdf")


def test_urdf_velocities_are_the_default_limits_of_speed(tmp_path: Path) -> None:
    model = urdf(tmp_path, "0.5", "1.25")
    given = driven(model, 60, RATE, 15, 1.5, 1)
    for limits, speed in (("file", (0.5, 1.25)), ({"j1": 3.0}, (0.5, 3.0)), (None, None)):
        shield = Shield(model, (), RATE, speed_limits=limits)
        fastest, _ = largest_rates(model, np.array([shield(q) for q in given]), RATE)
        assert fastest == pytest.approx(speed, rel=1e-5) if speed else (fastest > 5.0).all()


def test_refuses_a_urdf_joint_without_a_velocity(tmp_path: Path) -> None:
    for missing in ("", "0"):
        model = urdf(tmp_path, "0.5", missing)
        with pytest.raises(InvalidInput, match="j1"):
            Shield(model, (), RATE)
        Shield(model, (), RATE, speed_limits={"j1": 2.0})
    shield = Shield(urdf(tmp_path, "", ""), (), RATE)
    assert np.array_equal(shield(np.zeros(2)), np.zeros(2)) and np.array_equal(shield(np.array([1.0, 0.5])), [1.0, 0.5])
