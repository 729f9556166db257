"""Links that overlap at home and that loose things lean on: moved by load as well, they get no deeper than they may."""

import numpy as np
import pytest

from avatarsim.engine import Settings
from avatarsim.scene.body import simulated, solid
from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from avatarsim.simulator import AvatarsimEngine
from reference.judging.judge import Judge
from tests.ik.test_at_rest import SHAPES, bent, depth_by_directions, jointed

DT = 1.0 / 60.0


@pytest.mark.parametrize("place", [(0.0, 0.0, 0.06), (-0.09, 0.02, 0.06), (-0.12, 0.0, 0.0)])
@pytest.mark.parametrize("into", [0.0, 0.25])
def test_links_that_are_loaded_get_no_deeper_than_they_may(place: Vector, into: float) -> None:
    """A box of 3 kg falls onto them, or is pushed away by one, while their user holds still or drives them together."""
    home = depth_by_directions(jointed(SHAPES[0]), [bent(np.zeros(5))])
    avatar = jointed(SHAPES[0], allowed=home + 2e-4)
    box = (Piece(Box((0.04, 0.1, 0.05))),)
    scene = Scene("loaded", (simulated("box", box, "wood", solid(box, 3.0), place),), (avatar,))
    shown = []
    with AvatarsimEngine() as engine:
        engine.load(scene, Settings(), DT)
        for frame in range(60):
            share = np.sin(np.pi * frame / 30)
            angles = np.array([0.0, -into * share, 0.0, into * share, 0.0])
            shown.append(engine.advance(bent(angles), DT).shown)
    places = np.array([one.positions for one in shown]), np.array([one.orientations for one in shown])
    assert Judge(scene).deepest(*places) <= 1e-6
