"""Nothing in the paper is left without a test and a scene, and no entry of the table leads nowhere."""

import pytest

from scenarios import catalog
from tests.named_tests import TESTS, exists
from tests.paper.claims import ALGORITHMS, EQUATIONS, FIGURES, PAPER, TABLES


def test_every_equation_table_and_figure_has_claims() -> None:
    assert list(EQUATIONS) == [f"equation {k}" for k in range(1, 11)]
    assert list(TABLES) == ["table 1", "table 2"] and list(FIGURES) == [f"figure {k}" for k in range(1, 9)]
    assert list(ALGORITHMS) == ["algorithm 1"]


@pytest.mark.parametrize("name", PAPER)
def test_every_test_and_every_scene_that_is_named_exists(name: str) -> None:
    claim = PAPER[name]
    assert claim.says and claim.tests and claim.scenes
    assert set(claim.scenes) <= set(catalog.scenarios())
    for entry in claim.tests:
        assert exists(entry), entry


def test_every_file_of_this_room_is_in_the_table() -> None:
    named = {entry.partition("::")[0] for claim in PAPER.values() for entry in claim.tests}
    here = {f"paper/{path.name}" for path in (TESTS / "paper").glob("test_*.py")} - {"paper/test_claims.py"}
    assert here <= named
