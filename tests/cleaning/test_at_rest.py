"""Pairs that overlap at home, in recorded motions: no deeper than there, untouched where they are not, wherever a clip is cut."""

import numpy as np
import pytest

from avatarsim.assets.models.coordinates import coordinates_of
from avatarsim.assets.models.from_skeleton import human
from avatarsim.assets.models.model import Model
from avatarsim.cleaning import Options, Shield, audit, clean
from avatarsim.scene.motion import Motion
from avatarsim.scene.written import written as scene_data
from avatarsim.spatial import rotation
from tests.assets.models.recorded import human_skeleton
from tests.ik.test_at_rest import HOME, bent, depth_by_directions, jointed
from tests.ik.test_at_rest import SHAPES as LINKS

OPTIONS = Options(opinion=False)


def of_angles(angles: np.ndarray) -> Motion:
    """Return the two outer links with these angles (F, 5), at 30 Hz."""
    frames, still = len(angles), bent(np.zeros(5))
    return Motion(
        np.arange(frames) / 30.0, np.tile(still.positions, (frames, 1, 1)), np.tile(still.rotations, (frames, 1, 1)), angles
    )


@pytest.mark.parametrize("kind", [0, 1])
def test_links_go_no_deeper_than_at_home(kind: int) -> None:
    """Postures at home stay as they are."""
    home = depth_by_directions(jointed(LINKS[kind]), [bent(np.zeros(5))])
    model = Model(jointed(LINKS[kind], allowed=home + 2e-4), None, (), (), start=bent(np.zeros(5)))
    angles = np.zeros((60, 5))
    into = np.maximum(0.0, np.sin(np.linspace(-np.pi, 2.0 * np.pi, 60)))
    angles[:, 1], angles[:, 3], angles[:, 0] = -0.3 * into, 0.3 * into, np.linspace(0.0, 0.5, 60)
    done = clean(of_angles(angles), model, (), OPTIONS)
    assert done.before.overlapping > 5 and done.before.deepest > 0.02 and done.before.unproven > 0
    (before,), (after,) = done.before.at_rest, done.after.at_rest
    assert (before.a, before.b) == ("pair/left", "pair/right") and before.allowed == pytest.approx(home + 2e-4)
    assert before.depth == pytest.approx(home + 2e-4 + done.before.deepest, abs=1e-6)
    assert done.after.is_clean and after.depth <= home + 2e-4 + 1e-9
    # at home and beyond it, the links apart, nothing is nearer than it may be
    still = into == 0.0
    assert still.sum() > 15 and not done.changed[: int(np.flatnonzero(~still)[0]) - 4].any()
    shown = [done.motion.sample(frame) for frame in range(60)]
    assert model.avatar and depth_by_directions(model.avatar, shown) <= home + 2e-4 + 1e-6 and HOME > 0.0


@pytest.mark.parametrize("rates", [None, 8.0])
def test_a_shield_holds_still_at_home_and_lets_nothing_deeper(rates: float | None) -> None:
    home = depth_by_directions(jointed(LINKS[0]), [bent(np.zeros(5))])
    avatar = jointed(LINKS[0], allowed=home + 2e-4)
    model = Model(avatar, coordinates_of(avatar), (), (), start=bent(np.zeros(5)))
    shield = Shield(model, rate=60.0, options=OPTIONS, speed_limits=rates and 2.0, acceleration_limits=rates)
    still = [shield(np.zeros(5)) for _ in range(10)]
    assert np.abs(still).max() < 1e-12
    shares = np.sin(np.linspace(0.0, np.pi, 60))
    found = np.array([shield(share * np.array([0.0, -0.3, 0.0, 0.3, 0.0])) for share in shares])
    assert depth_by_directions(avatar, [bent(angles) for angles in found]) <= home + 2e-4 + 1e-6
    assert np.abs(found[:, [1, 3]]).max() < 0.2


def test_a_frame_is_called_the_same_wherever_its_clip_is_cut() -> None:
    """Arms that go into the hips and out again, cut where they are in them."""
    skeleton, frames = human_skeleton(), 24
    names = [bone.name for bone in skeleton.bones]
    turns = np.tile(np.array(rotation.IDENTITY), (frames, len(names), 1))
    angle = np.radians(-115.0) * np.sin(np.linspace(0.0, np.pi, frames))
    for name, sign in (("LeftArm", 1.0), ("RightArm", -1.0)):
        turns[:, names.index(name)] = rotation.from_axis_angle((1.0, 0.0, 0.0), sign * angle)
    places = np.tile((0.0, 0.0, 1.0), (frames, len(names), 1))
    whole = Motion(np.arange(frames) / 30.0, places, turns, np.zeros((frames, 0)))
    cut = Motion(whole.times[10:], places[10:], turns[10:], whole.angles[10:])
    models = [human(skeleton, 1.7, motion) for motion in (whole, cut)]
    assert scene_data(models[0].avatar) == scene_data(models[1].avatar)
    found = [audit(motion, model, (), OPTIONS) for motion, model in zip((whole, cut), models, strict=True)]
    assert found[1].overlapping > 3 and found[0].depths[0] == 0.0
    assert (found[0].depths[10:] == found[1].depths).all() and (found[0].proven[10:] == found[1].proven).all()
