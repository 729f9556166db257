"""Every metric and every closed form is named by a test of its own kind."""

import re
from pathlib import Path

from reference import closed_form
from runfiles.metrics import METRICS

TESTS = Path(__file__).resolve().parents[2]


def text_of(*folders: str) -> str:
    files = (file for folder in folders for file in (TESTS / folder).rglob("test_*.py") if file != Path(__file__))
    return "\n".join(file.read_text(encoding="utf-8") for file in files)


def test_every_metric_and_closed_form_is_named_by_a_test() -> None:
    measures, tested = text_of("scenarios/measure", "scenarios/studies"), text_of("reference/closed_form")
    # percentiles are tested in a loop; the placeholder "run" is no measure
    asked = {metric for metric in METRICS if metric in measures or re.sub(r"p\d+$", "p{share}", metric) in measures}
    assert asked >= set(METRICS) - {"run"}
    forms = {
        name for name, value in vars(closed_form).items()
        if getattr(value, "__module__", "") == closed_form.__name__ and not name.startswith("_")
    }
    # a result of `oblique_bounce`, which is tested
    assert forms - {"Oblique"} <= {name for name in forms if name in tested}
