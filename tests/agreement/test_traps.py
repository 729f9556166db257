"""Each trap that would silently falsify the comparison, avoided by the adapters."""

import numpy as np
import pytest

from avatarsim.engine import Settings
from avatarsim.errors import InvalidScene
from avatarsim.scene.body import fixed, simulated, solid
from avatarsim.scene.joint import SwingTwist
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from reference.in_mujoco.engine import MujocoEngine
from scenarios import catalog
from scenarios.catalog.hard.other_numbers import STACK
from tests.agreement.rivals import PybulletEngine, needs_pybullet, pybullet
from tests.agreement.runs import FRAME, idle, limit_excess, loaded, of_catalog, played
from tests.agreement.scenes import arm, ball_on_slab, bent, bodies_of_all_shapes, chain, hand_over_table, hull_on_slab, swung


@needs_pybullet
def test_1_breaking_threshold_left_by_others_is_overruled() -> None:
    """The setting is global to the process and survives resetSimulation and disconnect."""
    def last_state() -> str:
        return played(PybulletEngine(), ball_on_slab(), idle(ball_on_slab(), 40), Settings("default"))[-1].state_hash()

    fresh = last_state()
    other = pybullet.connect(pybullet.DIRECT)
    pybullet.setPhysicsEngineParameter(contactBreakingThreshold=1e-4, physicsClientId=other)
    pybullet.disconnect(other)
    assert last_state() == fresh


def resting_gap(preset: str) -> float:
    """Return the height [m] of a cube given as a hull above a slab given as a hull, after a second of rest."""
    scene = hull_on_slab()
    return float(played(PybulletEngine(), scene, idle(scene, 60), Settings(preset))[-1].shown.positions[1, 2]) - 0.05


@needs_pybullet
def test_3_hulls_are_not_inflated_when_tuned() -> None:
    """By default two hulls rest 2 mm apart: a margin of 1 mm on each."""
    assert resting_gap("default") > 1.5e-3
    assert abs(resting_gap("tuned")) < 5e-5


def test_8_hinge_limits_hold_when_tuned() -> None:
    """MuJoCo's default limits yield by degrees to the pull of a weld; the tuned ones do not."""
    excess = {}
    samples = [bent(frame) for frame in range(1, 61)]
    for frame, sample in enumerate(samples, 1):
        sample.angles[1] = 2.4 + min(0.5, 0.02 * frame)
    for settings in (Settings("default"), Settings("tuned", {"clamp_targets": False})):
        records = played(MujocoEngine(), arm(wall=False), samples, settings)[1:]
        excess[settings.preset] = np.degrees(max(np.abs(record.angles).max() for record in records) - 2.4)
    assert excess["default"] > 1.0
    assert excess["tuned"] < 0.5


@needs_pybullet
def test_11_stated_inertias_stay_in_the_multibody_solver() -> None:
    """With a given inertia, a body outside that solver loses its mass and its state becomes NaN."""
    scene, engine = bodies_of_all_shapes(), PybulletEngine()
    engine.load(scene, Settings("tuned"), FRAME)
    assert not engine._world.maximal
    assert np.isfinite(played(engine, scene, idle(scene, 10), Settings("tuned"))[-1].shown.positions).all()
    engine.load(ball_on_slab(), Settings("tuned"), FRAME)
    assert engine._world.maximal == {1}
    engine.close()


def test_a_diverged_mujoco_is_shown_as_such() -> None:
    """By default MuJoCo replaces a state that is not finite by the first one."""
    scene, engine = ball_on_slab(), MujocoEngine()
    engine.load(scene, Settings(), FRAME)
    engine._data.qvel[2] = np.nan
    record = engine.advance(idle(scene, 1)[0], FRAME)
    assert not np.isfinite(record.shown.positions[1, 2])
    assert record.statuses["not_finite"] == 1
    assert any(name.startswith("BAD") for name in record.statuses)


def test_swing_cones_hold_in_mujoco_when_tuned() -> None:
    """A tendon between two points acts as a cone, here against an unclamped tracker 0.4 rad beyond it."""
    limits = SwingTwist((1.0, 0.0, 0.0), (1.0, 0.0, 0.0), 0.3, (-3.0, 3.0))
    scene = Scene("cone", avatars=(chain(limits),), start=swung(0))
    samples = [swung(frame, 0.7) for frame in range(1, 121)]
    excess = limit_excess(scene, played(MujocoEngine(), scene, samples, Settings("tuned", {"clamp_targets": False}))[1:])
    # it yields by 2 degrees where the tracker swings fastest, and by less than 0.3 elsewhere
    assert np.radians(excess.max()) < 0.05
    assert np.radians(np.quantile(excess, 0.9)) < 0.005


@needs_pybullet
@pytest.mark.parametrize("preset", ["default", "tuned"])
def test_a_floor_of_many_pieces_is_whole(preset: str) -> None:
    """PyBullet takes 16 pieces for one body and ignores the others silently: a box at the far end then falls."""
    stones = tuple(Piece(Box((0.1, 1.0, 0.2)), (0.1 * k, 0.0, -0.1)) for k in range(40))
    pieces = (Piece(Box((0.3, 0.3, 0.1))),)
    boxes = tuple(simulated(f"box_{x}", pieces, "wood", solid(pieces, 1.0), (x, 0.0, 0.0501)) for x in (0.5, 2.0, 3.5))
    scene = Scene("stones", (fixed("floor", stones, "wood"), *boxes))
    shown = played(PybulletEngine(), scene, idle(scene, 30), Settings(preset))[-1].shown
    assert shown.positions[1:, 2] == pytest.approx(0.05, abs=2e-3)


@needs_pybullet
def test_refuses_more_pieces_than_pybullet_takes() -> None:
    pieces = tuple(Piece(Box((0.1, 0.1, 0.1)), (0.1 * k, 0.0, 0.0)) for k in range(17))
    scene = Scene("train", (simulated("train", pieces, "wood", solid(pieces, 1.0), (0.0, 0.0, 1.0)),))
    with pytest.raises(InvalidScene, match="17"):
        PybulletEngine().load(scene, Settings("default"), FRAME)


@pytest.mark.parametrize(("name", "edge", "options", "stands"), [
    ("scale_mm", 2e-4, {}, True), ("scale_km", 2e2, {}, True), ("scale_mm", 2e-4, {"tolerance": 1e-8}, False),
])
def test_mujoco_s_stacks_stand_at_any_size(name: str, edge: float, options: dict[str, object], stands: bool) -> None:
    """The solver must not stop where forces are small; with its default tolerance a stack of 0.2 mm collapses."""
    scene, records = of_catalog(MujocoEngine(), name, Settings("tuned", options), 30)
    boxes = [scene.names.index(box) for box in STACK]
    drift = np.abs(records[-1].shown.positions[boxes] - records[0].shown.positions[boxes]).max()
    assert (drift < 1e-3 * edge) if stands else (drift > 0.01 * edge)


@pytest.mark.parametrize("preset", ["default", "tuned"])
@pytest.mark.parametrize("scene", [hand_over_table(), arm()], ids=["hand", "arm"])
def test_9_no_scene_is_driven_by_an_actuator(scene: Scene, preset: str) -> None:
    """Links are welded to mocap bodies: without a servo there is no damping outside the constraint that a step would omit."""
    engine = loaded(MujocoEngine(), scene, Settings(preset))
    model = engine._world.model
    assert model.nu == 0 and model.neq >= len(scene.links)
    assert not model.dof_damping.any()
    engine.close()


def test_mujoco_eliminates_bodies_before_their_lift() -> None:
    """The solver eliminates the last velocity first; a lift listed before its load couples all of it, at 100 times the cost."""
    scenario = catalog.get("lift")
    engine = loaded(MujocoEngine(), scenario.build(), Settings("tuned"), scenario.dt)
    model, (_, _, velocities) = engine._model, engine._world.free
    driven = [int(model.body_dofadr[b]) for b in engine._world.body_ids[len(engine._scene.bodies) :]]
    assert max(driven) < min(velocities)
