"""Two recordings made by hand: which frames count, and which is nearer."""

from dataclasses import replace

import numpy as np
import pytest

from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import simulated, solid
from avatarsim.scene.joint import Free, Hinge, Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Capsule, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample, rest
from reference.judging.judge import Judge
from runfiles.record import Recording
from scenarios.beside.pair import ALIKE, compared
from tests.scenarios.examples import WALL_FACE, fist, fist_motion, fist_scene, recorded

SCENE = fist_scene()


def shown(stops: float) -> Recording:
    """The user's fist goes into the wall; the one shown stops with its centre at x = `stops` [m]."""
    motion = fist_motion(SCENE, 0)
    recording = recorded(SCENE, [SCENE.first_sample, *(motion(k) for k in range(30))])
    positions = recording.positions.copy()
    positions[:, 1, 0] = np.minimum(positions[:, 1, 0], stops)
    return replace(recording, positions=positions)


def test_all_frames_count_while_at_most_a_millimetre_is_left() -> None:
    found = compared(shown(0.4), shown(0.4009), fist(), SCENE, Judge(SCENE))
    assert (found.frames, found.counted, found.winner) == (30, 30, ("theirs", "same"))
    # the user is up to 0.2 m beyond 0.4
    beyond = np.maximum(0.02 * np.arange(1, 31) - 0.4, 0.0)
    assert found.offset == pytest.approx(np.sqrt(np.mean(beyond**2)), abs=1e-12)


def test_frames_with_more_overlap_do_not_count() -> None:
    found = compared(shown(0.4), shown(0.405), fist(), SCENE, Judge(SCENE))
    # 0.41 would be the 21st frame's; from there on 5 mm are left
    assert found.counted == 20 and found.winner == ("same", "same")


def test_frames_on_the_wrong_side_do_not_count() -> None:
    through = shown(0.4)
    positions = through.positions.copy()
    positions[25:, 1, 0] = WALL_FACE + 2.0
    found = compared(shown(0.39), replace(through, positions=positions), fist(), SCENE, Judge(SCENE))
    assert found.counted == 24 and found.winner == ("theirs", "same")


def test_no_numbers_do_not_count_and_nothing_is_nobodys() -> None:
    broken = shown(0.4)
    positions = np.full_like(broken.positions, np.nan)
    found = compared(shown(0.4), replace(broken, positions=positions), fist(), SCENE, Judge(SCENE))
    assert found.counted == 0 and found.winner == ("-", "-")


def test_ours_is_not_asked_which_frames_count() -> None:
    # ours deep in the wall wins nothing by leaving more overlap: the frames are theirs
    found = compared(shown(0.5), shown(0.4), fist(), SCENE, Judge(SCENE))
    assert found.counted == 30 and found.winner[0] == "ours"


def test_frames_in_which_theirs_leaves_the_limits_are_left_out_of_the_kept_ones() -> None:
    bar = (Piece(Capsule(0.04, 0.3), (0.0, 0.0, -0.15)),)
    elbow = Link("arm", "root", Hinges((Hinge((1.0, 0.0, 0.0), -0.5, 0.5),)), bar, solid(bar, 1.0), anchor=(0.0, 0.0, -0.5))
    avatar = Avatar("a", (Link("root", None, Free(), bar, solid(bar, 1.0)), elbow))
    scene, first = Scene("bend", (), (avatar,)), rest((avatar,))

    def bent(limit: float) -> Recording:
        samples = [TrackerSample(k / 60.0, first.positions, first.rotations, np.array([min(0.1 * k, limit)])) for k in range(11)]
        return recorded(scene, samples)

    ours, theirs = bent(0.45), replace(bent(9.0), raw_angles=bent(9.0).raw_angles)
    ours = replace(ours, raw_positions=theirs.raw_positions, raw_orientations=theirs.raw_orientations)
    found = compared(ours, theirs, replace(fist(), regions=()), scene, Judge(scene))
    # bent by 0.1 to 1.0 in ten frames, of which five are within 0.5; ours stops at 0.45
    assert (found.counted, found.kept.frames, found.winner, found.kept.winner) == (10, 5, ("same", "theirs"), ("same", "theirs"))
    assert found.kept.angle == pytest.approx(np.degrees(0.05 / np.sqrt(10.0)), abs=1e-9)
    assert found.kept.their_angle == pytest.approx(0.0, abs=1e-6) and found.kept.offset < found.offset + 1e-12


@pytest.mark.parametrize(("frames", "lost", "alike"), [(30, False, 1), (8, False, 1), (8, True, 0)])
def test_frames_in_which_a_loose_body_is_elsewhere_are_left_out_of_those_alike(frames: int, lost: bool, alike: int) -> None:
    pieces = (Piece(Sphere(0.1)),)
    ball = simulated("ball", pieces, "wood", solid(pieces, 1.0), (0.0, 3.0, 0.0))
    scene = replace(SCENE, bodies=(*SCENE.bodies, ball))
    motion, fist_at, ball_at = fist_motion(scene, 0), len(scene.bodies), len(SCENE.bodies)

    def shown(stops: float, falls: float, frames: int) -> Recording:
        recording = recorded(scene, [scene.first_sample, *(motion(k) for k in range(frames))])
        positions = recording.positions.copy()
        positions[:, fist_at, 0] = np.minimum(positions[:, fist_at, 0], stops)
        positions[:, ball_at, 2] -= falls * np.arange(frames + 1)
        return replace(recording, positions=positions)

    # theirs is at the user's and its ball falls away, by 0.9 of the bound a frame more than ours; it may end early
    ours, theirs = shown(0.01, 0.1 * ALIKE, 30), shown(0.4, ALIKE, frames)
    if lost:
        theirs.positions[1, ball_at, 2] = np.nan
    found = compared(ours, theirs, fist(), scene, Judge(scene))
    assert found.winner[0] == "theirs" and (found.frames, found.alike.frames) == (frames, alike)
    assert found.alike.winner == (("theirs", "same") if alike else ("-", "-"))
    if alike:
        assert (found.alike.offset, found.alike.their_offset) == (pytest.approx(0.01, abs=1e-12), pytest.approx(0.0, abs=1e-12))


def test_without_loose_bodies_all_frames_are_alike() -> None:
    found = compared(shown(0.4), shown(0.4009), fist(), SCENE, Judge(SCENE))
    assert (found.alike.frames, found.alike.winner) == (found.counted, found.winner)
