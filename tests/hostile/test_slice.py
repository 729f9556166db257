"""A slice of `make hostile`: some cases of each door in this process. Valid files pass, so that damage is all that is judged."""

from pathlib import Path

import pytest

from tests.assets.models.in_process import compile_here
from tests.hostile.campaign import doors
from tests.hostile.doors import FileDoor, place
from tests.hostile.judged import Judge

CASES, SLOW_CASES = 20, 3
"""Cases of one door."""
APART = {
    "engine", "pages", "mesh arrays", "words of clips", "words of pieces",
    *(name for name in doors() if name.startswith("hull ")),
}
"""Doors for `make hostile` alone: their cases take a tenth of a second and more, or wait for the engine's kernels."""
ASKED = [name for name in doors() if name not in APART]


@pytest.mark.parametrize("name", ASKED)
@pytest.mark.filterwarnings("ignore")
def test_hostile_input_ends_in_a_result_or_a_typed_error(name: str, tmp_path: Path) -> None:
    door, judge, found = doors()[name], Judge(reserves=True), []
    for k, case in enumerate(door.cases(1, SLOW_CASES if door.slow else CASES, tmp_path)):
        wrong = judge.verdict(case)
        if wrong is not None:
            found.append((k, case.text, wrong))
    assert not found, found


@pytest.mark.parametrize("name", [name for name in ASKED if doors()[name].files])
def test_valid_files_pass(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    compile_here(monkeypatch)
    files = doors()[name].files
    assert isinstance(files, FileDoor)
    for path, content in {**files.also(), **files.files()}.items():
        place(tmp_path, path, content)
    for path in files.files():
        files.ask(tmp_path, tmp_path / path)


@pytest.mark.parametrize("name", ["settings", "shapes"])
def test_equal_seeds_make_equal_cases_and_others_do_not(name: str, tmp_path: Path) -> None:
    first, again, other = ([case.text for case in doors()[name].cases(seed, 30, tmp_path)] for seed in (1, 1, 2))
    assert first == again != other and len(set(first)) > 20
