"""What angles weigh beside link origins."""

from dataclasses import replace

import numpy as np
import pytest

from avatarsim.posture.turn_weight import LEAST_SHARE, mean_reach, turn_weight
from avatarsim.scene.scene import Scene
from tests.posture.little_worlds import SETTINGS, hand, little, mixed_avatar

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]
SCENE = Scene("s", (), (mixed_avatar(), replace(mixed_avatar(), name="n")))


def test_the_mean_reach_of_links_is_measured_from_their_joints() -> None:
    found = little(SCENE)
    geo, skel, _, poses = found.parts
    # capsules of 0.3 and 0.1 m from the joint, with caps of 0.04 m; hull: twice its half length; box and ball: the ball's top
    expected = [0.34, 0.3, 0.4, 0.14, 0.34]
    assert mean_reach(geo, skel, poses) == pytest.approx(np.mean(expected), rel=0.03)


def test_a_radian_weighs_as_the_mean_reach_and_less_where_nothing_turns_against_anything() -> None:
    jointed, alone = little(SCENE), little(Scene("s", (), (hand(),)))
    geo, skel, _, poses = jointed.parts
    links, rigid = len(skel.kind), sum(not turns for turns in np.diff(skel.first_dof))
    # the sum over links and the one over joints stand for means
    share = SETTINGS.turn_share * links / (links - rigid)
    assert turn_weight(geo, skel, poses, SETTINGS) == pytest.approx(share * mean_reach(geo, skel, poses) ** 2)
    geo, skel, _, poses = alone.parts
    assert turn_weight(geo, skel, poses, SETTINGS) == pytest.approx(SETTINGS.turn_alone * mean_reach(geo, skel, poses) ** 2)


@pytest.mark.parametrize("share", [0.0, LEAST_SHARE, 0.5, 3.0])
def test_the_settings_say_what_angles_weigh(share: float) -> None:
    for scene, name in ((SCENE, "turn_share"), (Scene("s", (), (hand(),)), "turn_alone")):
        geo, skel, _, poses = little(scene).parts
        weighed = turn_weight(geo, skel, poses, SETTINGS._replace(**{name: share}))
        usual = turn_weight(geo, skel, poses, SETTINGS) / getattr(SETTINGS, name)
        assert weighed == pytest.approx(max(share, LEAST_SHARE) * usual)
