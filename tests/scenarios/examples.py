"""Small scenes and recordings made by hand, so that every figure is known before it is measured."""

from dataclasses import replace

import numpy as np

from avatarsim.scene.avatar import Avatar, Link, rigid_avatar
from avatarsim.scene.body import Body, fixed, simulated, solid
from avatarsim.scene.joint import Ball, Free, Hinge, Hinges, ReachCone, SwingTwist
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample, link_poses, rest
from avatarsim.spatial import rotation
from runfiles.record import EVENTS, Recording
from scenarios.scenario import INFINITE, Bound, Drop, Motion, Region, Scenario

DT = 1.0 / 60.0
RADIUS = 0.1
WALL_FACE = 0.5


def fist_scene() -> Scene:
    """Return a driven ball of radius 0.1 m at the origin and a wall whose face is at x = 0.5 m."""
    pieces = (Piece(Sphere(RADIUS)),)
    wall = fixed("wall", (Piece(Box((1.0, 4.0, 4.0))),), "wood", (WALL_FACE + 0.5, 0.0, 0.0))
    return Scene("fist", (wall,), (rigid_avatar("fist", pieces, solid(pieces, 1.0)),))


def fist_motion(scene: Scene, seed: int) -> Motion:
    """Return a motion towards the wall at 1.2 m/s: 20 mm per frame, into the wall after frame 20, and farther."""

    def sample(frame: int) -> TrackerSample:
        at = rest(scene.avatars, (frame + 1) * DT)
        return replace(at, positions=np.array([[0.02 * (frame + 1), 0.0, 0.0]]))

    return sample


def fist(frames: int = 30) -> Scenario:
    """Return the scenario of the fist into the wall, with the bounds of a scene of the catalogue."""
    return Scenario(
        "fist", "A fist goes into a wall.", "Overlap.", fist_scene, fist_motion, frames,
        bounds=(
            Bound("residual_overlap_max", 1e-6, "nothing overlaps"),
            Bound("still_frames", 50.0, "it moves until it is at the wall"),
            Bound("tracker_offset_rms_free", 1e-3, "it follows"),
        ),
        regions=(Region(("fist",), (-INFINITE,) * 3, (WALL_FACE, INFINITE, INFINITE), "this side of the wall"),),
    )


def arm_scene() -> Scene:
    """Return a free root, an arm on a hinge about y (-30 to 60 degrees), a hand on a ball (swing 45, twist 20 about x)."""
    pieces = (Piece(Sphere(0.05)),)
    mass = solid(pieces, 1.0)
    hinge = Hinges((Hinge((0.0, 1.0, 0.0), np.radians(-30.0), np.radians(60.0)),))
    limits = SwingTwist((1.0, 0.0, 0.0), (1.0, 0.0, 0.0), np.radians(45.0), (np.radians(-20.0), np.radians(20.0)))
    corners = np.array([[1.0, 1.0, 1.0], [1.0, -1.0, 1.0], [1.0, -1.0, -1.0], [1.0, 1.0, -1.0]])
    ball = Ball(limits, ReachCone(corners, (1.0, 0.0, 0.0)))
    links = (
        Link("root", None, Free(), pieces, mass),
        Link("arm", "root", hinge, pieces, mass, anchor=(0.3, 0.0, 0.0)),
        Link("hand", "arm", ball, pieces, mass, anchor=(0.3, 0.0, 0.0)),
    )
    return Scene("arm", (), (Avatar("arm", links),))


def drop_scene() -> Scene:
    """Return a ball of radius 0.1 m and 2 kg, one metre above a slab whose top is at z = 0."""
    pieces = (Piece(Sphere(RADIUS)),)
    ball: Body = simulated("ball", pieces, "wood", solid(pieces, 2.0), (0.0, 0.0, 1.0 + RADIUS))
    return Scene("drop", (fixed("slab", (Piece(Box((1.0, 1.0, 0.2))),), "wood", (0.0, 0.0, -0.1)), ball))


def nobody(scene: Scene, seed: int) -> Motion:
    """Return a sample without an avatar: only the time, no posture."""
    return lambda frame: rest(scene.avatars, (frame + 1) * DT)


def drop(frames: int = 90, restitution: float = 0.3) -> Scenario:
    """Return the scenario of the ball that falls on the slab; the wood's restitution is 0.3."""
    return Scenario(
        "drop", "A ball falls.", "Restitution.", drop_scene, nobody, frames,
        bounds=(Bound("restitution_error_max", 1e-3, "eq. 8"), Bound("apex_error_max", 1e-3, "e^2 h")),
        expects={"drops": (Drop("ball", "slab", restitution, 1.0),)},
    )


def recorded(scene: Scene, samples: list[TrackerSample], dt: float = DT) -> Recording:
    """Return a recording in which bodies rest at their start and links have exactly the tracker's poses.

    `samples` begin with the first state; no snapshots inside frames."""
    f, n, fixed_bodies = len(samples), len(scene.names), len(scene.bodies)
    positions, orientations = np.zeros((f, n, 3)), np.tile(rotation.IDENTITY, (f, n, 1))
    for k, body in enumerate(scene.bodies):
        positions[:, k], orientations[:, k] = body.position, body.orientation
    raw = [link_poses(scene.avatars, sample) for sample in samples]
    raw_positions, raw_orientations = np.array([p for p, _ in raw]), np.array([q for _, q in raw])
    positions[:, fixed_bodies:], orientations[:, fixed_bodies:] = raw_positions, raw_orientations
    angles = np.array([sample.angles for sample in samples]).reshape(f, -1)
    still = np.zeros((f, n, 3))
    return Recording(
        meta={"dt": dt, "scene": scene.name}, times=np.arange(f, dtype=np.float64) * dt, positions=positions,
        orientations=orientations, velocities=still, angular_velocities=still.copy(), angles=angles, raw_positions=raw_positions,
        raw_orientations=raw_orientations, raw_angles=angles.copy(), inside_time=np.zeros(0),
        inside_frame=np.zeros(0, dtype=np.int64), inside_event=np.zeros(0, dtype=np.int64),
        inside_positions=np.zeros((0, n, 3)), inside_orientations=np.zeros((0, n, 4)), inside_velocities=np.zeros((0, n, 3)),
        inside_angular_velocities=np.zeros((0, n, 3)), state_hashes=np.array(["0" * 16] * f),
    )


def resting(scene: Scene, frames: int) -> Recording:
    """Return a recording of the ball at rest."""
    return recorded(scene, [scene.first_sample] * (frames + 1))


def walked(frames: int) -> Recording:
    """Return a recording of a fist that always has the pose of its user, which moves into the wall."""
    scene = fist_scene()
    motion = fist_motion(scene, 0)
    return recorded(scene, [scene.first_sample, *(motion(k) for k in range(frames))])


def expecting(frames: int, **expects: object) -> Scenario:
    """Return a scene without bounds that gives these closed forms."""
    return replace(drop(frames), expects=expects, bounds=())


def with_inside(
    recording: Recording, times: list[float], frames: list[int], events: list[str], positions: np.ndarray, velocities: np.ndarray,
) -> Recording:
    """Return the recording with snapshots inside frames: positions and velocities (S, n, 3), orientations of the first state."""
    s = len(times)
    return replace(
        recording, inside_time=np.array(times), inside_frame=np.array(frames, dtype=np.int64),
        inside_event=np.array([EVENTS.index(event) for event in events], dtype=np.int64), inside_positions=positions,
        inside_velocities=velocities, inside_orientations=np.tile(recording.orientations[0], (s, 1, 1)),
        inside_angular_velocities=np.zeros_like(velocities),
    )
