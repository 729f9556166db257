"""A decomposed body in a scene: it falls, lands, comes to rest, and the judge finds no overlap in any frame."""

import numpy as np
import pytest

from avatarsim.assets.meshes import pieces_of_mesh
from avatarsim.engine import Settings
from avatarsim.scene.body import fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from avatarsim.simulator import AvatarsimEngine
from reference.judging.judge import Judge
from tests.assets.meshes.solids import Soup, channel, ell


@pytest.mark.parametrize(("soup", "pieces"), [(ell(), 2), (channel(), 3)])
def test_a_decomposed_body_lands_on_a_box(soup: Soup, pieces: int) -> None:
    found = pieces_of_mesh(soup, 0.1, quiet=True)
    assert len(found.pieces) == pieces
    table = fixed("table", (Piece(Box((2.0, 2.0, 0.1))),), "wood", (0.0, 0.0, -0.05))
    body = simulated("body", found.pieces, "wood", solid(found.pieces, 0.5), (0.0, 0.0, 0.05), angular_velocity=(0.4, 0.2, 0.1))
    scene = Scene("landing", (table, body))
    engine, judge = AvatarsimEngine(), Judge(scene)
    engine.load(scene, Settings(), 1.0 / 60.0)
    heights = []
    for _ in range(60):
        shown = engine.advance(scene.first_sample, 1.0 / 60.0).shown
        assert not judge.overlaps(shown.positions, shown.orientations).deepest > 1e-6
        heights.append(float(shown.positions[1, 2]))
    engine.close()
    # it fell, and something supports it: no corner of its 0.1 m slab is far from the table
    assert min(heights) < 0.04 and -1e-3 < heights[-1] < 0.15
    assert np.ptp(heights[-10:]) < 0.02
