"""Fixtures of pytest for a user's own scenes: `compare`, and `drift`, the gate on figures that were kept.

    def test_cell(compare):
        assert compare("cell.xml").overlap["mujoco/tuned"] < 1e-3

    def test_nothing_drifts(drift):
        drift("cell.xml", motion="joints.csv")
"""

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import pytest

if TYPE_CHECKING:
    import pandas as pd

UPDATE = "--update-drift"
FILES = ("motion", "avatar", "room")
"""Arguments that are files, in addition to the scene."""

Comparisons = dict[tuple[str, tuple[str, ...]], Mapping[str, Any]]
_made = pytest.StashKey[Comparisons]()


class Compare(Protocol):
    """`avatarsim.compare` with paths from the folder of the test."""

    def __call__(self, scene: str | Path, motion: str | Path | None = None, **arguments: Any) -> "pd.DataFrame": ...


class Drift(Protocol):
    """Gate on the figures of a scene: fails the test where one has moved from the kept file."""

    def __call__(
        self, scene: str | Path, motion: str | Path | None = None, *, kept: str | Path | None = None, share: float = 0.0,
        **arguments: Any,
    ) -> None: ...


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the option that keeps figures anew."""
    parser.getgroup("avatarsim").addoption(UPDATE, action="store_true", help="keep the figures of `drift` tests anew")


def _place(folder: Path, file: str | Path) -> str:
    """Return a path from the folder of the test, whose files are in its folder; names that are no file stay, such as "floor"."""
    return str(folder / file) if (folder / file).exists() else str(file)


@pytest.fixture
def _compared(request: pytest.FixtureRequest) -> Callable[..., Mapping[str, Any]]:
    """Compare a scene once in a session, however many tests use it."""
    from avatarsim.comparing import compared, words_of

    folder, made = request.path.parent, request.config.stash.setdefault(_made, {})

    def found(scene: str | Path, motion: str | Path | None = None, **arguments: Any) -> Mapping[str, Any]:
        given = {"motion": motion, **arguments}
        given |= {name: _place(folder, given[name]) for name in FILES if given.get(name) is not None}
        key = _place(folder, scene), tuple(words_of(**given))
        if key not in made:
            made[key] = compared(*key)
        return made[key]

    return found


@pytest.fixture
def compare(_compared: Callable[..., Mapping[str, Any]]) -> Iterator[Compare]:
    """Compare a scene in all installed engines: the table of `avatarsim.compare`, with the same arguments."""
    from avatarsim.comparing import table

    yield lambda scene, motion=None, **arguments: table(_compared(scene, motion, **arguments))


@pytest.fixture
def drift(request: pytest.FixtureRequest, _compared: Callable[..., Mapping[str, Any]]) -> Iterator[Drift]:
    """Compare the figures of a scene with those in a file next to the test, SCENE.drift.json, which --update-drift writes."""
    from avatarsim.drift import drift_table, drifted, read_figures, update

    def gate(
        scene: str | Path, motion: str | Path | None = None, *, kept: str | Path | None = None, share: float = 0.0,
        **arguments: Any,
    ) -> None:
        path = request.path.parent / (kept or f"{Path(scene).stem}.drift.json")
        if request.config.getoption(UPDATE):
            update(path, _compared(scene, motion, **arguments))
            return
        before = read_figures(path)
        if moved := drifted(before, _compared(scene, motion, **arguments), share):
            count = f"{len(moved)} of the figures in {path.name} moved"
            pytest.fail(f"{count}; pytest {UPDATE} keeps the new ones\n\n{drift_table(moved)}", pytrace=False)

    yield gate
