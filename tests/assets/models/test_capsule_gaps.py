"""Gaps of capsules: against the engine's own narrow phase, and segments against a dense search."""

import numpy as np
import pytest

import avatarsim as av
from avatarsim.assets.models.capsule_gaps import link_gaps, segment_distances
from avatarsim.assets.models.from_skeleton import human
from avatarsim.scene.tracker import link_poses
from tests.assets.models.recorded import clip, human_skeleton


def test_segments_are_as_far_apart_as_their_nearest_points() -> None:
    random = np.random.default_rng(4)
    ends = random.normal(size=(4, 300, 3))
    ends[1, :20] = ends[0, :20]
    ends[3, 10:40] = ends[2, 10:40]
    ends[3, 40:60] = ends[2, 40:60] + ends[1, 40:60] - ends[0, 40:60]
    found = segment_distances(*ends)
    t = np.linspace(0.0, 1.0, 201)
    for k in range(300):
        a, b = (ends[j, k] + t[:, None] * (ends[j + 1, k] - ends[j, k]) for j in (0, 2))
        dense = np.linalg.norm(a[:, None] - b[None, :], axis=-1).min()
        assert dense - 0.02 < found[k] <= dense + 1e-12


def test_gaps_of_links_are_the_engine_s() -> None:
    """Arms that come down until they touch: where the engine finds an overlap, the gap is as deep."""
    skeleton = human_skeleton()
    avatar = human(skeleton, 1.7, clip(skeleton, {}), limits=False).avatar
    assert avatar is not None
    names = [link.name for link in avatar.links]
    down = clip(skeleton, {"LeftArm": ((1.0, 0.0, 0.0), -99.0)}).sample(0)
    gaps = link_gaps(avatar.links, *link_poses([avatar], down))
    with pytest.raises(av.StartOverlaps) as caught, av.AvatarsimEngine() as engine:
        engine.load(av.Scene("room", avatars=(avatar,), start=down), av.Settings(), 0.01)
    depths = {tuple(name.split("/")[1] for name in pair[:2]): pair[2] for pair in caught.value.pairs}
    assert depths
    for (a, b), depth in depths.items():
        assert gaps[names.index(a), names.index(b)] == pytest.approx(-depth, abs=1e-6)
    assert np.isinf(np.diag(gaps)).all() and (gaps == gaps.T).all()
