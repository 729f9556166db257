"""Every contender answers the question that was asked, for the pair it was asked about; errors are those known of its library."""

import numpy as np
import pytest

from reference.narrow_phase.cells import Cell, Mode, sequence
from reference.narrow_phase.contender import Contender
from reference.narrow_phase.field import ROOMS, contenders
from reference.narrow_phase.truth import errors, truths

EXACT = {"ours": 1e-9, "ours+place": 1e-9, "ours/call": 1e-9, "coal exact": 1e-8, "coal fast": 2e-6, "coal default": 2e-6,
         "mj geomDist": 1e-6, "mj collision": 1e-6}
"""Metres within which a contender is expected in the cells below; it would miss them by decimetres with pairs mixed up."""

LOOSE = 1e-2
"""The same for all others: margins, first contacts of several, iterations that end early."""

CELLS = Cell("box", "hull", "shallow"), Cell("sphere", "ellipsoid", "apart")
THERE, _ = contenders(ROOMS)


@pytest.mark.parametrize("mode", ["cold", "coherent"])
@pytest.mark.parametrize("cell", CELLS, ids=[cell.name for cell in CELLS])
@pytest.mark.parametrize("contender", THERE, ids=[contender.identity.name for contender in THERE])
def test_answers_belong_to_their_pairs(contender: Contender, cell: Cell, mode: Mode) -> None:
    asked = sequence(cell, mode, 3, 3)
    contender.load(asked, mode)
    contender.begin()
    truth = truths(asked, range(3))
    for frame in range(3):
        contender.pose(frame)
        contender.ask()
        answers = contender.answers()
        assert answers.shape == (3,)
        if contender.identity.name == "pb detection" and cell.regime == "apart":
            # further apart than its breaking threshold: no answer, and none made up
            assert np.isinf(answers).all()
            continue
        assert errors(answers, truth[frame]).max() <= EXACT.get(contender.identity.name, LOOSE)


def test_ours_take_part_whatever_is_missing() -> None:
    assert [contender.identity.name for contender in THERE[:3]] == ["ours", "ours+place", "ours/call"]
    found, absent = contenders(("in_ours", "in_nothing"))
    assert len(found) == 3 and absent["nothing"].startswith("not measured: ModuleNotFoundError")


def test_names_are_told_apart_and_settings_have_reasons() -> None:
    names = [contender.identity.name for contender in THERE]
    assert len(names) == len(set(names))
    assert all(value and " " in why for contender in THERE for value, why in contender.identity.settings.values())


def test_an_answer_that_is_missing_or_no_number_is_an_error_without_end() -> None:
    assert np.isinf(errors(np.array([np.inf, np.nan]), np.zeros(2))).all()
    assert errors(np.array([1.0]), np.array([1.5])) == pytest.approx(0.5)
