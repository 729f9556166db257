"""Each trap that would silently falsify the comparison, sprung on purpose: the adapters must not fall into it."""

import numpy as np
import pytest

from avatarsim.engine import Engine, Settings, Snapshot
from avatarsim.errors import InvalidScene
from avatarsim.scene.body import fixed, simulated, solid
from avatarsim.scene.joint import SwingTwist
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.spatial import rotation
from reference.in_mujoco.engine import MujocoEngine
from reference.judging.judge import Judge
from tests.agreement.rivals import ENGINES, PybulletEngine, needs_pybullet, pybullet
from tests.agreement.scenes import (
    FRAME,
    arm,
    ball_on_slab,
    bent,
    bodies_of_all_shapes,
    chain,
    hand_over_table,
    hull_on_slab,
    nobody,
    pressed,
    sliding_box,
    swung,
)


def bounce(engine: Engine, preset: str, options: dict[str, object], frames: int = 40) -> tuple[float, str]:
    """Ratio of the velocities after and before the first bounce of a ball from 1 m, and the hash of the last frame."""
    scene = ball_on_slab()
    engine.load(scene, Settings(preset, options, record_inside=True), FRAME)
    inside: list[Snapshot] = []
    for frame in range(frames):
        record = engine.advance(nobody(scene, frame), FRAME)
        inside += record.inside
    engine.close()
    speeds = np.array([snapshot.velocities[1, 2] for snapshot in inside])
    # a ball that never comes back up has not bounced at all
    after = int(np.argmax(speeds > 0.05)) if (speeds > 0.05).any() else 0
    return (float(speeds[after] / -speeds[:after].min()) if after else 0.0), record.state_hash()


@needs_pybullet
def test_1_breaking_threshold_left_behind_by_others_does_not_matter() -> None:
    """It is global to the process and outlives resetSimulation and disconnect."""
    _, fresh = bounce(PybulletEngine(), "default", {})
    other = pybullet.connect(pybullet.DIRECT)
    pybullet.setPhysicsEngineParameter(contactBreakingThreshold=1e-4, physicsClientId=other)
    pybullet.disconnect(other)
    assert bounce(PybulletEngine(), "default", {})[1] == fresh


@ENGINES
@pytest.mark.parametrize("preset", ["default", "tuned"])
def test_2_shown_poses_are_not_a_step_old(engine: Engine, preset: str) -> None:
    ball = (Piece(Sphere(0.1)),)
    body = simulated("ball", ball, "wood", solid(ball, 1.0), velocity=(1.0, 0.0, 0.0))
    scene = Scene("fly", (body,), gravity=(0.0, 0.0, 0.0))
    options: dict[str, object] = {"damping": 0.0} if engine.name == "pybullet" else {}
    engine.load(scene, Settings(preset, options), FRAME)
    record = engine.advance(nobody(scene, 0), FRAME)
    engine.close()
    assert record.shown.positions[0, 0] == pytest.approx(FRAME, rel=1e-12)


def resting_gap(options: dict[str, object], preset: str) -> float:
    """Height [m] of a cube given as a hull above a slab given as a hull, after a second of rest."""
    scene, engine = hull_on_slab(), PybulletEngine()
    engine.load(scene, Settings(preset, options), FRAME)
    for frame in range(60):
        record = engine.advance(nobody(scene, frame), FRAME)
    engine.close()
    return float(record.shown.positions[1, 2]) - 0.05


@needs_pybullet
def test_3_hulls_are_not_inflated_when_tuned() -> None:
    """By default two hulls rest 2 mm apart: a margin of 1 mm on each."""
    assert resting_gap({}, "default") > 1.5e-3
    assert abs(resting_gap({}, "tuned")) < 5e-5


@needs_pybullet
@pytest.mark.parametrize("per_second", [240, 1000, 4000])
def test_4_and_5_bounce_survives_small_steps(per_second: int) -> None:
    """Contacts that act early stop a ball, and position correction throws it: neither happens when tuned."""
    ratio, _ = bounce(PybulletEngine(), "tuned", {"dt": 1.0 / per_second})
    assert ratio == pytest.approx(0.3, abs=0.01)


@needs_pybullet
def test_4_default_loses_the_bounce_at_small_steps() -> None:
    """The trap is real."""
    ratio, _ = bounce(PybulletEngine(), "default", {"dt": 1.0 / 4000.0})
    assert ratio < 0.2


@pytest.mark.parametrize("per_second", [60, 240, 1000])
def test_mujoco_bounces_as_stated_when_tuned(per_second: int) -> None:
    ratio, _ = bounce(MujocoEngine(), "tuned", {"dt": 1.0 / per_second})
    # gravity acts once more within the step of the impact
    assert ratio == pytest.approx(0.3, abs=0.01 + 9.81 / per_second / 4.4)


@ENGINES
@pytest.mark.parametrize("preset", ["default", "tuned"])
def test_6_driven_bodies_touch_fixed_ones(engine: Engine, preset: str) -> None:
    """A mocap body against a fixed one makes no contact in MuJoCo, nor a body of mass 0 in PyBullet: it would go 2 cm deep."""
    scene = hand_over_table()
    judge = Judge(scene)
    engine.load(scene, Settings(preset), FRAME)
    deepest = 0.0
    for frame in range(1, 61):
        shown = engine.advance(pressed(frame), FRAME).shown
        deepest = max(deepest, judge.overlaps(shown.positions, shown.orientations).deepest)
    engine.close()
    assert not deepest > 5e-3
    # and it stays on its side: no overlap is also what a hand under the table has
    assert shown.positions[1, 2] > 0.0


def test_8_hinge_limits_hold_when_tuned() -> None:
    """MuJoCo's default limits give way by degrees to a weld that pulls; the tuned ones do not."""
    excess = {}
    for preset, options in (("default", {}), ("tuned", {"clamp_targets": False})):
        engine, scene = MujocoEngine(), arm(wall=False)
        engine.load(scene, Settings(preset, options), FRAME)
        worst = 0.0
        for frame in range(1, 61):
            sample = bent(frame)
            sample.angles[1] = 2.4 + min(0.5, 0.02 * frame)
            worst = max(worst, float(np.abs(engine.advance(sample, FRAME).angles).max()) - 2.4)
        excess[preset] = np.degrees(worst)
    assert excess["default"] > 1.0
    assert excess["tuned"] < 0.5


@ENGINES
def test_10_friction_is_the_same_in_all_directions(engine: Engine) -> None:
    """The pyramid of MuJoCo's default slides 41 % too far on the diagonal."""
    lengths = []
    for degrees in (0.0, 45.0):
        scene = sliding_box(degrees)
        engine.load(scene, Settings("tuned"), FRAME)
        for frame in range(90):
            record = engine.advance(nobody(scene, frame), FRAME)
        engine.close()
        lengths.append(float(np.linalg.norm(record.shown.positions[1, :2])))
        assert np.linalg.norm(record.shown.velocities[1, :2]) < 1e-3
    stop = 2.0**2 / (2.0 * 0.3 * 9.81)
    assert lengths == pytest.approx([stop, stop], rel=0.02)


@needs_pybullet
def test_11_stated_inertias_stay_in_the_multibody_solver() -> None:
    """Told an inertia, a body outside that solver loses its mass and turns to NaN."""
    scene = bodies_of_all_shapes()
    engine = PybulletEngine()
    engine.load(scene, Settings("tuned"), FRAME)
    assert not engine._world.maximal
    for frame in range(10):
        record = engine.advance(nobody(scene, frame), FRAME)
    assert np.isfinite(record.shown.positions).all()
    plain = ball_on_slab()
    engine.load(plain, Settings("tuned"), FRAME)
    assert engine._world.maximal == {1}
    engine.close()


@needs_pybullet
def test_12_pybullet_replays_from_the_start() -> None:
    """saveState and restoreState are not exact to the bit, and are not used; a run from the start is."""
    assert bounce(PybulletEngine(), "tuned", {})[1] == bounce(PybulletEngine(), "tuned", {})[1]


def test_a_diverged_mujoco_is_shown_as_such() -> None:
    """MuJoCo replaces a state that is not finite by the first one, unless told not to."""
    scene, engine = ball_on_slab(), MujocoEngine()
    engine.load(scene, Settings(), FRAME)
    engine._data.qvel[2] = np.nan
    record = engine.advance(nobody(scene, 0), FRAME)
    assert not np.isfinite(record.shown.positions[1, 2])
    assert record.statuses["not_finite"] == 1
    assert any(name.startswith("BAD") for name in record.statuses)


@needs_pybullet
def test_links_come_back_in_the_scene_s_order() -> None:
    """Bullet numbers the links of a tree depth first, whatever order they are given in; see also the parity tests."""
    engine = PybulletEngine()
    scene = Scene("chain", avatars=(chain(),), start=swung(0))
    engine.load(scene, Settings("tuned"), FRAME)
    assert [part.link for part in engine._world.parts] == [0, 1, 2]
    engine.close()


def test_swing_cones_hold_in_mujoco_when_tuned() -> None:
    """A tendon between two points is a cone: against a tracker that goes 0.4 rad beyond it, unclamped."""
    limits = SwingTwist((1.0, 0.0, 0.0), (1.0, 0.0, 0.0), 0.3, (-3.0, 3.0))
    scene, engine = Scene("cone", avatars=(chain(limits),), start=swung(0)), MujocoEngine()
    engine.load(scene, Settings("tuned", {"clamp_targets": False}), FRAME)
    swings: list[float] = []
    for frame in range(1, 121):
        turns = engine.advance(swung(frame, 0.7), FRAME).shown.orientations
        parents = np.vstack([[1.0, 0.0, 0.0, 0.0], turns[:-1]])
        along = rotation.rotate(rotation.multiply(rotation.conjugate(parents), turns), np.array([1.0, 0.0, 0.0]))
        swings.append(float(np.arctan2(np.linalg.norm(along[:, 1:], axis=1), along[:, 0]).max()))
    # it gives way by 2 degrees where the tracker swings fastest, and by less than 0.3 elsewhere
    assert max(swings) < 0.3 + 0.05
    assert np.quantile(swings, 0.9) < 0.305


def test_spinning_box_keeps_its_angular_velocity_in_world_axes() -> None:
    """A free joint of MuJoCo turns about body axes; what is shown is in world axes, as stated at the start."""
    box = (Piece(Box((0.2, 0.2, 0.2))),)
    turn = tuple(float(v) for v in rotation.from_axis_angle((0.0, 0.0, 1.0), 0.7))
    body = simulated("box", box, "wood", solid(box, 1.0), orientation=turn, angular_velocity=(1.0, 0.0, 0.0))  # type: ignore[arg-type]
    scene, engine = Scene("spin", (body,), gravity=(0.0, 0.0, 0.0)), MujocoEngine()
    first = engine.load(scene, Settings(), FRAME)
    later = engine.advance(nobody(scene, 0), FRAME)
    for record in (first, later):
        assert record.shown.angular_velocities[0] == pytest.approx([1.0, 0.0, 0.0], abs=1e-12)


@needs_pybullet
def test_a_floor_of_many_pieces_is_whole() -> None:
    """PyBullet takes 16 pieces for one body and drops the others without a word: a box at the far end then falls."""
    stones = tuple(Piece(Box((0.1, 1.0, 0.2)), (0.1 * k, 0.0, -0.1)) for k in range(40))
    pieces = (Piece(Box((0.3, 0.3, 0.1))),)
    boxes = tuple(simulated(f"box_{x}", pieces, "wood", solid(pieces, 1.0), (x, 0.0, 0.0501)) for x in (0.5, 2.0, 3.5))
    scene = Scene("stones", (fixed("floor", stones, "wood"), *boxes))
    for preset in ("default", "tuned"):
        engine = PybulletEngine()
        engine.load(scene, Settings(preset), FRAME)
        for frame in range(30):
            shown = engine.advance(nobody(scene, frame), FRAME).shown
        engine.close()
        assert shown.positions[1:, 2] == pytest.approx(0.05, abs=2e-3)


@needs_pybullet
def test_a_moving_body_of_more_pieces_than_pybullet_takes_is_refused() -> None:
    pieces = tuple(Piece(Box((0.1, 0.1, 0.1)), (0.1 * k, 0.0, 0.0)) for k in range(17))
    scene = Scene("train", (simulated("train", pieces, "wood", solid(pieces, 1.0), (0.0, 0.0, 1.0)),))
    with pytest.raises(InvalidScene, match="pieces of a moving body or link in PyBullet is 17"):
        PybulletEngine().load(scene, Settings("default"), FRAME)
