"""No grader without a grade: every metric and every closed form has its test, which exists and speaks of it."""

import ast
import re
from functools import cache
from pathlib import Path

import pytest

from reference import closed_form
from runfiles.metrics import METRICS
from tests.scenarios.measure.grades import CLOSED_FORMS_GRADED, METRICS_GRADED

HERE = Path(__file__).resolve().parent
REFERENCE = HERE.parents[1] / "reference"


@cache
def source_of(entry: str, folder: Path) -> str:
    """The text of a test, "" when there is none of that name."""
    file, _, function = entry.partition("::")
    text = (folder / file).read_text(encoding="utf-8")
    found = [node for node in ast.parse(text).body if isinstance(node, ast.FunctionDef) and node.name == function]
    return ast.get_source_segment(text, found[0]) or "" if found else ""


def test_every_metric_and_every_closed_form_is_in_the_table() -> None:
    assert set(METRICS_GRADED) == set(METRICS) - {"run"}
    assert set(CLOSED_FORMS_GRADED) == {
        name for name, value in vars(closed_form).items()
        if getattr(value, "__module__", "") == closed_form.__name__ and not name.startswith("_")
    }


@pytest.mark.parametrize("metric", METRICS_GRADED)
def test_the_test_of_a_metric_names_it(metric: str) -> None:
    text = source_of(METRICS_GRADED[metric], HERE)
    # percentiles are asked in a loop
    family = re.sub(r"p\d+$", "p{share}", metric)
    assert metric in text or family in text or "test_tracker_offset" in METRICS_GRADED[metric]
    assert "assert" in text


@pytest.mark.parametrize("name", CLOSED_FORMS_GRADED)
def test_the_test_of_a_closed_form_calls_it(name: str) -> None:
    text = source_of(CLOSED_FORMS_GRADED[name], REFERENCE)
    assert name in text or name == "Oblique"
    assert "assert" in text
