"""Settings of a user's own are refused at the door when an engine does not take them, and only then."""

from pathlib import Path

import pytest

from avatarsim.errors import InvalidInput
from scenarios.run.own_settings import OwnSettings, check_settings
from tests.agreement.rivals import needs_pybullet
from tests.scenarios.bad_engines import joined

FILE = Path("mine.toml")


def row(engine: str, **options: object) -> OwnSettings:
    return OwnSettings(engine, "mine", "default", options)


@pytest.mark.parametrize("workers", [0, 2])
def test_the_first_in_the_file_is_named_with_value_and_what_is_valid(workers: int) -> None:
    rows = [row("avatarsim"), row("mujoco", itterations=5), row("avatarsim", tolerence=1e-3)]
    with pytest.raises(InvalidInput, match=r"in \[mujoco.mine\] of mine.toml: .*'itterations'; valid: .*iterations"):
        check_settings(rows, "ball_drop", FILE, workers)
    with pytest.raises(InvalidInput, match=r"in \[avatarsim.mine\] of mine.toml: .*'tolerence'; valid: "):
        check_settings(rows[::2], "ball_drop", FILE, workers)
    check_settings([row("avatarsim"), row("mujoco", iterations=5)], "ball_drop", FILE, workers)


@needs_pybullet
def test_a_word_where_a_number_belongs_is_refused() -> None:
    with pytest.raises(InvalidInput, match="solver_iterations of pybullet is 'many'; valid: numbers"):
        check_settings([row("pybullet", solver_iterations="many")], "ball_drop", FILE, 1)


def test_an_engine_that_falls_over_is_a_result_and_no_fault_of_the_settings(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(joined(tmp_path))
    check_settings([row("raises"), row("dies"), row("absent")], "ball_drop", FILE, 2)
