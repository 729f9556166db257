"""Pairs are in their regime, every contender answers for its own pair, and errors are those known of its library."""

import csv
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from benchmarks.__main__ import main
from benchmarks.narrow_phase import measure
from benchmarks.narrow_phase.contender import Cell, Contender, Mode
from benchmarks.narrow_phase.measure import Row, contenders, errors_of, summaries
from benchmarks.narrow_phase.pairs import DEPTHS, GAPS, RATE, TURNING, cells, make_trial, truths

EXACT = {"avatarsim": 1e-9, "avatarsim+place": 1e-9, "avatarsim/call": 1e-9, "coal exact": 1e-8, "coal fast": 2e-6,
         "coal default": 2e-6, "mj geomDist": 1e-6, "mj collision": 1e-6}
"""Metres within which a contender is expected in the cells below; it would miss them by decimetres with pairs mixed up."""
LOOSE = 1e-2
"""The same for all others: margins, first contacts of several, iterations that end early."""

SOME = (Cell("sphere", "capsule", "deep"), Cell("capsule", "box", "apart"), Cell("box", "hull", "shallow"),
        Cell("ellipsoid", "ellipsoid", "deep"))
THERE, ABSENT = contenders()


@pytest.mark.parametrize("mode", ["cold", "coherent"])
@pytest.mark.parametrize("cell", SOME, ids=[cell.name for cell in SOME])
def test_pairs_are_in_their_regime(cell: Cell, mode: Mode) -> None:
    made = make_trial(cell, mode, 3, 4)
    truth = truths(made, range(4))
    if cell.regime == "apart":
        assert (truth > GAPS[0] - 1e-4).all() and (truth < GAPS[1] + 1e-4).all()
        return
    concentric = made.at.copy()
    concentric[:, ::2] = 0.0
    deepest = truths(type(made)(cell, mode, made.shapes, made.turns, concentric), range(4))
    least, most = DEPTHS[cell.regime]
    assert (truth / deepest > least - 1e-3).all() and (truth / deepest < most + 1e-3).all()


def test_coherent_pairs_turn_at_the_rate_and_cold_ones_jump() -> None:
    made = make_trial(Cell("box", "hull", "shallow"), "coherent", 3, 5)
    steps = np.swapaxes(made.turns[:-1], -1, -2) @ made.turns[1:]
    angles = np.linalg.norm(Rotation.from_matrix(steps.reshape(-1, 3, 3)).as_rotvec(), axis=1).reshape(4, 6)
    assert np.allclose(angles[:, ::2], TURNING * RATE) and np.allclose(angles[:, 1::2], 0.0)
    assert np.linalg.norm(np.diff(made.at, axis=0), axis=-1).max() < 0.02
    cold = make_trial(Cell("box", "hull", "shallow"), "cold", 3, 3)
    assert np.linalg.norm(np.diff(cold.turns, axis=0), axis=(-1, -2)).min() > 0.05


@pytest.mark.parametrize("mode", ["cold", "coherent"])
@pytest.mark.parametrize("cell", [SOME[2], Cell("sphere", "ellipsoid", "apart")], ids=lambda cell: cell.name)
@pytest.mark.parametrize("contender", THERE, ids=[contender.name for contender in THERE])
def test_answers_belong_to_their_pairs(contender: Contender, cell: Cell, mode: Mode) -> None:
    trial = make_trial(cell, mode, 3, 3)
    contender.load(trial)
    answers = measure.answers(contender, trial, range(3))
    if contender.name == "pb detection" and cell.regime == "apart":
        # further apart than its breaking threshold: no answer, and none made up
        assert np.isinf(answers).all()
        return
    assert errors_of(answers, truths(trial, range(3))).max() <= EXACT.get(contender.name, LOOSE)


def test_missing_library_is_left_out_and_answer_is_infinite() -> None:
    found, absent = contenders(("avatarsim", "nothing"))
    assert [one.name for one in found] == ["avatarsim", "avatarsim+place", "avatarsim/call"] and set(absent) == {"nothing"}
    assert len({one.name for one in THERE}) == len(THERE)
    assert np.isinf(errors_of(np.array([np.inf, np.nan]), np.zeros(2))).all()
    assert errors_of(np.array([1.0]), np.array([1.5])) == pytest.approx(0.5)


def test_failing_contender_does_not_stop_the_others() -> None:
    class Fails(Contender):
        def load(self, trial: object) -> None:
            raise RuntimeError("no such shape")

    rows = measure.measure([Fails("bad", "bad", True), THERE[0]], SOME[0], "cold", measure.QUICK["cold"])
    assert [row.engine for row in rows] == ["avatarsim"]
    assert rows[0].us_p50 > 0.0 and rows[0].max_error_m < 1e-9 and rows[0].judged == 6


def test_a_summary_is_over_all_cells() -> None:
    def row(mode: str, us: float, error: float) -> Row:
        return Row("box", "box", "deep", mode, "lib", "lib", True, us, error, 0.0, 1, 1)

    (one,) = summaries([row("cold", 1.0, 0.0), row("cold", 4.0, 1e-3), row("coherent", 3.0, np.inf)])
    assert (one.us_cold, one.right, one.cells, one.max_error_m) == (2.0, 1, 3, 1e-3) and one.us_coherent == pytest.approx(3.0)


def test_the_command_measures_and_writes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert len(list(cells())) == 45
    code = main(["narrow-phase", "--quick", "--cells", "sphere-box deep", "--run", str(tmp_path)])
    assert code == (3 if ABSENT else 0)
    rows = list(csv.DictReader((tmp_path / "narrow_phase.csv").read_text().splitlines()))
    assert len(rows) == 2 * len(THERE) and all(float(row["us_p50"]) > 0.0 for row in rows)
    assert all(float(row["max_error_m"]) <= 1e-9 for row in rows if row["library"] == "avatarsim")
    engines = list(csv.DictReader((tmp_path / "narrow_phase_engines.csv").read_text().splitlines()))
    assert [row["engine"] for row in engines] == [one.name for one in THERE]
    assert main(["narrow-phase", "--cells", "pyramid*", "--run", str(tmp_path)]) == 2
    assert "pyramid*" in capsys.readouterr().err
