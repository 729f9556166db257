"""Cleaning of whole clips: nothing overlaps in frames or between, free frames stay to the bit, the rest is reported."""

import sys
from dataclasses import replace

import numpy as np
import pytest

from avatarsim.assets.models.model import Model
from avatarsim.cleaning import Audit, Cleaned, Options, audit, clean
from avatarsim.errors import InvalidInput, StartOverlaps
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import Body, fixed, simulated, solid
from avatarsim.scene.joint import Hinge, Hinges
from avatarsim.scene.motion import Motion
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Piece, Sphere
from avatarsim.scene.tracker import poses_of_links
from avatarsim.spatial import rotation
from benchmarks.cleaning import between, depths
from reference.judging.judge import Judge
from tests.cleaning.rooms import FLOOR, dipping, lowered, model, swinging, walker, wall

OPTIONS = Options(opinion=False)


def require_clean(cleaned: Cleaned, *bodies: Body) -> None:
    """Nothing overlaps, by our own proof and by the judge that shares no code with it."""
    assert cleaned.after.is_clean and cleaned.after.unproven == 0 and cleaned.after.limit_excess <= 1e-9
    plain = tuple(replace(body, material="wood") for body in bodies)
    judge = Judge(Scene("judged", plain, (walker(),)))
    assert depths(judge, cleaned.motion).max() <= 1e-6
    assert depths(judge, between(cleaned.motion)).max() <= 1e-6


def on_the_floor(motion: Motion) -> Cleaned:
    """Return a motion of the walker on the floor as it is cleaned; it is clean."""
    cleaned = clean(motion, model(), (FLOOR,), OPTIONS)
    require_clean(cleaned, FLOOR)
    return cleaned


def same(one: Motion, other: Motion) -> np.ndarray:
    """Return (F,) frames that are equal to the bit."""
    pairs = (one.positions, other.positions), (one.rotations, other.rotations), (one.angles, other.angles)
    return np.all([(a == b).reshape(len(a), -1).all(axis=1) for a, b in pairs], axis=0)


def test_a_dip_into_the_floor_is_lifted_and_the_rest_stays() -> None:
    motion, told = dipping(), list[float]()
    cleaned = clean(motion, model(), (FLOOR,), OPTIONS, told.append)
    require_clean(cleaned, FLOOR)
    assert cleaned.before.overlapping > 5 and cleaned.before.deepest > 0.01
    assert np.array_equal(~cleaned.changed, same(motion, cleaned.motion))
    assert not cleaned.changed[:20].any() and not cleaned.changed[70:].any() and cleaned.changed[40:50].all()
    assert cleaned.after.jerk_free <= 1.5 * cleaned.before.jerk_free
    assert told == sorted(told) and told[-1] == 1.0
    assert {one.why for one in cleaned.flagged} <= {"overlap", "blend", "catching up", "held back"}
    assert any(one.why == "overlap" and one.pair is not None and one.pair[0] == "floor" for one in cleaned.flagged)
    covered = np.zeros(90, dtype=bool)
    for one in cleaned.flagged:
        covered[one.first : one.last + 1] = True
    assert np.array_equal(covered, cleaned.changed)


def test_a_free_motion_comes_back_to_the_bit() -> None:
    motion = swinging(60, 1.0)
    cleaned = clean(motion, model(), (FLOOR,), OPTIONS)
    assert same(motion, cleaned.motion).all() and not cleaned.changed.any() and cleaned.flagged == ()
    assert cleaned.moved.link_rms.max() == 0.0 and cleaned.moved.joint_p95.max() == 0.0


def test_a_start_that_overlaps_is_freed_backwards() -> None:
    motion = lowered(swinging(60, 0.5), np.linspace(-0.3, 0.3, 60))
    cleaned = on_the_floor(motion)
    assert cleaned.before.depths[0] > 0.1 and cleaned.changed[0] and not cleaned.changed[-1]
    # near the input, not merely free: in the first frame it is upright on the floor
    assert 0.0 < cleaned.motion.positions[0, 0, 2] < 0.45


def test_a_motion_without_any_free_frame_is_lifted_out() -> None:
    motion = swinging(45, 0.2)
    cleaned = on_the_floor(motion)
    assert cleaned.changed.all() and np.isnan(cleaned.before.jerk_free)
    assert cleaned.motion.positions[:, 0, 2].max() < 0.6


def test_an_avatar_that_nothing_frees_is_refused_with_the_pair() -> None:
    palm = (Piece(Sphere(0.1)),)
    stuck = walker()
    links = (stuck.links[0], *(replace(link, joint=stuck.links[2].joint, anchor=(0.0, 0.0, 0.0)) for link in stuck.links[1:]))
    tied = replace(stuck, links=tuple(replace(link, pieces=palm) for link in links))
    motion = swinging(10, 0.5)
    motion = Motion(motion.times, motion.positions, motion.rotations, np.repeat(motion.angles, 2, axis=1))
    with pytest.raises(StartOverlaps, match="walker/left in walker/right"):
        clean(motion, Model(tied, None, (), ()), (), OPTIONS)


def test_a_user_behind_a_wall_is_flagged_as_unreachable() -> None:
    motion = swinging(120, 1.0, along=4.0)
    cleaned = clean(motion, model(), (wall(2.0),), OPTIONS)
    require_clean(cleaned, wall(2.0))
    last = cleaned.flagged[-1]
    assert last.why == "unreachable" and last.last == 119 and motion.times[last.first] < 3.0
    assert cleaned.motion.positions[:, 0, 0].max() < 1.9


def test_joints_outside_their_limits_are_brought_within() -> None:
    motion = swinging(60, 1.0, swing=1.5)
    cleaned = clean(motion, model(), (), OPTIONS)
    assert cleaned.before.limit_excess == pytest.approx(0.3, abs=1e-2) and cleaned.after.limit_excess == 0.0
    assert cleaned.changed.any() and not cleaned.changed.all() and "limits" in {one.why for one in cleaned.flagged}


def test_limbs_give_way_before_contact_with_blend_alone() -> None:
    motion = dipping()
    early, late = (clean(motion, model(), (FLOOR,), replace(OPTIONS, blend=blend)) for blend in (0.1, 0.0))
    assert np.argmax(early.changed) < np.argmax(late.changed)
    assert early.after.jerk_held < late.after.jerk_held
    require_clean(late, FLOOR)


def test_free_frames_keep_the_input_where_jerk_allows() -> None:
    times = np.arange(90)
    motion = lowered(swinging(90, 0.5), -0.2 * np.exp(-(((times - 45) / 1.5) ** 2)))
    cleaned = on_the_floor(motion)
    assert cleaned.changed.any() and np.array_equal(cleaned.changed, cleaned.held)
    assert np.array_equal(same(motion, cleaned.motion), ~cleaned.held)
    assert cleaned.after.jerk_free <= 1.5 * cleaned.before.jerk_free


def test_loose_bodies_stand_still_or_are_left_out() -> None:
    block = (Piece(Box((0.3, 2.0, 0.3))),)
    loose = simulated("block", block, "wood", solid(block, 1.0), (1.0, 0.0, 0.2))
    motion = swinging(60, 0.5, along=2.0)
    with_block = replace(model(), bodies=(loose,))
    assert clean(motion, with_block, (), OPTIONS).before.overlapping > 0
    assert clean(motion, with_block, (), replace(OPTIONS, loose=True)).before.overlapping == 0


def test_pairs_that_the_file_excludes_may_overlap_and_only_those() -> None:
    block = fixed("block", (Piece(Box((0.3, 2.0, 0.3))),), "wood", (1.0, 0.0, 0.2))
    names = ("walker/trunk", "walker/left", "walker/right")
    with_block = replace(model(), bodies=(block,), exclude=tuple((name, "block") for name in names))
    motion = swinging(60, 0.5, along=2.0)
    found = audit(motion, with_block, (replace(block, position=(50.0, 0.0, 0.0)),), OPTIONS)
    assert found.overlapping == 0 and max(one.depth for one in found.excluded) > 0.1
    # a body of the room that only shares the name is not excluded
    found = audit(motion, replace(with_block, bodies=()), (block,), OPTIONS)
    assert found.overlapping > 0 and found.excluded == ()


def bolted() -> Model:
    """Return an arm of two links on the ground, without a root that could be lifted."""
    rod = (Piece(Capsule(0.04, 0.4), (0.0, 0.0, 0.25)),)
    upper = Link("upper", None, Hinges((Hinge((0.0, 1.0, 0.0), -2.0, 2.0),)), rod, solid(rod, 1.0), anchor=(0.0, 0.0, 0.1))
    lower = Link("lower", "upper", Hinges((Hinge((0.0, 1.0, 0.0), -2.0, 2.0),)), rod, solid(rod, 1.0), anchor=(0.0, 0.0, 0.5))
    return Model(Avatar("arm", (upper, lower)), None, (), ())


def bent(angles: np.ndarray) -> Motion:
    """Return the arm with these angles (F, 2)."""
    frames = len(angles)
    return Motion(np.arange(frames) / 30.0, np.zeros((frames, 2, 3)), np.tile((1.0, 0.0, 0.0, 0.0), (frames, 2, 1)), angles)


@pytest.mark.parametrize("first", [0.0, 1.6])
def test_an_arm_that_is_bolted_down_slides_along_a_wall(first: float) -> None:
    """Also from a first posture within the wall, where there is no root to lift."""
    motion = bent(np.stack([np.linspace(first, 1.6, 60), np.full(60, 0.3)], axis=1))
    cleaned = clean(motion, bolted(), (wall(0.6),), OPTIONS)
    assert cleaned.after.is_clean and cleaned.after.unproven == 0 and cleaned.before.deepest > 0.1
    assert cleaned.changed[0] == (first > 0.0) and cleaned.changed[-1]
    assert cleaned.motion.angles[-1, 0] > 0.5


def crossed() -> Motion:
    """Return legs that swing into each other."""
    motion = swinging(30, 1.0, swing=0.0)
    rotations = motion.rotations.copy()
    rotations[:, 1] = (np.cos(0.3), np.sin(-0.3), 0.0, 0.0)
    return Motion(motion.times, motion.positions, rotations, motion.angles)


def test_excluded_pairs_are_measured() -> None:
    ignoring = Model(replace(walker(), ignore=(("left", "right"),)), None, (), ())
    found = audit(crossed(), ignoring, (), OPTIONS)
    (pair,) = found.excluded
    assert (pair.a, pair.b) == ("walker/left", "walker/right") and pair.depth > 0.005 and found.overlapping == 0
    seen = audit(crossed(), model(), (), OPTIONS)
    assert seen.deepest == pytest.approx(pair.depth) and seen.deepest_pair == ("walker/left", "walker/right")


def test_an_audit_measures_what_the_judge_measures() -> None:
    motion = dipping()
    found: Audit = audit(motion, model(), (FLOOR,))
    judge = Judge(Scene("judged", (replace(FLOOR, material="wood"),), (walker(),)))
    assert np.allclose(found.depths, depths(judge, motion), atol=1e-7)
    assert found.opinion is not None and found.opinion.frames == 90 and found.opinion.between == 89 * 9
    assert found.opinion.frames_overlapping == found.overlapping
    assert found.opinion.between_overlapping == int(np.sum(depths(judge, between(motion)) > 1e-6))
    assert found.opinion.frames_deepest == pytest.approx(found.deepest, abs=1e-7) and not found.is_clean


def test_without_a_second_engine_there_is_no_second_opinion(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "coal", None)
    found = audit(dipping(), model(), (FLOOR,))
    assert found.opinion is None and found.said and found.overlapping > 0


def test_how_far_a_motion_was_moved_is_that_of_its_links() -> None:
    motion = dipping()
    cleaned = clean(motion, model(), (FLOOR,), OPTIONS)
    moved = cleaned.moved
    assert moved.links == ("trunk", "left", "right") and moved.joints == ("trunk", "left", "right")
    places = [poses_of_links((walker(),), one.positions, one.rotations, one.angles)[0] for one in (motion, cleaned.motion)]
    # the trunk's middle is its origin
    assert moved.link_rms[0] == pytest.approx(np.sqrt(np.mean(np.sum((places[1] - places[0])[:, 0] ** 2, axis=1))))
    assert moved.joint_rms[2] == pytest.approx(np.sqrt(np.mean((cleaned.motion.angles - motion.angles) ** 2)))


def test_what_is_no_motion_of_the_avatar_is_refused_by_frame() -> None:
    motion = swinging(10, 1.0)
    with pytest.raises(InvalidInput, match="avatar of the model"):
        clean(motion, Model(None, None, (FLOOR,), ()), (), OPTIONS)
    with pytest.raises(InvalidInput, match="in frame 0 of the motion"):
        audit(Motion(motion.times, motion.positions, motion.rotations, np.zeros((10, 2))), model())
    with pytest.raises(InvalidInput, match="positions in frame 3"):
        audit(lowered(motion, 1e9 * (np.arange(10) == 3)), model())
    rotations = motion.rotations.copy()
    rotations[7, 1] *= 2.0
    with pytest.raises(InvalidInput, match="in frame 7 of the motion"):
        clean(Motion(motion.times, motion.positions, rotations, motion.angles), model())
    for name, value in (("margin", 0.0), ("margin", float("nan")), ("blend", -0.1), ("blend", 3.0)):
        with pytest.raises(InvalidInput, match=name):
            Options(**{name: value})  # type: ignore[arg-type]


@pytest.mark.parametrize("frames", [1, 2, 3])
def test_clips_of_a_few_frames(frames: int) -> None:
    for height in (1.0, 0.1):
        cleaned = clean(swinging(frames, height), model(), (FLOOR,), OPTIONS)
        require_clean(cleaned, FLOOR) if frames > 1 else None
        assert len(cleaned.motion) == frames and cleaned.after.overlapping == 0


def turning(canonical: bool) -> Motion:
    """A dip into the floor while the root makes two whole turns; if `canonical`, quaternions with a scalar part from 0 on."""
    motion = dipping()
    rotations = motion.rotations.copy()
    rotations[:, 0] = rotation.from_axis_angle((0.0, 0.0, 1.0), np.linspace(0.0, 4.0 * np.pi, len(motion)))
    if canonical:
        rotations *= np.where(rotations[..., :1] < 0.0, -1.0, 1.0)
    return replace(motion, rotations=rotations)


@pytest.mark.parametrize("blend", [0.0, OPTIONS.blend])
@pytest.mark.parametrize("canonical", [False, True])
def test_quaternions_change_sides_only_where_the_input_does(canonical: bool, blend: float) -> None:
    motion = turning(canonical)
    cleaned = clean(motion, model(), (FLOOR,), replace(OPTIONS, blend=blend))
    assert cleaned.changed[44:48].all()

    def sides(rotations: np.ndarray) -> np.ndarray:
        return np.asarray((rotations[1:] * rotations[:-1]).sum(axis=2) > 0.0)

    assert sides(motion.rotations).all() == (not canonical)
    assert (sides(cleaned.motion.rotations) == sides(motion.rotations)).all()
    assert np.array_equal(~cleaned.changed, same(motion, cleaned.motion))


def test_bodies_of_one_name_are_told_apart() -> None:
    twin = fixed("floor", (Piece(Box((1.0, 1.0, 1.0))),), "wood", (1.0, 0.0, 0.5))
    found = audit(swinging(30, 0.5, along=1.0), model(), (FLOOR, twin), OPTIONS)
    assert found.deepest_pair is not None and found.deepest_pair[0] == "floor (2)"
