"""Facts on engines for tables are in one file each."""

import fnmatch
import re
from datetime import date
from importlib.metadata import PackageNotFoundError, version

import pytest

from runfiles.engines import SPARE, about, engines, main_runs, run_label
from scenarios import catalog


def test_the_gated_engine_is_first_and_the_baseline_last() -> None:
    order = list(engines())
    assert order[0] == "avatarsim" and [name for name in order if engines()[name].baseline] == order[-1:] == ["tracker"]


@pytest.mark.parametrize("theme", ["colour", "dark"])
def test_colours_are_distinct(theme: str) -> None:
    colours = [getattr(one, theme) for one in engines().values()] + [pair[theme == "dark"] for pair in SPARE]
    assert len(set(colours)) == len(colours)


def test_known_issues_say_what_where_and_since_when() -> None:
    issues = [issue for one in engines().values() for issue in one.issues]
    names = list(catalog.scenarios())
    for issue in issues:
        assert date.fromisoformat(issue.date) <= date.today() and re.fullmatch(r"\d+(\.\d+)+", issue.version)
        for pattern in issue.scenes.split():
            assert fnmatch.filter(names, pattern) or pattern.startswith("unseen_"), pattern


@pytest.mark.parametrize("name", ["mujoco", "pybullet"])
def test_issues_are_of_the_version_that_runs(name: str) -> None:
    try:
        installed = version(name)
    except PackageNotFoundError:
        pytest.skip(f"{name} is not installed")
    assert {issue.version for issue in engines()[name].issues} == {installed}


def test_engine_without_a_file_has_facts_and_labels_differ() -> None:
    made = about("newcomer")
    assert (made.name, made.label) == ("newcomer", "newcomer") and not made.baseline and not made.unsupported
    assert (made.colour, made.dark) in SPARE and made == about("newcomer")
    runs = [*main_runs(), "mujoco/other", "avatarsim/paper", "newcomer/default", "newcomer/fast"]
    assert len({run_label(run) for run in runs}) == len(set(runs))
    assert set(main_runs()) == {f"{one.name}/{preset}" for one in engines().values() for preset in one.presets}
