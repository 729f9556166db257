"""Pairs are in the regime that their cell names, in every frame; coherent ones move slowly; the same seed, the same poses."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from reference.narrow_phase.cells import DEPTHS, GAPS, KINDS, RATE, TURNING, Cell, Mode, cells, sequence
from reference.narrow_phase.truth import truths

SOME = (Cell("sphere", "capsule", "deep"), Cell("capsule", "box", "apart"), Cell("box", "hull", "shallow"),
        Cell("ellipsoid", "ellipsoid", "deep"))


def test_there_is_a_cell_for_every_pair_of_kinds_and_regime() -> None:
    found = list(cells())
    assert len(found) == len(set(found)) == 45
    assert {kind for cell in found for kind in cell[:2]} == set(KINDS)


@pytest.mark.parametrize("mode", ["cold", "coherent"])
@pytest.mark.parametrize("cell", SOME, ids=[cell.name for cell in SOME])
def test_pairs_are_where_their_regime_wants_them(cell: Cell, mode: Mode) -> None:
    made = sequence(cell, mode, 3, 4)
    truth = truths(made, range(4))
    if cell.regime == "apart":
        assert (truth > GAPS[0] - 1e-4).all() and (truth < GAPS[1] + 1e-4).all()
        return
    concentric = made.at.copy()
    concentric[:, ::2] = 0.0
    deepest = truths(type(made)(cell, mode, made.shapes, made.turns, concentric), range(4))
    least, most = DEPTHS[cell.regime]
    assert (truth / deepest > least - 1e-3).all() and (truth / deepest < most + 1e-3).all()


def test_coherent_pairs_turn_at_the_stated_rate_and_do_not_jump() -> None:
    made = sequence(Cell("box", "hull", "shallow"), "coherent", 3, 5)
    steps = np.swapaxes(made.turns[:-1], -1, -2) @ made.turns[1:]
    angles = np.linalg.norm(Rotation.from_matrix(steps.reshape(-1, 3, 3)).as_rotvec(), axis=1).reshape(4, 6)
    assert np.allclose(angles[:, ::2], TURNING * RATE) and np.allclose(angles[:, 1::2], 0.0)
    assert np.linalg.norm(np.diff(made.at, axis=0), axis=-1).max() < 0.02


def test_cold_frames_have_nothing_to_do_with_each_other() -> None:
    made = sequence(Cell("box", "hull", "shallow"), "cold", 3, 3)
    assert np.linalg.norm(np.diff(made.turns, axis=0), axis=(-1, -2)).min() > 0.05


def test_the_same_every_time() -> None:
    first, again = (sequence(Cell("hull", "hull", "deep"), "cold", 2, 2) for _ in range(2))
    assert np.array_equal(first.at, again.at) and np.array_equal(first.turns, again.turns)


def test_hulls_have_the_stated_numbers_of_corners() -> None:
    made = sequence(Cell("ellipsoid", "hull", "apart"), "cold", 6, 1)
    assert all(len(shape.vertices) == 52 for shape in made.shapes[::2])  # type: ignore[union-attr]
    assert all(20 <= len(shape.vertices) <= 60 for shape in made.shapes[1::2])  # type: ignore[union-attr]
