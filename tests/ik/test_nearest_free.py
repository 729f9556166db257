"""A posture that the engine shows in contact against the nearest free one.

That one is found offline by scipy's least squares from the shown posture, by the plain kinematics of samples and the judge's
distances alone, which share nothing with an engine's solver: closeness to the user, and a price of overlap.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from avatarsim.engine import Settings
from avatarsim.scene.joint import Ball, Free, Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, link_poses
from avatarsim.simulator import AvatarsimEngine
from avatarsim.spatial import rotation
from reference.judging.judge import Judge
from scenarios import catalog
from scenarios.measure.posture.limits import beyond_cone
from tests.stability.hostile import swing_twist_excess

Array = NDArray[np.float64]

AROUND = 0.3
"""[m] reach in which bodies count: no posture that is searched for is farther from the shown one."""
TURN = 0.1
"""[m] weight of a radian of a joint against a metre of a link's origin: about the reach of an average link."""
PRICE = 1e3
"""Price of the square of an overlap [m] or excess [rad]: with it some hundredths of a millimetre are left."""
FRAME = 245
"""The arm is pressed into the corner."""


@dataclass(frozen=True)
class Search:
    """The user's posture, and where the bodies are: (b, 3) and (b, 4)."""

    scene: Scene
    user: TrackerSample
    places: Array
    turns: Array

    def moved(self, sample: TrackerSample, way: Array) -> TrackerSample:
        """Return the sample after a step of the root [m], of all free and ball joints as rotation vectors, and of all hinges."""
        joints = [link.joint for link in self.scene.links]
        turned = [k for k, joint in enumerate(joints) if isinstance(joint, Free | Ball)]
        limits = np.array([(h.lower, h.upper) for joint in joints if isinstance(joint, Hinges) for h in joint.hinges])
        positions, rotations, hinged = sample.positions.copy(), sample.rotations.copy(), 3 + 3 * len(turned)
        positions[0] += way[:3]
        turns = rotation.from_rotation_vector(way[3:hinged].reshape(-1, 3))
        rotations[turned] = rotation.normalised(rotation.multiply(rotations[turned], turns))
        return replace(sample, positions=positions, rotations=rotations, angles=np.clip(sample.angles + way[hinged:], *limits.T))

    def off(self, sample: TrackerSample) -> Array:
        """Return the way (L, 3) [m] of each link's origin from the user's."""
        return np.asarray(link_poses(self.scene.avatars, sample)[0] - link_poses(self.scene.avatars, self.user)[0])

    def errors(self, judge: Judge, sample: TrackerSample) -> Array:
        """Return numbers whose squares add up to the closeness [m^2] and the price of what is broken."""
        links = self.scene.links
        turned = rotation.to_rotation_vector(rotation.multiply(rotation.conjugate(self.user.rotations), sample.rotations))
        close = self.off(sample).ravel(), TURN * turned.ravel(), TURN * (sample.angles - self.user.angles)
        positions, turns = link_poses(self.scene.avatars, sample)
        first, second, gaps = judge.distances(np.vstack([self.places, positions]), np.vstack([self.turns, turns]))
        overlaps = np.zeros(len(self.scene.names))
        np.add.at(overlaps, judge.pieces.owner[second], np.minimum(gaps, 0.0) ** 2)
        balls = [(k, link.joint) for k, link in enumerate(links) if isinstance(link.joint, Ball)]
        at = [k for k, _ in balls]
        against = rotation.multiply(np.array([links[k].orientation for k in at]), sample.rotations[at])
        shown = Rotation.from_quat(against, scalar_first=True)
        cones = [beyond_cone(b.cone, turn.apply(b.limits.axis)[None])[0]
                 for (_, b), turn in zip(balls, shown, strict=True) if b.cone and b.limits]
        broken = np.concatenate([np.sqrt(overlaps), np.maximum(swing_twist_excess([b for _, b in balls], shown), 0.0), cones])
        return np.concatenate([np.concatenate(close) / np.sqrt(len(links)), np.sqrt(PRICE) * broken])

    def nearest(self, start: TrackerSample) -> TrackerSample:
        """Return the end of the descent from a posture."""
        judge = Judge(self.scene)
        degrees = sum({Free: 6, Ball: 3}.get(type(link.joint), 0) for link in self.scene.links) + len(start.angles)
        found = least_squares(lambda way: self.errors(judge, self.moved(start, way)), np.zeros(degrees), max_nfev=12)
        return self.moved(start, found.x)


def rms(ways: Array) -> float:
    """Return the root mean square length of ways (L, 3) [m]."""
    return float(np.sqrt((ways**2).sum(axis=1).mean()))


def test_an_arm_in_a_corner_is_near_the_nearest_free_posture() -> None:
    scenario = catalog.get("arm_in_corner").as_run(False)
    scene, engine = scenario.build(), AvatarsimEngine()
    motion = scenario.motion(scene, 0)
    engine.load(scene, Settings(), scenario.dt)
    for k in range(FRAME + 1):
        record = engine.advance(motion(k), scenario.dt)
    at, turns, judge = record.shown.positions, record.shown.orientations, Judge(scene)
    near = judge.pieces.owner[np.concatenate(judge.distances(at, turns, AROUND)[:2])]
    kept = [b for b in range(len(scene.bodies)) if b in near]
    around = replace(scene, bodies=tuple(scene.bodies[b] for b in kept))
    search, shown = Search(around, motion(FRAME), at[kept], turns[kept]), engine.posture()
    best = search.nearest(shown)
    judge = Judge(around)
    assert (search.errors(judge, best) ** 2).sum() <= (search.errors(judge, shown) ** 2).sum()
    assert rms(search.off(shown)) <= 2.0 * rms(search.off(best)) + 1e-3
    # the user is inside the wall
    assert rms(search.off(best)) > 1e-3
