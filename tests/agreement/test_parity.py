"""One scene in both engines: masses, inertias, vertices, kinematics, contact-free motion."""

from itertools import pairwise

import mujoco
import numpy as np
import pytest

from avatarsim.engine import Engine, FrameRecord, Settings
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import Body, Mass, solid
from avatarsim.scene.joint import Ball, Free, Hinge, Hinges, Rigid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import ConvexHull, Piece, Sphere
from avatarsim.scene.tracker import link_poses, rest
from avatarsim.spatial import rotation
from reference.in_mujoco.engine import MujocoEngine
from reference.in_tracker.engine import RawTracker
from tests.agreement.rivals import ENGINES, PybulletEngine, digits, needs_pybullet, pybullet
from tests.agreement.runs import FRAME, idle, loaded, played
from tests.agreement.scenes import anchored, ball_on_slab, bodies_of_all_shapes, chain, every_joint, posture

PRESETS = pytest.mark.parametrize("preset", ["default", "tuned"])


def same_turn(a: np.ndarray, b: np.ndarray) -> float:
    """Return the largest difference of two sets of quaternions, regardless of sign."""
    return float(np.minimum(np.abs(a - b).max(axis=-1), np.abs(a + b).max(axis=-1)).max())


@ENGINES
@PRESETS
@pytest.mark.parametrize(
    "avatar",
    [every_joint(), chain(), anchored(Rigid()), anchored(Ball()), anchored(Hinges((Hinge((0.0, 1.0, 0.0)),)))],
    ids=["all", "chain", "rigid", "ball", "hinge"],
)
def test_first_pose_is_that_of_the_plain_kinematics(engine: Engine, preset: str, avatar: Avatar) -> None:
    sample = posture(avatar, 0)
    scene = Scene("pose", avatars=(avatar,), start=sample)
    shown = engine.load(scene, Settings(preset), FRAME)
    positions, orientations = link_poses(scene.avatars, sample)
    engine.close()
    near = digits(engine, 1e-12, 2e-7)
    assert np.abs(shown.shown.positions - positions).max() <= near
    assert same_turn(shown.shown.orientations, orientations) <= near
    assert np.abs(shown.angles - sample.angles).max(initial=0.0) <= near


def test_mujoco_has_the_stated_masses_and_inertias() -> None:
    scene = bodies_of_all_shapes()
    engine = loaded(MujocoEngine(), scene, Settings())
    model = engine._world.model
    for body, k in zip(scene.bodies, engine._world.body_ids, strict=True):
        assert body.mass is not None
        axes = rotation.to_matrix(model.body_iquat[k])
        assert model.body_mass[k] == body.mass.mass
        assert np.abs(model.body_ipos[k] - body.mass.centre).max() <= 1e-15
        assert np.abs(axes @ np.diag(model.body_inertia[k]) @ axes.T - body.mass.inertia).max() <= 1e-15


@needs_pybullet
@pytest.mark.parametrize("scene", [bodies_of_all_shapes(), Scene("all", avatars=(every_joint(),))], ids=["bodies", "avatar"])
def test_pybullet_has_the_stated_masses_and_inertias(scene: Scene) -> None:
    engine = loaded(PybulletEngine(), scene, Settings())
    owners: list[Body | Link] = [*scene.bodies, *scene.links]
    for owner, part in zip(owners, engine._world.parts, strict=True):
        mass, _, moments, centre, *_ = pybullet.getDynamicsInfo(part.body, part.link, physicsClientId=engine._client)
        axes = rotation.to_matrix(part.frame)
        assert owner.mass is not None
        assert mass == owner.mass.mass
        assert np.abs(axes @ np.array(centre) - owner.mass.centre).max() <= 1e-15
        assert np.abs(axes @ np.diag(moments) @ axes.T - owner.mass.inertia).max() <= 1e-15
    engine.close()


def test_mujoco_meshes_are_where_the_scene_has_them() -> None:
    """MuJoCo moves every mesh to its centre of mass; a hull must still keep its place."""
    scene = bodies_of_all_shapes()
    engine = MujocoEngine()
    shown = engine.load(scene, Settings(), FRAME).shown
    model, data = engine._world.model, engine._data
    for k, i in ((3, 0), (4, 0)):
        geom = model.geom(f"g{k}.{i}").id
        mesh = model.geom_dataid[geom]
        first, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
        found = data.geom_xpos[geom] + model.mesh_vert[first : first + count] @ data.geom_xmat[geom].reshape(3, 3).T
        piece = scene.bodies[k].pieces[i]
        assert isinstance(piece.shape, ConvexHull)
        inside = rotation.rotate(piece.orientation, piece.shape.vertices) + np.array(piece.position)
        wanted = rotation.rotate(shown.orientations[k], inside) + shown.positions[k]
        # vertices are kept in single precision: 6e-8 of a tenth of a metre, a few times over
        assert max(np.abs(found - v).max(axis=1).min() for v in wanted) <= 1e-7
        assert model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_MESH


@needs_pybullet
def test_pybullet_hulls_are_where_the_scene_has_them() -> None:
    """A tiny ball 0.2 m outside a vertex has that distance, to the 0.1 mm of Bullet's own measurement."""
    scene = bodies_of_all_shapes()
    engine = PybulletEngine()
    shown = engine.load(scene, Settings("tuned"), FRAME).shown
    client = engine._client
    radius = 1e-3
    ball = pybullet.createCollisionShape(pybullet.GEOM_SPHERE, radius=radius, physicsClientId=client)
    probe = pybullet.createMultiBody(0.0, ball, physicsClientId=client)
    for k in (3, 4):
        piece, part = scene.bodies[k].pieces[0], engine._world.parts[k]
        assert isinstance(piece.shape, ConvexHull)
        points = rotation.rotate(piece.orientation, piece.shape.vertices) + np.array(piece.position)
        points = rotation.rotate(shown.orientations[k], points) + shown.positions[k]
        middle = points.mean(axis=0)
        found = []
        for point in points:
            out = (point - middle) / np.linalg.norm(point - middle)
            pybullet.resetBasePositionAndOrientation(probe, (point + 0.2 * out).tolist(), [0, 0, 0, 1], physicsClientId=client)
            near = pybullet.getClosestPoints(probe, part.body, 1.0, physicsClientId=client)
            distance = min(contact[8] for contact in near) - (0.2 - radius)
            assert distance <= 1e-4
            # the vertex itself is nearest where it is the support in that direction; the second body has another piece
            if k == 3 and (points @ out).max() == point @ out:
                found.append(distance)
        assert k != 3 or (len(found) >= 5 and np.abs(found).max() <= 1e-4)
    engine.close()


@ENGINES
@PRESETS
def test_free_fall_is_right_to_the_order_of_the_integrator(engine: Engine, preset: str) -> None:
    """Semi-implicit Euler falls g t h / 2 farther than the law, where h is the step; nothing else may differ."""
    scene = ball_on_slab(height=5.0)
    options = {"damping": 0.0} if engine.name == "pybullet" else {}
    record = played(engine, scene, idle(scene, 30), Settings(preset, options))[-1]
    # Rapier's solver iterations are substeps of velocities and positions
    t, step = 30 * FRAME, FRAME / record.counts["steps"] / (4 if engine.name == "rapier" else 1)
    assert record.shown.time == pytest.approx(t, rel=1e-12)
    assert record.shown.positions[1, 2] == pytest.approx(5.05 - 0.5 * 9.81 * t * (t + step), abs=digits(engine, 1e-9, 1e-4))
    assert record.shown.velocities[1, 2] == pytest.approx(-9.81 * t, abs=digits(engine, 1e-9, 1e-4))


def centre_and_momentum(record: FrameRecord, body: int, mass: Mass) -> tuple[np.ndarray, np.ndarray]:
    """Return the centre of mass [m] and the angular momentum about it, in world axes."""
    shown = record.shown
    turn = rotation.to_matrix(shown.orientations[body])
    return shown.positions[body] + turn @ np.array(mass.centre), turn @ mass.inertia @ turn.T @ shown.angular_velocities[body]


@ENGINES
def test_skewed_bodies_spin_alike(engine: Engine) -> None:
    """Without forces mass centres move straight on, and angular momentum changes only by the integrator's error."""
    scene = bodies_of_all_shapes()
    records = played(engine, scene, idle(scene, 30), Settings("tuned"))
    t = 30 * FRAME
    for k, body in enumerate(scene.bodies):
        assert body.mass is not None
        (at, momentum), (later, after) = (centre_and_momentum(record, k, body.mass) for record in (records[0], records[-1]))
        # MuJoCo moves the frame's origin, whose path is curved: an error of the order of the step; in single precision steps are
        # rounded 8 m from the origin
        assert np.abs(later - at - t * np.array(body.velocity)).max() <= digits(engine, 1e-5, 4e-3)
        assert np.abs(records[0].shown.velocities[k] - body.velocity).max() <= digits(engine, 1e-12, 1e-7)
        assert np.abs(records[0].shown.angular_velocities[k] - body.angular_velocity).max() <= digits(engine, 1e-12, 1e-7)
        assert np.linalg.norm(after - momentum) <= 0.01 * np.linalg.norm(momentum)


@ENGINES
@PRESETS
def test_steps_inside_a_frame_are_recorded_in_order(engine: Engine, preset: str) -> None:
    scene = ball_on_slab()
    record = played(engine, scene, idle(scene, 1), Settings(preset, record_inside=True))[-1]
    times = [snapshot.time for snapshot in record.inside]
    assert len(times) == record.counts["steps"]
    assert all(a < b for a, b in pairwise(times))
    assert times[-1] == pytest.approx(FRAME, rel=1e-12)
    assert record.inside[-1].positions.tobytes() == record.shown.positions.tobytes()
    heights = [snapshot.positions[1, 2] for snapshot in record.inside]
    assert all(a > b for a, b in pairwise(heights))


def test_raw_tracker_shows_the_plain_kinematics() -> None:
    avatar = every_joint()
    scene = Scene("raw", bodies_of_all_shapes().bodies, (avatar,), start=posture(avatar, 0))
    engine = RawTracker()
    assert isinstance(engine, Engine)
    assert set(engine.unsupported(scene)) == {"contact", "dynamics"}
    engine.load(scene, Settings(record_inside=True), FRAME)
    sample = posture(avatar, 1, FRAME)
    record = engine.advance(sample, FRAME)
    positions, orientations = link_poses(scene.avatars, sample)
    first = len(scene.bodies)
    assert np.abs(record.shown.positions[first:] - positions).max() <= 1e-15
    assert same_turn(record.shown.orientations[first:], orientations) <= 1e-15
    assert np.abs(record.shown.positions[:first] - [body.position for body in scene.bodies]).max() == 0.0
    assert len(record.inside) == 1


@ENGINES
@PRESETS
def test_links_without_shapes_go_along(engine: Engine, preset: str) -> None:
    """A root that is only a frame, and a joint without shape between two limbs."""
    ball, mass = (Piece(Sphere(0.1)),), Mass(1.0)
    sparse = Avatar("chain", (
        Link("root", None, Free(), (), mass), Link("upper", "root", Ball(), ball, solid(ball, 1.0), anchor=(0.0, 0.0, 0.3)),
        Link("elbow", "upper", Hinges((Hinge((1.0, 0.0, 0.0)),)), (), mass, anchor=(0.0, 0.0, 0.3)),
        Link("lower", "elbow", Ball(), ball, solid(ball, 1.0), anchor=(0.0, 0.0, 0.3)),
    ))
    scene = Scene("chain", (), (sparse,), gravity=(0.0, 0.0, 0.0))
    shown = played(engine, scene, [rest((sparse,))] * 3, Settings(preset))[-1].shown
    assert shown.positions[:, 2] == pytest.approx([0.0, 0.3, 0.6, 0.9], abs=1e-6)
