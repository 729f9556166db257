"""Pyramids of bricks: as many contacts as are known, no overlap, one at rest stays, one that is dropped lands."""

from math import ceil, sqrt

import numpy as np
import pytest

from avatarsim.engine import Settings
from avatarsim.scene.body import fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from avatarsim.scene.tracker import rest
from avatarsim.simulator import AvatarsimEngine
from reference.judging.judge import Judge

LONG, SIDE, JOINT, DROP, DT = 0.2, 0.1, 0.002, 0.01, 1.0 / 60.0


def pyramid(rows: int, gap: float) -> Scene:
    """Return rows of bricks, each a gap [m] above the one below. At rest the lowest of w rows has w bricks with four contact
    points each; all others, w (w - 1) / 2, rest on two with eight: 4 w^2."""
    shape = (Piece(Box((LONG, SIDE, SIDE))),)
    bricks = tuple(
        simulated(f"brick_{row}_{k}", shape, "wood", solid(shape, 2.0),
                  ((LONG + JOINT) * (k + 0.5 * row), 0.0, (SIDE + gap) * (row + 1) - 0.5 * SIDE))
        for row in range(rows) for k in range(rows - row)
    )
    ground = fixed("floor", (Piece(Box((100.0, 100.0, 0.2))),), "wood", (0.0, 0.0, -0.1))
    return Scene("pyramid", (ground, *bricks), narrow=("sleeping",))


@pytest.mark.parametrize("gap", [0.0, DROP])
@pytest.mark.parametrize("contacts", [1, 10, 100])
def test_it_keeps_its_contacts_and_overlaps_nothing(contacts: int, gap: float) -> None:
    rows = ceil(sqrt(contacts / 4.0))
    scene = pyramid(rows, gap)
    engine, judge = AvatarsimEngine(), Judge(scene)
    first = engine.load(scene, Settings(), DT)
    found = [engine.advance(rest((), (k + 1) * DT), DT) for k in range(90)]
    shown = [first, *found[::5], found[-1]]
    assert max(judge.overlaps(r.shown.positions, r.shown.orientations).deepest for r in shown) <= 1e-6
    moved = found[-1].shown.positions - first.shown.positions
    if gap == 0.0:
        np.testing.assert_allclose(moved, 0.0, atol=1e-6)
        assert min(record.counts["contacts"] for record in found) >= contacts
    else:
        assert moved[:, 2].min() == pytest.approx(-gap * rows, abs=1e-3)
        assert max(record.counts["contacts"] for record in found) >= min(contacts, 4)
        # a body at rest is looked at once: a load that wandered from corner to corner took 125,000
        assert found[-1].counts["work"] < 20 * max(contacts, 4)
