"""The verdict on made-up numbers: which library is a rival, what is taken off, and what nan and wrong answers lead to."""

from dataclasses import replace

import numpy as np
import pytest

from reference.narrow_phase.rows import Row
from reference.narrow_phase.verdict import Judged, call_costs, judged

BASE = Row("box", "hull", "deep", "cold", "ours", "avatarsim", False, 2.0, 1.9, 2.1, np.nan, 1e-15, 0.0, 0.0, 0.0, 200, 9)


def rival(name: str, us: float, call: float = np.nan, error: float = 1e-9) -> Row:
    return replace(BASE, engine=name, library="other", per_call=call == call, us_p50=us, call_us=call, max_error_m=error)


def verdict(*rivals: Row, ours: float = 2.0, called: float = 2.5, mode: str = "cold", error: float = 1e-15) -> Judged:
    mine = (replace(BASE, us_p50=ours, max_error_m=error),
            replace(BASE, engine="ours+place", us_p50=1.5 * ours, max_error_m=error),
            replace(BASE, engine="ours/call", per_call=True, us_p50=called, call_us=0.5, max_error_m=error))
    (one,) = judged([replace(row, mode=mode) for row in (*mine, *rivals)])
    return one


def test_a_call_is_taken_off_the_rival_and_said() -> None:
    one = verdict(rival("calls", 2.4, 0.5))
    assert (one.rival, one.rival_us, one.ratio) == ("calls", pytest.approx(1.9), pytest.approx(2.0 / 1.9))
    assert not one.held and one.ratio_called == pytest.approx(2.5 / 2.4)


def test_nothing_is_taken_off_who_answers_all_pairs_in_one_call() -> None:
    one = verdict(rival("calls", 2.9, 0.5), rival("inside", 2.1))
    assert (one.rival, one.held) == ("inside", True)
    assert one.rival_called == "calls" and one.ratio_placed == pytest.approx(3.0 / 2.1)


@pytest.mark.parametrize("error", [1.01e-6, np.inf, np.nan])
def test_who_is_wrong_is_no_rival(error: float) -> None:
    one = verdict(rival("wrong", 0.1, error=error), rival("right", 3.0))
    assert one.rival == "right" and one.held


def test_coherent_means_half() -> None:
    assert verdict(rival("r", 4.01), mode="coherent").held
    assert not verdict(rival("r", 3.99), mode="coherent").held
    assert verdict(rival("r", 2.0), mode="cold").held


def test_the_difference_of_two_noisy_numbers_is_no_figure() -> None:
    one = verdict(rival("closed form", 0.55, 0.5), ours=0.2, called=0.5)
    assert one.rival == "" and np.isnan(one.ratio)
    assert one.rival_called == "closed form" and one.held
    assert not verdict(rival("closed form", 0.55, 0.5), ours=0.2, called=0.6).held


def test_without_a_rival_nothing_is_lost() -> None:
    one = verdict(rival("wrong", 0.1, error=1.0))
    assert one.held and one.rival == one.rival_called == "" and one.worst == 0.0


def test_wrong_answers_or_missing_figures_of_ours_are_lost() -> None:
    assert not verdict(rival("r", 9.0), error=1e-5).held
    assert verdict(rival("r", 9.0), error=np.nan).worst == np.inf
    assert not verdict(rival("r", 9.0), ours=np.nan).held


def test_lost_cells_come_first_and_the_worst_of_them_at_the_top() -> None:
    rows = []
    for kind, theirs in (("box", 3.0), ("hull", 0.5), ("capsule", 1.0)):
        rows += [replace(row, shape_a=kind) for row in (BASE, replace(BASE, engine="ours/call"), rival("r", theirs))]
    assert [one.shape_a for one in judged(rows)] == ["hull", "capsule", "box"]


def test_the_cost_of_a_call_is_the_median_of_all_cells() -> None:
    rows = [rival("r", 2.0, cost) for cost in (0.4, 0.5, 9.0)]
    assert call_costs([*rows, BASE]) == {("r", "cold"): 0.5}
