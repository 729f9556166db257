"""The three questions of the report are answered in its first view, in the words of the sections that have the figures."""

from dataclasses import replace
from pathlib import Path

from reports.page.three_answers import three
from reports.sections import effects, stability
from reports.sections.sweep import cheapest, points
from tests.reports.sections import test_effects, test_stability
from tests.reports.sections.sweep.test_cheapest import point


def test_a_run_without_a_study_answers_nothing() -> None:
    assert three(None, None, None) == ()


def test_the_cost_of_accuracy_is_told_in_one_sentence_with_its_losses(tmp_path: Path) -> None:
    cheap = (point("avatarsim/default", 1e-7, 10.0), point("mujoco/tuned", 1e-7, 5.0))
    dear = (point("avatarsim/default", 1e-7, 5.0), point("mujoco/tuned", 1e-7, 10.0))
    for found, said in ((cheap, "another engine is cheaper in 4 (wall)."), (dear, "another engine is cheaper in 0.")):
        (short,) = three(points.Sweep(found, {}), None, None)
        assert short.section == "sweep" and said in short.answer
        assert short.answer == cheapest.brief(cheapest.table(points.Sweep(found, {})))


def test_a_rival_within_what_counts_as_level_is_called_level() -> None:
    found = (point("avatarsim/default", 1e-7, 10.0), point("mujoco/tuned", 1e-7, 9.5))
    assert "×0.95, level" in cheapest.brief(cheapest.table(points.Sweep(found, {})))


def test_hard_cases_and_effects_are_answered_in_the_words_of_their_sections(tmp_path: Path) -> None:
    steady = test_stability.found(tmp_path)
    ablation = test_effects.fill(tmp_path, [test_effects.row("friction", 0.1)], ("coupling",))
    hard, called = three(None, steady, ablation)
    assert (hard.section, hard.answer) == ("stability", stability.answer(steady))
    assert (called.section, called.answer) == ("effects", effects.answer(ablation)) and "zero calls of coupling" in called.answer


def test_a_file_that_no_command_writes_costs_its_answer_alone(tmp_path: Path) -> None:
    spoilt = points.Sweep((replace(point("avatarsim/default", 1e-7, 10.0), setting=None),), {})  # type: ignore[arg-type]
    assert [one.section for one in three(spoilt, test_stability.found(tmp_path), None)] == ["stability"]
