"""Rules for every scene of a catalogue: its texts, its bounds, a start free of overlap, a valid motion."""

import numpy as np
import pytest
from numpy.typing import NDArray

from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import checked, link_poses, link_poses_each
from reference.judging.judge import Judge
from scenarios.run.gate import bounds_of
from scenarios.scenario import EXPECTS, Scenario

Array = NDArray[np.float64]

BRISK = 0.15
"""Largest motion of a link's origin per frame [m]: 9 m/s, the speed of a fist."""
FREEZES = ("still_frames", "apex_error_max")
"""Metrics of which one needs a bound if the scene expects nothing else.
An engine that freezes must violate a bound that can be measured."""


def first_poses(scene: Scene) -> tuple[Array, Array]:
    """Return the body frames of the whole scene at its start."""
    positions, orientations = link_poses(scene.avatars, scene.first_sample)
    return (
        np.vstack([*(body.position for body in scene.bodies), positions]),
        np.vstack([*(body.orientation for body in scene.bodies), orientations]),
    )


def says_what_it_is_and_what_must_hold(scenario: Scenario) -> None:
    """Check one sentence each for title and judgement, the name, one bound per metric, and the bounds that every scene needs."""
    assert scenario.build().name == scenario.name
    assert scenario.title.endswith(".") and scenario.judged.endswith(".")
    bounds = {bound.metric: bound for bound in scenario.bounds}
    assert len(bounds) == len(scenario.bounds)
    assert bounds["residual_overlap_max"].limit == 1e-6
    assert "not_finite_frames" in bounds
    assert set(FREEZES) & set(bounds) or scenario.expects
    # a bound on a metric without a closed form in the scene would never be measured
    by_key = {metric: key for key, (_, metrics) in EXPECTS.items() for metric in metrics}
    assert {by_key[metric] for metric in bounds if metric in by_key} <= set(scenario.expects)
    # raises for a metric that does not exist
    assert set(bounds) <= set(bounds_of(scenario))


def begins_free_where_its_regions_allow(scenario: Scenario) -> None:
    """Check that the judge finds no overlap in the first pose, and that every body is in its regions."""
    scene = scenario.build()
    positions, orientations = first_poses(scene)
    assert scenario.expects.get("refusal") or Judge(scene).overlaps(positions, orientations).deepest == 0.0
    for region in scenario.regions:
        inside = positions[list(region.indices(scene.names))]
        assert ((inside >= region.low) & (inside <= region.high)).all()


def moves_soundly(scenario: Scenario, fastest: float = BRISK) -> None:
    """Check for valid samples, one per frame, equal when repeated; no origin moves farther than `fastest` [m] per frame."""
    scene = scenario.build()
    motion, again = scenario.motion(scene, 0), scenario.motion(scene, 0)
    samples = [checked(motion(frame), scene.avatars) for frame in range(min(scenario.frames, 400))]
    for frame, sample in enumerate(samples):
        assert sample.time == pytest.approx((frame + 1) * scenario.dt)
        same = again(frame)
        assert (sample.positions == same.positions).all() and (sample.rotations == same.rotations).all()
    places, _ = link_poses_each(scene.avatars, [scene.first_sample, *samples])
    assert np.linalg.norm(np.diff(places, axis=0), axis=-1).max(initial=0.0) < fastest
