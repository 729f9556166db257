"""The body of a user far beyond the limits: at the place that is nearest by the slope of the measure itself, and no faster."""

from dataclasses import replace

import numpy as np
import pytest

from avatarsim.posture.body_place import BACK, BODY, FAR_BEYOND, MOST_MOVED, MOST_TURNED, is_aside, place_bodies
from avatarsim.posture.closeness import locate
from avatarsim.posture.goal import clip_to_limits
from avatarsim.posture.workspace import ASTRAY, BEYOND, Goal
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from avatarsim.world.skeleton import FREE, Posture
from avatarsim.world.world import posture_of
from tests.posture.little_worlds import Little, little, mixed_avatar, random_sample
from tests.posture.ride import ride
from tests.stability.hostile import hinged_avatar

SCENE = Scene("s", (), (mixed_avatar(), replace(mixed_avatar(), name="n")))
WHERE = pytest.mark.parametrize("seed", range(5))


def world(seed: int, beyond: float) -> tuple[Little, Posture]:
    """Two avatars, and a tracker's posture whose hinges are all `beyond` [rad] over a limit and whose balls are anywhere."""
    found = little(SCENE)
    c = found.memory.goal.closeness
    c.turn_weight[c.turn_weight > 0.0] = 0.07
    skel = found.world.skeleton
    sample = random_sample(SCENE.avatars, seed)
    tracker = posture_of(skel, found.world.hinges, sample)
    for j in found.world.hinges.tolist():
        tracker.angle[j] = skel.limits[j, 1] + beyond if j % 2 else skel.limits[j, 0] - beyond
    return found, tracker


def placed(found: Little, tracker: Posture, frames: int = 1) -> Goal:
    """The goal after some frames at a resting tracker."""
    for _ in range(frames):
        clip_to_limits(found.world.skeleton, tracker, found.memory.goal)
        place_bodies(found.world.skeleton, found.memory.goal)
    return found.memory.goal


def roots(found: Little) -> list[int]:
    """Links that are free."""
    return np.flatnonzero(found.world.skeleton.kind == FREE).tolist()


def angle_of(turn: np.ndarray) -> float:
    """Angle [rad] of a rotation matrix."""
    quaternion = rotation.from_matrix(turn)
    return float(2.0 * np.arctan2(np.linalg.norm(quaternion[1:]), abs(quaternion[0])))


def distance(found: Little, tracker: Posture, shift: np.ndarray, turn: np.ndarray, root: int) -> float:
    """Half the squared distance of all link origins and of the weighed angle of one root, its goal moved a little further."""
    g, skel = found.memory.goal, found.world.skeleton
    end = Posture(*(array.copy() for array in g.tracker))
    end.root[root] += shift
    end.turn[root] = rotation.to_matrix(rotation.from_rotation_vector(turn)) @ end.turn[root]
    locate(skel, end, g.closeness)
    here = g.closeness.there.copy()
    locate(skel, tracker, g.closeness)
    angle = angle_of(tracker.turn[root].T @ end.turn[root])
    return 0.5 * float(((here - g.closeness.there) ** 2).sum()) + 0.5 * BODY * 0.07 * angle**2


@pytest.mark.nojit
@WHERE
def test_within_its_reach_a_body_stays_where_the_tracker_has_it(seed: int) -> None:
    found, tracker = world(seed, 0.5)
    for link in np.flatnonzero(found.world.skeleton.kind != FREE).tolist():
        tracker.turn[link] = np.eye(3)
    g = placed(found, tracker, 3)
    for link in roots(found):
        assert g.tracker.root[link].tolist() == tracker.root[link].tolist()
        assert g.tracker.turn[link].tolist() == tracker.turn[link].tolist()


@pytest.mark.nojit
@pytest.mark.boundscheck
@WHERE
def test_where_it_comes_to_rest_the_distance_has_no_slope(seed: int) -> None:
    found, tracker = world(seed, 2.0)
    g = placed(found, tracker, 200)
    assert g.closeness.mode[ASTRAY] == 1.0
    kept = [array.copy() for array in g.tracker]
    for link in roots(found):
        assert np.linalg.norm(g.tracker.root[link] - tracker.root[link]) > 1e-3
        for axis in np.eye(3) * 1e-5:
            for shift, turn in ((axis, 0.0 * axis), (0.0 * axis, axis)):
                slope = distance(found, tracker, shift, turn, link) - distance(found, tracker, -shift, -turn, link)
                assert abs(slope) / 2e-5 < 1e-4
    # the roots alone were moved
    placed(found, tracker)
    assert g.tracker.root == pytest.approx(kept[0], abs=1e-5)
    assert g.tracker.angle.tolist() == np.clip(tracker.angle, *found.world.skeleton.limits.T).tolist()


@pytest.mark.nojit
@WHERE
def test_no_frame_moves_or_turns_it_farther_than_the_cap_there_and_back(seed: int) -> None:
    found, far = world(seed, 2.0)
    _, near = world(seed, -0.1)
    # balls inside their limits too
    near.turn[:] = np.eye(3)
    for link in roots(found):
        near.turn[link] = far.turn[link]
    before, moved = placed(found, near), []
    for tracker in [far] * 40 + [near] * 40:
        root, turn = before.tracker.root.copy(), before.tracker.turn.copy()
        after = placed(found, tracker)
        for link in roots(found):
            moved.append(float(np.linalg.norm(after.tracker.root[link] - root[link])))
            assert moved[-1] <= MOST_MOVED + 1e-12 and angle_of(turn[link].T @ after.tracker.turn[link]) <= MOST_TURNED + 1e-12
    assert max(moved) == pytest.approx(MOST_MOVED)
    for link in roots(found):
        assert after.tracker.root[link].tolist() == near.root[link].tolist()
        assert after.tracker.turn[link].tolist() == near.turn[link].tolist()
        assert not is_aside(link, after)


@pytest.mark.nojit
def test_far_beyond_lasts_until_the_excess_is_well_below() -> None:
    found, tracker = world(0, 0.0)
    tracker.turn[:] = np.eye(3)
    hinges, joints, seen = found.world.hinges, len(found.world.hinges) + 6, []
    for share in (BACK, 0.99 * FAR_BEYOND, 1.01 * FAR_BEYOND, 1.01 * BACK, 0.99 * BACK, 1.01 * BACK):
        # so that the root mean square over all joints is `share`: those that are no hinges count as well
        tracker.angle[hinges] = found.world.skeleton.limits[hinges, 1] + share * np.sqrt(joints / len(hinges))
        g = placed(found, tracker)
        assert np.sqrt(g.closeness.mode[BEYOND]) == pytest.approx(share)
        seen.append(g.closeness.mode[ASTRAY])
    assert seen == [0.0, 0.0, 1.0, 1.0, 0.0, 0.0]


def test_who_is_far_beyond_is_shown_nearer_than_with_the_body_held_and_comes_back() -> None:
    human = hinged_avatar()
    go = ride(Scene("s", (), (human,)))
    home = go.scene.first_sample
    far = replace(home, angles=home.angles + 2.5)
    for _ in range(60):
        go.frame(far)
    held = clipped(go.scene, far)
    shown = np.linalg.norm(go.record.shown.positions - raw(go.scene, far), axis=-1)
    assert np.sqrt((shown**2).mean()) < 0.9 * np.sqrt((held**2).mean())
    for _ in range(30):
        go.frame(home)
    assert go.error(home) < 1e-2


def raw(scene: Scene, sample: TrackerSample) -> np.ndarray:
    """Link origins (L, 3) of a sample as it is."""
    found = little(scene)
    locate(found.world.skeleton, posture_of(found.world.skeleton, found.world.hinges, sample), found.memory.goal.closeness)
    return found.memory.goal.closeness.there.copy()


def clipped(scene: Scene, sample: TrackerSample) -> np.ndarray:
    """Distances (L,) of link origins of a sample inside its limits, its root as it is, from the sample's own."""
    limits = little(scene).world.skeleton.limits[little(scene).world.hinges]
    inside = replace(sample, angles=np.clip(sample.angles, *limits.T))
    return np.asarray(np.linalg.norm(raw(scene, inside) - raw(scene, sample), axis=-1))
