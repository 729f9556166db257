"""Executive summary: the three questions of the report, each answered in a sentence of the section that has the figures.

The questions are those of the README: what accuracy costs in time, whether hard cases stay numerically stable, and whether only
the effects are simulated that a scene calls for.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from reports.page.extra_sections import tried
from reports.sections import effects, stability
from reports.sections.effects import Ablation
from reports.sections.stability import Stability
from reports.sections.sweep import cheapest
from reports.sections.sweep.points import Sweep


@dataclass(frozen=True)
class Short:
    """A question in a few words, its answer, and the section that it is from."""

    question: str
    answer: str
    section: str


def three(sweep: Sweep | None, steady: Stability | None, ablation: Ablation | None) -> tuple[Short, ...]:
    """Those that this run can answer; a file that holds what no command writes is named by its own section."""
    asked: tuple[tuple[str, str, Callable[[], str] | None], ...] = (
        ("Accuracy against time", "sweep", partial(_cost, sweep) if sweep is not None and sweep.points else None),
        ("Stability", "stability", partial(stability.answer, steady) if steady is not None else None),
        ("Effects", "effects", partial(effects.answer, ablation) if ablation is not None else None),
    )
    told = [(question, section, tried((), answer, [])) for question, section, answer in asked if answer is not None]
    return tuple(Short(question, answer, section) for question, section, answer in told if answer is not None)


def _cost(sweep: Sweep) -> str:
    return cheapest.brief(cheapest.table(sweep))
