"""What tables need to know of engines stands in one file each."""

import fnmatch
import re
from datetime import date
from importlib.metadata import PackageNotFoundError, version

import pytest

from runfiles.engines import SPARE, About, about, engines, main_runs, run_label
from runfiles.metrics import METRICS
from scenarios import catalog

COLOUR = re.compile(r"#[0-9a-f]{6}")
FOUR = ("avatarsim", "mujoco", "pybullet", "tracker")


def test_four_engines_are_described_the_gated_one_first_and_the_baseline_last() -> None:
    assert set(engines()) == set(FOUR)
    order = list(engines())
    assert order[0] == "avatarsim" and order[-1] == "tracker"
    assert [name for name in order if engines()[name].baseline] == ["tracker"]


@pytest.mark.parametrize("theme", ["colour", "dark"])
def test_colours_are_valid_and_distinct(theme: str) -> None:
    own = [getattr(one, theme) for one in engines().values()]
    spare = [pair[theme == "dark"] for pair in SPARE]
    assert all(COLOUR.fullmatch(colour) for colour in own + spare)
    assert len(set(own + spare)) == len(own + spare)


@pytest.mark.parametrize("one", [engines()[name] for name in FOUR], ids=FOUR)
def test_facts_name_what_exists(one: About) -> None:
    assert one.label and one.presets and len(set(one.presets)) == len(one.presets)
    for lacking in one.unsupported.values():
        assert lacking.metrics and set(lacking.metrics) <= set(METRICS) and lacking.lacks in ("engine", "adapter")
    for line in one.native.values():
        assert "{" not in line or line.format("7") != line.format("8")


def test_known_issues_say_what_where_and_since_when() -> None:
    issues = [issue for one in engines().values() for issue in one.issues]
    assert issues
    names = list(catalog.scenarios())
    for issue in issues:
        assert issue.title and issue.text and issue.cause in ("engine", "adapter", "setting")
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


def test_an_engine_that_no_file_describes_has_facts_all_the_same() -> None:
    made = about("newcomer")
    assert (made.name, made.label) == ("newcomer", "newcomer") and not made.baseline and not made.unsupported
    assert (made.colour, made.dark) in SPARE and made == about("newcomer")


def test_labels_tell_all_runs_apart() -> None:
    runs = [*main_runs(), "mujoco/other", "avatarsim/paper", "newcomer/default", "newcomer/fast"]
    assert len({run_label(run) for run in runs}) == len(set(runs))
    assert set(main_runs()) == {f"{one.name}/{preset}" for one in engines().values() for preset in one.presets}
