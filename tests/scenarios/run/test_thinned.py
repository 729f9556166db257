"""What a run keeps of the states inside frames answers the questions that are asked later as all of them would."""

from dataclasses import replace

import numpy as np

from scenarios.measure.side import wrong_side
from scenarios.run.thinned import thinned
from scenarios.scenario import Region
from tests.scenarios.examples import drop, drop_scene, fist, fist_scene, resting, with_inside

BELOW = Region(("ball",), (-9.0, -9.0, -9.0), (9.0, 9.0, 1.0), "a ceiling")
"""Where the ball may be."""


def test_velocities_are_kept_of_bodies_and_not_of_links() -> None:
    scene, whole = fist_scene(), resting(fist_scene(), 4)
    whole.velocities[:] = 1.0
    kept = thinned(whole, fist(4), scene)
    links = kept.links
    assert np.isnan(kept.velocities[:, links]).all() and np.isnan(kept.angular_velocities[:, links]).all()
    assert kept.velocities[:, : links.start].tolist() == whole.velocities[:, : links.start].tolist()
    assert np.isfinite(whole.velocities).all() and links.stop > links.start


def test_of_frames_on_the_wrong_side_the_first_snapshot_is_kept_and_of_others_none() -> None:
    scene, base = drop_scene(), resting(drop_scene(), 4)
    z = [0.5, 0.6, 1.2, 1.3, 0.7, 1.4, np.nan]
    frames = [1, 1, 2, 2, 2, 3, 4]
    positions = np.tile(base.positions[0], (7, 1, 1))
    positions[:, scene.names.index("ball"), 2] = z
    whole = with_inside(base, [0.01 * k for k in range(7)], frames, ["step"] * 7, positions, np.zeros((7, 2, 3)))
    scenario = replace(drop(), regions=(BELOW,))
    kept = thinned(whole, scenario, scene)
    assert kept.inside_frame.tolist() == [2, 3, 4] and kept.inside_time.tolist() == [0.02, 0.05, 0.06]
    assert kept.positions is whole.positions and kept.inside_velocities.shape == (3, 2, 3)
    assert wrong_side(kept, scenario, scene) == wrong_side(whole, scenario, scene)
    assert len(thinned(whole, replace(scenario, regions=()), scene).inside_time) == 0
